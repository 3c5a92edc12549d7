#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Train the U-Net on a GPU within minutes, from packs that prepare.py wrote.

All pictures are decoded once into the memory of the device; samples are cut, composed and augmented there, batch by
batch.  Pictures without labels get those of a teacher (--teacher) first, where it is sure.  The run ends after --minutes
whatever the speed, and the learning rate follows the clock.

Writes into --output: weights.npz (averaged over the last steps, for export.py; also every --save-every minutes),
log.csv, curves.png and samples.png (what the network is shown).

Example
  train_gpu.py pack.0.npz pack.1.npz --start-from ../unet.onnx --teacher deeplabv3_mnv2_pascal_quant.tflite --output out/5
"""
import argparse
import copy
import pathlib
import sys
import time

import cv2
import numpy as np
import torch
from torch import nn
from torch.nn import functional

from classes import CLASSES, IGNORED, NOT_PERSON, PERSON, is_chance
from curves import draw_curves
from gpu_samples import Cutouts, DeviceSamples, Store
from measure import Confusion
from model import make_model, multiple
from pack import PackError, read_pack
from photographs import resized
from pretrained import load_encoder
from samples import DEVIATION, MEAN, to_tensor
from teacher import SIDE, Teacher, labels_of, own_classes, probabilities
from train import Log, learning_rate, size_of, training_loss
from weights import in_order, load_onnx, load_weights, save_weights, with_normalisation


def stretched(planes, size):
    return functional.interpolate(planes, size=size, mode="bilinear", align_corners=False)


def student_probabilities(student, pictures, size, input_size):
    """Of our classes, by a network of ours; mean over the pictures (0 to 1, N x 3 x H x W) and their mirror images."""
    width, height = input_size
    inputs = (stretched(pictures, (height, width)) - MEAN) / DEVIATION
    scores = [student(inputs).float(), student(inputs.flip(3)).float().flip(3)]
    return 0.5 * sum(torch.softmax(stretched(x, size), 1) for x in scores)


def teach(store, path, student_path, input_size, batch=32):
    """Labels of pictures without labels, where the teacher is sure, in place; with a student (an earlier network of ours), where both
    are in the mean.  Returns how many pictures there are."""
    if any(is_chance(entry.labels).any() for entry in store.entries):
        raise PackError("the packs hold chances of people, which only train.py reads; pack the pictures before chances.py labels them")
    unlabelled = [i for i, entry in enumerate(store.entries) if not entry.is_labelled()]
    if not unlabelled:
        return 0
    if path is None:
        raise PackError(f"the packs hold {len(unlabelled)} pictures without labels; name a --teacher for them")
    teacher = Teacher(path).to(store.device).eval()
    student = load_onnx(student_path).to(store.device).eval() if student_path else None
    size = (SIDE // 2, SIDE // 2)
    for start in range(0, len(unlabelled), batch):
        chosen = unlabelled[start:start + batch]
        inputs = torch.cat([stretched(store.picture(i), (SIDE, SIDE)) for i in chosen])
        with torch.no_grad(), torch.autocast(store.device.type, torch.bfloat16):
            found = own_classes(probabilities(teacher, inputs, size))
            if student:
                found = 0.5 * (found + student_probabilities(student, inputs, size, input_size))
        for i, probability in zip(chosen, found):
            height, width = store.entries[i].labels.shape
            hints = store.labels[i:i + 1, :height, :width]
            store.labels[i, :height, :width] = labels_of(stretched(probability[None].float(), (height, width)), hints)[0]
    return len(unlabelled)


def show(samples, size, path, count=24):
    """Samples and, below, their labels in colours, as a picture to look at before a long run."""
    colours = np.full((256, 3), (128, 128, 0), np.uint8)
    colours[:len(CLASSES)] = ((0, 0, 0), (0, 0, 255), (0, 255, 0), (255, 0, 0), (0, 255, 255))
    colours[NOT_PERSON], colours[IGNORED] = (200, 0, 200), (255, 255, 255)
    pictures, labels = samples.batch(count, size)
    pictures = ((pictures * DEVIATION + MEAN) * 255.0).byte().cpu().numpy().transpose(0, 2, 3, 1)[:, :, :, ::-1]
    pairs = [np.vstack([picture, picture // 2 + colours[label] // 2])
             for picture, label in zip(pictures, labels.byte().cpu().numpy())]
    rows = [np.hstack([cv2.resize(pair, (160, 240)) for pair in pairs[i:i + 8]]) for i in range(0, count - 7, 8)]
    cv2.imwrite(str(path), np.vstack(rows))


class Validation:
    """IoU on the photographs that are held out, and on rooms that are, and how many pixels there are wrongly a person."""

    GROUPS = {"voc_person": "photographs", "nyu": "rooms"}

    def __init__(self, held_out):
        self.entries = [entry for entry in held_out if entry.source in self.GROUPS]

    def __call__(self, model, size, device):
        confusions = {name: Confusion() for name in self.GROUPS.values()}
        empty = Confusion()
        for entry in self.entries:
            small, _ = resized(entry.picture, entry.labels, size)
            with torch.no_grad(), torch.autocast(device.type, torch.bfloat16):
                scores = model(to_tensor(small)[None].to(device)).float()
            scores = stretched(scores, entry.labels.shape)
            found = scores[0].argmax(0).cpu().numpy()
            confusions[self.GROUPS[entry.source]].add(entry.labels, found)
            if entry.source == "nyu" and not np.any(entry.labels == PERSON):
                empty.add(entry.labels, found)
        figures = {f"iou_{name}" if group == "photographs" else f"{group}_iou_{name}": confusion.iou(label)
                   for group, confusion in confusions.items() for label, name in enumerate(CLASSES)}
        figures["false_person"] = empty.share_found(PERSON)
        return figures


class Limited(nn.Module):
    """ReLU with an upper limit that all of a network's share."""

    def __init__(self, limit):
        super().__init__()
        self.limit = limit

    def forward(self, x):
        return functional.relu(x) if self.limit[0] is None else x.clamp(0.0, self.limit[0])


