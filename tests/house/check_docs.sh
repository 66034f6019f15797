#!/usr/bin/env bash
# Every `path` and `path:symbol` that the documents name exists.
set -euo pipefail
cd "$1"
bad=0
# shellcheck disable=SC2016
while IFS=: read -r document entry; do
  file=${entry%%:*}
  symbol=
  [[ $entry != *:* ]] || symbol=${entry#*:}
  if [[ $file == */wall.cl ]]; then continue; fi  # the invented term of add_a_term.md
  if [[ ! -e $file ]]; then
    echo "$document: there is no $file"
    bad=1
  elif [[ -n $symbol ]] && ! grep -qw -- "$symbol" "$file"; then
    echo "$document: $file has no $symbol"
    bad=1
  fi
done < <(grep -oE '`(src|include|kernels|tools|tests|cmake|docs|third_party)/[A-Za-z0-9_./-]+(:[A-Za-z0-9_]+)?`' \
  README.md docs/*.md | tr -d '`')
exit $bad
