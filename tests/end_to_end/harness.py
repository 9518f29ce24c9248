"""Runs the real command for the tests of this folder: under mpirun or alone, with limits, under a timeout.

Every test file is a unittest whose main() is harness.main(). ctest names the programs in the environment:
DOVETAIL_COMMAND, DOVETAIL_MPIEXEC, and DOVETAIL_DATA for real data (else ../shared/data beside the checkout).
Standard library only.
"""

import json
import os
import pathlib
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import uuid

COMMAND = os.environ["DOVETAIL_COMMAND"]
MPIEXEC = os.environ.get("DOVETAIL_MPIEXEC", "mpiexec")
FULL = os.environ.get("DOVETAIL_FULL") == "1"
SANITIZED = os.environ.get("DOVETAIL_SANITIZED") == "1"
SLOW_DISK = os.environ.get("DOVETAIL_SLOW_DISK", "")  # to be preloaded; a sanitizer lets nothing be loaded before it
CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
TIMEOUT_S = 120
PROGRESS = re.compile(r"dovetail: \w+, [^;]* gone(,|$)")


def slow_disk(bytes_a_second):
    """For a `with` statement: runs read and write no faster than that, unless a sanitizer stands in the way."""
    settings = {"LD_PRELOAD": SLOW_DISK, "DOVETAIL_TEST_DISK": str(bytes_a_second)} if SLOW_DISK else {}
    return unittest.mock.patch.dict(os.environ, settings)


class Run:
    """What a run of the command left: exit code, standard output and error without mpirun's own words."""

    def __init__(self, arguments, ranks, completed):
        self.arguments = arguments
        self.ranks = ranks
        self.code = completed.returncode
        self.out = completed.stdout
        self.err = completed.stderr

    @property
    def messages(self):
        """The command's own lines on standard error but those of its progress, which a slow machine sees."""
        lines = self.err.replace("\x1b[K", "").splitlines()
        return [line for line in lines if line.startswith("dovetail: ") and not PROGRESS.match(line)]

    def __str__(self):
        return (
            f"dovetail {' '.join(map(str, self.arguments))}\non {self.ranks or 'no'} ranks of mpirun: exit code {self.code}"
            f"\n--- standard output\n{self.out}\n--- standard error\n{self.err}"
        )


def dovetail(
    *arguments, ranks=0, file_limit=None, memory_limit=None, unprivileged=False, cwd=None, timeout=TIMEOUT_S,
    stdout=subprocess.PIPE
):
    """Runs the command on `ranks` ranks of mpirun, or without mpirun for 0. No file may grow beyond `file_limit`
    bytes, and no process beyond `memory_limit`. `unprivileged`: file permissions hold, even for root."""
    command = [COMMAND, *map(str, arguments)]
    if ranks:
        command = [MPIEXEC, "-n", str(ranks), *command]
    if unprivileged and os.geteuid() == 0:
        command = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", *command]

    def limit():
        if file_limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_limit, file_limit))
        if memory_limit is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory_limit, memory_limit))

    completed = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        timeout=timeout,
        preexec_fn=limit,
        cwd=cwd,
    )
    return Run(arguments, ranks, completed)


def data_file(name):
    """A real input, or None where the data is absent; under DOVETAIL_FULL=1 it must be there."""
    folder = pathlib.Path(os.environ.get("DOVETAIL_DATA") or CHECKOUT.parent / "shared" / "data")
    path = folder / name
    if path.is_file():
        return path
    if FULL:
        raise AssertionError(f"{path} is absent; set DOVETAIL_DATA")
    return None


def write_f64(path, points):
    """A raw little-endian file of coordinate pairs."""
    import array

    values = array.array("d", (c for point in points for c in point))
    if sys.byteorder == "big":
        values.byteswap()
    path.write_bytes(values.tobytes())


def write_las(path, n=500, side=25):
    """LAS 1.2, point format 0: ground and water (classes 2 and 9) in turns on a grid of whole metres."""
    header = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I12d", b"LASF", 0, 0, 0, 0, 0, bytes(8), 1, 2, bytes(32), bytes(32),
                         1, 2026, 227, 227, 0, 0, 20, n, n, 0, 0, 0, 0, 0.01, 0.01, 0.01, 0, 0, 0,
                         side - 1, 0, n // side - 1, 0, 8, 0)
    assert len(header) == 227
    records = (struct.pack("<3iHBBbBH", 100 * (i % side), 100 * (i // side), 100 * (i % 9), 0, 0, 2 if i % 2 else 9, 0, 0, 0)
               for i in range(n))
    path.write_bytes(header + b"".join(records))


class TestCase(unittest.TestCase):
    """A test with a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dovetail-test-"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def succeed(self, *arguments, **how):
        run = dovetail(*arguments, **how)
        self.assertEqual(run.code, 0, run)
        return run

    def report_of(self, *arguments, **how):
        """The JSON report of a run that succeeds; the run is in its "run"."""
        path = self.folder / f"{uuid.uuid4()}.json"
        run = self.succeed(*arguments, "--report", path, **how)
        report = json.loads(path.read_text())
        path.unlink()
        report["run"] = run
        return report

    def leftovers(self, folder=None):
        """Files that were written aside and never removed."""
        return sorted(str(p) for p in (folder or self.folder).rglob("*.partial*"))


class Result(unittest.TextTestResult):
    """Says SKIPPED in the way GoogleTest does, so that tools/test finds all of it."""

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        name = re.sub(r"^__main__", pathlib.Path(sys.argv[0]).stem, test.id())
        self.stream.writeln(f"\n[  SKIPPED ] {name} ({reason})")


def main():
    unittest.main(testRunner=unittest.TextTestRunner(resultclass=Result, verbosity=2))
