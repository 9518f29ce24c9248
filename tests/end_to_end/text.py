"""Points as text: Python's float() reads the same bits, attributes arrive in the mesh, NumPy's own files are read."""

import decimal
import random
import struct
import unittest

import harness

try:
    import h5py
    import numpy
except ImportError:
    h5py = None


def bits(value):
    return struct.pack("<d", value + 0.0)


def decimals(count):
    """Decimals that are hard to round: random doubles in three notations, long ones, and halfway cases."""
    chance = random.Random(7)
    decimal.getcontext().prec = 1200
    made = []
    while len(made) < count:
        value = struct.unpack("<d", chance.randbytes(8))[0] if len(made) % 2 else chance.uniform(-1e6, 1e6)
        if not abs(value) < 1e300:
            continue
        made += [repr(value), f"{value:.17g}", f"{value:.45g}"]
        if abs(value) > 1e-300:
            half = (decimal.Decimal(value) + decimal.Decimal(float(numpy.nextafter(value, 1e308)))) / 2
            made += [f"{half:e}", f"{half * (1 + decimal.Decimal(10) ** -1100):e}", f"{half:+E}"]
    return made[:count]


@unittest.skipIf(h5py is None, "numpy or h5py is absent")
class Text(harness.TestCase):
    def sites_of(self, mesh, *names):
        """Input index to (x, y, z, attributes...)."""
        with h5py.File(mesh) as file:
            group = file["VTKHDF"]
            own = group["PointData/vtkGhostType"][:] == 0
            columns = [group["Points"][:][own]] + [group["PointData"][name][:][own][:, None] for name in names]
            return dict(zip(group["PointData/input_index"][:][own].tolist(), numpy.hstack(columns).tolist()))

    def test_rounded_as_python_does(self):
        texts = decimals(6000)
        path = self.folder / "hard.txt"
        pairs = list(zip(texts[::2], texts[1::2]))
        path.write_text("".join(f"{x} {y}\n" for x, y in pairs))
        raw = self.folder / "hard.f64"
        harness.write_f64(raw, [(float(x), float(y)) for x, y in pairs])
        for ranks in (0, 3):
            mesh = self.folder / "hard.vtkhdf"
            self.succeed("triangulate", path, "-o", mesh, ranks=ranks)
            self.succeed("verify", mesh, "--points", raw)
            for index, (x, y, *_) in self.sites_of(mesh).items():
                self.assertEqual(bits(x), bits(float(pairs[index][0])), pairs[index][0])
                self.assertEqual(bits(y), bits(float(pairs[index][1])), pairs[index][1])

    def test_written_as_python_reads(self):
        for distribution, extension, separator in (
            ("lidar", "xyz", None), ("lidar", "csv", ","), ("uniform", "node", None), ("normal", "txt", None),
        ):
            whole = set()
            for ranks in (0, 3):
                raw, text = self.folder / "some.npy", self.folder / f"some.{extension}"
                self.succeed("generate", distribution, "-n", "2000", "--seed", "5", "-o", raw)
                self.succeed("generate", distribution, "-n", "2000", "--seed", "5", "-o", text, ranks=ranks)
                whole.add(text.read_bytes())
                lines = text.read_text().splitlines()[0 if extension in ("xyz", "txt") else 1 :]
                fields = [field for line in lines for field in line.split(separator)]
                # The fewest digits, as repr has them.
                self.assertTrue(all(decimal.Decimal(f) == decimal.Decimal(repr(float(f))) for f in fields))
                read = [[float(field) for field in line.split(separator)] for line in lines]
                read = numpy.array(read)[:, 1 if extension == "node" else 0 :]
                self.assertEqual(read.tobytes(), numpy.load(raw).tobytes())
            self.assertEqual(len(whole), 1)

    def test_attributes_arrive(self):
        rows = numpy.random.default_rng(3).uniform(-5, 5, (500, 5))
        named = self.folder / "named.csv"
        numpy.savetxt(named, rows, delimiter=",", header="x,y,z,intensity,time of day", comments="", fmt="%.17g")
        array = self.folder / "array.npy"
        records = self.folder / "records.npy"
        numpy.save(array, rows)
        fields = numpy.zeros(500, [("intensity", "<f8"), ("time of day", "<f8"), ("x", "<f8"), ("y", "<f8"), ("z", "<f8")])
        for column, name in enumerate(("x", "y", "z", "intensity", "time of day")):
            fields[name] = rows[:, column]
        numpy.save(records, fields)
        plain = ("column 4", "column 5")
        for path, names in ((named, ("intensity", "time of day")), (array, plain), (records, ("intensity", "time of day"))):
            mesh = self.folder / "mesh.vtkhdf"
            self.succeed("triangulate", path, "-o", mesh, "--slabs", 4, ranks=3)
            self.succeed("verify", mesh, "--points", path, ranks=2)
            sites = self.sites_of(mesh, *names)
            self.assertEqual(len(sites), 500)
            for index, row in sites.items():
                self.assertEqual(row, rows[index].tolist())
            out = self.succeed("info", path).out
            self.assertIn("z, " + ", ".join(names), out)
            self.assertRegex(out, r"points +500\n")

    def test_coordinates_by_name(self):
        path, mesh = self.folder / "numbered.csv", self.folder / "numbered.vtkhdf"
        path.write_text("id,X,Y,Z\n7,0,1,5\n8,2,3,6\n9,4,1,7\n")
        self.assertRegex(self.succeed("info", path).out, r"x and y +columns 2 and 3\n")
        self.succeed("triangulate", path, "-o", mesh)
        self.assertEqual(self.sites_of(mesh, "id"), {0: [0, 1, 5, 7], 1: [2, 3, 6, 8], 2: [4, 1, 7, 9]})

    def test_attributes_of_some_files_only(self):
        first, second = self.folder / "first.csv", self.folder / "second.txt"
        first.write_text("x,y,weight\n0,0,5\n1,0,6\n")
        second.write_text("0 1 7\n1 1 8\n2 2 9\n")
        mesh = self.folder / "both.vtkhdf"
        run = self.succeed("triangulate", first, second, "-o", mesh, ranks=2)
        self.assertIn("2 points without z got z = 0", run.out)
        self.assertIn("3 points without weight got NaN", run.out)
        sites = self.sites_of(mesh, "weight")
        self.assertEqual([sites[i][2] for i in range(5)], [0, 0, 7, 8, 9])
        self.assertEqual([sites[i][3] for i in range(2)], [5, 6])
        self.assertTrue(all(numpy.isnan(sites[i][3]) for i in range(2, 5)))
        self.succeed("verify", mesh, "--points", first, second, ranks=3)
        self.succeed("verify", mesh)

    def test_vertices_of_triangle(self):
        path = self.folder / "square.node"
        path.write_text("# made by hand\n4 2 1 1\n  1  0 0  10 1\n  2  1 0  11 1\n  3  1 1  12 1\n  4  0 1  13 0\n")
        mesh = self.folder / "square.vtkhdf"
        self.succeed("triangulate", path, "-o", mesh, ranks=2)
        sites = self.sites_of(mesh, "attribute 1", "marker")
        self.assertEqual(sites, {0: [0, 0, 0, 10, 1], 1: [1, 0, 0, 11, 1], 2: [1, 1, 0, 12, 1], 3: [0, 1, 0, 13, 0]})
        self.succeed("verify", mesh, "--points", path)


if __name__ == "__main__":
    harness.main()
