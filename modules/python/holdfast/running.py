# SPDX-License-Identifier: BSD-3-Clause
"""Whole runs of a configuration."""

from __future__ import annotations

import os
import sys
import time
from typing import Any, Callable, Optional, Sequence, Union

from . import _core
from ._core import FrameResult
from ._errors import RunError
from ._parts import Part, Parts, given
from .configuration import Config, Overrides, _load
from .result import Result

Progress = Callable[[int, Optional[int], FrameResult], None]


class _Line:
    """A line on standard error that shows how far a run is: written over on a terminal, seldom elsewhere."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._begin = self._last = time.monotonic()
        self._shown = False

    def __call__(self, done: int, total: Optional[int], result: FrameResult) -> None:
        now = time.monotonic()
        if now - self._last < (0.1 if self._terminal else 10.0):
            return
        self._last = now
        of = f" of {total}" if total is not None else ""
        text = f"frame {done}{of}, {done / max(now - self._begin, 1e-9):.1f} frames/s, {result.status}"
        print(
            f"\r{text}\033[K" if self._terminal else text,
            end="" if self._terminal else "\n",
            file=sys.stderr,
            flush=True,
        )
        self._shown = True

    def clear(self) -> None:
        if self._terminal and self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def run(
    config: Config,
    overrides: Overrides = {},
    output: Union[str, "os.PathLike[str]", None] = None,
    progress: Union[bool, Progress] = True,
    *,
    map: Union[str, "os.PathLike[str]", None] = None,
    localise: bool = False,
    overwrite: bool = False,
    source: Optional[Part] = None,
    features: Optional[Part] = None,
    segmenter: Optional[Part] = None,
    filters: Optional[Sequence[Part]] = None,
    observers: Optional[Sequence[Part]] = None,
) -> Result:
    """Runs a configuration from the first frame of its source to the last, as `holdfast run` does, with the same bytes.

    `config` is a file, a mapping or a Configuration; `overrides` are values by key path, such as {"run.seed": 2}.
    With `output`, the files of `holdfast run` are written into that folder; one that is not empty needs `overwrite`.
    `progress` is True for a line on standard error, False for none, or a function (frames done, frame count or None,
    FrameResult) that is called at most ten times a second; an exception of it ends the run. `map` is a map.hfm to
    continue, or with `localise` to find poses in without changing it. `source`, `features`, `segmenter`, `filters` and
    `observers` take the place of these sections, by name or as modules, as holdfast.Pipeline has it; config.yaml names
    such a module own_ and the words of its class.

    Python's lock (GIL) is released; other threads go on. Ctrl-C ends the run after the current frame: what was
    computed is written into `output`, then KeyboardInterrupt is raised.

    Raises ConfigurationError with every problem found; InputError for files that cannot be used; RunError when an error
    ended the run early, whose `result` holds what was computed until then.
    """
    if localise and map is None:
        raise ValueError("localise needs a map; give map='map.hfm' of an earlier run")
    parts = Parts()
    more = given(source=source, features=features, segmenter=segmenter, filters=filters, observers=observers)
    configuration = _load(config, overrides, fed=False, parts=parts, more=more)
    line = _Line() if progress is True else None
    on_frame: Any = line if line is not None else (progress or None)
    try:
        record = _core.run(
            configuration,
            os.fspath(output or ""),
            os.fspath(map or ""),
            localise,
            overwrite,
            on_frame,
            0.1,
            parts.modules,
        )
    finally:
        if line is not None:
            line.clear()
    result = Result(record)
    if record.failure:
        raise RunError(record.failure, result)
    return result
