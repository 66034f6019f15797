#!/usr/bin/env bash
# check_install.sh BUILD_DIR SOURCE_DIR: installs into a scratch folder, builds a small project against the installed
# package and runs it.
set -euo pipefail
build=$1
source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" >/dev/null
"$scratch/prefix/bin/livecap" --version
cmake -S "$source/tests/house/consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Release >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
cmake --build "$scratch/build" >>"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
# Nothing of the source tree may be needed.
if grep -rnF "$source" "$scratch/prefix/lib" --include='*.cmake'; then
  echo "the installed package files name the source folder"
  exit 1
fi
cd "$scratch"
"$scratch/build/consumer"
