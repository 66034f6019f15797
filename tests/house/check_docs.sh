#!/usr/bin/env bash
# Every `path` and `path:symbol` that the documents name exists, and every file and heading that they link to.
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

# The headings of a document as links name them.
anchors() {
  sed -n 's/^##* //p' "$1" | tr '[:upper:]' '[:lower:]' | sed -e 's/[^a-z0-9 _-]//g' -e 's/ /-/g'
}

while IFS=: read -r document link; do
  file=${link%%#*}
  target=$(dirname "$document")/$file
  [[ -n $file ]] || target=$document
  if [[ ! -e $target ]]; then
    echo "$document: there is no $file to link to"
    bad=1
  elif [[ $link == *#* ]] && ! anchors "$target" | grep -xF -- "${link#*#}" >/dev/null; then
    echo "$document: ${file:-it} has no heading #${link#*#}"
    bad=1
  fi
done < <(grep -oE '\]\([^) ]+\)' ./*.md docs/*.md | sed -e 's/\](//' -e 's/)$//' | grep -vE ':(https?|mailto):')
exit $bad
