# SPDX-License-Identifier: BSD-3-Clause
"""holdfast.run: the program's bytes, results, errors and Ctrl-C."""

import os
import pathlib
import signal
import subprocess
import sys
import threading
import time


import numpy
import pytest

import holdfast

PROGRAM = os.environ["HOLDFAST_PROGRAM"]


def program_run(folder, config_file, *options):
    subprocess.run([PROGRAM, "run", str(config_file), "--output", str(folder), "--quiet", *options], check=True)


def test_gives_the_bytes_of_the_program(config, tmp_path):
    config["loop_detector"] = "flann"
    file = tmp_path / "run.yaml"
    file.write_text(holdfast.load_config(config).to_yaml())
    program_run(tmp_path / "program", file)
    result = holdfast.run(file, output=tmp_path / "python", progress=False)
    for name in ("trajectory.txt", "keyframes.txt", "map.hfm", "static_map.ply", "evaluation.json", "config.yaml"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes(), name
    assert result.trajectory.to_text() == (tmp_path / "program" / "trajectory.txt").read_text()


@pytest.mark.data
def test_gives_the_bytes_of_the_program_on_a_recording(tmp_path):
    data = os.environ.get("HOLDFAST_DATA")
    recording = pathlib.Path(data or "") / "tum_fr1_xyz"
    if not data or not recording.is_dir():
        pytest.skip("HOLDFAST_DATA names no folder with tum_fr1_xyz")
    file = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"]) / "examples/configs/rgbd.yaml"
    program_run(tmp_path / "program", file, "--set", f"source.tum.path={recording}")
    holdfast.run(file, {"source.tum.path": recording}, tmp_path / "python", progress=False)
    for name in ("trajectory.txt", "keyframes.txt", "map.hfm"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes(), name


def test_result_holds_what_the_run_computed(config):
    calls = []
    result = holdfast.run(config, progress=lambda done, total, frame: calls.append((done, total, frame.status)))
    count = len(result.frame_stamps)
    assert calls[0][:2] == (1, count) and calls[-1][:2] == (count, count)
    assert result.trajectory.positions.shape == (len(result.trajectory), 3)
    assert result.coverage == 1.0 and not result.interrupted
    assert 0.0 < result.evaluation.ate_rmse < 0.02
    assert result.evaluation["ate_m"]["rmse"] == result.evaluation.ate_rmse
    assert {"stage", "median_s", "share"} <= set(result.stages[0])
    with pytest.warns(DeprecationWarning, match="'pieces_begun' of run.json is now 'submaps_begun'"):
        assert result.run_json["map"]["pieces_begun"] == result.run_json["map"]["submaps_begun"] == 0
    with pytest.raises(KeyError, match="submap"):
        result.run_json["submap"]
    assert result.tracking_seconds.shape == (count,)
    snapshot = result.map.snapshot()
    assert len(snapshot.keyframes) == result.map.keyframe_count > 0
    assert snapshot.points.shape == (result.map.point_count, 3) and numpy.isfinite(snapshot.points).all()
    assert "ATE RMSE" in repr(result)
    html = result._repr_html_()
    assert html.count("<svg") == 2 and "<table>" in html
    assert result.report_html().startswith("<!DOCTYPE html>")


def test_overrides_count_as_in_the_file(config):
    as_mapping = holdfast.load_config(config, {"features.orb.count": 700, "run.seed": 3})
    as_texts = holdfast.load_config(config, ["features.orb.count=700", "run.seed=3"])
    assert as_mapping.to_dict() == as_texts.to_dict()
    assert as_mapping.to_dict()["features"]["orb"]["count"] == 700
    assert as_mapping.to_dict()["run"]["seed"] == 3


def test_configuration_errors_are_all_there(config):
    config["features"] = {"orb": {"count": -5, "cuont": 3}}
    with pytest.raises(holdfast.ConfigurationError) as raised:
        holdfast.run(config, progress=False)
    assert len(raised.value.diagnostics) == 2
    assert raised.value.diagnostics[0].line == 1 and "cuont" in str(raised.value)
    assert isinstance(raised.value, ValueError)


def test_errors_have_the_text_of_the_program(tmp_path):
    file = tmp_path / "wrong.yaml"
    file.write_text("source: { simulatde: {} }\nfeatures: orb\noptimizer: ceres\n")
    program = subprocess.run([PROGRAM, "check", str(file)], capture_output=True, text=True)
    with pytest.raises(holdfast.ConfigurationError) as raised:
        holdfast.load_config(file)
    assert program.stderr == "".join(f"error: {line}\n" for line in str(raised.value).splitlines())


def test_output_folder_that_holds_something_is_refused(config, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(holdfast.InputError, match="not empty"):
        holdfast.run(config, output=tmp_path, progress=False)
    holdfast.run(config, {"source.simulated.duration": 0.2}, tmp_path, progress=False, overwrite=True)
    assert (tmp_path / "notes.txt").exists() and (tmp_path / "trajectory.txt").exists()


def test_a_map_can_be_continued(config, tmp_path):
    first = holdfast.run(config, {"loop_detector": "flann"}, progress=False)
    first.map.write(tmp_path / "map.hfm")
    assert holdfast.map_info(tmp_path / "map.hfm")["points"] == first.map.point_count
    read = holdfast.read_map(tmp_path / "map.hfm")
    assert numpy.array_equal(read.snapshot().points, first.map.snapshot().points)
    second = holdfast.run(config, {"loop_detector": "flann"}, progress=False, map=tmp_path / "map.hfm", localise=True)
    assert second.map.keyframe_count == first.map.keyframe_count and len(second.trajectory) > 0


def test_exception_of_progress_ends_the_run_with_its_results(config, tmp_path):
    def stop(done, total, frame):
        if done > 1:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        holdfast.run(config, output=tmp_path / "out", progress=stop)
    poses = len((tmp_path / "out" / "trajectory.txt").read_text().splitlines()) - 1
    assert 1 <= poses < 30 and (tmp_path / "out" / "run.json").exists()


def test_interrupt_ends_the_run_cleanly(config, tmp_path):
    threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        holdfast.run(config, {"source.simulated.duration": 600}, tmp_path / "out", progress=False)
    assert '"interrupted": true' in (tmp_path / "out" / "run.json").read_text()


def test_interrupt_ends_a_wait_for_a_client(config, tmp_path):
    config["observers"] = [{"foxglove": {"wait": True}}]
    try:
        holdfast.Pipeline(config).close()
    except holdfast.PluginError as error:
        pytest.skip(str(error))
    threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        holdfast.run(config, output=tmp_path / "out", progress=False)


def test_other_threads_go_on_during_a_run(config):
    counts = []
    running = threading.Event()

    def count():
        while running.is_set():
            counts.append(time.perf_counter())
            time.sleep(0.001)

    running.set()
    thread = threading.Thread(target=count)
    thread.start()
    holdfast.run(config, progress=False)
    running.clear()
    thread.join()
    # With the lock held for whole frames, the thread would count once a frame at most.
    assert len(counts) > 5 * 30


def test_module_is_the_program(tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    outcomes = [
        subprocess.run([*command, *words], capture_output=True, text=True, env=environment)
        for words in (["--help"], ["modules", "orb"], ["runn"], ["evaluate"])
        for command in ([sys.executable, "-m", "holdfast"], [PROGRAM])
    ]
    for module, program in zip(outcomes[::2], outcomes[1::2]):
        assert (module.returncode, module.stdout, module.stderr) == (
            program.returncode,
            program.stdout,
            program.stderr,
        )


OWN_CODE = """
import numpy, holdfast
@holdfast.register("darkness")
class Darkness(holdfast.Segmenter):
    classes = ["background", "person"]
    def __init__(self, threshold: int = 3):
        self.threshold = threshold
    def segment(self, frame):
        return (frame.colour.mean(axis=2) < self.threshold).astype(numpy.uint8)
"""


def run_module(folder, *words):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        [sys.executable, "-m", "holdfast", *words], capture_output=True, text=True, env=environment, cwd=folder
    )


@pytest.mark.parametrize("imports", [["--import", "own_code"], ["--import=own_code.py"]])
def test_program_imports_modules_in_python(config, tmp_path, imports):
    (tmp_path / "own_code.py").write_text(OWN_CODE)
    (tmp_path / "run.yaml").write_text(holdfast.load_config(config).to_yaml())
    choice = ["--set", "segmenter={darkness: {threshold: 5}}", "--set", "source.simulated.duration=0.3"]
    outcome = run_module(tmp_path, *imports, "run", "run.yaml", "--output", "out", *choice)
    assert outcome.returncode == 0, outcome.stderr
    assert "darkness:" in (tmp_path / "out" / "config.yaml").read_text()
    assert run_module(tmp_path, *imports, "check", "run.yaml", *choice).returncode == 0
    assert "threshold" in run_module(tmp_path, *imports, "modules", "darkness").stdout
    unknown = run_module(tmp_path, "check", "run.yaml", *choice)
    assert unknown.returncode == 2 and "there is no segmenter module 'darkness'" in unknown.stderr
    wrong = run_module(tmp_path, *imports, "check", "run.yaml", "--set", "segmenter={darkness: {treshold: 5}}")
    assert wrong.returncode == 2 and "threshold" in wrong.stderr


def test_matrix_of_the_program_knows_modules_in_python(config, tmp_path):
    (tmp_path / "own_code.py").write_text(OWN_CODE)
    config["segmenter"] = "none"
    (tmp_path / "base.yaml").write_text(holdfast.load_config(config).to_yaml())
    (tmp_path / "matrix.yaml").write_text(
        "title: own\nbase: base.yaml\naxes: { mask: { none: {}, dark: { segmenter: darkness } } }\nbaseline: none\n"
        "sequences: { office: { source: { simulated: { duration: 0.3 } } } }\n"
    )
    outcome = run_module(tmp_path, "--import", "own_code.py", "bench", "matrix.yaml", "--output", "out")
    assert outcome.returncode == 0, outcome.stderr
    statuses = {row["variant"]: row["status"] for row in holdfast.read_bench(tmp_path / "out").runs}
    assert statuses == {"none": "finished", "dark": "finished"}


@pytest.mark.parametrize(
    "words, message",
    [
        (["--import"], "error: --import: expected a name"),
        (["--import", "nowhere", "modules"], "error: --import: nowhere: there is no module 'nowhere'"),
        (["--import", "nowhere.py", "modules"], "nowhere.py: there is no such file"),
        (["--import", "numpy.py", "modules"], "a module 'numpy' is imported already; rename the file"),
        (["modules", "--import", "x"], "--import"),
    ],
)
def test_imports_that_are_not_there(tmp_path, words, message):
    (tmp_path / "numpy.py").write_text("")
    outcome = run_module(tmp_path / "..", *[str(tmp_path / word) if word == "numpy.py" else word for word in words])
    assert outcome.returncode == 2 and message in outcome.stderr and not outcome.stdout


def test_errors_of_imported_code_have_their_traceback(tmp_path):
    (tmp_path / "own_code.py").write_text("import holdfast\nimport a_package_that_is_missing\n")
    for name in ("own_code", "own_code.py"):
        outcome = run_module(tmp_path, "--import", name, "modules")
        assert outcome.returncode == 1 and "Traceback" in outcome.stderr and "own_code.py" in outcome.stderr
