#!/usr/bin/env bash
# Sets up, makes the built-in actor and sequence, captures it and says how well that went.
#
#   tools/demo.sh [OUT]       write below OUT (default: demo_out); further runs reuse OUT/sequence
#
#   LIVECAP_DEMO_OPTIONS      more options for `livecap capture`, e.g. "--model heavy --solver-device gpu"
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export LIVECAP_BUILD_DIR=${LIVECAP_BUILD_DIR:-$root/build}
out=${1:-$root/demo_out}
sequence=$out/sequence
capture=$out/capture
livecap=$LIVECAP_BUILD_DIR/tools/livecap

"$root/tools/setup.sh" livecap

mkdir -p "$out"
if [[ ! -f $sequence/.complete ]]; then
  echo "== making the sequence $sequence"
  rm -rf "$sequence"
  "$livecap" synth --actor builtin:skirt --motion demo --out "$sequence"
  touch "$sequence/.complete"
fi

echo "== capturing it into $capture"
# shellcheck disable=SC2086
"$livecap" capture --video "$sequence/video.mp4" --camera "$sequence/camera.json" \
  --background "$sequence/background.png" --actor "$sequence/actor.glb" --out "$capture" --overlay \
  ${LIVECAP_DEMO_OPTIONS:-}

echo "== comparing with the ground truth"
"$livecap" eval --capture "$capture" --truth "$sequence/truth" --html "$out/report.html"

echo
for file in overlay.mp4 capture.glb report.json; do
  [[ -s $capture/$file ]] || { echo "demo.sh: $capture/$file is missing" >&2; exit 1; }
  printf '%-13s %s\n' "$file" "$capture/$file"
done
printf '%-13s %s\n' report.html "$out/report.html"
