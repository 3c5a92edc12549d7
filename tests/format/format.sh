#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# format.sh SOURCES CLANG_FORMAT
# Names every C++ file that clang-format 14 would change. `clang-format -i FILE` mends it.
set -eu
sources=$1 program=$2
case $("$program" --version 2>/dev/null || true) in
  *"version 14."*) ;;
  *) echo "skipped: no clang-format 14 here (Debian 12: clang-format)"; exit 77 ;;
esac
cd "$sources"
list=$(mktemp)
trap 'rm -f "$list"' EXIT
find include modules plugins integrations examples tests benchmarks -name '*.cpp' -o -name '*.hpp' | sort >"$list"
number=$(wc -l <"$list")
[ "$number" -ge 500 ] || { echo "found only $number files in $sources" >&2; exit 1; }
xargs -P "$(nproc)" -n 50 "$program" --dry-run -Werror <"$list" || { echo "see above; mend with clang-format -i" >&2; exit 1; }
echo "$number files have the format of .clang-format"
