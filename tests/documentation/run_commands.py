#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""run_commands.py ROOT WORK BUILD PROGRAM RULES: runs the commands of all pages, page by page, each page in a copy of
the repository that looks like a clone which was built. A command that fails, and a rule that is for no command any
more, are failures.

The copy holds build/bin/holdfast, and the variable HOLDFAST_BUILD names the folder where all is built. Commands run as
they stand, in order; the folder and the exported variables of one are those of the next one."""
import os
import pathlib
import shutil
import subprocess
import sys
import time

import markdown
import shell


def make_clone(root: pathlib.Path, folder: pathlib.Path, program: pathlib.Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(root, folder, ignore=lambda parent, names: [name for name in names
                                                                if markdown.is_made(pathlib.Path(parent, name))])
    (folder / "build/bin").mkdir(parents=True)
    (folder / "build/bin/holdfast").symlink_to(program)


def run_page(commands: list[shell.Command], rules: list[shell.Rule], folder: pathlib.Path,
             build: pathlib.Path, program: pathlib.Path) -> tuple[int, list[str]]:
    """Runs a page's commands; returns how many, and what went wrong."""
    environment = os.environ | {"PATH": f"{program.parent}:{os.environ['PATH']}", "HOLDFAST_BUILD": str(build)}
    state, done, problems = folder / ".state", 0, []
    state.write_text(f"cd '{folder}'\n")
    for command in commands:
        rule = shell.rule_of(command, rules)
        text = command.text if rule is None else rule.run
        if text is None:
            continue
        script = f". '{state}'\n{text}\n{{ echo \"cd '$PWD'\"; export -p; }} > '{state}'\n"
        begin = time.monotonic()
        result = subprocess.run(["sh", "-e", "-c", script], env=environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
        done += 1
        note = "" if rule is None else f"   [instead of: {command.text}]"
        print(f"{time.monotonic() - begin:6.1f} s  {command.page}:{command.line}: {text.strip()}{note}", flush=True)
        if result.returncode != 0:
            problems.append(f"{command.page}:{command.line}: exit code {result.returncode} of: {text}\n{result.stdout}")
            break  # what follows would stand on what is not there
    return done, problems


def main() -> int:
    root, work, build, program, rules_file = (pathlib.Path(argument).resolve() for argument in sys.argv[1:6])
    rules = shell.read_rules(rules_file)
    done, problems, everything = 0, [], []
    for page in markdown.pages(root):
        name = page.relative_to(root).as_posix()
        commands = shell.commands_of(name, page.read_text(encoding="utf-8"))
        everything += commands
        chosen = [shell.rule_of(command, rules) for command in commands]
        if all(rule is not None and rule.run is None for rule in chosen):
            continue
        folder = work / name.replace("/", "_").removesuffix(".md")
        make_clone(root, folder, program)
        count, wrong = run_page(commands, rules, folder, build, program)
        done, problems = done + count, problems + wrong
        if not wrong:
            shutil.rmtree(folder)
    problems += [f"{rules_file.name}: no page has this command any more: {rule.pattern.pattern}"
                 for rule in rules if not rule.used]
    print("\n".join(problems) or f"{len(everything)} commands: {done} run, {len(everything) - done} listed")
    return 1 if problems or done < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
