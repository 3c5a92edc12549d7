#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Holds whole sequential runs to stored results, byte for byte: SHA-256 of the poses in trajectory.txt and of map.hfm
# for four configurations on three simulated scenes and on 200 frames of a recording, and for short runs that take the
# rare paths of tracking (paths.txt; the configuration is called "path", the scene by the name of the case). The
# trajectory is not smoothed but by the case of that name, so that the values are those of tracking. A change
# that is not meant to change results passes it; a change that is meant to rewrites the values, so that it shows as lines
# of the commit.
#
#   sh tests/oracle/oracle.sh PROGRAM                        runs every case and compares
#   sh tests/oracle/oracle.sh PROGRAM CONFIGURATION SCENE    runs one case, such as: full walking_xyz, or: path stereo
#   sh tests/oracle/oracle.sh --write PROGRAM                runs every case and writes the values of this program;
#                                                            with CONFIGURATION SCENE the value of that case
#
# PROGRAM is the program `holdfast`. Segmenters give exact masks (the simulator's; for the recording the label images
# beside it), so that no network takes part. The recording is $HOLDFAST_DATA/tum_fr1_xyz; without HOLDFAST_DATA its
# cases are skipped, and --write keeps their values.
#
# The values (values.txt) belong to Debian 12 and 13, which give the same bytes, on amd64 with AVX2 and FMA: other
# versions of Ceres or OpenCV, or another C library, may round differently. Elsewhere every case is skipped. Processors of
# other makers may round differently too: each value names the processors that gave it, and a case that differs on another one
# is skipped, and says so. --write adds this processor to a value that it finds equal, and replaces a value that differs.
# HOLDFAST_ORACLE_VALUES names another file of values, such as one to compare two states of the code on any processor.
# Exit status: 0 all compared cases are equal, 1 some differ, 2 wrong call, 77 skipped.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
debian=$(. /etc/os-release 2>/dev/null && [ "${ID:-}" = debian ] && echo "$VERSION_ID" || true)
values=${HOLDFAST_ORACLE_VALUES:-$here/values.txt}
paths=$here/paths.txt
cases=$(for scene in walking_xyz sitting_halfsphere loop tum_fr1_xyz; do
  for configuration in rgbd geometric full paper; do echo "$configuration $scene"; done
done; sed -n 's/^case \([^ ]*\) .*/path \1/p' "$paths")

fail() { echo "oracle: $*" >&2; exit 2; }
skip() { echo "oracle: skipped: $*"; exit 77; }

writes=no
if [ "${1:-}" = --write ]; then writes=yes; shift; fi
[ $# -eq 1 ] || [ $# -eq 3 ] || fail "usage: oracle.sh [--write] PROGRAM [CONFIGURATION SCENE]"
program=$1
[ -x "$program" ] || fail "'$program' is not a program; expected the path of holdfast, such as build/bin/holdfast"
if [ $# -eq 3 ]; then cases="$2 $3"; fi

on_reference_system() {
  case "$debian" in 12 | 13) ;; *) return 1 ;; esac
  [ "$(uname -m)" = x86_64 ] && [ -f "$values" ] && grep -q -m 1 '^flags.* fma .*avx2' /proc/cpuinfo
}
[ "$writes" = yes ] || on_reference_system ||
  skip "the stored values belong to Debian 12 and 13 on amd64 with AVX2 and FMA"
[ -n "$debian" ] || fail "values are written on Debian"

# Maker, family and model of the processor, such as "AuthenticAMD-25-17".
processor=$(awk -F ': *' '/^vendor_id|^cpu family|^model\t/ { text = text $2 "-" } /^$/ { exit }
                          END { sub(/-$/, "", text); print text }' /proc/cpuinfo)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Where the frames of a scene come from; the options of `holdfast run`, one per line.
source_options() {
  case "$1" in
    tum_fr1_xyz) printf '%s\n' --set "source.tum.path=$HOLDFAST_DATA/tum_fr1_xyz" --set source.tum.frames=200 ;;
    loop) printf '%s\n' --set "source.simulated.scene=$here/loop_with_people.yaml" ;;
    *) printf '%s\n' --set "source.simulated.scene=$root/examples/scenes/$1.yaml" --set source.simulated.duration=6 ;;
  esac
}

# Exact masks in place of the network.
segmenter_options() {
  case "$1" in full | paper) ;; *) return 0 ;; esac
  case "$2" in
    tum_fr1_xyz) printf '%s\n' --set "segmenter={precomputed: {path: $HOLDFAST_DATA/tum_fr1_xyz/labels_pseudo, \
labels: {15: person, 255: unknown}, tolerance: 0.2}}" ;;
    *) printf '%s\n' --set 'segmenter={truth: {}}' ;;
  esac
}

