#!/usr/bin/env python3
"""Who may include whom: reads include/dovetail and src and names every line that breaks the layering.

usage: layers.py CHECKOUT
"""
import pathlib
import re
import sys

# A layer may include itself and these.
MAY_KNOW = {
    "base": set(),
    "geometry": {"base"},
    "mesh": {"base", "geometry"},
    "comm": {"base"},
    "distributed": {"base", "geometry", "mesh", "comm"},
    "io": {"base", "geometry", "mesh", "comm", "distributed"},
    "cli": {"base", "geometry", "mesh", "comm", "distributed", "io"},
}
MPI_HEADER = re.compile(r"^(mpi\.h|mpio\.h|boost/mpi(\.hpp|/.*))$")
HDF5_HEADER = re.compile(r"^(hdf5|H5\w*)\.h$")
KNOWS_MPI = {"comm", "io", "cli"}  # the command starts MPI
KNOWS_HDF5 = {"io"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
# What no library may say: it is given a communicator, it returns to its caller, it serves every MPI.
FORBIDDEN = {
    "MPI_COMM_WORLD": re.compile(r"\bMPI_COMM_WORLD\b"),
    "MPI_Init": re.compile(r"\bMPI_(Init|Init_thread|Finalize)\b"),
    "a default boost::mpi::communicator (the world)": re.compile(r"\bmpi::communicator\s+\w*[^\W_]\s*(;|\{\s*\}|\(\s*\)\s*;)"),
    "exit or abort": re.compile(r"(?<![\w.>])(std::)?(_?exit|quick_exit|abort)\s*\("),
    "something only Open MPI has": re.compile(r"\b(OMPI_|OPEN_MPI|MPIX_)|mpi-ext\.h"),
}


def layer_of(included, own):
    """The layer that a quoted include names, or None if it is no layer's."""
    parts = pathlib.PurePosixPath(included).parts
    if parts[0] == "dovetail":
        parts = parts[1:]
    if len(parts) == 1:
        return own  # beside the file that includes it
    return parts[0] if parts[0] in MAY_KNOW else None


def without_comments(text):
    """The same lines with // and /* */ comments and string literals blanked, includes kept."""
    kept = lambda match: match.group(0) if match.group(0).startswith("#") else re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r'#\s*include[^\n]*|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', kept, text, flags=re.S)


def faults_of(path, layer):
    for number, line in enumerate(without_comments(path.read_text(encoding="utf-8")).splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            included = match.group(2)
            if match.group(1) == '"':
                other = layer_of(included, layer)
                if other is None:
                    yield number, f'"{included}" names no layer'
                elif other != layer and other not in MAY_KNOW[layer]:
                    yield number, f"{layer} must not know {other}"
            if MPI_HEADER.match(included) and layer not in KNOWS_MPI:
                yield number, f"{layer} must not include MPI"
            if HDF5_HEADER.match(included) and layer not in KNOWS_HDF5:
                yield number, f"{layer} must not include HDF5"
        elif layer != "cli":
            for name, pattern in FORBIDDEN.items():
                if pattern.search(line):
                    yield number, f"a library must not name {name}"


def main(checkout):
    root = pathlib.Path(checkout)
    files = faults = 0
    for top in (root / "include" / "dovetail", root / "src"):
        for path in sorted(top.rglob("*")):
            if path.suffix not in (".hpp", ".cpp", ".h"):
                continue
            layer = path.relative_to(top).parts[0]
            files += 1
            if layer not in MAY_KNOW:
                print(f"{path}: {layer} is no layer")
                faults += 1
                continue
            for number, fault in faults_of(path, layer):
                print(f"{path}:{number}: {fault}")
                faults += 1
    print(f"{files} files, {faults} faults")
    return 1 if faults or not files else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
