"""Reports for programs: every key with its type, null where it does not apply, and numbers that agree."""

import json
import unittest

import harness

NUMBER = (int, float)
# key: (type, subcommands where it is not null)
EVERY, MESHES = {"triangulate", "verify", "generate"}, {"triangulate", "verify"}
SCHEMA = {
    "program": (str, EVERY),
    "version": (str, EVERY),
    "mesh_format": (int, EVERY),
    "libraries": (dict, EVERY),
    "subcommand": (str, EVERY),
    "command_line": (list, EVERY),
    "inputs": (list, EVERY),
    "output": (str, {"triangulate", "generate"}),
    "ranks": (int, EVERY),
    "hosts": (int, EVERY),
    "slabs": (int, MESHES),
    "axis": (str, MESHES),
    "kernel": (str, {"triangulate"}),
    "points": (int, EVERY),
    "withheld": (int, {"triangulate"}),
    "other_class": (int, {"triangulate"}),
    "sites": (int, MESHES),
    "duplicates": (int, MESHES),
    "triangles": (int, MESHES),
    "hull_edges": (int, MESHES),
    "checksum": (str, MESHES),
    "valid": (bool, {"verify"}),
    "wall_s": (NUMBER, EVERY),
    "peak_rss_max_bytes": (int, EVERY),
    "own_sites_max": (int, {"triangulate"}),
    "path_sites_max": (int, {"triangulate"}),
    "candidate_sites_max": (int, {"triangulate"}),
    "imbalance": (NUMBER, {"triangulate"}),
    "path_sites": (int, {"triangulate"}),
    "longest_path": (int, {"triangulate"}),
    "ghosts": (int, MESHES),
    "split_trace": (dict, set()),  # on request
    "phases": (list, EVERY),
}
PHASE_KEYS = ("wall_max_s", "wall_mean_s", "cpu_max_s", "cpu_sum_s", "bytes_sent", "messages_sent",
              "peak_rss_max_bytes")
PHASES = ["read", "sort", "split", "triangulate", "stitch", "write"]
POINTS, SEED, RANKS = 20_000, 5, 3


