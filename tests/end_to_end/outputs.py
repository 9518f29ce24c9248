"""Every format of mesh files, read back by programs that are not ours: readers written here from the formats'
specifications, over numpy alone. What the mesh is, h5py tells from the native file."""

import shutil
import subprocess
import unittest
import xml.etree.ElementTree

import harness
from harness import FULL, dovetail, write_las

try:
    import h5py
    import numpy as np
except ImportError as missing:
    if FULL:
        raise
    h5py = None
    print(missing)

RANKS = (0, 1, 2, 3, 5, 8) if FULL else (0, 3)  # all of them in process: tests/mpi/mesh_outputs.cpp
FILE_LIMIT = 12 << 20  # leaves room for MPI's own files


class Mesh:
    """A native mesh file as arrays over the whole mesh."""

    def __init__(self, path):
        with h5py.File(path) as file:
            vtk, own = file["VTKHDF"], file["dovetail"]
            self.names = [name.decode() for name in own["attributes"][:]]
            ends = np.cumsum(vtk["NumberOfPoints"][:])
            cells = np.concatenate([[0], np.cumsum(vtk["NumberOfCells"][:])])
            starts = ends - vtk["NumberOfPoints"][:]
            self.slab_vertices = [slice(a, b) for a, b in zip(starts, ends)]
            self.slab_triangles = [slice(a, b) for a, b in zip(cells, cells[1:])]
            self.all_points = vtk["Points"][:]
            self.all_numbers = vtk["PointData/global_number"][:]
            self.all_indices = vtk["PointData/input_index"][:]
            self.ghost = vtk["PointData/vtkGhostType"][:]
            self.local = vtk["Connectivity"][:].reshape(-1, 3)
            attributes = {n: vtk["PointData"][n][:] for n in self.names if n != "z"}
            self.neighbours = own["neighbours"][:]
            self.duplicates = own["duplicates"][:]
            self.duplicate_z = own["duplicate_z"][:] if "z" in self.names else None
            self.offsets = own["site_offsets"][:]
        own = self.ghost == 0
        self.points = self.all_points[own]
        self.indices = self.all_indices[own]
        self.attributes = {n: (self.points[:, 2] if n == "z" else attributes[n][own]) for n in self.names}
        self.triangles = np.concatenate(
            [np.zeros((0, 3), int)]
            + [self.all_numbers[v][self.local[t]] for v, t in zip(self.slab_vertices, self.slab_triangles)]
        )


def same_bits(a, b):
    """Equal bit for bit, so that -0.0 is not 0.0."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def files_of(folder, stem):
    """Name and contents of all files whose names begin so."""
    return {path.name.removeprefix(stem): path.read_bytes() for path in folder.iterdir() if path.name.startswith(stem)}


def read_ply(path):
    """Vertices and faces, by Turk's description of the format."""
    content = path.read_bytes()
    head, _, body = content.partition(b"end_header\n")
    lines = head.decode("ascii").splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines
    types = {"double": "<f8", "int": "<i4", "uchar": "u1"}
    elements = {}
    for line in lines[2:]:
        word, *rest = line.split()
        if word == "element":
            fields = []
            elements[rest[0]] = (int(rest[1]), fields)
        elif rest[0] == "list":
            fields += [("count", types[rest[1]]), ("corners", types[rest[2]], (3,))]
        else:
            fields.append((rest[1], types[rest[0]]))
    arrays, place = [], 0
    for name in ("vertex", "face"):
        count, fields = elements[name]
        arrays.append(np.frombuffer(body, np.dtype(fields), count, place))
        place += arrays[-1].nbytes
    assert place == len(body)
    return arrays


VTK_TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}


