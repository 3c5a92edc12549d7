# SPDX-License-Identifier: BSD-3-Clause
"""holdfast.Pipeline: frames from arrays, threads, memory and errors."""

import gc
import os
import pathlib
import threading

import numpy
import psutil
import pytest

import holdfast

PIPELINE = {
    "camera": "tum_fr1",
    "features": {"orb": {"count": 600}},
    "optimizer": "ceres",
    "tracking": {"rolling_shutter": "off"},  # simulated images are exposed at once
}
SCENE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"]) / "examples/scenes/walking_xyz.yaml"
# 1000 in the slow test: a pipeline that leaks 5 kB shows there.
MEMORY_PIPELINES = int(os.environ.get("HOLDFAST_MEMORY_PIPELINES", "100"))


def test_gives_the_poses_of_a_run(config, frames):
    result = holdfast.run(config, {"source.simulated.duration": 0.7}, progress=False)
    with holdfast.Pipeline(PIPELINE) as pipeline:
        fed = [pipeline.feed(frame.timestamp, frame.colour, frame.depth) for frame in frames]
    assert fed[0].status == "initialised" and fed[-1].status == "tracked"
    assert fed[-1].T_world_camera.shape == (4, 4) and fed[-1].index == len(frames) - 1
    assert sum(fed[-1].stage_seconds.values()) > 0.0
    with pytest.warns(DeprecationWarning, match="FrameResult.trouble is now FrameResult.failure"):
        assert fed[-1].trouble == fed[-1].failure == "none"
    assert numpy.array_equal(pipeline.trajectory().poses, result.trajectory.poses)
    assert numpy.array_equal(pipeline.map.snapshot().points, result.map.snapshot().points)


def test_images_are_shared_not_copied(frames, fresh_modules):
    seen = []

    @holdfast.register("address_reader")
    class AddressReader(holdfast.Observer):
        def on_frame(self, frame, features, result):
            seen.append((frame.colour.ctypes.data, frame.depth.ctypes.data, frame.colour.flags.writeable))

    colour, depth = numpy.array(frames[0].colour), numpy.array(frames[0].depth)
    with holdfast.Pipeline({**PIPELINE, "observers": ["address_reader"]}) as pipeline:
        pipeline.feed(0.0, colour, depth)
        pipeline.feed(0.1, colour[:, ::1], depth)  # a view of the same memory
    assert seen == [(colour.ctypes.data, depth.ctypes.data, False)] * 2
    wide = numpy.zeros((480, 700, 3), numpy.uint8)
    part = wide[:, 20:660]
    assert holdfast.Frame(0.0, part).colour.ctypes.data == part.ctypes.data, "rows may be apart"
    mirrored = colour[:, ::-1]
    copied = holdfast.Frame(0.0, mirrored).colour
    assert copied.ctypes.data != colour.ctypes.data and numpy.array_equal(copied, mirrored)


def test_arrays_live_as_long_as_their_images(frames):
    frame = holdfast.Frame(0.0, numpy.full((480, 640, 3), 7, numpy.uint8))
    gc.collect()
    image = frame.colour
    del frame
    gc.collect()
    assert (image == 7).all()


@pytest.mark.parametrize(
    "colour, depth, message",
    [
        (
            numpy.zeros((480, 640, 4), numpy.uint8),
            None,
            r"colour: found an array of shape \(480, 640, 4\); expected .*uint8",
        ),
        (numpy.zeros((480, 640, 3)), None, r"colour: found an array of float64.*\.astype\(numpy.uint8\)"),
        (numpy.zeros((480, 640, 3), numpy.uint8), numpy.zeros((480, 640), numpy.uint16), "depth: .*/ 5000"),
        (numpy.zeros((480, 640, 3), numpy.uint8), numpy.zeros((480, 640)), r"depth: .*float64.*float32"),
        (numpy.zeros((480, 640, 3), numpy.uint8), numpy.zeros((240, 320), numpy.float32), "depth: has 320 x 240 px"),
        ("picture.png", None, "colour: found an object of type str"),
        (None, None, "colour: is None"),
    ],
)
def test_other_images_are_refused_with_a_remedy(colour, depth, message):
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(holdfast.InputError, match=message):
            pipeline.feed(0.0, colour, depth)


