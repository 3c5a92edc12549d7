# SPDX-License-Identifier: BSD-3-Clause
"""Python code that a command line names, so that it registers its modules."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from pathlib import Path


class ImportRequestError(Exception):
    """What the command line names cannot be imported, and what to write instead."""


def import_code(name: str) -> None:
    """Imports what `import` calls `name`, or a file that ends in .py. What the code itself raises passes."""
    if name.endswith(".py"):
        _import_file(Path(name).resolve())
    else:
        _import_name(name)


def _import_file(file: Path) -> None:
    if not os.path.isfile(file):
        raise ImportRequestError(f"{file}: there is no such file")
    if file.stem in sys.modules:
        raise ImportRequestError(f"{file}: a module '{file.stem}' is imported already; rename the file")
    spec = importlib.util.spec_from_file_location(file.stem, file)
    assert spec is not None and spec.loader is not None  # the ending is that of Python's files
    module = importlib.util.module_from_spec(spec)
    sys.modules[file.stem] = module  # classes are looked up there
    sys.path.append(str(file.parent))  # for what lies beside it
    spec.loader.exec_module(module)


def _import_name(name: str) -> None:
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{name}.".startswith(f"{error.name}."):
            raise  # it is there, and misses another one
        raise ImportRequestError(
            f"{name}: there is no module '{error.name}' in the working directory and on PYTHONPATH; expected a name "
            "that `import` knows, or a file that ends in .py"
        ) from None