class Adoption:
    """Makes a contracting path with ReLU6 our own, which has ReLU: the limit rises from 6 to 60 in the first half of the
    training and then goes, and the path's learning rate rises in the first tenth, in which the rest learns to use it."""

    def __init__(self, model, is_adopted):
        self.is_adopted, self.limit = is_adopted, [6.0 if is_adopted else None]
        for part in (model.stem, model.down) if is_adopted else ():
            self.limit_all(part)

    def limit_all(self, part):
        for name, child in part.named_children():
            if isinstance(child, nn.ReLU):
                setattr(part, name, Limited(self.limit))
            else:
                self.limit_all(child)

    def advance(self, progress):
        """Sets the limit; returns what to multiply the path's learning rate by."""
        if not self.is_adopted:
            return 1.0
        risen = max(0.0, (progress - 0.1) / 0.4)
        self.limit[0] = 6.0 * 10.0 ** risen if risen < 1.0 else None
        return min(1.0, progress / 0.1)


def starting_model(path, encoder_path, samples, size, device, batches=24):
    """Weights to begin with, and whether their contracting path is adopted; where export.py took the batch normalisation
    away, it is restored."""
    if path is None:
        model = make_model("mobile")
    else:
        model = load_onnx(path) if path.suffix == ".onnx" else load_weights(path)[0]
    layers = in_order(model)
    if encoder_path:
        layers = load_encoder(model, encoder_path, DEVIATION / 0.5)
    adoption = Adoption(model, encoder_path is not None)
    model = model.to(device)
    if encoder_path or path and all(float(norm.running_mean.abs().max()) == 0.0 for _, norm in layers if norm):
        model = with_normalisation(model, (samples.batch(16, size)[0] for _ in range(batches)), layers)
    return model, adoption


