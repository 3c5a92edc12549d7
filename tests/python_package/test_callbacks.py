# SPDX-License-Identifier: BSD-3-Clause
"""What a module may ask of the pipeline that calls it, and modules that are given as objects."""

import gc
import threading

import numpy
import pytest

import holdfast

PIPELINE = {"camera": "tum_fr1", "features": {"orb": {"count": 600}}, "optimizer": "ceres"}


class Caller(holdfast.Observer):
    """Calls its pipeline."""

    def __init__(self, call):
        self.call, self.pipeline, self.answers = call, None, []

    def on_frame(self, frame, features, result):
        self.answers.append(self.call(self.pipeline, frame))


CALLS = {
    "feed": lambda pipeline, frame: pipeline.feed(frame.timestamp + 1.0, frame.colour, frame.depth),
    "finish": lambda pipeline, frame: pipeline.finish(),
    "close": lambda pipeline, frame: pipeline.close(),
    "trajectory": lambda pipeline, frame: pipeline.trajectory(),
    "keyframes": lambda pipeline, frame: pipeline.keyframes(),
}


@pytest.mark.parametrize("mode", ["sequential", "threaded"])
@pytest.mark.parametrize("name", CALLS)
def test_what_would_wait_for_itself_is_refused(frames, name, mode):
    observer = Caller(CALLS[name])
    with holdfast.Pipeline(PIPELINE, {"run.mode": mode}, observers=[observer]) as pipeline:
        observer.pipeline = pipeline
        with pytest.raises(
            holdfast.InputError, match="was called by Caller.on_frame, a module of this pipeline"
        ) as raised:
            pipeline.feed(frames[0])
        assert isinstance(raised.value.__cause__, holdfast.Error) and "loop that feeds" in str(raised.value.__cause__)
        observer.call = lambda pipeline, frame: None
        pipeline.feed(frames[1])


def test_thread_of_the_pipeline_is_refused_too(frames):
    """A keyframe is seen by the mapping thread, for which finish() waits."""

    class OnKeyframe(holdfast.Observer):
        def on_keyframe(self, keyframe, map):
            self.pipeline.finish()

    observer = OnKeyframe()
    with pytest.raises(holdfast.InputError, match="finish: was called by OnKeyframe.on_keyframe"):
        with holdfast.Pipeline(PIPELINE, {"run.mode": "threaded"}, observers=[observer]) as pipeline:
            observer.pipeline = pipeline
            for frame in frames[:5]:
                pipeline.feed(frame)


@pytest.mark.parametrize("mode", ["sequential", "threaded"])
def test_snapshot_and_interrupt_are_allowed(frames, mode):
    observer = Caller(lambda pipeline, frame: (pipeline.interrupt(), len(pipeline.map_snapshot().points))[1])
    with holdfast.Pipeline(PIPELINE, {"run.mode": mode}, observers=[observer]) as pipeline:
        observer.pipeline = pipeline
        for frame in frames[:3]:
            pipeline.feed(frame)
    assert len(observer.answers) == 3 and observer.answers[-1] > 100


@pytest.mark.parametrize("observer", ["foxglove", "viewer"])
def test_interrupt_ends_a_wait_for_somebody(config, frames, observer):
    config["observers"] = [{observer: {"wait": True}}]
    try:
        watched = holdfast.Pipeline(config)
    except holdfast.PluginError as error:
        pytest.skip(str(error))
    with watched as pipeline:
        threading.Timer(0.5, pipeline.interrupt).start()
        pipeline.feed(frames[0])  # returns
        pipeline.feed(frames[1])


def test_filter_is_called_under_the_lock_of_the_map(frames):
    class Asking(holdfast.DynamicFilter):
        def apply(self, context, evidence):
            self.pipeline.map_snapshot()

    asking = Asking()
    with holdfast.Pipeline(PIPELINE, filters=[asking]) as pipeline:
        asking.pipeline = pipeline
        with pytest.raises(holdfast.InputError, match="map_snapshot: was called by Asking.apply"):
            for frame in frames[:3]:
                pipeline.feed(frame)


