#!/usr/bin/env bash
# outputs_test.sh LIVECAP: where results go, and what becomes of them when a run is stopped, nobody reads or nothing can
# be written.
livecap=$1
source "$(dirname "${BASH_SOURCE[0]}")/cases.sh"

# started ARGS...: runs in the background as $pid, and catches signals when this returns. Until it is the program, $pid is
# this shell's copy, which has this shell's handlers and ignores an interrupt.
started() {
  "$livecap" "$@" >out.txt 2>err.txt &
  pid=$!
  local i caught
  for ((i = 0; i < 600; ++i)); do
    caught=$(sed -n 's/^SigCgt:\t//p' "/proc/$pid/status")
    [[ /proc/$pid/exe -ef $livecap ]] && ((0x${caught:-0} & 2)) && return
    sleep 0.1
  done
}
# stopped_by SIGNAL WHAT: the run that was started ends with exit code 1 and says that it was interrupted.
stopped_by() {
  local got
  kill -"$1" "$pid"
  wait "$pid" 2>/dev/null
  got=$?
  check "$2 stopped by SIG$1: exit code $got" test "$got" = 1 -a "$(grep -c '^error: interrupted' err.txt)" = 1
}
sums() { find seq good -type f -exec sha256sum {} + | sort; }

"$livecap" -q synth --actor builtin:trousers --motion raise --frames 6 --empty-frames 2 --out seq >/dev/null || exit 1
sequence=(--video seq/video.mp4 --camera seq/camera.json --background seq/background.png)
"$livecap" -q capture "${sequence[@]}" --actor seq/actor.glb --model lite --out good >/dev/null || exit 1
eval=(eval --capture good --truth seq/truth)

# What is no file stays what it is; what a link leads to is replaced.
for what in 'eval --capture good --truth seq/truth --html' 'export --capture good --out'; do
  read -ra args <<<"$what"
  mkfifo pipe.glb
  timeout 60 cat pipe.glb >through &
  timeout 60 "$livecap" "${args[@]}" pipe.glb >out.txt 2>err.txt
  check "${args[0]} into a pipe" test -p pipe.glb
  [[ -p pipe.glb ]] || kill %%
  wait
  check "${args[0]} through a pipe" test -s through
  rm -f pipe.glb through
done
mkfifo pipe.mp4 pipe.bvh
expect 2 'pipe.mp4 pipe' render --capture good --out pipe.mp4
expect 2 'pipe.bvh pipe' export --capture good --out pipe.bvh
check 'pipes that are refused' test -p pipe.mp4 -a -p pipe.bvh
mkdir below
for file in page.html film.mp4; do ln -s "below/$file" "$file"; done
"$livecap" -q render --capture good --out film.mp4 >/dev/null 2>err.txt
"$livecap" "${eval[@]}" --html page.html >/dev/null 2>>err.txt
check 'links' test -L page.html -a -L film.mp4 -a -s below/page.html -a -s below/film.mp4

# No input is a result, and no two results are one file.
before=$(sums)
for file in good/report.json good/joints.csv good/vertices.pc2 good/actor.glb seq/truth/joints.json seq/actor.glb \
  seq/truth/masks/000003.png seq/truth/labels.npy seq/background.png good/capture.glb good/motion.bvh; do
  expect 2 "$file overwritten --html" "${eval[@]}" --html "$file"
  expect 2 "$file overwritten --out" "${eval[@]}" --out "$file"
done
ln -s good/frames.csv frames.html
expect 2 'overwritten' "${eval[@]}" --html frames.html
expect 2 'both.html two --html' "${eval[@]}" --html both.html --out both.html
expect 2 'seq/actor.glb overwritten --html' actor compare builtin:trousers seq/actor.glb --html seq/actor.glb
expect 2 'good/vertices.pc2 overwritten' export --capture good --out good/vertices.pc2
expect 2 'up.glb two' export --capture good --out up.glb --out ./up.glb
expect 2 'good/capture.glb overwritten --out' export --capture good --out good/capture.glb
expect 2 'good/motion.bvh overwritten --out' export --capture good --out good/motion.bvh
cp film.mp4 good/overlay.mp4
expect 2 'good/overlay.mp4 overwritten --out' render --capture good --out good/overlay.mp4
check 'the overlay is what it was' cmp -s film.mp4 good/overlay.mp4
rm good/overlay.mp4
ln -s good/report.json film2.mp4
expect 2 'report.json overwritten' render --capture good --out film2.mp4
check 'inputs are what they were' test "$before" = "$(sums)"

