#!/usr/bin/env bash
# Fails when a tracked C, C++ or OpenCL file is not as clang-format 14 (.clang-format) would write it.
#
#   tools/check_format.sh [--fix]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
program=$(command -v clang-format-14 || command -v clang-format || true)
[[ -n $program ]] || { echo "check_format.sh: no clang-format; tools/setup.sh installs it" >&2; exit 1; }

mode=(-n -Werror)
[[ ${1:-} != --fix ]] || mode=(-i)
git ls-files -z --cached --others --exclude-standard '*.c' '*.h' '*.cpp' '*.cl' | xargs -0 -r "$program" "${mode[@]}"
echo "format: $(git ls-files --cached --others --exclude-standard '*.c' '*.h' '*.cpp' '*.cl' | wc -l) files checked"
