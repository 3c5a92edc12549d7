# SPDX-License-Identifier: BSD-3-Clause
"""The commands of the pages, and what is to be done with each: run it, run something shorter, or leave it."""
import dataclasses
import pathlib
import re
import tomllib

import markdown


@dataclasses.dataclass(frozen=True)
class Command:
    page: str
    line: int
    text: str  # without comments at ends of lines; may have several lines


def commands_of(page: str, text: str) -> list[Command]:
    """The commands of a page's sh blocks, one by one: a line, with the lines that it goes on in; a loop is one."""
    found = []
    for block in markdown.blocks(text):
        if block.language not in ("sh", "bash", "shell", "console"):
            continue
        pending, begin = [], 0
        for number, line in enumerate(block.text.splitlines(), block.line):
            line = re.sub(r"(^|\s+)#\s.*$", "", line).rstrip()
            if not line and not pending:
                continue
            begin = begin if pending else number
            pending.append(line)
            whole = "\n".join(pending)
            opened = len(re.findall(r"^\s*(?:for|while|if)\b", whole, re.M))
            closed = len(re.findall(r"^\s*(?:done|fi)\b", whole, re.M))
            if line.endswith("\\") or opened > closed:
                continue
            found.append(Command(page, begin, whole))
            pending = []
        if pending:
            raise ValueError(f"{page}:{begin}: a command that never ends")
    return found


@dataclasses.dataclass
class Rule:
    """An entry of commands.toml: what is done with a command that is not run as it stands."""
    pattern: re.Pattern
    reason: str
    run: str | None  # what is run in its place; None: nothing
    used: bool = False


def read_rules(file: pathlib.Path) -> list[Rule]:
    """Each entry has `command` (the text) or `matches` (a regular expression), `reason`, and perhaps `run`."""
    rules = []
    for entry in tomllib.loads(file.read_text(encoding="utf-8"))["rule"]:
        unknown = entry.keys() - {"command", "matches", "reason", "run"}
        if unknown or not entry.get("reason") or ("command" in entry) == ("matches" in entry):
            raise ValueError(f"{file}: an entry needs command or matches, and reason: {entry}")
        pattern = entry.get("matches") or "^" + re.escape(entry["command"].strip()) + "$"
        rules.append(Rule(re.compile(pattern), entry["reason"], entry.get("run")))
    return rules


def rule_of(command: Command, rules: list[Rule]) -> Rule | None:
    for rule in rules:
        if rule.pattern.search(command.text):
            rule.used = True
            return rule
    return None