# A device that is always full, where one can be made.
if mknod full.html c 1 7 2>/dev/null && : 2>/dev/null >full.html; then
  expect 2 'full.html written' "${eval[@]}" --html full.html
  check 'a device stays one' test -c full.html
  "$livecap" "${eval[@]}" --json >full.html 2>err.txt
  check 'standard output on a full disk' test "$?" = 2 -a "$(grep -c '^error: standard output' err.txt)" = 1
else
  echo "skipped: no device can be made here"
fi
"$livecap" --help >&- 2>err.txt
check 'standard output that is closed' test "$?" = 2
"$livecap" devices 2>err.txt | head -1 >out.txt
check 'a reader that has seen enough' test "${PIPESTATUS[0]}" = 141 -a ! -s err.txt -a -s out.txt

# Stopped runs keep what they have. Nobody has to read the progress.
for signal in INT TERM HUP; do
  started synth --actor builtin:trousers --frames 5000 --out "long$signal"
  while [[ ! -e long$signal/truth/masks/000001.png ]] && kill -0 "$pid"; do sleep 0.1; done
  stopped_by "$signal" synth
  check "synth stopped by SIG$signal: its video" test -s "long$signal/video.mp4"
done
started devices
stopped_by INT devices
mkdir long && cp good/actor.glb good/camera.json long
for file in frames joints angles; do
  awk -v of=2 'NR == 1 { print; next } { row[NR] = $0; sub(/^[^,]*,[^,]*/, "", row[NR]) }
    END { for (k = 0; k < 30000; ++k) print k "," 33 * k row[of + k % (NR - 1)] }' "good/$file.csv" >"long/$file.csv"
done
for what in 'export --out long.bvh' 'eval --truth seq/truth --html long.bvh'; do
  for signal in INT TERM; do
    echo old >long.bvh
    read -ra args <<<"$what"
    started "${args[@]}" --capture long
    stopped_by "$signal" "${args[0]}"
    check "${args[0]} stopped by SIG$signal: the old file" test "$(cat long.bvh)" = old
  done
done
started live "${sequence[@]}" --actor seq/actor.glb --model lite
stopped_by INT 'live before its first picture'
{ "$livecap" synth --actor builtin:trousers --frames 40 --out unread 2>&1 >/dev/null; echo $? >code; } | true
check "progress that nobody reads: exit code $(cat code)" test "$(cat code)" = 0

# A run that was killed leaves no report.json; a sequence that was moved is not where that says.
cp -r good killed && rm killed/report.json killed/capture.glb
"$livecap" export --capture killed --out killed.glb >out.txt 2>err.txt
check 'export of a killed run' test -s killed.glb
"$livecap" -q render --capture killed --view left --out killed.png >out.txt 2>err.txt
check 'render of a killed run' test -s killed.png
expect 2 'killed/report.json: no such file --video --background' render --capture killed --out killed.png
"$livecap" "${eval[@]/good/killed}" >out.txt 2>err.txt
check 'eval of a killed run' grep -q vertex out.txt
mkdir moved nothing && mv seq moved
expect 2 'seq/camera.json good/report.json --camera --video' render --capture good --out film.mp4
expect 2 'seq/video.mp4 good/report.json --video' render --capture good --out film.mp4 --camera moved/seq/camera.json
mv moved/seq .
expect 2 'nothing: no capture folder joints.csv' render --capture nothing --out film.mp4

# Before the work, not after it.
expect 2 'below folder' bench --sequence seq --trace below
expect 2 'seq/video.mp4 overwritten --trace' bench --sequence seq --trace seq/video.mp4
# A variable of a script that was never set.
expect 2 '--out: empty' synth --out ''
expect 2 '--out: empty' actor views seq/actor.glb --out ''
expect 2 '--out: empty' detect --video seq/video.mp4 --fov 60 --out ''
expect 2 '--background: empty' capture --video seq/video.mp4 --fov 60 --actor seq/actor.glb --out result --background ''

# A home that cannot be written to is no reason to have no device; a cache folder of the user's is named.
unset POCL_CACHE_DIR
if XDG_CACHE_HOME=$dir/out.txt "$livecap" devices --no-test >list.txt 2>err.txt && grep -q -i pocl list.txt; then
  check 'a cache folder that cannot be written' grep -q '^warning: .*out.txt/pocl/kcache.* POCL_CACHE_DIR' err.txt
else
  check 'devices without a cache folder' false
fi
POCL_CACHE_DIR=$dir/out.txt/kcache "$livecap" devices --no-test >list.txt 2>err.txt
check "the user's cache folder" grep -q 'out.txt/kcache, where PoCL .* cannot be written' err.txt

ended
