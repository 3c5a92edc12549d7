# SPDX-License-Identifier: BSD-3-Clause
"""Modules written in Python, which configurations select by name.

A module is a class below one of `Segmenter`, `DynamicFilter`, `FeatureExtractor`, `FrameSource` and `Observer` with the
decorator `register`::

    @holdfast.register("bright")
    class Bright(holdfast.Segmenter):
        '''Calls bright pixels a person.'''

        classes = ["background", "person"]

        def __init__(self, threshold: Annotated[int, holdfast.Parameter("grey level", minimum=0, maximum=255)] = 180):
            self.threshold = threshold

        def segment(self, frame):
            return (frame.colour.mean(axis=2) > self.threshold).astype(numpy.uint8)

The parameters of `__init__` with their annotations and defaults are those of the configuration, which may then say
`segmenter: { bright: { threshold: 200 } }`. Types are bool, int, float, str, pathlib.Path, List[str] and List[float]; a
parameter without a default is required. A parameter `context: holdfast.Creation` receives camera, seed and folder of
the run. Any exception ends the run with its traceback. Python's lock (GIL) is held during calls, and never while C++
works.
"""

from __future__ import annotations

import collections.abc
import inspect
import pathlib
import re
from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Type,
    TypeVar,
    Union,
)
from typing import get_args, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Camera, FilterContext, Frame, FrameFeatures, FrameResult, ObservedMap, StaticEvidence
from ._errors import PluginError
from .maps import MapSnapshot
from .trajectory import Trajectory


class Parameter:
    """What the reference says of a parameter and what it may be: `Annotated[int, Parameter("help", minimum=0)]`.

    `minimum` and `maximum` bound a number or every number of a list, `one_of` lists the texts that are allowed,
    `unit` is that of a number.
    """

    def __init__(
        self,
        help: str = "",
        *,
        minimum: Optional[float] = None,
        maximum: Optional[float] = None,
        unit: str = "",
        one_of: Sequence[str] = (),
    ) -> None:
        self.help, self.minimum, self.maximum, self.unit, self.one_of = help, minimum, maximum, unit, list(one_of)


class Creation(NamedTuple):
    """What a module learns of the run when it is made."""

    camera: Camera
    seed: int
    sequential: bool
    output_directory: Optional[pathlib.Path]
    class_names: List[str]


class Module:
    """Base class of all modules; use one of its subclasses below."""

    _kind = ""


class Segmenter(Module):
    """Assigns a class to every pixel.

    `classes` lists 1 to 255 names by label, the first being the background; `movable` the subset that can move, if
    known. Used by one thread at a time; in threaded mode tracking does not wait for it.
    """

    _kind = "segmenter"
    classes: Sequence[str]

    def segment(
        self, frame: Frame
    ) -> Union[None, npt.NDArray[np.uint8], Tuple[Optional[npt.NDArray[np.uint8]], ...]]:
        """Labels, (labels, confidence), (labels, confidence, instances), or None for a frame without segmentation.

        All are uint8 (rows, columns) of the size of `frame.colour`: indices into `classes`, 255 = unknown;
        confidence 255 = certain, or None; instances 0 = none, otherwise a number for each object, such as each of
        several people. `frame.colour` must not be written to.
        """
        raise NotImplementedError("segment")


class DynamicFilter(Module):
    """Adds evidence about which features belong to the static world.

    `needs` lists the inputs without which it cannot work: "depth", "segmentation", "pose_prior", "matches", and
    "evidence" of filters that run before it. In a single frame one may be missing all the same.
    """

    _kind = "filters"
    needs: Iterable[str] = ()

    def apply(self, context: FilterContext, evidence: StaticEvidence) -> None:
        """Adds log-odds of standing still, by evidence.add(float (n,)); 0 where it cannot decide. Used by one thread.

        `context` and `evidence` are valid during the call only; arrays that they give are copies.
        """
        raise NotImplementedError("apply")


class Features:
    """Features of one image; entry i of every array belongs to feature i.

    `x`, `y` are pixels of the full image, `descriptors` the arrays that the extractor
    names: uint8 (n, length / 8), float32 or int8 (n, length). `octave` is the pyramid level, `angle` the
    orientation [rad, 0 to 2 pi), `response` the strength; each may be left out for zeros.
    """

    def __init__(
        self,
        x: npt.ArrayLike,
        y: npt.ArrayLike,
        descriptors: npt.NDArray[Any],
        octave: Optional[npt.ArrayLike] = None,
        angle: Optional[npt.ArrayLike] = None,
        response: Optional[npt.ArrayLike] = None,
    ) -> None:
        self.x, self.y, self.descriptors = np.asarray(x), np.asarray(y), descriptors
        zeros = np.zeros(len(self.x), np.float32)
        self.octave = zeros if octave is None else np.asarray(octave)
        self.angle = zeros if angle is None else np.asarray(angle)
        self.response = zeros if response is None else np.asarray(response)