class Average:
    """Running mean of the weights over the steps."""

    def __init__(self, model, fraction):
        self.state, self.fraction, self.step = copy.deepcopy(model.state_dict()), fraction, 0

    def add(self, model):
        keep = min(self.fraction, (1.0 + self.step) / (10.0 + self.step))
        pairs = [(self.state[name], value) for name, value in model.state_dict().items() if value.dtype.is_floating_point]
        averages, values = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
        torch._foreach_mul_(averages, keep)
        torch._foreach_add_(averages, values, alpha=1.0 - keep)
        self.step += 1

    def model(self, model):
        result = copy.deepcopy(model)
        result.load_state_dict(self.state)
        return result.eval()


def optimizer_for(model, arguments):
    encoder = [value for part in (model.stem, model.down) for value in part.parameters()]
    known = set(encoder)
    others = [value for value in model.parameters() if value not in known]
    groups = [dict(params=encoder, share=arguments.encoder_rate), dict(params=others, share=1.0)]
    return torch.optim.AdamW(groups, lr=arguments.learning_rate, weight_decay=arguments.weight_decay, foreach=True)


def step(model, optimizer, samples, arguments, size, rates, class_weights, device):
    """One step on a batch of the size; returns the loss, still on the device."""
    for group, rate in zip(optimizer.param_groups, rates):
        group["lr"] = rate * group["share"]
    larger = size[0] * size[1] / (arguments.sizes[0][0] * arguments.sizes[0][1])
    count = max(2, round(arguments.batch / max(1.0, larger)))
    with torch.no_grad():
        pictures, labels = samples.batch(count, size)
    optimizer.zero_grad(set_to_none=True)
    with torch.autocast(device.type, torch.bfloat16):
        outputs = model(pictures.contiguous())
    loss = training_loss([scores.float() for scores in outputs], labels, class_weights, arguments.coarse_share,
                         arguments.furniture_dice)
    loss.backward()
    torch.nn.utils.clip_grad_norm_(model.parameters(), 5.0)
    optimizer.step()
    return loss.detach()


