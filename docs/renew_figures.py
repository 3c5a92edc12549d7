#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the figures of the pages anew, and compares or replaces them. docs/figures.toml lists the figures and the
runs that they come from. Sequential runs give the same bytes on every machine with the same build, so that a figure is
compared as it is printed. Times are no figures of this kind and are left as they are.

  docs/renew_figures.py                    measures everything (half an hour on one core); exit code 1 if a figure differs
  docs/renew_figures.py --write            the same, and writes the measured figures into the pages
  docs/renew_figures.py --only 'scene_*'   measures only the runs with such names, and compares what depends on them alone
  docs/renew_figures.py --find             measures nothing: says whether every figure of the list is found in its page
"""
import argparse
import dataclasses
import fnmatch
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import textwrap
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
NUMBER = r"-?[0-9]+(?:\.[0-9]+)?"
FIELD = re.compile(r"<([\w.+-]+):(\.\d+f)>")
WIDTH = 150  # of a quotation that is written anew


class PageError(Exception):
    """A page, or the list of figures, is not as expected."""


@dataclasses.dataclass(frozen=True)
class Run:
    name: str
    command: str
    needs: str = ""  # an environment variable without which it cannot be made


@dataclasses.dataclass(frozen=True)
class Figure:
    """Text of a page with fields "<RUN.VALUE:.4f>" in place of its numbers. "..." stands for anything within a line."""
    page: str
    text: str

    def runs(self) -> set[str]:
        return {name.partition(".")[0] for name, _ in FIELD.findall(self.text)}


@dataclasses.dataclass(frozen=True)
class Quotation:
    """A paragraph, a list item or a table of a file that a run writes, and that the page quotes. Both begin with the same
    text, in the file after another one if it is given."""
    page: str
    run: str
    file: str
    begins: str
    after: str = ""

    def runs(self) -> set[str]:
        return {self.run}


def expanded(entries: list[dict]) -> list[dict]:
    """An entry with a list `each` stands for one entry per element, in which {each} is replaced."""
    result = []
    for entry in entries:
        entry = dict(entry)
        for each in entry.pop("each", [""]):
            result.append({key: value.replace("{each}", each) for key, value in entry.items()})
    return result


def read_list(file: pathlib.Path) -> tuple[dict[str, Run], list, list[str]]:
    """The runs by name, the figures and quotations, and the commands that come before the runs."""
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    runs = {entry["name"]: Run(**entry) for entry in expanded(content.get("run", []))}
    figures = [Figure(**entry) for entry in expanded(content.get("figure", []))]
    figures += [Quotation(**entry) for entry in expanded(content.get("quotation", []))]
    for figure in figures:
        for name in figure.runs() - runs.keys():
            raise PageError(f"{file.name}: there is no run '{name}', which a figure of {figure.page} comes from")
    return runs, figures, content.get("prepare", [])


def pattern_of(text: str) -> re.Pattern:
    """The numbers of the fields are the groups. A page may break a line wherever there is a blank."""
    parts, end = [], 0

    def literal(piece: str) -> str:
        pieces = [re.escape(part) for part in piece.split("...")]
        return re.sub(r"(?:\\?\s)+", r"\\s+(?:> )?", r"[^\n]*?".join(pieces))

    for field in FIELD.finditer(text):
        parts += [literal(text[end:field.start()]), f"({NUMBER})"]
        end = field.end()
    return re.compile("".join(parts) + literal(text[end:]))


def find(page: str, figure: Figure) -> re.Match:
    found = list(pattern_of(figure.text).finditer(page))
    if len(found) != 1:
        raise PageError(f"{figure.page}: found {len(found)} times, expected once: {figure.text}")
    return found[0]


def measured_text(field: re.Match | tuple[str, str], values: dict[str, dict[str, float]]) -> str:
    name, form = field
    run, _, key = name.partition(".")
    if key not in values[run]:
        raise PageError(f"the run '{run}' has no value '{key}'; expected one of {', '.join(sorted(values[run]))}")
    return format(values[run][key], form)


def renewed(page: str, figure: Figure, values: dict[str, dict[str, float]]) -> tuple[str, list[str]]:
    """The page with the measured figures, and what differed."""
    match, changes = find(page, figure), []
    fields = FIELD.findall(figure.text)
    for group in range(len(fields), 0, -1):  # from the end, so that the places of the others stay
        text = measured_text(fields[group - 1], values)
        if text == match[group]:
            continue
        line = page.count("\n", 0, match.start(group)) + 1
        changes.insert(0, f"{figure.page}:{line}: {fields[group - 1][0]} is {match[group]}, measured {text}")
        page = page[:match.start(group)] + text + page[match.end(group):]
    return page, changes


def paragraph(text: str, begins: str, where: str) -> tuple[int, int]:
    """Begin and end of the lines of the paragraph, list item, table or quotation that begins so; the first one counts."""
    found = re.search(rf"^(?:> |- )?{re.escape(begins)}", text, re.M)
    if found is None:
        raise PageError(f"{where}: found no paragraph that begins with: {begins}")
    end = re.compile(r"^(?:>?[ \t]*$|- )", re.M).search(text, found.end())
    return found.start(), end.start() if end else len(text)


def plain(text: str) -> str:
    return " ".join(re.sub(r"^(?:> ?|- )", "", text, flags=re.M).split())


def requoted(page: str, quotation: Quotation, source: str) -> tuple[str, list[str]]:
    """The page with the paragraph as the source has it, and what differed."""
    begin, end = paragraph(page, quotation.begins, quotation.page)
    _, after, source = source.partition(quotation.after) if quotation.after else ("", "", source)
    source_begin, source_end = paragraph(source, quotation.begins, quotation.file)
    here, there = page[begin:end], source[source_begin:source_end].rstrip("\n") + "\n"
    if plain(here) == plain(there):
        return page, []
    if here.startswith("> "):
        lines = textwrap.wrap(plain(there), WIDTH - 2, break_long_words=False, break_on_hyphens=False)
        there = "".join(f"> {line}\n" for line in lines)
    line = page.count("\n", 0, begin) + 1
    change = f"{quotation.page}:{line}: the text is\n{here}and {quotation.run}/{quotation.file} says\n{there}"
    return page[:begin] + there + page[end:], [change]


def values_of_run(content: dict) -> dict[str, float]:
    """The figures in a run.json."""
    frames, evaluation = content["frames"], content["evaluation"] or {}
    values = {name: float(frames[name]) for name in ("fed", "expected", "poses", "lost", "recovered", "relocalised")}
    values |= {"coverage": 100.0 * frames["coverage"], "missing": 100.0 * (1.0 - frames["coverage"]),
               "keyframes": float(content["map"]["keyframes"]), "points": float(content["map"]["points"]),
               "inliers": content["mean_inliers"], "loops": float(len(content["loops"]["closed"]))}
    if evaluation:
        per_time = evaluation["rpe_per_time"]
        values |= {"ate": evaluation["ate_m"]["rmse"], "rpe": per_time["translation_m"]["rmse"],
                   "rpe_deg": per_time["rotation_deg"]["rmse"], "pairs": float(evaluation["pairing"]["pairs"]),
                   "path": evaluation["pairing"]["true_path_m"]}
    return {key: value for key, value in values.items() if value is not None}


def values_of_bench(content: dict) -> dict[str, float]:
    """What a results.json says of every comparison of the ATE, "BEFORE.AFTER.better" and so on, and of every cell:
    "VARIANT.SEQUENCE.ate" and "VARIANT.SEQUENCE.missing", the frames without a pose in per cent."""
    names = [variant["name"] for variant in content["variants"]]
    values = {}
    for each in content["comparisons"]:
        if each["quantity"] == "ATE":
            place = f"{names[each['before']]}.{names[each['after']]}"
            values |= {f"{place}.{key}": float(each[key]) for key in ("better", "worse", "p", "p_holm")
                       if each[key] is not None}
    for cell in content["cells"]:
        place = f"{names[cell['variant']]}.{content['sequences'][cell['sequence']]['name']}"
        if (ate := cell["errors"]["ate_m"]["rmse"]["median"]) is not None:
            values[f"{place}.ate"] = ate
        values[f"{place}.missing"] = 100.0 * (1.0 - cell["coverage"]["median"])
    return values


def values_of_segmentation(content: dict) -> dict[str, float]:
    """The IoU of every class in what `holdfast evaluate-segmentation --json` writes: "iou.CLASS"."""
    return {f"iou.{each['name']}": each["iou"] for each in content["classes"] if each["iou"] is not None}


READERS = {"run.json": values_of_run, "results.json": values_of_bench, "segmentation.json": values_of_segmentation}


def values_in(folder: pathlib.Path) -> dict[str, float]:
    for name, reader in READERS.items():
        if (folder / name).exists():
            return reader(json.loads((folder / name).read_text(encoding="utf-8")))
    raise PageError(f"{folder}: expected one of {', '.join(READERS)}")


def execute(words: list[str], log: pathlib.Path, environment: dict[str, str]) -> None:
    with log.open("w", encoding="utf-8") as stream:
        code = subprocess.run(words, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=stream,
                              stderr=subprocess.STDOUT).returncode
    if code != 0:
        tail = "".join(log.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)[-20:])
        raise PageError(f"exit code {code} of: {shlex.join(words)}\n{tail}")


def measure(run: Run, arguments: argparse.Namespace, environment: dict[str, str]) -> dict[str, float] | None:
    """The values of a run; None where its data is missing. {out} in its command is the folder of its results."""
    if run.needs and not environment.get(run.needs):
        print(f"skipped: {run.name} needs the folder {run.needs}", flush=True)
        return None
    folder = arguments.work / run.name
    if not arguments.reuse or not any((folder / name).exists() for name in READERS):
        print(f"measuring {run.name}", flush=True)
        subprocess.run(["rm", "-rf", str(folder)], check=True)
        command = run.command.replace("{out}", shlex.quote(str(folder)))
        execute(["sh", "-ec", command], arguments.work / f"{run.name}.log", environment)
    return values_in(folder)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", help="folder of the build (default: build)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/figures", help="folder for the runs")
    parser.add_argument("--only", action="append", metavar="PATTERN", help="of the names of runs; may be repeated")
    parser.add_argument("--reuse", action="store_true", help="take the results that are in the folder for the runs")
    parser.add_argument("--write", action="store_true", help="write measured figures into the pages")
    parser.add_argument("--find", action="store_true", help="only look for the figures in the pages")
    arguments = parser.parse_args()
    arguments.build, arguments.work = arguments.build.resolve(), arguments.work.resolve()
    runs, figures, prepare = read_list(ROOT / "docs/figures.toml")
    environment = os.environ | {"PATH": f"{arguments.build}/bin:{os.environ['PATH']}", "BUILD": str(arguments.build),
                                "WORK": str(arguments.work)}
    chosen = [run for name, run in runs.items()
              if any(fnmatch.fnmatch(name, pattern) for pattern in arguments.only or ["*"])]
    values: dict[str, dict[str, float]] = {}
    if not arguments.find:
        arguments.work.mkdir(parents=True, exist_ok=True)
        if not arguments.reuse and any("$WORK" in run.command for run in chosen):
            for command in prepare:
                execute(["sh", "-ec", command], arguments.work / "prepare.log", environment)
        for run in chosen:
            measured = measure(run, arguments, environment)
            if measured is not None:
                values[run.name] = measured
    problems, compared = [], 0
    for figure in figures:
        file = ROOT / figure.page
        before = file.read_text(encoding="utf-8")
        if not figure.runs() <= values.keys():
            paragraph(before, figure.begins, figure.page) if isinstance(figure, Quotation) else find(before, figure)
            continue
        if isinstance(figure, Quotation):
            source = (arguments.work / figure.run / figure.file).read_text(encoding="utf-8")
            after, changes = requoted(before, figure, source)
        else:
            after, changes = renewed(before, figure, values)
        compared += 1
        problems += changes
        if arguments.write and after != before:
            file.write_text(after, encoding="utf-8")
    print("\n".join(problems) or f"{len(figures)} texts with figures: all are found in their pages, {compared} were measured"
          " and are the same")
    return 1 if problems and not arguments.write else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except PageError as error:
        sys.exit(f"error: {error}")
