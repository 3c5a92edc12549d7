#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# From a fresh clone to the verdict of all tests: installs what is missing, builds everything, runs every test but for
# those that the nightly run alone has time for (label nightly). Tests on recordings run when HOLDFAST_DATA names the
# folder that holds them, and say that they were skipped otherwise.
#
#   sh cmake/test.sh [BUILD_FOLDER]        BUILD_FOLDER: build by default
set -eu

cd "$(dirname "$0")/.."
build=${1:-build}
jobs=$(nproc)

sh cmake/install_dependencies.sh --training --documentation --benchmarks --cameras --onnxruntime --surface --python-tests --valgrind --clang
cmake --preset release -B "$build" \
  -DHOLDFAST_UNITY=ON -DHOLDFAST_BUILD_TESTS=ON -DHOLDFAST_BUILD_BENCHMARKS=ON -DHOLDFAST_BUILD_EXAMPLES=ON -DHOLDFAST_PYTHON=ON \
  -DHOLDFAST_PYTHON_PACKAGE=ON
rm -f "$build"/tests_*.log  # those of an earlier run say nothing about this one
cmake --build "$build" --parallel "$jobs"

# What a group of tests prints is kept in BUILD_FOLDER/tests_GROUP.log.
run_tests() {
  group=$1; shift
  ctest --test-dir "$build" --parallel "$jobs" --output-on-failure --no-tests=error --output-log "$build/tests_$group.log" "$@"
}
# The quick ones first, so that a plain mistake shows within seconds; the others run even when those fail.
verdict=0
run_tests quick --label-regex '^quick$' || verdict=1
run_tests others --label-exclude '^(quick|nightly)$' || verdict=1
[ "$verdict" -eq 0 ] && echo "All tests passed." || echo "Some tests failed: see above." >&2
exit "$verdict"
