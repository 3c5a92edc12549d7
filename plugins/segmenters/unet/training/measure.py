# SPDX-License-Identifier: BSD-3-Clause
"""How good the labels are: intersection over union, on held-out photographs and composed frames."""
import numpy as np
import torch
from torch.nn import functional

from classes import CLASSES, IGNORED, NOT_PERSON, PERSON, is_other_thing
from composition import composed, cutouts
from photographs import random_camera, resized
from samples import to_tensor


class Confusion:
    """Pixels by true and found class, over all pictures."""

    def __init__(self):
        self.pixels = np.zeros((len(CLASSES), len(CLASSES)), np.int64)

    def add(self, labels, found):
        known = labels != IGNORED
        labels = np.where((labels == NOT_PERSON) | is_other_thing(labels), 0, labels)
        index = labels[known].astype(np.int64) * len(CLASSES) + found[known]
        self.pixels += np.bincount(index, minlength=self.pixels.size).reshape(self.pixels.shape)

    def iou(self, label):
        union = self.pixels[label].sum() + self.pixels[:, label].sum() - self.pixels[label, label]
        return self.pixels[label, label] / max(union, 1)

    def accuracy(self, label):
        return self.pixels[label, label] / max(self.pixels[label].sum(), 1)

    def share_found(self, label):
        return self.pixels[:, label].sum() / max(self.pixels.sum(), 1)


def found_labels(model, picture, input_size):
    """Labels at the picture's own size, the way the C++ segmenter makes them."""
    small, _ = resized(picture, np.zeros(picture.shape[:2], np.uint8), input_size)
    with torch.no_grad():
        scores = model(to_tensor(small)[None].contiguous(memory_format=torch.channels_last))
        scores = functional.interpolate(scores, size=picture.shape[:2], mode="bilinear", align_corners=False)
    return scores[0].argmax(0).numpy()


class Validation:
    """Held-out photographs; held-out people composed into rooms; rooms without anybody."""

    def __init__(self, training, held_out, composed_count=60, empty_count=40):
        self.photographs = [entry for entry in held_out if entry.source == "voc_person"]
        rooms = [entry for entry in training if entry.source in ("room", "simulated")]
        self.empty = [entry for entry in rooms if not np.any(np.isin(entry.labels, (PERSON, IGNORED)))]
        self.empty = self.empty[::max(1, len(self.empty) // empty_count)]
        people = [cutout for entry in held_out if entry.source == "penn_fudan" for cutout in cutouts(entry)]
        self.composed = []
        for i in range(composed_count if people and rooms else 0):
            random = np.random.default_rng((7, i))
            background = rooms[int(random.integers(len(rooms)))]
            picture, labels = composed(random, background, people, rooms, (320, 240))
            self.composed.append((random_camera(random, picture), labels))

    def __call__(self, model, input_size):
        """Figures by name; those without pictures are left out."""
        figures = {}
        if self.photographs:
            confusion = Confusion()
            for entry in self.photographs:
                confusion.add(entry.labels, found_labels(model, entry.picture, input_size))
            for label, name in enumerate(CLASSES):
                figures[f"iou_{name}"] = confusion.iou(label)
        if self.composed:
            confusion = Confusion()
            for picture, labels in self.composed:
                confusion.add(labels, found_labels(model, picture, input_size))
            figures["iou_person_composed"] = confusion.iou(PERSON)
        if self.empty:
            confusion = Confusion()
            for entry in self.empty:
                confusion.add(entry.labels, found_labels(model, entry.picture, input_size))
            figures["false_person"] = confusion.share_found(PERSON)
        return figures
