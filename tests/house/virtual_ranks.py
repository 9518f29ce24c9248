#!/usr/bin/env python3
"""Virtual ranks do what real ones do: bytes, messages, paths, ghosts and the mesh are those of mpiexec, for 1 to 8
ranks; and a sample of slabs shows about the paths that there are.

usage: virtual_ranks.py VIRTUAL_RANKS DOVETAIL MPIEXEC FLAG
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

virtual_ranks, dovetail, mpiexec, flag = sys.argv[1:]
EQUAL = ("axis", "slabs", "sites", "triangles", "checksum", "own_sites_max", "path_sites_max", "candidate_sites_max",
         "path_sites", "longest_path", "ghosts")
TRAFFIC = ("bytes_sent", "messages_sent")
ALL = ("uniform", "kuzmin", "lidar", "line", "normal", "lattice", "circle", "clusters")
# ranks, distribution, points (not divisible by the ranks), slabs (0: chosen). Lidar has duplicates and a column more.
CASES = [(p, kind, 6001 + 997 * p, slabs)
         for p, kind, slabs in zip(range(1, 9), ALL, (5, 0, 0, 9, 0, 3, 0, 24))] + [(5, "uniform", 3, 0), (4, "lidar", 60_000, 0)]
if os.environ.get("DOVETAIL_FULL"):
    CASES += [(p, kind, 40_001, slabs) for p in range(1, 9) for kind in ALL for slabs in (0, 3 * p)]


def output_of(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"failed: {words}: {done.stderr}")
    return done.stdout


def virtual(*words):
    return json.loads(output_of(virtual_ranks, *words))


def real(folder, ranks, kind, points, slabs):
    file, report = folder / f"{kind}-{points}.npy", folder / "report.json"
    if not file.exists():
        output_of(dovetail, "generate", kind, "-n", points, "--seed", 1, "-o", file)
    output_of(mpiexec, flag, ranks, dovetail, "triangulate", file, "-o", "none", "--quiet", "--report", report,
              *(["--slabs", slabs] if slabs else []))
    return json.loads(report.read_text())


def compare(folder, ranks, kind, points, slabs):
    expected, found = real(folder, ranks, kind, points, slabs), virtual(kind, points, ranks, "--slabs", slabs)
    wrong = [f"{key}: {expected[key]} really, {found[key]} virtually" for key in EQUAL if expected[key] != found[key]]
    phases = {phase["name"]: phase for phase in expected["phases"]}
    assert [phase["name"] for phase in found["phases"]] == ["sort", "split", "triangulate", "stitch"]
    for phase in found["phases"]:
        there = phases[phase["name"]]
        wrong += [f"{phase['name']} {key}: {there[key]} really, {phase[key]} virtually"
                  for key in TRAFFIC if there[key] != phase[key]]
        assert phase["wall_max_s"] >= phase["wall_mean_s"] > 0
        assert phase["wall_max_s"] + 1e-9 >= phase["cpu_max_s"]
    assert not wrong, f"{kind}, {points} points, {ranks} ranks, {slabs} slabs: " + "; ".join(wrong)


def check_samples():
    for kind in ("uniform", "normal", "kuzmin", "line"):
        exact, sample = virtual(kind, 64_000, 32), virtual(kind, 64_000, 32, "--sampled")
        assert exact["axis"] == sample["axis"] == ("y" if kind == "line" else "x")
        for key in ("longest_path", "path_sites", "path_sites_max"):
            assert 0.85 < sample[key] / exact[key] < 1.15, (kind, key, sample[key], exact[key])
    refused = subprocess.run([virtual_ranks, "circle", "1000", "10", "--sampled"], capture_output=True, text=True, check=False)
    assert refused.returncode == 1 and "only uniform" in refused.stderr, refused


def check_the_network():
    """Work is measured and differs from run to run; but a second of latency is more than any work here."""
    slow = virtual("uniform", 4000, 4, "--latency", 1)
    split = next(phase for phase in slow["phases"] if phase["name"] == "triangulate")
    assert 2 < split["wall_max_s"] < 2.5, split  # one agreement of four ranks: an all-reduce in two steps
    alone = virtual("uniform", 4000, 1, "--latency", 1)
    assert sum(phase["wall_max_s"] for phase in alone["phases"]) < 1


with tempfile.TemporaryDirectory() as temporary:
    for case in CASES:
        compare(pathlib.Path(temporary), *case)
check_samples()
check_the_network()
print(f"{len(CASES)} runs on 1 to 8 ranks: the same mesh, bytes and messages on virtual ranks")