class FeatureExtractor(Module):
    """Detects and describes features.

    `levels` and `factor` are those of the scale pyramid to which Features.octave refers: level i is smaller by factor
    ** i.

    `descriptors` is their kind: "binary" (arrays of uint8 with length / 8 columns), "float32" or "int8" (length
    columns). `metric` is "hamming" for binary ones, "euclidean" or "cosine" (float32 of unit length) for others.
    `strict_distance` is the largest distance of a match without any prediction, `loose_distance` that of a match near
    its prediction.
    """

    _kind = "features"
    levels: int = 1
    factor: float = 1.2
    descriptors: str = "binary"
    metric: Optional[str] = None
    length: int = 256
    strict_distance: float = 50.0
    loose_distance: float = 100.0

    def extract(self, grey: npt.NDArray[np.uint8], ignore: Optional[npt.NDArray[np.uint8]]) -> Optional[Features]:
        """Features of an image (rows, columns); none where `ignore`, of the same shape or None, is not 0.

        The same image gives the same features in the same order.
        """
        raise NotImplementedError("extract")


class FrameSource(Module):
    """Provides frames: iterate over it to get holdfast.Frame or (timestamp, colour, depth) with rising time stamps.

    Set `camera` to its calibration, or leave it to the configuration. `frame_count` is the number of frames if it is
    known. A source of rectified stereo pairs has `has_depth = False` and `has_right = True`, a `camera` with the
    baseline of the pair, and yields (timestamp, left, None, right).
    """

    _kind = "source"
    name: Optional[str] = None
    camera: Optional[Camera] = None
    has_depth: bool = True
    has_right: bool = False
    frame_count: Optional[int] = None
    class_names: Sequence[str] = ()

    def __iter__(self) -> Iterator[Union[Frame, Tuple[float, Any, Any], Tuple[float, Any, Any, Any]]]:
        """The frames, in order; called once per run, in threaded mode by a thread of its own."""
        raise NotImplementedError("__iter__")

    def truth(self) -> Optional[Trajectory]:
        """True poses, if they are known; they are compared with the run's."""
        return None


class Observer(Module):
    """Observes a run; define the methods that are of interest. An exception ends the run.

    In sequential mode the thread that feeds frames calls all of them. `features` and `map` are valid during the call
    only.
    """

    _kind = "observers"

    def on_frame(self, frame: Frame, features: FrameFeatures, result: FrameResult) -> None:
        """After each frame, by the tracking thread."""

    def on_keyframe(self, keyframe: int, map: ObservedMap) -> None:
        """After local mapping has processed a keyframe, by the mapping thread."""

    def on_loop(self, older: int, newer: int, map: ObservedMap) -> None:
        """After a loop was closed between two keyframes, by the loop closing thread."""

    def on_finish(self, map: MapSnapshot) -> None:
        """Once at the end of the run, by the thread that calls finish()."""


_METHODS: Dict[Type[Module], Tuple[str, ...]] = {
    Segmenter: ("segment",),
    DynamicFilter: ("apply",),
    FeatureExtractor: ("extract",),
    FrameSource: ("__iter__",),
    Observer: (),
}
_TYPES: List[Tuple[Any, str]] = [
    (bool, "boolean"),
    (int, "integer"),
    (float, "real"),
    (str, "text"),
    (pathlib.Path, "path"),
]
ModuleClass = TypeVar("ModuleClass", bound=Type[Module])


def _type_name(annotation: Any) -> Optional[str]:
    for known, name in _TYPES:
        if annotation is known:
            return name
    if get_origin(annotation) in (list, collections.abc.Sequence):
        return {str: "list of texts", float: "list of reals"}.get(get_args(annotation)[0])
    return None


def _row(owner: str, parameter: inspect.Parameter, annotation: Any) -> Dict[str, Any]:
    details = Parameter()
    for extra in getattr(annotation, "__metadata__", ()):
        details = extra if isinstance(extra, Parameter) else details
    if hasattr(annotation, "__metadata__"):
        annotation = get_args(annotation)[0]
    required = parameter.default is inspect.Parameter.empty
    if annotation is inspect.Parameter.empty and not required:
        annotation = type(parameter.default)
    name = _type_name(annotation)
    if name is None:
        raise PluginError(
            f"{owner}: the parameter '{parameter.name}' of __init__ has the type {annotation!r}; expected one of "
            "bool, int, float, str, pathlib.Path, List[str] and List[float]"
        )
    empty: Dict[str, Any] = {"boolean": False, "integer": 0, "real": 0.0, "list of texts": [], "list of reals": []}
    return {
        "name": parameter.name,
        "type": name,
        "help": details.help,
        "unit": details.unit,
        "minimum": details.minimum,
        "maximum": details.maximum,
        "one_of": details.one_of,
        "required": required,
        "default": empty.get(name, "") if required else parameter.default,
    }


