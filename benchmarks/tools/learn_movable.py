#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Learns the parameter `movable` of the filter semantic_mask from runs with the observer class_motion.

    learn_movable.py RUN [RUN ...]      folders of results; sums their class_motion.csv and prints a line of YAML

The value of a class is the share of its measured features that were measured to move. A class with fewer than --least
measured features, or whose share rounds to 0, is left out: it counts as background.
"""
import argparse
import csv
import pathlib
import sys


def read_counts(file, counts):
    """Adds the counts of a file to {class: [measured, moving]}."""
    with open(file, newline="", encoding="utf-8") as stream:
        rows = csv.reader(stream)
        if next(rows, None) != ["class", "measured", "moving", "share"]:
            sys.exit(f"{file}:1: expected the columns class,measured,moving,share, as class_motion writes them")
        for line, row in enumerate(rows, start=2):
            # A name may contain commas; the last three columns do not.
            try:
                name, measured, moving = ",".join(row[:-3]), int(row[-3]), int(row[-2])
            except (IndexError, ValueError):
                sys.exit(f"{file}:{line}: found '{','.join(row)}'; expected a class and three numbers")
            if not 0 <= moving <= measured:
                sys.exit(f"{file}:{line}: found {moving} moving of {measured} features; expected at most all")
            count = counts.setdefault(name, [0, 0])
            count[0] += measured
            count[1] += moving


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", type=pathlib.Path, help="folders of results, or files class_motion.csv")
    parser.add_argument("--least", type=int, default=1000, help="measured features that a class needs (1000)")
    arguments = parser.parse_args()
    counts = {}
    for run in arguments.runs:
        file = run / "class_motion.csv" if run.is_dir() else run
        if not file.is_file():
            sys.exit(f"{file}: not found; expected the results of a run with `observers: [class_motion]`")
        read_counts(file, counts)
    shares = {name: round(moving / measured, 2) for name, (measured, moving) in counts.items()
              if name != "background" and measured >= max(1, arguments.least)}
    named = ", ".join(f"{name if name.isidentifier() else chr(34) + name + chr(34)}: {share:g}"
                      for name, share in sorted(shares.items()) if 0 < share < 0.5)
    print(f"movable: {{ {named} }}" if named else "movable: {}")


if __name__ == "__main__":
    main()
