"""Ctrl-C and its kin in every stage, without mpirun and on three ranks: nothing under the final name, nothing aside,
one line from one rank, a non-zero exit code, and all that soon.

The stages are found by bisection: the line says which one the signal met, and the next signal comes earlier or later.
Whatever stage it meets, the run must end well.
"""

import json
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest
import unittest.mock

import harness
from harness import COMMAND, FULL, MPIEXEC, SLOW_DISK

POINTS = 1_000_000 if FULL else 300_000
SOON_S = 2  # mpirun itself takes one second to kill what it has asked to end
ATTEMPTS = 40  # a loaded machine changes its speed from run to run
SLOW_BYTES_A_SECOND = 50e6
LINE = re.compile(r"dovetail: interrupted(?: during (\w+))?; (.*)")


class Interrupted:
    """A run that was sent `sent` after `delay` seconds, or as soon as the file `once` is there: to the process that
    was started, or to the ranks `only`."""

    def __init__(self, arguments, ranks, delay, sent=signal.SIGTERM, only=None, once=None):
        command = [COMMAND, *map(str, arguments)]
        if ranks:
            command = [MPIEXEC, "-n", str(ranks), *command]
        when = f"once {once} is there" if once else f"after {delay:.2f} s"
        self.described = f"{command} {signal.Signals(sent).name} {when}"
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        if once is None:
            time.sleep(delay)
        else:
            while process.poll() is None and not once.exists():
                time.sleep(0.001)
        if only is None:
            process.send_signal(sent)
        else:
            children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            for pid in [children[rank] for rank in only if rank < len(children)]:
                os.kill(int(pid), sent)
        sent_at = time.monotonic()
        try:
            self.out, self.err = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            raise AssertionError(f"hangs: {self.described}")
        self.took = time.monotonic() - sent_at
        self.code = process.returncode
        self.lines = LINE.findall(self.err)
        self.stage = self.lines[0][0] if self.lines else None

    def __str__(self):
        return f"{self.described}: exit code {self.code} {self.took:.2f} s later\n{self.out}\n{self.err}"


