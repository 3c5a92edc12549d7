#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# run.sh PLACE_CHANGES [SEGMENTER WEIGHTS]: the rows of benchmarks/findings/changed_rooms.md.
set -e
program=$1 segmenter=${2:-truth} weights=${3:-chair=0.1,monitor=0.1}
here=$(dirname "$0")
scene() {
  file=$1 settings=$2
  echo "{ simulated: { scene: $here/$file.yaml, set: [$settings] } }"
}
"$program" "$segmenter" "$weights" \
  "$(scene round seed=1)" "$(scene round 'seed=1, visit=2, camera.path=corridor')" \
  "$(scene round seed=1)" "$(scene aisles 'seed=1, visit=2')" \
  "$(scene round seed=2)" "$(scene aisles 'seed=2, visit=2')" \
  "$(scene aisles seed=3)" "$(scene round 'seed=3, visit=2')" \
  "$(scene round seed=4)" "$(scene aisles 'seed=4, visit=2')" \
  "$(scene hall seed=1)" "$(scene hall 'seed=1, visit=2, camera.path=corridor')"
