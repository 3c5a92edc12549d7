#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pack pictures of people and of rooms for training.

Reads, as far as they are named:
  --people DIR      with voc_person/, penn_fudan/, human_290/ and, if there is one, more/ (their layout: README.md)
  --room DIR        a sequence in TUM layout with labels_pseudo/: 0 nobody, 15 person, 255 unsure
  --simulated DIR   sequences that `holdfast simulate` wrote; DIR itself, or folders in it
  --composed DIR    folders of sequences that benchmarks/tools/compose_people.py wrote from frames of --room
  --further DIR     with images/SOURCE_*.jpg, classes/SOURCE_*.png (pictures without it are for the teacher of
                    train_gpu.py, to whom boxes/SOURCE_*.txt may say where people are: lines of x, y of the middle,
                    width, height, as shares of the picture) and depth/SOURCE_*.png (8 bits for 10 m); its sources
                    replace those of more/
and writes one .npz, or several parts of it.  Entries that --validation lists (or that its rule chooses, see validation.txt) are marked: they are
never trained on.
"""
import argparse
import functools
import json
import pathlib
import sys

import cv2
import numpy as np

from classes import IGNORED, IN_BOX, IN_NO_BOX, NOT_PERSON, PERSON, SIMULATED, UNLABELLED, VOC, relabelled
from pack import PackError, PackWriter

HERE = pathlib.Path(__file__).parent


def read(path, flags):
    image = cv2.imread(str(path), flags)
    if image is None:
        raise PackError(f"{path}: cannot be read; expected an image")
    return image


def colour(path):
    return read(path, cv2.IMREAD_COLOR)


def grey(path):
    return read(path, cv2.IMREAD_GRAYSCALE)


def with_ignored(labels, ignored_path):
    """Bystanders whom the masks leave out teach nothing."""
    if ignored_path.exists():
        labels = np.where((grey(ignored_path) > 0) & (labels == 0), IGNORED, labels).astype(np.uint8)
    return labels


def voc_person(folder):
    for path in sorted((folder / "labels").glob("*.png")):
        yield path.stem, colour(folder / "images" / f"{path.stem}.jpg"), relabelled(grey(path), VOC)


def penn_fudan(folder):
    for path in sorted((folder / "PedMasks").glob("*_mask.png")):
        name = path.stem[:-len("_mask")]
        people = np.where(grey(path) > 0, PERSON, 0).astype(np.uint8)
        picture = next((folder / "PNGImages").glob(name + ".*"))
        yield name, colour(picture), with_ignored(people, folder / "unlabelled_people" / f"{name}.png")


def human_290(folder):
    for path in sorted((folder / "masks").glob("*.png")):
        people = np.where(grey(path) > 0, PERSON, 0).astype(np.uint8)
        picture = folder / "images" / f"{path.stem}.jpg"
        yield path.stem, colour(picture), with_ignored(people, folder / "unlabelled_people" / path.name)


def more_people(folder, source):
    """Pictures of several collections in one folder: labels 0 other, 1 person, 255 void; of some, also VOC's numbers."""
    for path in sorted((folder / "labels").glob(f"{source}_*.png")):
        classes = folder / "labels_voc" / path.name
        labels = relabelled(grey(classes), VOC) if classes.exists() else relabelled(grey(path), {1: PERSON, 255: IGNORED})
        yield path.stem, colour(folder / "images" / f"{path.stem}.jpg"), labels


def boxes_in(path, shape):
    """Boxes of a file (lines of the middle, width and height, as shares of the picture): left, top, right, bottom [px]."""
    for x, y, width, height in np.loadtxt(path, ndmin=2).reshape(-1, 4) if path.stat().st_size else ():
        corners = np.array([[x - width / 2, y - height / 2], [x + width / 2, y + height / 2]]) * shape[::-1]
        yield corners.round().astype(int).clip(0).reshape(-1)


def in_boxes(path, shape):
    """What a label image says when only boxes of people are known."""
    labels = np.full(shape, IN_NO_BOX, np.uint8)
    for left, top, right, bottom in boxes_in(path, shape):
        labels[top:bottom, left:right] = IN_BOX
    return labels


def further(folder, source):
    """Labels as in classes.py, or boxes, or none, and depth, if there is any: (name, picture, labels, depth or None)."""
    for path in sorted((folder / "images").glob(f"{source}_*.jpg")):
        picture = colour(path)
        classes, boxes, depth = (folder / kind / f"{path.stem}.{end}"
                                 for kind, end in (("classes", "png"), ("boxes", "txt"), ("depth", "png")))
        if classes.exists():
            labels = grey(classes)
        elif boxes.exists():
            labels = in_boxes(boxes, picture.shape[:2])
        else:
            labels = np.full(picture.shape[:2], UNLABELLED, np.uint8)
        yield path.stem, picture, labels, grey(depth) if depth.exists() else None


