"""Unusual points are answered, not refused: triangulated, written, verified beside their points, described."""

import concurrent.futures
import math
import sys
import unittest

import harness
from harness import write_f64

GREATEST = sys.float_info.max

CASES = {
    # name: (points, sites, triangles or None)
    "none": ([], 0, 0),
    "one": ([(3.0, 4.0)], 1, 0),
    "two": ([(3.0, 4.0), (-1.0, 1e150)], 2, 0),
    "three": ([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], 3, 1),
    "five": ([(0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (2.0, 2.0), (1.0, 1.0)], 5, 4),
    "equal": ([(0.1, 0.2)] * 50, 1, 0),
    "two_places": ([(0.1, 0.2), (0.1, -0.2)] * 25, 2, 0),
    "zeros": ([(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0), (1.0, 0.0), (0.0, 1.0)], 3, 1),
    "vertical": ([(1.0, float(i * 37 % 101)) for i in range(101)], 101, 0),
    "horizontal": ([(float(i * 37 % 101), -2.0) for i in range(101)], 101, 0),
    "oblique": ([(float(i * 37 % 101), 2.0 * (i * 37 % 101) + 1.0) for i in range(101)], 101, 0),
    "nearly_oblique": ([(float(i), 2.0 * i) for i in range(40)] + [(20.0, 40.0 + 2**-47)], 41, 39),
    "same_x_but_one": ([(1.0, float(i)) for i in range(50)] + [(2.0, 7.5)], 51, 49),
    "square": ([(float(i // 8), float(i % 8)) for i in range(64)], 64, 98),
    "circle": ([(math.cos(i), math.sin(i)) for i in range(60)], 60, None),
    "greatest": ([(GREATEST * ((i * 7 % 11 - 5) / 5), GREATEST * ((i * 5 % 13 - 6) / 6)) for i in range(12)], 12, None),
    "far_away": ([(i * 7 % 11 + 0.5, i * 5 % 13 + 0.25) for i in range(100)] + [(1e150, -1e150)], 101, None),
}


class Degenerate(harness.TestCase):
    def check(self, name, ranks, *options):
        """Triangulates on `ranks`, verifies on another number of ranks, returns the checksum."""
        points, sites, triangles = CASES[name]
        path = self.folder / f"{name}.f64"
        mesh = self.folder / f"{name}.{ranks}.vtkhdf"
        write_f64(path, points)
        report = self.report_of("triangulate", path, "-o", mesh, *options, ranks=ranks)
        run = report["run"]
        self.assertEqual(report["points"], len(points), run)
        self.assertEqual(report["sites"], sites, run)
        self.assertEqual(report["duplicates"], len(points) - sites, run)
        if triangles is not None:
            self.assertEqual(report["triangles"], triangles, run)
        if report["triangles"]:
            self.assertEqual(report["triangles"], 2 * sites - 2 - report["hull_edges"], run)
        else:
            self.assertIn("no triangles", run.out)
        verdict = self.report_of("verify", mesh, "--points", path, ranks=3 - ranks if ranks in (0, 3) else 2)
        self.assertIs(verdict["valid"], True, verdict["run"])
        self.assertEqual(verdict["checksum"], report["checksum"])
        self.assertIn(f"sites              {sites}\n", self.succeed("info", mesh).out)
        return report["checksum"]

    def checksums(self, name):
        checksums = {self.check(name, 0), self.check(name, 3, "--slabs", "7", "--axis", "y")}
        if harness.FULL:
            checksums |= {self.check(name, 8, "--axis", "x"), self.check(name, 5, "--slabs", "2")}
        return checksums

    def test_all(self):
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            answers = {name: pool.submit(self.checksums, name) for name in CASES}
        for name, answer in answers.items():
            with self.subTest(name=name):
                self.assertEqual(len(answer.result()), 1)

    def test_more_slabs_than_sites(self):
        self.assertEqual(self.check("five", 2, "--slabs", "100"), self.check("five", 8))


if __name__ == "__main__":
    harness.main()
