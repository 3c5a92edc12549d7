#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The table and the picture of segmenters.py, of a bench that was made up."""
import csv
import json
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

TOOL = pathlib.Path(sys.argv.pop(1)) / "segmenters.py"
QUALITY = {"classes": [{"name": "background", "iou": 0.9}, {"name": "person", "iou": 0.75}]}


def make_bench(folder, program):
    runs = []
    for variant, sequence, ate, segmented in ((0, 0, 0.1, 0), (1, 0, 0.01, 40), (1, 1, 0.03, 40), (1, 1, 9.0, 40)):
        run_id = f"run{len(runs)}"
        (folder / "runs" / run_id).mkdir(parents=True)
        masks = {"segmented": segmented, **({"median_age_s": 0.2} if segmented else {})}
        (folder / "runs" / run_id / "run.json").write_text(json.dumps(
            {"masks": masks, "stages": [{"stage": "segmentation", "median_s": 0.03}] if segmented else []}))
        runs.append({"id": run_id, "variant": variant, "sequence": sequence, "folder": "runs/" + run_id, "counts": ate < 1,
                     "configuration": "config.yaml", "outcome": "crashed",
                     "result": {"errors": {"ate_m": {"rmse": ate}}, "coverage": 0.5 if sequence else 1.0}})
    (folder / "results.json").write_text(json.dumps(
        {"variants": [{"name": "none+geometry"}, {"name": "net+both"}], "sequences": [{"name": "a"}, {"name": "b"}],
         "runs": runs}))
    program.write_text(f"#!/bin/sh\ncat <<'END'\n{json.dumps(QUALITY)}\nEND\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)


class Segmenters(unittest.TestCase):
    def test_table_and_picture_hold_the_figures_of_the_runs_that_count(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            make_bench(folder, folder / "holdfast")
            done = subprocess.run([sys.executable, str(TOOL), name, "--program", str(folder / "holdfast")], check=True,
                                  capture_output=True, text=True)
            self.assertIn("left out: run3, crashed", done.stderr)
            self.assertIn("| net | both | 0.02 | 75.0 % | 0.750 | 30.0 | 0.2 | 2 |", done.stdout)
            self.assertIn("| none | geometry | 0.1 | 100.0 % | - | - | - | 1 |", done.stdout)
            self.assertIn("| net | both |", (folder / "segmenters.md").read_text())
            with open(folder / "segmenters.csv", encoding="utf-8") as file:
                self.assertEqual(len(list(csv.DictReader(file))), 2)
            picture = xml.etree.ElementTree.parse(folder / "segmenters.svg").getroot()
            circles = [part for part in picture.iter() if part.tag.endswith("circle")]
            self.assertEqual([circle.get("cx") for circle in circles][0], "80.0", "without masks: 0 ms")
            self.assertGreater(float(circles[1].get("cy")), float(circles[0].get("cy")), "a smaller error is lower")

    def test_a_folder_without_a_bench_is_refused(self):
        with tempfile.TemporaryDirectory() as name:
            done = subprocess.run([sys.executable, str(TOOL), name], check=False, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("results.json is missing", done.stderr)


if __name__ == "__main__":
    unittest.main()