def test_stamps_are_numbers(frames):
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(TypeError, match="^feed: the time stamp is of type str; expected seconds, or a Frame$"):
            pipeline.feed("1.0", frames[0].colour, frames[0].depth)
        assert pipeline.feed(numpy.float64(1.0), frames[0].colour, frames[0].depth).timestamp == 1.0


@pytest.fixture(scope="module")
def pairs():
    """A simulated stereo camera."""
    return holdfast.simulate(overrides={"duration": 0.5}, camera="tum_fr3", stereo_baseline=0.11)


def test_stereo_pairs_give_the_poses_of_a_run(pairs):
    source = {"simulated": {"duration": 0.5, "stereo_baseline": 0.11}}
    config = {**PIPELINE, "camera": "tum_fr3", "source": source, "run": {"mode": "sequential"}}
    result = holdfast.run(config, progress=False)
    assert pairs[0].depth is None and pairs[0].right.shape == (480, 640, 3) and pairs.camera.baseline == 0.11
    fed = {**PIPELINE, "run": {"mode": "sequential"}}
    with holdfast.Pipeline(fed, camera=pairs.camera, stereo=True) as pipeline:
        for frame in pairs:
            last = pipeline.feed(frame.timestamp, frame.colour, right=frame.right)
    assert last.status == "tracked" and len(result.trajectory) == len(pairs)
    assert numpy.array_equal(pipeline.trajectory().poses, result.trajectory.poses)
    with holdfast.Pipeline(fed, camera=pairs.camera, stereo=True) as pipeline:
        for frame in pairs:
            pipeline.feed(frame)
    assert numpy.array_equal(pipeline.trajectory().poses, result.trajectory.poses)


def test_right_images_are_shared_and_may_be_grey(pairs):
    for right in (numpy.array(pairs[0].right), numpy.array(pairs[0].right[:, :, 1])):
        assert holdfast.Frame(0.0, pairs[0].colour, right=right).right.ctypes.data == right.ctypes.data
        with holdfast.Pipeline(PIPELINE, camera=pairs.camera, stereo=True) as pipeline:
            assert pipeline.feed(0.0, pairs[0].colour, right=right).status == "initialised"


def test_colour_may_be_grey(frames, fresh_modules):
    grey = [numpy.array(frame.colour[:, :, 1]) for frame in frames[:2]]
    assert holdfast.Frame(0.0, grey[0]).colour.ctypes.data == grey[0].ctypes.data
    with holdfast.Pipeline(PIPELINE) as pipeline:
        assert pipeline.feed(0.0, grey[0], frames[0].depth).status == "initialised"
    seen = []

    @holdfast.register("shape_reader")
    class ShapeReader(holdfast.Observer):
        def on_frame(self, frame, features, result):
            seen.append(frame.colour.shape)

    with holdfast.Pipeline({**PIPELINE, "observers": ["shape_reader"]}) as pipeline:
        pipeline.feed(0.0, grey[0], frames[0].depth)
    assert seen == [(480, 640, 3)], "modules get three channels"


