#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""moving_world_table.py OUTPUT_FOLDER CONFIGURATION...: the runs below a folder as a Markdown table."""
import json
import pathlib
import statistics
import sys


def main():
    folder = pathlib.Path(sys.argv[1])
    print("| configuration | runs | ATE RMSE, median [m] | least | most | coverage, least | tracking, median [ms] |")
    print("|---|---|---|---|---|---|---|")
    for configuration in sys.argv[2:]:
        errors, coverages, times, failed = [], [], [], 0
        for run in sorted((folder / configuration).glob("*.log")):
            try:
                evaluation = json.loads((run.with_suffix("") / "evaluation.json").read_text())
                summary = json.loads((run.with_suffix("") / "run.json").read_text())
            except FileNotFoundError:
                failed += 1
                continue
            errors.append(evaluation["ate_m"]["rmse"])
            coverages.append(evaluation["coverage"]["ratio"])
            times.append(summary["tracking"]["median_s"])
        if errors:
            print(f"| {configuration} | {len(errors)}{f', {failed} failed' if failed else ''} "
                  f"| {statistics.median(errors):.4f} | {min(errors):.4f} | {max(errors):.4f} "
                  f"| {100 * min(coverages):.2f} % | {1e3 * statistics.median(times):.1f} |")


main()
