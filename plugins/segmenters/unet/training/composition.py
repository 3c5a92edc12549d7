# SPDX-License-Identifier: BSD-3-Clause
"""People cut out by their masks and put into other pictures, as a robot's camera sees them: at many scales, cut by the
borders of the image, one behind another, behind furniture, moved while the shutter was open."""
import cv2
import numpy as np

from classes import IGNORED, PERSON
from photographs import blurred, random_light, random_view


class Cutout:
    """A person, or some who stand together: picture and opacity (0 to 255), without surroundings."""

    def __init__(self, picture, opacity):
        self.picture, self.opacity = picture, opacity


def cutouts(entry, smallest_height=90):
    """Everybody in a picture who is large enough to be put into another one."""
    people = (entry.labels == PERSON).astype(np.uint8)
    count, components, stats, _ = cv2.connectedComponentsWithStats(people, connectivity=4)
    found = []
    for k in range(1, count):
        left, top, width, height, area = stats[k]
        if height < smallest_height or area < 0.15 * width * height or area < 2000:
            continue
        rows, columns = slice(top, top + height), slice(left, left + width)
        opacity = (components[rows, columns] == k).astype(np.uint8) * 255
        opacity = cv2.GaussianBlur(cv2.erode(opacity, np.ones((3, 3), np.uint8)), (0, 0), 0.7)
        found.append(Cutout(entry.picture[rows, columns].copy(), opacity))
    return found


def placed(random, image, opacity, size):
    """The cutout at a random place and scale of a frame: its picture and opacity, as large as the frame."""
    width, height = size
    nearest = random.random() < 0.3  # at arm's length
    person_height = height * np.exp(random.uniform(np.log(1.6 if nearest else 0.35), np.log(3.6)))
    scale = person_height / image.shape[0]
    stretch = np.exp(random.normal(0.0, 0.12))
    if random.random() < 0.5:
        stretch = -stretch
    person_width = abs(stretch) * scale * image.shape[1]
    centre_x = random.uniform(-0.1, 1.1) * width
    if person_height < 0.9 * height:
        top = random.uniform(-0.25 * person_height, height - 0.6 * person_height)
    else:  # larger than the frame: any part of the person, heads not more often than legs
        top = random.uniform(0.35 * height - person_height, 0.5 * height)
    lean = random.normal(0.0, 0.06)
    x_axis = stretch * scale
    start = centre_x - person_width / 2 if stretch > 0 else centre_x + person_width / 2
    matrix = np.array([[x_axis, lean, start - lean * person_height / 2], [0.0, scale, top]], np.float64)
    if scale < 0.6:  # a shrunk picture must not flicker
        shrunk = (max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale)))
        image = cv2.resize(image, shrunk, interpolation=cv2.INTER_AREA)
        opacity = cv2.resize(opacity, shrunk, interpolation=cv2.INTER_AREA)
        matrix[:, :2] /= scale
    return (cv2.warpAffine(image, matrix, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE),
            cv2.warpAffine(opacity, matrix, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT))


def random_shape(random, size):
    """Opacity of a rounded or angular thing somewhere in the frame."""
    width, height = size
    shape = np.zeros((height, width), np.uint8)
    centre = random.uniform(0.0, 1.0, 2) * size
    if random.random() < 0.5:
        axes = tuple(int(value) for value in random.uniform(0.05, 0.4, 2) * width)
        cv2.ellipse(shape, tuple(int(value) for value in centre), axes, random.uniform(0, 180), 0, 360, 255, -1)
    else:
        count = int(random.integers(3, 7))
        angles = np.sort(random.uniform(0.0, 2 * np.pi, count))
        radii = random.uniform(0.08, 0.45, count) * width
        points = centre + np.stack([np.cos(angles), np.sin(angles)], 1) * radii[:, None]
        cv2.fillPoly(shape, [points.astype(np.int32)], 255)
    return cv2.GaussianBlur(shape, (0, 0), 0.6)


def occluder(random, size):
    """1 where the room hides people: what stands on a desk, or below a slanting edge, or a thing in between."""
    width, height = size
    hides = np.zeros((height, width), np.uint8)
    kind = random.random()
    if kind < 0.6:  # a desk
        left, right = random.uniform(0.5, 1.05) * height + random.normal(0.0, 0.08 * height, 2)
        cv2.fillPoly(hides, [np.array([[0, left], [width, right], [width, height], [0, height]], np.int32)], 1)
        for _ in range(int(random.integers(0, 4))):  # what stands on it
            x, w, h = random.uniform(0.0, width), random.uniform(0.03, 0.3) * width, random.uniform(0.05, 0.35) * height
            bottom = max(left, right)
            cv2.rectangle(hides, (int(x), int(bottom - h)), (int(x + w), int(bottom)), 1, -1)
    else:
        hides[random_shape(random, size) > 127] = 1
    return hides


