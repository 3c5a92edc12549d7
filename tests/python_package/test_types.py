# SPDX-License-Identifier: BSD-3-Clause
"""The package and the examples are typed, and the stub of the extension names what the extension has."""

import ast
import os
import pathlib
import subprocess
import sys

import numpy
import pytest

from holdfast import _core

SOURCE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])
# Files of the segmenter `python` stand alone: they know nothing of the package.
EXAMPLES = [
    file for file in sorted((SOURCE / "examples/python").glob("*.py")) if "import holdfast" in file.read_text()
]


def test_type_checker_finds_nothing(tmp_path):
    pytest.importorskip("mypy")
    targets = [SOURCE / "modules/python/holdfast", *EXAMPLES]
    environment = {**os.environ, "MYPYPATH": str(SOURCE / "modules/python"), "PYTHONPATH": ""}
    outcome = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--strict",
            "--python-version",
            "3.9" if int(numpy.__version__.split(".")[0]) < 2 else "3.10",  # as the declarations of numpy need
            "--cache-dir",
            str(tmp_path),
            *map(str, targets),
        ],
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
    )
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr


def test_stub_names_what_the_extension_has():
    stub = ast.parse((SOURCE / "modules/python/holdfast/_core.pyi").read_text())
    names = {}
    for node in stub.body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {part.name for part in node.body if isinstance(part, ast.FunctionDef)} | {
                part.target.id for part in node.body if isinstance(part, ast.AnnAssign)
            }
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = None
        elif isinstance(node, ast.AnnAssign):
            names[node.target.id] = None
    there = {name for name in vars(_core) if not name.startswith("_")}
    assert there == {name for name in names if not name.startswith("_")}
    for name, members in names.items():
        if members is None:
            continue
        own = {member for member in vars(getattr(_core, name)) if not member.startswith("_")}
        assert own == {member for member in members if not member.startswith("_")} - {"features", "previous"} | (
            own & {"features", "previous"}
        ), name
