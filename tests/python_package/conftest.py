# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python package share: short simulated scenes, and configurations over them."""

import os
import pathlib
from typing import Any, Dict, List

import numpy
import pytest

import holdfast

SOURCE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])


def pytest_configure(config: Any) -> None:
    """Names the marks of these tests."""
    config.addinivalue_line("markers", "data: needs a recording in the folder HOLDFAST_DATA")


@pytest.fixture
def config() -> Dict[str, Any]:
    """A run of a second through the empty office."""
    return {
        "source": {"simulated": {"duration": 1.0}},
        "camera": "tum_fr1",
        "features": {"orb": {"count": 600}},
        "optimizer": "ceres",
        "run": {"mode": "sequential"},
    }


@pytest.fixture(scope="session")
def frames() -> List[holdfast.Frame]:
    """The first frames of the empty office."""
    simulation = holdfast.simulate(overrides={"duration": 0.7})
    return list(simulation)


@pytest.fixture
def arrays(frames: List[holdfast.Frame]) -> Any:
    """The frames as (timestamp, colour, depth) in arrays of their own."""
    return [(frame.timestamp, numpy.array(frame.colour), numpy.array(frame.depth)) for frame in frames]


@pytest.fixture
def fresh_modules() -> Any:
    """Takes away what a test registers."""
    before = set(holdfast.registered())
    yield
    for kind, name in set(holdfast.registered()) - before:
        holdfast.unregister(kind, name)
