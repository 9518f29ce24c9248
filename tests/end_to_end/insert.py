"""A mesh that grows is the mesh of all points: checksum, bytes for every number of ranks, verification beside all
inputs; and what cannot be inserted, or inserted into, is refused in words."""

import hashlib
import random
import shutil
import unittest

import h5py
import numpy

import harness
from harness import write_f64

RANKS = (0, 1, 2, 3, 5, 8) if harness.FULL else (0, 3)


class Insert(harness.TestCase):
    def generate(self, distribution, count, seed, name=None):
        path = self.folder / (name or f"{distribution}.{count}.{seed}.npy")
        self.succeed("generate", distribution, "-n", count, "--seed", seed, "-o", path, "--quiet")
        return path

    def mesh_of(self, *points, slabs=5, options=(), name="mesh.vtkhdf"):
        mesh = self.folder / name
        self.succeed("triangulate", *points, "-o", mesh, "--slabs", slabs, *options, "--quiet")
        return mesh

    def check(self, old, new, *options, slabs=5, old_options=()):
        """Inserts on all numbers of ranks; the report of the last."""
        mesh = self.mesh_of(old, slabs=slabs, options=old_options)
        anew = self.report_of("triangulate", old, new, "-o", "none", *old_options, *options)
        digests = set()
        for ranks in RANKS:
            grown = self.folder / f"grown.{ranks}.vtkhdf"
            report = self.report_of("insert", mesh, new, "-o", grown, *options, ranks=ranks)
            digests.add(hashlib.sha256(grown.read_bytes()).hexdigest())
            for key in ("checksum", "points", "sites", "duplicates", "triangles", "hull_edges"):
                self.assertEqual(report[key], anew[key], key)
        self.assertEqual(len(digests), 1)
        verdict = self.report_of("verify", grown, "--points", old, new)
        self.assertIs(verdict["valid"], True)
        self.assertEqual(self.leftovers(), [])
        return report

    def test_uniform_points(self):
        old, new = self.generate("uniform", 20000, 1), self.generate("uniform", 500, 2)
        report = self.check(old, new)
        self.assertEqual(report["inserted_points"], 500)
        self.assertEqual(report["changed_slabs"], 5)
        names = [phase["name"] for phase in report["phases"]]
        self.assertEqual(names, ["read", "place", "paths", "insert", "stitch", "write"])

    def test_heights_and_duplicates(self):
        old = self.generate("lidar", 8000, 1)
        for rule in ("first", "lowest", "highest") if harness.FULL else ("lowest",):
            # The same points again, and others between them.
            both = self.folder / "both.npy"
            numpy.save(both, numpy.concatenate([numpy.load(old)[::3] + [0, 0, 0.5], numpy.load(old)[::5] + [0.25, 0, -1]]))
            self.check(old, both, "--duplicates", rule, old_options=("--axis", "y"))

    def test_far_outside(self):
        old, new = self.generate("kuzmin", 5000, 1), self.folder / "far.f64"
        write_f64(new, [(1e9, 1e9), (-1e150, 3.0), (0.0, -1e9), (5.0, 1e-9)])
        self.check(old, new)

    def test_into_few_and_none(self):
        row = [(float(i), 2.0 * i) for i in range(9)]
        random.Random(1).shuffle(row)
        cases = (([], row), (row, [(3.0, 3.0)]), (row[:4], row[4:]), ([], []), (row, row))
        for count, (old, new) in enumerate(cases if harness.FULL else cases[:2]):
            paths = self.folder / f"old.{count}.f64", self.folder / f"new.{count}.f64"
            write_f64(paths[0], old)
            write_f64(paths[1], new)
            self.check(*paths, slabs=3)

    def test_slabs_that_nothing_comes_to(self):
        old, new = self.generate("uniform", 20000, 1), self.folder / "one.f64"
        write_f64(new, [(0.1001, 0.5002)])
        self.assertEqual(self.check(old, new, slabs=4)["changed_slabs"], 1)

    def test_uneven_slabs_are_noticed(self):
        old, new = self.generate("uniform", 20000, 1), self.folder / "crowd.npy"
        numpy.save(new, 0.05 + 0.01 * numpy.load(self.generate("uniform", 20000, 2)))
        run = self.succeed("insert", self.mesh_of(old), new, "-o", self.folder / "crowd.vtkhdf")
        self.assertIn("times its share", run.out)

    def test_other_outputs_and_none(self):
        mesh, new = self.mesh_of(self.generate("uniform", 500, 1)), self.generate("uniform", 50, 2)
        self.succeed("insert", mesh, new, "-o", self.folder / "grown.ply", ranks=2)
        run = self.succeed("insert", mesh, new, "-o", "none", ranks=2)
        self.assertIn("valid, in exact arithmetic", run.out)
        self.assertEqual(self.succeed("insert", mesh, new, "-o", "none", "--quiet").out, "")


