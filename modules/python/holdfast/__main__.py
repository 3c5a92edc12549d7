# SPDX-License-Identifier: BSD-3-Clause
"""`python -m holdfast [--import NAME]... ARGUMENTS` is the program `holdfast`.

`--import` comes before the command and imports Python code whose modules configurations select by name: NAME is what
`import` calls it, or a file that ends in .py.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import List, Sequence, Tuple

from ._core import run_program
from ._imports import ImportRequestError, import_code


def _split(words: Sequence[str]) -> Tuple[List[str], List[str]]:
    """What is to be imported, files with their whole path, and the arguments of the program."""
    rest, names = list(words), []
    while rest and (rest[0] == "--import" or rest[0].startswith("--import=")):
        word = rest.pop(0)
        name = word[len("--import=") :] if "=" in word else rest.pop(0) if rest else ""
        if not name:
            raise ImportRequestError("expected a name that `import` knows, or a file that ends in .py")
        names.append(str(Path(name).resolve()) if name.endswith(".py") else name)
    return names, rest


def main() -> int:
    """Runs the program with the arguments of the command line and returns its exit code."""
    try:
        names, words = _split(sys.argv[1:])
        for name in names:
            import_code(name)
    except ImportRequestError as error:
        print(f"error: --import: {error}", file=sys.stderr)
        return 2
    imports = [word for name in names for word in ("--import", name)]
    return run_program(words, [sys.executable, "-m", "holdfast", *imports])


if __name__ == "__main__":
    sys.exit(main())
