# SPDX-License-Identifier: BSD-3-Clause
# The conformance tests; private. See conformance.py.

from typing import Sequence

def run(
    registry: object,
    modules: Sequence[str],
    exclude: Sequence[str],
    parameters: str,
    folder: str,
    options: Sequence[str],
) -> int: ...
