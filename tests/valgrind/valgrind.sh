#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs the program under valgrind's memcheck on some twenty frames of a simulated sequence: a decision that depends on
# memory that nobody wrote, or access outside of what was allocated, is an error. What the sanitizers cannot see of the
# first is seen here.
#
#   sh tests/valgrind/valgrind.sh PROGRAM CASE     CASE: mono, stereo, full, threaded, or files (evaluate and map)
#
# PROGRAM is the program `holdfast`, built without sanitizers. Exit status: 0 clean, 1 not, 2 wrong call, 77 skipped.
set -eu

usage() { sed -n '3,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
[ $# -eq 2 ] && [ -x "$1" ] || usage
program=$1
if ! command -v valgrind >/dev/null 2>&1; then
  echo "valgrind: skipped: valgrind is not installed (sh cmake/install_dependencies.sh --valgrind)"
  exit 77
fi
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# check COMMAND...: valgrind's report is shown where there is one. Its processor knows AVX2 and no AVX-512.
check() {
  status=0
  HOLDFAST_SIMD=avx2 valgrind --quiet --error-exitcode=99 --num-callers=20 "$@" >"$work/log" 2>&1 || status=$?
  [ "$status" -eq 0 ] && return 0
  head -n 100 "$work/log" >&2
  echo "valgrind: ended with $status: $*" >&2
  exit 1
}

# run CONFIGURATION OPTION...: a whole run.
run() {
  configuration=$1
  shift
  check "$program" run "$root/examples/configs/$configuration.yaml" --output "$work/out" --quiet "$@"
  poses=$(grep -c '^[0-9]' "$work/out/trajectory.txt") || true
  [ "$poses" -ge 10 ] || { echo "valgrind: $poses poses: too few for a run that shows something" >&2; exit 1; }
}

# A camera that moves fast enough for a map of one camera, past people, 10 times a second.
simulate() {
  "$program" simulate "$root/examples/scenes/walking_xyz.yaml" --path loop --frame-rate 10 --duration 2 \
    --camera tum_fr3 --output "$work/sequence" --quiet
}
sequence="source={tum: {path: $work/sequence}}"
masks="segmenter={precomputed: {path: $work/sequence/mask, labels: {1-254: person}}}"

case "$2" in
  mono) simulate; run mono --set "$sequence" --set camera=tum_fr3 ;;
  full) simulate; run full --set "$sequence" --set camera=tum_fr3 --set "$masks" ;;
  threaded) simulate; run full --set "$sequence" --set camera=tum_fr3 --set "$masks" --set run.mode=threaded ;;
  stereo)
    run stereo --set 'camera={width: 320, height: 240, fx: 270, fy: 270, cx: 159.5, cy: 119.5}' \
      --set "source={simulated: {scene: $root/examples/scenes/empty.yaml, duration: 0.6, stereo_baseline: 0.1}}"
    ;;
  files)
    simulate
    "$program" run "$root/examples/configs/rgbd.yaml" --output "$work/out" --quiet --set "$sequence" --set camera=tum_fr3
    check "$program" evaluate "$work/sequence/groundtruth.txt" "$work/out/trajectory.txt" \
      --frames "$work/sequence/rgb.txt" --json "$work/figures.json" --csv "$work/figures.csv" --plots "$work/plots"
    check "$program" map info "$work/out/map.hfm"
    check "$program" map export "$work/out/map.hfm" --points "$work/points.ply" --trajectory "$work/keyframes.txt" \
      --json "$work/map.json"
    ;;
  *) usage ;;
esac
echo "valgrind: $2 is clean"