def test_right_images_belong_to_stereo_pipelines(frames, pairs):
    left, right = pairs[0].colour, pairs[0].right
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(holdfast.InputError, match="right: the pipeline expects depth images; .*stereo=True"):
            pipeline.feed(0.0, left, right=right)
    with holdfast.Pipeline(PIPELINE, camera=pairs.camera, stereo=True) as pipeline:
        with pytest.raises(holdfast.InputError, match="has no right image"):
            pipeline.feed(0.0, left, frames[0].depth)
        with pytest.raises(holdfast.InputError, match="right: has 640 x 240 px; expected .* 640 x 480 px"):
            pipeline.feed(0.0, left, right=right[:240])
        with pytest.raises(holdfast.InputError, match="right: found an array of float64"):
            pipeline.feed(0.0, left, right=right / 255)
    with pytest.raises(holdfast.ConfigurationError, match="the camera of a stereo pair has distortion"):
        holdfast.Pipeline(PIPELINE, camera="tum_fr1", stereo=True)
    with pytest.raises(holdfast.InputError, match="stereo_baseline: is -"):
        holdfast.simulate(stereo_baseline=-0.1)


def test_stamps_rise(frames):
    with holdfast.Pipeline(PIPELINE) as pipeline:
        pipeline.feed(1.0, frames[0].colour, frames[0].depth)
        with pytest.raises(holdfast.InputError, match="time stamp"):
            pipeline.feed(1.0, frames[0].colour, frames[0].depth)


