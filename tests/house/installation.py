#!/usr/bin/env python3
"""Installs a build into a fresh folder, and builds and runs a project that uses what is installed.

usage: installation.py BUILD CONSUMER KERNEL_ALONE
"""
import pathlib
import subprocess
import sys
import tempfile

build, consumer, kernel_alone = map(pathlib.Path, sys.argv[1:])


def run(*command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}"
    return done.stdout


with tempfile.TemporaryDirectory(prefix="dovetail installation ") as folder:
    prefix, work = pathlib.Path(folder) / "prefix", pathlib.Path(folder) / "work"
    run("cmake", "--install", build, "--prefix", prefix)
    run("cmake", "-S", consumer, "-B", work, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DDOVETAIL_KERNEL_ALONE={kernel_alone}",
        "-DCMAKE_BUILD_TYPE=Debug")
    run("cmake", "--build", work)
    installed = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file()}
    assert {"bin/dovetail", "include/dovetail/mesh/triangulation.hpp"} <= installed, installed
    run(prefix / "bin" / "dovetail", "--version")
    assert len(run(work / "over_kernel").strip()) == 16
    said = run(work / "over_library")
    assert said == "points.f64: it is not there\n", said
print(f"{len(installed)} files installed; programs over the kernel and over the library built and run")
