"""Larger than memory: the same bytes whether sites wait on disk or stay in memory, for every number of ranks; a peak
that keeps to the budget and falls as slabs rise; what cannot fit is refused before it starts; and scratch leaves
nothing behind, however a run ends."""

import hashlib
import pathlib
import random
import signal
import subprocess
import time
import unittest

import harness
from harness import COMMAND, FULL, MPIEXEC

RANKS = (1, 2, 3, 5, 8) if FULL else (1, 3, 5)
MIB = 1 << 20


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


measures_memory = unittest.skipIf(harness.SANITIZED, "AddressSanitizer keeps what is freed, and adds its own")


class Memory(harness.TestCase):
    def generated(self, distribution, count, extension="npy"):
        path = self.folder / f"{distribution}.{count}.{extension}"
        if not path.exists():
            self.succeed("generate", distribution, "-n", count, "--seed", 7, "-o", path, "--quiet")
        return path

    def on_disk(self, *arguments, **how):
        report = self.report_of("triangulate", *arguments, "--on-disk", **how)
        self.assertIs(report["forecast"]["on_disk"], True, report["run"])
        return report

    def check_same_bytes(self, inputs, memory, *options):
        """With slabs of one number, in memory and with so little memory that sites wait on disk."""
        whole, waiting = self.folder / "whole.vtkhdf", self.folder / "waiting.vtkhdf"
        expected = self.report_of("triangulate", *inputs, "-o", whole, *options)
        self.assertIs(expected["forecast"]["on_disk"], False)
        for ranks in RANKS:
            with self.subTest(inputs=inputs, ranks=ranks):
                report = self.on_disk(
                    *inputs, "-o", waiting, "--memory", memory, *options, ranks=ranks
                )
                self.assertEqual(digest(whole), digest(waiting))
                for key in ("checksum", "sites", "duplicates", "points", "withheld", "other_class", "longest_path"):
                    self.assertEqual(report[key], expected[key], key)
        return whole

    def test_same_bytes(self):
        for distribution in ("uniform", "kuzmin", "lattice", "clusters", "normal") if FULL else ("kuzmin", "lattice"):
            path = self.generated(distribution, 60000)
            self.check_same_bytes([path], "6MiB", "--slabs", 5)

    def test_same_bytes_along_y_and_by_height(self):
        path = self.generated("lidar", 60000)
        for rule in ("lowest", "highest"):
            self.check_same_bytes(
                [path], "6MiB", "--slabs", 5, "--axis", "y", "--duplicates", rule
            )

    def test_same_bytes_of_duplicates(self):
        path = self.folder / "duplicates.f64"
        draw = random.Random(1)
        points = [(float(draw.randrange(100)), float(draw.randrange(100))) for _ in range(40000)] + [(3.0, 4.0)] * 9000
        draw.shuffle(points)
        harness.write_f64(path, points)
        self.check_same_bytes([path], "6MiB", "--slabs", 4)
        run = harness.dovetail("triangulate", path, "-o", "none", "--duplicates", "error", "--memory", "4MiB", "--on-disk")
        other = harness.dovetail("triangulate", path, "-o", "none", "--duplicates", "error")
        self.assertEqual((run.code, run.messages), (1, other.messages), run)

    def test_same_bytes_of_text_and_las(self):
        text, las = self.generated("normal", 30000, "csv"), self.folder / "grid.las"
        harness.write_las(las, 20000, 200)
        node = self.generated("uniform", 30000, "node")
        self.check_same_bytes([text, las, node], "9MiB", "--slabs", 4)
        self.check_same_bytes([las], "4MiB", "--slabs", 2, "--class", "2")

    def test_checked_by_verify(self):
        path, mesh = self.generated("kuzmin", 60000), self.folder / "checked.vtkhdf"
        self.on_disk(path, "-o", mesh, "--memory", "6MiB", ranks=2)
        self.assertIs(self.report_of("verify", mesh, "--points", path, ranks=2)["valid"], True)

    def test_counted_only(self):
        path = self.generated("uniform", 60000)
        whole = self.report_of("triangulate", path, "-o", "none")
        counted = self.on_disk(path, "-o", "none", "--memory", "6MiB", ranks=2)
        self.assertEqual(whole["checksum"], counted["checksum"])
        self.assertEqual((whole["valid"], counted["valid"]), (True, None))

    @measures_memory
    def test_peak_keeps_to_the_budget(self):
        count = 2_000_000 if FULL else 600_000
        path = self.generated("uniform", count, "f64")
        nothing = self.generated("uniform", 10, "f64")
        program = self.report_of("triangulate", nothing, "-o", self.folder / "nothing.vtkhdf")["peak_rss_max_bytes"]
        for memory in (48, 64):
            report = self.on_disk(path, "-o", self.folder / "peak.vtkhdf", "--memory", f"{memory}MiB")
            # The budget is less than the sites alone would be; what pages of code the program touches is its own.
            self.assertLess(report["peak_rss_max_bytes"], memory * MIB + program / 2, report["run"])
        (self.folder / "peak.vtkhdf").unlink()

    @measures_memory
    def test_slabs_leave_only_their_borders(self):
        peaks = []
        for slabs in (4, 20):  # of one size
            path = self.generated("uniform", 100_000 * slabs)
            report = self.on_disk(path, "-o", self.folder / "left.vtkhdf", "--memory", "48MiB", "--slabs", slabs)
            peaks.append(report["peak_rss_max_bytes"])
        (self.folder / "left.vtkhdf").unlink()
        self.assertLess(peaks[1] - peaks[0], 1_600_000 * 10, peaks)  # sites and triangles have 72 bytes a site

    @measures_memory
    def test_peak_falls_as_slabs_rise(self):
        path = self.generated("uniform", 600_000, "f64")
        peaks = [
            self.report_of("triangulate", path, "-o", self.folder / "slabs.vtkhdf", "--slabs", slabs)["peak_rss_max_bytes"]
            for slabs in (1, 4, 16)
        ]
        self.assertGreater(peaks[0] - peaks[1], 20 * MIB, peaks)
        self.assertGreater(peaks[1] - peaks[2], 2 * MIB, peaks)

    def refused(self, *arguments, **how):
        run = harness.dovetail("triangulate", *arguments, **how)
        self.assertEqual(run.code, 1, run)
        self.assertEqual(len(run.messages), 1, run)
        return run.messages[0]

    def test_what_cannot_fit_is_refused(self):
        output = self.folder / "refused.vtkhdf"
        circle = self.generated("circle", 100000)
        began = time.monotonic()
        message = self.refused(circle, "-o", output, "--memory", "24MiB", "--slabs", 8)
        self.assertRegex(message, r"--memory: 24.0 MiB a rank are too few: about .* are needed, .*; give --memory \d+MiB")
        self.assertFalse(output.exists())
        enough = int(message.split("give --memory ")[1].split("MiB")[0])
        self.assertGreater(enough, 40)
        self.succeed("triangulate", circle, "-o", output, "--memory", f"{enough}MiB", "--slabs", 8)
        self.assertLess(time.monotonic() - began, 100)
        # A format that is not written slab by slab.
        uniform = self.generated("uniform", 60000)
        message = self.refused(uniform, "-o", self.folder / "refused.ply", "--memory", "4MiB")
        self.assertIn("name a .vtkhdf as output", message)
        self.assertEqual(self.leftovers(), [])

    def test_dry_run(self):
        path, output = self.generated("uniform", 60000), self.folder / "dry.vtkhdf"
        report = self.report_of("triangulate", path, "-o", output, "--dry-run", "--memory", "8MiB", "--on-disk", ranks=2)
        self.assertFalse(output.exists())
        foretold = report["forecast"]
        real = self.report_of("triangulate", path, "-o", output, "--memory", "8MiB", "--on-disk", ranks=2)
        self.assertEqual(foretold["on_disk"], real["forecast"]["on_disk"])
        self.assertEqual(foretold["slabs"], real["slabs"])
        self.assertLess(abs(foretold["path_sites"] / real["longest_path"] - 1), 0.4)
        self.assertLess(abs(foretold["mesh_bytes"] / output.stat().st_size - 1), 0.1)
        for fact in ("points", "slabs", "paths", "memory", "scratch", "output", "time"):
            self.assertRegex(report["run"].out, rf"(?m)^{fact} ")

    def test_sizes_in_words(self):
        path = self.generated("uniform", 10, "f64")
        for good in ("1GiB", "1 gib", "1.5G", "1000000", "512m"):
            self.succeed("triangulate", path, "-o", "none", "--memory", good, "--quiet")
        for bad in ("", "much", "-1", "0", "4XB", "1e300"):
            self.assertEqual(harness.dovetail("triangulate", path, "-o", "none", f"--memory={bad}").code, 2, bad)

    def test_scratch_that_cannot_be_used(self):
        path, output = self.generated("uniform", 60000), self.folder / "scratch.vtkhdf"
        locked = self.folder / "locked"
        locked.mkdir(exist_ok=True)
        locked.chmod(0o500)
        for folder, reason in ((self.folder / "missing", "No such file"), (locked, "Permission denied")):
            for ranks in (0, 3):
                message = self.refused(
                    path, "-o", output, "--memory", "8MiB", "--on-disk", "--scratch", folder, ranks=ranks, unprivileged=True
                )
                self.assertIn(f"{folder}: cannot be used for scratch ({reason}", message)
                self.assertIn("a folder that is there and can be written to", message)
        self.assertFalse(output.exists())
        path = self.generated("uniform", 400_000, "f64")
        message = self.refused(path, "-o", output, "--memory", "64MiB", "--on-disk", file_limit=5_000_000)
        self.assertIn("cannot take more scratch (File too large)", message)
        self.assertEqual(self.leftovers(), [])

    def test_killed(self):
        points, folder = self.generated("uniform", 400_000, "f64"), self.folder / "killed"
        folder.mkdir()
        output = folder / "killed.vtkhdf"
        arguments = [COMMAND, "triangulate", str(points), "-o", str(output), "--memory", "28MiB", "--on-disk"]
        for sent in (signal.SIGKILL, signal.SIGTERM):
            for delay in (0.2, 0.5, 0.8, 1.2, 1.8) if FULL else (0.4, 0.8):
                (folder / "killed.vtkhdf.partial").unlink(missing_ok=True)
                process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(delay)
                process.send_signal(sent)
                process.wait(60)
                if output.exists():  # it had the time to finish: then it is whole
                    self.succeed("verify", output)
                    output.unlink()
                left = {str(p.relative_to(folder)) for p in folder.rglob("*")}
                allowed = {"killed.vtkhdf.partial"} if sent == signal.SIGKILL else set()
                self.assertLessEqual(left, allowed, f"{sent} after {delay}")
        self.succeed(*arguments[1:])
        self.assertEqual([p.name for p in folder.iterdir()], ["killed.vtkhdf"])


if __name__ == "__main__":
    harness.main()
