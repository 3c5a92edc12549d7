#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# From a fresh clone to a camera tracked through the simulated room: installs what is missing, builds the program,
# runs the demo and says where its report lies. Call it as often as you like.
#
#   sh cmake/demo.sh [--view | --configure] [BUILD_FOLDER]        BUILD_FOLDER: build by default
#
# --view shows the run in a browser: it prints an address and waits until you have opened it. --configure stops before
# building.
set -eu

cd "$(dirname "$0")/.."
purpose=run
case "${1:-}" in
  --view | --configure) purpose=${1#--}; shift ;;
  -*) echo "demo: unknown option '$1'; known are --view and --configure" >&2; exit 2 ;;
esac
build=${1:-build}
output=out/demo

# With Python: the tutorial goes on with a segmenter written in it.
sh cmake/install_dependencies.sh --python
# The program alone: tests, benchmarks and examples would more than double the time to the first picture.
cmake --preset release -B "$build" \
  -DHOLDFAST_UNITY=ON -DHOLDFAST_PYTHON=ON -DHOLDFAST_BUILD_TESTS=OFF -DHOLDFAST_BUILD_BENCHMARKS=OFF -DHOLDFAST_BUILD_EXAMPLES=OFF
[ "$purpose" != configure ] || exit 0
cmake --build "$build" --parallel "$(nproc)" --target holdfast_program
if [ "$purpose" = view ]; then
  # At the speed of a camera, so that there is something to see; Ctrl-C ends it.
  exec "$build/bin/holdfast" run examples/configs/demo.yaml --output "$output" --overwrite --view \
    --set 'filters=[semantic_mask, multi_view_depth, motion_objects]' --set 'observers=[{viewer: {wait: true, speed: 1}}]'
fi
"$build/bin/holdfast" run examples/configs/demo.yaml --output "$output" --overwrite

[ -s "$output/report.html" ] || { echo "demo: $output/report.html was not written" >&2; exit 1; }
echo
echo "The report, with the path against the truth and the error over time: $PWD/$output/report.html"
