"""Synthetic points: the same bytes for every number of ranks, as NumPy reads them."""

import struct
import unittest

import harness

DISTRIBUTIONS = ("uniform", "normal", "kuzmin", "line", "lattice", "circle", "lidar", "clusters")


class Generate(harness.TestCase):
    def test_same_bytes_for_every_number_of_ranks(self):
        for distribution in DISTRIBUTIONS:
            with self.subTest(distribution=distribution):
                files = set()
                for ranks in (0, 3, 5) if harness.FULL else (0, 3):
                    path = self.folder / f"{distribution}.npy"
                    self.succeed("generate", distribution, "-n", "1001", "--seed", "7", "-o", path, ranks=ranks)
                    files.add(path.read_bytes())
                self.assertEqual(len(files), 1)
                columns = 3 if distribution == "lidar" else 2
                content = files.pop()
                self.assertIn(f"(1001, {columns})".encode(), content[:128])
                self.assertEqual(len(content) % 64, 1001 * columns * 8 % 64)

    def test_seed_and_number_matter(self):
        def made(*arguments):
            path = self.folder / "some.f64"
            self.succeed("generate", *arguments, "-o", path, "--quiet")
            return path.read_bytes()

        first = made("uniform", "-n", "100", "--seed", "1")
        self.assertEqual(first, made("uniform", "-n", "1e2", "--seed", "1"))
        self.assertNotEqual(first, made("uniform", "-n", "100", "--seed", "2"))
        self.assertEqual(len(first), 1600)

    def test_few_points(self):
        for count in (0, 1, 2):
            path = self.folder / f"few{count}.f64"
            self.succeed("generate", "normal", "-n", count, "--seed", 1, "-o", path, ranks=3)
            self.assertEqual(path.stat().st_size, 16 * count)

    def test_capital_extensions(self):
        points, mesh = self.folder / "P.NPY", self.folder / "M.VTKHDF"
        self.succeed("generate", "normal", "-n", "10", "-o", points)
        self.succeed("triangulate", points, "-o", mesh)
        self.succeed("verify", mesh, "--points", points)
        self.assertRegex(self.succeed("info", mesh).out, r"sites +10\n")

    def test_lattice_is_whole(self):
        path = self.folder / "lattice.f64"
        self.succeed("generate", "lattice", "-n", "90", "--seed", "3", "-o", path)
        values = struct.unpack("<180d", path.read_bytes())
        points = set(zip(values[::2], values[1::2]))
        self.assertEqual(points, {(float(i % 10), float(i // 10)) for i in range(90)})

    def test_quiet_and_loud(self):
        path = self.folder / "loud.npy"
        run = self.succeed("generate", "uniform", "-n", "1234567", "-o", path, ranks=2)
        self.assertIn("1,234,567", run.out)
        self.assertEqual(run.out.count("\n"), 3, run)
        self.assertEqual(self.succeed("generate", "uniform", "-n", "10", "-o", path, "--quiet").out, "")


if __name__ == "__main__":
    harness.main()
