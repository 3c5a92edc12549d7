# SPDX-License-Identifier: BSD-3-Clause
"""The exceptions of the package; their texts are those of the C++ errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, List, NamedTuple, Tuple

if TYPE_CHECKING:
    from .result import Result


class Diagnostic(NamedTuple):
    """One problem of a configuration with its place; line and column count from 1, 0 is the whole file or line."""

    file: str
    line: int
    column: int
    message: str


class Error(RuntimeError):
    """Base class of all errors of Holdfast. The text says what was found, what was expected and how to correct it."""


class ConfigurationError(Error, ValueError):
    """A configuration that cannot be run. `diagnostics` holds every problem found, and the text one per line."""

    diagnostics: List[Diagnostic] = []


class InputError(Error, ValueError):
    """A file, an array or a frame that cannot be used. `location` is (file, line, column).

    Where code in Python raised it, as in a segmenter, its own exception is `__cause__`, and the traceback is in the
    text.
    """

    location: Tuple[str, int, int] = ("", 0, 0)


class PluginError(Error):
    """A plugin that cannot be loaded, or a module that cannot be registered."""


class CheckError(Error):
    """A precondition of the library was violated: a defect of the library or of a plugin."""


class RunError(Error):
    """A run ended early with an error. `result` holds what was computed until then."""

    def __init__(self, message: str, result: "Result") -> None:
        super().__init__(message)
        self.result = result
