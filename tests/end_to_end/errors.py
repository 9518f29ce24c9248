"""Every error a user can cause: one message that names the file, place and remedy, alike on one rank and three.

No hang (every run is under a timeout), the same exit code everywhere, nothing under the final name, nothing
written aside left over.
"""

import concurrent.futures
import os
import pathlib
import shutil
import struct
import unittest

import harness
from harness import dovetail, write_f64

FAILURE, USAGE = 1, 2
# Without mpirun, and under it.
RANKS = (0, 1, 3) if harness.FULL else (0, 3)
# Open MPI's shared memory is made of files too, so the limit must leave room for those (some MiB a rank).
FILE_LIMIT = 12 << 20


def npy_header(shape, dtype="<f8"):
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}"
    text += " " * (-(10 + len(text) + 1) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


class Errors(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.background = concurrent.futures.ThreadPoolExecutor(4)
        cls.addClassCleanup(cls.background.shutdown)
        cls.good = cls.folder / "good.npy"
        made = dovetail("generate", "uniform", "-n", "2000", "--seed", "1", "-o", cls.good, "--quiet")
        assert made.code == 0, made
        cls.mesh = cls.folder / "good.vtkhdf"
        made = dovetail("triangulate", cls.good, "-o", cls.mesh, "--quiet", "--slabs", "3")
        assert made.code == 0, made
        cls.output = cls.folder / "output.vtkhdf"

    def refused(self, *arguments, code=FAILURE, names=None, says=(), absent=None, ranks=RANKS, **how):
        """The run fails with `code` and one message that contains `names` and each of `says`; `absent` is not
        there afterwards. Runs in the background until finish_refusals(), at the latest at the end of the test:
        most of a run that fails at once is the start of MPI, which is mostly waiting."""
        for count in ranks:
            run = self.background.submit(dovetail, *arguments, ranks=count, timeout=60, **how)
            self.started.append((run, code, [str(names)] * (names is not None) + list(says), absent or self.output))

    def setUp(self):
        self.started = []

    def tearDown(self):
        self.finish_refusals()

    def finish_refusals(self):
        runs = [(run.result(), *expected) for run, *expected in self.started]
        self.started = []
        for run, code, texts, absent in runs:
            with self.subTest(arguments=list(map(str, run.arguments)), ranks=run.ranks):
                self.assertEqual(run.code, code, run)
                self.assertEqual(len(run.messages), 1, run)
                for text in texts:
                    self.assertIn(text, run.messages[0], run)
                for noise in ("terminate called", "MPI_ABORT", "Aborted", "HDF5-DIAG", "Segmentation"):
                    self.assertNotIn(noise, run.err, run)
                self.assertFalse(os.path.lexists(absent), run)
                self.assertEqual(self.leftovers(), [], run)

    def triangulate_refuses(self, path, *says, **how):
        self.refused("triangulate", path, "-o", self.output, names=path, says=says, **how)

    # Inputs

    def test_missing_input(self):
        self.triangulate_refuses(self.folder / "missing.npy")
        self.refused("verify", self.folder / "missing.vtkhdf", names=self.folder / "missing.vtkhdf")
        self.refused("info", self.folder / "missing.las", names=self.folder / "missing.las")

    def test_second_input_missing(self):
        missing = self.folder / "missing.f64"
        self.refused("triangulate", self.good, missing, "-o", self.output, names=missing)

    def test_folder_as_input(self):
        for name in ("folder.npy", "folder.f64", "folder.las"):
            folder = self.folder / name
            folder.mkdir()
            self.triangulate_refuses(folder)
        folder = self.folder / "folder.vtkhdf"
        folder.mkdir()
        self.refused("verify", folder, names=folder)

    def test_unknown_extension(self):
        for name in ("points.pts", "points", "points.npy.gz"):
            path = self.folder / name
            path.write_bytes(b"0 0\n1 1\n")
            self.triangulate_refuses(path, ".npy", ".las", ".f64", ".csv", ".node")

    def test_domain_for_points(self):
        for name in ("land.poly", "land.geojson"):
            self.triangulate_refuses(self.folder / name, "dovetail constrain")

    def test_compressed_las(self):
        path = self.folder / "points.laz"
        path.write_bytes(b"LASF" + bytes(1000))
        self.triangulate_refuses(path, "las")

    def test_truncated(self):
        cut = self.folder / "cut.npy"
        cut.write_bytes(self.good.read_bytes()[:-9])
        self.triangulate_refuses(cut)
        cut = self.folder / "cut_header.npy"
        cut.write_bytes(self.good.read_bytes()[:40])
        self.triangulate_refuses(cut)
        cut = self.folder / "cut.f64"
        cut.write_bytes(bytes(16 * 10 + 8))
        self.triangulate_refuses(cut)

    def test_truncated_las(self):
        las = harness.data_file("autzen_trim.las")
        if las is None:
            self.skipTest("autzen_trim.las is absent")
        for name, size in (("cut.las", 2_000_001), ("cut_header.las", 100)):
            cut = self.folder / name
            cut.write_bytes(las.read_bytes()[:size])
            self.triangulate_refuses(cut)

    def test_malformed(self):
        for name, content in (
            ("magic.npy", b"not numpy at all" * 10),
            ("shape.npy", npy_header("(4, 1)") + bytes(32)),
            ("flat.npy", npy_header("(8,)") + bytes(64)),
            ("type.npy", npy_header("(4, 2)", "<i8") + bytes(64)),
            ("magic.las", b"FSAL" + bytes(1000)),
        ):
            path = self.folder / name
            path.write_bytes(content)
            self.triangulate_refuses(path)

    def test_empty_file(self):
        for name in ("empty.npy", "empty.las"):
            path = self.folder / name
            path.write_bytes(b"")
            self.triangulate_refuses(path)

    def test_not_finite(self):
        for name, bad in (("nan", float("nan")), ("infinite", float("inf")), ("negative", float("-inf"))):
            points = [(i * 0.25, (i * 7) % 11) for i in range(1000)]
            points[777] = (777.0, bad)
            path = self.folder / f"{name}.f64"
            write_f64(path, points)
            self.triangulate_refuses(path, "777")
            path = self.folder / f"{name}.npy"
            path.write_bytes(npy_header("(1000, 2)") + (self.folder / f"{name}.f64").read_bytes())
            self.triangulate_refuses(path, "777")

    def test_text(self):
        for name, content, *says in (
            ("bad.xyz", "1 2\n# c\n3 four\n", "line 3, character 3", "'four'"),
            ("short.csv", "x,y,z\n1,2,3\n4,5\n", "line 3, character 4", "too few columns"),
            ("nan.txt", "1 2\n3 nan\n", "line 2, character 3", "NaN"),
            ("infinite.txt", "1 2\n-inf 3\n", "line 2, character 1", "infinite"),
            ("comma.csv", "1,5;2,5\n", "line 1, character 1", "decimal commas"),
            ("cut.node", "3 2 0 0\n1 0 0\n2 1 1\n", "line 4", "2 of the 3 vertices"),
            ("gap.node", "3 2 0 0\n1 0 0\n3 1 1\n4 2 2\n", "line 3, character 1", "2 is due"),
            ("empty.node", "", "empty"),
            ("binary.txt", bytes(100).decode(), "not text"),
        ):
            path = self.folder / name
            path.write_text(content)
            self.triangulate_refuses(path, *says)
        secret = self.folder / "secret.csv"
        secret.write_text("1,2\n")
        secret.chmod(0)
        self.triangulate_refuses(secret, unprivileged=True)
        self.triangulate_refuses(self.folder / "missing.node")

    def test_no_permission_to_read(self):
        path = self.folder / "secret.npy"
        shutil.copy(self.good, path)
        path.chmod(0)
        self.triangulate_refuses(path, unprivileged=True)

    # Outputs

    def test_unknown_output(self):
        output = self.folder / "output.stl"
        self.refused("triangulate", self.good, "-o", output, code=USAGE, names=output, says=[".vtkhdf"], absent=output)
        output = self.folder / "output.las"
        self.refused("generate", "uniform", "-n", 10, "-o", output, code=USAGE, names=output, says=[".npy"], absent=output)
        output = self.folder / "points_as_mesh.vtkhdf"
        self.refused("convert", self.good, output, code=USAGE, names=output, says=["dovetail triangulate"], absent=output)
        output = self.folder / "no_extension"
        self.refused("convert", self.good, output, code=USAGE, names=output, says=[".npy"], absent=output)

    def test_output_folder_missing(self):
        output = self.folder / "nowhere" / "output.vtkhdf"
        # Known before anything is read: the input is missing as well, and nobody gets that far.
        self.refused("triangulate", self.folder / "missing.npy", "-o", output, names=output, absent=output.parent)
        output = self.folder / "nowhere" / "points.npy"
        self.refused("generate", "uniform", "-n", 10, "-o", output, names=output, absent=output.parent)

    def test_output_is_folder(self):
        output = self.folder / "a_folder.vtkhdf"
        output.mkdir()
        self.refused("triangulate", self.good, "-o", output, names=output, absent=self.output)

    def test_output_is_input(self):
        before = self.mesh.read_bytes()
        self.refused("triangulate", self.mesh, "-o", self.mesh, code=USAGE, names=self.mesh)
        link = self.folder / "link.vtkhdf"
        link.symlink_to(self.mesh)
        self.refused("triangulate", link, "-o", self.mesh, code=USAGE, names=self.mesh)
        self.finish_refusals()
        self.assertEqual(self.mesh.read_bytes(), before)

    def test_no_permission_to_write(self):
        folder = self.folder / "locked"
        folder.mkdir()
        folder.chmod(0o555)
        self.refused("triangulate", self.good, "-o", folder / "output.vtkhdf", names=folder / "output.vtkhdf",
                     unprivileged=True)

    def test_read_only_file_is_kept(self):
        kept = self.folder / "kept.vtkhdf"
        kept.write_bytes(b"kept")
        kept.chmod(0o444)
        self.refused("triangulate", self.good, "-o", kept, names=kept, says=["Permission denied"], unprivileged=True)
        self.finish_refusals()
        self.assertEqual(kept.read_bytes(), b"kept")

    def test_link_to_nowhere(self):
        link = self.folder / "nowhere_link.vtkhdf"
        link.symlink_to(self.folder / "nowhere" / "output.vtkhdf")
        # Known before anything is read.
        self.refused("triangulate", self.folder / "missing.npy", "-o", link, names=link, says=["does not exist"])

    def test_empty_name(self):
        self.refused("triangulate", self.good, "-o", "", code=USAGE, says=["name"])
        self.refused("triangulate", "", "-o", self.output, code=USAGE, says=["empty"])

    def test_standard_input(self):
        self.refused("triangulate", "-", "-o", self.output, code=USAGE, says=["standard input", "file"])
        self.refused("info", "-", code=USAGE, says=["standard input", "file"])

    def test_report_is_the_output_in_other_words(self):
        mesh = self.folder / "both.vtkhdf"
        self.refused("triangulate", self.good, "-o", mesh, "--report", f"{self.folder}/./both.vtkhdf", code=USAGE,
                     says=["both.vtkhdf"], absent=mesh)

    def test_report_folder_missing(self):
        report = self.folder / "nowhere" / "report.json"
        self.refused("triangulate", self.good, "-o", self.output, "--report", report, names=report)
        self.refused("verify", self.mesh, "--report", report, names=report)
        self.refused("triangulate", self.good, "-o", self.output, "--report", self.good, code=USAGE, names=self.good)
        self.refused("triangulate", self.good, "-o", self.output, "--report", self.output, code=USAGE, names=self.output)

    def test_full_disk(self):
        large = self.folder / "large.npy"
        self.succeed("generate", "uniform", "-n", "200000", "--seed", "1", "-o", large, "--quiet")
        self.refused("triangulate", large, "-o", self.output, names=self.output, file_limit=FILE_LIMIT)
        points = self.folder / "too_large.npy"
        self.refused(
            "generate", "uniform", "-n", "2e6", "-o", points, names=points, absent=points, file_limit=FILE_LIMIT
        )
        self.finish_refusals()
        self.output.write_bytes(b"an older file")
        run = dovetail("triangulate", large, "-o", self.output, ranks=1, file_limit=FILE_LIMIT)
        self.assertEqual(run.code, FAILURE, run)
        self.assertEqual(self.output.read_bytes(), b"an older file")
        self.output.unlink()

    # Promises that are not kept

    def test_duplicates_refused(self):
        path = self.folder / "duplicates.f64"
        write_f64(path, [(0, 0), (1, 0), (0, 1), (1, 0), (2, 2)])
        self.refused("triangulate", path, "-o", self.output, "--duplicates", "error", says=["--duplicates"])

    def test_not_presorted(self):
        path = self.folder / "unsorted.f64"
        write_f64(path, [(i * 7 % 10, i) for i in range(10)])
        self.refused("triangulate", path, "-o", self.output, "--presorted", says=["--presorted"])

    # Meshes

    def test_not_a_mesh(self):
        path = self.folder / "text.vtkhdf"
        path.write_text("not HDF5 at all\n" * 100)
        self.refused("verify", path, names=path)
        self.refused("info", path, names=path)
        path = self.folder / "cut.vtkhdf"
        path.write_bytes(self.mesh.read_bytes()[:-1000])
        self.refused("verify", path, names=path)
        path = self.folder / "empty.vtkhdf"
        path.write_bytes(b"")
        self.refused("verify", path, names=path)

    def test_other_points(self):
        other = self.folder / "other.npy"
        self.succeed("generate", "uniform", "-n", "2000", "--seed", "2", "-o", other, "--quiet")
        # The mesh itself is right, and is not to be called wrong.
        self.refused("verify", self.mesh, "--points", other, names=self.mesh, says=["not the mesh of the points given"])

    def test_broken_mesh(self):
        # Wherever a coordinate of some site stands in the file, moving it must not go unnoticed.
        content = self.mesh.read_bytes()
        x = struct.pack("<d", struct.unpack_from("<d", self.good.read_bytes(), len(self.good.read_bytes()) - 16)[0])
        place = content.find(x)
        self.assertGreater(place, 0)
        path = self.folder / "moved.vtkhdf"
        path.write_bytes(content[:place] + struct.pack("<d", 0.5) + content[place + 8 :])
        self.refused("verify", path, names=path, says=["not valid"])
        run = dovetail("verify", path, "--report", self.folder / "broken.json")
        import json

        self.assertIs(json.loads((self.folder / "broken.json").read_text())["valid"], False, run)
        self.assertRegex(run.err, r"\n  \w+: ")  # the first violations

    # Usage

    def test_usage(self):
        for arguments, says in (
            ((), "subcommand"),
            (("triangel",), "'triangel' among triangulate, "),
            (("--quiet", "info", self.good), "'--quiet' stands before info"),
            # What is misspelt is named, and not the option that is missing because of it.
            (("triangulate", self.good, "--ouput", self.output), "no option '--ouput'"),
            (("verify", self.mesh, self.good), f"'{self.good}' is one argument too many"),
            (("triangulate", self.good, "-o"), "--output needs a value"),
            (("triangulate", self.good, "-o", self.output, "-o", self.output), "--output is given more than once"),
            (("triangulate",), ""),
            (("triangulate", self.good), "--output"),
            (("triangulate", self.good, "-o", self.output, "--axis", "z"), "--axis"),
            (("triangulate", self.good, "-o", self.output, "--slabs", "0"), "--slabs"),
            (("triangulate", self.good, "-o", self.output, "--slabs", "-2"), "--slabs"),
            (("triangulate", self.good, "-o", self.output, "--slabs", "many"), "--slabs"),
            (("triangulate", self.good, "-o", self.output, "--duplicates", "both"), "--duplicates"),
            (("triangulate", self.good, "-o", self.output, "--class", "2,x"), "--class"),
            (("triangulate", self.good, "-o", self.output, "--class", "256"), "--class"),
            (("triangulate", self.good, "-o", self.output, "--wrong"), "--wrong"),
            (("generate", "gaussian", "-n", "10", "-o", self.folder / "x.npy"), "'gaussian' is none of uniform, "),
            (("generate", "uniform", "-n", "10", "--seed", "-1", "-o", self.folder / "x.npy"), "--seed: '-1'"),
            (("generate", "uniform", "-n", "1.5", "-o", self.folder / "x.npy"), "1.5"),
            (("generate", "uniform", "-n", "-5", "-o", self.folder / "x.npy"), "-5"),
            (("generate", "uniform", "-n", "1e30", "-o", self.folder / "x.npy"), "1e30"),
            (("generate", "uniform", "-o", self.folder / "x.npy"), "-n"),
            (("verify",), ""),
            (("info",), ""),
        ):
            self.refused(*arguments, code=USAGE, says=["--help", says], ranks=(0,))
        self.refused("triangulate", self.good, "--wrong", "-o", self.output, code=USAGE, says=["--wrong"])

    def test_name_like_an_option(self):
        path = self.folder / "-points.f64"
        write_f64(path, [(0, 0), (1, 0), (0, 1)])
        self.refused("triangulate", path.name, "-o", self.output, code=USAGE, says=["'./-points.f64'"], cwd=self.folder)
        self.finish_refusals()
        self.succeed("triangulate", "./-points.f64", "-o", "-points.vtkhdf", cwd=self.folder)
        self.succeed("verify", "./-points.vtkhdf", "--points", "./-points.f64", cwd=self.folder)

    def test_lost_standard_output(self):
        full = pathlib.Path("/dev/full")
        if not full.exists():
            self.skipTest("there is no /dev/full")
        with full.open("w") as sink:
            run = dovetail("info", self.mesh, stdout=sink)
        self.assertEqual(run.code, FAILURE, run)
        self.assertEqual(len(run.messages), 1, run)


if __name__ == "__main__":
    harness.main()
