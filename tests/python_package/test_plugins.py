# SPDX-License-Identifier: BSD-3-Clause
"""Modules in Python: from YAML by name, their contracts, and their errors."""

import pathlib
import threading
from typing import Annotated, List

import numpy
import pytest

import holdfast

pytestmark = pytest.mark.usefixtures("fresh_modules")


def run(config, **overrides):
    return holdfast.run(config, {"source.simulated.duration": 0.5, **overrides}, progress=False)


def define_bright():
    @holdfast.register("bright", paper="none")
    class Bright(holdfast.Segmenter):
        """Calls bright pixels a person.

        More words.
        """

        classes = ["background", "person"]
        movable = ["person"]

        def __init__(self, threshold: Annotated[int, holdfast.Parameter("grey level", minimum=0, maximum=255)] = 180):
            self.threshold = threshold
            self.frames = []
            made.append(self)

        def segment(self, frame):
            self.frames.append(frame.index)
            return (frame.colour.mean(axis=2) > self.threshold).astype(numpy.uint8)

    made: List[Bright] = []
    return made


@pytest.mark.parametrize("mode", ["sequential", "threaded"])
def test_segmenter_from_yaml(config, tmp_path, mode):
    made = define_bright()
    file = tmp_path / "run.yaml"
    config["filters"] = ["semantic_mask"]
    file.write_text(
        holdfast.load_config(config).to_yaml().replace("segmenter: none", "segmenter: { bright: { threshold: 120 } }")
        if "segmenter: none" in holdfast.load_config(config).to_yaml()
        else "segmenter: { bright: { threshold: 120 } }\n" + yaml_of(config)
    )
    result = holdfast.run(
        file, {"source.simulated.duration": 0.5, "run.mode": mode}, tmp_path / "out", progress=False
    )
    assert made[-1].threshold == 120 and made[-1].frames
    assert len(result.trajectory) > 0
    assert "bright" in (tmp_path / "out" / "config.yaml").read_text()


def yaml_of(config):
    import json

    return "\n".join(f"{key}: {json.dumps(value)}" for key, value in config.items())


def test_reference_knows_registered_modules():
    define_bright()
    entry = next(entry for entry in holdfast.modules() if entry["name"] == "bright")
    assert entry["kind"] == "segmenter" and entry["summary"] == "Calls bright pixels a person."
    (parameter,) = entry["parameters"]
    assert (parameter["name"], parameter["default"], parameter["maximum"]) == ("threshold", 180, 255)
    assert not any(entry["name"] == "fed_frames" for entry in holdfast.modules())


def test_parameters_are_checked_as_those_of_built_in_modules(config):
    define_bright()
    config["segmenter"] = {"bright": {"threshold": 300, "tresh": 1}}
    with pytest.raises(holdfast.ConfigurationError) as raised:
        holdfast.load_config(config)
    assert len(raised.value.diagnostics) == 2 and "255" in str(raised.value) and "tresh" in str(raised.value)
    config["segmenter"] = "brihgt"
    with pytest.raises(holdfast.ConfigurationError, match="bright"):
        holdfast.load_config(config)


def test_file_segmenter_runs_too(config, tmp_path):
    (tmp_path / "own.py").write_text(
        "import numpy\nclass Segmenter:\n    classes = ['background', 'person']\n"
        "    def segment(self, image):\n        return (image[:, :, 0] > 200).astype(numpy.uint8)\n"
    )
    config["segmenter"] = {"python": {"file": str(tmp_path / "own.py")}}
    config["filters"] = ["semantic_mask"]
    for mode in ("sequential", "threaded"):
        assert len(run(config, **{"run.mode": mode}).trajectory) > 0


def test_error_has_the_traceback_and_the_cause(config):
    @holdfast.register("broken")
    class Broken(holdfast.Segmenter):
        classes = ["background"]

        def segment(self, frame):
            raise KeyError("weights")

    config["segmenter"] = "broken"
    for mode in ("sequential", "threaded"):
        with pytest.raises(holdfast.RunError, match="Broken.segment raised KeyError") as raised:
            run(config, **{"run.mode": mode})
        assert "Traceback" in str(raised.value) and 'raise KeyError("weights")' in str(raised.value)
        assert isinstance(raised.value.result, holdfast.Result)
    frame = holdfast.simulate(overrides={"duration": 0.1})[0]
    with holdfast.Pipeline({**config, "run": {"mode": "sequential"}}) as pipeline:
        with pytest.raises(holdfast.InputError) as raised:
            pipeline.feed(frame)
        assert isinstance(raised.value.__cause__, KeyError)


