#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_links.py ROOT: every relative link of every page leads to a file of this repository, and every anchor to a
heading. Addresses of the web are not visited."""
import pathlib
import sys
import urllib.parse

import markdown


def problems_of(root: pathlib.Path) -> tuple[list[str], int]:
    root = root.resolve()
    texts = {page: page.read_text(encoding="utf-8") for page in markdown.pages(root)}
    problems, count = [], 0
    for page, text in texts.items():
        for line, target in markdown.links(text):
            where = f"{page.relative_to(root)}:{line}: {target}"
            if urllib.parse.urlsplit(target).scheme:
                continue
            count += 1
            path, _, anchor = urllib.parse.unquote(target).partition("#")
            if path.startswith("/"):
                problems.append(f"{where}: links start from the page, not from a root")
                continue
            file = (page.parent / path).resolve() if path else page
            if root not in (file, *file.parents):
                problems.append(f"{where}: leaves the repository")
            elif not file.exists():
                problems.append(f"{where}: there is no such file")
            elif anchor:
                if file not in texts:
                    problems.append(f"{where}: an anchor into what is no page")
                elif anchor not in markdown.anchors(texts[file]):
                    problems.append(f"{where}: no heading with this name; there are "
                                    + ", ".join(sorted(markdown.anchors(texts[file]))))
    return problems, count


if __name__ == "__main__":
    wrong, links = problems_of(pathlib.Path(sys.argv[1]))
    print("\n".join(wrong) or f"{links} links are fine")
    # Guards against a reader that finds nothing and therefore nothing wrong.
    sys.exit(1 if wrong or links < 50 else 0)
