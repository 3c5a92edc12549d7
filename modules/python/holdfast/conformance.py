# SPDX-License-Identifier: BSD-3-Clause
"""Tests of modules in Python against the contracts of their interfaces.

`python3 -m holdfast.conformance CODE...` imports each CODE, a name that `import` knows or a file that ends in .py, and
holds every segmenter, filter and extractor that is registered then to its contract, by the tests that the built-in
modules pass. It exits with 0 when all pass, 1 when one fails, 2 when something named is not there.
"""

from __future__ import annotations

import argparse
import os
import sys
from typing import List, Optional, Sequence

from . import _core
from ._errors import Error
from ._imports import ImportRequestError, import_code


def check(
    modules: Sequence[str] = (),
    exclude: Sequence[str] = (),
    parameters: str = "",
    options: Sequence[str] = (),
) -> bool:
    """Tests the modules that are registered in this process, once per process; returns whether all tests passed.

    `modules` and `exclude` select by `name` or `kind/name`; `parameters` is YAML by kind and name, such as
    "segmenter: { mine: { threshold: 3 } }"; `options` are those of GoogleTest, such as "--gtest_filter=*Frames*". The
    report goes to standard output. Raises ConfigurationError for wrong selections and parameters, PluginError without
    a module that can be tested, ImportError if the package was built without the tests.
    """
    try:
        from . import _conformance
    except ImportError as error:
        raise ImportError(
            "this package was built without the conformance tests; build it with -DHOLDFAST_BUILD_CONFORMANCE=ON and "
            "GoogleTest (Debian: libgtest-dev)"
        ) from error
    registry = _core.registered_registry()
    return _conformance.run(registry, list(modules), list(exclude), parameters, os.getcwd(), list(options)) == 0


def main(arguments: Optional[List[str]] = None) -> int:
    """The command line of this module."""
    parser = argparse.ArgumentParser(
        prog="python3 -m holdfast.conformance",
        allow_abbrev=False,
        description="Tests modules in Python against the contracts of their interfaces.",
        epilog="Options that begin with --gtest_ are those of GoogleTest.",
    )
    parser.add_argument("code", nargs="+", metavar="CODE", help="what registers modules: an importable name or a file")
    parser.add_argument("--module", action="append", default=[], help="only this one, as NAME or KIND/NAME; repeatable")
    parser.add_argument("--except", action="append", default=[], dest="exclude", help="not this one; repeatable")
    parser.add_argument("--parameters", default="", metavar="YAML", help="'segmenter: { mine: { threshold: 3 } }'")
    words, options = parser.parse_known_args(arguments)
    wrong = [option for option in options if not option.startswith("--gtest_")]
    if wrong:
        parser.error(f"unknown argument {wrong[0]!r}")
    try:
        for name in words.code:
            import_code(name)
        return 0 if check(words.module, words.exclude, words.parameters, options) else 1
    except (Error, ImportRequestError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
