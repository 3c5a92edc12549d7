#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds Holdfast with sanitizers and runs it: tests, and whole short runs on simulated scenes. Any report ends a
# program with an error. What the libraries below us do to themselves is listed in
# cmake/thread_sanitizer_suppressions.txt.
#
#   sh tests/sanitizers.sh            everything, which is both of these:
#   sh tests/sanitizers.sh --address  all quick tests and all runs with the address and the undefined behaviour sanitizer
#   sh tests/sanitizers.sh --thread   the tests that start threads, and threaded runs, with the thread sanitizer
#   sh tests/sanitizers.sh --quick    a selection that compiles in minutes, with the address and most of the undefined
#                                     behaviour sanitizer: a sequential and a threaded run, the tests of the pipeline and of
#                                     readers, and the replays of tests/fuzz that do not need the program
#
# Environment: CXX (clang++ by default, which compiles this in two thirds of the time of g++); CCACHE=ON uses ccache.
set -eu

cd "$(dirname "$0")/.."
case "${1:-}" in
  '') parts="address thread" ;;
  --quick | --address | --thread) parts=${1#--} ;;
  *) sed -n '3,15s/^# \{0,1\}//p' tests/sanitizers.sh >&2; exit 2 ;;
esac
root=$PWD
jobs=$(nproc)
export ASAN_OPTIONS="detect_leaks=0:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:${UBSAN_OPTIONS:-}"
export TSAN_OPTIONS="halt_on_error=1:suppressions=$root/cmake/thread_sanitizer_suppressions.txt:${TSAN_OPTIONS:-}"
CXX=${CXX:-clang++}
[ "$CXX" != clang++ ] || sh cmake/install_dependencies.sh --clang

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# step NAME COMMAND...: runs a command, and shows its output only if it fails.
step() {
  name=$1
  shift
  if "$@" > "$work/log" 2>&1; then
    echo "clean: $name"
  else
    failures=$((failures + 1))
    echo "FAILED: $name: $*" >&2
    tail -n 60 "$work/log" >&2
  fi
}

# build PRESET TARGET...
build() {
  preset=$1
  shift
  cmake --preset "$preset" -DCMAKE_CXX_COMPILER="$CXX" -DHOLDFAST_BUILD_TESTS=ON -DHOLDFAST_BUILD_EXAMPLES=ON \
    ${CCACHE:+-DCMAKE_CXX_COMPILER_LAUNCHER=ccache} ${flags:+"-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=$flags"} \
    ${sanitizers:+"-DHOLDFAST_SANITIZE=$sanitizers"}
  cmake --build "build-$preset" --parallel "$jobs" --target "$@"
}

# run PRESET CONFIGURATION MODE DURATION: a whole run among walking people.
run() {
  step "$1: $2, $3" "build-$1/bin/holdfast" run "examples/configs/$2.yaml" --output "$work/$1-$2-$3" --quiet \
    --set "source={simulated: {scene: $root/examples/scenes/walking_xyz.yaml, duration: $4}}" --set camera=tum_fr3 \
    --set segmenter=truth --set "run.mode=$3"
}

# run_one_camera PRESET MODE DURATION: the same with one camera, whose points come and go in two threads.
run_one_camera() {
  step "$1: one camera, $2" "build-$1/bin/holdfast" run examples/configs/mono.yaml --output "$work/$1-mono-$2" --quiet \
    --set "source={simulated: {scene: $root/examples/scenes/walking_xyz.yaml, duration: $3}}" --set camera=tum_fr3 \
    --set segmenter=truth --set 'filters=[semantic_mask, epipolar_consistency]' --set tracking.minimum_inliers=15 \
    --set tracking.keyframe_tracked_ratio=0.9 --set "run.mode=$2"
}

