# SPDX-License-Identifier: BSD-3-Clause
"""Modules in Python under the tests that the built-in modules pass: `python3 -m holdfast.conformance`."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

pytest.importorskip("holdfast._conformance", reason="the conformance tests are not built")
HERE = pathlib.Path(__file__).parent


def conformance(*words):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        [sys.executable, "-m", "holdfast.conformance", *map(str, words)],
        capture_output=True,
        text=True,
        env=environment,
        cwd=HERE,
    )


def test_modules_keep_their_contracts():
    outcome = conformance("conformant_modules.py", "--parameters", "segmenter: { dark_parts: { threshold: 60 } }")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    passed = re.findall(r"\[       OK \] (\w+/\w+)\.(\w+)", outcome.stdout)
    assert {"segmenter/dark_parts", "filters/far_away"} <= {module for module, _ in passed}
    # Those of a segmenter, a filter, and of every module, for which docs/conformance.md has the list.
    checks = {name: {check for module, check in passed if module == name} for name, _ in passed}
    assert len(checks["segmenter/dark_parts"]) >= 17 and "InstancesDoNotMeet" in checks["segmenter/dark_parts"]
    assert len(checks["filters/far_away"]) >= 17 and "NeverTakesAway" in checks["filters/far_away"]
    assert "SKIPPED" not in outcome.stdout and "FAILED" not in outcome.stdout


def test_modules_of_the_example_keep_their_contracts():
    source = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])
    outcome = conformance(source / "examples/python/own_modules.py")
    assert outcome.returncode == 0, outcome.stdout + outcome.stderr
    assert "segmenter/bright" in outcome.stdout and "filters/near_border" in outcome.stdout


def test_broken_contracts_are_found():
    outcome = conformance("broken_modules.py")
    assert outcome.returncode == 1
    failed = set(re.findall(r"\[  FAILED  \] (\w+/\w+\.\w+)", outcome.stdout))
    assert {"segmenter/remembers.SameFramesSameResults", "filters/counts.SameContextsSameEvidence"} <= failed
    assert "holdfast/interfaces/segmenter.hpp" in outcome.stdout, "the sentence of the contract"


def test_selection():
    outcome = conformance("broken_modules.py", "--module", "filters/counts", "--gtest_filter=*NeedsStay")
    assert outcome.returncode == 0 and "1 test from" in outcome.stdout and "remembers" not in outcome.stdout


@pytest.mark.parametrize(
    "words, message",
    [
        (["broken_modules.py", "--module", "cuonts"], "known are segmenter/remembers, filters/counts"),
        (["broken_modules.py", "--parameters", "filters: { counts: { speed: 3 } }"], "speed"),
        (["json"], "has no module that can be tested"),
        (["nowhere.py"], "there is no such file"),
        (["broken_modules.py", "--modul", "x"], "module"),
    ],
)
def test_other_requests_are_refused(words, message):
    outcome = conformance(*words)
    assert outcome.returncode == 2 and message in outcome.stderr
