#!/usr/bin/env python3
"""The scaling driver leaves the records that it promises and refuses more ranks than cores; the tables made of
records compare with the best sequential code and with equal checksums; the study on virtual ranks carries on to more
ranks than it runs.

usage: studies.py CHECKOUT BUILD
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

checkout, build = sys.argv[1:]
sys.path.insert(0, f"{checkout}/jobs")
sys.dont_write_bytecode = True
import projection  # noqa: E402: from the checkout
ranks = [1, 2] if len(os.sched_getaffinity(0)) >= 2 else [1]
has_commit = (pathlib.Path(checkout) / ".git").exists() and shutil.which("git")  # not in an unpacked archive
has_kernel = (pathlib.Path(build) / "tests/benchmark/kernel_dovetail").exists()


def run(script, *words):
    command = [sys.executable, f"{checkout}/jobs/{script}", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def written(path, records):
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    return path


def check_drivers(folder):
    log = folder / "records.jsonl"
    sizes = {"strong": lambda p: 3000, "weak": lambda p: 3000 * p, "distributions": lambda p: 3000}
    for study, size in sizes.items():
        log.unlink(missing_ok=True)
        kinds = ["kuzmin", "line"] if study == "distributions" else ["kuzmin"]
        done = run("scaling", study, "--ranks", ",".join(map(str, ranks)), "--points", "3e3", "--repeat", 2,
                   "--distributions", ",".join(kinds), "--records", log, "--scratch", folder, "--build", build)
        assert done.returncode == 0, done.stdout + done.stderr
        found = [json.loads(line) for line in log.read_text().splitlines()]
        pipeline = [r for r in found if r["code"] == "pipeline"]
        assert [(r["repetition"], r["distribution"], r["ranks"]) for r in pipeline] == \
            [(i, d, p) for i in range(2) for d in kinds for p in ranks]  # interleaved
        assert len(found) == len(pipeline) + (2 * len(kinds) if has_kernel else 0)
        for record in pipeline:
            assert record["report"]["ranks"] == record["ranks"] and record["report"]["hosts"] == 1
            assert record["points"] == record["report"]["points"] == size(record["ranks"])
        for record in found:
            assert all(record[key] for key in ("machine", "mpi", "build", "time", "command", "checksum"))
        for (kind, points) in {(r["distribution"], r["points"]) for r in found}:
            same = [r for r in found if (r["distribution"], r["points"]) == (kind, points)]
            line = f"checksum of {points:,} points, {kind}, seed 1: {same[0]['checksum']} in all {len(same)} runs"
            assert line in done.stdout, done.stdout
        assert "efficiency" in done.stdout and "nan" not in done.stdout.lower(), done.stdout

    log.unlink()
    for words in (("--ranks", "1,9999"), ("--ranks", "0"), ("--ranks", "1,1"), ("--ranks", "two")):
        done = run("scaling", "strong", *words, "--points", 10, "--records", log, "--build", build)
        assert done.returncode == 2 and "--ranks" in done.stderr, (words, done)
        assert not log.exists()


def invented(ranks_of_run, seconds, checksum, code="pipeline"):
    """A record of a run in which one phase took all the time, half of it on average."""
    record = {"study": "strong", "distribution": "uniform", "seed": 1, "size": 1000, "points": 1000, "repetition": 0,
              "commit": "c0ffee", "mpi": "an MPI", "machine": {"cpu": "a processor", "cores": 8}, "load_before": 0.0,
              "code": code, "ranks": ranks_of_run, "checksum": checksum, "seconds": seconds}
    phases = [{"name": name, "wall_max_s": seconds * (name == "triangulate"), "cpu_sum_s": seconds,
               "wall_mean_s": seconds / 2 * (name == "triangulate"), "bytes_sent": 8, "messages_sent": 1}
              for name in ("sort", "split", "triangulate", "stitch")]
    record["report"] = {"slabs": ranks_of_run, "peak_rss_max_bytes": 1 << 20, "path_sites": 5, "longest_path": 5,
                        "phases": phases}
    return record


def row_of(table, first, width):
    return next(line.split() for line in table.splitlines() if line.split()[:1] == [first] and len(line.split()) == width)


def check_tables(folder):
    # The kernel alone is faster than one rank: 8 s against it are a speedup of 6 / 2 on four ranks.
    log = written(folder / "made.jsonl", [invented(1, 8.0, "aa"), invented(4, 2.0, "aa"), invented(1, 6.0, "aa", "kernel")])
    done = run("table", log)
    assert done.returncode == 0 and "best sequential: the kernel alone, 6.000 s" in done.stdout, done
    assert row_of(done.stdout, "4", 14)[7:9] == ["3.00", "75%"], done.stdout
    assert ["4", "triangulate", "2.000", "1.000", "2.00", "100.0%"] in \
        [line.split()[:6] for line in done.stdout.splitlines()], done.stdout
    assert "aa in all 3 runs" in done.stdout

    log = written(folder / "made.jsonl", [invented(1, 8.0, "aa"), invented(4, 2.0, "bb")])
    done = run("table", log)
    assert done.returncode == 1 and "DIFFERS between runs: aa, bb" in done.stdout, done
    assert "best sequential: the pipeline on one rank, 8.000 s" in done.stdout, done.stdout

    if shutil.which("gnuplot"):
        run("table", log, "--plots", folder / "plots")
        pictures = sorted(path.name for path in (folder / "plots").iterdir())
        assert len(pictures) == 4 and all(name.endswith(".svg") for name in pictures), pictures
        assert all("<svg" in path.read_text() for path in (folder / "plots").iterdir())

    done = run("table", written(folder / "made.jsonl", []))
    assert done.returncode == 2 and "no run" in done.stderr, done


def check_virtual_study(folder):
    log = folder / "virtual.jsonl"
    done = run("virtual", "weak", "--points", 2000, "--ranks", "2,4,8,32", "--exact", 16_000, "--distributions", "kuzmin",
               "--records", log, "--build", build)
    assert done.returncode == 0, done.stdout + done.stderr
    found = [json.loads(line) for line in log.read_text().splitlines()]
    assert [(r["ranks"], r["code"]) for r in found] == \
        [(1, "exact"), (2, "exact"), (4, "exact"), (8, "exact"), (8, "sampled"), (32, "sampled")]
    for record in found:
        assert [p["name"] for p in record["phases"]] == list(projection.PHASES)
        assert record["points"] == 2000 * record["ranks"] and record["machine"]
        assert record["commit"] or not has_commit, record
    assert row_of(done.stdout, "1", 16)[4] == "100%" and row_of(done.stdout, "32", 16)[2] == "sampled", done.stdout
    assert "As if 8 ranks had only been sampled" in done.stdout and "kuzmin: below 85% from 2 ranks on" in done.stdout
    foretold, run_exactly = found[4], found[3]
    assert abs(projection.differences(foretold, run_exactly)["bytes"]) < 0.15

    done = run("virtual", "strong", "--points", 4000, "--ranks", "1,3", "--distributions", "line", "--records", log,
               "--build", build)
    assert done.returncode == 0 and "in all 2 runs" in done.stdout, done.stdout + done.stderr
    done = run("virtual", "weak", "--points", 2000, "--ranks", "64", "--exact", 2000, "--distributions", "line", "--records",
               log, "--build", build)
    assert done.returncode == 1 and "--exact" in done.stderr, done
    done = run("virtual", "weak", "--points", 2000, "--ranks", "0", "--build", build)
    assert done.returncode == 2 and "--ranks" in done.stderr, done


def check_split_path_study(folder):
    log = folder / "split-path.jsonl"
    done = run("split-path", "--sizes", "2e3", "--distributions", "uniform,kuzmin", "--ranks", ",".join(map(str, ranks)),
               "--repeat", 1, "--records", log, "--scratch", folder, "--build", build)
    assert done.returncode == 0, done.stdout + done.stderr
    found = [json.loads(line) for line in log.read_text().splitlines()]
    assert sum(r["code"] == "pipeline" for r in found) == 2 * 2 * len(ranks)
    traces = [r["report"]["split_trace"]["levels"] for r in found if r["code"] == "trace"]
    assert len(traces) == 2 and all(levels[0]["subproblems"] == 1 for levels in traces)
    for kind in ("uniform", "kuzmin"):
        runs = [r for r in found if r["distribution"] == kind]
        assert f"2,000 points, {kind}, seed 1: {runs[0]['checksum']} in all {len(runs)} runs" in done.stdout, done.stdout
    # The table's first path is the trace's.
    row = row_of(done.stdout.split("length of the first path")[1], "2,000", 3)
    assert row[1:] == [f"{levels[0]['path'] / 2000 ** 0.5:.2f}" for levels in traces], (row, done.stdout)
    verdicts = done.stdout.split("against what is published")[1]
    assert f"kuzmin over uniform, {max(ranks)} ranks, default kernel" in verdicts, verdicts
    assert ("over the kernel alone" in verdicts) == has_kernel, verdicts

    done = run("split-path", "--sizes", "2e3", "--distributions", "kuzmin", "--build", build)
    assert done.returncode == 2 and "uniform" in done.stderr, done


def check_projection():
    """Factors that were put in come out; none is negative; fewer runs than terms are enough."""
    values = [3 * n + 5 * n * n for n in (1, 2, 4, 8)]
    found = projection.fit([[n, n * n] for n in (1, 2, 4, 8)], values, values)
    assert all(abs(found[k] - factor) < 1e-9 for k, factor in ((0, 3), (1, 5))), found
    falling = projection.fit([[1, n] for n in (1, 2, 3)], [3, 2, 1], [1, 1, 1])
    assert set(falling) == {0} and abs(falling[0] - 2) < 1e-9, falling
    assert projection.fit([[1], [1]], [0, 4], [1, 1e-9]) == {0: 4}  # the second must be met, the first need not
    assert projection.fit([[1, 7, 2]], [4], [1]) == {0: 4}
    assert projection.log2_ceiling(1) == 0 and projection.log2_ceiling(5) == 3
    network = projection.Network({"latency_s": 2, "overhead_s": 1, "bytes_per_second": 10})
    assert network.all_reduce(5, 20) == 3 * (2 + 2 + 2)


with tempfile.TemporaryDirectory() as temporary:
    check_drivers(pathlib.Path(temporary))
    check_tables(pathlib.Path(temporary))
    check_virtual_study(pathlib.Path(temporary))
    check_split_path_study(pathlib.Path(temporary))
check_projection()
print(f"strong, weak and distributions on {ranks} ranks: records and tables as promised")
