# SPDX-License-Identifier: BSD-3-Clause
"""SLAM frame by frame."""

from __future__ import annotations

import atexit
import os
import weakref
from types import TracebackType
from typing import Any, Callable, Dict, Optional, Sequence, Type, Union, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Camera, Frame, FrameResult, Health
from ._parts import Part, Parts, given
from .configuration import Config, Overrides, _load
from .maps import Map, MapSnapshot
from .trajectory import Trajectory

_open_pipelines: "weakref.WeakSet[Pipeline]" = weakref.WeakSet()


def _of_points(question: Callable[[Any], Any], points: Any) -> Any:
    """The answers for points (N, 3), or the one for a point (3,)."""
    array = np.asarray(points, dtype=float)
    return question(array[None])[0].item() if array.ndim == 1 else question(array)


class Pipeline:
    """Visual SLAM from frames to poses and a map.

    `config` is a file, a mapping or a Configuration. Its source is not opened: frames come from feed(). Without the
    section `camera` give `camera`, a known name or a Camera. `map` is a map.hfm to continue, or with `localise` to
    find poses in without changing it. `output` is a folder for modules that write files. `class_names` are those of
    the frames' `class_labels`, for the segmenter `truth`. With `stereo` frames are rectified stereo pairs in place of
    colour and depth: the camera has no distortion, and its `baseline` is the distance of the pair's cameras [m].

    `features`, `segmenter`, `filters` and `observers` take the place of these sections of the configuration: a name,
    {name: parameters}, or a module, which is an instance of a class below FeatureExtractor, Segmenter, DynamicFilter or
    Observer; lists of them for filters and observers. A mapping may hold modules in the same places. One module may
    serve several pipelines one after the other.

    Pipelines share nothing: any number may live at once. Any thread may call any method; feed() and finish() of one
    pipeline wait for each other. C++ works without Python's lock (GIL). Used as a context manager, it is finished at
    the end of the block, and closed: trajectory, keyframes and map stay. A module that is called by a pipeline may ask
    it for map_snapshot() (a filter may not) and interrupt(); other calls would wait for the module itself, and raise
    Error.

    Raises ConfigurationError with every problem found, InputError for a map that cannot be used.
    """

    def __init__(
        self,
        config: Config,
        overrides: Overrides = {},
        *,
        camera: Union[str, Camera, None] = None,
        map: Union[str, "os.PathLike[str]", None] = None,
        localise: bool = False,
        output: Union[str, "os.PathLike[str]", None] = None,
        class_names: Sequence[str] = (),
        stereo: bool = False,
        features: Optional[Part] = None,
        segmenter: Optional[Part] = None,
        filters: Optional[Sequence[Part]] = None,
        observers: Optional[Sequence[Part]] = None,
    ) -> None:
        if localise and map is None:
            raise ValueError("localise needs a map; give map='map.hfm' of an earlier run")
        more: Dict[str, Any] = given(features=features, segmenter=segmenter, filters=filters, observers=observers)
        if camera is not None:
            more["camera"] = camera if isinstance(camera, str) else _camera_section(camera)
        if class_names or stereo:
            more["source"] = {"fed_frames": {"class_names": list(class_names), "stereo": stereo}}
        parts = Parts()
        configuration = _load(config, overrides, fed=True, parts=parts, more=more)
        self._finished: Optional[_Finished] = None
        self._core = _core.Pipeline(
            configuration, os.fspath(output or ""), os.fspath(map or ""), localise, parts.modules
        )
        _open_pipelines.add(self)

    @overload
    def feed(
        self,
        timestamp: float,
        colour: npt.NDArray[np.uint8],
        depth: Optional[npt.NDArray[np.float32]] = ...,
        right: Optional[npt.NDArray[np.uint8]] = ...,
    ) -> FrameResult:
        ...

    @overload
    def feed(self, timestamp: Frame) -> FrameResult:
        ...

    def feed(self, timestamp: Any, colour: Any = None, depth: Any = None, right: Any = None) -> FrameResult:
        """Processes one frame and returns what tracking found.

        `timestamp` [s] rises strictly. `colour` is uint8 (rows, columns, 3), blue green red as cv2 reads it, or grey
        (rows, columns); `depth` is float32 (rows, columns) along the optical axis [m], 0 where there is none. `right`
        is the right image of a stereo pair, whose left image is `colour`: uint8 (rows, columns, 3) or (rows, columns);
        a pipeline with `stereo` expects one in every frame, others refuse it. A Frame is accepted in their place. The
        images are shared, not copied: do not write to them afterwards; a camera that reuses its buffer hands over
        copies. Only arrays whose rows are not contiguous, such as image[:, :, ::-1], are copied.

        Trouble with a frame is a result, not an exception. Raises InputError for arrays of another kind and for time
        stamps that do not rise, and what a thread of the pipeline raised.
        """
        if isinstance(timestamp, Frame):
            if colour is not None or depth is not None or right is not None:
                raise TypeError("feed: a Frame holds its images; expected a Frame alone, or a time stamp and images")
            return self._core.feed(timestamp)
        if not hasattr(timestamp, "__float__"):  # here, because the message of pybind11 prints all images
            raise TypeError(f"feed: the time stamp is of type {type(timestamp).__name__}; expected seconds, or a Frame")
        return self._core.feed_arrays(timestamp, colour, depth, right)

    def finish(self) -> None:
        """Ends the run: waits for background work, adjusts the map once more where that helps, tells the observers."""
        self._core.finish()

    def close(self) -> None:
        """Ends the threads and frees the memory. A pipeline that is not finished loses what waits for its threads."""
        if self._finished is None and self._core.is_finished and not self._core.is_closed:
            self._finished = _Finished(self._core)
        self._core.close()

    def interrupt(self) -> None:
        """Makes adjustments in progress end after their current iteration, and observers that wait for somebody go on,
        both for the rest of the run: a viewer no longer pauses, and finish() does not adjust again. Frames may still be
        fed. From any thread, also during feed() and from the pipeline's own modules; a closed pipeline ignores it."""
        self._core.interrupt()

    def trajectory(self) -> Trajectory:
        """Poses of all tracked frames so far, corrected by all that came later."""
        if self._finished is not None:
            return self._finished.trajectory
        return Trajectory._of(self._core.trajectory())

    def keyframes(self) -> Trajectory:
        """Poses of the keyframes in the map, by time."""
        if self._finished is not None:
            return self._finished.keyframes
        return Trajectory._of(self._core.keyframes())

    def health(self, patience: float = 10.0) -> Health:
        """Health of the last frame; its state is "stalled" if no frame came for `patience` of their usual periods.

        Any thread may call it while frames are fed. After finish(), ask the results of frames.
        """
        return self._core.health(patience)

    def map_snapshot(self) -> MapSnapshot:
        """A copy of the map's geometry as it is now, while frames and background work go on."""
        if self._finished is not None:
            return self._finished.map.snapshot()
        return MapSnapshot(self._core.map_snapshot())

    def is_free(self, points: Any) -> Any:
        """Whether points of the world [m] are known to be free, by the surface as fused so far (`surface.enabled`).

        A point (3,) gives a bool, points (N, 3) an array. The first call after a keyframe meshes the surface.
        """
        return _of_points(self._core.is_free, points)

    def distance(self, points: Any) -> Any:
        """Distance of points of the world to the nearest surface [m], as is_free()."""
        return _of_points(self._core.distance, points)

    @property
    def map(self) -> Map:
        """The map of a finished pipeline, which is closed thereby. Raises Error before finish()."""
        if self._finished is None:
            if not self._core.is_finished:
                self._core.take_map()  # raises and says why
            self._finished = _Finished(self._core)
        return self._finished.map

    @property
    def camera(self) -> Camera:
        """The camera of the frames."""
        return self._core.camera

    def __enter__(self) -> "Pipeline":
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        try:
            if kind is None and not self._core.is_finished and not self._core.is_closed:
                self._core.finish()
        finally:
            self.close()

    def __repr__(self) -> str:
        state = "closed" if self._core.is_closed else "finished" if self._core.is_finished else "running"
        return f"Pipeline({self._core.fed} frames, {state})"


class _Finished:
    """What stays of a pipeline that was closed after its end."""

    def __init__(self, core: _core.Pipeline) -> None:
        self.trajectory = Trajectory._of(core.trajectory())
        self.keyframes = Trajectory._of(core.keyframes())
        self.map = Map(core.take_map())


def _camera_section(camera: Camera) -> Any:
    coefficients = ("k1", "k2", "k3", "k4") if camera.lens == "fisheye" else ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
    names = ("name", "width", "height", "fx", "fy", "cx", "cy", "baseline", "frame_rate")
    section = {name: getattr(camera, name) for name in names if name != "name" or camera.name in _core.camera_names()}
    return {**section, "lens": camera.lens, **dict(zip(coefficients, camera.distortion))}


@atexit.register
def _close_pipelines() -> None:
    """Threads of C++ that still call Python must end before Python does."""
    for pipeline in list(_open_pipelines):
        pipeline._core.close()
