# SPDX-License-Identifier: BSD-3-Clause
"""`python -m holdfast` is the program `holdfast`."""

import sys

from ._core import run_program


def main() -> int:
    """Runs the program with the arguments of the command line and returns its exit code."""
    return run_program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
