"""For a given number of slabs the mesh file has the same bytes for every number of ranks; and the checksum is one
for every number of slabs, either axis, and any order of the input. (Every combination in process: tests/mpi/matrix.)"""

import array
import hashlib
import random
import unittest

import harness

RANKS = (0, 1, 2, 3, 4, 5, 8) if harness.FULL else (0, 3, 8)


def shuffled(path, target):
    """The same points in another order."""
    values = array.array("d", path.read_bytes())
    pairs = list(zip(values[::2], values[1::2]))
    random.Random(1).shuffle(pairs)
    harness.write_f64(target, pairs)


class SameBytes(harness.TestCase):
    def check(self, distribution, count, *options):
        path = self.folder / f"{distribution}.npy"
        self.succeed("generate", distribution, "-n", count, "--seed", 3, "-o", path, "--quiet")
        digests, checksums = set(), set()
        for ranks in RANKS:
            mesh = self.folder / f"{distribution}.{ranks}.vtkhdf"
            report = self.report_of("triangulate", path, "-o", mesh, *options, ranks=ranks)
            digests.add(hashlib.sha256(mesh.read_bytes()).hexdigest())
            checksums.add(report["checksum"])
        self.assertEqual(len(digests), 1)
        self.assertEqual(len(checksums), 1)
        self.assertIs(self.report_of("verify", mesh, "--points", path, ranks=2)["valid"], True)
        return checksums.pop()

    def test_uniform(self):
        first = self.check("uniform", 50000, "--slabs", 7)
        self.assertEqual(self.check("uniform", 50000, "--slabs", 5, "--axis", "y"), first)

    def test_duplicates_and_heights(self):
        self.check("lidar", 100000, "--slabs", 16, "--duplicates", "lowest")

    def test_lattice(self):
        self.check("lattice", 10000, "--slabs", 3, "--axis", "y")

    def test_order_of_input_and_of_slabs(self):
        path, other = self.folder / "points.f64", self.folder / "shuffled.f64"
        self.succeed("generate", "clusters", "-n", 20000, "--seed", 4, "-o", path, "--quiet")
        shuffled(path, other)
        one = self.report_of("triangulate", path, "-o", "none", ranks=3)
        two = self.report_of("triangulate", other, "-o", "none", "--slabs", 11, "--axis", "y", ranks=2)
        self.assertEqual(one["checksum"], two["checksum"])

    def test_several_files_are_one_input(self):
        whole, first, second = (self.folder / name for name in ("whole.f64", "first.f64", "second.f64"))
        self.succeed("generate", "normal", "-n", 3001, "--seed", 5, "-o", whole, "--quiet")
        content = whole.read_bytes()
        first.write_bytes(content[: 16 * 1000])
        second.write_bytes(content[16 * 1000 :])
        one, two = self.folder / "one.vtkhdf", self.folder / "two.vtkhdf"
        self.succeed("triangulate", whole, "-o", one, "--slabs", 2, ranks=2)
        self.succeed("triangulate", first, second, "-o", two, "--slabs", 2, ranks=3)
        self.assertEqual(one.read_bytes(), two.read_bytes())
        self.succeed("verify", two, "--points", first, second)
        swapped = harness.dovetail("verify", two, "--points", second, first)
        self.assertEqual(swapped.code, 1, swapped)

    def test_presorted(self):
        path = self.folder / "sorted.f64"
        harness.write_f64(path, [(float(i // 50), float(i % 50)) for i in range(2500)])
        one = self.report_of("triangulate", path, "-o", "none", "--presorted", ranks=3)
        two = self.report_of("triangulate", path, "-o", "none", ranks=2)
        self.assertEqual((one["checksum"], one["axis"]), (two["checksum"], "x"))


if __name__ == "__main__":
    harness.main()
