#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_settings.py ROOT PROGRAM: what a header says of a parameter agrees with the row of its parameter table, from
which help and reference come. Of both texts are checked

- the unit: "[m]" in the comment is unit("m") of the row;
- special values: "0 = off" stands in both texts or in neither; the help explains every value that the comment explains,
  and the range contains it;
- the default, which is the initial value of the member alone: "1000 as in ORB-SLAM2" must be it, and "default: 1000"
  says it twice;
- "required", which must be true."""
import json
import pathlib
import re
import subprocess
import sys
from dataclasses import dataclass

TEXT = r'"(?:[^"\\]|\\.)*"'
NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
ROW = re.compile(rf"\.\s*add\(\s*({TEXT})\s*,\s*&(\w+)::(\w+)\s*,\s*((?:{TEXT}\s*)+)\)")
STRUCT = re.compile(r"^struct (\w+)[^;{]*\{\n(.*?)^\};", re.S | re.M)
DECLARATION = re.compile(r"(?!using|static|return|constexpr)[\w:]+(?:<[^;=(]*>)? ([^;()]+?|[^;()]+ = [^;]+);$")
SPECIAL = re.compile(rf"(?<![\w.=*/+-])(?<!to )({NUMBER}) ?(?:=|:(?= )) ?(?=[a-z])(?!chi-square)")
AS_IN = re.compile(rf"(?<![\w.-])({NUMBER}) as in [A-Z]")
UNIT = re.compile(r"\[([^\]]+)\](?=$|[;.:,)])")  # that of the value ends its clause


@dataclass
class Row:
    """table.add("count", &OrbSettings::count, "help")"""

    struct: str
    member: str
    name: str
    help: str


@dataclass
class Member:
    place: str
    comment: str


def text_of(literals: str) -> str:
    return "".join(json.loads(literal) for literal in re.findall(TEXT, literals))


def rows_of(code: str) -> list[Row]:
    rows = []
    for row in ROW.finditer(code):
        aliases = dict(re.findall(r"using (\w+) = (\w+);", code[:row.start()]))  # the last one counts
        rows.append(Row(aliases.get(row[2], row[2]), row[3], text_of(row[1]), text_of(row[4])))
    return rows


def members_of(name: str, code: str) -> dict[tuple[str, str], Member]:
    """The members of all structs of a file, by struct and name."""
    members: dict[tuple[str, str], Member] = {}
    for struct in STRUCT.finditer(code):
        before, declaration, last = "", "", []
        for number, line in enumerate(struct[2].split("\n"), code.count("\n", 0, struct.start(2)) + 1):
            statement, _, behind = (part.strip() for part in line.partition("///<"))
            if not statement and behind:
                for member in last:
                    member.comment += " " + behind
            elif statement.startswith("///"):
                before += " " + statement[3:].strip()
            elif statement and not statement.startswith("//"):
                declaration += " " + statement
                if behind or statement.endswith((";", "{", "}")):
                    found = DECLARATION.match(declaration.strip())
                    names = re.findall(r"(\w+)(?: = [^,]*|\{[^}]*\})?(?:, |$)", found[1]) if found else []
                    last = [Member(f"{name}:{number}", (before + " " + behind).strip()) for _ in names]
                    members |= {(struct[1], each): member for each, member in zip(names, last)}
                    before = declaration = ""
    return members


def explained(text: str) -> set[float]:
    return {float(value) for value in SPECIAL.findall(re.sub(r"\{.*?\}", "", text))}  # { 255: unknown }


def disagreements(comment: str, parameter: dict) -> list[str]:
    found = []
    help_text, default = parameter["help"], parameter["default"]
    unit = UNIT.search(comment)
    if unit and not f"{unit[1]} ".startswith(parameter["unit"] + " "):
        found.append(f"its unit is [{parameter['unit']}], not [{unit[1]}]")
    if not explained(comment) <= explained(help_text):
        found.append(f"the help does not explain {explained(comment) - explained(help_text)}")
    if comment and 0.0 in explained(help_text) - explained(comment):
        found.append("the help explains 0, the comment does not")
    low, high = (parameter[bound] for bound in ("minimum", "maximum"))
    for value in explained(comment) | explained(help_text):
        if (low is not None and value < low) or (high is not None and value > high):
            found.append(f"the range from {low} to {high} excludes {value:g}, which is explained")
    for text in (comment, help_text):
        found += [f"its default is {default}, not {value}" for value in AS_IN.findall(text) if float(value) != default]
        if re.search(rf"\b[Dd]efault(?: is|:)? {NUMBER}", text):
            found.append("a text repeats the default")
    if re.search(r"\brequired$", comment) and not parameter["required"]:
        found.append("it is not required")
    return found


def problems_of(root: pathlib.Path, modules: list[dict]) -> tuple[list[str], int]:
    rows, members = [], {}
    for top in ("include", "modules", "plugins"):
        for file in sorted((root / top).rglob("*.[ch]pp")):
            code = file.read_text(encoding="utf-8")
            rows += rows_of(code)
            members |= members_of(str(file.relative_to(root)), code)
    parameters: dict[tuple[str, str], list[dict]] = {}
    for each in (each for module in modules for each in module["parameters"]):
        parameters.setdefault((each["name"], each["help"]), []).append(each)
    problems, count = [], 0
    for row in rows:
        member, described = members.get((row.struct, row.member)), parameters.get((row.name, row.help))
        if member is None or described is None:
            continue  # a row of several structs, or of a module that this build leaves out
        count += 1
        problems += [f"{member.place}: {row.struct}::{row.member}: {problem}"
                     for problem in min((disagreements(member.comment, each) for each in described), key=len)]
    return problems, count


if __name__ == "__main__":
    answer = subprocess.run([sys.argv[2], "modules", "--json"], capture_output=True, check=True).stdout
    wrong, compared = problems_of(pathlib.Path(sys.argv[1]), json.loads(answer))
    print("\n".join(wrong) or f"the texts of {compared} parameters agree")
    # Guards against a reader that finds nothing and therefore nothing wrong.
    sys.exit(1 if wrong or compared < 400 else 0)
