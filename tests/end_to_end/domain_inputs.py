"""Whatever people's domain files contain: each defect of segments mended and counted, each bad file refused.

Every file is a square with one kind of defect in it, so the counts expected are those of the drawing. What is
mended must also verify against the file as it was, constrained and refined.
"""

import json
import math
import unittest

import harness
from harness import dovetail

SIDE = 8
OUTLINE = [(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)]
NO_REPAIRS = dict.fromkeys(
    ("duplicate_vertices", "zero_length_segments", "repeated_segments", "overlapping_segments", "junctions",
     "vertices_on_segments", "crossings", "pulled_vertices", "closed_rings", "hanging_ends", "lone_vertices"), 0)
ULP = 2.0**-52  # of coordinates from 1 to 2


def poly(vertices, segments):
    """Vertices and segments beside those of the outline, which are 0 to 3; numbers count from 0."""
    vertices = OUTLINE + list(vertices)
    segments = [(i, (i + 1) % 4) for i in range(4)] + list(segments)
    rows = [f"{len(vertices)} 2 0 0", *(f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(vertices)),
            f"{len(segments)} 0", *(f"{i} {a} {b}" for i, (a, b) in enumerate(segments)), "0"]
    return "\n".join(rows) + "\n"


def geojson(*lines, rings=(OUTLINE + OUTLINE[:1],)):
    return json.dumps({"type": "GeometryCollection", "geometries": [
        {"type": "Polygon", "coordinates": rings}, *({"type": "LineString", "coordinates": line} for line in lines)]})


