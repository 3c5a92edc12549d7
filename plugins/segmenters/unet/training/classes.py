# SPDX-License-Identifier: BSD-3-Clause
"""The classes of the network, and what other people's label images call them."""
import numpy as np

CLASSES = ("background", "person", "chair", "table", "tv")
PERSON = 1
IGNORED = 255
#: Some furniture: whatever it is, it is no person.
NOT_PERSON = 254

#: PASCAL VOC's class indices; every other object of VOC is background, 255 its unlabelled border.
VOC = {9: 2, 11: 3, 15: PERSON, 20: 4, 255: IGNORED}
#: Names in the scene.json of a simulated sequence.
SIMULATED = {"person": PERSON, "chair": 2, "desk": 3, "table": 3, "monitor": 4}


def relabelled(labels, mapping):
    """Label image with other numbers; what the mapping leaves out becomes background."""
    table = np.zeros(256, np.uint8)
    for value, label in mapping.items():
        table[value] = label
    return table[labels]
