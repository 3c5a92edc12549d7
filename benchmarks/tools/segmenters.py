#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the accuracy and the cost of a bench over the axis `segmenter` in one table and one picture.

    holdfast bench benchmarks/segmenters.yaml --output out/segmenters
    python3 benchmarks/tools/segmenters.py out/segmenters

Writes segmenters.md, segmenters.csv and segmenters.svg (ATE over the time of a mask) into the folder of the bench. The
masks are compared with the truth by `holdfast evaluate-segmentation`: that of the source, or, for recordings, that of
--truth SEQUENCE=FOLDER with `rgb` and `mask` (values 1 to 254: person).
"""
import argparse
import collections
import csv
import html
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys

COLUMNS = ("segmenter", "others", "ate_rmse_m", "coverage", "iou_person", "mask_ms", "mask_age_s", "runs")
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7", "#56b4e9")


def read_json(file):
    return json.loads(file.read_text(encoding="utf-8"))


def median(values):
    known = [value for value in values if value is not None and math.isfinite(value)]
    return statistics.median(known) if known else None


def mask_quality(program, configuration, truth, every):
    """Mean IoU of `person` over the frames; None where nobody knows the truth."""
    command = [program, "evaluate-segmentation", str(configuration), "--every", str(every), "--quiet", "--json", "-"]
    if truth:
        command += ["--images", truth + "/rgb", "--labels", truth + "/mask", "--label-map", "{1-254: person}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        print(f"no IoU for {configuration}: {done.stderr.strip()[:200]}", file=sys.stderr)
        return None
    for entry in json.loads(done.stdout)["classes"]:
        if entry["name"] == "person":
            return entry["iou"]
    return None


def rows_of(folder, program, truths, every):
    results = read_json(folder / "results.json")
    groups = collections.defaultdict(list)
    qualities = {}
    for run in results["runs"]:
        name = run["variant"] if isinstance(run["variant"], str) else results["variants"][run["variant"]]["name"]
        segmenter, _, others = name.partition("+")
        sequence = run["sequence"] if isinstance(run["sequence"], str) else results["sequences"][run["sequence"]]["name"]
        own = folder / run["folder"]
        if not run["counts"]:
            print(f"left out: {run['id']}, {run['outcome']}", file=sys.stderr)
            continue
        record = read_json(own / "run.json")
        is_segmented = record["masks"].get("segmented", 0) > 0
        if is_segmented and (segmenter, sequence) not in qualities:
            qualities[segmenter, sequence] = mask_quality(program, own / run["configuration"], truths.get(sequence), every)
        stage = next((row for row in record["stages"] if row["stage"] == "segmentation"), None)
        groups[segmenter, others].append({
            "ate": run["result"]["errors"]["ate_m"]["rmse"],
            "coverage": run["result"]["coverage"],
            "iou": qualities.get((segmenter, sequence)),
            "ms": 1e3 * stage["median_s"] if stage and is_segmented else None,
            "age": record["masks"].get("median_age_s") if is_segmented else None,
        })
    for (segmenter, others), runs in groups.items():
        yield dict(zip(COLUMNS, (
            segmenter, others, median([run["ate"] for run in runs]), statistics.mean(run["coverage"] for run in runs),
            median([run["iou"] for run in runs]), median([run["ms"] for run in runs]),
            median([run["age"] for run in runs]), len(runs))))


def text_of(column, value):
    if value is None:
        return "-"
    if isinstance(value, (str, int)):
        return str(value)
    if column == "coverage":
        return f"{100 * value:.1f} %"
    return f"{value:.1f}" if column == "mask_ms" else f"{value:.3f}" if column == "iou_person" else f"{value:.4g}"


def table_of(rows):
    header = ("segmenter", "others", "ATE RMSE [m]", "coverage", "IoU person", "time of a mask [ms]", "age of masks [s]", "runs")
    lines = ["| " + " | ".join(header) + " |", "|---|---|" + "---:|" * 6]
    lines += ["| " + " | ".join(text_of(column, row[column]) for column in COLUMNS) + " |" for row in rows]
    return ("Medians over sequences, the coverage their mean. The time is that of the segmenter for a frame; the age that of\n"
            "the newest mask when a frame is tracked.\n\n" + "\n".join(lines) + "\n")


def picture_of(rows):
    """ATE (logarithmic) over the time of a mask, as SVG; a segmenter without masks stands at 0 ms."""
    width, height, left, right, top, bottom = 760, 460, 80, 30, 30, 60
    rows = [row for row in rows if row["ate_rmse_m"]]
    times = [row["mask_ms"] or 0.0 for row in rows]
    low = math.floor(math.log10(min(row["ate_rmse_m"] for row in rows)) * 2) / 2
    high = math.ceil(math.log10(max(row["ate_rmse_m"] for row in rows)) * 2) / 2
    most = max(times + [1.0]) * 1.15
    across = lambda value: left + (width - left - right) * value / most
    up = lambda value: top + (height - top - bottom) * (high - math.log10(value)) / max(high - low, 0.5)
    step = 10 ** math.floor(math.log10(most / 3))
    step *= 5 if most / step > 10 else 2 if most / step > 5 else 1
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for i in range(int(most / step) + 1):
        x = across(i * step)
        parts.append(f'<path d="M{x:.1f} {top}V{height - bottom}" stroke="#ddd"/>'
                     f'<text x="{x:.1f}" y="{height - bottom + 18}" text-anchor="middle">{i * step:g}</text>')
    for i in range(int(round((high - low) * 2)) + 1):
        value = 10 ** (low + i / 2)
        parts.append(f'<path d="M{left} {up(value):.1f}H{width - right}" stroke="#ddd"/>'
                     f'<text x="{left - 8}" y="{up(value) + 4:.1f}" text-anchor="end">{value:.2g}</text>')
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 15}" text-anchor="middle">time of a mask [ms]; in brackets: coverage</text>'
                 f'<text transform="translate(20 {(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">ATE RMSE [m]</text>')
    groups = list(dict.fromkeys(row["others"] for row in rows))
    places = []
    for row, time in zip(rows, times):
        colour = COLOURS[groups.index(row["others"]) % len(COLOURS)]
        x, y = across(time), up(row["ate_rmse_m"])
        label = y - 8
        while any(abs(label - other_y) < 14 and abs(x - other_x) < 120 for other_x, other_y in places):
            label += 14
        places.append((x, label))
        anchor = "end" if x > width - 160 else "start"
        name = html.escape(row["segmenter"] + (f" ({100 * row['coverage']:.0f} %)" if row["coverage"] < 0.995 else ""))
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{colour}"/><text x="{x + (8 if anchor == "start" else -8):.1f}" '
                     f'y="{label:.1f}" text-anchor="{anchor}" fill="{colour}">{name}</text>')
    for i, group in enumerate(groups):
        parts.append(f'<text x="{width - right}" y="{top + 16 + 18 * i}" text-anchor="end" fill="{COLOURS[i % len(COLOURS)]}">'
                     f'{html.escape(group) or "all"}</text>')
    return "\n".join(parts) + "\n</svg>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="output folder of the bench")
    parser.add_argument("--program", default=shutil.which("holdfast") or "build/bin/holdfast")
    parser.add_argument("--every", type=int, default=5, help="frames for the IoU: every N-th (default 5)")
    parser.add_argument("--truth", action="append", default=[], metavar="SEQUENCE=FOLDER")
    arguments = parser.parse_args()
    if not (arguments.folder / "results.json").is_file():
        sys.exit(f"{arguments.folder}/results.json is missing; expected the output folder of a finished `holdfast bench`")
    truths = dict(entry.split("=", 1) for entry in arguments.truth if "=" in entry)
    if len(truths) != len(arguments.truth):
        sys.exit("--truth: expected SEQUENCE=FOLDER, of each sequence once")
    rows = list(rows_of(arguments.folder, arguments.program, truths, arguments.every))
    if not rows:
        sys.exit(f"{arguments.folder}: no run has an error that counts")
    (arguments.folder / "segmenters.md").write_text(table_of(rows), encoding="utf-8")
    with open(arguments.folder / "segmenters.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    (arguments.folder / "segmenters.svg").write_text(picture_of(rows), encoding="utf-8")
    print(table_of(rows))


if __name__ == "__main__":
    main()