class Inputs(harness.TestCase):
    commands = ("constrain", "refine")

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def check_mesh(self, mesh, domain):
        verdict = self.report_of("verify", mesh, "--domain", domain)
        self.assertTrue(verdict["valid"], verdict)
        self.assertTrue(math.isclose(verdict["area"], SIDE * SIDE, rel_tol=1e-12), verdict)

    def mended(self, domain, sites, segments, **repairs):
        """The constrained mesh has exactly these repairs, sites and subsegments; both it and the refined one verify."""
        mesh = self.folder / "mended.vtkhdf"
        report = self.report_of("constrain", domain, "-o", mesh)
        self.assertEqual(report["repairs"], NO_REPAIRS | repairs)
        self.assertEqual((report["sites"], report["segments"]), (sites, segments))
        self.check_mesh(mesh, domain)
        refined = self.report_of("refine", domain, "-o", mesh, "--min-angle", 30)
        self.assertEqual(refined["repairs"], NO_REPAIRS | repairs)
        self.check_mesh(mesh, domain)
        return report

    def refused(self, path, *says, code=1, unprivileged=False):
        """Both commands, which read with the same functions and so take turns, give one message, which names the file
        and says each of these, and leave nothing."""
        self.commands = self.commands[::-1]
        mesh = self.folder / "refused.vtkhdf"
        run = dovetail(self.commands[0], path, "-o", mesh, unprivileged=unprivileged)
        self.assertEqual(run.code, code, run)
        self.assertEqual(len(run.messages), 1, run)
        for words in (str(path), *says):
            self.assertIn(words, run.messages[0])
        self.assertFalse(mesh.exists(), run)
        self.assertEqual(self.leftovers(), [])

    def refused_text(self, extension, text, *says):
        self.refused(self.write(f"refused.{extension}", text), *says)

    @unittest.skipIf(harness.SANITIZED, "AddressSanitizer needs terabytes of addresses")
    def test_more_triangles_than_memory(self):
        domain, mesh = self.write("a.poly", poly([], [])), self.folder / "refused.vtkhdf"
        run = dovetail("refine", domain, "-o", mesh, "--max-area", 1e-8, memory_limit=1_000_000_000)
        self.assertEqual(run.code, 1, run)
        self.assertEqual(len(run.messages), 1, run)
        for words in (str(domain), "more memory than there is", "--max-area", "--max-points"):
            self.assertIn(words, run.messages[0])
        self.assertFalse(mesh.exists(), run)

    @unittest.skipIf(harness.SANITIZED, "AddressSanitizer needs terabytes of addresses")
    def test_more_segments_than_memory(self):
        count = 800_000
        with open(self.folder / "long.poly", "w") as file:
            file.write(f"{count} 2 0 0\n")
            file.writelines(f"{i} {i} {i % 7}\n" for i in range(count))
            file.write(f"{count - 1} 0\n")
            file.writelines(f"{i} {i} {i + 1}\n" for i in range(count - 1))
            file.write("0\n")
        mesh = self.folder / "refused.vtkhdf"
        for command in self.commands:
            run = dovetail(command, self.folder / "long.poly", "-o", mesh, "--convex", memory_limit=350_000_000)
            self.assertEqual(run.code, 1, run)
            self.assertEqual(len(run.messages), 1, run)
            for words in ("long.poly", "more memory than there is", "in parts"):
                self.assertIn(words, run.messages[0])
            self.assertFalse(mesh.exists(), run)

    # Segments in any condition

    def test_nothing_to_mend(self):
        self.mended(self.write("a.poly", poly([], [])), 4, 4)
        self.mended(self.write("a.geojson", geojson()), 4, 4)

    def test_segments_that_cross(self):
        domain = self.write("a.poly", poly([(1, 1), (3, 3), (1, 3), (3, 1)], [(4, 5), (6, 7)]))
        self.mended(domain, 9, 8, crossings=1, hanging_ends=4)
        other = self.write("a.geojson", geojson([(1, 1), (3, 3)], [(1, 3), (3, 1)]))
        self.mended(other, 9, 8, crossings=1, hanging_ends=4)
        mesh = self.folder / "refused.vtkhdf"
        for path, first, second in ((domain, "segment 4 (line 15)", "segment 5 (line 16)"),
                                    (other, "geometries[1].coordinates[0]", "geometries[2].coordinates[0]")):
            for command in ("constrain", "refine"):
                run = dovetail(command, path, "-o", mesh, "--crossings", "error")
                self.assertEqual((run.code, len(run.messages), mesh.exists()), (1, 1, False), run)
                for words in (str(path), first, "crosses segment 5", second, "(2, 2)", "--crossings split"):
                    self.assertIn(words, run.messages[0])

    def test_segments_that_meet_at_ends_do_not_cross(self):
        domain = self.write("a.poly", poly([(4, 4), (4, 0)], [(4, 5), (0, 4), (4, 2)]))
        report = self.report_of("constrain", domain, "-o", self.folder / "a.vtkhdf", "--crossings", "error")
        self.assertEqual(report["repairs"], NO_REPAIRS | {"junctions": 1})

    def test_many_segments_through_one_place(self):
        ends = [(1, 3), (5, 3), (3, 1), (3, 5), (1, 1), (5, 5), (1, 5), (5, 1)]
        domain = self.write("a.poly", poly(ends, [(4, 5), (6, 7), (8, 9), (10, 11)]))
        self.mended(domain, 4 + 8 + 1, 4 + 8, crossings=6, hanging_ends=8)  # each pair of four

    def test_segments_that_cross_outlines(self):
        domain = self.write("a.poly", poly([(-1, 4), (9, 4)], [(4, 5)]))
        self.mended(domain, 4 + 2 + 2, 4 + 2 + 3, crossings=2, hanging_ends=2)

    def test_overlapping_segments(self):
        ends = [(1, 1), (4, 1), (2, 1), (5, 1)]
        self.mended(self.write("a.poly", poly(ends, [(4, 5), (6, 7)])), 8, 7, overlapping_segments=1, junctions=2,
                    hanging_ends=2)
        self.mended(self.write("a.geojson", geojson(ends[:2], ends[2:])), 8, 7, overlapping_segments=1, junctions=2,
                    hanging_ends=2)

    def test_segment_within_another(self):
        domain = self.write("a.poly", poly([(1, 1), (5, 5), (2, 2), (4, 4)], [(4, 5), (7, 6)]))
        self.mended(domain, 8, 7, overlapping_segments=1, junctions=2, hanging_ends=2)

    def test_segment_along_the_outline(self):
        domain = self.write("a.poly", poly([(2, 0), (6, 0)], [(5, 4)]))
        self.mended(domain, 6, 6, overlapping_segments=1, junctions=2)

    def test_repeated_segments(self):
        ends = [(1, 1), (3, 2)]
        self.mended(self.write("a.poly", poly(ends, [(4, 5), (4, 5), (5, 4)])), 6, 5, repeated_segments=2,
                    hanging_ends=2)
        self.mended(self.write("a.geojson", geojson(ends, ends[::-1])), 6, 5, repeated_segments=1,
                    duplicate_vertices=2, hanging_ends=2)

    def test_hanging_segments(self):
        domain = self.write("a.poly", poly([(1, 1), (3, 1), (5, 5)], [(4, 5), (2, 6)]))
        self.mended(domain, 7, 6, hanging_ends=3)  # one is free, the other is bound to a corner
        self.mended(self.write("a.geojson", geojson([(1, 1), (3, 1), (3, 2)])), 7, 6, hanging_ends=2)

    def test_segment_that_ends_in_the_middle_of_another(self):
        domain = self.write("a.poly", poly([(1, 4), (7, 4), (4, 4), (4, 6)], [(4, 5), (6, 7)]))
        self.mended(domain, 8, 7, junctions=1, hanging_ends=3)
        self.mended(self.write("a.geojson", geojson([(4, 0), (4, 4)])), 6, 6, junctions=1, hanging_ends=1)

    def test_segments_without_length(self):
        domain = self.write("a.poly", poly([(1, 1), (1, 1)], [(4, 4), (4, 5), (2, 2)]))
        self.mended(domain, 5, 4, zero_length_segments=3, duplicate_vertices=1, lone_vertices=1)
        self.mended(self.write("a.geojson", geojson([(1, 1), (1, 1)])), 5, 4, zero_length_segments=1,
                    duplicate_vertices=1, lone_vertices=1)

    def test_vertices_on_segments(self):
        domain = self.write("a.poly", poly([(2, 0), (8, 3), (1, 1), (3, 5), (2, 3)], [(6, 7)]))
        self.mended(domain, 9, 8, vertices_on_segments=3, hanging_ends=2)

    def test_vertices_next_to_segments(self):
        """As near as doubles go, two ulps beside their middle, and not on them: nothing is mended."""
        domain = self.write("a.poly", poly([(1, 1), (1 + 4 * ULP, 7), (1, 4)], [(4, 5)]))
        self.mended(domain, 7, 5, hanging_ends=2, lone_vertices=1)

    def test_vertex_that_a_rounded_crossing_would_sweep(self):
        """In ulps from (1, 1): the line from (0, 0) to (8, 3) is crossed at (1, 3/8), which rounds to (1, 0), and
        between the line and its bend there lies one vertex only, (3, 1)."""
        place = lambda x, y: (1 + x * ULP, 1 + y * ULP)
        domain = self.write("a.poly", poly([place(0, 0), place(8, 3), place(1, -1), place(1, 1), place(3, 1)],
                                           [(4, 5), (6, 7)]))
        mesh = self.folder / "a.vtkhdf"
        report = self.report_of("constrain", domain, "-o", mesh)
        self.assertEqual(report["repairs"], NO_REPAIRS | {"crossings": 1, "pulled_vertices": 1, "hanging_ends": 4})
        self.assertEqual((report["sites"], report["segments"]), (10, 4 + 3 + 2))
        self.check_mesh(mesh, domain)

    def test_lone_vertices(self):
        self.mended(self.write("a.poly", poly([(3, 3), (5, 4)], [])), 6, 4, lone_vertices=2)

    def test_duplicate_vertices(self):
        domain = self.write("a.poly", poly([(8, 8), (2, 2), (2, 2), (-0.0, 0.0)], [(4, 5), (6, 7)]))
        # The two are one segment across, from corner to corner through (2, 2).
        self.mended(domain, 5, 6, duplicate_vertices=3)

    def test_everything_at_once(self):
        """One of each, apart from each other, adds up."""
        ends = [(1, 1), (2, 2), (1, 2), (2, 1),  # cross
                (3, 1), (5, 1), (4, 1), (6, 1),  # overlap
                (1, 4), (2, 4),                  # repeat
                (4, 3), (4, 5), (4, 4), (5, 4),  # end in the middle
                (6, 6), (6, 6),                  # no length, two equal
                (4, 0),                          # on the outline
                (7, 7)]                          # alone
        pairs = [(0, 1), (2, 3), (4, 5), (6, 7), (8, 9), (9, 8), (10, 11), (12, 13), (14, 15)]
        domain = self.write("a.poly", poly(ends, [(4 + a, 4 + b) for a, b in pairs]))
        self.mended(domain, 4 + 17 + 1, 4 + 1 + 4 + 3 + 1 + 3, crossings=1, overlapping_segments=1, junctions=2 + 1,
                    repeated_segments=1, zero_length_segments=1, duplicate_vertices=1, vertices_on_segments=1,
                    hanging_ends=4 + 2 + 2 + 3, lone_vertices=2)

    def test_outline_that_is_not_closed(self):
        text = "4 2 0 0\n0 0 0\n1 8 0\n2 8 8\n3 0 8\n3 0\n0 0 1\n1 1 2\n2 2 3\n0\n"
        domain = self.write("a.poly", text)
        self.refused(domain, "outline is not closed (2 segments end free)", "--convex")
        mesh = self.folder / "a.vtkhdf"
        report = self.report_of("constrain", domain, "-o", mesh, "--convex")
        self.assertEqual(report["repairs"], NO_REPAIRS | {"hanging_ends": 2})
        self.check_mesh(mesh, domain)
        self.refused_text("geojson", json.dumps({"type": "LineString", "coordinates": OUTLINE}),
                          "outline is not closed (2 segments end free)")

    def test_ring_that_is_not_closed(self):
        self.mended(self.write("a.geojson", geojson(rings=(OUTLINE,))), 4, 4, closed_rings=1)

    def test_domain_without_area(self):
        for points in ([], [(1, 1)], [(0, 0), (1, 1)], [(0, 0), (1, 1), (2, 2), (5, 5)]):
            text = f"{len(points)} 2 0 0\n" + "".join(f"{i} {x} {y}\n" for i, (x, y) in enumerate(points))
            if points:
                self.refused_text("poly", text + "0 0\n0\n", "it has no triangles")
            self.refused_text("geojson", json.dumps({"type": "MultiPoint", "coordinates": points}),
                              "it has no triangles")

    # Files

    def test_missing_file(self):
        for extension in ("poly", "geojson", "json"):
            self.refused(self.folder / f"missing.{extension}", "cannot be opened (No such file or directory)")

    def test_missing_vertices_beside(self):
        run = dovetail("constrain", self.write("alone.poly", "0 2 0 0\n0 0\n0\n"), "-o", self.folder / "alone.vtkhdf")
        self.assertEqual((run.code, len(run.messages)), (1, 1), run)
        self.assertIn(f"{self.folder / 'alone.node'}: cannot be opened", run.messages[0])

    def test_no_permission_to_read(self):
        for extension, text in (("poly", poly([], [])), ("geojson", geojson())):
            path = self.write(f"secret.{extension}", text)
            path.chmod(0)
            self.refused(path, "cannot be opened (Permission denied)", "chmod u+r", unprivileged=True)

    def test_folder_in_place_of_a_file(self):
        for extension in ("poly", "geojson"):
            path = self.folder / f"folder.{extension}"
            path.mkdir()
            self.refused(path, "Is a directory")

    def test_wrong_extension(self):
        for name in ("square.shp", "square", "square.poly.bak"):
            path = self.write(name, poly([], []))
            self.refused(path, "its extension is not that of a domain", ".poly, .geojson or .json", code=2)
            self.refused(path, "its extension is not that of a domain", ".poly, .geojson or .json", code=2)

    def test_extension_of_the_other_format(self):
        self.refused_text("poly", geojson(), "line 1")
        self.refused_text("geojson", poly([], []), "not JSON here")

    def test_empty_file(self):
        for text in ("", " \n\n"):
            self.refused_text("poly", text, "the file ends before there is anything")
            self.refused_text("geojson", text, "not JSON here")

    def test_truncated_file(self):
        """After every line of a .poly but the last; after every tenth byte of GeoJSON."""
        text = poly([], [])
        lines = text.splitlines(keepends=True)
        for count in range(1, len(lines) - 1):
            self.refused_text("poly", "".join(lines[:count]), "the file ends")
        self.refused_text("poly", text[:text.index("8")], "line 3")  # in the middle of a line
        for end in range(1, len(geojson()), 10):
            self.refused_text("geojson", geojson()[:end], "not JSON here", f"byte {end}")

    def test_coordinates_that_are_no_numbers(self):
        for word, says in (("nan", "not a finite number"), ("-nan", "not a finite number"),
                           ("inf", "not a finite number"), ("1e999", "not a finite number"),
                           ("zero", "'zero' is not a number"), ("0x8", "'0x8' is not a number"),
                           ("8,0", "'8,0' is not a number")):
            self.refused_text("poly", poly([], []).replace("1 8 0", f"1 8 {word}"), "line 3, character 5", says)
        for word in ("NaN", "-Infinity", "1.", "0x8"):
            self.refused_text("geojson", geojson().replace("[8, 0]", f"[8, {word}]"), "not JSON here", "byte ")
        self.refused_text("geojson", geojson().replace("[8, 0]", "[8, 1e999]"), "beyond the range of doubles")
        for word in ("null", '"0"', "true", "[0]", "{}"):
            self.refused_text("geojson", geojson().replace("[8, 0]", f"[8, {word}]"),
                              "geometries[0].coordinates[0][1][1]")

    def test_seeds_that_are_no_numbers(self):
        self.refused_text("poly", poly([], [])[:-2] + "1\n0 nan 1\n", "line 12, character 3", "not a finite number")
        self.refused_text("poly", poly([], []) + "1\n0 1 1 5 inf\n", "line 13, character 9", "not a finite number")

    def test_malformed_poly(self):
        good = poly([], [])
        for old, new, *says in (
            ("4 2 0 0", "4 3 0 0", "line 1", "3 dimensions"),
            ("4 2 0 0", "-4 2 0 0", "line 1, character 1", "'-4' is not a count"),
            ("4 2 0 0", "4.5 2 0 0", "line 1, character 1", "'4.5' is not a count"),
            ("4 2 0 0", "5000000000 2 0 0", "line 1, character 1", "is not a count"),
            ("4 2 0 0", "4 2 0 2", "line 1", "2 boundary markers are too many"),
            ("4 2 0 0", "4 2 0 0 0", "line 1", "5 columns"),
            ("4 2 0 0", "4 2 1 0", "line 2", "3 columns where 4"),
            ("4 2 0 0", "5 2 0 0", "line 6", "2 columns where 3"),
            ("4 2 0 0", "3 2 0 0", "line 5"),
            ("1 8 0", "1 8", "line 3", "2 columns where 3"),
            ("1 8 0", "1 8 0 7", "line 3", "4 columns where 3"),
            ("1 8 0", "2 8 0", "line 3, character 1", "vertex 2 stands where 1 must"),
            ("0 0 0", "5 0 0", "line 2, character 1", "'5' is not the first vertex"),
            ("4 0\n", "4 2\n", "line 6, character 3", "2 boundary markers are too many"),
            ("1 1 2", "1 1 9", "line 8, character 5", "there is no vertex 9", "0 to 3"),
            ("1 1 2", "1 -1 2", "line 8, character 3", "there is no vertex -1"),
            ("1 1 2", "1 1.5 2", "line 8, character 3", "there is no vertex 1.5"),
            ("1 1 2", "1 1", "line 8", "2 columns where 3"),
            ("1 1 2", "1 1 2 7", "line 8", "4 columns where 3"),
            ("3 3 0\n0", "3 3 0\n0\n0\n1", "line 13", "after the last region"),
        ):
            self.assertIn(old, good)
            self.refused_text("poly", good.replace(old, new, 1), *says)
        marked = good.replace("4 0\n", "4 1\n").replace("1 1 2", "1 1 2 3000000000")
        self.refused_text("poly", marked, "line 8, character 7", "is not a marker")

    def test_bytes_that_are_no_text(self):
        self.refused_text("poly", b"4 2 0 0\n0 0 0\0\n", "a byte is zero")
        self.refused_text("poly", b"\xff\xfe4 2 0 0\n", "line 1")
        self.refused_text("geojson", b'{"type": "\xff"}', "not JSON here")
        self.refused_text("geojson", b'{"type": "Point\0"}', "not JSON here")

    def test_malformed_geojson(self):
        for value, *says in (
            (5, "the whole", "is not an object"),
            ([], "the whole", "is not an object"),
            ({}, 'has no "type"'),
            ({"type": 7}, "type", "is not a text"),
            ({"type": "Circle", "coordinates": []}, '"Circle" is no type of GeoJSON'),
            ({"type": "polygon", "coordinates": []}, '"polygon" is no type of GeoJSON'),
            ({"type": "Polygon"}, 'has no "coordinates"'),
            ({"type": "Polygon", "coordinates": {}}, "coordinates", "is not a list"),
            ({"type": "Polygon", "coordinates": [OUTLINE[0]]}, "coordinates[0][0]", "is not a list"),
            ({"type": "Polygon", "coordinates": [[[0], [1, 1]]]}, "coordinates[0][0]", "not a position"),
            ({"type": "Polygon", "coordinates": [[[0, 0]]]}, "coordinates[0]", "one position"),
            ({"type": "LineString", "coordinates": [[0, 0]]}, "coordinates", "one position"),
            ({"type": "FeatureCollection"}, 'has no "features"'),
            ({"type": "FeatureCollection", "features": {}}, "features", "is not a list"),
            ({"type": "FeatureCollection", "features": [{"type": "Feature"}]}, "features[0]", 'has no "geometry"'),
            ({"type": "GeometryCollection", "geometries": [None]}, "geometries[0]", "is not an object"),
            ({"type": "Feature", "geometry": "Polygon"}, "geometry", "is not an object"),
            ({"type": "Feature", "properties": {"marker": 1.5}, "geometry": None}, "properties.marker", "32 bits"),
            ({"type": "Feature", "properties": {"marker": 1e10}, "geometry": None}, "properties.marker", "32 bits"),
            ({"type": "Feature", "properties": {"marker": "wall"}, "geometry": None}, "properties.marker", "32 bits"),
        ):
            self.refused_text("geojson", json.dumps(value), *says)
        self.refused_text("geojson", geojson() + geojson(), "not JSON here")
        self.refused_text("geojson", "[" * 100_000, "too deep")


if __name__ == "__main__":
    harness.main()