test_quick() {
  # Without line numbers it compiles faster; the full mode tells them. Calls that a library calls deprecated are errors:
  # its next version may not have them.
  flags="-O1 -DNDEBUG -Werror=deprecated-declarations"
  # Without alignment, null, object-size and vptr, which double the time to compile; the address sanitizer sees most of
  # what these see, and the full mode has them.
  sanitizers="address;bool;bounds;builtin;enum;integer-divide-by-zero;nonnull-attribute;pointer-overflow;return"
  sanitizers="$sanitizers;returns-nonnull-attribute;shift;signed-integer-overflow;unreachable;vla-bound"
  # Which lock guards what (core/thread_annotations.hpp) is clang's to check.
  case "$CXX" in *clang*) flags="$flags -Werror=thread-safety" ;; esac
  # Without the program and the bench, which are half of what there is to compile.
  borders="configuration image_header image_lists map_file onnx_signature override plugin_record scene trajectory"
  build asan pipeline_test config_test map_io_test sources_test holdfast_example_run_and_report \
    $(printf 'fuzz_%s ' $borders)
  for test in pipeline_test config_test map_io_test sources_test; do
    step "asan: $test" "build-asan/tests/$test"
  done
  for mode in sequential threaded; do
    grep -v '^\(source\|camera\|segmenter\|run\):' examples/configs/full.yaml > "$work/$mode.yaml"
    cat >> "$work/$mode.yaml" <<END
source: { simulated: { scene: $root/examples/scenes/walking_xyz.yaml, duration: 0.5 } }
camera: { width: 320, height: 240, fx: 270, fy: 270, cx: 159.5, cy: 119.5 }
segmenter: truth
run: { mode: $mode }
END
    step "asan: a $mode run" build-asan/examples/run_and_report "$work/$mode.yaml" "$work/$mode"
  done
  for border in $borders; do
    step "asan: fuzz_$border" "build-asan/tests/fuzz_$border" "tests/fuzz/corpus/$border"
  done
}

test_address() {
  build asan all
  step "asan: quick tests" ctest --test-dir build-asan --parallel "$jobs" --output-on-failure --no-tests=error \
    --label-regex '^quick$'
  for configuration in full paper objects; do
    for mode in sequential threaded; do run asan "$configuration" "$mode" 3; done
  done
  for mode in sequential threaded; do run_one_camera asan "$mode" 4; done
  map=$work/asan-full-sequential/map.hfm
  step "asan: map export" build-asan/bin/holdfast map export "$map" --points "$work/points.ply" \
    --trajectory "$work/keyframes.txt" --json "$work/map.json"
  step "asan: a map continued" build-asan/bin/holdfast run examples/configs/full.yaml --output "$work/continued" \
    --quiet --map "$map" --set "source={simulated: {scene: $root/examples/scenes/walking_xyz.yaml, duration: 1}}" \
    --set camera=tum_fr3 --set segmenter=truth
  step "asan: simulate" build-asan/bin/holdfast simulate examples/scenes/crowd.yaml --duration 0.3 \
    --output "$work/crowd" --preview "$work/preview.png"
  cat > "$work/matrix.yaml" <<END
base: $root/examples/configs/rgbd.yaml
sequences:
  crowd: { source: { simulated: { scene: $root/examples/scenes/crowd.yaml, duration: 0.5 } } }
END
  step "asan: bench" build-asan/bin/holdfast bench "$work/matrix.yaml" --output "$work/bench"
  step "asan: bench again" build-asan/bin/holdfast bench "$work/matrix.yaml" --output "$work/bench" --resume
}

test_thread() {
  tests="pipeline_test run_library_test prefetch_test busy_threads_test stop_test foxglove_test viewer_test"
  build tsan holdfast_program $tests
  for test in $tests; do
    step "tsan: $test" "build-tsan/tests/$test"
  done
  for configuration in full paper objects; do run tsan "$configuration" threaded 2; done
  run_one_camera tsan threaded 4
}

for part in $parts; do "test_$part"; done

[ "$failures" -eq 0 ] && echo "No sanitizer has a report." || echo "$failures steps failed: see above." >&2
exit "$((failures > 0))"