def test_another_pipeline_may_be_fed(frames):
    with holdfast.Pipeline(PIPELINE) as second:
        observer = Caller(lambda pipeline, frame: second.feed(frame).status)
        with holdfast.Pipeline(PIPELINE, observers=[observer]) as first:
            for frame in frames[:3]:
                first.feed(frame)
        assert len(second.trajectory()) == len(first.trajectory()) == 3


def test_snapshot_while_the_pipeline_is_closed(frames):
    """close() waits for the thread that asks for a snapshot."""
    inside, closing = threading.Event(), threading.Event()

    class Late(holdfast.Observer):
        def on_keyframe(self, keyframe, map):
            inside.set()
            assert closing.wait(60)
            threading.Event().wait(0.2)
            try:
                self.pipeline.map_snapshot()
            except holdfast.Error as error:
                self.error = str(error)

    late = Late()
    pipeline = holdfast.Pipeline(PIPELINE, {"run.mode": "threaded"}, observers=[late])
    late.pipeline = pipeline
    pipeline.feed(frames[0])
    assert inside.wait(60)
    closing.set()
    pipeline.close()
    assert "map_snapshot: the pipeline is closed" in late.error


def test_pipeline_may_be_collected_by_its_own_thread(frames):
    """Garbage collection runs in any thread, also in one of the pipeline that it collects."""
    dropped, collected = threading.Event(), threading.Event()

    class Collecting(holdfast.Observer):
        def on_keyframe(self, keyframe, map):
            assert dropped.wait(60)
            gc.collect()
            collected.set()

    gc.disable()
    try:
        pipeline = holdfast.Pipeline(PIPELINE, {"run.mode": "threaded"}, observers=[Collecting()])
        pipeline.feed(frames[0])
        cycle = [pipeline]
        cycle.append(cycle)
        del pipeline, cycle
        dropped.set()
        assert collected.wait(60)
    finally:
        gc.enable()


class Bright(holdfast.Segmenter):
    classes = ["background", "person"]

    def __init__(self, threshold):
        self.threshold, self.calls = threshold, 0

    def segment(self, frame):
        self.calls += 1
        return (frame.colour.mean(axis=2) > self.threshold).astype(numpy.uint8)


class NearBorder(holdfast.DynamicFilter):
    def __init__(self, margin=20.0):
        self.margin = margin

    def apply(self, context, evidence):
        evidence.add(numpy.where(context.features.raw_x < self.margin, -2.0, 0.0))


def test_modules_are_given_as_objects(config, frames, tmp_path, fresh_modules):
    bright, border = Bright(200), NearBorder(60.0)
    filters = ["semantic_mask", border, NearBorder(10.0)]
    with holdfast.Pipeline(PIPELINE, segmenter=bright, filters=filters) as pipeline:
        fed = [pipeline.feed(frame) for frame in frames]
    assert bright.calls > 0 and fed[-1].static_features < fed[-1].features

    # The same by name: objects are modules as registered classes are.
    holdfast.register("bright")(type("Named", (Bright,), {"__init__": lambda self: Bright.__init__(self, 200)}))
    holdfast.register("near_border")(NearBorder)
    by_name = {
        "segmenter": "bright",
        "filters": ["semantic_mask", {"near_border": {"margin": 60.0}}, {"near_border": {"margin": 10.0}}],
    }
    with holdfast.Pipeline({**PIPELINE, **by_name}) as named:
        for frame in frames:
            named.feed(frame)
    assert numpy.array_equal(named.trajectory().poses, pipeline.trajectory().poses)

    # In a run, in a mapping, in overrides, and over a configuration that was loaded.
    short = {"source.simulated.duration": 0.5}
    result = holdfast.run(config, short, tmp_path / "out", False, segmenter=bright, filters=filters)
    sections = result.configuration.to_dict()
    assert list(sections["segmenter"]) == ["own_bright"]
    assert [list(each)[0] for each in sections["filters"]] == ["semantic_mask", "own_near_border", "own_near_border_2"]
    assert "own_bright" in (tmp_path / "out" / "config.yaml").read_text()
    again = [
        holdfast.run({**config, "segmenter": bright, "filters": filters}, short, progress=False),
        holdfast.run(config, {**short, "segmenter": bright, "filters": filters}, progress=False),
        holdfast.run(holdfast.load_config(config), short, progress=False, segmenter=bright, filters=filters),
    ]
    for other in again:
        assert numpy.array_equal(other.trajectory.poses, result.trajectory.poses)


