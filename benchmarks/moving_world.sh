#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The ablation of the moving world: five configurations on recordings with people composed into them, one table.
#
#   sh benchmarks/moving_world.sh PROGRAM OUTPUT_FOLDER SEQUENCE_FOLDER...
#
# Each sequence is a folder in TUM layout with exact masks in mask/ (0 = static, 1 to 254 = person). Two runs at a time
# on a machine with two cores disturb the times, not the errors: JOBS=2 is for errors, JOBS=1 (the default) for times.
set -eu
[ $# -ge 3 ] || { sed -n '3,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
program=$1; output=$2; shift 2
here=$(dirname "$0")
mkdir -p "$output"
configurations=${CONFIGURATIONS:-none geometric semantic paper full}
for sequence in "$@"; do
  for configuration in $configurations; do
    echo "$configuration $sequence"
  done
done | xargs -P "${JOBS:-1}" -L 1 sh "$here/moving_world_run.sh" "$program" "$output"
python3 "$here/moving_world_table.py" "$output" $configurations