def read_vtu(path):
    """The arrays of a file of one piece, appended raw, by VTK's description of its XML formats."""
    content = path.read_bytes()
    head, _, appended = content.partition(b'<AppendedData encoding="raw">\n_')
    root = xml.etree.ElementTree.fromstring(head + b"</VTKFile>")
    assert (root.get("type"), root.get("byte_order")) == ("UnstructuredGrid", "LittleEndian")
    assert root.get("header_type") == "UInt64"
    (piece,) = root.iter("Piece")
    rows = {"Points": int(piece.get("NumberOfPoints")), "Cells": int(piece.get("NumberOfCells"))}
    rows["PointData"] = rows["Points"]
    arrays, end = {}, 0
    for group in piece:
        for array in group:
            assert array.get("format") == "appended"
            place = int(array.get("offset"))
            assert place == end
            (length,) = np.frombuffer(appended, "<u8", 1, place)
            end = place + 8 + int(length)
            values = np.frombuffer(appended[place + 8 : end], VTK_TYPES[array.get("type")])
            components = int(array.get("NumberOfComponents"))
            values = values if components == 1 else values.reshape(-1, components)
            assert len(values) == rows[group.tag] * (3 if array.get("Name") == "connectivity" else 1)
            arrays[array.get("Name")] = values
    assert appended[end:].split() == [b"</AppendedData>", b"</VTKFile>"], appended[end:]
    return arrays


class read_msh:
    """A binary file by the section "MSH file format" of Gmsh's manual."""

    def __init__(self, path):
        self.content, self.place = path.read_bytes(), 0
        self.section("MeshFormat", lambda: (self.expect(b"4.1 1 8\n"), self.expect(b"\1\0\0\0")))
        self.section("Entities", self.read_entities)
        self.section("PartitionedEntities", self.read_partitions)
        self.section("Nodes", self.read_nodes)
        self.section("Elements", self.read_elements)
        assert self.place == len(self.content)

    def expect(self, text):
        found = self.content[self.place : self.place + len(text)]
        assert found == text, (self.place, found, text)
        self.place += len(text)

    def section(self, name, read):
        self.expect(f"${name}\n".encode())
        read()
        self.expect(f"\n$End{name}\n".encode())

    def take(self, dtype, count=1):
        values = np.frombuffer(self.content, dtype, count, self.place)
        self.place += values.nbytes
        return values

    def sizes(self, count=1):
        return self.take("<u8", count).tolist()

    def ints(self, count=1):
        return self.take("<i4", count).tolist()

    def read_surface_end(self):
        """Bounding box, physical groups, bounding curves."""
        box = self.take("<f8", 6).tolist()
        self.ints(self.sizes()[0])
        self.ints(self.sizes()[0])
        return tuple(box)

    def read_entities(self):
        assert self.sizes(4) == [0, 0, 1, 0]
        assert self.ints() == [1]
        self.box = self.read_surface_end()

    def read_partitions(self):
        partitions, ghosts, points, curves, surfaces, volumes = self.sizes(6)
        assert (ghosts, points, curves, surfaces, volumes) == (0, 0, 0, partitions, 0)
        self.partitions = []
        for _ in range(surfaces):
            tag, dimension, parent = self.ints(3)
            self.partitions.append((tag, dimension, parent, self.ints(self.sizes()[0])))
            self.read_surface_end()

    def read_nodes(self):
        blocks, total, lowest, highest = self.sizes(4)
        self.node_blocks = []
        for _ in range(blocks):
            dimension, tag, parametric = self.ints(3)
            assert (dimension, parametric) == (2, 0)
            (count,) = self.sizes()
            tags = self.take("<u8", count)
            self.node_blocks.append((tag, dimension, tags, self.take("<f8", 3 * count).reshape(-1, 3)))
        tags = np.concatenate([np.zeros(0, "<u8")] + [block[2] for block in self.node_blocks])
        assert (total, lowest, highest) == (len(tags), min(tags, default=0), max(tags, default=0))

    def read_elements(self):
        blocks, total, lowest, highest = self.sizes(4)
        self.element_blocks = []
        for _ in range(blocks):
            dimension, tag, element = self.ints(3)
            assert dimension == 2
            (count,) = self.sizes()
            self.element_blocks.append((tag, element, self.take("<u8", 4 * count).reshape(-1, 4)))
        tags = np.concatenate([np.zeros(0, "<u8")] + [block[2][:, 0] for block in self.element_blocks])
        assert (total, lowest, highest) == (len(tags), min(tags, default=0), max(tags, default=0))


