"""README's transcripts: what stands behind a $ is run, in the order of the page, and must print what stands below."""

import os
import pathlib
import re
import subprocess
import unittest

import harness

# What differs from run to run.
MEASURED = re.compile(r"^(time|memory) .*", re.MULTILINE)


def transcripts(page):
    """(command, what it prints) for every indented line that begins with a $."""
    found = []
    for block in re.findall(r"(?:^    .*\n)+", page, re.MULTILINE):
        for line in block.splitlines():
            if line.startswith("    $ "):
                found.append((line.removeprefix("    $ "), []))
            elif found and "    $ " in block:
                found[-1][1].append(line.removeprefix("    ") + "\n")
    return [(command, "".join(lines)) for command, lines in found]


class Readme(harness.TestCase):
    def test_transcripts(self):
        commands = transcripts((harness.CHECKOUT / "README.md").read_text())
        self.assertGreater(len(commands), 5)
        folder = pathlib.Path(harness.COMMAND).parent
        environment = dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}", DOVETAIL_MPIEXEC=harness.MPIEXEC)
        for command, printed in commands:
            run = subprocess.run(
                ["sh", "-c", f'mpirun() {{ "$DOVETAIL_MPIEXEC" "$@"; }}\n{command}'],
                cwd=self.folder, env=environment, capture_output=True, text=True, timeout=harness.TIMEOUT_S,
            )
            self.assertEqual(run.returncode, 0, f"{command}\n{run.stderr}")
            self.assertEqual(MEASURED.sub(r"\1", run.stdout), MEASURED.sub(r"\1", printed), command)


if __name__ == "__main__":
    harness.main()
