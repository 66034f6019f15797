#!/usr/bin/env bash
# No tracked file names a folder of somebody's machine.
set -euo pipefail
cd "$1"
git rev-parse --is-inside-work-tree >/dev/null 2>&1 || { echo "skipped: not a git work tree"; exit 77; }
# The brackets keep this file from naming them itself.
if git grep -nIE '(^|[^[:alnum:]_.~-])/(wor[k]|roo[t]|hom[e]|User[s]|mn[t])/' -- . ':!LICENSE'; then
  echo "the lines above name paths of one machine"
  exit 1
fi
