#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# alone.sh SOURCES COMPILER PROGRAM EIGEN...
# Compiles all headers of geometry/, and of matching/ but for those about Holdfast's own frames, in one file, then the
# example geometry_alone as PROGRAM, with Eigen's folder and ours as the only ones to include from. Runs it. That each of
# the headers can be the only one of a file is the test headers.compile_alone.
set -eu
sources=$1 compiler=$2 program=$3
shift 3
flags="-std=c++20 -Wall -Wextra -Wpedantic -Werror -I$sources/include"
for folder in "$@"; do flags="$flags -isystem $folder"; done

cd "$sources/include"
number=0
includes=
for header in holdfast/geometry/*.hpp holdfast/matching/*.hpp; do
  case $header in
    */frame_features.hpp | */point_block.hpp | */point_fusion.hpp) continue ;;
  esac
  includes="$includes#include \"$header\"
"
  number=$((number + 1))
done
[ "$number" -ge 15 ] || { echo "found only $number headers in $sources/include/holdfast/geometry" >&2; exit 1; }
# shellcheck disable=SC2086
printf '%s' "$includes" | "$compiler" $flags -fsyntax-only -x c++ - || { echo "a header needs more than Eigen" >&2; exit 1; }
# shellcheck disable=SC2086
"$compiler" $flags "$sources/examples/geometry_alone.cpp" -o "$program"
"$program"
