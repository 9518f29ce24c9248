#!/usr/bin/env python3
"""tools/shorelines joins the pieces of polygons to rings, at the places where the bins say.

usage: shorelines.py CHECKOUT
"""
import pathlib
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"[  SKIPPED ] shorelines.{missing.name} is missing (tools/install-dependencies shorelines)")
    sys.exit(77)

tool = pathlib.Path(sys.argv[1]) / "tools" / "shorelines"
SIDE = 65535
SOUTH, EAST, NORTH, WEST, CLOSED = range(5)


def run(*words, code=0):
    done = subprocess.run([sys.executable, tool, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code and "Traceback" not in done.stderr, done
    return done.stdout + done.stderr


def write(path, segments):
    """Segments in any order: (west, south, polygon, entry, exit, vertices within the bin)."""
    segments = sorted(segments, key=lambda s: (89 - s[1]) * 360 + s[0] % 360)
    counts = [len(s[5]) for s in segments]
    bins = np.zeros(64800, np.int16)
    for west, south, *_ in segments:
        bins[(89 - south) * 360 + west % 360] += 1
    vertices = np.array([v for s in segments for v in s[5]], np.uint16).view(np.int16)
    with h5py.File(path, "w") as file:
        file["Bin_size_in_minutes"] = np.array([60], np.int32)
        file["N_bins_in_360_longitude_range"] = np.array([360], np.int32)
        file["N_bins_in_180_degree_latitude_range"] = np.array([180], np.int32)
        file["N_segments_in_a_bin"] = bins
        file["Embedded_npts_levels_exit_entry_for_a_segment"] = np.array(
            [(count << 9) | (1 << 6) | (s[3] << 3) | s[4] for count, s in zip(counts, segments)], np.int32)
        file["Id_of_first_point_in_a_segment"] = np.cumsum([0] + counts[:-1]).astype(np.int32)
        file["Id_of_GSHHS_ID"] = np.array([s[2] for s in segments], np.int32)
        file["Embedded_ANT_flag"] = np.zeros(len(segments), np.int8)
        file["Relative_longitude_from_SW_corner_of_bin"] = vertices[:, 0]
        file["Relative_latitude_from_SW_corner_of_bin"] = vertices[:, 1]


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    source, output, rings = folder / "small.nc", folder / "points.npy", folder / "rings.npy"
    cut = [
        (179, 0, 7, EAST, EAST, [(SIDE, 1000), (40000, 2000), (SIDE, 60000)]),  # around the antimeridian
        (180, 0, 7, WEST, WEST, [(0, 60000), (30000, 2000), (0, 1000)]),
        (0, -90, 8, CLOSED, CLOSED, [(0, 0), (SIDE, 0), (1, SIDE), (0, 0)]),  # an island of its own
        (179, 0, 9, NORTH, NORTH, [(5, SIDE), (6, 7), (8, SIDE)]),  # in a bin with another
        (179, 1, 9, SOUTH, SOUTH, [(8, 0), (6, 7), (5, 0)]),
    ]
    write(source, cut)
    said = run(output, "--rings", rings, "--source", source)
    assert said.startswith("16 points in 3 rings, longitude -180.0"), said
    points, begins = np.load(output), np.load(rings)
    expected = set()
    for first, second in ((cut[0], cut[1]), (cut[2], None), (cut[3], cut[4])):
        ring = [((piece[0] + 180) % 360 - 180 + x / SIDE, piece[1] + y / SIDE) for piece in (first, second) if piece
                for x, y in piece[5]]
        half = len(first[5])
        expected |= {tuple(ring), tuple(ring[half:] + ring[:half])}
    for begin, end in zip(begins, begins[1:]):
        ring = points[begin:end]
        matches = [e for e in expected if len(e) == len(ring) and np.allclose(ring, e, rtol=0, atol=1e-12)]
        assert len(matches) == 1, ring
        assert (ring[0] - ring[-1])[1] == 0 and (ring[0] - ring[-1])[0] % 360 == 0
    raw = folder / "points.f64"
    run(raw, "--source", source)
    assert (np.fromfile(raw, "<f8").reshape(-1, 2) == points).all()

    domain = folder / "rings.poly"
    said = run(domain, "--source", source, "--min-points", 3)
    words = [line.split() for line in domain.read_text().splitlines()[1:]]
    count = int(words[0][0])
    ends = [(int(a), int(b), int(marker)) for _, a, b, marker in words[count + 2 : -1]]
    assert said.startswith(f"{ends[-1][2]} rings in the window") and words[-1] == ["0"] and count == len(ends), said
    assert sorted(a for a, _, _ in ends) == sorted(b for _, b, _ in ends) == list(range(count)), ends
    vertices = np.array([[float(x), float(y)] for _, x, y in words[1 : count + 1]])
    assert len(np.unique(vertices, axis=0)) == count and {tuple(v) for v in vertices} <= {tuple(p) for p in points}
    assert "0 rings" in run(domain, "--source", source, "--window", "100,80,101,81")

    write(source, cut[:1] + cut[2:])  # a piece is missing
    assert "GSHHG 2.3.7" in run(output, "--source", source, code=1)
    assert "gmt-gshhg-full" in run(output, "--source", folder / "none.nc", code=1)
    assert "none of .npy, .f64 and .poly" in run(folder / "points.txt", code=2)
print("pieces of five bins joined to three rings")