def test_interrupt_inside_a_module_is_one(config):
    @holdfast.register("interrupted")
    class Interrupted(holdfast.Observer):
        def on_frame(self, frame, features, result):
            raise KeyboardInterrupt

    config["observers"] = ["interrupted"]
    with pytest.raises(KeyboardInterrupt):
        run(config)


@pytest.mark.parametrize(
    "result, message",
    [
        (lambda image: image, r"Odd.segment returned labels of shape \(480, 640, 3\)"),
        (lambda image: numpy.zeros((480, 640)), "float64.*astype"),
        (lambda image: numpy.full((480, 640), 9, numpy.uint8), "label 9 at row 0"),
        (lambda image: "mask", "type str"),
    ],
)
def test_segmenter_results_are_checked(config, result, message):
    @holdfast.register("odd")
    class Odd(holdfast.Segmenter):
        classes = ["background", "person"]

        def segment(self, frame):
            return result(frame.colour)

    config["segmenter"] = "odd"
    with pytest.raises(holdfast.RunError, match=message):
        run(config)


def test_filter_decides(config):
    seen = {}

    @holdfast.register("left_half")
    class LeftHalf(holdfast.DynamicFilter):
        """Distrusts the left half of the image."""

        needs = ["depth", "matches"]

        def __init__(self, share: float = 0.5, names: List[str] = ["a"], context: holdfast.Creation = None):
            self.border = share * context.camera.width
            seen["context"] = context

        def apply(self, context, evidence):
            features = context.features
            seen["shapes"] = (context.points.shape, features.descriptors.shape, len(evidence))
            seen["pose"] = context.T_world_camera
            seen["matched"] = numpy.isfinite(context.points[:, 0]).sum()
            seen["view"] = context
            evidence.add(numpy.where(features.x < self.border, -5.0, 0.0))
            assert evidence.log_odds.min() == -5.0

    plain = run(config)
    config["filters"] = [{"left_half": {"share": 0.4}}]
    result = run(config)
    camera = seen["context"].camera
    assert seen["context"].seed == 1 and camera.name == "tum_fr1" and camera.fx == holdfast.camera("tum_fr1").fx
    assert camera.readout == 0.0  # simulated images are exposed at once
    count = seen["shapes"][2]
    assert seen["shapes"] == ((count, 3), (count, 32), count) and count > 300
    assert seen["matched"] > 20 and numpy.allclose(seen["pose"][3], [0, 0, 0, 1])
    assert not numpy.array_equal(plain.trajectory.poses, result.trajectory.poses)
    assert numpy.array_equal(result.trajectory.poses, run(config).trajectory.poses), "the same bits on repeat"
    with pytest.raises(holdfast.Error, match="valid during the call only"):
        seen["view"].points


@pytest.mark.parametrize(
    "log_odds, message",
    [
        (lambda n: numpy.zeros(n + 1), r"log_odds: found an array of shape"),
        (lambda n: numpy.full(n, numpy.nan), "is nan; expected finite numbers"),
        (lambda n: ["a"] * n, "expected an array of numbers"),
    ],
)
def test_filter_evidence_is_checked(config, log_odds, message):
    @holdfast.register("odd_filter")
    class OddFilter(holdfast.DynamicFilter):
        def apply(self, context, evidence):
            evidence.add(log_odds(len(evidence)))

    config["filters"] = ["odd_filter"]
    with pytest.raises(holdfast.RunError, match=message):
        run(config)


def test_filter_needs_are_checked(config):
    @holdfast.register("needy")
    class Needy(holdfast.DynamicFilter):
        needs = ["segmentation"]

        def apply(self, context, evidence):
            pass

    config["filters"] = ["needy"]
    with pytest.raises(holdfast.ConfigurationError, match="needs a segmentation"):
        run(config)


