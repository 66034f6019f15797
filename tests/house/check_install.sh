#!/usr/bin/env bash
# check_install.sh BUILD_DIR SOURCE_DIR: installs into a scratch folder, builds a small project against the installed
# package and runs it; likewise a program in C with pkg-config alone.
set -euo pipefail
build=$1
source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --prefix "$scratch/prefix" >/dev/null
"$scratch/prefix/bin/livecap" --version
# Every page and picture that the installed README links to (headers and sources are elsewhere).
readme=$(find "$scratch/prefix" -name README.md)
for link in $(grep -oE '\]\((docs|CHANGELOG)[^)#]*' "$readme" | sed 's/](//' | sort -u); do
  [[ -s $(dirname "$readme")/$link ]] || { echo "$readme links to $link, which is not installed"; exit 1; }
done
cmake -S "$source/tests/house/consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DCMAKE_BUILD_TYPE=Release >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
cmake --build "$scratch/build" >>"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
# Nothing of the source tree may be needed.
if grep -rnF "$source" "$scratch/prefix/lib" --include='*.cmake' --include='*.pc'; then
  echo "the installed package files name the source folder"
  exit 1
fi
cd "$scratch"
"$scratch/build/consumer"
"$scratch/build/consumer_c"

# The shared library finds the weights that were installed with it before any others: these are no weights.
pc=$(dirname "$(find "$scratch/prefix" -name livecap.pc)")
read -ra flags < <(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs livecap)
cc -std=c99 -pedantic -Wall -Wextra -Werror "$source/tests/house/consumer/consumer.c" -o consumer_pc "${flags[@]}" \
  -Wl,-rpath,"$(PKG_CONFIG_PATH=$pc pkg-config --variable=libdir livecap)"
models=$scratch/prefix/share/livecap/models
rm -rf "$models"  # models/ may be a link to a folder, and is installed as one
mkdir -p "$models"
echo broken >"$models/pose_landmark_lite.tflite"
env -u LIVECAP_MODEL_DIR ./consumer_pc "$models"
