# SPDX-License-Identifier: BSD-3-Clause
"""What the network is shown, made on the device that trains it: the augmentation of photographs.py and composition.py
for a whole batch at a time, from pictures that lie there as bytes."""
import concurrent.futures
import math

import cv2
import numpy as np
import torch
from torch.nn import functional

from classes import IGNORED, PERSON
from composition import cutouts
from pack import PackError
from samples import DEVIATION, MEAN, by_source

#: How often a sample is a view of a picture of this source.
PLAIN = {"voc_person": 0.14, "sbd": 0.14, "coco": 0.05, "instances": 0.08, "boxed": 0.24, "cocoplus": 0.02, "street": 0.02,
         "human_290": 0.04, "penn_fudan": 0.02, "ccp": 0.02, "camvid": 0.01, "davis": 0.003, "nyu": 0.17, "places": 0.11,
         "pinterest": 0.05, "clothes": 0.02, "room": 0.03, "simulated": 0.10, "walking": 0.06}
COMPOSED = 0.3
#: How often a picture of this source is the background of a composed sample, and how often its people are in it.
BACKGROUNDS = {"nyu": 0.45, "places": 0.16, "pinterest": 0.08, "clothes": 0.03, "room": 0.08, "simulated": 0.10, "voc_person": 0.05,
               "sbd": 0.05}
PEOPLE = {"voc_person": 0.16, "human_290": 0.20, "penn_fudan": 0.15, "ccp": 0.13, "sbd": 0.12, "cutout": 0.12, "instances": 0.05,
          "coco": 0.03, "simulated": 0.05}
#: Pictures as a moving robot sees rooms: rolled and blurred more.
ROOMS = ("nyu", "places", "pinterest", "clothes", "room", "simulated", "walking")
FOCAL_LENGTH = 0.81  # of a Kinect, in widths of the image
METRES = 10.0 / 255.0  # of a value of the depth


