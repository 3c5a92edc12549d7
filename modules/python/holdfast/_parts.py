# SPDX-License-Identifier: BSD-3-Clause
"""Modules that are given as objects, where a configuration would name them."""

from __future__ import annotations

import re
from typing import Any, Dict, List, Mapping, Tuple, Type, Union

from .plugins import DynamicFilter, FeatureExtractor, FrameSource, Module, Observer, Segmenter, _check_methods, _file_of

#: What selects a module: its name, {name: parameters}, or the module itself.
Part = Union[str, Mapping[str, Any], Module]

#: Kind, name, file of the class, and the module.
GivenModule = Tuple[str, str, str, Module]

_BASES: Dict[str, Type[Module]] = {
    "source": FrameSource,
    "features": FeatureExtractor,
    "segmenter": Segmenter,
    "filters": DynamicFilter,
    "observers": Observer,
}


def _words(class_name: str) -> str:
    """NearBorder as near_border."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", class_name).lower()
    return re.sub(r"[^a-z0-9]+", "_", words).strip("_") or "module"


class Parts:
    """Gives modules names, so that a configuration can select them, and keeps them together with these."""

    def __init__(self) -> None:
        self.modules: List[GivenModule] = []

    def named(self, sections: Mapping[str, Any]) -> Dict[str, Any]:
        """The sections, or overrides by key path, with a name in place of every module."""
        return {key: self._section(key, value) if key in _BASES else value for key, value in sections.items()}

    def _section(self, section: str, value: Any) -> Any:
        if isinstance(value, (list, tuple)):
            return [self._choice(section, each) for each in value]
        return self._choice(section, value)

    def _choice(self, section: str, value: Any) -> Any:
        if value is None or isinstance(value, (str, Mapping)):
            return value
        base = _BASES[section]
        if not isinstance(value, base):
            found = f"the class {value.__name__}" if isinstance(value, type) else f"a {type(value).__name__}"
            raise TypeError(
                f"{section}: found {found}; expected the name of a module, {{name: parameters}}, or an instance of a "
                f"class below holdfast.{base.__name__}"
            )
        _check_methods(type(value), base)
        name = self._free_name(section, "own_" + _words(type(value).__name__))
        self.modules.append((section, name, _file_of(type(value)), value))
        return name

    def _free_name(self, section: str, name: str) -> str:
        taken = {each for kind, each, *_ in self.modules if kind == section}
        count = 1
        while (name if count == 1 else f"{name}_{count}") in taken:
            count += 1
        return name if count == 1 else f"{name}_{count}"


def given(**parts: Any) -> Dict[str, Any]:
    """The arguments that are not None."""
    return {section: value for section, value in parts.items() if value is not None}