class Reports(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points = cls.folder / "points.npy"
        cls.mesh = cls.folder / "mesh.vtkhdf"

    def assert_schema(self, report, but_null=()):
        subcommand = report["subcommand"]
        for key, (kind, where) in SCHEMA.items():
            with self.subTest(key=key, subcommand=subcommand):
                self.assertIn(key, report)
                if subcommand in where and key not in but_null:
                    self.assertIsInstance(report[key], kind)
                    self.assertFalse(kind is int and isinstance(report[key], bool))
                elif key not in but_null or report[key] is not None:
                    self.assertTrue(report[key] is None or key in but_null, report[key])
        self.assertEqual((report["ranks"], report["hosts"]), (RANKS, 1))
        self.assertIn("mpi", report["libraries"])
        self.assertIn("hdf5", report["libraries"])
        self.assertEqual(report["command_line"][1], subcommand)
        for phase in report["phases"]:
            with self.subTest(phase=phase):
                self.assertEqual(set(phase), {"name", *PHASE_KEYS})
                values = [phase[key] for key in PHASE_KEYS]
                if any(value is None for value in values):
                    self.assertEqual(values, [None] * len(values))
                    continue
                self.assertTrue(all(value >= 0 for value in values))
                self.assertLessEqual(phase["wall_mean_s"], phase["wall_max_s"] * (1 + 1e-9))
                self.assertLessEqual(phase["cpu_max_s"], phase["cpu_sum_s"] * (1 + 1e-9))
        run = [phase for phase in report["phases"] if phase["wall_max_s"] is not None]
        self.assertLessEqual(sum(phase["wall_mean_s"] for phase in run), report["wall_s"])
        self.assertGreater(report["peak_rss_max_bytes"], 1 << 20)

    def test_the_whole_way(self):
        made = self.report_of("generate", "lidar", "-n", POINTS, "--seed", SEED, "-o", self.points, ranks=RANKS)
        self.assert_schema(made)
        self.assertEqual(made["points"], POINTS)
        self.assertEqual([p["name"] for p in made["phases"]], ["generate", "write"])

        report = self.report_of("triangulate", self.points, "-o", self.mesh, "--slabs", 4, "--axis", "y", ranks=RANKS)
        self.assert_schema(report)
        self.assertEqual([p["name"] for p in report["phases"]], PHASES)
        self.assertEqual(report["inputs"], [str(self.points)])
        self.assertEqual(report["output"], str(self.mesh))
        self.assertEqual((report["slabs"], report["axis"], report["points"]), (4, "y", POINTS))
        self.assertEqual(report["points"], report["sites"] + report["duplicates"])
        self.assertEqual(report["triangles"], 2 * report["sites"] - 2 - report["hull_edges"])
        self.assertRegex(report["checksum"], "^[0-9a-f]{16}$")
        self.assertGreaterEqual(report["own_sites_max"] * RANKS, report["sites"])
        self.assertGreaterEqual(report["path_sites"], report["longest_path"])
        self.assertGreaterEqual(report["imbalance"], 1)
        for text in (f"{report['sites']:,}", f"{report['triangles']:,}", report["checksum"], str(self.mesh)):
            self.assertIn(text, report["run"].out)

        verdict = self.report_of("verify", self.mesh, "--points", self.points, ranks=RANKS)
        self.assert_schema(verdict)
        self.assertIs(verdict["valid"], True)
        for key in ("slabs", "axis", "points", "sites", "duplicates", "triangles", "hull_edges", "checksum", "ghosts"):
            self.assertEqual(verdict[key], report[key], key)

    def test_without_output(self):
        self.succeed("generate", "uniform", "-n", 3000, "--seed", SEED, "-o", self.points, "--quiet")
        before = sorted(self.folder.iterdir())
        for option in (("-o", "none"), ("--output", "none")):
            report = self.report_of("triangulate", self.points, *option, ranks=RANKS)
            self.assert_schema(report, but_null=("output", "valid"))
            self.assertIsNone(report["output"])
            self.assertIs(report["valid"], True)
            self.assertEqual([p["name"] for p in report["phases"]][:6], PHASES)
            self.assertIsNone(report["phases"][5]["wall_max_s"])
        self.assertEqual(before, sorted(self.folder.iterdir()))

    def test_kernels(self):
        self.succeed("generate", "kuzmin", "-n", POINTS, "--seed", SEED, "-o", self.points, "--quiet")
        found = set()
        for ranks, slabs in ((1, 1), (2, 3), (3, 8)):
            for kernel in ("merge", "split-path"):
                report = self.report_of("triangulate", self.points, "-o", "none", "--slabs", slabs, "--kernel", kernel,
                                        ranks=ranks)
                self.assertEqual(report["kernel"], kernel)
                self.assertIsNone(report["split_trace"])
                self.assertIs(report["valid"], True)
                found.add((report["checksum"], report["triangles"]))
        self.assertEqual(len(found), 1)

    def test_trace(self):
        self.succeed("generate", "uniform", "-n", POINTS, "--seed", SEED, "-o", self.points, "--quiet")
        for ranks, slabs in ((1, 1), (3, 8)):
            report = self.report_of("triangulate", self.points, "-o", "none", "--slabs", slabs, "--kernel", "split-path",
                                    "--trace", ranks=ranks)
            levels, times = report["split_trace"]["levels"], report["split_trace"]["times"]
            self.assertEqual(levels[0]["subproblems"], slabs)
            # Every site is once in the interior or on the border of its slab; those of paths are so in two slabs.
            sites = levels[0]["interior"] + levels[0]["border"]
            self.assertGreaterEqual(sites, POINTS)
            self.assertLessEqual(sites, POINTS + 2 * report["path_sites"])
            for level, below in zip(levels, levels[1:]):
                self.assertLessEqual(2 * below["largest"], level["largest"])
                self.assertLessEqual(level["longest_path"], level["path"])
                self.assertGreaterEqual(level["bucketing"], 1)
            self.assertEqual(levels[-1]["interior"], levels[-1]["bottom_interior"])
            self.assertEqual(levels[-1]["subproblems"], levels[-1]["bottoms"])
            self.assertEqual([part["name"] for part in times], ["sort", "hull", "border", "split", "bottom"])
            for part in times:
                self.assertGreater(part["max_s"], 0)
                self.assertLessEqual(part["max_s"], part["sum_s"])
            self.assertIn(f"{levels[0]['path']:,}", report["run"].out)
            self.assertIn("bucketing", report["run"].out)
        refused = harness.dovetail("triangulate", self.points, "-o", "none", "--trace", ranks=2)
        self.assertEqual(refused.code, 2, refused)
        self.assertIn("--kernel split-path", refused.err)

    def test_quiet(self):
        self.succeed("generate", "uniform", "-n", 300, "-o", self.points, "--quiet")
        for arguments in (("triangulate", self.points, "-o", self.mesh), ("verify", self.mesh)):
            run = self.succeed(*arguments, "--quiet", ranks=2)
            self.assertEqual((run.out, run.err), ("", ""), run)
            self.assertNotEqual(self.succeed(*arguments).out, "")

    def test_report_replaces_an_older_one(self):
        report = self.folder / "replaced.json"
        report.write_text("older")
        self.succeed("generate", "uniform", "-n", 3, "-o", self.points, "--report", report)
        self.assertEqual(json.loads(report.read_text())["points"], 3)
        self.assertEqual(self.leftovers(), [])


if __name__ == "__main__":
    harness.main()
