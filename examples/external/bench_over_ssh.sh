#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Executes the runs of a benchmark on several hosts by SSH and GNU parallel (Debian: parallel), then writes its report:
#   bench_over_ssh.sh HOST[,HOST...] MATRIX OUTPUT [OPTION...]     `:` is this host, 4/HOST takes four runs at once
# The program, the matrix, the data and the output folder must have the same paths on all hosts. Runs that have a result
# are not repeated: after an interruption, call it again. HOLDFAST in the environment names the program.
set -eu
[ $# -ge 3 ] || { sed -n '3,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
hosts=$1
matrix=$(realpath "$2")
mkdir -p "$3"
output=$(realpath "$3")
shift 3
holdfast=${HOLDFAST:-holdfast}

# Lines of a dry run with two slashes are the ids of runs; what follows two blanks is a remark.
"$holdfast" bench "$matrix" --dry-run "$@" | sed -n 's/  .*//; /^[^ ]*\/[^ ]*\/[^ ]*$/p' > "$output/.runs.txt"
parallel --sshlogin "$hosts" --retries 3 --workdir "$PWD" --joblog "$output/parallel.log" --arg-file "$output/.runs.txt" \
  "$holdfast" bench "$matrix" --output "$output" "$@" --run {}
"$holdfast" bench "$matrix" --output "$output" --resume "$@"
