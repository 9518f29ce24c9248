"""Domains of the kinds that break mesh generators, from file to verified mesh, and how time grows with their size.

Alone, prints the table: DOVETAIL_FULL=1 DOVETAIL_COMMAND=build/dovetail python3 tests/end_to_end/domain_families.py
"""

import math
import random
import resource
import unittest

import harness

ANGLES = (20, 26.45, 30)
# Vertices of the input, about. Small ones take as long as starting the command does.
SIZES = (1000, 10_000, 100_000) if harness.FULL else (150,)


class Drawing:
    """Vertices and segments of a .poly file."""

    def __init__(self):
        self.vertices, self.segments = [], []

    def line(self, *points):
        first = len(self.vertices)
        self.vertices += points
        self.segments += [(i, i + 1) for i in range(first, len(self.vertices) - 1)]

    def ring(self, points):
        first = len(self.vertices)
        self.line(*points)
        self.segments.append((len(self.vertices) - 1, first))

    def square(self, low, side):
        (x, y) = low
        self.ring([(x, y), (x + side, y), (x + side, y + side), (x, y + side)])

    def poly(self, scale=1.0, shift=0.0):
        place = lambda value: repr(scale * value + shift)
        rows = [f"{len(self.vertices)} 2 0 0"]
        rows += [f"{i} {place(x)} {place(y)}" for i, (x, y) in enumerate(self.vertices)]
        rows += [f"{len(self.segments)} 1"]
        rows += [f"{i} {a} {b} {1 + i % 7}" for i, (a, b) in enumerate(self.segments)]
        return "\n".join(rows) + "\n0\n"


def on_circle(radius, turn):
    return (radius * math.cos(2 * math.pi * turn), radius * math.sin(2 * math.pi * turn))