def test_two_at_once_from_threads_are_as_alone(frames):
    def poses(mode):
        with holdfast.Pipeline(PIPELINE, {"run.mode": mode}) as pipeline:
            for frame in frames:
                pipeline.feed(frame)
        return pipeline.trajectory().poses

    alone = poses("sequential")
    together = [None] * 3
    modes = ["sequential", "sequential", "threaded"]

    def work(index):
        together[index] = poses(modes[index])

    threads = [threading.Thread(target=work, args=(index,)) for index in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert numpy.array_equal(together[0], alone) and numpy.array_equal(together[1], alone)
    assert len(together[2]) == len(alone)


def test_map_is_seen_while_frames_come(frames):
    with holdfast.Pipeline(PIPELINE, {"run.mode": "threaded"}) as pipeline:
        for frame in frames:
            pipeline.feed(frame)
            snapshot = pipeline.map_snapshot()
            health = pipeline.health(patience=1000)
        assert health.state == "good" and health.reasons == [] and health.jump == 0
        assert health.frame == len(frames) - 1 and health.since_frame >= 0
        assert health.covariance.shape == (6, 6) and numpy.linalg.eigvalsh(health.covariance)[0] > 0
        assert len(snapshot.points) > 100 and len(snapshot.keyframes) >= 1
        with pytest.raises(holdfast.Error, match="not finished"):
            pipeline.map


def test_free_space_is_known_while_frames_come(frames):
    with holdfast.Pipeline(PIPELINE, {"surface.enabled": True, "surface.minimum_views": 1}) as pipeline:
        for frame in frames:
            pipeline.feed(frame)
        depth = numpy.array(frames[0].depth)
        ahead = float(numpy.median(depth[230:250, 310:330]))
        assert pipeline.is_free([0, 0, 0.5 * ahead]) is True and pipeline.is_free([0, 0, 99]) is False
        distances = pipeline.distance([[0, 0, 0.5 * ahead], [0, 0, ahead]])
        assert distances.shape == (2,) and distances[0] > distances[1]
        with pytest.raises(holdfast.InputError, match="shape"):
            pipeline.is_free([1, 2])
    with holdfast.Pipeline(PIPELINE) as pipeline:
        with pytest.raises(holdfast.Error, match="surface.enabled"):
            pipeline.distance([0, 0, 1])


def test_ends_once(frames):
    pipeline = holdfast.Pipeline(PIPELINE)
    pipeline.feed(frames[0])
    pipeline.finish()
    with pytest.raises(holdfast.Error, match="finished"):
        pipeline.feed(frames[1])
    pipeline.close()
    pipeline.close()
    assert len(pipeline.trajectory()) == 1 and "closed" in repr(pipeline)
    dropped = holdfast.Pipeline(PIPELINE)
    dropped.close()
    with pytest.raises(holdfast.Error, match="closed"):
        dropped.trajectory()


def test_exception_in_the_block_passes(frames):
    with pytest.raises(KeyError):
        with holdfast.Pipeline(PIPELINE) as pipeline:
            pipeline.feed(frames[0])
            raise KeyError("mine")
    assert "closed" in repr(pipeline)


def test_cameras_have_lenses():
    numbers = {"width": 640, "height": 480, "fx": 300, "fy": 300, "cx": 320, "cy": 240}
    without = {key: value for key, value in PIPELINE.items() if key != "camera"}
    for coefficients, length in (
        ({"k1": -0.05}, 5),
        ({"k1": 0.5, "k2": -2.6, "p1": 0.001, "k3": 1.5, "k4": 0.4, "k5": -2.4, "k6": 1.4}, 8),
        ({"lens": "fisheye", "k1": 0.01, "k4": -0.002}, 4),
    ):
        camera = holdfast.Camera(**numbers, **coefficients)
        assert camera.lens == coefficients.get("lens", "radial_tangential")
        assert len(camera.distortion) == length and camera.distortion[0] == coefficients["k1"]
        with holdfast.Pipeline(without, camera=camera) as pipeline:
            assert pipeline.camera == camera
    with pytest.raises(holdfast.InputError, match="did you mean 'fisheye'"):
        holdfast.Camera(**numbers, lens="fishy")
    with pytest.raises(holdfast.InputError, match="k1, k2, k3 and k4 alone"):
        holdfast.Camera(**numbers, lens="fisheye", p1=0.1)
    with pytest.raises(holdfast.InputError, match="no inverse in the image: from pixel"):
        holdfast.Camera(**numbers, k1=-0.4)


def test_refuses_a_perturbation_of_frames_that_are_fed():
    config = {**PIPELINE, "perturbation": {"seed": 3}}
    holdfast.Pipeline(config).close()
    with pytest.raises(holdfast.ConfigurationError, match="'perturbation' changes the frames of the configuration's"):
        holdfast.Pipeline(config, {"perturbation.calibration": 0.1})


def test_camera_can_be_given(frames):
    without = {key: value for key, value in PIPELINE.items() if key != "camera"}
    with pytest.raises(holdfast.ConfigurationError, match="camera is missing"):
        holdfast.Pipeline(without)
    known = holdfast.camera("tum_fr1")
    with holdfast.Pipeline(without, camera=known) as pipeline:
        assert pipeline.camera == known
    own = holdfast.Camera(width=640, height=480, fx=500, fy=500, cx=320, cy=240)
    with holdfast.Pipeline(without, camera=own) as pipeline:
        assert (pipeline.camera.fx, pipeline.camera.width) == (500, 640)
    with pytest.raises(holdfast.InputError, match="did you mean"):
        holdfast.camera("tum_fr11")


def test_source_of_the_configuration_is_not_opened(frames):
    config = {**PIPELINE, "source": {"tum": {"path": "/nowhere"}}}
    with holdfast.Pipeline(config) as pipeline:
        assert pipeline.feed(frames[0]).status == "initialised"


def test_segmenter_truth_reads_the_labels_of_frames():
    people = holdfast.simulate(SCENE, {"duration": 0.3})
    config = {**PIPELINE, "segmenter": "truth", "filters": ["semantic_mask"]}
    with holdfast.Pipeline(config, class_names=people.class_names) as pipeline:
        results = [pipeline.feed(frame) for frame in people]
    assert any(result.static_features < result.features for result in results)


def test_memory_of_dropped_pipelines_is_freed(frames):
    process = psutil.Process()

    def make(count):
        for _ in range(count):
            pipeline = holdfast.Pipeline(PIPELINE)
            pipeline.feed(frames[0])
            del pipeline
        gc.collect()

    make(100)
    before = process.memory_info().rss
    make(MEMORY_PIPELINES)
    assert process.memory_info().rss - before < 5e6