def furniture(labels):
    """Where large things stand that are no part of a person, among the pixels that are unsure."""
    unsure = cv2.erode((labels == IGNORED).astype(np.uint8), np.ones((7, 7), np.uint8))
    count, components, stats, _ = cv2.connectedComponentsWithStats(unsure)
    large = [k for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] > 0.025 * labels.size]
    near_person = cv2.dilate((labels == PERSON).astype(np.uint8), np.ones((25, 25), np.uint8)) > 0
    return np.isin(components, large) & ~near_person


def room_labels(path):
    labels = relabelled(grey(path), {15: PERSON, 255: IGNORED})
    labels[furniture(labels)] = NOT_PERSON
    return labels


def room(folder):
    for path in sorted((folder / "labels_pseudo").glob("*.png")):
        yield path.stem, colour(next((folder / "rgb").glob(path.stem + ".*"))), room_labels(path)


def simulated(folder):
    scenes = [folder] if (folder / "scene.json").exists() else sorted(p.parent for p in folder.glob("*/scene.json"))
    if not scenes:
        raise PackError(f"{folder}: holds no scene.json; expected a sequence that `holdfast simulate` wrote")
    for scene in scenes:
        names = json.loads((scene / "scene.json").read_text())["classes"]
        mapping = {i: SIMULATED[name] for i, name in enumerate(names) if name in SIMULATED}
        for path in sorted((scene / "labels").glob("*.png")):
            picture = next((scene / "rgb").glob(path.stem + ".*"))
            yield f"{scene.name}/{path.stem}", colour(picture), relabelled(grey(path), mapping)


def walking(folder, room_folder):
    """People composed into frames of the room by its depth; the room's own labels where nobody was put."""
    for path in sorted(folder.glob("*/mask/*.png")):
        below = room_folder / "labels_pseudo" / path.name
        if not below.exists():
            continue
        labels = room_labels(below)
        labels[grey(path) > 0] = PERSON
        picture = next((path.parent.parent / "rgb").glob(path.stem + ".*"))
        yield f"{path.parent.parent.name}/{path.stem}", colour(picture), labels


def sources_in(folder):
    return sorted({path.name.split("_")[0] for path in folder.glob("*.*")})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=pathlib.Path)
    parser.add_argument("--room", type=pathlib.Path)
    parser.add_argument("--simulated", type=pathlib.Path)
    parser.add_argument("--composed", type=pathlib.Path)
    parser.add_argument("--further", type=pathlib.Path)
    parser.add_argument("--validation", type=pathlib.Path, default=HERE / "validation.txt",
                        help="names of entries to hold out, one a line (default: validation.txt beside this program)")
    parser.add_argument("--long-side", type=int, default=384, help="pictures are shrunk to it [px] (default: 384)")
    parser.add_argument("--quality", type=int, default=90, help="of the pictures in the pack (default: 90)")
    parser.add_argument("--webp", action="store_true", help="pictures as WebP, half as large as JPEG of the same quality")
    parser.add_argument("--parts", type=int, default=1,
                        help="splits the pack into as many files, OUTPUT.0.npz and so on (default: 1, OUTPUT itself)")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="the pack, .npz")
    arguments = parser.parse_args()

    held_out = {line for line in arguments.validation.read_text().split("\n") if line and not line.startswith("#")}
    readers = []
    further_sources = sources_in(arguments.further / "images") if arguments.further else []
    if arguments.people:
        for reader in (voc_person, penn_fudan, human_290):
            readers.append((reader.__name__, reader, arguments.people / reader.__name__))
        more = arguments.people / "more"
        for source in sources_in(more / "labels"):
            if source not in further_sources:
                readers.append((source, functools.partial(more_people, source=source), more))
    for source in further_sources:
        readers.append((source, functools.partial(further, source=source), arguments.further))
    if arguments.room:
        readers.append(("room", room, arguments.room))
    if arguments.simulated:
        readers.append(("simulated", simulated, arguments.simulated))
    if arguments.composed:
        if not arguments.room:
            parser.error("--composed needs --room, the recording that people were composed into")
        readers.append(("walking", lambda folder: walking(folder, arguments.room), arguments.composed))
    if not readers:
        parser.error("nothing to pack; name --people, --room, --simulated or --further")

    writer = PackWriter(arguments.long_side, arguments.quality, arguments.webp)
    for source, reader, folder in readers:
        if not folder.is_dir():
            raise PackError(f"{folder}: is no folder; expected the data of '{source}'")
        before = len(writer.names)
        for name, picture, labels, *depth in reader(folder):
            full_name = f"{source}/{name}"
            writer.add(full_name, picture, labels, full_name in held_out, *depth)
        print(f"{source}: {len(writer.names) - before} pictures, "
              f"{sum(writer.validation[before:])} of them held out")
    if not writer.names:
        raise PackError("no pictures found; expected the layouts that --help names")
    for part in range(arguments.parts):
        path = arguments.output.with_suffix(f".{part}.npz") if arguments.parts > 1 else arguments.output
        writer.write(path, part, arguments.parts)
        print(f"{path}: {path.stat().st_size / 2**20:.1f} MiB")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError, StopIteration) as error:
        sys.exit(f"prepare.py: {error}")