@pytest.mark.parametrize("mode", ["sequential", "threaded"])
def test_observer_sees_the_run(config, mode):
    seen = []

    @holdfast.register("watcher")
    class Watcher(holdfast.Observer):
        def on_frame(self, frame, features, result):
            seen.append(("frame", frame.index, len(features), result.index))

        def on_keyframe(self, keyframe, map):
            seen.append(("keyframe", keyframe, len(map.snapshot().points)))

        def on_finish(self, map):
            seen.append(("finish", len(map.keyframes)))

    config["observers"] = ["watcher"]
    result = run(config, **{"run.mode": mode})
    kinds = [event[0] for event in seen]
    assert kinds.count("frame") == len(result.frame_stamps) and kinds.count("finish") == 1
    assert "keyframe" in kinds and seen[-1] == ("finish", result.map.keyframe_count)


def test_source_yields_frames(config):
    simulation = holdfast.simulate(overrides={"duration": 0.5})

    @holdfast.register("own_source")
    class OwnSource(holdfast.FrameSource):
        camera = simulation.camera
        frame_count = len(simulation)

        def __iter__(self):
            for frame in simulation:
                yield frame.timestamp, numpy.array(frame.colour), numpy.array(frame.depth)

        def truth(self):
            return simulation.truth

    expected = run(config)
    del config["camera"]
    config["source"] = "own_source"
    for mode in ("sequential", "threaded"):
        result = holdfast.run(config, {"run.mode": mode, "tracking.rolling_shutter": "off"}, progress=False)
        assert len(result.frame_stamps) == len(simulation) and result.evaluation is not None
        if mode == "sequential":
            assert numpy.array_equal(result.trajectory.poses, expected.trajectory.poses)


def test_source_yields_stereo_pairs(config):
    simulation = holdfast.simulate(overrides={"duration": 0.5}, camera="tum_fr3", stereo_baseline=0.11)

    @holdfast.register("own_pairs")
    class OwnPairs(holdfast.FrameSource):
        camera = simulation.camera
        has_depth = False
        has_right = True

        def __iter__(self):
            for frame in simulation:
                yield frame.timestamp, frame.colour, None, frame.right

    config["source"] = {"simulated": {"stereo_baseline": 0.11}}
    config["camera"] = "tum_fr3"
    expected = run(config)
    del config["camera"]
    config["source"] = "own_pairs"
    assert len(expected.trajectory) == len(simulation)
    result = holdfast.run(config, progress=False)
    assert numpy.array_equal(result.trajectory.poses, expected.trajectory.poses)


@pytest.mark.parametrize(
    "items, message",
    [
        ([3], "yielded an object of type int"),
        ([(0.0, numpy.zeros((480, 640, 3), numpy.uint8))] * 2, "time stamps in seconds that rise strictly"),
        ([(0.0, numpy.zeros((480, 640, 4), numpy.uint8))], "colour: found an array of shape"),
    ],
)
def test_source_is_checked(config, items, message):
    @holdfast.register("odd_source")
    class OddSource(holdfast.FrameSource):
        def __iter__(self):
            return iter(items)

    config["source"] = "odd_source"
    with pytest.raises(holdfast.RunError, match=message):
        holdfast.run(config, progress=False)


def test_extractor_gives_features(config):
    cv2 = pytest.importorskip("cv2")

    @holdfast.register("cv_orb")
    class CvOrb(holdfast.FeatureExtractor):
        levels = 8
        factor = 1.2

        def __init__(self):
            self.orb = cv2.ORB_create(800)

        def extract(self, grey, ignore):
            keypoints, descriptors = self.orb.detectAndCompute(grey, None)
            return holdfast.Features(
                [k.pt[0] for k in keypoints],
                [k.pt[1] for k in keypoints],
                descriptors,
                octave=[k.octave for k in keypoints],
                angle=numpy.radians([k.angle for k in keypoints]) % 6.283185,
                response=[k.response for k in keypoints],
            )

    config["features"] = "cv_orb"
    result = run(config)
    assert result.coverage > 0.9 and result.evaluation.ate_rmse < 0.05


def test_extractor_of_numbers(config):
    cv2 = pytest.importorskip("cv2")

    @holdfast.register("cv_sift")
    class CvSift(holdfast.FeatureExtractor):
        descriptors = "float32"
        length = 128
        strict_distance = 200.0
        loose_distance = 300.0

        def __init__(self):
            self.sift = cv2.SIFT_create(600)

        def extract(self, grey, ignore):
            keypoints, descriptors = self.sift.detectAndCompute(grey, None)
            return holdfast.Features([k.pt[0] for k in keypoints], [k.pt[1] for k in keypoints], descriptors)

    @holdfast.register("look_at_descriptors")
    class Look(holdfast.DynamicFilter):
        seen = None

        def apply(self, context, evidence):
            Look.seen = context.features.descriptors

    config["features"] = "cv_sift"
    config["filters"] = ["look_at_descriptors"]
    result = run(config)
    assert result.coverage > 0.9 and result.evaluation.ate_rmse < 0.05
    assert Look.seen.dtype == numpy.float32 and Look.seen.shape[1] == 128 and Look.seen.max() > 1


