# SPDX-License-Identifier: BSD-3-Clause
"""Imports the extension, and says what is wrong where Python would only say that it is not there."""

import importlib
import sys
from pathlib import Path

try:
    importlib.import_module("._core", __package__)
except ModuleNotFoundError as error:
    if error.name != f"{__package__}._core":
        raise  # the extension is there, and misses another module
    _folder = Path(__file__).parent
    _found = ", ".join(sorted(file.name for file in _folder.glob("_core.*.so"))) or "none"
    _version = f"{sys.version_info[0]}.{sys.version_info[1]}"
    raise ImportError(
        f"{_folder} holds no extension for Python {_version} ({sys.executable}), found: {_found}; use the Python "
        "that it was built with, or install the package with this one: pip install . --no-build-isolation"
    ) from None
