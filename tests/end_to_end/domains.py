"""`dovetail constrain`, `refine` and `verify` on domains: real ones, messy ones, and every refusal."""

import json
import math
import random
import unittest

import harness
from harness import data_file, dovetail

DATA = ["A", "capital_a", "guitar", "hanging", "island", "square_with_crack", "sweden"]
SQUARE = "4 2 0 1\n1 0 0 3\n2 1 0 0\n3 1 1 0\n4 0 1 0\n4 1\n1 1 2 5\n2 2 3 6\n3 3 4 7\n4 4 1 8\n0\n"


def poly(vertices, segments, holes=(), regions=()):
    text = f"{len(vertices)} 2 0 0\n" + "".join(f"{i} {x!r} {y!r}\n" for i, (x, y) in enumerate(vertices))
    text += f"{len(segments)} 1\n" + "".join(f"{i} {a} {b} {m}\n" for i, (a, b, m) in enumerate(segments))
    text += f"{len(holes)}\n" + "".join(f"{i} {x!r} {y!r}\n" for i, (x, y) in enumerate(holes))
    text += f"{len(regions)}\n" + "".join(f"{i} {' '.join(map(repr, r))}\n" for i, r in enumerate(regions))
    return text


def ring(points, first=0, marker=1):
    return [(first + i, first + (i + 1) % len(points), marker) for i in range(len(points))]