@unittest.skipIf(h5py is None, "h5py or numpy is not installed")
class Outputs(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        random = np.random.default_rng(7)
        sets = {
            # Seventeen digits, exponents of all sizes, and equal points whose heights differ.
            "wide": np.ldexp(random.standard_normal((3000, 3)), random.integers(-60, 60, (3000, 1))),
            "lattice": np.stack(np.meshgrid(np.arange(30.0), np.arange(20.0)), -1).reshape(-1, 2),
            "line": np.array([(i, 2.0 * i) for i in range(9)]),
            "none": np.zeros((0, 2)),
        }
        sets["wide"][100:200, :2] = sets["wide"][1100:1200, :2]
        sets["wide"][7, :2] = (5e-324, 1.7976931348623157e100)
        cls.inputs, cls.mesh = sets, {}
        for name, points in sets.items():
            np.save(cls.folder / f"{name}.in.npy", points)
            native = cls.folder / f"{name}.vtkhdf"
            run = dovetail("triangulate", cls.folder / f"{name}.in.npy", "--slabs", 4, "-o", native)
            assert run.code == 0, run
            cls.mesh[name] = Mesh(native)
        assert len(cls.mesh["wide"].duplicates) == 100

    def each(self, extension):
        """Every mesh converted, with the path of its output."""
        for name, mesh in self.mesh.items():
            output = self.folder / f"{name}.out{extension}"
            self.succeed("convert", self.folder / f"{name}.vtkhdf", output, "--quiet", ranks=2)
            yield name, mesh, output

    def test_npy(self):
        for _, mesh, output in self.each(".npy"):
            read = {part: np.load(output.with_suffix(f".{part}.npy")) for part in ("points", "index", "triangles", "neighbours")}
            columns = mesh.points if "z" in mesh.names else mesh.points[:, :2]
            self.assertTrue(same_bits(read["points"], np.ascontiguousarray(columns)))
            self.assertTrue(same_bits(read["index"], mesh.indices))
            self.assertTrue(same_bits(read["triangles"], mesh.triangles))
            self.assertTrue(same_bits(read["neighbours"], mesh.neighbours))

    def test_ply(self):
        for _, mesh, output in self.each(".ply"):
            vertices, faces = read_ply(output)
            for column, axis in enumerate("xyz"):
                self.assertTrue(same_bits(vertices[axis].copy(), mesh.points[:, column].copy()))
            self.assertTrue(np.all(faces["count"] == 3))
            self.assertTrue(np.array_equal(faces["corners"], mesh.triangles))

    def test_vtu(self):
        for _, mesh, output in self.each(".vtu"):
            arrays = read_vtu(output)
            self.assertTrue(same_bits(arrays["Points"], mesh.points))
            self.check_cells(arrays, mesh.triangles, np.int64)
            self.assertTrue(same_bits(arrays["input_index"], mesh.indices))

    def check_cells(self, arrays, triangles, index):
        self.assertEqual(arrays["connectivity"].dtype, index)
        self.assertEqual(arrays["connectivity"].tolist(), triangles.ravel().tolist())
        self.assertEqual(arrays["offsets"].tolist(), (3 * np.arange(1, len(triangles) + 1)).tolist())
        self.assertEqual(arrays["types"].tolist(), [5] * len(triangles))

    def test_pvtu(self):
        for _, mesh, output in self.each(".pvtu"):
            summary = xml.etree.ElementTree.parse(output).getroot()
            self.assertEqual(summary.get("type"), "PUnstructuredGrid")
            pieces = [piece.get("Source") for piece in summary.iter("Piece")]
            self.assertEqual(len(pieces), len(mesh.slab_vertices))
            declared = {a.get("Name"): a.get("type") for a in summary.iter("PDataArray")}
            for piece, vertices, triangles in zip(pieces, mesh.slab_vertices, mesh.slab_triangles):
                arrays = read_vtu(output.parent / piece)
                self.assertTrue(same_bits(arrays["Points"], mesh.all_points[vertices]))
                self.check_cells(arrays, mesh.local[triangles], np.int32)
                self.assertTrue(same_bits(arrays["input_index"], mesh.all_indices[vertices]))
                self.assertTrue(same_bits(arrays["global_number"], mesh.all_numbers[vertices]))
                self.assertTrue(same_bits(arrays["vtkGhostType"], mesh.ghost[vertices]))
                for name in set(arrays) - {"connectivity", "offsets", "types"}:
                    self.assertEqual(VTK_TYPES[declared[name]], arrays[name].dtype)

    def test_msh(self):
        for _, mesh, output in self.each(".msh"):
            read = read_msh(output)
            slabs = len(mesh.slab_vertices)
            self.assertEqual(read.partitions, [(s + 2, 2, 1, [s + 1]) for s in range(slabs)])
            self.assertEqual([tag for tag, _, _, _ in read.node_blocks], [s + 2 for s in range(slabs) if mesh.offsets[s] < mesh.offsets[s + 1]])
            for tag, _, tags, points in read.node_blocks:
                own = slice(mesh.offsets[tag - 2], mesh.offsets[tag - 1])
                self.assertEqual(tags.tolist(), list(range(own.start + 1, own.stop + 1)))
                self.assertTrue(same_bits(points, mesh.points[own]))
            for tag, element, rows in read.element_blocks:
                slab = mesh.slab_triangles[tag - 2]
                self.assertEqual((element, rows[:, 0].tolist()), (2, list(range(slab.start + 1, slab.stop + 1))))
                self.assertTrue(np.array_equal(rows[:, 1:].astype(int) - 1, mesh.triangles[slab]))
            self.assertEqual(sum(len(rows) for _, _, rows in read.element_blocks), len(mesh.triangles))
            if len(mesh.points):
                self.assertEqual(read.box, (*mesh.points.min(0), *mesh.points.max(0)))

    @unittest.skipUnless(FULL, "other people's readers are tried under DOVETAIL_FULL=1")
    def test_meshio(self):
        try:
            import meshio
        except ImportError:
            self.skipTest("meshio is not installed")
        for extension in (".ply", ".vtu"):  # of .msh it knows no partitions, not even those that Gmsh makes
            for name, mesh, output in self.each(extension):
                if len(mesh.triangles) == 0:
                    continue  # meshio knows no mesh without triangles
                read = meshio.read(output)
                self.assertTrue(np.array_equal(read.points, mesh.points), extension)
                self.assertEqual({block.type for block in read.cells}, {"triangle"})
                cells = np.concatenate([block.data for block in read.cells])
                self.assertTrue(np.array_equal(cells, mesh.triangles), extension)

    @unittest.skipUnless(FULL, "other people's readers are tried under DOVETAIL_FULL=1")
    def test_gmsh(self):
        gmsh = shutil.which("gmsh")
        if gmsh is None:
            self.skipTest("gmsh is not installed")
        for name, mesh, output in self.each(".msh"):
            if name not in ("wide", "lattice"):
                continue
            text = output.with_suffix(".msh2")
            command = [gmsh, output, "-save", "-o", text, "-format", "msh2"]
            run = subprocess.run(command, capture_output=True, text=True, timeout=60)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            self.assertNotIn("Error", run.stdout + run.stderr)
            lines = text.read_text().splitlines()
            nodes = lines[lines.index("$Nodes") + 2 : lines.index("$EndNodes")]
            read = np.array([[float(word) for word in line.split()[1:]] for line in nodes])
            np.testing.assert_allclose(read, mesh.points, rtol=1e-15)  # Gmsh writes 16 digits
            elements = lines[lines.index("$Elements") + 2 : lines.index("$EndElements")]
            elements = np.array([[int(word) for word in line.split()] for line in elements])
            self.assertTrue(np.array_equal(elements[:, -3:] - 1, mesh.triangles))
            slab = np.repeat(np.arange(4), [t.stop - t.start for t in mesh.slab_triangles])
            self.assertTrue(np.array_equal(elements[:, -4], slab + 1))  # the partition

    @unittest.skipUnless(FULL, "other people's readers are tried under DOVETAIL_FULL=1")
    def test_vtk(self):
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOXML import vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader
        except ImportError:
            self.skipTest("VTK's Python modules are not installed")
        for extension, kind in ((".vtu", vtkXMLUnstructuredGridReader), (".pvtu", vtkXMLPUnstructuredGridReader)):
            for _, mesh, output in self.each(extension):
                reader = kind()
                reader.SetFileName(str(output))
                reader.Update()
                self.assertEqual(reader.GetErrorCode(), 0)
                grid = reader.GetOutput()
                self.assertEqual(grid.GetNumberOfCells(), len(mesh.triangles))
                if len(mesh.triangles) == 0:
                    continue
                points = vtk_to_numpy(grid.GetPoints().GetData())
                corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3)
                self.assertTrue(np.array_equal(points[corners], mesh.points[mesh.triangles]))

    def test_triangle_files(self):
        for name, mesh, output in self.each(".ele"):
            self.check_triangle_files(mesh, output, self.inputs[name])

    def check_triangle_files(self, mesh, output, points, node_of_index=None):
        """points: all that were taken, in order."""
        nodes, elements, neighbours = (
            [line.split() for line in output.with_suffix(end).read_text().splitlines()] for end in (".node", ".ele", ".neigh")
        )
        self.assertEqual(nodes[0], [str(len(points)), "2", str(points.shape[1] - 2), "0"])
        self.assertEqual([line[0] for line in nodes[1:]], [str(i) for i in range(len(points))])
        read = np.array([[float(word) for word in line[1:]] for line in nodes[1:]]).reshape(points.shape)
        self.assertTrue(same_bits(read, points))
        for line in nodes[1:]:
            for word in line[1:]:
                self.assertLessEqual(len(word), len(repr(float(word)).removesuffix(".0")))
        self.assertEqual(elements[0], [str(len(mesh.triangles)), "3", "0"])
        self.assertEqual(neighbours[0], [str(len(mesh.triangles)), "3"])
        node = mesh.indices if node_of_index is None else node_of_index[mesh.indices]
        numbered = [[t, *row] for t, row in enumerate(node[mesh.triangles].tolist())]
        self.assertEqual([[int(word) for word in line] for line in elements[1:]], numbered)
        numbered = [[t, *row] for t, row in enumerate(mesh.neighbours.tolist())]
        self.assertEqual([[int(word) for word in line] for line in neighbours[1:]], numbered)

    def test_triangle_files_of_a_part_of_the_records(self):
        # Skipped LAS records leave gaps in the input indices, but not among the nodes.
        las, native, output = (self.folder / f"part{end}" for end in (".las", ".vtkhdf", ".node"))
        write_las(las, 3000, 31)
        self.succeed("triangulate", las, "--class", 9, "-o", native, "--slabs", 5, ranks=2)
        mesh = Mesh(native)
        record = np.arange(0, 3000, 2)
        self.assertEqual(sorted(mesh.indices), record.tolist())
        points = np.stack([record % 31, record // 31, record % 9], -1) * np.array([1, 1, 100 * 0.01])
        node_of_index = np.full(3000, -1)
        node_of_index[record] = np.arange(len(record))
        for ranks in (1, 3):
            self.succeed("convert", native, output, ranks=ranks)
            self.check_triangle_files(mesh, output, points, node_of_index)

    EXTENSIONS = (".npy", ".vtu", ".pvtu", ".ply", ".msh", ".node")

    def test_every_number_of_ranks_makes_the_same_bytes(self):
        for extension in self.EXTENSIONS:
            for name in ("wide", "line") if FULL else ("wide",):
                expected = None
                for ranks in RANKS:
                    # The name is part of some files, so it is the same in folders of their own.
                    folder = self.folder / f"{name}{extension}.{ranks}"
                    folder.mkdir()
                    source = self.folder / f"{name}.vtkhdf"
                    self.succeed("convert", source, folder / f"m{extension}", "--quiet", ranks=ranks)
                    files = files_of(folder, "m")
                    self.assertEqual(files, expected or files, (extension, ranks))
                    expected = files
                folder = self.folder / f"{name}{extension}.direct"
                folder.mkdir()
                points = self.folder / f"{name}.in.npy"
                self.succeed("triangulate", points, "--slabs", 4, "-o", folder / f"m{extension}", "--quiet", ranks=3)
                self.assertEqual(files_of(folder, "m"), expected, extension)

    def test_points(self):
        for name in ("lattice", "line", "none"):
            source, raw, back = (self.folder / f"{name}{end}" for end in (".in.npy", ".f64", ".back.npy"))
            self.succeed("convert", source, raw, ranks=3)
            self.assertEqual(raw.read_bytes(), self.inputs[name].tobytes())
            self.succeed("convert", raw, back)
            self.assertTrue(same_bits(np.load(back), self.inputs[name]))

    # Failures leave nothing, and say so once, on every number of ranks.

    def refused(self, *arguments, code=1, says=(), ranks=(1, 3), folder=None, **how):
        before = files_of(folder, "") if folder else None
        for count in ranks:
            run = dovetail(*arguments, ranks=count, **how)
            self.assertEqual(run.code, code, run)
            self.assertEqual(len(run.messages), 1, run)
            for text in says:
                self.assertIn(str(text), run.messages[0], run)
            self.assertEqual(self.leftovers(), [], run)
            if folder:
                self.assertEqual(files_of(folder, ""), before, run)

    def test_refusals(self):
        source = self.folder / "wide.vtkhdf"
        locked = self.folder / "locked"
        locked.mkdir()
        locked.chmod(0o555)
        for extension in self.EXTENSIONS if FULL else (".npy", ".pvtu"):
            missing = self.folder / "nowhere" / f"m{extension}"
            self.refused("convert", source, missing, says=["nowhere", "does not exist"])
            self.refused("convert", source, locked / f"m{extension}", says=["locked"], unprivileged=True, folder=locked)
        self.refused("convert", source, self.folder / "m.stl", code=2, says=["m.stl", "'.stl'", *self.EXTENSIONS])
        self.refused("convert", source, self.folder / "m", code=2, says=["without an extension", *self.EXTENSIONS])
        self.refused("convert", source, source, code=2, says=["is an input"])
        self.refused("convert", self.folder / "line.in.npy", self.folder / "m.stl", code=2, says=["m.stl", ".npy"])
        self.refused("convert", self.folder / "none.vtkhdf", "x.npy", "--report", "x.points.npy", code=2, says=["report"])

    def test_file_size_limit(self):
        points, mesh = self.folder / "many.npy", self.folder / "many.vtkhdf"
        self.succeed("generate", "uniform", "-n", 400_000, "-o", points)
        self.succeed("triangulate", points, "-o", mesh, "--quiet", "--slabs", 2)
        folder = self.folder / "small"
        folder.mkdir()
        for extension in self.EXTENSIONS:
            (folder / f"m{extension}").write_text("an older file")
            self.refused("convert", mesh, folder / f"m{extension}", says=["ulimit -f"], folder=folder, file_limit=FILE_LIMIT)

    def test_parts_in_the_way(self):
        folder = self.folder / "way"
        folder.mkdir()
        for extension, part in ((".npy", ".neighbours.npy"), (".ele", ".neigh"), (".pvtu", ".2.vtu")):
            (folder / f"m{part}").mkdir()
            self.refused("convert", self.folder / "wide.vtkhdf", folder / f"m{extension}", says=[part, "folder"])
            self.assertEqual([p.name for p in folder.iterdir()], [f"m{part}"])
            (folder / f"m{part}").rmdir()


if __name__ == "__main__":
    harness.main()