def tiles(count):
    """Lower left corners of unit squares that are stacked to a square."""
    side = math.isqrt(count - 1) + 1
    return side, [(i % side, i // side) for i in range(count)]


def comb(n):
    drawing, teeth = Drawing(), n // 4
    outline = [(0, -1), (teeth - 0.2, -1)]
    for i in reversed(range(teeth)):
        outline += [(i + 0.8, 0), (i + 0.8, 3), (i, 3), (i, 0)]
    drawing.ring(outline[:2] + outline[3:-1])
    return drawing


def star(degrees):
    def draw(n):
        drawing, spikes = Drawing(), n // 2
        # The tip at distance 1 sees the two inner vertices beside it, half a step away, under the angle.
        half_step, half_angle = math.pi / spikes, math.radians(degrees) / 2
        inner = math.sin(half_angle) / math.sin(math.pi - half_step - half_angle)
        drawing.ring([on_circle(*place) for i in range(spikes) for place in ((1, i / spikes), (inner, (i + 0.5) / spikes))])
        return drawing

    return draw


def fans(n):
    """Of 40 lines each, of three lengths; many more at one vertex make meshes that grow with their square."""
    drawing = Drawing()
    _, corners = tiles(max(1, n // 45))
    for x, y in corners:
        drawing.square((5 * x, 5 * y), 4)
        centre = len(drawing.vertices)
        drawing.vertices.append((5 * x + 2, 5 * y + 2))
        for i in range(40):
            drawing.segments.append((centre, len(drawing.vertices)))
            dx, dy = on_circle(1 + 0.3 * (i % 3), (i + 0.3) / 40)
            drawing.vertices.append((5 * x + 2 + dx, 5 * y + 2 + dy))
    return drawing


def slits(n):
    drawing, gap = Drawing(), 0.001
    side, corners = tiles(max(1, n // 4))
    drawing.square((0, 0), side)
    for x, y in corners:
        drawing.line((x + 0.5, y + 0.5), (x + 0.52, y + 0.5))
        drawing.line((x + 0.5 + gap, y + 0.5 + gap), (x + 0.52 + 2 * gap, y + 0.5 + 1.5 * gap))
    return drawing


def nested(n):
    drawing = Drawing()
    _, corners = tiles(max(1, n // 24))
    for x, y in corners:
        for inset in (0.1, 0.13, 0.2, 0.23, 0.3, 0.33):
            drawing.square((x + inset, y + inset), 1 - 2 * inset)
    return drawing


def many_sides(n):
    drawing = Drawing()
    drawing.ring([on_circle(1, i / n) for i in range(n)])
    return drawing


def crossing(n):
    draw, drawing = random.Random(n), Drawing()
    drawing.square((0, 0), 1)
    reach = 1.5 / math.sqrt(n / 2)
    for _ in range(n // 2):
        x, y, turn = draw.uniform(0.02, 0.98), draw.uniform(0.02, 0.98), draw.random()
        (dx, dy) = on_circle(reach, turn)
        drawing.line((x, y), (min(max(x + dx, 0.01), 0.99), min(max(y + dy, 0.01), 0.99)))
    return drawing


def chords(n):
    """Long ones, which make about n vertices where they cross."""
    draw, drawing = random.Random(n), Drawing()
    drawing.square((0, 0), 1)
    for _ in range(int(2 * math.sqrt(n))):
        drawing.line(*((draw.uniform(0.02, 0.98), draw.uniform(0.02, 0.98)) for _ in range(2)))
    return drawing


FAMILY = {
    "comb": comb,
    "star of 10 degrees": star(10),
    "star of 0.1 degrees": star(0.1),
    "fans": fans,
    "slits": slits,
    "nested holes": nested,
    "many-sided": many_sides,
    "crossing segments": crossing,
    "chords": chords,
}


def user_seconds():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


class Families(harness.TestCase):
    def refine_and_verify(self, domain, angle, holes, may_lack_room):
        """The report of refine, its user seconds and those of verify."""
        mesh = self.folder / "mesh.vtkhdf"
        begin = user_seconds()
        refined = self.report_of("refine", domain, "-o", mesh, "--min-angle", angle, "--holes", holes, timeout=600)
        middle = user_seconds()
        verdict = self.report_of("verify", mesh, "--domain", domain, timeout=600)
        self.assertTrue(verdict["valid"])
        reasons = {left["reason"] for left in refined["left_triangles"]}
        if may_lack_room:
            self.assertLessEqual(reasons, {"small input angle", "precision"})
        else:
            self.assertLessEqual(reasons, {"small input angle"})
            self.assertEqual((verdict["left_triangles"], refined["left_subsegments"]), (0, 0))
        return refined, middle - begin, user_seconds() - middle

    def run_family(self, name, scale, shift):
        holes = "even-odd" if name == "nested holes" else "seeds"
        domain = self.folder / "domain.poly"
        # Random lines may cross nearer to each other than doubles at 1e7 resolve: told, and nothing else.
        may_lack_room = shift > 0 and name in ("crossing segments", "chords")
        before = None
        for size in SIZES:
            domain.write_text(FAMILY[name](size).poly(scale, shift))
            for angle in ANGLES if size < 50_000 else (26.45,):
                refined, seconds, verify_seconds = self.refine_and_verify(domain, angle, holes, may_lack_room)
                print(f"{name:20} {'at 1e7' if shift else '':7} {angle:6} degrees  {refined['points']:8,} given "
                      f"{refined['triangles']:10,} triangles  refine {seconds:7.2f} s  verify {verify_seconds:7.2f} s  "
                      f"{1e6 * seconds / refined['triangles']:6.2f} us a triangle", flush=True)
            # n log n, in what comes in and out; what starting takes is left out, caches are not.
            work = refined["points"] + refined["triangles"]
            if before is not None:
                self.assertLess(seconds / work, 3 * (before[1] + 0.2) / before[0], (name, size))
            before = work, seconds

    def test_families(self):
        for name in FAMILY:
            with self.subTest(name):
                self.run_family(name, 1, 0)

    def test_families_far_from_the_origin(self):
        for name in FAMILY if harness.FULL else ("slits", "crossing segments"):
            with self.subTest(name):
                self.run_family(name, 1000, 1e7)


if __name__ == "__main__":
    harness.main()
