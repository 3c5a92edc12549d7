# SPDX-License-Identifier: BSD-3-Clause
"""docs/python_reference.md is what the docstrings say, and every public name has one."""

import inspect
import os
import pathlib
import subprocess
import sys

import holdfast

SOURCE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])


def test_reference_is_up_to_date():
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    outcome = subprocess.run(
        [sys.executable, str(SOURCE / "docs/make_python_reference.py")],
        capture_output=True,
        text=True,
        env=environment,
    )
    assert outcome.returncode == 0, outcome.stderr
    page = (SOURCE / "docs/python_reference.md").read_text(encoding="utf-8")
    assert (
        page == outcome.stdout
    ), "write it anew: python3 docs/make_python_reference.py > docs/python_reference.md"


def test_every_public_name_is_documented():
    for name in holdfast.__all__:
        thing = getattr(holdfast, name)
        if name == "__version__":
            continue
        assert (thing.__doc__ or "").strip(), name
        if inspect.isclass(thing) and thing.__module__ != "holdfast._core":
            for member, value in vars(thing).items():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                    assert (value.__doc__ or "").strip(), f"{name}.{member}"
