#!/usr/bin/env bash
# CTest runs the suite that is called as its file (tests/CMakeLists.txt); one of another name would never run.
set -euo pipefail
cd "$1"
find tests -mindepth 2 -name '*_test.cpp' | sort | while read -r file; do
  unit=$(basename "$file" _test.cpp)
  suite=$(sed -E 's/(^|_)(.)/\U\2/g' <<<"$unit")
  { grep -noE '^TEST(_F|_P)?\([A-Za-z0-9]+' "$file" || true; } | sed -E 's/^([0-9]+):TEST(_F|_P)?\(/\1 /' |
    awk -v file="$file" -v suite="$suite" '$2 != suite { print file ":" $1 ": suite " $2 " is not " suite ": CTest does not run it" }'
done | tee /dev/stderr | (! grep -q .)
