# SPDX-License-Identifier: BSD-3-Clause
"""Random views of a labelled picture: another framing, other light, another camera."""
import cv2
import numpy as np

from classes import IGNORED


def resized(picture, labels, size):
    shrinks = picture.shape[1] > size[0]
    return (cv2.resize(picture, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR),
            cv2.resize(labels, size, interpolation=cv2.INTER_NEAREST_EXACT))


def random_view(random, picture, labels, size, smallest=0.3, whole=0.25):
    """A random part of a picture, at the size of the network's input: the whole of it with probability `whole`, else a
    part down to the share `smallest` of its longer side; its shape between its own and that of the input, because a
    frame is squeezed into the input whatever its shape."""
    height, width = labels.shape
    if random.random() < whole:
        crop_width, crop_height = width, height
    else:
        share = np.exp(random.uniform(np.log(smallest), 0.0))  # of the longer side
        own, wanted = width / height, size[0] / size[1]
        shape = own * (wanted / own) ** random.uniform(0.0, 1.0) * np.exp(random.normal(0.0, 0.12))
        crop_height = min(height, width / shape) * share
        crop_width = min(width, crop_height * shape)
    left = random.uniform(0.0, width - crop_width)
    top = random.uniform(0.0, height - crop_height)
    rows = slice(int(top), max(int(top + crop_height), int(top) + 8))
    columns = slice(int(left), max(int(left + crop_width), int(left) + 8))
    picture, labels = resized(picture[rows, columns], labels[rows, columns], size)
    if random.random() < 0.5:
        picture, labels = picture[:, ::-1], labels[:, ::-1]
    if random.random() < 0.3:
        picture, labels = turned(random, picture, labels)
    return np.ascontiguousarray(picture), np.ascontiguousarray(labels)


def turned(random, picture, labels, roll=8.0, zoom=(-0.5, 0.2)):
    """As from a camera that is not held level, by `roll` degrees (standard deviation), or that is farther away or nearer
    (logarithm of the scale)."""
    height, width = labels.shape
    matrix = cv2.getRotationMatrix2D((width / 2, height / 2), random.normal(0.0, roll), np.exp(random.uniform(*zoom)))
    border = cv2.BORDER_REFLECT_101 if random.random() < 0.5 else cv2.BORDER_CONSTANT
    grey = tuple(int(value) for value in random.integers(0, 256, 3))
    return (cv2.warpAffine(picture, matrix, (width, height), flags=cv2.INTER_LINEAR, borderMode=border, borderValue=grey),
            cv2.warpAffine(labels, matrix, (width, height), flags=cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT,
                           borderValue=IGNORED))


def random_light(random, picture, strength=1.0):
    """Brightness, contrast, gamma, colour cast and saturation; under- and over-exposure are among them."""
    gain = np.exp(random.normal(0.0, 0.22 * strength)) * np.exp(random.normal(0.0, 0.07 * strength, 3))
    gamma = np.exp(random.normal(0.0, 0.2 * strength))
    offset = random.normal(0.0, 10.0 * strength)
    levels = (np.arange(256, dtype=np.float32) / 255.0) ** gamma * 255.0
    table = np.clip(levels[:, None] * gain[None] + offset, 0, 255).astype(np.uint8)
    picture = cv2.LUT(picture, table[None])
    saturation = random.uniform(0.3, 1.3) if random.random() < 0.5 else (0.0 if random.random() < 0.08 else 1.0)
    if saturation != 1.0:
        grey = cv2.cvtColor(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
        picture = cv2.addWeighted(picture, saturation, grey, 1.0 - saturation, 0.0)
    return picture


def blurred(random, picture, longest):
    """Out of focus, or moved while the shutter was open, by up to `longest` pixels."""
    length = random.uniform(0.5, longest)
    if random.random() < 0.5:
        return cv2.GaussianBlur(picture, (0, 0), 0.35 * length)
    reach = int(np.ceil(length / 2))
    kernel = np.zeros((2 * reach + 1, 2 * reach + 1), np.float32)
    angle = random.uniform(0.0, np.pi)
    step = length / 2 * np.array([np.cos(angle), np.sin(angle)])
    ends = [tuple(int(round(value)) for value in reach + sign * step) for sign in (-1, 1)]
    cv2.line(kernel, ends[0], ends[1], 1.0)
    return cv2.filter2D(picture, -1, kernel / kernel.sum())


def random_camera(random, picture, blur=0.2, longest=1 / 25):
    """Light, blur (with probability `blur`, up to the share `longest` of the width) and noise of another camera."""
    picture = random_light(random, picture)
    if random.random() < blur:
        picture = blurred(random, picture, picture.shape[1] * longest)
    if random.random() < 0.25:
        noise = random.normal(0.0, random.uniform(1.0, 8.0), picture.shape)
        picture = np.clip(picture + noise, 0, 255).astype(np.uint8)
    return picture