def train(arguments):
    started = time.monotonic()

    def say(text):
        print(f"{time.monotonic() - started:6.1f} s  {text}", flush=True)

    device = torch.device(arguments.device)
    torch.manual_seed(arguments.seed)
    torch.backends.cuda.matmul.allow_tf32 = torch.backends.cudnn.allow_tf32 = True
    entries, held_out = [], []
    for path in arguments.packs:
        some, others = read_pack(path, unlabelled=True)
        entries, held_out = entries + some, held_out + others
    say(f"{len(entries)} pictures, {len(held_out)} held out")
    store = Store(entries, device)
    taught = teach(store, arguments.teacher, arguments.student, max(arguments.sizes))
    people = Cutouts(entries, device)
    say(f"{taught} of them labelled by the teacher, {people.count} people cut out, squares of {store.side} px")
    samples = DeviceSamples(store, people, arguments.whole)
    show(samples, arguments.sizes[0], arguments.output / "samples.png")
    model, adoption = starting_model(arguments.start_from, arguments.encoder_from, samples, arguments.sizes[0], device)
    optimizer = optimizer_for(model, arguments)
    average, validation = Average(model, arguments.average), Validation(held_out)
    class_weights = torch.tensor(arguments.class_weights, device=device)
    log = Log(arguments.output / "log.csv", False)

    def measure(count, loss, rate):
        averaged = average.model(model)
        figures = validation(averaged, arguments.sizes[0], device)
        row = dict(step=count, minutes=round((time.monotonic() - begun) / 60, 2), learning_rate=f"{rate:.2e}",
                   loss=round(loss, 4), **{name: round(float(value), 4) for name, value in figures.items()})
        log.add(row)
        say("  ".join(f"{name} {value}" for name, value in row.items()))

    def save():
        save_weights(arguments.output / "weights.npz", average.state, "mobile", arguments.sizes[0])

    begun = time.monotonic()
    measure(0, 0.0, 0.0)
    model.train()
    count, losses, saved, measured = 0, [], begun, begun

    def progress():
        return count / arguments.steps if arguments.steps else (time.monotonic() - begun) / (60.0 * arguments.minutes)

    while progress() < 1.0:
        rate = learning_rate(progress(), count, arguments.learning_rate, arguments.warm_up)
        rates = (rate * adoption.advance(progress()), rate)
        losses.append(step(model, optimizer, samples, arguments, arguments.sizes[count % len(arguments.sizes)], rates,
                           class_weights, device))
        count += 1
        average.add(model)
        if count in (10, 100):
            say(f"step {count}")
        now = time.monotonic()
        if now - saved > 60.0 * arguments.save_every:
            save()
            saved = now
        if now - measured > 60.0 * arguments.measure_every:
            measure(count, float(torch.stack(losses).mean()), rate)
            losses, measured = [], time.monotonic()
    save()
    measure(count, float(torch.stack(losses).mean()) if losses else 0.0, rate)
    save()
    draw_curves([log.path], arguments.output / "curves.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("packs", type=pathlib.Path, nargs="+", help="pictures and labels, from prepare.py")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="folder of this run")
    parser.add_argument("--start-from", type=pathlib.Path, help="weights.npz of an earlier run, or unet.onnx")
    parser.add_argument("--encoder-from", type=pathlib.Path,
                        help="begin with this file's contracting path (that of the --teacher, say, which has seen COCO)")
    parser.add_argument("--teacher", type=pathlib.Path, help="deeplabv3_mnv2_pascal_quant.tflite, for pictures without labels")
    parser.add_argument("--student", type=pathlib.Path,
                        help="unet.onnx that labels these pictures too: what the mean of both is sure of is taught")
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--minutes", type=float, default=9.0, help="of training, all else comes on top (default: 9)")
    length.add_argument("--steps", type=int)
    parser.add_argument("--sizes", type=size_of, nargs="+", metavar="WxH", default=[(384, 288), (384, 288), (512, 384), (224, 192)],
                        help="of the input, batch by batch in turn; the first is what --batch is meant for "
                             "(default: 384x288 384x288 512x384 224x192)")
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--learning-rate", type=float, default=2e-3, help="the highest (default: 2e-3)")
    parser.add_argument("--encoder-rate", type=float, default=0.5, metavar="SHARE",
                        help="the contracting path's learning rate, as a share of the others' (default: 0.5)")
    parser.add_argument("--warm-up", type=int, default=150, metavar="STEPS")
    parser.add_argument("--weight-decay", type=float, default=0.03)
    parser.add_argument("--average", type=float, default=0.998, help="what a step leaves of the running mean (default: 0.998)")
    parser.add_argument("--class-weights", type=float, nargs=5, default=[1.0, 1.0, 1.5, 1.5, 1.5],
                        help="in the loss: background, person, chair, table, tv")
    parser.add_argument("--furniture-dice", type=float, default=0.0, metavar="WEIGHT",
                        help="in the loss, of the soft Dice loss of each of chair, table and tv; a person's is 0.5 (default: 0)")
    parser.add_argument("--coarse-share", type=float, default=0.1, help="weight in the loss of each of the coarse heads")
    parser.add_argument("--whole", type=float, default=0.4, help="how often a picture is shown whole (default: 0.4)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--measure-every", type=float, default=2.5, metavar="MINUTES")
    parser.add_argument("--save-every", type=float, default=1.0, metavar="MINUTES")
    arguments = parser.parse_args()
    for width, height in arguments.sizes:
        if width % multiple("mobile") or height % multiple("mobile"):
            parser.error(f"an input of {width}x{height}; expected multiples of {multiple('mobile')}")
    arguments.output.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    train(arguments)


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"train_gpu.py: {error}")
