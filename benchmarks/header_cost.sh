#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What including a header costs: seconds of the compiler (user time, best of three) and lines after preprocessing.
#
#   sh benchmarks/header_cost.sh [BUILD_FOLDER [HEADER...]]      build, and holdfast.hpp beside what it stands on
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- Eigen/Geometry opencv2/core/mat.hpp holdfast/core/camera.hpp holdfast/core/map.hpp \
  holdfast/interfaces/all.hpp holdfast/plugin/plugin.hpp holdfast/pipeline/pipeline.hpp holdfast/settings/all.hpp \
  holdfast/holdfast.hpp
flags="-std=c++20 -Iinclude -I$build/include $(pkg-config --cflags eigen3 opencv4)"
source=$(mktemp --suffix=.cpp)
trap 'rm -f "$source" "$source.time"' EXIT

printf '%-36s %8s %8s\n' header seconds lines
for header in "$@"; do
  echo "#include \"$header\"" >"$source"
  best=$(for _ in 1 2 3; do
    sh -c "time -p ${CXX:-c++} $flags -fsyntax-only $source" 2>&1 | sed -n 's/^user //p'
  done | sort -n | head -n 1)
  printf '%-36s %8s %8s\n' "$header" "$best" "$(${CXX:-c++} $flags -E -P "$source" | wc -l)"
done
