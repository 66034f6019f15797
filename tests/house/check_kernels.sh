#!/usr/bin/env bash
# Every kernel file compiles alone as OpenCL C 1.2 without a warning, for GPUs and for CPUs with vectors of either size,
# with PoCL and without, whatever the driver says.
set -euo pipefail
cd "$1"
clang=$(command -v clang-14 || command -v clang || true)
[[ -n $clang ]] || { echo "skipped: no clang (package clang)"; exit 77; }

lint() {
  local options=(-x cl -cl-std=CL1.2 -fsyntax-only -Xclang -finclude-default-header -Xclang -fdeclare-opencl-builtins
    -target spir64 -Wall -Wextra -Werror -Wno-unused-function -D LC_DEVICE=1 -I kernels)
  local lanes pocl
  for lanes in 1 8 16; do
    for pocl in 0 1; do
      "$clang" "${options[@]}" -D LC_CPU=$((lanes > 1)) -D LC_VECTOR=$lanes -D LC_POCL=$pocl "$1" ||
        { echo "$1: does not compile with LC_VECTOR=$lanes and LC_POCL=$pocl"; return 1; }
    done
  done
}
export -f lint
export clang
files=$(find kernels -name '*.cl' | sort)
[[ -n $files ]] || { echo "no kernels found"; exit 1; }
echo "$files" | xargs -P "$(nproc)" -I{} bash -c 'lint {}'
