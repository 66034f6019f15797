#!/usr/bin/env bash
# check_exports.sh LIBRARY SOURCE_DIR: the shared library exports the functions of livecap/livecap.h and nothing else.
set -euo pipefail
library=$1
header=$2/include/livecap/livecap.h
exported=$(nm -D --defined-only "$library" | awk '{ print $NF }' | sort)
# A declaration begins a line; typedefs, inline functions and comments do not count.
declared=$(grep -E '^[a-z]' "$header" | grep -vE '^(typedef|static|extern)' | grep -oE '\blivecap_[a-z_]+\(' | tr -d '(' | sort)
[[ -n $declared ]] || { echo "$header declares nothing"; exit 1; }
diff <(echo "$declared") <(echo "$exported") || { echo "< declared, not exported; > exported, not declared"; exit 1; }
