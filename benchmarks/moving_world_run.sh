#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One run of the ablation: moving_world_run.sh PROGRAM OUTPUT_FOLDER CONFIGURATION SEQUENCE_FOLDER
set -eu
program=$1; output=$2; configuration=$3; sequence=$4
configs=$(dirname "$0")/../examples/configs
name=$configuration/$(basename "$sequence")
[ ! -e "$output/$name/run.json" ] || exit 0
file=$configs/$configuration.yaml
[ "$configuration" != none ] || file=$configs/rgbd.yaml
mkdir -p "$output/$name"
set -- --set "source.tum.path=$sequence"
! grep -q '^segmenter: { precomputed' "$file" || set -- "$@" --set "segmenter.precomputed.path=$sequence/mask"
"$program" run "$file" "$@" --output "$output/$name" --overwrite > "$output/$name.log" 2>&1 ||
  echo "$name failed, see $output/$name.log" >&2