class Store:
    """Pictures, labels and depth of all entries on a device, each in the corner of a square."""

    def __init__(self, entries, device):
        self.entries, self.device = entries, device
        self.side = max(max(entry.labels.shape) for entry in entries) // 2 * 2 + 2
        pictures = np.zeros((len(entries), 3, self.side, self.side), np.uint8)
        labels = np.full((len(entries), self.side, self.side), IGNORED, np.uint8)
        with_depth = [i for i, entry in enumerate(entries) if entry.depth is not None]
        depths = np.zeros((len(with_depth) + 1, self.side // 2, self.side // 2), np.uint8)  # the first knows nothing
        depth_index = np.zeros(len(entries), np.int64)
        depth_index[with_depth] = np.arange(1, len(with_depth) + 1)

        def put(i):
            height, width = entries[i].labels.shape
            pictures[i, :, :height, :width] = entries[i].picture[:, :, ::-1].transpose(2, 0, 1)
            labels[i, :height, :width] = entries[i].labels
            if entries[i].depth is not None:
                size = (width // 2, height // 2)
                depths[depth_index[i], :size[1], :size[0]] = cv2.resize(entries[i].depth, size, interpolation=cv2.INTER_NEAREST)

        with concurrent.futures.ThreadPoolExecutor() as threads:
            list(threads.map(put, range(len(entries))))
        self.pictures, self.labels, self.depths, self.depth_index = (
            torch.from_numpy(array).to(device) for array in (pictures, labels, depths, depth_index))
        sizes = np.array([entry.labels.shape for entry in entries], np.float32)
        self.heights, self.widths = (torch.from_numpy(sizes[:, k].copy()).to(device) for k in (0, 1))
        is_room = np.array([entry.source in ROOMS for entry in entries])
        self.is_room = torch.from_numpy(is_room).to(device)

    def picture(self, i):
        """Colours from 0 to 1, 1 x 3 x height x width."""
        height, width = self.entries[i].labels.shape
        return self.pictures[i:i + 1, :, :height, :width].float() / 255.0


class Cutouts:
    """People cut out by their masks, on a device, in two sizes, so that a shrunk one does not flicker."""

    SIDES = (320, 96)

    def __init__(self, entries, device):
        shown = [entry for entry in entries if entry.source in PEOPLE]
        with concurrent.futures.ThreadPoolExecutor() as threads:
            found = list(threads.map(cutouts, shown))
        people = [(entry.source, cutout) for entry, some in zip(shown, found) for cutout in some]
        self.count = len(people)
        self.sources = [source for source, _ in people]
        self.levels, self.sizes = [], []
        for side in self.SIDES:
            planes = np.zeros((len(people), 4, side, side), np.uint8)
            sizes = np.zeros((len(people), 2), np.float32)
            for i, (_, cutout) in enumerate(people):
                scale = min(1.0, side / max(cutout.opacity.shape))
                size = tuple(max(2, round(value * scale)) for value in cutout.opacity.shape[::-1])
                picture = cv2.resize(cutout.picture, size, interpolation=cv2.INTER_AREA)
                planes[i, :3, :size[1], :size[0]] = picture[:, :, ::-1].transpose(2, 0, 1)
                planes[i, 3, :size[1], :size[0]] = cv2.resize(cutout.opacity, size, interpolation=cv2.INTER_AREA)
                sizes[i] = size
            self.levels.append(torch.from_numpy(planes).to(device))
            self.sizes.append(torch.from_numpy(sizes).to(device))


class Choice:
    """Draws numbers of items of several sources, each source with its own weight."""

    def __init__(self, sources, weights, device):
        lists = by_source((source, i) for i, source in enumerate(sources) if source in weights)
        if not lists:
            raise PackError(f"the packs hold nothing of {', '.join(weights)}; expected pictures of some of these sources")
        chance = torch.zeros(len(sources))
        for source, items in lists.items():
            chance[items] = weights[source] / len(items)
        self.total = float(chance.sum())
        self.sums = (chance.double().cumsum(0) / chance.double().sum()).to(device)

    def draw(self, count):
        values = torch.rand(count, device=self.sums.device, dtype=torch.float64)
        return torch.searchsorted(self.sums, values).clamp(max=len(self.sums) - 1)


class DeviceSamples:
    """Batches of augmented samples; `whole`: how often a picture is shown whole."""

    def __init__(self, store, people, whole=0.4):
        self.store, self.people, self.whole, self.device = store, people, whole, store.device
        sources = [entry.source for entry in store.entries]
        self.plain = Choice(sources, PLAIN, self.device)
        self.composed_share = 0.0
        if people.count and set(sources) & set(BACKGROUNDS):
            self.backgrounds = Choice(sources, BACKGROUNDS, self.device)
            self.who = Choice(people.sources, PEOPLE, self.device)
            self.composed_share = COMPOSED / (COMPOSED + self.plain.total)

    def uniform(self, low, high, *shape):
        return low + (high - low) * torch.rand(*shape, device=self.device)

    def log_uniform(self, low, high, *shape):
        return torch.exp(self.uniform(math.log(low), math.log(high), *shape))

    def normal(self, deviation, *shape):
        return deviation * torch.randn(*shape, device=self.device)

    def chance(self, probability, count):
        return torch.rand(count, device=self.device) < probability

    def batch(self, count, size):
        """(pictures as the network wants them, labels) of width x height `size`."""
        double = 2 if size[0] < 300 else 1  # made larger and shrunk, so that nothing flickers
        width, height = double * size[0], double * size[1]
        index = self.plain.draw(count)
        composes = torch.nonzero(self.chance(self.composed_share, count)).reshape(-1)
        if len(composes):
            index[composes] = self.backgrounds.draw(len(composes))
        smallest = torch.full((count,), 0.3, device=self.device)
        smallest[composes] = 0.45
        pictures, labels, depth, crop = self.view(index, smallest, (width, height))
        if len(composes):
            pictures[composes], labels[composes] = self.composed(
                pictures[composes], labels[composes], depth[composes], [value[composes] for value in crop], index[composes])
        is_room = self.store.is_room[index]
        turns = torch.nonzero(self.chance(torch.where(is_room, 0.5, 0.3), count)).reshape(-1)
        if len(turns):
            roll = self.normal(1.0, len(turns)) * torch.where(is_room[turns], 25.0, 8.0)
            pictures[turns], labels[turns] = self.turned(pictures[turns], labels[turns], roll)
        pictures = self.light(pictures)
        blurs = torch.nonzero(self.chance(torch.where(is_room, 0.4, 0.2), count)).reshape(-1)
        if len(blurs):
            pictures[blurs] = self.blurred(pictures[blurs])
        noisy = self.chance(0.25, count).float() * self.uniform(1.0, 8.0, count) / 255.0
        pictures = (pictures + noisy.reshape(-1, 1, 1, 1) * torch.randn_like(pictures)).clamp(0.0, 1.0)
        if double == 2:
            pictures, labels = functional.avg_pool2d(pictures, 2), labels[:, ::2, ::2]
        return (pictures - MEAN) / DEVIATION, labels.long()

    def view(self, index, smallest, size):
        """A random part of every picture: (pictures, labels, depth, (left, top, width, height) of the parts)."""
        count, (width, height) = len(index), size
        full_height, full_width = self.store.heights[index], self.store.widths[index]
        own, wanted = full_width / full_height, width / height
        shape = own * (wanted / own) ** self.uniform(0.0, 1.0, count) * torch.exp(self.normal(0.12, count))
        part_height = torch.minimum(full_height, full_width / shape) * smallest ** self.uniform(0.0, 1.0, count)
        part_width = torch.minimum(full_width, part_height * shape)
        is_whole = self.chance(self.whole, count)
        part_height = torch.where(is_whole, full_height, part_height)
        part_width = torch.where(is_whole, full_width, part_width)
        left = self.uniform(0.0, 1.0, count) * (full_width - part_width)
        top = self.uniform(0.0, 1.0, count) * (full_height - part_height)
        x = (torch.arange(width, device=self.device) + 0.5) / width
        y = (torch.arange(height, device=self.device) + 0.5) / height
        across = torch.where(self.chance(0.5, count)[:, None], 1.0 - x[None], x[None].expand(count, -1))
        x = left[:, None] + across * part_width[:, None]
        y = top[:, None] + y[None] * part_height[:, None]
        x = torch.minimum(x.clamp(min=0.5), full_width[:, None] - 0.5)
        y = torch.minimum(y.clamp(min=0.5), full_height[:, None] - 0.5)
        grid = torch.stack(torch.broadcast_tensors(x[:, None, :], y[:, :, None]), 3) * (2.0 / self.store.side) - 1.0
        pictures = functional.grid_sample(self.store.pictures[index].float() / 255.0, grid, align_corners=False)
        labels = nearest(self.store.labels[index], grid)
        depth = nearest(self.store.depths[self.store.depth_index[index]], grid)
        return pictures, labels, depth.float() * METRES, (left, top, part_width, part_height)

    def turned(self, pictures, labels, roll):
        """As from a camera that is not held level, by `roll` degrees, or that is farther away."""
        count, height, width = labels.shape
        scale, angle = torch.exp(self.uniform(-0.5, 0.2, count)), torch.deg2rad(roll)
        y, x = torch.meshgrid(torch.arange(height, device=self.device) + 0.5 - height / 2,
                              torch.arange(width, device=self.device) + 0.5 - width / 2, indexing="ij")
        cosine, sine = (value(angle).reshape(-1, 1, 1) / scale.reshape(-1, 1, 1) for value in (torch.cos, torch.sin))
        grid = torch.stack([(cosine * x - sine * y) * (2.0 / width), (sine * x + cosine * y) * (2.0 / height)], 3)
        outside = (grid.abs() > 1.0).any(3)
        found = functional.grid_sample(pictures, grid, padding_mode="reflection", align_corners=False)
        one_colour = self.chance(0.5, count).reshape(-1, 1, 1, 1) & outside[:, None]
        found = torch.where(one_colour, self.uniform(0.0, 1.0, count, 3, 1, 1), found)
        return found, torch.where(outside, IGNORED, nearest(labels, grid))

    def light(self, pictures, strength=1.0):
        """Brightness, contrast, gamma, colour cast and saturation; darkness is among them."""
        count = len(pictures)
        gain = self.normal(0.22 * strength, count, 1, 1, 1) + self.normal(0.07 * strength, count, 3, 1, 1)
        gain = gain - self.chance(0.08 * strength, count).reshape(-1, 1, 1, 1) * self.uniform(0.4, 1.6, count, 1, 1, 1)
        gamma = torch.exp(self.normal(0.2 * strength, count, 1, 1, 1))
        pictures = pictures.clamp(1e-4, 1.0) ** gamma * torch.exp(gain) + self.normal(0.04 * strength, count, 1, 1, 1)
        pictures = pictures.clamp(0.0, 1.0)
        kind = torch.rand(count, device=self.device)
        saturation = torch.where(kind < 0.5, self.uniform(0.3, 1.3, count), torch.where(kind < 0.54, 0.0, 1.0))
        grey = pictures.mean(1, keepdim=True)
        return (grey + saturation.reshape(-1, 1, 1, 1) * (pictures - grey)).clamp(0.0, 1.0)

    def blurred(self, pictures):
        """Out of focus, or moved while the shutter was open."""
        count, _, height, width = pictures.shape
        length = self.uniform(0.5, width / 25, count).reshape(-1, 1, 1)
        reach = int(math.ceil(width / 50)) + 1
        steps = torch.arange(-reach, reach + 1, device=self.device).float()
        y, x = torch.meshgrid(steps, steps, indexing="ij")
        angle = self.uniform(0.0, math.pi, count).reshape(-1, 1, 1)
        along, beside = torch.cos(angle) * x + torch.sin(angle) * y, torch.cos(angle) * y - torch.sin(angle) * x
        line = (1.0 - beside.abs()).clamp(min=0.0) * (0.5 + length / 2 - along.abs()).clamp(0.0, 1.0)
        focus = torch.exp(-(x * x + y * y) / (2.0 * (0.35 * length) ** 2))
        kernel = torch.where(self.chance(0.5, count).reshape(-1, 1, 1), line, focus) + 1e-8
        kernel = (kernel / kernel.sum((1, 2), keepdim=True)).repeat_interleave(3, 0)[:, None]
        padded = functional.pad(pictures, (reach,) * 4, mode="replicate").reshape(1, 3 * count, height + 2 * reach, -1)
        return functional.conv2d(padded, kernel, groups=3 * count).reshape(count, 3, height, width)

    def occluders(self, count, size):
        """Where a desk and what stands on it hide people."""
        width, height = size
        y, x = torch.meshgrid((torch.arange(height, device=self.device) + 0.5) / height,
                              (torch.arange(width, device=self.device) + 0.5) / width, indexing="ij")
        edge = self.uniform(0.4, 1.05, count, 1, 1)
        hides = y > edge + self.normal(0.12, count, 1, 1) * (x - 0.5)
        for _ in range(2):
            left, wide = self.uniform(0.0, 1.0, count, 1, 1), self.uniform(0.03, 0.3, count, 1, 1)
            tall = self.uniform(0.05, 0.4, count, 1, 1)
            box = (x > left) & (x < left + wide) & (y > edge - tall) & self.chance(0.5, count).reshape(-1, 1, 1)
            hides = hides | box
        return hides

    def things(self, pictures, labels, size):
        """Pieces of other pictures somewhere in every frame; pieces of people out of any context are nobody's."""
        count, (width, height) = len(pictures), size
        smallest = torch.full((count,), 0.2, device=self.device)
        thing, thing_labels, _, _ = self.view(self.backgrounds.draw(count), smallest, size)
        y, x = torch.meshgrid((torch.arange(height, device=self.device) + 0.5) / height,
                              (torch.arange(width, device=self.device) + 0.5) / width, indexing="ij")
        x, y = x - self.uniform(0.0, 1.0, count, 1, 1), y - self.uniform(0.0, 1.0, count, 1, 1)
        angle = self.uniform(0.0, math.pi, count, 1, 1)
        u = (torch.cos(angle) * x + torch.sin(angle) * y) / self.uniform(0.05, 0.4, count, 1, 1)
        v = (torch.cos(angle) * y - torch.sin(angle) * x) / self.uniform(0.05, 0.4, count, 1, 1)
        power = torch.where(self.chance(0.5, count), 2.0, 8.0).reshape(-1, 1, 1)  # rounded or angular
        inside = (u.abs() ** power + v.abs() ** power < 1.0) & self.chance(0.35, count).reshape(-1, 1, 1)
        thing_labels = torch.where(thing_labels == PERSON, IGNORED, thing_labels)
        return torch.where(inside[:, None], self.light(thing, 1.5), pictures), torch.where(inside, thing_labels, labels)

    def composed(self, pictures, labels, depth, crop, index):
        """Up to three people in every frame, at all scales, or at a distance in a room whose depth hides them."""
        count, height, width = labels.shape
        pictures, labels = self.things(pictures, labels, (width, height))
        left, top, part_width, part_height = crop
        focal = FOCAL_LENGTH * self.store.widths[index] * (height / part_height)
        horizon = (self.store.heights[index] * (0.5 + self.normal(0.13, count)) - top) * (height / part_height)
        camera_height = self.uniform(0.6, 1.6, count)
        has_depth = (depth > 0).float().mean((1, 2)) > 0.3
        for k in range(3):
            there = self.chance((1.0, 0.6, 0.3)[k], count)
            at_distance = self.chance(torch.where(has_depth, 0.6, 0.25), count)
            distance = self.log_uniform(0.8, 5.0, count)
            room_height = focal * self.uniform(1.4, 1.9, count) / distance
            free_height = height * torch.where(self.chance(0.3, count), self.log_uniform(1.6, 3.6, count),
                                               self.log_uniform(0.3, 3.6, count))
            tall = torch.where(at_distance, room_height, free_height)
            low, high = -0.25 * tall, height - 0.6 * tall
            near = tall > 0.9 * height  # larger than the frame: any part of the person
            low, high = torch.where(near, 0.35 * height - tall, low), torch.where(near, 0.5 * height, high)
            free_top = low + (high - low) * self.uniform(0.0, 1.0, count)
            tops = torch.where(at_distance, horizon + focal * camera_height / distance - tall, free_top)
            picture, opacity = self.person(tall, tops, (width, height))
            hidden = at_distance.reshape(-1, 1, 1) & (depth > 0) & (depth < distance.reshape(-1, 1, 1) - 0.12)
            by_desk = self.chance(torch.where(has_depth & at_distance, 0.1, 0.45), count).reshape(-1, 1, 1)
            hidden = hidden | (by_desk & self.occluders(count, (width, height)))
            opacity = opacity * (~hidden & there.reshape(-1, 1, 1))
            pictures = pictures + opacity[:, None] * (self.light(picture, 0.9) - pictures)
            labels = torch.where(opacity > 0.5, PERSON, labels)
        return pictures, labels

    def person(self, tall, top, size):
        """A cutout of given height and top in every frame: (picture, opacity)."""
        count, (width, height) = len(tall), size
        who = self.who.draw(count)
        own = self.people.sizes[0][who]
        wide = tall * own[:, 0] / own[:, 1] * torch.exp(self.normal(0.12, count))
        centre = self.uniform(-0.1, 1.1, count) * width
        y = (torch.arange(height, device=self.device) + 0.5 - (top + tall / 2).reshape(-1, 1)) / (tall / 2).reshape(-1, 1)
        x = (torch.arange(width, device=self.device) + 0.5 - centre.reshape(-1, 1)) / (wide / 2).reshape(-1, 1)
        x = x * torch.where(self.chance(0.5, count), 1.0, -1.0).reshape(-1, 1)
        lean = self.normal(0.08, count).reshape(-1, 1, 1) * y[:, :, None]
        x, y = torch.broadcast_tensors(x[:, None, :] + lean, y[:, :, None])
        found = []
        for planes, sizes, side in zip(self.people.levels, self.people.sizes, Cutouts.SIDES):
            scale = (sizes[who] / side).reshape(-1, 1, 1, 2)
            grid = (torch.stack([x, y], 3) + 1.0) * scale - 1.0
            found.append(functional.grid_sample(planes[who].float() / 255.0, grid, align_corners=False))
        shrinks = (tall < 0.6 * own[:, 1]).reshape(-1, 1, 1, 1)
        planes = torch.where(shrinks, found[1], found[0])
        inside = (x.abs() < 1.0) & (y.abs() < 1.0)
        return planes[:, :3], planes[:, 3] * inside


def nearest(values, grid):
    """Bytes (N x H x W) at the places of a grid; zero outside."""
    return functional.grid_sample(values[:, None].float(), grid, mode="nearest", align_corners=False)[:, 0].to(torch.uint8)
