# Sourced by tests of the program $livecap, which then run in a folder of their own that goes away, count their cases
# and end with `ended`.
set -uo pipefail
dir=$(mktemp -d)
trap 'chmod -R u+w "$dir"; rm -rf "$dir"' EXIT
cd "$dir" || exit 1
failures=0
cases=0

# check WHAT CONDITION...: one case; shows what was last said when the condition fails.
check() {
  local what=$1
  shift
  cases=$((cases + 1))
  "$@" && return
  echo "FAILED: $what"
  sed 's/^/  | /' err.txt | head -5
  failures=$((failures + 1))
}
# expect CODE PATTERN ARGS...: the program ends with CODE and one line "error: ..." that has every word of PATTERN.
expect() {
  local code=$1 pattern=$2 got lines others word missing=
  shift 2
  timeout 120 "$livecap" "$@" >out.txt 2>err.txt
  got=$?
  lines=$(grep -c '^error: ' err.txt)
  others=$(grep -cvE '^(error: |warning: |capture |live |synth |detect |eval |render |actor: |views |calibrate )' err.txt)
  for word in $pattern; do
    grep '^error: ' err.txt | grep -qF -- "$word" || missing+=" $word"
  done
  check "livecap $*: exit code $got, not $code; $lines error lines, $others others; not named:${missing:- nothing}" \
    test "$got $lines $others $missing" = "$code 1 0 "
}
ended() {
  echo "$cases cases, $failures failures"
  [[ $failures -eq 0 ]]
}
