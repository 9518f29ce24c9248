"""Signs of life while reading and writing: a slow disk, played by a preloaded library, shows the lines.

Percents only grow, the time left is about what was then needed, and it ends with the run.
"""

import re
import time
import unittest

import harness
from harness import SLOW_DISK

LINE = re.compile(r"dovetail: (\w+), (\d+) s gone(?:, (about|over) (\d+) % done(?:, (\d+) s left)?)?$")
POINTS = 400_000 # so that a file is many buffers


@unittest.skipUnless(SLOW_DISK, "a sanitizer does not let anything be loaded before it")
class Progress(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points = cls.folder / "points.npy"
        cls.text = cls.folder / "points.csv"
        cls.mesh = cls.folder / "mesh.vtkhdf"
        for arguments in (
            ("generate", "uniform", "-n", POINTS, "-o", cls.points),
            ("generate", "uniform", "-n", POINTS, "-o", cls.text),
            ("triangulate", cls.points, "-o", cls.mesh, "--slabs", 4),
        ):
            made = harness.dovetail(*arguments, "--quiet")
            assert made.code == 0, made

    def lines_of(self, bytes_a_second, *arguments, ranks=0):
        """(stage, seconds gone, percent or None, seconds left or None) of every line; the run's length."""
        began = time.monotonic()
        with harness.slow_disk(bytes_a_second):
            run = self.succeed(*arguments, "--progress", ranks=ranks)
        took = time.monotonic() - began
        lines = []
        for text in run.err.replace("\x1b[K", "").splitlines():  # of live lines as well
            if text:
                found = LINE.match(text)
                self.assertIsNotNone(found, repr(text))
                stage, gone, kind, percent, left = found.groups()
                lines.append((stage, int(gone), int(percent) if kind == "about" else None, left and int(left)))
        return lines, took

    def check(self, stages, bytes_a_second, *arguments, ranks=0):
        lines, took = self.lines_of(bytes_a_second, *arguments, ranks=ranks)
        for stage in stages:
            own = [line for line in lines if line[0] == stage]
            with self.subTest(stage=stage, arguments=list(map(str, arguments)), ranks=ranks):
                percents = [percent for _, _, percent, _ in own if percent is not None]
                self.assertGreaterEqual(len(percents), 2, lines)
                self.assertEqual(percents, sorted(percents), lines)
                self.assertGreaterEqual(len(set(percents)), 2, lines)
        # Half way through the last stage nobody is far off.
        _, gone, _, left = [line for line in lines if line[0] == stages[-1] and line[3] is not None][-1]
        self.assertLess(abs(took - gone - left), 3, (took, lines))

    def test_points(self):
        rate = self.text.stat().st_size / 2.5
        for output in ("written.csv", "written.npy", "written.node") if harness.FULL else ("written.node",):
            self.check(["read", "write"], rate, "convert", self.text, self.folder / output)

    def test_meshes(self):
        rate = self.mesh.stat().st_size / 2 / 2.5  # of each of two ranks
        every = ("vtkhdf", "vtu", "pvtu", "ply", "msh", "ele", "npy")
        for extension in every if harness.FULL else every[:1]:
            output = self.folder / f"written.{extension}"
            self.check(["read", "write"], rate, "convert", self.mesh, output, ranks=2)

    def test_triangulate(self):
        output = self.folder / "written.vtkhdf"
        # Slabs are written as they are made, and the disk is what is waited for.
        rate = self.mesh.stat().st_size / 2.5
        for slabs in (1, 8):
            self.check(["triangulate"], rate, "triangulate", self.points, "-o", output, "--slabs", slabs)

    def test_quiet(self):
        with harness.slow_disk(1e6):
            self.assertEqual(self.succeed("convert", self.points, self.folder / "quiet.npy", "--quiet").err, "")


if __name__ == "__main__":
    harness.main()
