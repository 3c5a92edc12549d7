# SPDX-License-Identifier: BSD-3-Clause
"""Configurations from files and mappings, and the reference of all modules."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

from . import _core
from ._core import Configuration
from ._parts import Parts
from .plugins import Module

Config = Union[str, "os.PathLike[str]", Mapping[str, Any], Configuration]
Overrides = Union[Mapping[str, Any], Sequence[str]]


def _plain(value: Any) -> Any:
    """What json.dumps does not know by itself: paths, and numbers and arrays of NumPy."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Module):
        raise TypeError(
            f"a configuration names its modules and cannot hold a {type(value).__name__}; give it to holdfast.run or "
            "holdfast.Pipeline, in the section of its kind"
        )
    raise TypeError(f"a configuration cannot hold {value!r}; expected numbers, texts, lists and mappings")


def _yaml(value: Any) -> str:
    """JSON, which is YAML as well."""
    return json.dumps(value, default=_plain)


def _override_texts(overrides: Overrides) -> List[str]:
    if isinstance(overrides, Mapping):
        return [f"{key}={_yaml(value)}" for key, value in overrides.items()]
    if isinstance(overrides, str):
        raise TypeError("overrides is a text; expected {'key.path': value, ...} or ['key.path=value', ...]")
    return list(overrides)


def _load(
    config: Config,
    overrides: Overrides,
    fed: bool,
    parts: Optional[Parts] = None,
    more: Mapping[str, Any] = {},
) -> Configuration:
    """`more` are overrides that come last. Modules in the configuration and in overrides need `parts`."""
    if parts is not None:
        config = parts.named(config) if isinstance(config, Mapping) else config
        overrides = parts.named(overrides) if isinstance(overrides, Mapping) else overrides
        more = parts.named(more)
    texts = _override_texts(overrides) + _override_texts(more)
    modules = parts.modules if parts is not None else []
    if isinstance(config, Configuration):
        if not texts and not fed:
            return config
        name, text = config.file or "configuration", config.to_yaml()
        return _core.load_configuration(name, text, os.getcwd(), texts, fed, modules)
    if isinstance(config, Mapping):
        return _core.load_configuration("configuration", _yaml(config), os.getcwd(), texts, fed, modules)
    return _core.load_configuration(os.fspath(config), None, "", texts, fed, modules)


def load_config(config: Config, overrides: Overrides = {}) -> Configuration:
    """Reads and checks a configuration, as `holdfast check --without-data` does.

    `config` is a file, or a mapping with the sections of one (relative paths in it start from the working directory).
    `overrides` are values by key path, {"features.orb.count": 1500} or ["features.orb.count=1500"]; they count as if
    the configuration contained them.

    Raises ConfigurationError with every problem found, each with file, line and column.
    """
    return _load(config, overrides, fed=False)


def modules() -> List[Dict[str, Any]]:
    """The reference of all modules and plain sections, those registered in Python included, as `holdfast modules
    --json`.

    Each entry has `kind`, `name`, `summary` and `parameters` with name, type, default, range, unit and help.
    """
    entries: List[Dict[str, Any]] = json.loads(_core.reference_json())
    return [entry for entry in entries if entry.get("name") != "fed_frames"]
