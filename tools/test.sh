#!/usr/bin/env bash
# Sets up, builds and runs all tests. Arguments go to ctest:
#
#   tools/test.sh                    everything
#   tools/test.sh -R surface/ -V     only the tests of one room, with their output
#   tools/test.sh -LE slow           all but the slow ones
#
#   LIVECAP_TEST_DEVICES   devices of the device tests, comma-separated selectors (default: pocl)
#   LIVECAP_DATA_DIR       folder of recorded sequences; tests that need it say so when they skip
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export LIVECAP_BUILD_DIR=${LIVECAP_BUILD_DIR:-$root/build}
LIVECAP_TESTS=1 "$root/tools/setup.sh" all  # with the tests, if it was configured without
exec ctest --test-dir "$LIVECAP_BUILD_DIR" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
