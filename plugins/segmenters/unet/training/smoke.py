#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does the training work at all?  A few steps with a tiny network, in seconds.

Packs simulated frames, trains, goes on from the checkpoint, exports, and starts another training from that.  Fails when
the loss does not fall, or when what is read back from the export is another network.  Leaves in
--output: unet.onnx, picture.png and labels.png, what PyTorch says of that picture, for a comparison with C++.
"""
import argparse
import csv
import pathlib
import subprocess
import sys

import cv2
import numpy as np
import torch

from chances import chances
from classes import CHANCE, IGNORED, IN_BOX, IN_NO_BOX, NOT_PERSON, PERSON, UNLABELLED
from measure import found_labels
from pack import PackError, read_pack
from samples import Samples, drawn, to_tensor
from teacher import labels_of
from train_gpu import student_probabilities
from weights import in_order, load_onnx, load_weights, with_normalisation

HERE = pathlib.Path(__file__).parent


def run(program, *arguments):
    command = [sys.executable, str(HERE / program), *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        raise PackError(f"{program} failed:\n{result.stdout}{result.stderr}")


def check_scores(folder, onnx, model, pictures):
    """Offsets are added to the scores, which are divided by the temperature then."""
    changed, offsets = onnx.with_name("changed.onnx"), [0.0, -1.0, 1.0, 0.5, 0.0]
    run("export.py", folder / "weights.npz", changed, "--temperature", 2, "--offsets", *offsets)
    read_back = load_onnx(changed)
    with torch.no_grad():
        read_back = with_normalisation(read_back, [pictures], in_order(read_back))
        expected = model(pictures) + torch.tensor(offsets)[None, :, None, None]
        difference = float((2.0 * read_back(pictures) - expected).abs().max())
    if not difference < 1e-3:
        raise PackError(f"{changed}: twice its scores differ by {difference} from those of weights.npz with the offsets; "
                        "expected the same")


def check_boxes(folder):
    """Boxes of people reach a pack, with pictures as WebP, and decide what becomes of a teacher's probabilities."""
    for kind in ("images", "boxes"):
        (folder / "further" / kind).mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "further" / "images" / "boxed_1.jpg"), np.full((40, 80, 3), 100, np.uint8))
    (folder / "further" / "boxes" / "boxed_1.txt").write_text("0.25 0.5 0.5 1\n")
    run("prepare.py", "--further", folder / "further", "--webp", "--output", folder / "boxed.npz")
    entry = read_pack(folder / "boxed.npz", unlabelled=True)[0][0]
    hints = np.where(np.arange(80) < 40, IN_BOX, IN_NO_BOX)[None].repeat(40, 0)
    if not np.array_equal(entry.labels, hints) or entry.is_labelled():
        raise PackError("a box over the left half of a picture came back as other labels; expected the box")
    cases = [(0.6, IN_BOX, PERSON), (0.6, IN_NO_BOX, IGNORED), (0.2, IN_NO_BOX, NOT_PERSON), (0.01, IN_NO_BOX, 0), (0.01, IN_BOX, IGNORED),
             (0.6, UNLABELLED, IGNORED), (0.75, UNLABELLED, PERSON), (0.2, UNLABELLED, IGNORED)]
    for chance, hint, expected in cases:
        probability = torch.zeros(1, 5, 20, 20)
        probability[:, PERSON], probability[:, 0] = chance, 1.0 - chance
        found = labels_of(probability, torch.full((1, 20, 20), hint, dtype=torch.uint8))
        if not bool((found == expected).all()):
            raise PackError(f"a person's probability of {chance} where the label says {hint} became {found[0, 10, 10]}; expected {expected}")


