#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# headers_alone.sh SOURCES GENERATED COMPILER all|rest FOLDER...
# Compiles public headers, each as the only one of a file, with all warnings as errors; FOLDERs are those of libraries.
# rest: only headers that no file of ours includes first, because for the others every build is that test already.
set -eu
sources=$1 generated=$2 compiler=$3 which=$4
shift 4
if ! command -v "$compiler" >/dev/null 2>&1; then
  echo "skipped: no clang++ here (Debian: clang)"
  exit 77
fi

flags="-std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I$sources/include -I$generated"
for folder in "$@"; do
  case $folder in
    "$sources"/*) flags="$flags -I$folder" ;;
    /usr/include) ;; # as a system folder it would hide the compiler's own
    *) flags="$flags -isystem $folder" ;;
  esac
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$sources"
(cd include && find holdfast -name '*.hpp') | sort >"$work/headers"
if [ "$which" = rest ]; then
  for file in $(find modules plugins -name '*.cpp'); do sed -n '/^#include/{s/.*"\(holdfast.*\)".*/\1/p;q}' "$file"; done |
    sort -u >"$work/first"
  comm -23 "$work/headers" "$work/first" >"$work/chosen"
else
  cp "$work/headers" "$work/chosen"
fi
number=$(wc -l <"$work/chosen")
[ "$number" -ge 20 ] || { echo "found only $number headers in $sources/include" >&2; exit 1; }

export compiler flags
xargs -P "$(nproc)" -I{} sh -c '
  echo "#include \"{}\"" | "$compiler" $flags -x c++ - || { echo "{} does not compile alone" >&2; exit 1; }' <"$work/chosen"
echo "$number of $(wc -l <"$work/headers") headers compile alone with $compiler"
