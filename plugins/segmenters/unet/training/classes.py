# SPDX-License-Identifier: BSD-3-Clause
"""The classes of the network, and what other people's label images call them."""
import numpy as np

CLASSES = ("background", "person", "chair", "table", "tv")
PERSON = 1
IGNORED = 255
#: Some furniture: whatever it is, it is no person.
NOT_PERSON = 254
#: A person with a probability of N %, else background: CHANCE + N, N from 0 to 100 (chances.py writes them).  train.py
#: draws one or the other for each sample; train_gpu.py does not know them.
CHANCE = 100

#: In a pack: pictures without labels, which a teacher labels (train_gpu.py); nothing else is in such a label image.
#: Either nothing is known of the picture, or boxes of people are: a pixel is in one of them, or in none.
UNLABELLED, IN_BOX, IN_NO_BOX = 253, 252, 251

#: What else VOC names.  Background to the network's user; in training, coarse heads that are not shipped tell it apart,
#: so that less of a horse is taken for the person on it.  Their labels follow those of CLASSES.
OTHER_THINGS = ("aeroplane", "bicycle", "bird", "boat", "bottle", "bus", "car", "cat", "cow", "dog", "horse", "motorbike",
                "pottedplant", "sheep", "sofa", "train")
TOLD_APART = len(CLASSES) + len(OTHER_THINGS)
#: PASCAL VOC's class indices, 255 its unlabelled border.
VOC = {9: 2, 11: 3, 15: PERSON, 20: 4, 255: IGNORED}
VOC.update({index: len(CLASSES) + i for i, index in enumerate(k for k in range(1, 21) if k not in VOC)})
#: Names in the scene.json of a simulated sequence.
SIMULATED = {"person": PERSON, "chair": 2, "desk": 3, "table": 3, "monitor": 4}


def relabelled(labels, mapping):
    """Label image with other numbers; what the mapping leaves out becomes background."""
    table = np.zeros(256, np.uint8)
    for value, label in mapping.items():
        table[value] = label
    return table[labels]


def is_other_thing(labels):
    """For arrays of numpy and of PyTorch."""
    return (labels >= len(CLASSES)) & (labels < TOLD_APART)


def is_chance(labels):
    """Which labels are chances of a person."""
    return (labels >= CHANCE) & (labels <= CHANCE + 100)
