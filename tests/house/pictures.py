#!/usr/bin/env python3
"""tools/plot-mesh draws what a mesh file holds, with its numbers, and refuses what is none.

usage: pictures.py CHECKOUT COMMAND
"""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

checkout, command = sys.argv[1:]
tool = pathlib.Path(checkout) / "tools" / "plot-mesh"
try:
    import matplotlib  # noqa: F401
except ImportError:
    print("[  SKIPPED ] pictures.matplotlib is missing (tools/install-dependencies plot)")
    sys.exit(77)


def plot(*words):
    return subprocess.run([sys.executable, tool, *words], capture_output=True, text=True, check=False)


loader = importlib.machinery.SourceFileLoader("plot_mesh", str(tool))
spec = importlib.util.spec_from_loader("plot_mesh", loader)
plot_mesh = importlib.util.module_from_spec(spec)
sys.dont_write_bytecode = True
loader.exec_module(plot_mesh)

with tempfile.TemporaryDirectory() as folder:
    for axis in "xy":
        points, mesh, picture = (f"{folder}/{axis}.{end}" for end in ("f64", "vtkhdf", "svg"))
        subprocess.run([command, "generate", "uniform", "-n", "200", "--seed", "7", "-o", points], check=True,
                       stdout=subprocess.DEVNULL)
        subprocess.run([command, "triangulate", points, "-o", mesh, "--slabs", "3", "--axis", axis, "--quiet"], check=True)
        found = plot_mesh.read(mesh)
        # The borders of the triangles of each slab, found from the corners alone, are the paths and the hull.
        sides = {}
        for corners, slab in zip(found["corners"], found["slab"]):
            for i in range(3):
                sides.setdefault(frozenset(map(int, (corners[i], corners[i - 1]))), []).append(slab)
        hull = {side for side, slabs in sides.items() if len(slabs) == 1}
        assert hull == {frozenset(map(int, side)) for side in found["hull"]}
        steps = {frozenset(map(int, step)) for path in found["paths"] for step in zip(path, path[1:])}
        assert {side for side, slabs in sides.items() if len(set(slabs)) == 2} <= steps <= set(sides)
        assert found["axis"] == axis and len(found["lines"]) == len(found["paths"]) == 2
        done = plot(mesh, picture)
        assert done.returncode == 0, done.stderr
        assert pathlib.Path(picture).stat().st_size > 10_000
    done = plot(points, f"{folder}/none.png")
    assert done.returncode == 1 and points in done.stderr and "Traceback" not in done.stderr, done.stderr
# Another Python than the one that has the packages: said in a sentence, not in a traceback.
done = subprocess.run([sys.executable, "-S", tool, "--help"], capture_output=True, text=True, check=False)
assert done.returncode == 1 and "install-dependencies plot" in done.stderr, done.stderr
assert "Traceback" not in done.stderr, done.stderr
print("two meshes drawn, with borders as in their triangles")
