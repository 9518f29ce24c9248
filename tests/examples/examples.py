#!/usr/bin/env python3
"""Runs an example and checks what it prints.

usage: examples.py EXAMPLE PROGRAM     $DOVETAIL_MPIEXEC starts the ranks (default: mpiexec)
"""
import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree

import numpy

RANKS = (1, 2, 3)


def output_of(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=120)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}"
    return done.stdout


def on_ranks(program, ranks):
    return output_of(os.environ.get("DOVETAIL_MPIEXEC", "mpiexec"), "-n", str(ranks), program)


def numbers_in(text):
    return [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e[+-]\d+)?", text)]


def convex_hull(points):
    """By the monotone chain of Andrew; corners only, counter-clockwise."""
    def half(sequence):
        chain = []
        for p in sequence:
            while len(chain) > 1 and numpy.cross(chain[-1] - chain[-2], p - chain[-1]) <= 0:
                chain.pop()
            chain.append(p)
        return chain[:-1]
    ordered = points[numpy.lexsort((points[:, 1], points[:, 0]))]
    return numpy.array(half(ordered) + half(ordered[::-1]))


def check_serial(program):
    k = numpy.arange(1000)
    angle = 2.399963229728653 * k
    hull = convex_hull(numpy.sqrt(k)[:, None] * numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1))
    beyond = numpy.roll(hull, -1, axis=0)
    points, triangles, edges, perimeter, area = numbers_in(output_of(program))
    assert (points, edges) == (1000, len(hull)), (points, edges, len(hull))
    assert triangles == 2 * points - 2 - edges, triangles
    assert math.isclose(perimeter, numpy.hypot(*(beyond - hull).T).sum(), abs_tol=1e-3), perimeter
    assert math.isclose(area, numpy.cross(hull, beyond).sum() / 2, abs_tol=1e-3), area


def check_in_memory(program):
    last_lines = set()
    for ranks in RANKS:
        lines = on_ranks(program, ranks).splitlines()
        own = {}
        for line in lines:
            match = re.fullmatch(r"rank (\d+): (\d+) slabs, (\d+) inner sides, (\d+) to other ranks \(([ \d]*) \), "
                                 r"(\d+) on the hull", line)
            if match:
                own[int(match[1])] = (*map(int, match.group(2, 3, 4, 6)), set(map(int, match[5].split())))
        assert sorted(own) == list(range(ranks)), lines
        for rank, (slabs, _, border, _, neighbours) in own.items():
            assert slabs >= 1 and (border > 0) == bool(neighbours) == (ranks > 1), lines
            assert all(rank in own[other][4] for other in neighbours - {rank}) and rank not in neighbours, lines
        (summary,) = [line for line in lines if "checksum" in line]
        sites, triangles = numbers_in(summary)[:2]
        hull = sum(of_rank[3] for of_rank in own.values())
        assert sites == 10000 and triangles == 2 * sites - 2 - hull, (summary, hull)
        assert sum(sum(of_rank[1:4]) for of_rank in own.values()) == 3 * triangles, lines
        last_lines.add(summary)
        caught = [line.split(": ", 1)[1] for line in lines if "caught" in line]
        assert len(caught) == ranks and len(set(caught)) == 1 and f"rank {ranks - 1}" in caught[0], caught
    assert len(last_lines) == 1, last_lines  # one mesh, however many ranks


def check_poisson(program):
    tables = [numpy.array([numbers_in(line) for line in on_ranks(program, ranks).splitlines()]) for ranks in RANKS]
    for table in tables:
        assert list(table[:, 0]) == [8, 16, 32, 64], table
        orders = numpy.log2(table[:-1, 1] / table[1:, 1])
        assert (orders > 1.8).all() and (orders < 2.3).all(), orders
        assert numpy.allclose(orders, table[1:, 2], atol=0.006), table
        assert table[-1, 1] < 1e-3, table
        assert numpy.allclose(table[:, 1], tables[0][:, 1], rtol=1e-8, atol=0), (table, tables[0])


def check_refined_poisson(program):
    table = numpy.array([numbers_in(line) for line in output_of(program).splitlines()])
    triangles, largest, error = table.T
    assert numpy.allclose(largest[:-1] / largest[1:], 4), table
    assert ((triangles[1:] / triangles[:-1] > 3) & (triangles[1:] / triangles[:-1] < 5)).all(), table
    orders = numpy.log2(error[:-1] / error[1:]) / numpy.log2(triangles[1:] / triangles[:-1]) * 2
    assert (orders > 1.7).all() and abs(orders.mean() - 2) < 0.2, orders  # in the mesh size, the root of the area
    assert error[-1] < 1e-3, table


def check_insertion(program):
    """One frame a step; after the flips the same star as after the cavity's commit."""
    picture = xml.etree.ElementTree.fromstring(output_of(program))
    frames = picture.findall("{*}g")
    captions = [frame.find("{*}text").text for frame in frames]
    begin = captions.index("commit: the star of the site takes its place")
    assert begin >= 3 and re.fullmatch(r"after \d+ flips: the same star", captions[-1]), captions
    edges = [sorted(frame.find("{*}path[@class='edges']").get("d")[1:].split("M")) for frame in frames]
    undirected = [{frozenset(edge.split("L")) for edge in of_frame} for of_frame in edges]
    assert undirected[begin] == undirected[-1] and undirected[begin] != undirected[begin - 1]
    assert [frame.get("visibility") for frame in frames] == ["hidden"] * (len(frames) - 1) + ["visible"]


if __name__ == "__main__":
    example, program_path = sys.argv[1:]
    {"serial": check_serial, "in_memory": check_in_memory, "poisson": check_poisson,
     "refined_poisson": check_refined_poisson, "insertion": check_insertion}[example](program_path)
    print(f"{example}: as it must be")