class Domains(harness.TestCase):
    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def check(self, mesh, domain=None):
        more = ("--domain", domain) if domain else ()
        report = self.report_of("verify", mesh, *more)
        self.assertTrue(report["valid"], report)
        return report

    def refuse(self, *arguments, code=1, says=()):
        run = dovetail(*arguments)
        self.assertEqual(run.code, code, run)
        self.assertEqual(len(run.messages), 1, run)
        for words in says:
            self.assertIn(words, run.messages[0])
        self.assertEqual(self.leftovers(), [])
        return run

    def test_real_domains(self):
        for name in DATA:
            domain = data_file(f"{name}.poly")
            if domain is None:
                self.skipTest(f"{name}.poly is absent")
            mesh = self.folder / f"{name}.vtkhdf"
            constrained = self.report_of("constrain", domain, "-o", mesh)
            self.check(mesh, domain)
            area = None
            for angle in (20, 26.45, 30) if harness.FULL or name == "A" else (30,):
                refined = self.report_of("refine", domain, "-o", mesh, "--min-angle", angle)
                verdict = self.check(mesh, domain)
                self.assertEqual(verdict["left_triangles"], 0, (name, angle))
                area = area or refined["area"]
                self.assertTrue(math.isclose(area, refined["area"], rel_tol=1e-9))
                self.assertGreater(refined["vertices_per_feature_integral"], 0.1)
                if verdict["exempt_triangles"] == 0:
                    self.assertGreaterEqual(refined["smallest_angle"], angle - 1e-9)
            self.assertGreaterEqual(refined["triangles"], constrained["triangles"])

    def test_markers_reach_the_mesh_and_triangle_files(self):
        domain = self.write("square.poly", SQUARE)
        mesh = self.folder / "square.vtkhdf"
        self.succeed("refine", domain, "-o", mesh, "--max-area", 0.01)
        self.check(mesh, domain)
        self.succeed("convert", mesh, self.folder / "square.ele")
        nodes = [line.split() for line in (self.folder / "square.node").read_text().splitlines()]
        self.assertEqual([nodes[1][1:], nodes[2][1:]], [["0", "0", "3"], ["1", "0", "5"]])
        for _, x, y, marker in nodes[5:]:
            expected = "5" if y == "0" else "6" if x == "1" else "7" if y == "1" else "8" if x == "0" else "0"
            self.assertEqual(marker, expected)
        # What was written is a domain again, of the same shape.
        again = self.report_of("constrain", self.folder / "square.poly", "-o", self.folder / "again.vtkhdf")
        self.assertEqual(again["sites"], len(nodes) - 1)

    def test_other_commands_take_domains(self):
        domain = self.write("two.poly", poly([(0, 0), (2, 0), (2, 1), (0, 1), (1, 0), (1, 1)],
                                             [(0, 1, 1), (1, 2, 1), (2, 3, 1), (3, 0, 1), (4, 5, 2)], (),
                                             [(0.5, 0.5, 10.0, 0.01), (1.5, 0.5, 20.0)]))
        mesh = self.folder / "two.vtkhdf"
        report = self.report_of("refine", domain, "-o", mesh)
        self.assertEqual(report["repairs"]["junctions"], 2)
        self.check(mesh, domain)
        self.assertIn("6 vertices given", self.succeed("info", mesh).out)
        self.assertTrue(math.isclose(self.report_of("stats", mesh)["area"], 2))
        self.succeed("render", mesh, "-o", self.folder / "two.png")
        for extension in (".vtu", ".msh", ".ply", ".npy"):
            self.succeed("convert", mesh, self.folder / ("two" + extension), ranks=2)
        self.succeed("convert", mesh, self.folder / "copy.vtkhdf", ranks=2)
        self.assertEqual((self.folder / "copy.vtkhdf").read_bytes(), mesh.read_bytes())
        further = self.report_of("refine", mesh, "-o", self.folder / "finer.vtkhdf", "--max-area", 0.001)
        self.assertGreater(further["triangles"], 2 / 0.001)
        self.check(self.folder / "finer.vtkhdf", domain)

    def test_points(self):
        points = self.write("points.xyz", "".join(
            f"{random.Random(i).random()} {random.Random(-i - 1).random()} 1\n" for i in range(500)))
        for boundary, angle in (("hull", 30), ("box", 20)):
            mesh = self.folder / f"{boundary}.vtkhdf"
            report = self.report_of("refine", points, "-o", mesh, "--boundary", boundary, "--min-angle", angle)
            self.check(mesh)
            self.assertEqual(report["points"], 500 + (4 if boundary == "box" else 0))
            self.assertIn("attribute z left out", report["notices"][0])

    def test_messy_segments(self):
        draw = random.Random(7)
        for run in range(6):
            vertices = [(0, 0), (9, 0), (9, 9), (0, 9)] + [(draw.randrange(10), draw.randrange(10)) for _ in range(40)]
            segments = ring(vertices[:4]) + [(4 + 2 * i, 5 + 2 * i, i) for i in range(20)]
            domain = self.write("messy.poly", poly(vertices, segments))
            mesh = self.folder / "messy.vtkhdf"
            report = self.report_of("constrain", domain, "-o", mesh)
            self.assertGreater(report["repairs"]["crossings"], 0)
            self.check(mesh, domain)
            self.succeed("refine", domain, "-o", mesh, "--min-angle", 20)
            self.check(mesh, domain)
            self.refuse("constrain", domain, "-o", mesh, "--crossings", "error",
                        says=["messy.poly, segment", "(line ", "crosses segment"])

    def test_geojson(self):
        outer, inner = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]], [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]
        features = [
            {"type": "Feature", "properties": {"marker": 7}, "geometry": {"type": "Polygon", "coordinates": [outer, inner]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [[[[4, 0], [6, 0], [6, 4], [4, 4]]]]}},
            {"type": "Feature", "properties": None, "geometry": {"type": "LineString", "coordinates": [[3, 3, 8], [5, 3, 8]]}},
        ]
        domain = self.write("land.geojson", json.dumps({"type": "FeatureCollection", "features": features}))
        mesh = self.folder / "land.vtkhdf"
        report = self.report_of("constrain", domain, "-o", mesh)
        self.assertEqual(report["repairs"]["closed_rings"], 1)
        self.assertEqual(report["repairs"]["repeated_segments"], 1)
        self.assertEqual(report["repairs"]["crossings"], 1)
        self.assertEqual(report["notices"], ["2 heights left out: domains are flat"])
        self.assertTrue(math.isclose(self.check(mesh, domain)["area"], 23))
        # Without its rings the hole is a part of the domain, and the line crosses a border either way.
        self.report_of("constrain", domain, "-o", mesh, "--holes", "seeds")
        self.assertTrue(math.isclose(self.check(mesh)["area"], 24))
        self.report_of("refine", domain, "-o", mesh)
        self.check(mesh, domain)

    def test_limits_are_told(self):
        domain = self.write("needle.poly", poly([(0, 0), (100, 0), (100, 1)], ring([0] * 3)))
        mesh = self.folder / "needle.vtkhdf"
        report = self.report_of("refine", domain, "-o", mesh, "--max-points", 10, "--max-area", 0.01)
        self.assertLessEqual(report["sites"], 10)
        self.assertEqual({left["reason"] for left in report["left_triangles"]}, {"max points"})
        self.check(mesh, domain)
        self.report_of("refine", domain, "-o", mesh, "--min-angle", 30)
        self.assertGreater(self.check(mesh, domain)["exempt_triangles"], 0)

    def test_verify_finds_what_is_wrong(self):
        domain = self.write("right.poly", SQUARE)
        mesh = self.folder / "right.vtkhdf"
        self.succeed("refine", domain, "-o", mesh, "--max-area", 0.05)
        other = self.write("other.poly", SQUARE.replace("3 1 1 0", "3 1 1.5 0"))
        run = dovetail("verify", mesh, "--domain", other)
        self.assertEqual(run.code, 1, run)
        self.assertIn("not a mesh of the domain given", run.err)
        try:
            import h5py
        except ImportError:
            self.skipTest("h5py is not installed")
        for name, change in {"domain/segment_markers": 1, "domain/segment_of_side": 1, "domain/chain_vertices": 1,
                             "dovetail/neighbours": 1}.items():
            broken = self.folder / "broken.vtkhdf"
            broken.write_bytes(mesh.read_bytes())
            with h5py.File(broken, "r+") as file:
                row = file[name][0]
                file[name][0] = row + change
            run = dovetail("verify", broken)
            self.assertEqual(run.code, 1, (name, run))

    def test_refusals_of_poly(self):
        for text, words in {
            "": "the file ends before there is anything",
            "3 3 0 0\n0 0 0 0\n": "3 dimensions",
            "3 2 0 0\n0 0 0\n1 1 0\n": "line 4",
            "1 2 0 0\n0 0 x\n": "line 2, character 5: 'x' is not a number",
            "1 2 0 0\n0 0 inf\n": "not a finite number",
            "2 2 0 0\n0 0 0\n2 1 1\n": "vertex 2 stands where 1 must",
            "2 2 0 0\n7 0 0\n8 1 1\n": "'7' is not the first vertex",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 2\n0\n": "line 5, character 5: there is no vertex 2",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1 4\n0\n": "4 columns where 3",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1\n1\n": "after 0 of 1 holes",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1\n0\n1\n0 1 1\n": "regions must be",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1\n0\n0\n7\n": "after the last region",
            "0 2 0 0\n0 0\n0\n": ".node: cannot be opened",
            "2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1\n0\n": "no triangles",
            "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n3 0\n0 0 1\n1 1 2\n2 2 3\n0\n": "2 segments end free",
            "1 2 0 0\n0 0 0\0\n": "a byte is zero",
        }.items():
            domain = self.write("bad.poly", text)
            self.refuse("constrain", domain, "-o", self.folder / "bad.vtkhdf", says=[words])

    def test_refusals_of_geojson(self):
        for text, words in {
            '{"type": "Polygon", "coordinates": [[[0, 0], ': "byte ",
            '{"type": "Polygon"}': 'has no "coordinates"',
            '{"type": "Circle", "coordinates": []}': '"Circle" is no type of GeoJSON',
            '{"type": "Polygon", "coordinates": [[[0, 0], [1, "a"], [1, 1]]]}': "coordinates[0][1][1]",
            '{"type": "Polygon", "coordinates": [[0, 0]]}': "coordinates[0][0]: is not a list",
            '{"type": "FeatureCollection", "features": 5}': "features: is not a list",
            '{"type": "Feature", "properties": {"marker": 0.5}, "geometry": null}': "properties.marker",
            '{"type": "LineString", "coordinates": [[0, 0]]}': "one position",
            "[" * 100000: "too deep",
        }.items():
            domain = self.write("bad.geojson", text)
            self.refuse("constrain", domain, "-o", self.folder / "bad.vtkhdf", says=[words])

    def test_refusals_of_commands(self):
        domain = self.write("fine.poly", SQUARE)
        mesh, points = self.folder / "fine.vtkhdf", self.write("fine.xyz", "0 0\n1 0\n0 1\n")
        self.refuse("constrain", points, "-o", mesh, code=2, says=["not that of a domain file"])
        self.refuse("refine", domain, "-o", mesh, "--min-angle", 40, code=2)
        self.refuse("refine", domain, "-o", mesh, "--max-area", -1, code=2)
        self.refuse("refine", self.folder / "none.poly", "-o", mesh, says=["none.poly: cannot be opened"])
        self.succeed("triangulate", points, "-o", mesh)
        self.refuse("refine", mesh, "-o", self.folder / "out.vtkhdf", says=["without a domain"])
        self.refuse("verify", mesh, "--domain", domain, code=2, says=["without a domain"])
        self.succeed("constrain", domain, "-o", mesh)
        self.refuse("verify", mesh, "--points", points, code=2, says=["not of points alone"])
        for arguments in (("constrain", domain, "-o", mesh), ("refine", domain, "-o", mesh), ("verify", mesh)):
            run = dovetail(*arguments, ranks=2)
            self.assertNotEqual(run.code, 0)
            self.assertEqual(len(run.messages), 1, run)
            self.assertIn("works on one rank, and this run has 2", run.messages[0])


if __name__ == "__main__":
    harness.main()
