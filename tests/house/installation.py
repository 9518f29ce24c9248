#!/usr/bin/env python3
"""Installs a build into a fresh folder, and builds and runs programs that use what is installed: by find_package, and
by pkg-config where there is one.

usage: installation.py BUILD CONSUMER KERNEL_EXAMPLE COMPILER
"""
import json
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

build, consumer, kernel_example = map(pathlib.Path, sys.argv[1:4])
compiler = sys.argv[4]


def run(*command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    assert done.returncode == 0, f"{command}\n{done.stdout}"
    return done.stdout


def check(programs):
    """The two programs in a folder do what they do in a build."""
    kernel = run(programs / "over_kernel")
    assert kernel.startswith("1000 points, 1964 triangles\n"), kernel
    library = run(programs / "over_library", programs / "mesh.vtkhdf").splitlines()
    assert library[0] == "5 sites, 4 triangles", library
    assert len(library) == 2 and library[1].startswith("no such.vtkhdf"), library


def build_by_cmake(prefix, work):
    run("cmake", "-S", consumer, "-B", work, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DDOVETAIL_OVER_KERNEL={kernel_example}",
        "-DCMAKE_BUILD_TYPE=Debug", f"-DCMAKE_CXX_COMPILER={compiler}", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")
    run("cmake", "--build", work)
    for unit in json.loads((work / "compile_commands.json").read_text(encoding="utf-8")):
        assert "-ffp-contract=off" in unit["command"], unit


def build_by_pkg_config(prefix, work):
    (folder,) = {path.parent for path in prefix.rglob("*.pc")}
    work.mkdir()
    for name, package, source in (("over_kernel", "dovetail_kernel", kernel_example),
                                  ("over_library", "dovetail", consumer / "over_library.cpp")):
        flags = {}
        for kind in ("--cflags", "--libs"):
            flags[kind] = shlex.split(run("env", f"PKG_CONFIG_PATH={folder}", "pkg-config", kind, package))
        assert "-ffp-contract=off" in flags["--cflags"], flags
        if package == "dovetail_kernel":
            assert not any(word in " ".join(flags["--libs"]) for word in ("mpi", "hdf5", "boost")), flags
        run(compiler, "-std=c++20", *flags["--cflags"], source, "-o", work / name, *flags["--libs"])


with tempfile.TemporaryDirectory(prefix="dovetail installation ") as top:
    prefix, by_cmake, by_pkg_config = (pathlib.Path(top) / name for name in ("prefix", "by cmake", "by pkg-config"))
    run("cmake", "--install", build, "--prefix", prefix)
    installed = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file()}
    assert {"bin/dovetail", "include/dovetail/mesh/triangulation.hpp"} <= installed, installed
    run(prefix / "bin" / "dovetail", "--version")
    build_by_cmake(prefix, by_cmake)
    check(by_cmake)
    ways = "by find_package"
    if shutil.which("pkg-config"):
        build_by_pkg_config(prefix, by_pkg_config)
        check(by_pkg_config)
        ways += " and by pkg-config"
print(f"{len(installed)} files installed; programs over the kernel and over the library built and run {ways}")
