#!/usr/bin/env python3
"""The first points of every distribution, worked out again from the description in distributions.hpp.

Whole-number arithmetic for the words; Python's floats are IEEE doubles without fused multiply-add; the
logarithm is taken from `decimal` with 50 digits. Prints the table in distributions_test.cpp.
"""
from decimal import Decimal, getcontext
from math import isqrt, sqrt
from struct import pack, unpack

getcontext().prec = 50
M = 2**64 - 1
G = 0x9E3779B97F4A7C15


def mix(v):
    v = ((v ^ v >> 30) * 0xBF58476D1CE4E5B9) & M
    v = ((v ^ v >> 27) * 0x94D049BB133111EB) & M
    return v ^ v >> 31


def absorb(h, w):
    return mix(((h ^ w) + G) & M)


def key(seed, stream):
    return absorb(absorb(0, seed), stream)


class Draws:
    def __init__(self, k, index):
        self.h, self.k = absorb(k, index), 0

    def word(self):
        self.k += 1
        return mix((self.h + self.k * G) & M)

    def unit(self):
        return (self.word() >> 11) / 2**53

    def below(self, bound):
        return (self.word() >> 32) * bound >> 32

    def disk(self):
        while True:
            x = 2 * self.unit() - 1
            y = 2 * self.unit() - 1
            s = x * x + y * y
            if 0 < s < 1:
                return x, y, s


def normal(d):
    x, y, s = d.disk()
    f = sqrt(-2 * float(Decimal(s).ln()) / s)
    return x * f, y * f


def point(name, n, seed, i):
    d = Draws(key(seed, 0), i)
    if name == "uniform":
        x = d.unit()
        return x, d.unit()
    if name == "normal":
        return normal(d)
    if name == "kuzmin":
        u = d.unit()
        r = sqrt(u * (2 - u)) / (1 - u)
        x, y, s = d.disk()
        f = r / sqrt(s)
        return x * f, y * f
    if name == "line":
        b = 0.001
        u = d.unit()
        x = b / (u - b * u + b)
        return x, d.unit()
    if name == "circle":
        x, y, s = d.disk()
        length = sqrt(s)
        return x / length, y / length
    if name == "lidar":
        x = int(d.unit() * 100000 + 0.5)
        return x / 100, int(d.unit() * 100000 + 0.5) / 100
    if name == "clusters":
        c = Draws(key(seed, 1), d.below(isqrt(n)))
        cx = c.unit()
        cy = c.unit()
        x, y = normal(d)
        return cx + 0.001 * x, cy + 0.001 * y
    if name == "lattice":
        columns = isqrt(n - 1) + 1
        rows = -(-n // columns)
        keys = [absorb(key(seed, 2), k) for k in range(6)]
        row, column = divmod(i, columns)
        while True:
            for k in (0, 2, 4):
                column = (column + ((absorb(keys[k], row) >> 32) * columns >> 32)) % columns
                row = (row + ((absorb(keys[k + 1], column) >> 32) * rows >> 32)) % rows
            if row * columns + column < n:
                return float(column), float(row)


def bits(v):
    return unpack("<Q", pack("<d", v))[0]


for name in "uniform normal kuzmin line lattice circle lidar clusters".split():
    for n, seed, i in ((1000, 0, 0), (1000, 1, 1), (1000, 1, 999), (10**12, 2**64 - 1, 10**12 - 1)):
        x, y = point(name, n, seed, i)
        print(f"    {{Distribution::{name}, {n}, 0x{seed:x}, {i}, 0x{bits(x):016x}, 0x{bits(y):016x}}},")
