#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzz targets with clang, AddressSanitizer and UndefinedBehaviorSanitizer, and lets libFuzzer search with
# each of them. What it learns stays in BUILD_FOLDER/fuzz/BORDER/corpus, so that the next call goes on from there; an
# input that crashes, hangs (5 s) or takes more than 1 GB lands in BUILD_FOLDER/fuzz/BORDER and is a defect: mend it,
# and add the input to tests/fuzz/corpus/BORDER.
#
#   sh tests/fuzz/run.sh SECONDS [BORDER ...]     SECONDS of each border, all borders by default
#
# Environment: BUILD_FOLDER (build-fuzz); RUNS, a number of executions at which a border is done before its time.
set -eu

cd "$(dirname "$0")/../.."
[ $# -ge 1 ] || { sed -n '3,11s/^# \{0,1\}//p' tests/fuzz/run.sh >&2; exit 2; }
seconds=$1
shift
build=${BUILD_FOLDER:-build-fuzz}
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)

sh cmake/install_dependencies.sh --clang
cmake --preset fuzz -B "$build"
for border in "$@"; do targets="${targets:-} fuzz_$border"; done
cmake --build "$build" --target $targets

# Most borders read files: those of the inputs stay in memory.
[ ! -d /dev/shm ] || export TMPDIR="${TMPDIR:-/dev/shm}"
export UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:${UBSAN_OPTIONS:-}"
# AddressSanitizer keeps each distinct stack of an allocation for ever, and reading YAML makes some 25 new ones in every
# execution: 1.4 million after 55,000, which would pass the limit of memory after some hundred thousand. With the innermost
# frame alone there are 13. The stack of a defect itself is complete; ASAN_OPTIONS=malloc_context_size=30 tells those of its
# allocations. What is freed waits in a quarantine, 256 MB by default.
export ASAN_OPTIONS="malloc_context_size=1:quarantine_size_mb=64:${ASAN_OPTIONS:-}"
verdict=0
for border in "$@"; do
  found=$build/fuzz/$border
  mkdir -p "$found/corpus"
  echo "== $border"
  # Nearly all the time of these goes into scanning YAML; what their readers do differs by keys, not by length.
  case "$border" in configuration | matrix | scene) limit=400 ;; *) limit=0 ;; esac
  "$build/tests/fuzz_$border" -max_total_time="$seconds" -runs="${RUNS:--1}" -rss_limit_mb=1024 \
    -timeout=5 -max_len="$limit" -artifact_prefix="$found/" -print_final_stats=1 \
    "$found/corpus" "tests/fuzz/corpus/$border" \
    > "$found/log" 2>&1 || { verdict=1; echo "found a defect, see $found/log:" >&2; tail -n 40 "$found/log" >&2; }
  grep -E '^stat::(number_of_executed_units|average_exec_per_sec|peak_rss_mb)' "$found/log" || true
done
exit "$verdict"
