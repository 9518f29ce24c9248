"""Every example of every --help is a command line that parses and, on small points, works."""

import re
import shlex
import unittest

import harness
from harness import dovetail, write_las

SUBCOMMANDS = ("triangulate", "generate", "verify", "info", "convert", "stats", "render", "insert", "constrain",
               "refine")


def examples(*command):
    """The lines of a help text that begin a command, split into words."""
    text = dovetail(*command, "--help")
    assert text.code == 0, text
    lines = [line.strip() for line in text.out.splitlines() if re.match(r"  (mpirun .*)?dovetail ", line)]
    assert lines, text
    return [shlex.split(line) for line in lines]


class Help(harness.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The files that examples read, made small.
        square = "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n4 0\n0 0 1\n1 1 2\n2 2 3\n3 3 0\n0\n"
        (cls.folder / "coast.poly").write_text(square)
        (cls.folder / "part.poly").write_text(square)
        (cls.folder / "parcels.geojson").write_text(
            '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}')
        for name in ("stars.npy", "west.npy", "east.npy", "wells.csv", "survey.las"):
            made = cls.folder / name
            seed = str(len(name))
            if name.endswith(".las"):
                write_las(made)
            else:
                run = dovetail("generate", "uniform", "-n", "500", "--seed", seed, "-o", made)
                assert run.code == 0, run

    def run_example(self, words):
        ranks = 0
        if words[0] == "mpirun":
            ranks = min(2, int(words[2]))
            words = words[3:]
        self.assertEqual(words[0], "dovetail")
        arguments = ["1000" if re.fullmatch(r"[\d.]+e\d|\d{7}", word) else word for word in words[1:]]
        run = dovetail(*arguments, ranks=ranks, cwd=self.folder)
        self.assertEqual(run.code, 0, run)
        self.assertEqual(run.messages, [], run)

    def test_examples(self):
        # In the order in which one makes what the next reads.
        for command in ((), ("generate",), ("triangulate",), ("verify",), ("info",), ("convert",), ("stats",),
                        ("render",), ("insert",), ("constrain",), ("refine",)):
            for words in examples(*command):
                with self.subTest(example=" ".join(words)):
                    self.run_example(words)

    def test_help_is_printed_once(self):
        run = self.succeed("--help", ranks=3)
        self.assertEqual(run.out.count("Usage: dovetail"), 1, run)
        for subcommand in SUBCOMMANDS:
            self.assertIn(f"\n  {subcommand} ", run.out)
            self.assertIn(f"Usage: dovetail {subcommand}", self.succeed(subcommand, "--help").out)

    def test_lines_fit_a_terminal(self):
        for command in ((), *((s,) for s in SUBCOMMANDS)):
            for line in self.succeed(*command, "--help").out.splitlines():
                self.assertLessEqual(len(line), 110, line)

    def test_version(self):
        for ranks in (0, 2):
            run = self.succeed("--version", ranks=ranks)
            self.assertRegex(run.out, r"^dovetail \d+\.\d+\.\d+\nmesh format \d+\nMPI: \S.*\nHDF5 \d+\.\d+\.\d+\n$")


if __name__ == "__main__":
    harness.main()
