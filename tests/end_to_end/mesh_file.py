"""Mesh files read by h5py: what VTK expects of an UnstructuredGrid, and what stands beside it."""

import unittest

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


def slab_ranges(file):
    """For every slab: its rows in vertex columns, in triangle columns, in Offsets."""
    vtk = file["VTKHDF"]
    points = np.concatenate([[0], np.cumsum(vtk["NumberOfPoints"][:])])
    cells = np.concatenate([[0], np.cumsum(vtk["NumberOfCells"][:])])
    for s in range(len(points) - 1):
        yield s, slice(points[s], points[s + 1]), slice(cells[s], cells[s + 1]), slice(cells[s] + s, cells[s + 1] + s + 1)


@unittest.skipIf(h5py is None, "h5py or numpy is not installed")
class MeshFile(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.points = cls.folder / "points.npy"
        run = dovetail("generate", "lidar", "-n", 5000, "--seed", 3, "-o", cls.points)
        assert run.code == 0, run
        cls.mesh = cls.folder / "mesh.vtkhdf"
        run = dovetail("triangulate", cls.points, "--slabs", 6, "--axis", "x", "-o", cls.mesh, ranks=3)
        assert run.code == 0, run

    def test_what_vtk_expects(self):
        with h5py.File(self.mesh) as file:
            vtk = file["VTKHDF"]
            self.assertEqual(list(vtk.attrs["Version"]), [1, 0])
            kind = vtk.attrs.get_id("Type")
            self.assertEqual(kind.get_type().get_cset(), h5py.h5t.CSET_ASCII)
            self.assertFalse(kind.get_type().is_variable_str())
            self.assertEqual(vtk.attrs["Type"], b"UnstructuredGrid")
            # VTK 9.1 shows no cells at all if these two differ in type.
            self.assertEqual(vtk["Connectivity"].dtype, np.dtype("<i4"))
            self.assertEqual(vtk["Offsets"].dtype, np.dtype("<i4"))
            self.assertEqual(vtk["Points"].dtype, np.dtype("<f8"))
            self.assertEqual(vtk["Types"].dtype, np.dtype("u1"))
            self.assertEqual(vtk["PointData/vtkGhostType"].dtype, np.dtype("u1"))
            for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
                self.assertEqual(vtk[name].shape, (6,))
            n, cells = vtk["NumberOfPoints"][:].sum(), vtk["NumberOfCells"][:].sum()
            self.assertEqual(vtk["Points"].shape, (n, 3))
            self.assertEqual(vtk["Types"].shape, (cells,))
            self.assertTrue((vtk["Types"][:] == 5).all())
            self.assertEqual(vtk["Connectivity"].shape, (vtk["NumberOfConnectivityIds"][:].sum(),))
            self.assertEqual(vtk["Offsets"].shape, (cells + 6,))
            for data in vtk["PointData"].values():
                self.assertEqual(data.shape, (n,))
            for s, vertices, triangles, offsets in slab_ranges(file):
                count = triangles.stop - triangles.start
                self.assertTrue((vtk["Offsets"][offsets] == 3 * np.arange(count + 1)).all())
                corners = vtk["Connectivity"][3 * triangles.start : 3 * triangles.stop]
                self.assertTrue((corners >= 0).all())
                self.assertTrue((corners < vertices.stop - vertices.start).all())

    def test_vertices(self):
        table = np.load(self.points)
        with h5py.File(self.mesh) as file:
            own_part = file["dovetail"]
            points, number = file["VTKHDF/Points"][:], file["VTKHDF/PointData/global_number"][:]
            index, ghost = file["VTKHDF/PointData/input_index"][:], file["VTKHDF/PointData/vtkGhostType"][:]
            self.assertTrue((points == table[index]).all())  # z as well
            sites = {}
            for s, vertices, _, _ in slab_ranges(file):
                own = own_part["own_counts"][s]
                first = own_part["site_offsets"][s]
                self.assertEqual(own, own_part["site_offsets"][s + 1] - first)
                self.assertTrue((ghost[vertices] == (np.arange(vertices.stop - vertices.start) >= own)).all())
                self.assertTrue((number[vertices][:own] == first + np.arange(own)).all())
                self.assertTrue((np.diff(number[vertices][own:]) > 0).all())
                for v in range(vertices.start, vertices.stop):
                    if not ghost[v]:
                        sites[number[v]] = points[v]
            ghosts = np.flatnonzero(ghost)
            self.assertGreater(len(ghosts), 0)
            self.assertTrue(all((points[v] == sites[number[v]]).all() for v in ghosts))
            # In the total order, and with the duplicates every point of the input.
            order = [tuple(sites[v][:2]) for v in range(len(sites))]
            self.assertEqual(order, sorted(set(order)))
            duplicates, z = own_part["duplicates"][:], own_part["duplicate_z"][:]
            self.assertEqual(len(sites) + len(duplicates), len(table))
            for (point, site), height in zip(duplicates, z):
                self.assertEqual(tuple(table[point]), (*sites[site][:2], height))
            self.assertEqual(own_part.attrs["digest_points"], len(table))

    def test_neighbours(self):
        with h5py.File(self.mesh) as file:
            number = file["VTKHDF/PointData/global_number"][:]
            corners = np.concatenate(
                [
                    number[vertices][file["VTKHDF/Connectivity"][3 * triangles.start : 3 * triangles.stop]]
                    for _, vertices, triangles, _ in slab_ranges(file)
                ]
            ).reshape(-1, 3)
            neighbours = file["dovetail/neighbours"][:]
            self.assertEqual(neighbours.shape, corners.shape)
            hull = 0
            for t, (triangle, beyond) in enumerate(zip(corners.tolist(), neighbours.tolist())):
                for i, other in enumerate(beyond):
                    if other == -1:
                        hull += 1
                        continue
                    edge = {triangle[i - 1], triangle[i - 2]}
                    back = neighbours[other].tolist().index(t)
                    there = corners[other].tolist()
                    self.assertEqual({there[back - 1], there[back - 2]}, edge)
            self.assertEqual(hull, file["dovetail"].attrs["hull_edges"])
            self.assertEqual(len(corners), 2 * file["dovetail/site_offsets"][-1] - 2 - hull)

    def test_paths_ascend_along_edges(self):
        with h5py.File(self.mesh) as file:
            own_part = file["dovetail"]
            number, points = file["VTKHDF/PointData/global_number"][:], file["VTKHDF/Points"][:]
            y = dict(zip(number.tolist(), points[:, 1].tolist()))
            offsets, paths = own_part["path_offsets"][:], own_part["paths"][:]
            self.assertEqual(offsets[1], 0)  # nothing on the left of the first slab
            edges = set()
            for _, vertices, triangles, _ in slab_ranges(file):
                local = file["VTKHDF/Connectivity"][3 * triangles.start : 3 * triangles.stop].reshape(-1, 3)
                for triangle in number[vertices][local].tolist():
                    edges |= {frozenset((triangle[i], triangle[i - 1])) for i in range(3)}
            for s in range(1, 6):
                path = paths[offsets[s] : offsets[s + 1]].tolist()
                self.assertEqual((y[path[0]], y[path[-1]]), (min(y.values()), max(y.values())))
                for a, b in zip(path, path[1:]):
                    self.assertLess(y[a], y[b])
                    self.assertIn(frozenset((a, b)), edges)

    def test_every_number_of_ranks_makes_the_same_bytes(self):
        expected = self.mesh.read_bytes()
        for ranks in (0, 1, 2, 5):
            again = self.folder / f"again{ranks}.vtkhdf"
            self.succeed("triangulate", self.points, "--slabs", 6, "--axis", "x", "-o", again, ranks=ranks)
            self.assertEqual(again.read_bytes(), expected)

    def test_no_triangles(self):
        points, mesh = self.folder / "line.f64", self.folder / "line.vtkhdf"
        write_f64(points, [(float(i), 2.0 * i) for i in range(10)])
        self.succeed("triangulate", points, "--slabs", 3, "-o", mesh)
        with h5py.File(mesh) as file:
            self.assertEqual(file["VTKHDF/Types"].shape, (0,))
            self.assertEqual(file["VTKHDF/Offsets"][:].tolist(), [0, 0, 0])
            self.assertEqual(file["dovetail/neighbours"].shape, (0, 3))

    def test_file_size_limit(self):
        # MPI itself needs files of several megabytes, so the limit can only be tried on a mesh beyond that.
        points, mesh = self.folder / "many.npy", self.folder / "many.vtkhdf"
        self.succeed("generate", "uniform", "-n", 250_000, "-o", points)
        mesh.write_text("an older file")
        for ranks in (1, 3):
            run = dovetail("triangulate", points, "-o", mesh, ranks=ranks, file_limit=20_000_000)
            self.assertNotEqual(run.code, 0, run)
            self.assertEqual(len(run.messages), 1, run)
            self.assertIn(str(mesh), run.messages[0])
            self.assertIn("ulimit -f", run.messages[0])
            self.assertEqual(self.leftovers(), [])
            self.assertEqual(mesh.read_text(), "an older file")


if __name__ == "__main__":
    harness.main()