# The lines of a case of paths.txt that begin with a word: "lines_of NAME shows".
lines_of() {
  awk -v name="$1" -v word="$2" '
    $1 == "case" { inside = ($2 == name) } inside && $1 == word { sub(/^ *[^ ]* /, ""); print }' "$paths"
}

# Configuration and options of a case, in $work/options; the configuration's name is printed.
options_of() {
  if [ "$1" != path ]; then
    { source_options "$2"; segmenter_options "$1" "$2"; } >"$work/options"
    echo "$1"
    return 0
  fi
  lines_of "$2" set | sed "s|=@/|=$here/|; s|=%/|=$root/examples/scenes/|; i --set" >"$work/options"
  for other in $(lines_of "$2" map); do printf '%s\n' --map "$work/path_$other/map.hfm" --localise >>"$work/options"; done
  sed -n "s/^case $2 //p" "$paths"
}

# Whether run.json shows that a case took its path.
took_its_path() {
  lines_of "$1" shows >"$work/shows"
  while IFS= read -r expression; do
    grep -Eq "^ *$expression" "$2/run.json" && continue
    echo "oracle: path $1 is not taken: run.json does not contain $expression" >&2
    return 1
  done <"$work/shows"
}

# Runs a case in $work/CONFIGURATION_SCENE.
run_program() {
  configuration=$(options_of "$1" "$2")
  [ -n "$configuration" ] || fail "there is no case '$1 $2'"
  result=$work/$1_$2
  set -- "$1" "$2" run "$root/examples/configs/$configuration.yaml" --output "$result" --quiet --overwrite \
    --set tracking.smooth_trajectory=false
  while IFS= read -r option; do set -- "$@" "$option"; done <"$work/options"
  shift 2
  "$program" "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; return 1; }
}

# Prints "CONFIGURATION SCENE SHA256_OF_TRAJECTORY SHA256_OF_MAP"; a run that only localises has no map, and "-".
run_case() {
  if [ "$1" = path ]; then
    for other in $(lines_of "$2" map); do run_program path "$other" || return 1; done
  fi
  run_program "$1" "$2" || return 1
  result=$work/$1_$2
  trajectory=$(sed '/^#/d' "$result/trajectory.txt" | sha256sum) map=-
  [ ! -f "$result/map.hfm" ] || map=$(sha256sum <"$result/map.hfm")
  if [ "$1" = path ] && ! took_its_path "$2" "$result"; then
    [ "$writes" = no ] || return 1
    map=path-not-taken
  fi
  echo "$1 $2 ${trajectory%% *} ${map%% *}"
  rm -rf "$result"
}

# Stores the value of a case with the processors that gave it, in its place or at the end.
store() {
  awk -v case="$1 $2 " -v found="$3" -v processor="$processor" '
    index($0, case) == 1 {
      seen = 1
      if (index($0, found " ") != 1) $0 = found " " processor
      else if (index("," $5 ",", "," processor ",") == 0) $0 = $0 "," processor
    }
    { print }
    END { if (!seen) print found " " processor }' "$values" >"$values.new"
  mv "$values.new" "$values"
  grep "^$1 $2 " "$values"
}

[ "$writes" = no ] || touch "$values"
differing=0 compared=0 elsewhere=0
echo "$cases" >"$work/cases"
while read -r configuration scene <&3; do
  stored=$(grep "^$configuration $scene " "$values" 2>/dev/null || true)
  if [ "$scene" = tum_fr1_xyz ] && [ -z "${HOLDFAST_DATA:-}" ]; then
    echo "oracle: $configuration $scene skipped: HOLDFAST_DATA does not name the folder with tum_fr1_xyz"
    continue
  fi
  found=$(run_case "$configuration" "$scene") || fail "$configuration $scene could not be run"
  compared=$((compared + 1))
  if [ "$writes" = yes ]; then
    store "$configuration" "$scene" "$found"
  elif [ -z "$stored" ]; then
    fail "$values holds no case '$configuration $scene'"
  elif [ "$found" = "${stored% *}" ]; then
    echo "oracle: $configuration $scene is equal"
  elif case ",${stored##* }," in *",$processor,"*) false ;; esac; then
    elsewhere=$((elsewhere + 1))
    echo "oracle: $configuration $scene differs, on $processor; the value is of ${stored##* }"
  else
    differing=$((differing + 1))
    printf 'oracle: %s %s differs\n  stored %s\n  found  %s\n' "$configuration" "$scene" "${stored% *}" "$found"
  fi
done 3<"$work/cases"

[ "$writes" = no ] || exit 0
[ "$compared" -gt "$elsewhere" ] || exit 77
[ "$differing" -eq 0 ] || { echo "oracle: $differing of $compared cases differ"; exit 1; }