class Interrupts(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points = cls.folder / "points.f64"
        cls.mesh = cls.folder / "mesh.vtkhdf"
        for arguments in (
            ("generate", "circle" if FULL else "kuzmin", "-n", POINTS, "-o", cls.points),
            ("triangulate", cls.points, "-o", cls.mesh),
        ):
            made = harness.dovetail(*arguments, "--quiet")
            assert made.code == 0, made

    def check(self, run, output):
        """Whether the signal met a run under way; `output` is removed."""
        there = output is not None and output.exists()
        self.assertEqual(self.leftovers(), [], run)
        self.assertLessEqual(len(run.lines), 1, run)
        if there:
            output.unlink()
        if run.code == 0 or (not run.lines and (there or run.out)):
            return False  # too late
        self.assertNotEqual(run.code, 0, run)
        # Open MPI's mpiexec now and then falls over its own end when the ranks are long gone.
        said = re.sub(r"(?m)^\[[^\]]*:\d+\] .*$", "", run.err) if "PMIx_server_finalize" in run.err else run.err
        for noise in ("terminate called", "MPI_ABORT", "Aborted", "Segmentation", "unexpected"):
            self.assertNotIn(noise, said, run)
        if not there:
            self.assertEqual(run.out, "", run)
        if run.lines:
            self.assertEqual(run.lines[0][1], f"{output} had been written" if there else "nothing was written", run)
            self.assertLess(run.took, SOON_S, run)
        return True

    def usual_times(self, arguments, ranks, stages):
        """When each stage begins and ends in a run that is let alone."""
        path = self.folder / "times.json"
        began = time.monotonic()
        run = harness.dovetail(*arguments, "--report", path, "--quiet", ranks=ranks)
        self.assertEqual(run.code, 0, run)
        took = time.monotonic() - began
        report = json.loads(path.read_text())
        path.unlink()
        lengths = {phase["name"]: phase["wall_max_s"] or 0 for phase in report["phases"]}
        # The longest rank of each stage: together they may be longer than the run.
        now = max(0, report["wall_s"] - sum(lengths.values())) + max(0, took - report["wall_s"]) / 2
        times = {}
        for stage in stages:
            times[stage] = now + lengths[stage] / 2
            now += lengths[stage]
        return times, took

    def interrupt_in(self, wanted, arguments, output, stages, ranks):
        """Interrupts in each of the stages `wanted` of a run whose stages are `stages`."""
        times, took = self.usual_times(arguments, ranks, stages)
        met = set()
        if output is not None:
            output.unlink()
        for stage in wanted:
            earliest, latest, delay = 0, 2 * took, times[stage]
            for attempt in range(ATTEMPTS):
                if stage in met:
                    break
                # mpirun would pass it on a second later.
                run = Interrupted(
                    arguments,
                    ranks,
                    delay,
                    only=range(ranks) if ranks else None,
                    once=output.with_name(output.name + ".partial") if stage == "write" else None,
                )
                under_way = self.check(run, output)
                met.add(run.stage)
                if under_way and (not run.stage or stages.index(run.stage) < stages.index(stage)):
                    earliest = delay
                else:
                    latest = delay
                if latest - earliest < 0.01:
                    earliest, latest = max(0, earliest - 0.3), latest + 0.3  # the machine has changed its speed
                delay = (earliest + latest) / 2
        self.assertLessEqual(set(wanted), met, f"{ranks} ranks")

    def interrupt_while_written(self, arguments, output, ranks, sent=signal.SIGTERM):
        """Slabs are written as they are made, to a file that is there before its contents. Those take most of a
        second, so that a loaded machine is not too late."""
        partial = output.with_name(output.name + ".partial")
        with harness.slow_disk(SLOW_BYTES_A_SECOND):
            run = Interrupted(arguments, ranks, 0, sent, only=range(ranks) if ranks else None, once=partial)
        self.assertTrue(self.check(run, output), run)
        return run

    def test_triangulate(self):
        output = self.folder / "output.vtkhdf"
        stages = ["read", "sort", "split", "triangulate", "stitch", "write"]
        wanted = stages[:-1] if FULL else ["triangulate"]  # what is called write here is over in an instant
        for ranks in (0, 3):
            with self.subTest(ranks=ranks):
                arguments = ["triangulate", self.points, "-o", output, "--slabs", "3"]
                # Without mpirun one slab would do, and its stages split and stitch would be empty.
                self.interrupt_in(wanted, arguments, output, stages, ranks)
                self.interrupt_while_written(arguments, output, ranks)

    @unittest.skipUnless(SLOW_DISK, "a sanitizer does not let anything be loaded before it")
    def test_what_was_removed_does_not_come_back(self):
        output = self.folder / "output.vtkhdf"
        partial = output.with_name(output.name + ".partial")
        # Between the file's first appearance and its first contents there is time for the signal, and after its
        # removal time to make it again.
        with unittest.mock.patch.dict(os.environ, LD_PRELOAD=SLOW_DISK, DOVETAIL_TEST_REMOVAL="0.03"):
            run = Interrupted(["triangulate", self.points, "-o", output], 0, 0, once=partial)
        self.assertTrue(self.check(run, output), run)

    def test_triangulate_to_check(self):
        arguments = ["triangulate", self.points, "-o", "none"]
        self.interrupt_in(["check"], arguments, None, ["read", "sort", "split", "triangulate", "stitch", "check"], 3)

    def test_verify(self):
        for ranks in (0, 3) if FULL else (3,):
            with self.subTest(ranks=ranks):
                self.interrupt_in(["check"], ["verify", self.mesh], None, ["read", "check"], ranks)

    def test_generate(self):
        output = self.folder / "generated.npy"
        arguments = ["generate", "kuzmin", "-n", 10 * POINTS, "-o", output]
        for ranks in (0, 3) if FULL else (3,):
            with self.subTest(ranks=ranks):
                self.interrupt_in(["generate", "write"], arguments, output, ["generate", "write"], ranks)

    def test_mpirun_passes_it_on(self):
        output = self.folder / "passed_on.npy"
        for delay in (0.1, 0.3, 0.5, 0.7, 0.9):
            with self.subTest(delay=delay):
                run = Interrupted(["generate", "kuzmin", "-n", 20 * POINTS, "-o", output], 3, delay)
                self.check(run, output)

    def test_one_rank_alone_ends_all(self):
        output = self.folder / "alone.vtkhdf"
        arguments = ["triangulate", self.points, "-o", output]
        times, _ = self.usual_times(arguments, 3, ["read", "sort", "split", "triangulate", "stitch", "write"])
        output.unlink()
        for rank in (0, 1, 2):
            with self.subTest(rank=rank):
                run = Interrupted(arguments, 3, times["triangulate"], only=[rank])
                self.check(run, output)

    def test_dies_of_the_signal(self):
        output = self.folder / "signals.vtkhdf"
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=sent):
                run = self.interrupt_while_written(["triangulate", self.points, "-o", output], output, 0, sent)
                self.assertEqual(len(run.lines), 1, run)
                self.assertEqual(run.code, -sent, run)

    def test_an_ignored_signal_stays_ignored(self):
        output = self.folder / "ignored.vtkhdf"
        process = subprocess.Popen(
            [COMMAND, "triangulate", str(self.points), "-o", str(output), "--quiet"],
            stdin=subprocess.DEVNULL,
            preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
        )
        while process.poll() is None:
            process.send_signal(signal.SIGHUP)
            time.sleep(0.05)
        self.assertEqual(process.returncode, 0)
        self.assertTrue(output.exists())

    def test_older_output_stays(self):
        output = self.folder / "older.vtkhdf"
        arguments = ["triangulate", self.points, "-o", output]
        times, _ = self.usual_times(arguments, 0, ["read", "sort", "split", "triangulate"])
        output.write_bytes(b"older")
        run = Interrupted(arguments, 0, times["triangulate"])
        if run.code != 0 and run.lines:
            self.assertEqual(output.read_bytes(), b"older", run)
        self.assertEqual(self.leftovers(), [], run)


if __name__ == "__main__":
    harness.main()
