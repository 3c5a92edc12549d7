#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_blocks.py ROOT PROGRAM [CXX ARGUMENT ...]: the blocks of the pages that are not commands.

- A block after the line <!-- file: PATH --> is that file of the repository, to the letter; after <!-- file: PATH part
  --> it is a part of it. What holds for such files is tested where they are used; plugins have 30 lines
  at most, an extractor of features 40.
- Any other YAML block with source, features and optimizer is a whole configuration, and `holdfast check` accepts it.
- Any other C++ block with an #include is a whole file, and compiles (without linking) by the given compiler."""
import pathlib
import re
import subprocess
import sys
import tempfile

import markdown

MARKER = re.compile(r"<!--\s*file:\s*(\S+?)(\s+part)?\s*-->\s*$")


def check_file(root: pathlib.Path, where: str, block: markdown.Block, marker: re.Match) -> list[str]:
    file = root / marker[1]
    if not file.is_file():
        return [f"{where}: there is no file {marker[1]}"]
    # The licence line on top of every file need not stand in the page.
    whole = re.sub(r"\A(?://|#) SPDX-License-Identifier: .*\n", "", file.read_text(encoding="utf-8"))
    text = re.sub(r"\A(?://|#) SPDX-License-Identifier: .*\n", "", block.text)
    if (marker[2] is None and text != whole) or text not in whole:
        return [f"{where}: the block differs from {marker[1]}; the file says\n{whole}"]
    return []


def check_length(root: pathlib.Path) -> list[str]:
    """What a stranger writes is short: the plugins that the pages show."""
    problems = []
    for file in sorted(root.glob("examples/plugins/*/*.cpp")):
        most = 40 if "FeatureExtractor" in file.read_text(encoding="utf-8") else 30
        lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not re.match(r"\s*(//.*)?$", line)]
        if len(lines) > most:
            problems.append(f"{file.relative_to(root)}: {len(lines)} lines of code; the pages promise {most} at most")
    return problems


def check_configuration(program: str, where: str, text: str) -> list[str]:
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(text)
        file.flush()
        result = subprocess.run([program, "check", file.name, "--without-data"], capture_output=True, text=True)
    return [] if result.returncode == 0 else [f"{where}: {result.stdout}{result.stderr}"]


def check_source(compiler: list[str], where: str, text: str) -> list[str]:
    result = subprocess.run([*compiler, "-fsyntax-only", "-x", "c++", "-"], input=text, capture_output=True, text=True)
    return [] if result.returncode == 0 else [f"{where}: does not compile:\n{result.stderr}"]


def main() -> int:
    root, program, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3:]
    problems, files, configurations, sources = check_length(root), 0, 0, 0
    for page in markdown.pages(root):
        text = page.read_text(encoding="utf-8")
        lines = text.splitlines()
        for block in markdown.blocks(text):
            where = f"{page.relative_to(root)}:{block.line}"
            marker = MARKER.match(lines[block.line - 3]) if block.line >= 3 else None
            if marker:
                files += 1
                problems += check_file(root, where, block, marker)
            elif block.language == "yaml" and all(re.search(rf"^{key}:", block.text, re.M)
                                                for key in ("source", "features", "optimizer")):
                configurations += 1
                problems += check_configuration(program, where, block.text)
            elif block.language == "cpp" and "#include" in block.text and compiler:
                sources += 1
                problems += check_source(compiler, where, block.text)
    print("\n".join(problems) or f"{files} files, {configurations} configurations, {sources} sources are fine")
    # Guards against a reader that finds nothing and therefore nothing wrong.
    return 1 if problems or min(files, configurations, sources if compiler else 1) < 1 else 0


if __name__ == "__main__":
    sys.exit(main())
