"""What the studies in this folder share: who may run how much, starting the command, one JSON record a run,
and medians, tables and plots of records.

A record is one line of JSON. All have the keys of `circumstances` and
  study        which one: strong, weak, distributions, ...
  distribution, seed, points
  code         what ran: "pipeline" (dovetail triangulate), "kernel" (its sequential kernel alone), ...
  ranks, repetition
  time, load_before, command
  checksum     of the mesh, 16 hexadecimal digits: equal problems must show equal ones
and what the study adds, such as `report`, the command's own (dovetail triangulate --report).
"""
import datetime
import json
import os
import pathlib
import platform
import shlex
import statistics
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parent.parent


# Where a study runs

def physical_cores():
    """Cores this process may use; hardware threads of one core count once, as MPI launchers count slots."""
    cores = set()
    for cpu in os.sched_getaffinity(0):
        siblings = pathlib.Path(f"/sys/devices/system/cpu/cpu{cpu}/topology/thread_siblings_list")
        cores.add(siblings.read_text().strip() if siblings.exists() else str(cpu))
    return len(cores)


def places():
    """How many ranks may run, and who says so."""
    if "SLURM_JOB_ID" in os.environ:
        tasks = os.environ.get("SLURM_NTASKS")
        if tasks is None:
            sys.exit("this SLURM allocation names no --ntasks")
        return int(tasks), f"the tasks of SLURM job {os.environ['SLURM_JOB_ID']}"
    return physical_cores(), f"the cores of {platform.node()}"


def first_line(*command):
    """The first line that a command prints; None if it fails or is not there."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, cwd=TOP, check=False)
    except OSError:
        return None
    return (done.stdout.splitlines() or [None])[0] if done.returncode == 0 else None


def machine():
    found = {"host": platform.node(), "system": platform.platform(), "cores": physical_cores()}
    for file, key, name in (("/proc/cpuinfo", "model name", "cpu"), ("/proc/meminfo", "MemTotal", "memory")):
        try:
            lines = pathlib.Path(file).read_text(encoding="utf-8").splitlines()
        except OSError:
            continue
        found[name] = next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), None)
    return found


def build_settings(build):
    wanted = ("CMAKE_BUILD_TYPE", "DOVETAIL_NATIVE", "DOVETAIL_DEVELOPER", "DOVETAIL_SANITIZE")
    settings = {}
    for line in (build / "CMakeCache.txt").read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition("=")
        if name.split(":")[0] in wanted:
            settings[name.split(":")[0]] = value
    return settings


def tell_unless_plain_release(build):
    settings = build_settings(build)
    if settings.get("CMAKE_BUILD_TYPE") != "Release" or "ON" in (settings.get("DOVETAIL_DEVELOPER"),
                                                                 settings.get("DOVETAIL_SANITIZE")):
        print(f"NOTE: {build} is not a plain Release build: {settings}")


def circumstances(build):
    """What is the same for all records of a study."""
    return {"commit": first_line("git", "describe", "--always", "--dirty", "--abbrev=12"), "machine": machine(),
            "mpi": first_line("mpiexec", "--version"), "build": build_settings(build)}


# Running

def usual_launcher():
    """mpiexec; inside a SLURM allocation srun, by PMIx if this SLURM speaks it."""
    if "SLURM_JOB_ID" not in os.environ:
        return "mpiexec -n {ranks}"
    spoken = subprocess.run(["srun", "--mpi=list"], capture_output=True, text=True, check=False)
    return f"srun{' --mpi=pmix' if 'pmix' in spoken.stdout + spoken.stderr else ''} --ntasks={{ranks}}"


class Runner:
    """Starts programs of a build on a number of ranks."""

    def __init__(self, build, launcher=None):
        self.launcher = launcher or usual_launcher()
        self.build = build
        self.environment = dict(os.environ)
        if os.geteuid() == 0:
            self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def run(self, ranks, program, *words):
        """The command line and what was printed; a failure ends the study. No ranks: without the launcher."""
        launcher = shlex.split(self.launcher.format(ranks=ranks)) if ranks is not None else []
        command = [*launcher, str(self.build / program), *map(str, words)]
        done = subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            sys.exit(f"failed with {done.returncode}: {shlex.join(command)}")
        return shlex.join(command), done.stdout


def now():
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


class Log:
    """Appends records to a file; each is on disk as soon as it is known."""

    def __init__(self, path):
        self.path = path
        self.records = []

    def add(self, record):
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")
        self.records.append(record)


def read(paths):
    found = []
    for path in paths:
        for number, line in enumerate(pathlib.Path(path).read_text(encoding="utf-8").splitlines(), 1):
            try:
                found.append(json.loads(line))
            except json.JSONDecodeError as error:
                sys.exit(f"{path}, line {number}: not a record: {error}")
    return found


# Reading records

def phase(record, name):
    return next(p for p in record["report"]["phases"] if p["name"] == name)


def median(records, value):
    return statistics.median(value(record) for record in records)


def groups(records, *keys):
    """Records by the values of some keys, in the order in which they come first."""
    found = {}
    for record in records:
        found.setdefault(tuple(record[key] for key in keys), []).append(record)
    return found


def checksums_agree(records):
    """Prints, for each problem (distribution, seed, points) that ran more than once, whether all its runs made the
    same mesh."""
    agree, once = True, 0
    for (distribution, seed, points), runs in groups(records, "distribution", "seed", "points").items():
        found = sorted({run["checksum"] for run in runs})
        name = f"checksum of {points:,} points, {distribution}, seed {seed}"
        if len(found) > 1:
            agree = False
            print(f"{name} DIFFERS between runs: {', '.join(found)}")
        elif len(runs) > 1:
            print(f"{name}: {found[0]} in all {len(runs)} runs")
        else:
            once += 1
    if once:
        print(f"{once} problems ran once: nothing to compare their checksums with")
    return agree


# Tables and plots

def print_table(head, rows):
    """Columns as wide as their widest word, aligned to the right."""
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    for row in [head, *rows]:
        print("  ".join(f"{word:>{width}}" for word, width in zip(row, widths)))


def plot(path, title, x_label, y_label, curves, settings=()):
    """A picture (SVG or PNG, by the extension) of curves {name: [(x, y), ...]} by gnuplot; False without it.
    `settings`: more lines for gnuplot, such as "set logscale xy 2"."""
    terminal = {".svg": "svg size 720,480 background 'white'", ".png": "pngcairo size 960,640"}[path.suffix]
    quoted = [text.replace("\\", "").replace('"', "") for text in (str(path), title, x_label, y_label)]
    script = [f"set terminal {terminal} noenhanced", f'set output "{quoted[0]}"', f'set title "{quoted[1]}"',
              f'set xlabel "{quoted[2]}"', f'set ylabel "{quoted[3]}"', "set key outside", "set grid", *settings]
    for i, points in enumerate(curves.values()):
        script += [f"$curve{i} << EOD", *(f"{x!r} {y!r}" for x, y in points), "EOD"]
    titles = [name.replace('"', "") for name in curves]
    script.append("plot " + ", ".join(f'$curve{i} with linespoints title "{t}"' for i, t in enumerate(titles)))
    try:
        done = subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True, capture_output=True, check=False)
    except FileNotFoundError:
        return False
    if done.returncode:
        sys.exit(f"gnuplot failed: {done.stderr}")
    return True
