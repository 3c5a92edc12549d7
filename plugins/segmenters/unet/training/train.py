#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Train the U-Net on a pack.

Writes into --output: weights.npz (averaged over the last steps, for export.py), checkpoint.pt (to go on after an
interruption, --resume), log.csv and curves.png.  Progressive training is several runs, each with --start-from the one
before: a short way to good weights is small pictures first, for long, then larger ones.

Example
  train.py pack.npz --output out/coarse --width 128 --height 96 --minutes 60
  train.py pack.npz --output out/base --start-from out/coarse/weights.npz --learning-rate 5e-4 --minutes 60
"""
import argparse
import copy
import csv
import itertools
import math
import pathlib
import sys
import time

import torch
from torch.nn import functional

from classes import CLASSES, IGNORED, NOT_PERSON, PERSON, TOLD_APART, is_other_thing
from curves import draw_curves
from measure import Validation
from model import SIZES, make_model, multiple
from mobile_unet import MobileUNet
from pack import PackError, read_pack
from pretrained import load_encoder
from samples import DEVIATION, Samples
from weights import in_order, load_onnx, load_weights, save_weights, with_normalisation


PRESETS = {
    # Zeng et al., Remote Sensing 2023, 15, 5479, section 4.1.
    "paper": dict(size="paper", optimizer="adam", learning_rate=1e-4, weight_decay=2e-5, batch=8, dropout=0.1,
                  class_weights=[1.0, 1.0, 1.0, 1.0, 1.0]),
}


def soft_dice(scores, labels, label=PERSON):
    """1 - dice coefficient of a class, pixels of a batch together."""
    known = labels != IGNORED
    if label != PERSON:
        known = known & (labels != NOT_PERSON)
    own = ((labels == label) & known).float()
    probability = torch.softmax(scores, 1)[:, label] * known.float()
    return 1.0 - (2.0 * (probability * own).sum() + 1.0) / (probability.sum() + own.sum() + 1.0)


def class_loss(scores, labels, class_weights):
    """Cross entropy; furniture of no known class only must not be a person."""
    known = torch.where(labels == NOT_PERSON, IGNORED, labels)
    loss = functional.cross_entropy(scores, known, class_weights, ignore_index=IGNORED)
    vague = labels == NOT_PERSON
    if vague.any():
        others = torch.cat([scores[:, :PERSON], scores[:, PERSON + 1:]], 1)
        surprise = (torch.logsumexp(scores, 1) - torch.logsumexp(others, 1))[vague]
        loss = loss + surprise.sum() / (known != IGNORED).sum()
    return loss


def training_loss(outputs, labels, class_weights, coarse_share, furniture_dice=0.0):
    fine = functional.interpolate(outputs[0], size=labels.shape[1:], mode="bilinear", align_corners=False)
    own_labels = torch.where(is_other_thing(labels), 0, labels)
    loss = class_loss(fine, own_labels, class_weights) + 0.5 * soft_dice(fine, own_labels)
    for label in range(PERSON + 1, len(CLASSES)) if furniture_dice else ():
        loss = loss + furniture_dice * soft_dice(fine, own_labels, label)
    told_apart = torch.cat([class_weights, class_weights.new_ones(TOLD_APART - len(CLASSES))])
    for scores in outputs[1:] if coarse_share else []:
        step = labels.shape[1] // scores.shape[2]
        coarse_labels = labels[:, step // 2::step, step // 2::step]
        loss = loss + coarse_share * class_loss(scores, coarse_labels, told_apart)
    return loss


class Training:
    """Everything that changes while training; what a checkpoint holds."""

    def __init__(self, arguments, first_batches):
        torch.manual_seed(arguments.seed)
        self.input_size = (arguments.width, arguments.height)
        self.model = make_model(arguments.size, arguments.dropout)
        if arguments.start_from:
            self.start_from(arguments.start_from, first_batches)
        self.normalisation_is_kept = arguments.keep_normalisation
        if arguments.keep_blocks:
            if not isinstance(self.model, MobileUNet):
                raise PackError(f"--keep-blocks with size '{arguments.size}', expected with --size mobile")
            for part in [self.model.stem, *self.model.down[:arguments.keep_blocks]]:
                part.requires_grad_(False)
        self.model = self.model.to(memory_format=torch.channels_last)
        self.average = copy.deepcopy(self.model.state_dict())
        encoder = [value for part in (self.model.stem, self.model.down) for value in part.parameters()
                   if value.requires_grad]
        known = set(encoder)
        others = [value for value in self.model.parameters() if value.requires_grad and value not in known]
        kind = {"adamw": torch.optim.AdamW, "adam": torch.optim.Adam}[arguments.optimizer]
        self.optimizer = kind([dict(params=encoder, share=arguments.encoder_rate), dict(params=others, share=1.0)],
                              lr=arguments.learning_rate, betas=(0.9, 0.999), weight_decay=arguments.weight_decay,
                              foreach=True)
        self.step, self.seconds = 0, 0.0

    def start_from(self, path, first_batches):
        if path.suffix == ".tflite":
            if not isinstance(self.model, MobileUNet):
                raise PackError(f"{path}: holds weights of MobileNetV2, expected with --size mobile")
            layers = load_encoder(self.model, path, DEVIATION / 0.5)
            with_normalisation(self.model, first_batches, layers)
            return
        exported = path.suffix == ".onnx"
        weights = load_onnx(path) if exported else load_weights(path)[0]
        if exported:
            weights = with_normalisation(weights, first_batches, in_order(weights))
        if weights.size != self.model.size:
            raise PackError(f"{path}: holds size '{weights.size}', expected '{self.model.size}'")
        self.model.load_state_dict(weights.state_dict())

    def train_mode(self):
        self.model.train()
        if self.normalisation_is_kept:
            for part in self.model.modules():
                if isinstance(part, torch.nn.BatchNorm2d):
                    part.eval()

    def average_weights(self, fraction=0.999):
        """Running mean over the steps: smoother, and better, than the last step's weights."""
        keep = min(fraction, (1.0 + self.step) / (10.0 + self.step))
        averages, values = [], []
        for name, value in self.model.state_dict().items():
            if value.dtype.is_floating_point:
                averages.append(self.average[name])
                values.append(value)
        torch._foreach_mul_(averages, keep)
        torch._foreach_add_(averages, values, alpha=1.0 - keep)

    def averaged_model(self):
        model = copy.deepcopy(self.model)
        model.load_state_dict(self.average)
        return model.eval()

    def save(self, folder):
        state = dict(model=self.model.state_dict(), average=self.average, optimizer=self.optimizer.state_dict(),
                     step=self.step, seconds=self.seconds, size=self.model.size, input_size=self.input_size)
        torch.save(state, folder / "checkpoint.part")
        (folder / "checkpoint.part").replace(folder / "checkpoint.pt")
        save_weights(folder / "weights.npz", self.average, self.model.size, self.input_size)

    def load(self, path):
        state = torch.load(path)
        if (state["size"], tuple(state["input_size"])) != (self.model.size, self.input_size):
            raise PackError(f"{path}: is of size '{state['size']}' with an input of {state['input_size']}; expected "
                            f"'{self.model.size}' and {self.input_size}, as this run says")
        self.model.load_state_dict(state["model"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.average, self.step, self.seconds = state["average"], state["step"], state["seconds"]


class Log:
    """log.csv: one row for each measurement."""

    def __init__(self, path, goes_on):
        self.path, self.header_is_written = path, goes_on and path.exists()

    def add(self, row):
        with open(self.path, "a" if self.header_is_written else "w", newline="") as file:
            writer = csv.DictWriter(file, row.keys())
            if not self.header_is_written:
                writer.writeheader()
            writer.writerow(row)
        self.header_is_written = True


def learning_rate(progress, step, highest, warm_up):
    """Warm-up over some steps, then half a cosine down to a hundredth."""
    return highest * min(1.0, (step + 1) / max(warm_up, 1)) * (0.01 + 0.99 * 0.5 * (1.0 + math.cos(math.pi * min(progress, 1.0))))


def train(arguments):
    torch.set_num_threads(arguments.threads)
    training_entries, held_out = read_pack(arguments.pack)
    sizes = [(arguments.width, arguments.height)]
    if arguments.also:
        sizes = sizes * 2 + arguments.also

    def batches_from(step):
        samples = Samples(training_entries, sizes, arguments.batch, arguments.seed, step * arguments.batch,
                          arguments.whole, arguments.shares, arguments.room_roll, arguments.nobody)
        return iter(torch.utils.data.DataLoader(samples, arguments.batch, num_workers=arguments.workers))

    training = Training(arguments, (pictures for pictures, _ in itertools.islice(batches_from(0), 24)))
    checkpoint = arguments.output / "checkpoint.pt"
    if arguments.resume and checkpoint.exists():
        training.load(checkpoint)
        print(f"goes on at step {training.step}", flush=True)
    batches = batches_from(training.step)
    validation = Validation(training_entries, held_out)
    class_weights = torch.tensor(arguments.class_weights)
    log = Log(arguments.output / "log.csv", arguments.resume)

    def progress():
        return training.step / arguments.steps if arguments.steps else training.seconds / (60.0 * arguments.minutes)

    mean_loss, count = 0.0, 0
    started, measured_at, saved_at = time.monotonic() - training.seconds, training.seconds, training.seconds
    while progress() < 1.0:
        rate = learning_rate(progress(), training.step, arguments.learning_rate, arguments.warm_up)
        for group in training.optimizer.param_groups:
            group["lr"] = rate * group["share"]
        pictures, labels = next(batches)
        training.train_mode()
        training.optimizer.zero_grad(set_to_none=True)
        with torch.autocast("cpu", torch.bfloat16, enabled=arguments.precision == "bf16"):
            outputs = training.model(pictures.contiguous(memory_format=torch.channels_last))
        outputs = [scores.float() for scores in outputs]
        loss = training_loss(outputs, labels, class_weights, arguments.coarse_share)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(training.model.parameters(), 5.0)
        training.optimizer.step()
        training.step += 1
        training.average_weights()
        mean_loss, count = mean_loss + loss.item(), count + 1
        training.seconds = time.monotonic() - started
        last = progress() >= 1.0
        if last or training.seconds - measured_at >= 60.0 * arguments.measure_every:
            model = training.averaged_model()
            figures = validation(model, training.input_size)
            for size in arguments.also:
                prefix = f"{size[0]}x{size[1]}_"
                figures.update({prefix + name: value for name, value in validation(model, size).items()})
            row = dict(step=training.step, minutes=round(training.seconds / 60, 2), learning_rate=f"{rate:.2e}",
                       loss=round(mean_loss / count, 4), **{name: round(float(v), 4) for name, v in figures.items()})
            print("  ".join(f"{name} {value}" for name, value in row.items()), flush=True)
            log.add(row)
            draw_curves([log.path], arguments.output / "curves.png")
            mean_loss, count, measured_at = 0.0, 0, time.monotonic() - started
        if last or training.seconds - saved_at >= 60.0 * arguments.save_every:
            training.save(arguments.output)
            saved_at = time.monotonic() - started


class Shares(argparse.Action):
    """SOURCE=SHARE ... as a dictionary."""

    def __call__(self, parser, namespace, values, option_string=None):
        try:
            pairs = [value.split("=") for value in values]
            setattr(namespace, self.dest, {source: float(share) for source, share in pairs})
        except ValueError:
            parser.error(f"{option_string} {' '.join(values)}; expected SOURCE=SHARE, such as nyu=0.15")


def size_of(text):
    try:
        width, height = (int(part) for part in text.split("x"))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}' is no size; expected WIDTHxHEIGHT, such as 160x128") from error
    return width, height


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pack", type=pathlib.Path, help="pictures and labels, from prepare.py")
    parser.add_argument("--output", type=pathlib.Path, required=True, help="folder of this run")
    parser.add_argument("--size", choices=SIZES, default="mobile")
    parser.add_argument("--width", type=int, help="of the input [px] (default: as the size ships with)")
    parser.add_argument("--height", type=int)
    parser.add_argument("--also", type=size_of, nargs="+", default=[], metavar="WxH",
                        help="after every two batches, one of each of these sizes follows, for weights that are good at all "
                             "of them, such as 160x128")
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--minutes", type=float, default=60.0, help="length of the run (default: 60)")
    length.add_argument("--steps", type=int, help="length of the run, exactly repeatable")
    parser.add_argument("--start-from", type=pathlib.Path,
                        help="weights.npz of an earlier run, unet.onnx as export.py writes it, or a .tflite file with "
                             "MobileNetV2's weights for the contracting path of --size mobile")
    parser.add_argument("--preset", choices=PRESETS, help="other defaults; paper: those of Zeng et al. 2023, for a GPU")
    parser.add_argument("--resume", action="store_true", help="go on from the checkpoint in --output, if there is one")
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--learning-rate", type=float, default=1.5e-3, help="the highest (default: 1.5e-3)")
    parser.add_argument("--warm-up", type=int, default=200, metavar="STEPS",
                        help="steps in which the learning rate rises (default: 200)")
    parser.add_argument("--encoder-rate", type=float, default=1.0, metavar="SHARE",
                        help="the contracting path's learning rate, as a share of the others' (default: 1)")
    parser.add_argument("--optimizer", choices=("adamw", "adam"), default="adamw")
    parser.add_argument("--weight-decay", type=float, default=1e-2,
                        help="with adamw decoupled from the gradient (default: 1e-2)")
    parser.add_argument("--dropout", type=float, default=0.1)
    parser.add_argument("--class-weights", type=float, nargs=5, default=[1.0, 1.3, 1.0, 1.0, 1.0],
                        help="in the loss: background, person, chair, table, tv")
    parser.add_argument("--coarse-share", type=float, default=0.2,
                        help="weight in the loss of each of the coarse heads; an ONNX file holds none, so that they would "
                             "disturb a short run from it: 0 (default: 0.2)")
    parser.add_argument("--whole", type=float, default=0.25,
                        help="how often a picture is shown whole, not a part of it (default: 0.25; in a last run 0.5)")
    parser.add_argument("--shares", nargs="+", action=Shares, metavar="SOURCE=SHARE",
                        help="how often samples are of a source of the pack, or 'composed' (default: see samples.py)")
    parser.add_argument("--room-roll", type=float, default=0.0, metavar="DEGREES",
                        help="standard deviation of the roll in half of the pictures of rooms, which are blurred twice as "
                             "often then; 0 = as all pictures (default: 0)")
    parser.add_argument("--nobody", type=float, default=0.0, metavar="SHARE",
                        help="how often a sample is a near, tilted, dark or blurred view of a picture without people; the "
                             "others are blurred more, too (default: 0)")
    parser.add_argument("--keep-blocks", type=int, default=0, metavar="COUNT",
                        help="the stem and the first blocks of the contracting path of --size mobile, which cost most of "
                             "the time, keep their weights (default: 0)")
    parser.add_argument("--keep-normalisation", action="store_true",
                        help="batch normalisation keeps its mean and variance: for small rates and batches")
    parser.add_argument("--precision", choices=("fp32", "bf16"), default="fp32",
                        help="bf16 computes convolutions with 16 bits, the weights stay as they are: several times faster "
                             "on processors with AVX512_BF16, slower on others (default: fp32)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1, help="processes that make samples (default: 1; 0 = none)")
    parser.add_argument("--measure-every", type=float, default=4.0, metavar="MINUTES")
    parser.add_argument("--save-every", type=float, default=4.0, metavar="MINUTES")
    preset = parser.parse_known_args()[0].preset
    if preset:
        parser.set_defaults(**PRESETS[preset])
    arguments = parser.parse_args()
    arguments.width = arguments.width or SIZES[arguments.size][1][0]
    arguments.height = arguments.height or SIZES[arguments.size][1][1]
    unit = multiple(arguments.size)
    for width, height in [(arguments.width, arguments.height), *arguments.also]:
        if width % unit or height % unit:
            parser.error(f"an input of {width}x{height}; expected multiples of {unit}")
    arguments.output.mkdir(parents=True, exist_ok=True)
    train(arguments)


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"train.py: {error}")
