"""Pictures of `dovetail render`: pixels against points in triangles from the arrays of the file, the same bytes on every
number of ranks, well-formed SVG, and every refusal."""

import struct
import unittest
import xml.etree.ElementTree
import zlib

import harness
from harness import FULL, dovetail, write_f64

try:
    import h5py
    import numpy as np
except ImportError as missing:
    if FULL:
        raise
    h5py = None
    print(missing)

SVG = "{http://www.w3.org/2000/svg}"
RANKS = (0, 2, 3, 5)


def read_png(path):
    """The pixels (rows, columns, 3) of a PNG of eight bits a channel, not interlaced."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert (depth, colour, interlaced) == (8, 2, 0)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    assert kind == b"IEND"
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    rows = np.zeros((height + 1, 3 * width + 3), np.int64)  # with a pixel of zeros on the left, a row of them above
    for y, line in enumerate(raw):
        kind, above, row = line[0], rows[y], rows[y + 1]
        if kind == 0:
            row[3:] = line[1:]
        elif kind == 2:
            row[3:] = (line[1:] + above[3:]) % 256
        else:
            for i in range(3, 3 * width + 3):
                left, up, corner = row[i - 3], above[i], above[i - 3]
                near = left + up - corner
                paeth = min((abs(near - left), 0, left), (abs(near - up), 1, up), (abs(near - corner), 2, corner))[2]
                row[i] = (line[i - 2] + {1: left, 3: (left + up) // 2, 4: paeth}[kind]) % 256
    return rows[1:, 3:].reshape(height, width, 3)


def triangles_of(mesh):
    """Corners (triangles, 3, 2) and the slab of every triangle."""
    with h5py.File(mesh) as file:
        vtk = file["VTKHDF"]
        first = np.concatenate(([0], np.cumsum(vtk["NumberOfPoints"][:])))
        cells = vtk["NumberOfCells"][:]
        corners = vtk["Connectivity"][:].reshape(-1, 3) + np.repeat(first[:-1], cells)[:, None]
        return vtk["Points"][:, :2][corners], np.repeat(np.arange(len(cells)), cells)


def containing(triangles, point):
    """The number of the triangle that has the point well inside, or None."""
    a, b, c = triangles[:, 0] - point, triangles[:, 1] - point, triangles[:, 2] - point
    inside = [p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((a, b), (b, c), (c, a))]
    found = np.flatnonzero(np.minimum(np.minimum(*inside[:2]), inside[2]) > 0)
    return found[0] if len(found) == 1 else None


@unittest.skipIf(h5py is None, "h5py or numpy is not installed")
class Render(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()

        def make(name, kind, n, *how):
            points, mesh = cls.folder / f"{name}.npy", cls.folder / f"{name}.vtkhdf"
            run = dovetail("generate", kind, "-n", n, "--seed", 6, "-o", points, "--quiet")
            assert run.code == 0, run
            run = dovetail("triangulate", points, "-o", mesh, "--quiet", *how)
            assert run.code == 0, run
            return mesh

        cls.fine = make("fine", "uniform", 20000, "--slabs", 4, "--axis", "x")
        cls.coarse = make("coarse", "uniform", 60, "--slabs", 3)
        cls.relief = make("relief", "lidar", 4000, "--slabs", 5, "--axis", "y")

    def draw(self, name, *arguments, ranks=0):
        picture = self.folder / name
        self.succeed("render", *arguments, "-o", picture, "--quiet", ranks=ranks)
        return picture

    def test_colours_of_slabs_where_they_are(self):
        # Narrow enough for neither text nor margins: the window is the picture.
        size, low, high = 270, 0.05, 0.95
        pixels = read_png(self.draw("slabs.png", self.fine, "--width", size, "--window", f"{low},{low},{high},{high}"))
        self.assertEqual(pixels.shape, (size, size, 3))
        triangles, slab = triangles_of(self.fine)
        colours = {}
        rng = np.random.default_rng(2)
        for column, row in rng.integers(0, size, (150, 2)):
            found = set()
            for dx, dy in ((0.5, 0.5), (0, 0), (0, 1), (1, 0), (1, 1)):
                x, y = low + (column + dx) * (high - low) / size, high - (row + dy) * (high - low) / size
                triangle = containing(triangles, np.array([x, y]))
                found.add(-1 if triangle is None else slab[triangle])
            if len(found) == 1 and -1 not in found:
                colours.setdefault(found.pop(), set()).add(tuple(pixels[row, column]))
        self.assertGreaterEqual(len(colours), 2)
        self.assertTrue(all(len(seen) == 1 for seen in colours.values()), colours)
        self.assertEqual(len(set.union(*colours.values())), len(colours))

    def test_lightness_rises_with_angle_and_area(self):
        triangles, _ = triangles_of(self.coarse)
        back = np.roll(triangles, 1, axis=1) - triangles
        on = np.roll(triangles, -1, axis=1) - triangles
        cross = np.abs(back[..., 0] * on[..., 1] - back[..., 1] * on[..., 0])
        values = {"angle": np.degrees(np.arctan2(cross, (back * on).sum(axis=2))).min(axis=1), "area": cross[:, 0] / 2}
        size = 270
        middles = triangles.mean(axis=1)
        inradius = cross[:, 0] / np.hypot(*np.moveaxis(on, 2, 0)).sum(axis=1)
        roomy = np.flatnonzero(inradius * size > 4)  # their middles are far from drawn edges
        self.assertGreater(len(roomy), 20)
        for by, value in values.items():
            pixels = read_png(self.draw(f"{by}.png", self.coarse, "--by", by, "--width", size, "--window", "0,0,1,1"))
            seen = [pixels[int((1 - y) * size), int(x * size)] @ (0.2126, 0.7152, 0.0722) for x, y in middles[roomy]]
            seen = np.array(seen)[np.argsort(value[roomy])]
            self.assertTrue((np.diff(seen) >= -1.5).all(), (by, seen))
            self.assertGreater(seen[-1] - seen[0], 60)

    def test_colours_are_for_what_is_seen(self):
        # Nearly all triangles are in a corner too small to see: the others have all colours nevertheless.
        rng = np.random.default_rng(3)
        points, mesh, size = self.folder / "corner.f64", self.folder / "corner.vtkhdf", 270
        write_f64(points, [*(rng.random((3000, 2)) * 1e-3).tolist(), *rng.random((60, 2)).tolist(), (1, 1)])
        self.succeed("triangulate", points, "-o", mesh, "--quiet")
        triangles, _ = triangles_of(mesh)
        u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        area = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
        order = [t for t in np.argsort(area) if area[t] > 1e-3]
        picture = self.draw("corner.png", mesh, "--by", "area", "--width", size, "--window", "0,0,1,1", ranks=3)
        pixels = read_png(picture)
        middles = triangles[order].mean(axis=1)
        seen = [pixels[int((1 - y) * size), int(x * size)] @ (0.2126, 0.7152, 0.0722) for x, y in middles]
        quarter = len(order) // 4
        self.assertGreater(np.median(seen[-quarter:]) - np.median(seen[:quarter]), 40)

    def test_every_number_of_ranks_makes_the_same_bytes(self):
        for name, *arguments in (
            ("a.png", self.fine, "--paths", "--hull", "--width", 700),
            ("b.png", self.relief, "--by", "elevation", "--paths", "--hull", "--width", 500),
            ("c.png", self.coarse, "--by", "area", "--hull", "--width", 2600),  # several bands
            ("d.png", self.fine, "--by", "angle", "--width", 333, "--window", "0.4,0.4,0.45,0.47", "--paths"),
            ("e.svg", self.relief, "--by", "elevation", "--paths", "--hull"),
        ):
            first = self.draw(name, *arguments).read_bytes()
            for ranks in RANKS[1:]:
                again = self.draw(f"again-{name}", *arguments, ranks=ranks).read_bytes()
                self.assertTrue(again == first, (name, ranks))

    def test_svg(self):
        tree = xml.etree.ElementTree.parse(self.draw("coarse.svg", self.coarse, "--paths", "--hull", ranks=3)).getroot()
        triangles, _ = triangles_of(self.coarse)
        self.assertEqual(len(list(tree.iter(f"{SVG}polygon"))), len(triangles))
        with h5py.File(self.coarse) as file:
            self.assertEqual(len(list(tree.iter(f"{SVG}line"))), file["dovetail"].attrs["hull_edges"])
            lengths = np.diff(file["dovetail/path_offsets"][:])[1:].tolist()
        drawn = [len(line.get("points").split()) for line in tree.iter(f"{SVG}polyline")]
        self.assertEqual(drawn, 2 * lengths)  # white below black
        self.assertTrue(any("triangles" in text.text for text in tree.iter(f"{SVG}text")))

    def test_legends(self):
        def texts(*arguments):
            tree = xml.etree.ElementTree.parse(self.draw("legend.svg", *arguments)).getroot()
            return [text.text for text in tree.iter(f"{SVG}text")]

        self.assertIn("slab 3: 5,000 sites", texts(self.fine, "--window", "0,0,0.1,0.1"))
        self.assertEqual(texts(self.coarse, "--by", "angle")[-7:], ["0", "10", "20", "30", "40", "50", "60"])
        # All values are told, also those that the scale leaves out.
        triangles, _ = triangles_of(self.coarse)
        u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
        (name,) = [text for text in texts(self.coarse, "--by", "area") if text.startswith("area")]
        self.assertRegex(name, r"^area \(logarithmic\), [\d.]+ to [\d.]+ in all$")
        least, _, greatest = name.split()[2:5]
        self.assertTrue(np.allclose([float(least), float(greatest)], [areas.min(), areas.max()], rtol=0.01), name)

    def test_few_sites(self):
        for count in (1, 2, 5):
            points, mesh = self.folder / f"line{count}.f64", self.folder / f"line{count}.vtkhdf"
            write_f64(points, [(float(i), 0.0) for i in range(count)])
            self.succeed("triangulate", points, "-o", mesh, "--quiet")
            for by in ("slab", "angle", "area"):
                self.assertGreater(read_png(self.draw("line.png", mesh, "--by", by, "--width", 320, ranks=2)).shape[0], 0)

    def test_refusals(self):
        picture = self.folder / "refused.png"
        narrow = ("--window", "5,5,6,6")
        many = self.folder / "refused.svg"
        for code, says, *arguments in (
            (2, (".png or .svg", "gif"), self.fine, "-o", self.folder / "refused.gif"),
            (2, ("has no z",), self.fine, "-o", picture, "--by", "elevation"),
            (2, ("beside the mesh",), self.fine, "-o", picture, *narrow),
            (2, ("is empty",), self.fine, "-o", picture, "--window", "1,0,0,1"),
            (2, ("x0,y0,x1,y1",), self.fine, "-o", picture, "--window", "1,0,0"),
            (2, ("15",), self.fine, "-o", picture, "--width", "15"),
            (2, ("20001",), self.fine, "-o", picture, "--width", "20001"),
            (2, ("colour",), self.fine, "-o", picture, "--by", "colour"),
            (1, ("no_such",), self.folder / "no_such.vtkhdf", "-o", picture),
            (1, ("no_folder",), self.fine, "-o", self.folder / "no_folder" / "a.png"),
        ):
            for ranks in (0, 3):
                run = dovetail("render", *arguments, ranks=ranks)
                self.assertEqual((run.code, len(run.messages)), (code, 1), run)
                for text in says:
                    self.assertIn(text, run.messages[0], run)
                self.assertFalse(picture.exists() or many.exists())
                self.assertEqual(self.leftovers(), [])


if __name__ == "__main__":
    harness.main()