@pytest.mark.parametrize("name, value", [("descriptors", "text"), ("metric", "manhattan"), ("length", 0)])
def test_impossible_descriptors_are_named(config, name, value):
    @holdfast.register("impossible")
    class Impossible(holdfast.FeatureExtractor):
        def extract(self, grey, ignore):
            return None

    setattr(Impossible, name, value)
    config["features"] = "impossible"
    with pytest.raises(holdfast.Error, match=name if name != "length" else "length is 0"):
        run(config)


@pytest.mark.parametrize(
    "features, message",
    [
        (lambda: holdfast.Features([1.0], [1.0], numpy.zeros((1, 16), numpy.uint8)), r"shape \(1, 16\)"),
        (lambda: holdfast.Features([700.0], [1.0], numpy.zeros((1, 32), numpy.uint8)), "outside the image"),
        (lambda: holdfast.Features([1.0], [1.0], numpy.zeros((1, 32), numpy.uint8), octave=[5]), "octave 5"),
        (lambda: [1], "type list"),
    ],
)
def test_extractor_results_are_checked(config, features, message):
    @holdfast.register("odd_features")
    class OddFeatures(holdfast.FeatureExtractor):
        def extract(self, grey, ignore):
            return features()

    config["features"] = "odd_features"
    with pytest.raises(holdfast.RunError, match=message):
        run(config)


def test_registration_is_checked():
    with pytest.raises(holdfast.PluginError, match="lower case"):
        holdfast.register("My Segmenter")
    with pytest.raises(holdfast.PluginError, match="not below one of the interfaces"):
        holdfast.register("nothing")(type("Nothing", (), {}))
    with pytest.raises(holdfast.PluginError, match="does not define segment"):
        holdfast.register("empty")(type("Empty", (holdfast.Segmenter,), {}))
    with pytest.raises(holdfast.PluginError, match="taken by one of Holdfast itself"):
        holdfast.register("unet")(type("Mine", (holdfast.Segmenter,), {"segment": lambda self, frame: None}))

    class Complicated(holdfast.Observer):
        def __init__(self, table: dict = {}):
            pass

    with pytest.raises(holdfast.PluginError, match="'table'.*expected one of bool"):
        holdfast.register("complicated")(Complicated)


def test_class_may_be_defined_again_but_not_by_another():
    first, second = define_bright(), define_bright()
    assert first is not second
    other = type("Other", (holdfast.Segmenter,), {"segment": lambda self, frame: None})
    with pytest.raises(holdfast.PluginError, match="taken"):
        holdfast.register("bright")(other)


def test_paths_and_lists_arrive_with_their_types(config, tmp_path):
    seen = {}

    @holdfast.register("typed")
    class Typed(holdfast.Observer):
        def __init__(self, file: pathlib.Path, gains: List[float] = [1.0], flag: bool = False, name: str = "x"):
            seen.update(locals())

        def on_finish(self, map):
            pass

    config["observers"] = [{"typed": {"file": "a/b.txt", "gains": [1, 2.5], "flag": True}}]
    run(config)
    assert isinstance(seen["file"], pathlib.Path) and seen["file"].name == "b.txt"
    assert (seen["gains"], seen["flag"], seen["name"]) == ([1.0, 2.5], True, "x")
    config["observers"] = ["typed"]
    with pytest.raises(holdfast.ConfigurationError, match="file"):
        holdfast.load_config(config)


def test_lock_is_free_while_another_thread_segments(config, fresh_modules):
    """A segmenter that waits for the main thread would never return if C++ held the lock."""
    event = threading.Event()

    @holdfast.register("waiting")
    class Waiting(holdfast.Segmenter):
        classes = ["background"]

        def segment(self, frame):
            assert event.wait(60)
            return None

    config["segmenter"] = "waiting"
    config["run"] = {"mode": "threaded"}
    threading.Timer(0.2, event.set).start()
    assert len(run(config).trajectory) > 0
