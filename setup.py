# SPDX-License-Identifier: BSD-3-Clause
"""Builds the Python package by CMake, for `pip install . --no-build-isolation`.

HOLDFAST_BUILD_FOLDER names a build folder to keep, so that the next build compiles only what changed; CMAKE_ARGS are
passed to CMake; CMAKE_BUILD_PARALLEL_LEVEL is the number of compilers at once.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

here = Path(__file__).parent.resolve()


class CMakeExtension(Extension):
    """What CMake builds: setuptools only knows its name."""

    def __init__(self, name: str) -> None:
        super().__init__(name, sources=[])


class BuildByCMake(build_ext):
    """Configures, builds and installs the component bindings into the folder that setuptools packs."""

    def build_extension(self, extension: Extension) -> None:
        package = Path(self.get_ext_fullpath(extension.name)).resolve().parent
        build = Path(os.environ.get("HOLDFAST_BUILD_FOLDER", self.build_temp)).resolve()
        build.mkdir(parents=True, exist_ok=True)
        self.run_step(
            ["cmake", "-S", str(here), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
            + [
                "-DHOLDFAST_PYTHON=ON",
                "-DHOLDFAST_PYTHON_PACKAGE=ON",
                "-DHOLDFAST_PYTHON_FOLDER=.",
                "-DHOLDFAST_UNITY=ON",
            ]
            + [f"-DHOLDFAST_BUILD_{part}=OFF" for part in ("TESTS", "EXAMPLES", "BENCHMARKS", "BRIDGE")]
            + [f"-DPython3_EXECUTABLE={sys.executable}"]
            + shlex.split(os.environ.get("CMAKE_ARGS", ""))
        )
        self.run_step(["cmake", "--build", str(build), "--target", "holdfast_python_package"])
        self.run_step(
            [
                "cmake",
                "--install",
                str(build),
                "--prefix",
                str(package.parent),
                "--component",
                "bindings",
                "--strip",
            ]
        )

    @staticmethod
    def run_step(command: "list[str]") -> None:
        print(shlex.join(command), flush=True)
        try:
            subprocess.run(command, check=True)
        except FileNotFoundError:
            sys.exit("cmake was not found; `sh cmake/install_dependencies.sh --python` installs what is needed")
        except subprocess.CalledProcessError as error:
            sys.exit(
                f"`{shlex.join(command[:2])}` failed with {error.returncode}, see above; "
                "`sh cmake/install_dependencies.sh --python` installs what is needed"
            )


version = re.search(r"project\(holdfast VERSION ([0-9.]+)", (here / "CMakeLists.txt").read_text(encoding="utf-8"))
assert version is not None
setup(version=version.group(1), ext_modules=[CMakeExtension("holdfast._core")], cmdclass={"build_ext": BuildByCMake})
