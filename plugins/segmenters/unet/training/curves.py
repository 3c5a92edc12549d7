# SPDX-License-Identifier: BSD-3-Clause
"""Loss and IoU over a training, as a picture: from log.csv, without a plotting library."""
import csv
import pathlib

import cv2
import numpy as np

COLOURS = {"loss": (90, 90, 90), "iou_person": (40, 40, 210), "iou_person_composed": (200, 120, 20)}
WIDTH, HEIGHT, MARGIN = 900, 420, 50


def read_log(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def draw_curves(logs, picture):
    """Logs of stages that followed each other, one behind the other."""
    rows, offset, borders = [], 0, []
    for log in logs:
        stage = read_log(log)
        rows += [(offset + int(row["step"]), row) for row in stage]
        offset = rows[-1][0] if rows else 0
        borders.append(offset)
    canvas = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    inner_width, inner_height = WIDTH - 2 * MARGIN, HEIGHT - 2 * MARGIN

    def at(step, value):
        return (int(MARGIN + inner_width * step / max(offset, 1)), int(HEIGHT - MARGIN - inner_height * min(value, 1.0)))

    for tenth in range(0, 11, 2):
        cv2.line(canvas, at(0, tenth / 10), at(offset, tenth / 10), (225, 225, 225), 1)
        cv2.putText(canvas, f"{tenth / 10:.1f}", (12, at(0, tenth / 10)[1] + 4), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (0, 0, 0), 1,
                    cv2.LINE_AA)
    for border in borders:
        cv2.line(canvas, at(border, 0), at(border, 1), (225, 225, 225), 1)
    for i, (name, colour) in enumerate(COLOURS.items()):
        scale = 0.5 if name == "loss" else 1.0
        points = [at(step, scale * float(row[name])) for step, row in rows if row.get(name)]
        if len(points) > 1:
            cv2.polylines(canvas, [np.array(points, np.int32)], False, colour, 2, cv2.LINE_AA)
        cv2.putText(canvas, "loss / 2" if name == "loss" else name, (MARGIN + 180 * i, 25), cv2.FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv2.LINE_AA)
    cv2.putText(canvas, f"{offset} steps", (WIDTH - MARGIN - 100, HEIGHT - 15), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1,
                cv2.LINE_AA)
    cv2.imwrite(str(pathlib.Path(picture)), canvas)
