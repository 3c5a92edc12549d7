#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Composes the sequences of benchmarks/development.yaml: six draws of people who walk, stand, or both, into two recordings
# of static rooms. Sequences that exist already are kept.
#
#   compose_development.sh TUM PEOPLE OUTPUT     TUM: folder with rgbd_dataset_freiburg1_xyz and _rpy
#                                                PEOPLE: folder of the Penn-Fudan pedestrian database
set -eu

[ $# -eq 3 ] || { sed -n '3,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
recordings=$1 people=$2 output=$3
compose=$(dirname "$0")/compose_people.py
mkdir -p "$output"
for room in xyz rpy; do
  for mode in walk still mixed; do
    for seed in 41 42 43 44 45 46; do
      name=${room}_${mode}_$seed
      [ -d "$output/$name" ] && continue
      echo "$name"
      "$compose" "$recordings/rgbd_dataset_freiburg1_$room" "$people" "$output/$name.part" \
        --seed "$seed" --count 3 --mode "$mode" --distance 0.5 0.9
      mv "$output/$name.part" "$output/$name"
    done
  done
done
