#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mean of the weights of several trainings that started from the same weights, with other seeds or sizes.

Such a mean generalises better than each of its parts and costs nothing at run time (Wortsman et al., Model soups,
ICML 2022).  Means and variances of the batch normalisation belong to the new weights, so they are measured anew, on
pictures to train on.

Example
  average.py pack.npz out/a/weights.npz out/b/weights.npz --output out/both.npz
"""
import argparse
import itertools
import pathlib
import sys

import torch

from pack import PackError, read_pack
from samples import Samples
from weights import load_weights, save_weights


def mean_of(models):
    """Their mean, in the first of them."""
    states = [model.state_dict() for model in models]
    for name, value in states[0].items():
        if value.dtype.is_floating_point:
            value.copy_(torch.stack([state[name] for state in states]).mean(0))
    return models[0]


def measure_normalisation(model, batches):
    """Means and variances over all of `batches` (tensors), in place of running ones."""
    for module in model.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            module.reset_running_stats()
            module.momentum = None  # all batches count alike
    model.train()
    with torch.no_grad():
        for pictures in batches:
            model(pictures)
    return model.eval()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pack", type=pathlib.Path)
    parser.add_argument("weights", type=pathlib.Path, nargs="+", help="weights.npz of trainings")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="weights.npz to write")
    parser.add_argument("--pictures", type=int, default=800, help="to measure the normalisation on (default: 800)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    models, sizes = zip(*(load_weights(path) for path in arguments.weights))
    if len({model.size for model in models}) != 1:
        raise PackError(f"sizes {', '.join(model.size for model in models)}; expected weights of one size")
    model, batch = mean_of(models), 8
    training, _ = read_pack(arguments.pack)
    samples = torch.utils.data.DataLoader(Samples(training, [sizes[0]], batch, arguments.seed), batch)
    count = -(-arguments.pictures // batch)
    measure_normalisation(model, (pictures for pictures, _ in itertools.islice(samples, count)))
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    save_weights(arguments.output, model.state_dict(), model.size, sizes[0])
    print(f"{arguments.output}: mean of {len(models)}")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"average.py: {error}")
