#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Holds whole sequential runs to stored results, byte for byte: SHA-256 of the poses in trajectory.txt and of map.hfm
# for four configurations on three simulated scenes and on 200 frames of a recording. A change that is not meant to
# change results passes it; a change that is meant to rewrites the values, so that it shows as lines of the commit.
#
#   sh tests/oracle/oracle.sh PROGRAM                        runs every case and compares
#   sh tests/oracle/oracle.sh PROGRAM CONFIGURATION SCENE    runs one case, such as: full walking_xyz
#   sh tests/oracle/oracle.sh --write PROGRAM                runs every case and writes the values of this program;
#                                                            with CONFIGURATION SCENE the value of that case
#
# PROGRAM is the program `holdfast`. Segmenters give exact masks (the simulator's; for the recording the label images
# beside it), so that no network takes part. The recording is $HOLDFAST_DATA/tum_fr1_xyz; without HOLDFAST_DATA its
# cases are skipped, and --write keeps their values.
#
# The values belong to one version of Debian on amd64 with AVX2 and FMA, each with a file of its own: another version of
# Ceres or OpenCV, or another C library, may round differently. Elsewhere every case is skipped. Processors of other
# makers may round differently too: a case that differs on a processor other than that named in the file is skipped, and
# says so. Exit status: 0 all compared cases are equal, 1 some differ, 2 wrong call, 77 skipped.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
debian=$(. /etc/os-release 2>/dev/null && [ "${ID:-}" = debian ] && echo "$VERSION_ID" || true)
values=$here/values_debian_$debian.txt
configurations="rgbd geometric full paper"
scenes="walking_xyz sitting_halfsphere loop tum_fr1_xyz"

fail() { echo "oracle: $*" >&2; exit 2; }
skip() { echo "oracle: skipped: $*"; exit 77; }

writes=no
if [ "${1:-}" = --write ]; then writes=yes; shift; fi
[ $# -eq 1 ] || [ $# -eq 3 ] || fail "usage: oracle.sh [--write] PROGRAM [CONFIGURATION SCENE]"
program=$1
[ -x "$program" ] || fail "'$program' is not a program; expected the path of holdfast, such as build/bin/holdfast"
if [ $# -eq 3 ]; then configurations=$2; scenes=$3; fi

on_reference_system() {
  [ "$(uname -m)" = x86_64 ] && [ -f "$values" ] && grep -q -m 1 '^flags.* fma .*avx2' /proc/cpuinfo
}
[ "$writes" = yes ] || on_reference_system ||
  skip "the stored values belong to Debian 12 and 13 on amd64 with AVX2 and FMA"
[ -n "$debian" ] || fail "values are written on Debian"

# Maker, family and model of the processor, such as "AuthenticAMD 25 17".
processor() {
  awk -F ': *' '/^vendor_id|^cpu family|^model\t/ { text = text $2 " " } /^$/ { exit }
                END { sub(/ $/, "", text); print text }' /proc/cpuinfo
}

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

# Prints "CONFIGURATION SCENE SHA256_OF_TRAJECTORY SHA256_OF_MAP".
run_case() {
  { source_options "$2"; segmenter_options "$1" "$2"; } >"$work/options"
  set -- "$1" "$2" run "$root/examples/configs/$1.yaml" --output "$work/$1_$2" --quiet
  while IFS= read -r option; do set -- "$@" "$option"; done <"$work/options"
  configuration=$1 scene=$2
  shift 2
  "$program" "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; return 1; }
  result=$work/${configuration}_$scene
  trajectory=$(sed '/^#/d' "$result/trajectory.txt" | sha256sum) map=$(sha256sum <"$result/map.hfm")
  echo "$configuration $scene ${trajectory%% *} ${map%% *}"
  rm -rf "$result"
}

# Replaces the line of a case in the values, in its place, or appends it.
store() {
  awk -v case="$1 $2 " -v line="$3" '
    index($0, case) == 1 { $0 = line; found = 1 } { print } END { if (!found) print line }' "$values" >"$values.new"
  mv "$values.new" "$values"
  echo "$3"
}

if [ "$writes" = yes ]; then
  touch "$values"
  { echo "# processor: $(processor)"; grep -v '^# processor: ' "$values" || true; } >"$values.new"
  mv "$values.new" "$values"
fi
differing=0 compared=0 elsewhere=0
for scene in $scenes; do
  for configuration in $configurations; do
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
    elif [ "$found" != "$stored" ] && ! grep -q "^# processor: $(processor)\$" "$values"; then
      elsewhere=$((elsewhere + 1))
      echo "oracle: $configuration $scene differs, on $(processor); the values are of another processor"
    elif [ "$found" != "$stored" ]; then
      differing=$((differing + 1))
      printf 'oracle: %s %s differs\n  stored %s\n  found  %s\n' "$configuration" "$scene" "$stored" "$found"
    else
      echo "oracle: $configuration $scene is equal"
    fi
  done
done

[ "$writes" = no ] || exit 0
[ "$compared" -gt "$elsewhere" ] || exit 77
[ "$differing" -eq 0 ] || { echo "oracle: $differing of $compared cases differ"; exit 1; }
