# SPDX-License-Identifier: BSD-3-Clause
"""What the network is shown: an endless, numbered series of augmented pictures with labels."""
import cv2
import numpy as np
import torch

from composition import composed, cutouts
from pack import PackError
from photographs import random_camera, random_view, turned

MEAN, DEVIATION = 0.5, 0.25  # of a pixel divided by 255, every channel

#: How often a sample is a plain view of a picture of this source.
PLAIN = {"voc_person": 0.21, "sbd": 0.20, "coco": 0.07, "human_290": 0.05, "penn_fudan": 0.03, "ccp": 0.05, "nyu": 0.08,
         "camvid": 0.02, "davis": 0.005, "room": 0.03, "simulated": 0.06, "walking": 0.05}
COMPOSED = 0.22
#: How often a picture of this source is the background of a composed sample, and how often its people are in it.
BACKGROUNDS = {"room": 0.15, "simulated": 0.2, "voc_person": 0.15, "sbd": 0.15, "nyu": 0.35}
#: Pictures as a moving robot sees rooms: they are rolled and blurred more with `room_roll`.
ROOMS = ("room", "walking", "nyu", "simulated")
PEOPLE = {"voc_person": 0.2, "human_290": 0.25, "penn_fudan": 0.25, "ccp": 0.15, "sbd": 0.1, "simulated": 0.05}


def to_tensor(picture):
    """A picture (8 bit, blue green red) as the network wants it: 3 x height x width, red green blue."""
    planes = np.ascontiguousarray(picture[:, :, ::-1].transpose(2, 0, 1)).astype(np.float32)
    return torch.from_numpy((planes / 255.0 - MEAN) / DEVIATION)


class Choice:
    """Draws from several lists, each with its own weight; lists that are empty are left out."""

    def __init__(self, lists, weights):
        self.lists = [lists[source] for source in weights if lists.get(source)]
        self.total = sum(weights[source] for source in weights if lists.get(source))
        if self.lists:
            self.shares = np.array([weights[source] for source in weights if lists.get(source)]) / self.total

    def draw(self, random):
        chosen = self.lists[int(random.choice(len(self.lists), p=self.shares))]
        return chosen[int(random.integers(len(chosen)))]


def by_source(items):
    lists = {}
    for source, item in items:
        lists.setdefault(source, []).append(item)
    return lists


class Samples(torch.utils.data.IterableDataset):
    """Sample i depends on seed and i alone, so that a training goes on after an interruption as if there was none.

    `sizes`: width x height of the samples, batch by batch in turn.  `whole`: how often a picture is shown whole.
    `shares`: replaces entries of PLAIN and, as `composed`, COMPOSED.  `room_roll`: standard deviation of the camera's roll
    in half of the pictures of ROOMS [deg]; 0 = as in all other pictures.
    """

    def __init__(self, entries, sizes, batch=1, seed=1, start=0, whole=0.25, shares=None, room_roll=0.0):
        super().__init__()
        self.sizes, self.batch, self.seed, self.start, self.whole = sizes, batch, seed, start, whole
        self.room_roll = room_roll
        plain = {**PLAIN, **(shares or {})}
        composed_share = plain.pop("composed", COMPOSED)
        if unknown := set(plain) - set(PLAIN):
            raise PackError(f"unknown source '{sorted(unknown)[0]}' of samples; expected composed, {', '.join(PLAIN)}")
        entries_by_source = by_source((entry.source, entry) for entry in entries)
        self.plain = Choice(entries_by_source, plain)
        self.backgrounds = Choice(entries_by_source, BACKGROUNDS)
        self.textures = [entry for entry in entries if entry.source in BACKGROUNDS]
        self.people = Choice(by_source((entry.source, cutout) for entry in entries for cutout in cutouts(entry)), PEOPLE)
        if not self.plain.lists:
            raise PackError("the pack holds no pictures to train on; pack some with prepare.py")
        composes = self.backgrounds.lists and self.people.lists
        self.composed_share = composed_share / (composed_share + self.plain.total) if composes else 0.0

    def sample(self, i):
        random = np.random.default_rng((self.seed, i))
        size = self.sizes[i // self.batch % len(self.sizes)]
        if random.random() < self.composed_share:
            people = [self.people.draw(random) for _ in range(4)]
            picture, labels = composed(random, self.backgrounds.draw(random), people, self.textures, size)
            is_room = True
        else:
            entry = self.plain.draw(random)
            picture, labels = random_view(random, entry.picture, entry.labels, size, whole=self.whole)
            is_room = entry.source in ROOMS
        rolls = is_room and self.room_roll > 0.0
        if rolls and random.random() < 0.5:
            picture, labels = turned(random, picture, labels, self.room_roll)
        return random_camera(random, picture, blur=0.4 if rolls else 0.2), labels

    def __iter__(self):
        cv2.setNumThreads(1)
        i = self.start
        while True:
            picture, labels = self.sample(i)
            yield to_tensor(picture), torch.from_numpy(labels.astype(np.int64))
            i += 1