def _read_parameters(owner: str, function: Callable[..., Any]) -> Tuple[List[Dict[str, Any]], List[str], bool]:
    """Rows of the parameter table, names of paths, and whether it takes the context."""
    try:
        hints = get_type_hints(function, include_extras=True)
    except NameError as error:
        raise PluginError(f"{owner}: the annotations of __init__ cannot be read: {error}") from error
    rows, paths, takes_context = [], [], False
    for parameter in list(inspect.signature(function).parameters.values())[1:]:
        if parameter.kind in (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD):
            continue
        if parameter.name == "context":
            takes_context = True
            continue
        row = _row(owner, parameter, hints.get(parameter.name, inspect.Parameter.empty))
        rows.append(row)
        if row["type"] == "path":
            paths.append(parameter.name)
    return rows, paths, takes_context


def _creation(context: Dict[str, Any]) -> Creation:
    folder = context["output_directory"]
    return Creation(
        context["camera"],
        context["seed"],
        context["sequential"],
        pathlib.Path(folder) if folder else None,
        context["class_names"],
    )


def _summary(definition: type) -> str:
    text = (inspect.getdoc(definition) or "").strip().split("\n\n")[0] if definition.__doc__ else ""
    return " ".join(text.split())


def _check_methods(definition: type, base: Type[Module]) -> None:
    for method in _METHODS[base]:
        if getattr(definition, method) is getattr(base, method):
            raise PluginError(
                f"{definition.__name__} does not define {method}; expected what holdfast.{base.__name__} describes"
            )


def _file_of(definition: type) -> str:
    try:
        return inspect.getfile(definition)
    except (TypeError, OSError):  # in a notebook or an interactive session
        return f"<{definition.__module__}>"


def register(name: str, *, paper: str = "", licence: str = "not stated") -> Callable[[ModuleClass], ModuleClass]:
    """Decorator that registers a class as a module, so that configurations of this process can select it by `name`.

    The summary in the reference is the first paragraph of the docstring; `paper` is the publication that it
    implements, `licence` that of the code, such as "BSD-3-Clause". A class that is defined again, as in a notebook,
    takes the place of the earlier one. Raises PluginError for a name that is taken, for a class below none of the
    interfaces, and for parameters of other types.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise PluginError(
            f"'{name}' is no name of a module; expected lower case words joined by _, such as my_segmenter"
        )

    def decorate(definition: ModuleClass) -> ModuleClass:
        owner = definition.__name__
        bases = [base for base in _METHODS if issubclass(definition, base)]
        if len(bases) != 1:
            expected = ", ".join(f"holdfast.{base.__name__}" for base in _METHODS)
            raise PluginError(f"{owner} is not below one of the interfaces; expected a class below one of {expected}")
        _check_methods(definition, bases[0])
        rows: List[Dict[str, Any]] = []
        paths: List[str] = []
        takes_context = False
        if definition.__init__ is not object.__init__:
            rows, paths, takes_context = _read_parameters(owner, definition.__init__)

        def make(values: Dict[str, Any], context: Dict[str, Any]) -> Module:
            arguments = {key: pathlib.Path(value) if key in paths else value for key, value in values.items()}
            if takes_context:
                arguments["context"] = _creation(context)
            return definition(**arguments)

        kind = bases[0]._kind
        origin = f"{definition.__module__}.{definition.__qualname__}"
        replace = _origins.get((kind, name)) == origin
        _core.register_module(
            kind, name, _summary(definition), paper, licence, origin, _file_of(definition), rows, make, replace
        )
        _origins[(kind, name)] = origin
        return definition

    return decorate


_origins: Dict[Tuple[str, str], str] = {}


def unregister(kind: str, name: str) -> bool:
    """Takes a module away again and returns whether there was one.

    `kind` is "segmenter", "filters", "features", "source" or "observers".
    """
    _origins.pop((kind, name), None)
    return _core.unregister_module(kind, name)


def registered() -> List[Tuple[str, str]]:
    """(kind, name) of the modules that were registered in this process."""
    return _core.registered_modules()
