"""autzen_trim.las, a real survey: known counts, heights in the output, read by h5py."""

import struct
import unittest

import harness

try:
    import h5py
    import numpy
except ImportError:
    h5py = None

LAS = harness.data_file("autzen_trim.las")
SITES, DUPLICATES = 109_993, 7


def las_points(path):
    """x, y, z of every record, straight from the specification of LAS 1.2."""
    content = path.read_bytes()
    offset_to_points = struct.unpack_from("<I", content, 96)[0]
    record_bytes = struct.unpack_from("<H", content, 105)[0]
    count = struct.unpack_from("<I", content, 107)[0]
    scale = numpy.array(struct.unpack_from("<3d", content, 131))
    offset = numpy.array(struct.unpack_from("<3d", content, 155))
    records = numpy.frombuffer(content, numpy.uint8, count * record_bytes, offset_to_points)
    raw = records.reshape(count, record_bytes)[:, :12].copy().view("<i4")
    return raw * scale + offset


@unittest.skipIf(LAS is None, "autzen_trim.las is absent")
class RealData(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = cls.folder / "autzen.vtkhdf"
        cls.run_ = harness.dovetail("triangulate", LAS, "-o", cls.mesh, "--slabs", 5, ranks=3)
        assert cls.run_.code == 0, cls.run_

    def test_counts(self):
        report = self.report_of("verify", self.mesh, "--points", LAS, ranks=2)
        self.assertIs(report["valid"], True)
        self.assertEqual((report["sites"], report["duplicates"]), (SITES, DUPLICATES))
        self.assertEqual(report["points"], SITES + DUPLICATES)
        self.assertIn("109,993", self.run_.out)
        self.assertIn("7 duplicates", self.run_.out)
        self.assertEqual(report["checksum"], self.report_of("triangulate", LAS, "-o", "none")["checksum"])

    def test_info(self):
        self.assertIn("LAS 1.2", self.succeed("info", LAS).out)
        out = self.succeed("info", self.mesh).out
        self.assertIn("109,993", out)
        self.assertIn("coordinate system", out)

    def test_classes(self):
        ground = self.folder / "ground.vtkhdf"
        report = self.report_of("triangulate", LAS, "-o", ground, "--class", "2", ranks=2)
        self.assertEqual(report["points"] + report["other_class"] + report["withheld"], SITES + DUPLICATES)
        self.assertGreater(report["other_class"], 0)
        self.succeed("verify", ground, "--points", LAS, "--class", "2")
        self.assertEqual(harness.dovetail("verify", ground, "--points", LAS).code, 1)

    def test_which_duplicate_is_kept(self):
        if h5py is None:
            self.skipTest("h5py is absent")
        points = las_points(LAS)
        _, inverse = numpy.unique(points[:, :2], axis=0, return_inverse=True)
        expected = {"lowest": numpy.full(inverse.max() + 1, numpy.inf), "highest": numpy.full(inverse.max() + 1, -numpy.inf)}
        numpy.minimum.at(expected["lowest"], inverse, points[:, 2])
        numpy.maximum.at(expected["highest"], inverse, points[:, 2])
        for rule, heights in expected.items():
            mesh = self.folder / f"{rule}.vtkhdf"
            self.succeed("triangulate", LAS, "-o", mesh, "--duplicates", rule, ranks=3)
            with h5py.File(mesh) as file:
                group = file["VTKHDF"]
                own = group["PointData/vtkGhostType"][:] == 0
                z = group["Points"][:][own, 2]
                index = group["PointData/input_index"][:][own]
            self.assertTrue((z == heights[inverse[index]]).all(), rule)

    @unittest.skipIf(h5py is None, "h5py is absent")
    def test_h5py(self):
        points = las_points(LAS)
        with h5py.File(self.mesh) as file:
            group = file["VTKHDF"]
            self.assertEqual(group.attrs["Type"], b"UnstructuredGrid")
            own = group["PointData/vtkGhostType"][:] == 0
            self.assertEqual(int(own.sum()), SITES)
            index = group["PointData/input_index"][:]
            read = group["Points"][:]
            # Every vertex, ghosts too, is the point of the survey that it says it is, height included.
            self.assertTrue((read == points[index]).all())
            # Triangles: partition by partition, counter-clockwise, and as many as Euler's relation has.
            connectivity = group["Connectivity"][:].reshape(-1, 3)
            firsts = numpy.concatenate([[0], numpy.cumsum(group["NumberOfPoints"][:])[:-1]])
            shift = numpy.repeat(firsts, group["NumberOfCells"][:])
            a, b, c = (read[connectivity[:, i] + shift] for i in range(3))
            area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
            self.assertTrue((area > 0).all())
            hull_edges = int((file["dovetail/neighbours"][:] == -1).sum())
            self.assertEqual(len(connectivity), 2 * SITES - 2 - hull_edges)
            self.assertEqual(file["dovetail/duplicates"].shape, (DUPLICATES, 2))


LAKE = harness.data_file("lake_superior.xyz")


@unittest.skipIf(LAKE is None, "lake_superior.xyz is absent")
class Shoreline(harness.TestCase):
    """A shoreline as text: 1,552 points, `x y` in every line."""

    def test_shoreline(self):
        points = [tuple(map(float, line.split())) for line in LAKE.read_text().splitlines()]
        checksums = set()
        for ranks in (0, 3):
            mesh = self.folder / "lake.vtkhdf"
            report = self.report_of("triangulate", LAKE, "-o", mesh, ranks=ranks)
            self.assertEqual((report["points"], report["sites"]), (len(points), len(set(points))))
            self.assertEqual(report["triangles"], 2 * report["sites"] - 2 - report["hull_edges"])
            checksums.add(report["checksum"])
            self.succeed("verify", mesh, "--points", LAKE, ranks=ranks)
        # The same numbers as Python reads them.
        raw = self.folder / "lake.f64"
        harness.write_f64(raw, points)
        checksums.add(self.report_of("triangulate", raw, "-o", "none")["checksum"])
        self.assertEqual(len(checksums), 1)
        self.succeed("verify", mesh, "--points", raw)
        self.assertRegex(self.succeed("info", LAKE).out, r"text, 2 columns separated by blanks\npoints +1552\n")


if __name__ == "__main__":
    harness.main()