def check_chances():
    """Chances of people become labels by the boxes of people: a missed person, and one outside of all boxes, are ignored."""
    probability = np.zeros((5, 100, 100), np.float32)
    probability[PERSON, 10:40, 10:40] = 0.8  # in the first box
    probability[PERSON, 60:62, 60:90] = 0.8  # a sliver of the second one
    probability[PERSON, 10:20, 70:80] = 0.6  # in no box
    probability[PERSON + 1, 80:90, 10:20] = 0.9
    probability[0] = 1.0 - probability[1:].sum(0)
    found = chances(probability, [(10, 10, 40, 40), (60, 60, 90, 90)])
    expected = {(20, 20): CHANCE + 80, (61, 70): CHANCE + 80, (75, 75): IGNORED, (15, 75): IGNORED, (85, 15): PERSON + 1, (50, 5): 0}
    for (row, column), label in expected.items():
        if found[row, column] != label:
            raise PackError(f"chances.py labelled row {row}, column {column} {found[row, column]}; expected {label}")


def check_student(model, input_size):
    """A student's probabilities are the mean of its own for a picture and for the mirror image."""
    picture = np.random.default_rng(1).integers(0, 255, (input_size[1], input_size[0], 3), dtype=np.uint8)
    planes = torch.from_numpy(picture[:, :, ::-1].transpose(2, 0, 1) / np.float32(255))[None]
    with torch.no_grad():
        scores, mirrored = (model(to_tensor(view)[None]) for view in (picture, picture[:, ::-1]))
        expected = 0.5 * (torch.softmax(scores, 1) + torch.softmax(mirrored, 1).flip(3))
        found = student_probabilities(model, planes, tuple(scores.shape[2:]), input_size)
    difference = float((found - expected).abs().max())
    if not difference < 1e-4:
        raise PackError(f"the student's probabilities differ by {difference} from the network's; expected the same")


def check_kept_blocks(folder, pack):
    """A training with --keep-blocks leaves these blocks alone, and their normalisation, and changes the others."""
    before = folder / "mobile" / "weights.npz"
    run("train.py", pack, "--output", folder / "kept", "--size", "mobile", "--batch", 2, "--workers", 0, "--width", 64,
        "--height", 64, "--steps", 2, "--start-from", before, "--keep-blocks", 3, "--keep-normalisation", "--coarse-share", 0,
        "--warm-up", 1, "--room-roll", 25, "--shares", "simulated=0.5", "composed=0.5")
    before, after = np.load(before), np.load(folder / "kept" / "weights.npz")
    changed = [name for name in before.files if before[name].dtype.kind == "f" and not np.array_equal(before[name], after[name])]
    kept = ("stem.", "down.0.", "down.1.", "down.2.", "coarse_heads.")
    wrong = [name for name in changed if name.startswith(kept) or "running_" in name]
    if wrong or not any(name.startswith("down.3.") for name in changed):
        raise PackError(f"--keep-blocks 3 changed {wrong[:3] or changed[:3]}; expected weights of the other blocks only")


def check_samples(pack):
    """Chances become people or background; a sample of nobody shows nobody, and without such pictures there is none."""
    chances = np.array([[CHANCE, CHANCE + 20, CHANCE + 80, CHANCE + 100, 3]], np.uint8)
    found = drawn(np.random.default_rng(1), chances)
    if found.tolist() != [[0, 0, PERSON, PERSON, 3]]:
        raise PackError(f"people with chances of 0, 20, 80 and 100 % and a table became {found[0].tolist()}; expected 0, 0, 1, 1, 3")
    entries = read_pack(pack)[0]
    for entry in entries:
        entry.labels = np.where(entry.labels == PERSON, 0, entry.labels).astype(np.uint8)
    samples = Samples(entries, [(64, 48)], nobody=1.0)
    if any((samples.sample(i)[1] == PERSON).any() for i in range(8)):
        raise PackError("samples of nobody have people in their labels; expected none")
    for entry in entries:
        entry.labels[0, 0] = PERSON
    try:
        Samples(entries, [(64, 48)], nobody=1.0)
    except PackError:
        return
    raise PackError("people are in all pictures, and there are samples of nobody; expected an error")


