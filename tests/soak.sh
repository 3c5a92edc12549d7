#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A long threaded run: memory beyond the trajectory must level off, and descriptors and threads must stay as many as they
# are. Then pipelines that are made and dropped, and runs that are stopped at random moments.
#
#   sh tests/soak.sh [MINUTES] [BUILD_FOLDER] [PART ...]
#
# 60 minutes and `build` by default. The parts, all by default: crowd, simulated; recording, looped, where HOLDFAST_DATA
# names a folder with tum_fr1_xyz; pipelines; stops.
set -eu

cd "$(dirname "$0")/.."
minutes=${1:-60}
build=${2:-build}
[ $# -le 2 ] && parts="crowd recording pipelines stops" || { shift 2; parts=$*; }
wants() { case " $parts " in *" $1 "*) ;; *) false ;; esac; }
# A pose of the trajectory and those of removed keyframes to which it is relative, by a heap profile of 28,000 frames.
bytes_per_frame=232
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
verdict=0

# watch NAME OVERRIDE...: runs a configuration for the minutes, writes a line each 10 s to out/soak/NAME.csv and judges.
watch() {
  name=$1
  shift
  mkdir -p out/soak
  table=out/soak/$name.csv
  echo "seconds,memory_kB,descriptors,threads,frames" > "$table"
  "$build/bin/holdfast" run examples/configs/full.yaml --output "$work/$name" --quiet --set run.mode=threaded "$@" \
    > "$work/log" 2>&1 &
  process=$!
  start=$(date +%s)
  now=0
  while [ "$now" -lt $((minutes * 60)) ] && kill -0 "$process" 2> /dev/null; do
    sleep 10
    now=$(($(date +%s) - start))
    memory=$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$process/status" 2> /dev/null || true)
    [ -n "$memory" ] || break
    frames=$(cat "$work/$name/trajectory.txt" 2> /dev/null | wc -l)
    echo "$now,$memory,$(ls "/proc/$process/fd" | wc -l),$(ls "/proc/$process/task" | wc -l),$frames" >> "$table"
  done
  kill -TERM "$process" 2> /dev/null || true
  wait "$process" || code=$?
  case "${code:-0}" in 0 | 130 | 143) ;; *) verdict=1; echo "$name: exit code $code" >&2; tail -n 20 "$work/log" >&2 ;; esac
  # Least squares over the least memory of each minute, since frames in flight and adjustments take some for a while,
  # after the first sixth of the time, which fills the map and the caches. An image file may be open when a line is
  # written, so that descriptors and threads are the least of each half.
  awk -F, -v name="$name" -v all=$((minutes * 60)) '
    NR > 1 { memory[int($1 * 10 / (all + 1))] = $2 }
    END {
      printf "%s: memory [MB] at the end of each tenth:", name
      for (i = 0; i < 10; i++) if (i in memory) printf " %d", memory[i] / 1024
      print "" }' "$table"
  awk -F, -v name="$name" -v begin=$((minutes * 10)) -v middle=$((minutes * 35)) -v trajectory="$bytes_per_frame" '
    function end_minute() {
      if (least == "") return
      n++; x += at; y += least; xx += at * at; xy += at * least
      least = ""
    }
    NR > 1 && $1 >= begin {
      memory = $2 - $5 * trajectory / 1024
      if (int($1 / 60) != minute) end_minute()
      minute = int($1 / 60)
      if (least == "" || memory < least) { least = memory; at = $1 }
      half = $1 >= middle
      if (!(half in d) || $3 < d[half]) d[half] = $3
      if (!(half in t) || $4 < t[half]) t[half] = $4
    }
    END {
      end_minute()
      if (n < 3) { print name ": too short to judge"; exit 0 }
      slope = (n * xy - x * y) / (n * xx - x * x) * 600 / 1024
      changed = d[0] != d[1] || t[0] != t[1]
      printf "%s: %.2f MB per 10 minutes beyond the trajectory, %d descriptors, %d threads%s\n", name, slope, d[0], t[0],
        changed ? sprintf(", then %d and %d", d[1], t[1]) : ""
      exit slope > 1.0 || changed }' "$table" || verdict=1
}

! wants crowd || watch crowd --set camera=tum_fr3 --set segmenter=truth \
  --set "source={simulated: {scene: $PWD/examples/scenes/crowd.yaml, duration: $((minutes * 120))}}"

# A recording played forwards and backwards again and again.
recording=${HOLDFAST_DATA:-}/tum_fr1_xyz
if ! wants recording; then
  :
elif [ -n "${HOLDFAST_DATA:-}" ] && [ -d "$recording" ]; then
  mkdir "$work/looped"
  # Both lists have one period, or depth would drift away from colour.
  period=$(grep -hv '^#' "$recording/rgb.txt" "$recording/depth.txt" | awk '
    NR == 1 || $1 < first { first = $1 }
    $1 > last { last = $1 }
    END { printf "%.6f %.6f", first, last - first + 0.02 }')
  for kind in rgb depth; do
    ln -s "$recording/$kind" "$work/looped/$kind"
    grep -v '^#' "$recording/$kind.txt" | awk -v minutes="$minutes" -v period="$period" '
      { stamp[NR] = $1; name[NR] = $2 }
      END {
        split(period, of, " ")
        for (k = 0; 2 * k * of[2] < minutes * 60 + 60; k++) {
          begin = of[1] + k * (2 * of[2] + 0.02)
          for (i = 1; i <= NR; i++) printf "%.6f %s\n", begin + stamp[i] - of[1], name[i]
          for (i = NR; i >= 1; i--) printf "%.6f %s\n", begin + 2 * of[2] - (stamp[i] - of[1]), name[i]
        }
      }' > "$work/looped/$kind.txt"
  done
  # At the pace of its stamps: as fast as it goes, the recording would be over long before the minutes are.
  watch recording --set run.pace=timestamps --set camera=tum_fr1 --set source.tum.path="$work/looped" --set segmenter=none \
    --set 'filters=[multi_view_depth]'
else
  echo "recording: skipped, because HOLDFAST_DATA names no folder with tum_fr1_xyz"
fi

if wants pipelines; then
  HOLDFAST_PIPELINES=1000 "$build/tests/pipeline_test" --gtest_filter='Growth.*' || verdict=1
fi
if wants stops; then
  HOLDFAST_STOPS=200 "$build/tests/stop_test" || verdict=1
  HOLDFAST_STOPS=200 "$build/tests/busy_threads_test" --gtest_filter='*AStopAtAnyMoment*' || verdict=1
fi
exit "$verdict"
