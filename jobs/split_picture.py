"""Draws how the split-path kernel splits a few points, as its authors drew it: the points and the line, the points on
the paraboloid over it with their lower hull, the path, and the whole recursion."""
import json
import subprocess
import sys

DISTRIBUTION, POINTS, SEED = "uniform", 300, 3
COLOURS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#999999"]  # told apart by the colour-blind


def block(name, rows):
    """Rows of numbers for gnuplot; an empty row interrupts a line."""
    return [f"${name} << EOD", *(" ".join(f"{value!r}" for value in row) for row in rows), "EOD"]


def lifted(first, site):
    """A site seen along the split line: its place on the line, its height on the paraboloid centred there."""
    across, along = (0, 1) if first["axis"] == "x" else (1, 0)
    return site[along], (site[across] - first["line"]) ** 2 + site[along] ** 2


def script(told, terminal, path):
    sites, splits = told["sites"], told["splits"]
    first = splits[0]
    depths = 1 + max(split["depth"] for split in splits)
    lines = block("sites", sites)
    lines += block("path", [sites[v] for v in first["path"]])
    lines += block("lifted", [lifted(first, site) for site in sites])
    lines += block("hull", [lifted(first, sites[v]) for v in first["path"]])
    for depth in range(depths):
        rows = []
        for split in (s for s in splits if s["depth"] == depth):
            rows += [*(sites[v] for v in split["path"]), []]
        lines += block(f"depth{depth}", rows)
    where = f"{first['line']!r}"
    line = f"set arrow 1 from {where}, graph 0 to {where}, graph 1 nohead dt 2 lc rgb '#555555'" if first["axis"] == "x" else \
        f"set arrow 1 from graph 0, first {where} to graph 1, first {where} nohead dt 2 lc rgb '#555555'"
    points = "$sites with points pt 7 ps 0.3 lc rgb '#444444' notitle"
    lines += [f"set terminal {terminal}", f'set output "{path}"', "set multiplot layout 2,2 margins 0.03,0.98,0.03,0.93 "
              "spacing 0.05,0.08", "unset key", "unset tics", "set size ratio -1", line,
              'set title "points and split line"', f"plot {points}", "unset arrow 1", "set size noratio",
              'set title "on the paraboloid over the line, and their lower hull"',
              "plot $lifted with points pt 7 ps 0.3 lc rgb '#444444', $hull with linespoints pt 7 ps 0.4 lw 1.5 lc rgb "
              f"'{COLOURS[0]}'", "set size ratio -1", line, 'set title "the path: the hull, seen in the plane"',
              f"plot {points}, $path with linespoints pt 7 ps 0.4 lw 1.5 lc rgb '{COLOURS[0]}'", "unset arrow 1",
              'set title "the recursion: a colour a level"']
    drawn = [f"$depth{d} with lines lw {max(0.8, 2.2 - 0.25 * d)} lc rgb '{COLOURS[min(d, len(COLOURS) - 1)]}'"
             for d in reversed(range(depths))]
    return [*lines, "plot " + ", ".join([*drawn, points]), "unset multiplot"]


def draw(runner, path):
    _, printed = runner.run(None, "tests/benchmark/split_steps", DISTRIBUTION, POINTS, SEED)
    terminal = {".svg": "svg size 800,800 background 'white'", ".png": "pngcairo size 800,800 fontscale 0.9"}.get(path.suffix)
    if terminal is None or '"' in str(path):
        sys.exit(f"jobs/split-path: {path}: only .png and .svg can be drawn")
    try:
        subprocess.run(["gnuplot"], input="\n".join(script(json.loads(printed), terminal, path)) + "\n", text=True, check=True)
    except FileNotFoundError:
        sys.exit("jobs/split-path: gnuplot is not there: tools/install-dependencies plots")
    print(f"wrote {path}")
    return 0
