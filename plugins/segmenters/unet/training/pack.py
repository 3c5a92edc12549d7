# SPDX-License-Identifier: BSD-3-Clause
"""A pack: all pictures and labels of a training in one small .npz (JPEG and PNG bytes inside).

Every entry has a name such as `voc_person/000129`, a picture and labels (indices into classes.CLASSES, behind
them those of OTHER_THINGS, 254 = not a person, 255 = ignored).
"""
import zipfile

import cv2
import numpy as np


class PackError(Exception):
    """What is wrong with a pack or with the data for it, for the person who gave it."""


class PackWriter:
    def __init__(self, long_side):
        self.long_side = long_side
        self.names, self.pictures, self.labels, self.validation = [], [], [], []

    def add(self, name, picture, labels, validation=False):
        """Takes a picture (8 bit, blue green red) and its labels, shrunk to the pack's size."""
        if picture.shape[:2] != labels.shape:
            raise PackError(f"{name}: the picture has {picture.shape[1]}x{picture.shape[0]} pixels, its labels "
                            f"{labels.shape[1]}x{labels.shape[0]}; expected the same size")
        scale = self.long_side / max(labels.shape)
        if scale < 1:
            size = (round(labels.shape[1] * scale), round(labels.shape[0] * scale))
            picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
            labels = cv2.resize(labels, size, interpolation=cv2.INTER_NEAREST_EXACT)
        self.names.append(name)
        self.validation.append(validation)
        self.pictures.append(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 90])[1].reshape(-1))
        self.labels.append(cv2.imencode(".png", labels, [cv2.IMWRITE_PNG_COMPRESSION, 9])[1].reshape(-1))

    def write(self, path):
        def joined(parts):
            return np.concatenate(parts), np.cumsum([0] + [len(part) for part in parts])
        pictures, picture_ends = joined(self.pictures)
        labels, label_ends = joined(self.labels)
        np.savez(path, names=np.array(self.names), validation=np.array(self.validation), pictures=pictures,
                 picture_ends=picture_ends, labels=labels, label_ends=label_ends)


class Entry:
    """One picture (8 bit, blue green red) with its labels."""

    def __init__(self, name, picture, labels):
        self.name, self.picture, self.labels = name, picture, labels
        self.source = name.split("/")[0]


def read_pack(path):
    """(entries to train on, entries to validate on)"""
    try:
        data = dict(np.load(path))
        columns = [data[key] for key in ("names", "validation", "pictures", "picture_ends", "labels", "label_ends")]
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise PackError(f"{path}: cannot be read ({error}); expected a pack that prepare.py wrote") from error
    names, validation, pictures, picture_ends, labels, label_ends = columns
    training, held_out = [], []
    for i, name in enumerate(names):
        picture = cv2.imdecode(pictures[picture_ends[i]:picture_ends[i + 1]], cv2.IMREAD_COLOR)
        label = cv2.imdecode(labels[label_ends[i]:label_ends[i + 1]], cv2.IMREAD_GRAYSCALE)
        (held_out if validation[i] else training).append(Entry(str(name), picture, label))
    return training, held_out


def not_measured(held_out):
    """Held-out entries by which something may be chosen: all but the photographs that accuracy is measured on."""
    return [entry for entry in held_out if entry.source != "voc_person"]
