#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A stand-in for a program of somebody else, to see what `holdfast bench` does with one:
#   stand_in.sh ASSOCIATIONS SETTINGS SEQUENCE TRAJECTORY
# It "tracks" by reading the truth, moved by one rigid motion. STAND_IN in the environment is its mood:
#   good   a pose for every frame            crash  half of the poses, a line cut short, then a segmentation fault
#   half   the first half of the poses       hang   half of the poses, then nothing more, for ever
#   nan    numbers in every second pose      empty  a trajectory without poses          fail  exits with 3
set -eu
associations=$1; settings=$2; sequence=$3; trajectory=$4
frames=$(grep -c . "$associations")
grep -q '^Camera.fx: ' "$settings"
echo "$frames frames ${STAND_IN_NAME:-}"

# A pose for each of the first $1 frames; every second one without numbers where $2 is nan.
track() {
  awk -v most="$1" -v mood="${2:-}" '
    FNR == NR { if ($1 !~ /^#/) pose[sprintf("%.3f", $1)] = ($2 + 1) " " ($3 - 2) " " $4 " " $5 " " $6 " " $7 " " $8; next }
    ++frame <= most {
      if (mood == "nan" && frame % 2 == 0) print $1, "nan nan nan nan nan nan nan"
      else if (sprintf("%.3f", $1) in pose) print $1, pose[sprintf("%.3f", $1)]
    }' "$sequence/groundtruth.txt" "$associations" > "$trajectory"
}

case ${STAND_IN:-good} in
  good)  track "$frames" ;;
  half)  track $((frames / 2)) ;;
  nan)   track "$frames" nan ;;
  crash) track $((frames / 2)); printf '123.45 0.1 0.' >> "$trajectory"; kill -SEGV $$ ;;
  hang)  track $((frames / 2)); sleep 1000 ;;
  empty) : > "$trajectory" ;;
  fail)  exit 3 ;;
  *)     echo "unknown mood '$STAND_IN'" >&2; exit 2 ;;
esac
