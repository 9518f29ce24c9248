#!/usr/bin/env python3
"""The scaling driver leaves the records and the table that it promises, and refuses more ranks than cores.

usage: studies.py CHECKOUT BUILD
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

checkout, build = sys.argv[1:]
ranks = [1, 2] if len(os.sched_getaffinity(0)) >= 2 else [1]


def scaling(*words):
    command = [sys.executable, f"{checkout}/jobs/scaling", *map(str, words), "--build", build]
    return subprocess.run(command, capture_output=True, text=True, check=False)


with tempfile.TemporaryDirectory() as folder:
    records = pathlib.Path(folder) / "records.jsonl"
    for study in ("strong", "weak"):
        records.unlink(missing_ok=True)
        done = scaling(study, "--ranks", ",".join(map(str, ranks)), "--points", "3e3", "--repeat", 2, "--distribution",
                       "kuzmin", "--records", records, "--scratch", folder)
        assert done.returncode == 0, done.stdout + done.stderr
        found = [json.loads(line) for line in records.read_text().splitlines()]
        assert [(r["repetition"], r["ranks"]) for r in found] == [(i, p) for i in range(2) for p in ranks]  # interleaved
        for record in found:
            assert record["report"]["ranks"] == record["ranks"]
            assert record["report"]["points"] == 3000 * (record["ranks"] if study == "weak" else 1)
            assert all(record[key] for key in ("machine", "mpi", "build", "time", "command"))
        checksums = {r["report"]["checksum"] for r in found}
        assert len(checksums) == (len(ranks) if study == "weak" else 1)
        assert all(f"{checksum} in all " in done.stdout for checksum in checksums), done.stdout
        assert "efficiency" in done.stdout and "NaN" not in done.stdout, done.stdout

    records.unlink()
    for words in (("--ranks", "1,9999"), ("--ranks", "0"), ("--ranks", "1,1"), ("--ranks", "two")):
        done = scaling("strong", *words, "--points", 10, "--records", records)
        assert done.returncode == 2 and "--ranks" in done.stderr, (words, done)
        assert not records.exists()
print(f"strong and weak scaling on {ranks} ranks: records and tables as promised")
