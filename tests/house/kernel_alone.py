#!/usr/bin/env python3
"""The kernel needs no MPI and no HDF5: neither its objects nor a program that links it alone.

usage: kernel_alone.py PROGRAM LIBRARY
"""
import re
import subprocess
import sys

program, library = sys.argv[1:]


def lines_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


output = lines_of(program)
assert len(output) == 1 and re.fullmatch("[0-9a-f]{16}", output[0]), output
needed = [line for line in lines_of("readelf", "--dynamic", program) if "(NEEDED)" in line]
assert needed, "a program without shared libraries?"
foreign = [line for line in needed if re.search(r"\[lib(mpi|open-|boost_mpi|boost_serialization|hdf5)", line)]
assert not foreign, foreign
symbols = lines_of("nm", "--demangle", library)
assert any("dovetail::" in symbol for symbol in symbols)
foreign = [symbol for symbol in symbols if re.search(r" (P?MPI_|H5[A-Z]|ompi_|boost::(mpi|serialization|archive))", symbol)]
assert not foreign, foreign[:10]
print(f"{len(needed)} shared libraries, {len(symbols)} symbols: none of MPI's or HDF5's")
