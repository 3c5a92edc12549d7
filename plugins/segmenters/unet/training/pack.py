# SPDX-License-Identifier: BSD-3-Clause
"""A pack: all pictures and labels of a training in one small .npz (JPEG and PNG bytes inside, or WebP for both).

Every entry has a name such as `voc_person/000129`, a picture and labels (indices into classes.CLASSES, behind
them those of OTHER_THINGS, 251 to 253 = unlabelled, 254 = not a person, 255 = ignored), and of some rooms the depth, 8 bits for 10 m.
"""
import concurrent.futures
import zipfile

import cv2
import numpy as np

from classes import IN_BOX, IN_NO_BOX, UNLABELLED


class PackError(Exception):
    """What is wrong with a pack or with the data for it, for the person who gave it."""


def encoded(image, image_format):
    return cv2.imencode(image_format[0], image, image_format[1])[1].reshape(-1)


class PackWriter:
    def __init__(self, long_side, quality=90, webp=False):
        self.long_side = long_side
        if webp:
            self.picture_format = ".webp", [cv2.IMWRITE_WEBP_QUALITY, quality]
            self.label_format = ".webp", [cv2.IMWRITE_WEBP_QUALITY, 101]  # lossless
        else:
            self.picture_format = ".jpg", [cv2.IMWRITE_JPEG_QUALITY, quality]
            self.label_format = ".png", [cv2.IMWRITE_PNG_COMPRESSION, 9]
        self.names, self.pictures, self.labels, self.depths, self.validation = [], [], [], [], []

    def add(self, name, picture, labels, validation=False, depth=None):
        """Takes a picture (8 bit, blue green red) and its labels, shrunk to the pack's size; the depth of any size."""
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
        self.pictures.append(encoded(picture, self.picture_format))
        self.labels.append(encoded(labels, self.label_format))
        self.depths.append(np.zeros(0, np.uint8) if depth is None else encoded(depth, self.label_format))

    def write(self, path, part=0, parts=1):
        """All entries, or every `parts`-th of them from number `part` on."""
        def joined(items):
            return np.concatenate(items[part::parts]), np.cumsum([0] + [len(item) for item in items[part::parts]])
        pictures, picture_ends = joined(self.pictures)
        labels, label_ends = joined(self.labels)
        depths, depth_ends = joined(self.depths)
        np.savez(path, names=np.array(self.names[part::parts]), validation=np.array(self.validation[part::parts]),
                 pictures=pictures, picture_ends=picture_ends, labels=labels, label_ends=label_ends, depths=depths,
                 depth_ends=depth_ends)


class Entry:
    """One picture (8 bit, blue green red) with its labels and its depth (8 bits for 10 m, 0 = unknown) or None."""

    def __init__(self, name, picture, labels, depth=None):
        self.name, self.picture, self.labels, self.depth = name, picture, labels, depth
        self.source = name.split("/")[0]

    def is_labelled(self):
        return self.labels[0, 0] not in (UNLABELLED, IN_BOX, IN_NO_BOX)


def read_pack(path, unlabelled=False):
    """(entries to train on, entries to validate on); those without labels only if wanted."""
    try:
        data = dict(np.load(path))
        columns = [data[key] for key in ("names", "validation", "pictures", "picture_ends", "labels", "label_ends")]
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise PackError(f"{path}: cannot be read ({error}); expected a pack that prepare.py wrote") from error
    names, validation, pictures, picture_ends, labels, label_ends = columns
    depth_ends = data.get("depth_ends", np.zeros(len(names) + 1, np.int64))

    def decoded(i):
        picture = cv2.imdecode(pictures[picture_ends[i]:picture_ends[i + 1]], cv2.IMREAD_COLOR)
        label = cv2.imdecode(labels[label_ends[i]:label_ends[i + 1]], cv2.IMREAD_GRAYSCALE)
        depth = None
        if depth_ends[i + 1] > depth_ends[i]:
            depth = cv2.imdecode(data["depths"][depth_ends[i]:depth_ends[i + 1]], cv2.IMREAD_GRAYSCALE)
        return Entry(str(names[i]), picture, label, depth)

    with concurrent.futures.ThreadPoolExecutor() as threads:
        entries = list(threads.map(decoded, range(len(names))))
    wanted = [i for i, entry in enumerate(entries) if unlabelled or entry.is_labelled()]
    return [entries[i] for i in wanted if not validation[i]], [entries[i] for i in wanted if validation[i]]


def not_measured(held_out):
    """Held-out entries by which something may be chosen: all but the photographs that accuracy is measured on."""
    return [entry for entry in held_out if entry.source != "voc_person"]
