# SPDX-License-Identifier: BSD-3-Clause
"""The examples and the notebook run."""

import json
import os
import pathlib
import subprocess
import sys

import numpy
import pytest

import holdfast

SOURCE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])
EXAMPLES = SOURCE / "examples"


def environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "MPLBACKEND": "Agg"}


@pytest.mark.parametrize(
    "name, expected",
    [("run_and_compare.py", "with masks"), ("feed_frames.py", "map points"), ("own_modules.py", "ATE RMSE")],
)
def test_example_runs(name, expected, tmp_path):
    outcome = subprocess.run(
        [sys.executable, str(EXAMPLES / "python" / name), "1.0"],
        capture_output=True,
        text=True,
        env=environment(),
        cwd=tmp_path,
    )
    assert outcome.returncode == 0, outcome.stderr
    assert expected in outcome.stdout


def test_notebook_runs(monkeypatch):
    monkeypatch.chdir(EXAMPLES / "notebooks")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {"__name__": "__main__"}
    notebook = json.loads((EXAMPLES / "notebooks/from_recording_to_ablation.ipynb").read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 5
    for number, cell in enumerate(cells):
        exec(compile(cell, f"cell {number}", "exec"), names)  # the cells of our own notebook, as a kernel runs them
    assert [row[0] for row in names["table"]] == ["static", "geometry", "masks"]
    assert "report.html" in {file.name for file in (names["folder"] / "masks").iterdir()}
    holdfast.unregister("segmenter", "true_people")


def test_segmenter_of_a_torch_file_runs(tmp_path, config):
    torch = pytest.importorskip("torch")

    class Bright(torch.nn.Module):
        def forward(self, image):
            grey = image.mean(dim=1, keepdim=True) - 0.7
            return torch.cat([-grey, grey], dim=1)

    torch.jit.script(Bright()).save(str(tmp_path / "bright.pt"))
    sys.path.insert(0, str(EXAMPLES / "python"))
    try:
        import torch_segmenter  # noqa: F401
    finally:
        sys.path.pop(0)
    config["segmenter"] = {"network_file": {"file": str(tmp_path / "bright.pt")}}
    config["filters"] = ["semantic_mask"]
    try:
        result = holdfast.run(config, {"source.simulated.duration": 0.3}, progress=False)
        assert len(result.trajectory) > 5
        labels, confidence = torch_segmenter.NetworkFile(tmp_path / "bright.pt").segment(
            holdfast.Frame(0.0, numpy.full((8, 8, 3), 255, numpy.uint8))
        )
        assert (labels == 1).all() and (confidence > 127).all()
    finally:
        holdfast.unregister("segmenter", "network_file")