def computes_with_16_bits():
    """Whether this processor does, on Linux."""
    processor = pathlib.Path("/proc/cpuinfo")
    return processor.exists() and "avx512_bf16" in processor.read_text()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("simulated", type=pathlib.Path, help="a sequence that `holdfast simulate` wrote")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    pack, onnx = arguments.output / "pack.npz", arguments.output / "unet.onnx"

    run("prepare.py", "--simulated", arguments.simulated, "--long-side", 160, "--output", pack)
    training = ("train.py", pack, "--output", arguments.output, "--size", "tiny", "--batch", 4, "--workers", 0,
                "--learning-rate", "5e-3", "--resume")
    run(*training, "--steps", 25)
    run(*training, "--steps", 50)
    with open(arguments.output / "log.csv", newline="") as file:
        losses = [float(row["loss"]) for row in csv.DictReader(file)]
    if len(losses) != 2 or not losses[1] < losses[0]:
        raise PackError(f"mean losses of the two halves {losses}; expected two, the second below the first")
    run("export.py", arguments.output / "weights.npz", onnx)

    torch.set_num_threads(1)
    model, input_size = load_weights(arguments.output / "weights.npz")
    pictures = torch.rand(2, 3, input_size[1], input_size[0])
    with torch.no_grad():
        read_back = load_onnx(onnx)
        read_back = with_normalisation(read_back, [pictures], in_order(read_back))
        difference = float((read_back(pictures) - model(pictures)).abs().max())
    if not difference < 1e-3:
        raise PackError(f"{onnx}: scores differ by {difference} from those of weights.npz; expected the same")
    check_scores(arguments.output, onnx, model, pictures)
    check_samples(pack)
    run("average.py", onnx, arguments.output / "weights.npz", "--share", 0.5, "--output", arguments.output / "average.npz")
    with torch.no_grad():
        difference = float((load_weights(arguments.output / "average.npz")[0](pictures) - model(pictures)).abs().max())
    if not difference < 1e-3:
        raise PackError(f"scores of the average of the same weights differ by {difference} from theirs; expected the same")
    check_student(load_onnx(onnx), input_size)
    run("calibrate.py", pack, arguments.output / "weights.npz", "--width", 64, "--height", 48, "--every", 1)
    run("int8_labels.py", pack, onnx, "--width", 64, "--height", 48, "--pictures", 4)
    run("train.py", pack, "--output", arguments.output / "further", "--size", "tiny", "--batch", 4, "--workers", 0,
        "--also", "64x64", "32x32", "--steps", 4, "--start-from", onnx,
        "--precision", "bf16" if computes_with_16_bits() else "fp32")
    run("train.py", pack, "--output", arguments.output / "paper", "--preset", "paper", "--batch", 2, "--workers", 0,
        "--width", 32, "--height", 32, "--steps", 2)
    for size in ("mobile", "plain"):
        folder = arguments.output / size
        run("train.py", pack, "--output", folder, "--size", size, "--batch", 2, "--workers", 0, "--width", 64,
            "--height", 64, "--steps", 2)
        run("export.py", folder / "weights.npz", folder / "unet.onnx")
    check_kept_blocks(arguments.output, pack)
    check_boxes(arguments.output)
    check_chances()
    run("train_gpu.py", pack, "--output", arguments.output / "gpu", "--device", "cpu", "--batch", 2, "--steps", 2, "--sizes", "64x64",
        "--furniture-dice", 0.1, "--start-from", arguments.output / "mobile" / "weights.npz")
    run("average.py", arguments.output / "mobile" / "unet.onnx", arguments.output / "gpu" / "weights.npz", pack, "--output",
        arguments.output / "average.npz", "--pictures", 4, "--width", 64, "--height", 64)
    load_weights(arguments.output / "average.npz")
    picture = read_pack(pack)[0][0].picture
    cv2.imwrite(str(arguments.output / "picture.png"), picture)
    cv2.imwrite(str(arguments.output / "labels.png"), found_labels(model, picture, input_size).astype(np.uint8))
    print(f"loss {losses[0]:.3f}, then {losses[1]:.3f}; {onnx}")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"smoke.py: {error}")
