#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""What learn_movable.py makes of the counts of several runs, and what it refuses."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(sys.argv.pop(1)) / "learn_movable.py"
HEADER = "class,measured,moving,share\n"


def learn(files, *options):
    with tempfile.TemporaryDirectory() as folder:
        runs = []
        for number, text in enumerate(files):
            run = pathlib.Path(folder) / str(number)
            run.mkdir()
            if text is not None:
                (run / "class_motion.csv").write_text(text)
            runs.append(str(run))
        done = subprocess.run([sys.executable, str(TOOL), *runs, *options], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout.strip(), done.stderr.strip()


class LearnMovable(unittest.TestCase):
    def test_runs_are_summed(self):
        first = HEADER + "background,90000,100,0\nperson,1000,900,0.9\nchair,3000,0,0\ndesk lamp,2000,100,0.05\n"
        second = HEADER + "person,1000,500,0.5\nchair,1000,120,0.12\ncat,999,999,1\n"
        self.assertEqual(learn([first, second]), (0, 'movable: { chair: 0.03, "desk lamp": 0.05 }', ""))
        self.assertEqual(learn([second], "--least", "500")[1], "movable: { chair: 0.12 }")
        self.assertEqual(learn([HEADER])[1], "movable: {}")

    def test_other_files_are_refused_with_their_place(self):
        for text, message in ((None, "not found"), ("a,b\n", "csv:1: expected the columns"),
                              (HEADER + "person,5,7,1\n", "csv:2: found 7 moving of 5"),
                              (HEADER + "person,x,7,1\n", "csv:2: found 'person,x,7,1'")):
            status, output, error = learn([text])
            self.assertEqual((status, output), (1, ""))
            self.assertIn(message, error)


if __name__ == "__main__":
    unittest.main()
