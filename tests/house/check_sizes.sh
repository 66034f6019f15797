#!/usr/bin/env bash
# One idea a file: kernels stay below 300 lines, everything else below 600.
set -euo pipefail
cd "$1"
find kernels src include tools tests cmake -type f \( -name '*.cl' -o -name '*.h' -o -name '*.c' -o -name '*.cpp' -o -name '*.sh' \
  -o -name '*.cmake' \) -print0 | xargs -0 wc -l | awk '
  $2 == "total" { next }
  { limit = $2 ~ /^kernels\// ? 300 : 600 }
  $1 > limit { print $2 ": " $1 " lines, at most " limit; bad = 1 }
  END { exit bad }'
