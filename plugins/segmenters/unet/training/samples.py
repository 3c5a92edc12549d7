# SPDX-License-Identifier: BSD-3-Clause
"""What the network is shown: an endless, numbered series of augmented pictures with labels."""
import cv2
import numpy as np
import torch

from classes import CHANCE, IGNORED, PERSON, is_chance
from composition import composed, cutouts, with_sheets
from pack import PackError
from photographs import random_camera, random_view, turned

MEAN, DEVIATION = 0.5, 0.25  # of a pixel divided by 255, every channel

#: How often a sample is a plain view of a picture of this source.
PLAIN = {"voc_person": 0.21, "sbd": 0.20, "coco": 0.07, "human_290": 0.05, "penn_fudan": 0.03, "ccp": 0.05, "nyu": 0.08,
         "camvid": 0.02, "davis": 0.005, "room": 0.03, "simulated": 0.06, "walking": 0.05, "instances": 0.08, "boxed": 0.2,
         "clothes": 0.02}
COMPOSED = 0.22
#: How often a picture of this source is the background of a composed sample, and how often its people are in it.
BACKGROUNDS = {"room": 0.15, "simulated": 0.2, "voc_person": 0.15, "sbd": 0.15, "nyu": 0.35}
#: Pictures as a moving robot sees rooms: they are rolled and blurred more with `room_roll`.
ROOMS = ("room", "walking", "nyu", "simulated")
#: How often a sample of nobody is a picture of this source; only pictures without people are taken.
NOBODY = {"nyu": 0.60, "instances": 0.10, "sbd": 0.08, "coco": 0.04, "simulated": 0.06, "room": 0.12}
PEOPLE = {"voc_person": 0.2, "human_290": 0.25, "penn_fudan": 0.25, "ccp": 0.15, "sbd": 0.1, "simulated": 0.05,
          "instances": 0.05, "cutout": 0.12}


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


def drawn(random, labels):
    """Labels without chances: people are where the chance is above a threshold, one for the whole picture, so that an
    outline is learned where it is likely and the doubt about it as well.  Thresholds near 0 and 1 would teach what is
    improbable."""
    people = np.where(labels > CHANCE + 100.0 * random.uniform(0.25, 0.75), PERSON, 0)
    return np.where(is_chance(labels), people, labels).astype(np.uint8)


def shows_nobody(entry):
    """Neither people nor chances of them, and nearly all of the picture is known."""
    possible = (entry.labels == PERSON) | is_chance(entry.labels)
    return not possible.any() and (entry.labels == IGNORED).mean() < 0.2


def by_source(items):
    lists = {}
    for source, item in items:
        lists.setdefault(source, []).append(item)
    return lists


class Samples(torch.utils.data.IterableDataset):
    """Sample i depends on seed and i alone, so that a training goes on after an interruption as if there was none.

    `sizes`: width x height of the samples, batch by batch in turn.  `whole`: how often a picture is shown whole.
    `shares`: replaces entries of PLAIN and, as `composed`, COMPOSED.  `room_roll`: standard deviation of the camera's roll
    in half of the pictures of ROOMS [deg]; 0 = as in all other pictures.  `nobody`: how often a sample is one of nobody: a
    near, tilted, dark or blurred view of a picture without people.
    """

    def __init__(self, entries, sizes, batch=1, seed=1, start=0, whole=0.25, shares=None, room_roll=0.0, nobody=0.0):
        super().__init__()
        self.sizes, self.batch, self.seed, self.start, self.whole = sizes, batch, seed, start, whole
        self.room_roll, self.nobody = room_roll, nobody
        plain = {**PLAIN, **(shares or {})}
        composed_share = plain.pop("composed", COMPOSED)
        if unknown := set(plain) - set(PLAIN):
            raise PackError(f"unknown source '{sorted(unknown)[0]}' of samples; expected composed, {', '.join(PLAIN)}")
        entries_by_source = by_source((entry.source, entry) for entry in entries)
        self.plain = Choice(entries_by_source, plain)
        self.backgrounds = Choice(entries_by_source, BACKGROUNDS)
        empty = [entry for entry in entries if nobody and entry.source in NOBODY and shows_nobody(entry)]
        self.empty = Choice(by_source((entry.source, entry) for entry in empty), NOBODY)
        if nobody and not self.empty.lists:
            raise PackError(f"--nobody {nobody} needs pictures without people of {', '.join(NOBODY)}; the pack holds none")
        self.textures = [entry for entry in entries if entry.source in BACKGROUNDS]
        self.people = Choice(by_source((entry.source, cutout) for entry in entries for cutout in cutouts(entry)), PEOPLE)
        if not self.plain.lists:
            raise PackError("the pack holds no pictures to train on; pack some with prepare.py")
        composes = self.backgrounds.lists and self.people.lists
        self.composed_share = composed_share / (composed_share + self.plain.total) if composes else 0.0

    def sample_of_nobody(self, random, size):
        """What networks take for people most often: things at the border, tilted, dark or blurred."""
        entry = self.empty.draw(random)
        picture, labels = random_view(random, entry.picture, entry.labels, size, smallest=0.5, whole=0.3)
        if random.random() < 0.6:
            pieces = [self.empty.draw(random).picture for _ in range(int(random.integers(1, 5)))]
            picture, labels = with_sheets(random, picture, labels, pieces)
        if random.random() < 0.6:
            picture, labels = turned(random, picture, labels, 40.0, zoom=(-0.1, 0.4))
        if random.random() < 0.3:
            picture = (picture * random.uniform(0.4, 0.9)).astype(np.uint8)
        return random_camera(random, picture, blur=0.55, longest=1 / 22), labels

    def sample(self, i):
        random = np.random.default_rng((self.seed, i))
        size = self.sizes[i // self.batch % len(self.sizes)]
        if self.nobody and random.random() < self.nobody:
            return self.sample_of_nobody(random, size)
        if random.random() < self.composed_share:
            people = [self.people.draw(random) for _ in range(4)]
            picture, labels = composed(random, self.backgrounds.draw(random), people, self.textures, size)
            is_room = True
        else:
            entry = self.plain.draw(random)
            picture, labels = random_view(random, entry.picture, drawn(random, entry.labels), size, whole=self.whole)
            is_room = entry.source in ROOMS
        rolls = is_room and self.room_roll > 0.0
        if rolls and random.random() < 0.5:
            picture, labels = turned(random, picture, labels, self.room_roll)
        # If only samples of nobody were blurred much, blur would mean nobody.
        longest = 1 / 15 if self.nobody and random.random() < 0.4 else 1 / 25
        return random_camera(random, picture, blur=0.4 if rolls else 0.2, longest=longest), labels

    def __iter__(self):
        cv2.setNumThreads(1)
        i = self.start
        while True:
            picture, labels = self.sample(i)
            yield to_tensor(picture), torch.from_numpy(labels.astype(np.int64))
            i += 1