def mix(below, above, opacity):
    weight = opacity[:, :, None].astype(np.uint16)
    return ((below * (255 - weight) + above * weight + 127) // 255).astype(np.uint8)


def with_sheets(random, picture, labels, pieces):
    """Books and sheets of paper that lie about, seen at a slant, often at the border of the frame: parts of `pieces`
    (pictures), paler or of one colour.  They are no people and no furniture."""
    height, width = labels.shape
    picture, labels = picture.copy(), labels.copy()
    for piece in pieces:
        cover, _ = random_view(random, piece, np.zeros(piece.shape[:2], np.uint8), (96, 128), smallest=0.15)
        cover = random_light(random, cover, 1.5)
        colour = cv2.cvtColor(np.uint8([[[random.integers(0, 180), random.integers(0, 256), random.integers(30, 256)]]]),
                              cv2.COLOR_HSV2BGR)
        share = random.uniform(0.0, 1.0) if random.random() < 0.6 else 0.0
        cover = cv2.addWeighted(cover, 1.0 - share, np.broadcast_to(colour, cover.shape).copy(), share, 0.0)
        centre = random.uniform(0.0, 1.0, 2)
        if random.random() < 0.5:  # at a border
            centre[int(random.integers(2))] = random.integers(2) + random.normal(0.0, 0.04)
        half_width = np.exp(random.uniform(np.log(0.05), np.log(0.25))) * width
        half = half_width * np.array([1.0, np.exp(random.normal(0.3, 0.3))])
        angle = random.uniform(0.0, 2.0 * np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * random.uniform(0.8, 1.2, (4, 2))
        corners = corners @ turn.T * [1.0, random.uniform(0.4, 1.0)] + centre * [width, height]
        outline = np.array([[0, 0], [95, 0], [95, 127], [0, 127]], np.float32)
        matrix = cv2.getPerspectiveTransform(outline, corners.astype(np.float32))
        sheet = cv2.warpPerspective(cover, matrix, (width, height), borderMode=cv2.BORDER_REPLICATE)
        opacity = cv2.warpPerspective(np.full((128, 96), 255, np.uint8), matrix, (width, height))
        picture = mix(picture, sheet, opacity)
        labels[opacity > 127] = 0
    return picture, labels


def composed(random, background, people, textures, size):
    """A frame with up to four people (and sometimes things that are none) in a background; picture and labels."""
    picture, labels = random_view(random, background.picture, background.labels, size, smallest=0.45)
    room, room_labels = picture.copy(), labels.copy()
    for _ in range(int(random.choice([0, 1, 2], p=[0.7, 0.2, 0.1]))):
        texture = textures[int(random.integers(len(textures)))]
        thing, thing_labels = random_view(random, texture.picture, texture.labels, size, smallest=0.2)
        opacity = random_shape(random, size)
        picture = mix(picture, random_light(random, thing, 1.5), opacity)
        # A piece of a person out of any context is nobody's label.
        thing_labels = np.where(thing_labels == PERSON, IGNORED, thing_labels)
        labels = np.where(opacity > 127, thing_labels, labels)
    for _ in range(int(random.choice([1, 2, 3, 4], p=[0.35, 0.35, 0.2, 0.1]))):
        person = people[int(random.integers(len(people)))]
        image, opacity = placed(random, person.picture, person.opacity, size)
        image = random_light(random, image, 0.9)
        if random.random() < 0.3:
            length = random.uniform(1.0, size[0] / 25)
            seed = int(random.integers(1 << 30))  # picture and opacity move alike
            image = blurred(np.random.default_rng(seed), image, length)
            opacity = blurred(np.random.default_rng(seed), opacity, length)
        if random.random() < 0.45:
            opacity = np.where(occluder(random, size) > 0, 0, opacity)
        picture = mix(picture, image, opacity)
        labels[opacity > 127] = PERSON
    if random.random() < 0.25:
        hidden = occluder(random, size) > 0
        picture[hidden], labels[hidden] = room[hidden], room_labels[hidden]
    return picture, labels