class Refusals(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points, cls.mesh = cls.folder / "points.npy", cls.folder / "mesh.vtkhdf"
        for arguments in (("generate", "uniform", "-n", 3000, "--seed", 1, "-o", cls.points),
                          ("triangulate", cls.points, "-o", cls.mesh, "--slabs", 4)):
            assert harness.dovetail(*arguments).code == 0

    def refuse(self, *arguments, code=1, words="", ranks=0):
        output = self.folder / "refused.vtkhdf"
        run = harness.dovetail("insert", *arguments, "-o", output, ranks=ranks)
        self.assertEqual(run.code, code, run)
        self.assertEqual(len(run.messages), 1, run)
        self.assertIn(words, run.messages[0], run)
        self.assertFalse(output.exists(), run)
        self.assertEqual(self.leftovers(), [])

    def changed(self, change):
        """A copy of the mesh's file that `change` has been at."""
        copy = self.folder / "changed.vtkhdf"
        shutil.copyfile(self.mesh, copy)
        with h5py.File(copy, "r+") as file:
            change(file)
        return copy

    def test_inputs(self):
        self.refuse(self.points, self.points, words="HDF5")
        self.refuse(self.folder / "absent.vtkhdf", self.points)
        self.refuse(self.mesh, self.folder / "absent.npy")
        broken = self.folder / "nan.f64"
        write_f64(broken, [(1.0, 2.0), (float("nan"), 0.0)])
        self.refuse(self.mesh, broken, ranks=2)
        truncated = self.folder / "truncated.vtkhdf"
        truncated.write_bytes(self.mesh.read_bytes()[:-100000])
        self.refuse(truncated, self.points)
        self.refuse(self.mesh, self.points, "--duplicates", "error", words="point 0:", ranks=3)

    def test_output_is_input(self):
        before = self.mesh.read_bytes()
        run = harness.dovetail("insert", self.mesh, self.points, "-o", self.mesh)
        self.assertEqual(run.code, 2, run)
        self.assertEqual(self.mesh.read_bytes(), before)

    def test_meshes_that_are_not_right(self):
        def newer(file):
            file["dovetail"].attrs["format_version"] = 99

        def beyond(file):
            file["VTKHDF/Connectivity"][7] = 2**30

        def foreign(file):
            del file["dovetail"]

        def strange_line(file):
            file["dovetail/lines"][1] = file["dovetail/lines"][1] + 0.2

        def turned(file):
            corners = file["VTKHDF/Connectivity"][:].reshape(-1, 3)
            file["VTKHDF/Connectivity"][:] = corners[:, [0, 2, 1]].reshape(-1)

        def moved(file):
            points = file["VTKHDF/Points"][:]
            points[:, 1] = points[::-1, 1]
            file["VTKHDF/Points"][:] = points

        def last_index(file):
            file["VTKHDF/PointData/input_index"][0] = 2**63 - 1

        def digest(file):
            file["dovetail"].attrs["digest_points"] = 2**62

        few, many = self.near(250, 0.003), self.near(2000, 0.003)  # inserted, and with slabs made anew
        for change in (newer, beyond, foreign, strange_line, turned, moved, last_index, digest):
            for points in (few, many):
                with self.subTest(change=change.__name__, points=points.name):
                    broken = self.changed(change)
                    self.refuse(broken, points, words=str(broken), ranks=2 if change is moved else 0)

    def test_what_no_point_comes_near_to_is_seen_in_the_end(self):
        """Four points in nine slabs, one triangle of the first twice, and a new point in another slab."""
        points, mesh, more = (self.folder / name for name in ("four.f64", "four.vtkhdf", "fifth.f64"))
        write_f64(points, [(1, 9.2), (3.7, 6.1), (6.7, 9.3), (7.2, 4.1)])
        write_f64(more, [(0.1, 6.3)])
        self.succeed("triangulate", points, "-o", mesh, "--slabs", 9)
        with h5py.File(mesh, "r+") as file:
            file["VTKHDF/Connectivity"][3:6] = file["VTKHDF/Connectivity"][0:3]
        self.refuse(mesh, more, words=f"{mesh}: does not fit together")

    def near(self, count, distance):
        """Points of the mesh, moved a little."""
        path = self.folder / f"near.{count}.npy"
        numpy.save(path, numpy.load(self.points)[:count] + distance)
        return path


if __name__ == "__main__":
    harness.main()
