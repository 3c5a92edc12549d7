# SPDX-License-Identifier: BSD-3-Clause
"""The pages of this repository, and what stands in them: blocks of code, headings, links."""
import dataclasses
import os
import pathlib
import re

@dataclasses.dataclass(frozen=True)
class Block:
    language: str
    text: str
    line: int  # of its first line, from 1


def is_made(folder: pathlib.Path) -> bool:
    """Whether a folder is hidden or was made by a build or a run, and so is no part of the repository."""
    if folder.name.startswith(".") or folder.name in ("build", "out", "__pycache__"):
        return True
    return (folder / "CMakeCache.txt").exists()


def pages(root: pathlib.Path) -> list[pathlib.Path]:
    """All Markdown files below root, in order; not those in folders that are made."""
    found = []
    for folder, folders, files in os.walk(root):
        folders[:] = [name for name in folders if not is_made(pathlib.Path(folder, name))]
        found += [pathlib.Path(folder, name) for name in files if name.endswith(".md")]
    return sorted(found)


def _parts(text: str):
    """Yields (line number, line, block) where block is the language of the block that the line stands in, else None;
    the fences themselves are left out. ValueError for a block that never ends."""
    fence, language, begin = None, None, 0
    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(r" {0,3}(`{3,}|~{3,})\s*(\S*)", line)
        if fence is None and mark:
            fence, language, begin = mark[1], mark[2], number
        elif fence is not None and mark and mark[1].startswith(fence) and not mark[2]:
            fence = None
        else:
            yield number, line, language if fence is not None else None
    if fence is not None:
        raise ValueError(f"line {begin}: a block of code that never ends")


def blocks(text: str) -> list[Block]:
    """The fenced blocks of code of a page."""
    result, lines, language, begin, last = [], [], None, 0, -1
    for number, line, inside in _parts(text):
        if lines and (inside is None or number != last + 1):
            result.append(Block(language, "\n".join(lines) + "\n", begin))
            lines = []
        if inside is not None:
            if not lines:
                language, begin = inside, number
            lines.append(line)
        last = number
    if lines:
        result.append(Block(language, "\n".join(lines) + "\n", begin))
    return result


def _prose(text: str):
    """The lines outside of blocks of code."""
    for number, line, inside in _parts(text):
        if inside is None:
            yield number, line


def headings(text: str) -> list[str]:
    return [m[1] for _, line in _prose(text) if (m := re.match(r"#{1,6}\s+(.*?)\s*#*$", line))]


def anchors(text: str) -> set[str]:
    """The names by which a page's headings can be linked to, made as GitHub makes them, and its HTML ids."""
    result: set[str] = set()
    for heading in headings(text):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")
        unique, count = name, 0
        while unique in result:
            count += 1
            unique = f"{name}-{count}"
        result.add(unique)
    result.update(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    return result


def links(text: str) -> list[tuple[int, str]]:
    """(line, target) of every link and picture: [text](target), [text]: target, href="..." and src="..."."""
    found = []
    for number, line in _prose(text):
        line = re.sub(r"`[^`]*`", "``", line)
        for pattern in (r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", r"^\s{0,3}\[[^\]^]+\]:\s*(\S+)",
                        r"(?:href|src)=\"([^\"]+)\""):
            found += [(number, target) for target in re.findall(pattern, line)]
    return found
