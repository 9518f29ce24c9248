"""The figures of `dovetail stats`, against numpy's from the arrays of the file, alike on every number of ranks."""

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

FIGURES = ("areas", "edge_lengths", "angles", "smallest_angles", "degrees")


def read(path):
    """Sites by global number, triangles by global numbers of their corners."""
    with h5py.File(path) as file:
        vtk = file["VTKHDF"]
        first = np.concatenate(([0], np.cumsum(vtk["NumberOfPoints"][:])))
        number = vtk["PointData/global_number"][:]
        sites = np.empty((file["dovetail/site_offsets"][-1], 2))
        sites[number] = vtk["Points"][:, :2]
        corners = vtk["Connectivity"][:].reshape(-1, 3)
        corners = number[corners + np.repeat(first[:-1], vtk["NumberOfCells"][:])[:, None]]
        paths = np.diff(file["dovetail/path_offsets"][:])[1:]
    return sites, corners, paths


@unittest.skipIf(h5py is None, "h5py or numpy is not installed")
class Stats(harness.TestCase):
    def mesh_of(self, name, *how):
        mesh = self.folder / f"{name}.vtkhdf"
        self.succeed("triangulate", *how, "-o", mesh, "--quiet")
        return mesh

    def compare(self, mesh, report):
        sites, corners, paths = read(mesh)
        p = sites[corners]
        towards, back = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
        dot = (towards * back).sum(axis=2)
        cross = np.abs(towards[..., 0] * back[..., 1] - towards[..., 1] * back[..., 0])
        angles = np.degrees(np.arctan2(cross, dot))
        sides = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
        edges, seen = np.unique(sides, axis=0, return_counts=True)
        lengths = np.hypot(*(sites[edges[:, 0]] - sites[edges[:, 1]]).T)
        values = {
            "angles": angles.ravel(),
            "smallest_angles": angles.min(axis=1),
            "areas": cross[:, 0] / 2,
            "edge_lengths": lengths,
            "degrees": np.bincount(edges.ravel(), minlength=len(sites)),
        }
        for name in FIGURES:
            with self.subTest(figure=name, mesh=mesh.name):
                found = report[name]
                bounds = np.array(found["bounds"])
                at = np.clip(np.searchsorted(bounds, values[name], side="right") - 1, 0, len(bounds) - 2)
                expected = np.bincount(at, minlength=len(bounds) - 1)
                # Rounding may put a right angle on either side of 90 degrees.
                on_bound = np.isclose(values[name][:, None], bounds, rtol=1e-9, atol=0).any(axis=1).sum()
                self.assertLessEqual(np.abs(expected - found["counts"]).sum(), 2 * on_bound)
                if name == "degrees":
                    self.assertEqual(expected.tolist(), found["counts"])
                self.assertEqual(sum(found["counts"]), len(values[name]))
                np.testing.assert_allclose(found["lowest"], values[name].min(), rtol=1e-7)
                np.testing.assert_allclose(found["highest"], values[name].max(), rtol=1e-9)
        np.testing.assert_allclose(report["area"], values["areas"].sum(), rtol=1e-12)
        np.testing.assert_allclose(report["edge_length"], lengths.sum(), rtol=1e-12)
        np.testing.assert_allclose(report["hull_length"], lengths[seen == 1].sum(), rtol=1e-12)
        self.assertEqual(report["hull_edges"], (seen == 1).sum())
        self.assertEqual(report["edges"], len(edges))
        self.assertEqual(report["path_lengths"], paths.tolist())

    def test_against_numpy_and_across_ranks(self):
        points = self.folder / "points.npy"
        self.succeed("generate", "kuzmin", "-n", 3000, "--seed", 4, "-o", points, "--quiet")
        rng = np.random.default_rng(1)
        lattice = self.folder / "lattice.npy"  # cocircular, right angles, duplicates
        np.save(lattice, rng.integers(0, 12, (800, 2)).astype(float))
        for name, *how in (("kuzmin", points, "--slabs", 5), ("y", points, "--slabs", 3, "--axis", "y"),
                           ("lattice", lattice, "--slabs", 4)):
            mesh = self.mesh_of(name, *how)
            first = self.report_of("stats", mesh)
            self.compare(mesh, first)
            for ranks in (2, 3, 5):
                again = self.report_of("stats", mesh, ranks=ranks)
                for key in ("sites", "triangles", "duplicates", "repeated_sites", "most_duplicates", "hull_edges",
                            "hull_length", "area", "edges", "edge_length", "path_lengths", *FIGURES):
                    self.assertEqual(again[key], first[key], (key, ranks))
                self.assertEqual(again["run"].out, first["run"].out)
        _, counts = np.unique(np.load(lattice), axis=0, return_counts=True)
        self.assertEqual(first["duplicates"], (counts - 1).sum())
        self.assertEqual(first["repeated_sites"], (counts > 1).sum())
        self.assertEqual(first["most_duplicates"], counts.max() - 1)

    def test_text(self):
        points = self.folder / "grid.f64"
        write_f64(points, [(float(i), float(j)) for i in range(11) for j in range(11)])
        run = self.succeed("stats", self.mesh_of("grid", points))
        for text in ("sites              121\n", "triangles          200\n", "edges              320\n",
                     "40 edges, length 40, area 100\n", "0.5 to 0.5, mean 0.5\n"):
            self.assertIn(text, run.out)
        self.assertLessEqual(max(map(len, run.out.splitlines())), 120)

    def test_few_sites(self):
        for count in (0, 1, 5):
            points = self.folder / f"line{count}.f64"
            write_f64(points, [(float(i), float(i)) for i in range(count)])
            report = self.report_of("stats", self.mesh_of(f"line{count}", points), ranks=2)
            self.assertEqual((report["sites"], report["triangles"], report["area"]), (count, 0, 0))
            self.assertEqual(sum(report["areas"]["counts"]), 0)
            self.assertIsNone(report["areas"]["lowest"])
            self.assertEqual(report["degrees"]["counts"][0], count)

    def test_extreme_sizes(self):
        for scale in (1e-140, 1e140):
            points = self.folder / "scaled.f64"
            write_f64(points, [(x * scale, y * scale) for x, y in ((0, 0), (4, 0), (0, 3), (4, 3))])
            report = self.report_of("stats", self.mesh_of("scaled", points))
            self.assertAlmostEqual(report["hull_length"] / scale, 14)
            self.assertAlmostEqual(report["areas"]["lowest"] / scale / scale, 6)
            self.assertAlmostEqual(report["angles"]["highest"], 90)

    def test_errors(self):
        for ranks in (1, 3):
            run = dovetail("stats", self.folder / "missing.vtkhdf", ranks=ranks)
            self.assertEqual((run.code, len(run.messages)), (1, 1), run)
            self.assertIn("missing.vtkhdf", run.messages[0])

    def test_damaged_corner_is_refused(self):
        points = self.folder / "some.npy"
        self.succeed("generate", "uniform", "-n", 100, "-o", points, "--quiet")
        mesh = self.mesh_of("damaged", points)
        with h5py.File(mesh, "r+") as file:
            file["VTKHDF/Connectivity"][7] = 1_000_000
        for ranks in (1, 3):
            run = dovetail("stats", mesh, ranks=ranks)
            self.assertEqual((run.code, len(run.messages)), (1, 1), run)
            self.assertIn("out of range", run.messages[0])


if __name__ == "__main__":
    harness.main()