def test_source_extractor_and_observer_are_given_as_objects(config):
    simulation = holdfast.simulate(overrides={"duration": 0.5})

    class Frames(holdfast.FrameSource):
        def __iter__(self):
            return iter(simulation)

    class Empty(holdfast.FeatureExtractor):
        def extract(self, grey, ignore):
            return None

    class Counting(holdfast.Observer):
        count = 0

        def on_frame(self, frame, features, result):
            self.count += 1

    counting = Counting()
    result = holdfast.run(config, progress=False, source=Frames(), observers=[counting])
    assert counting.count == len(simulation) and result.coverage == 1.0
    assert len(holdfast.run(config, progress=False, source=Frames(), features=Empty()).trajectory) == 0


def test_segmenter_as_an_object_is_checked_as_a_registered_one(frames):
    class Odd(holdfast.Segmenter):
        classes = ["background", "person"]

        def segment(self, frame):
            return frame.colour

    with holdfast.Pipeline(PIPELINE, segmenter=Odd()) as pipeline:
        with pytest.raises(
            holdfast.InputError, match=r"Odd.segment returned labels of shape \(480, 640, 3\)"
        ) as raised:
            for frame in frames:
                pipeline.feed(frame)
    assert raised.value.location[0] == __file__

    class NoClasses(holdfast.Segmenter):
        def segment(self, frame):
            return None

    with pytest.raises(holdfast.InputError, match="classes"):
        holdfast.Pipeline(PIPELINE, segmenter=NoClasses())


@pytest.mark.parametrize(
    "parts, error, message",
    [
        ({"segmenter": Bright}, TypeError, "segmenter: found the class Bright; expected the name.*holdfast.Segmenter"),
        ({"segmenter": NearBorder()}, TypeError, "segmenter: found a NearBorder; expected"),
        ({"filters": ["semantic_mask", 3]}, TypeError, "filters: found a int; expected"),
        ({"observers": [type("Nothing", (holdfast.Observer,), {})()]}, holdfast.InputError, "observes nothing"),
        (
            {"features": type("Blind", (holdfast.FeatureExtractor,), {})()},
            holdfast.PluginError,
            "does not define extract",
        ),
        ({"segmenter": "brihgt"}, holdfast.ConfigurationError, "there is no segmenter module 'brihgt'"),
    ],
)
def test_other_objects_are_refused(parts, error, message):
    with pytest.raises(error, match=message):
        holdfast.Pipeline(PIPELINE, **parts)


def test_configuration_holds_no_objects(config):
    config["segmenter"] = Bright(3)
    with pytest.raises(TypeError, match="cannot hold a Bright; give it to holdfast.run or holdfast.Pipeline"):
        holdfast.load_config(config)


def test_right_images_are_refused(frames):
    """A pipeline that is not made for stereo pairs does not lose a second image without a word."""
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(holdfast.InputError, match="right: the pipeline expects depth images"):
            pipeline.feed(0.0, frames[0].colour, frames[0].depth, right=frames[0].colour)
        with pytest.raises(holdfast.InputError):
            pipeline.feed(0.0, frames[0].colour, frames[0].depth, frames[0].colour)


def test_frame_is_given_alone(frames):
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(TypeError, match="a Frame holds its images"):
            pipeline.feed(frames[0], frames[0].colour)
