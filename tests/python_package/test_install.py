# SPDX-License-Identifier: BSD-3-Clause
"""`pip install .` into a clean virtual environment that sees the packages of the system."""

import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["HOLDFAST_SOURCE_DIR"])
FILES = (
    "CMakeLists.txt",
    "LICENSE",
    "README.md",
    "pyproject.toml",
    "setup.py",
    "cmake",
    "include",
    "modules",
    "plugins",
    "examples",
    "third_party",
)

USE = """
import holdfast, pathlib
assert pathlib.Path(holdfast.__file__).is_relative_to({environment!r}), holdfast.__file__
assert (pathlib.Path(holdfast.__file__).parent / "py.typed").exists()
assert len(holdfast.simulate(overrides={{"duration": 0.2}})) > 3
pathlib.Path("own.py").write_text(
    "import numpy\\nclass Segmenter:\\n    classes = ['background']\\n    def segment(self, image): return None\\n")
config = {{"source": {{"simulated": {{"duration": 0.3}}}}, "camera": "tum_fr1", "features": "orb", "optimizer": "ceres",
          "segmenter": {{"python": {{"file": "own.py"}}}}}}
assert len(holdfast.run(config, progress=False).trajectory) > 3
"""


def test_pip_installs_a_package_that_works(tmp_path):
    pytest.importorskip("setuptools")
    pytest.importorskip("wheel")
    clone = tmp_path / "clone"
    clone.mkdir()
    for name in FILES:
        (clone / name).symlink_to(SOURCE / name)
    environment = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", str(environment)], check=True)
    python = environment / "bin" / "python"
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    clean.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", "2")
    subprocess.run(
        [str(python), "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "-v", "."],
        check=True,
        cwd=clone,
        env={**clean, "HOLDFAST_BUILD_FOLDER": str(tmp_path / "build")},
    )
    subprocess.run([str(python), "-c", USE.format(environment=str(environment))], check=True, cwd=tmp_path, env=clean)
    for command in ([str(python), "-m", "holdfast"], [str(environment / "bin" / "holdfast")]):
        outcome = subprocess.run([*command, "--help"], capture_output=True, text=True, env=clean, cwd=tmp_path)
        assert outcome.returncode == 0 and "holdfast run" in outcome.stdout
