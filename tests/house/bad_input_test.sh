#!/usr/bin/env bash
# cli_test.sh LIVECAP SOURCE_DIR: what the program does with bad usage and bad input. Each case: the exit code, exactly
# one line of error, and what that line must name. No case may crash or leave a file that looks complete.
set -uo pipefail
livecap=$1
source=$2
dir=$(mktemp -d)
trap 'chmod -R u+w "$dir"; rm -rf "$dir"' EXIT
cd "$dir" || exit 1
unset DISPLAY WAYLAND_DISPLAY SDL_VIDEODRIVER
failures=0
cases=0

# expect CODE PATTERN ARGS...: the program ends with CODE and one line "error: ..." matching every word of PATTERN.
expect() {
  local code=$1 pattern=$2 got lines
  shift 2
  cases=$((cases + 1))
  timeout 120 "$livecap" "$@" >out.txt 2>err.txt
  got=$?
  lines=$(grep -c '^error: ' err.txt)
  local others
  others=$(grep -cvE '^(error: |warning: |capture |live |synth |detect |eval |render |actor: |views |calibrate )' err.txt)
  local word missing=
  for word in $pattern; do
    grep '^error: ' err.txt | grep -qF -- "$word" || missing+=" $word"
  done
  if [[ $got -ne $code || $lines -ne 1 || $others -ne 0 || -n $missing ]]; then
    echo "FAILED: livecap $*"
    echo "  exit code $got, expected $code; $lines error lines, $others other lines; not named:${missing:- nothing}"
    sed 's/^/  | /' err.txt | head -5
    failures=$((failures + 1))
  fi
}

# A short good sequence to break.
"$livecap" -q synth --actor builtin:trousers --motion raise --frames 6 --empty-frames 2 --out seq >/dev/null || exit 1
capture() {  # capture with one option replaced: capture NAME VALUE prints the arguments
  local -A option=([--video]=seq/video.mp4 [--camera]=seq/camera.json [--background]=seq/background.png
    [--actor]=seq/actor.glb [--model]=lite [--out]=result)
  [[ $# -eq 0 ]] || option[$1]=$2
  local name
  for name in "${!option[@]}"; do [[ -z ${option[$name]} ]] || printf '%s\n%s\n' "$name" "${option[$name]}"; done
}
expect_capture() {  # CODE PATTERN NAME VALUE [MORE...]
  local code=$1 pattern=$2 args
  mapfile -t args < <(capture "$3" "$4")
  shift 4
  expect "$code" "$pattern" capture "${args[@]}" "$@"
  if [[ -e result/report.json || -e result/capture.glb ]]; then
    echo "FAILED: $pattern: a complete-looking result was left"
    failures=$((failures + 1))
  fi
  chmod -R u+w result 2>/dev/null
  rm -rf result
}

# Usage.
expect 2 'subcommand'
expect 2 'nonsense' nonsense
expect 2 '--video' capture
expect 2 '--no-such-option' devices --no-such-option
expect 2 '--frames' capture --frames three
expect_capture 2 '--without nonsense' --camera seq/camera.json --without nonsense
expect_capture 2 '--fov --camera' --camera seq/camera.json --fov 60
expect_capture 2 '--height' --camera seq/camera.json --height 9
expect_capture 2 '--camera' --camera ''
expect 2 'nobody skirt' synth --actor builtin:nobody --out s
expect 2 'nonsense' synth --motion nonsense --out s
expect 2 'none.toml' devices --config none.toml
# Which numbers are right, and not the limits of double.
expect_capture 2 '--frames: must be at least 1, not 0' --camera seq/camera.json --frames 0
expect_capture 2 '--first: must be at least 0, not -1' --camera seq/camera.json --first -1
expect_capture 2 '--rigidity: must be above 0, not -1' --camera seq/camera.json --rigidity -1
expect_capture 2 '--height: must be between 0.5 and 3 metres, not 0' --camera seq/camera.json --height 0
expect_capture 2 '--frames: whole number, not 2.5' --camera seq/camera.json --frames 2.5
expect 2 '--fov: must be a number, not abc' detect --fov abc
expect 2 '--fov: must be between 1 and 170' live --fov 400
expect 2 '--rigidity: must be above 0' live --rigidity 0
expect 2 '--height: between 0.5 and 3 metres, not 178' actor inspect builtin:skirt --height 178
expect 2 '--height: between 0.5 and 3 metres, not 17' synth --height 17 --out s
expect 2 '--frames -4: between 0 and 100000' synth --frames -4 --out s
expect 2 '--picture-height 7' synth --picture-height 7 --out s
expect 2 '--seed: at least 0, not -1' synth --seed -1 --out s
for option in capture detect live 'actor build' 'actor fit' 'eval --ablate'; do
  expect 2 '--fov: must be between 1 and 170 degrees, not -5' $option --video seq/video.mp4 --fov -5
done
expect 2 '--fov: must be between 1 and 170 degrees, not 0' capture --video seq/video.mp4 --fov 0
for option in capture live 'actor fit' 'eval --ablate'; do
  expect 2 '--background-frames: must be at least 1, not -3' $option --background-frames -3
done
for option in views vertices texture grid; do
  expect 2 "--$option: must be between , not -1" actor build --"$option" -1
done
expect 2 '--fit-frames: between 4 and 200, not -1' actor fit --fit-frames -1
expect 2 '--frames: at least 1, not -1' actor fit --frames -1
expect 2 '--max-views: between , not -1' calibrate --max-views -1
expect 2 '--views: between 1 and 1000, not 0' actor views --views 0
expect 2 '--unit: auto' actor compare seq/actor.glb seq/actor.glb --views seq --unit auto
# What was misspelt, and whose help says more.
expect 2 'no option --vidoe capture --help' capture --vidoe a.mp4
expect 2 'no option --draws bench --help' bench --draws
expect 2 'no subcommand captur livecap --help' -q captur
expect 2 'no subcommand buidl actor --help' actor buidl
expect 2 'no subcommand capure livecap --help' capure --help
expect 2 'no subcommand bild actor --help' actor bild --help
expect 2 'no option --foo actor fit --help' actor fit --foo
expect 2 '--video: value missing' capture --video
expect 2 'unexpected argument b' actor inspect a b
# Options from a file: file and line of what is wrong; below the subcommand's name or at the top.
echo 'nonsense = 1' >bad.toml
expect 2 'bad.toml:1: no option nonsense' devices --config bad.toml
printf 'frames = 3\nvideo = [[[\n' >bad.toml
expect 2 'bad.toml:2: array' capture --config bad.toml
printf '# all\n[capture]\nframes = 0\n' >bad.toml
expect 2 'bad.toml:3: --frames: must be at least 1' capture --config bad.toml
printf '[actor.buidl]\nmesh = "none.obj"\n' >bad.toml
expect 2 'bad.toml:2: subcommand' actor build --config bad.toml
printf '[actor.fit]\nno_option = 1\n[actor.build]\nimages = "seq/truth/masks"\nparser = "no#ne.onnx" # a network\nno-refine = true\nparser-mean = [\n  0.1, 0.2,\n 0.3]\n' >good.toml
expect 2 'no#ne.onnx' actor build --config good.toml --out a.glb
printf 'mesh = "top.obj"\nout = "top.glb"\n[actor.build]\nmesh = "own.obj"\nout = "own.glb"\n' >good.toml
expect 2 'own.obj' actor build --config good.toml
printf '[actor]\nmesh = "none.obj"\n' >bad.toml
expect 2 'bad.toml:2: mesh [actor.build]' actor build --config bad.toml --out a.glb
printf '"mesh" = "none.obj"\nout = "a.glb"\n' >good.toml
expect 2 'none.obj' actor build --config good.toml
expect 2 'other.obj' actor build --config good.toml --mesh other.obj
cases=$((cases + 1))
if ! "$livecap" --help | grep -q '1 the run failed .*interruption'; then
  echo "FAILED: the help does not say what an interruption returns"
  failures=$((failures + 1))
fi

# Broken files of every kind: missing, empty, cut off, garbage.
head -c 4000 /dev/zero | tr '\0' 'x' >garbage
: >empty
for kind in video actor model camera background; do
  case $kind in
    video) good=seq/video.mp4 ;;
    actor) good=seq/actor.glb ;;
    model) good=$source/models/pose_landmark_lite.tflite ;;
    camera) good=seq/camera.json ;;
    background) good=seq/background.png ;;
  esac
  suffix=${good##*.}
  cp garbage "garbage.$suffix"
  cp empty "empty.$suffix"
  size=$(stat -c %s "$good")
  head -c $((size * 2 / 3)) "$good" >"cut.$suffix"
  for name in "none.$suffix" "empty.$suffix" "garbage.$suffix" "cut.$suffix"; do
    [[ $name == cut.mp4 ]] && continue  # has frames: below
    expect_capture 2 "$name" "--$kind" "$name"
  done
done
expect_capture 2 'none.jsonl' --background seq/background.png --detections none.jsonl
expect_capture 2 'garbage' --background seq/background.png --detections garbage

# A video that ends early is captured as far as it goes, with a warning and one row per frame; without its index it is none.
cases=$((cases + 1))
mapfile -t args < <(capture --video cut.mp4)
if ! "$livecap" capture "${args[@]}" >out.txt 2>err.txt || ! grep -q 'warning: cut.mp4' err.txt ||
  [[ $(grep -c . result/frames.csv) -lt 3 || $(grep -c . result/frames.csv) -gt 7 ]]; then
  echo "FAILED: a video that ends early"
  sed 's/^/  | /' err.txt | head -5
  failures=$((failures + 1))
fi
rm -rf result
head -c 300 seq/video.mp4 >stub.mp4
expect_capture 2 'stub.mp4' --video stub.mp4

# Files that are fine but not for this.
sed 's/"width": *540/"width": 640/' seq/camera.json >wide.json
expect_capture 2 'wide.json width 640 540' --camera wide.json
sed 's/"fx": *[0-9.]*/"fx": -1/' seq/camera.json >negative.json
expect_capture 2 'negative.json fx' --camera negative.json
sed 's/^{/{"floor":{"normal":[0,1,0],"distance_mm":1200},/' seq/camera.json >ceiling.json
expect_capture 2 'ceiling.json floor.normal down' --camera ceiling.json
sed 's/"fx": *[0-9.]*/"fx": "long"/' seq/camera.json >text.json
expect_capture 2 'text.json fx' --camera text.json
# An actor whose bones nobody knows: the names are overwritten at the same length, so that the container stays whole.
sed -E 's/"name":"Left/"name":"Zzza/g; s/"name":"Right/"name":"Zzzzb/g; s/"Hips"/"Zzzc"/; s/"Neck"/"Zzzd"/' seq/actor.glb >boneless.glb
[[ $(stat -c %s boneless.glb) -eq $(stat -c %s seq/actor.glb) ]] || { echo "the test's own GLB is broken"; exit 1; }
expect_capture 2 'boneless.glb' --actor boneless.glb
expect 2 'boneless.glb' actor inspect boneless.glb
cases=$((cases + 1))
if ! "$livecap" actor inspect builtin:skirt | grep -q '^hanging cloth: .* taut' ||
  "$livecap" actor inspect builtin:trousers | grep -q 'hanging cloth'; then
  echo "FAILED: actor inspect, of hanging cloth"
  failures=$((failures + 1))
fi

# Output that cannot be written.
touch file
expect_capture 2 'file' --out file/below
expect 2 'file' synth --actor builtin:trousers --frames 3 --out file/below
if [[ $(id -u) -ne 0 ]]; then
  mkdir locked && chmod a-w locked
  expect_capture 2 'locked' --out locked/below
fi

# Devices.
expect_capture 2 'nonsense valid :0' --out result --solver-device nonsense
expect_capture 2 'nonsense valid :0' --out result --cnn-device nonsense
cases=$((cases + 1))
if ! "$livecap" devices --no-test | grep -qE '^ +selected by +[a-z]+:0'; then
  echo "FAILED: devices does not tell selectors"
  failures=$((failures + 1))
fi
export OCL_ICD_VENDORS=/nonexistent
expect 1 'OpenCL device' devices
expect_capture 1 'OpenCL' --out result
unset OCL_ICD_VENDORS

# A first frame after the last: the video's length, and nothing is written.
expect_capture 2 '--first 100000 seq/video.mp4 6 frames' --camera seq/camera.json --first 100000
expect_capture 2 '--background-frames 6: seq/video.mp4 6 frames' --background '' --background-frames 6
expect 2 '--first 6: seq/video.mp4 6 frames' detect --video seq/video.mp4 --camera seq/camera.json --model lite --first 6 --out detected
[[ ! -e detected ]] || { echo "FAILED: detect left a folder"; failures=$((failures + 1)); }

# live, which writes nothing.
live=(live --video seq/video.mp4 --camera seq/camera.json --background seq/background.png --actor seq/actor.glb --model lite)
expect 2 '--camera --fov' live --video seq/video.mp4 --actor seq/actor.glb
expect 2 '--fov' live --video seq/video.mp4 --actor seq/actor.glb --fov 400
expect 2 'none.mp4' live --video none.mp4 --fov 60 --actor seq/actor.glb
expect 2 'none.glb' live --video seq/video.mp4 --fov 60 --actor none.glb
expect 2 'wide.json 640 540' live --video seq/video.mp4 --camera wide.json --actor seq/actor.glb
expect 2 'here HOST:PORT 39539' "${live[@]}" --vmc here
expect 2 'nobody.invalid host' "${live[@]}" --vmc nobody.invalid:39539
expect 2 'nonsense' "${live[@]}" --without nonsense
expect 2 '--background-frames 99: seq/video.mp4 6 frames' live --video seq/video.mp4 --camera seq/camera.json --background-frames 99 --actor seq/actor.glb --model lite
expect 2 'nonsense valid :0' "${live[@]}" --solver-device nonsense
# Without libavdevice, or SDL in FFmpeg, there is no window anywhere.
"$livecap" "${live[@]}" --show >out.txt 2>err.txt
if grep -qE '^error: no window: (libavdevice.* is missing|this FFmpeg has no SDL)' err.txt; then
  echo "skipped: live --show shows pictures: $(grep -h '^error: ' err.txt)"
  expect 2 'no window:' "${live[@]}" --show
  show=()
else
  expect 2 'no window desktop DISPLAY' "${live[@]}" --show
  show=(--show)
fi
cases=$((cases + 1))
if ! SDL_VIDEODRIVER=dummy "$livecap" "${live[@]}" "${show[@]}" --vmc 127.0.0.1:39539 >out.txt 2>err.txt || ! grep -q '^pictures *6, tracked [1-6],' out.txt ||
  ! grep -qE '^sent +[1-9][0-9]* packets to 127.0.0.1:39539' out.txt; then
  echo "FAILED: live"
  sed 's/^/  | /' err.txt out.txt | head -20
  failures=$((failures + 1))
fi

# eval.
expect 2 'none' eval --capture none --truth seq/truth
mkdir -p half && echo '{}' >half/report.json && cp empty half/joints.csv
expect 2 'half/report.json actor' eval --capture half --truth seq/truth
echo 'not json' >half/report.json
expect 2 'half/report.json JSON' eval --capture half --truth seq/truth

# A good capture, then what does not go with it.
mapfile -t args < <(capture --out good)
"$livecap" -q capture "${args[@]}" >/dev/null || exit 1
expect 2 '--capture' eval --truth seq/truth
# What lies there stays: no input is a file that is written, and a run that cannot begin takes nothing away.
cp -r good kept
expect_kept() {  # PATTERN ARGS...: capture into kept fails and leaves every byte
  local pattern=$1 before after
  shift
  before=$(cd kept && sha256sum -- * | sort)
  expect 2 "$pattern" capture "$@" --out kept
  after=$(cd kept && sha256sum -- * | sort)
  [[ $before == "$after" ]] || { echo "FAILED: $pattern: kept/ is not what it was"; failures=$((failures + 1)); }
}
plate=(--background seq/background.png)
sequence=(--video seq/video.mp4 --camera seq/camera.json --actor seq/actor.glb "${plate[@]}")
expect_kept '--detections kept/detections.jsonl overwritten --out' "${sequence[@]}" --detections kept/detections.jsonl
expect_kept '--camera kept/camera.json overwritten' --video seq/video.mp4 --camera kept/camera.json --actor seq/actor.glb "${plate[@]}"
expect_kept '--actor kept/capture.glb overwritten' --video seq/video.mp4 --camera seq/camera.json --actor kept/capture.glb "${plate[@]}"
expect_kept 'big' "${sequence[@]}" --model big
expect_kept 'none.jsonl' "${sequence[@]}" --detections none.jsonl
expect_kept 'garbage.png' --video seq/video.mp4 --camera seq/camera.json --actor seq/actor.glb --background garbage.png
rm -rf kept
# Another draw has other detections, and its report says so.
cases=$((cases + 1))
mapfile -t args < <(capture --out drawn)
if ! "$livecap" -q capture "${args[@]}" --no-surface --draw 7 2>err.txt ||
  ! grep -q '"draw": 7' drawn/report.json || cmp -s good/detections.jsonl drawn/detections.jsonl; then
  echo "FAILED: capture --draw"
  failures=$((failures + 1))
fi
rm -rf drawn
# Somebody in frames that were called empty: a warning.
cases=$((cases + 1))
mapfile -t args < <(capture --background '')
if ! "$livecap" -q capture "${args[@]}" --no-surface --background-frames 4 >/dev/null 2>err.txt ||
  ! grep -q 'sees a person in [1-4] of the first 4 frames' result/report.json; then
  echo "FAILED: capture --background-frames with the person in them"
  failures=$((failures + 1))
fi
rm -rf result
expect 2 'nowhere folder' eval --capture good --truth nowhere
mkdir -p nothing
expect 2 'nothing vertices.pc2 joints.json masks' eval --capture good --truth nothing
expect 2 'nothing: joints.csv' eval --capture nothing --truth seq/truth
cp -r good bare && rm bare/joints.csv
expect 2 'bare: joints.csv' eval --capture bare --truth seq/truth
cp good/joints.csv bare && sed -i '4s/,[^,]*$/,abc/' bare/joints.csv
expect 2 'bare/joints.csv line 4 "abc" number' eval --capture bare --truth seq/truth
mkdir -p tenth  # ten points, no sample
printf 'POINTCACHE2\0\1\0\0\0\12\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >tenth/vertices.pc2
expect 2 'tenth/vertices.pc2 10 points' eval --capture good --truth tenth
cp -r good other && cp tenth/vertices.pc2 other
expect 2 'other/vertices.pc2 10 points' eval --capture other --truth seq/truth
expect 2 'wide.json' eval --capture good --truth seq/truth --camera wide.json --view wide.json seq/truth/masks
sed 's/"width": *540/"width": 640/' seq/camera.json >other.json
expect 2 'masks 540x960 640x960' eval --capture good --truth seq/truth --camera other.json
mkdir -p deserted/masks
"$livecap" -q synth --actor builtin:trousers --motion raise --frames 3 --empty-frames 2 --out empty_seq >/dev/null || exit 1
cp empty_seq/truth/masks/000000.png deserted/masks/000003.png
expect 2 'deserted nobody' eval --capture good --truth deserted
expect 2 'seq/camera.json view_from_camera' eval --capture good --truth seq/truth --view seq/camera.json seq/truth/masks
sed 's/^{/{"view_from_camera":[[1,0,0,0],[0,1,0,0],[0,0,1,0]],/' seq/camera.json >view.json
expect 2 'nowhere folder' eval --capture good --truth seq/truth --view view.json nowhere
expect 2 'nothing 000000.png' eval --capture good --truth seq/truth --view view.json nothing
expect 2 'nowhere/report.html' eval --capture good --truth seq/truth --html nowhere/report.html
expect 2 'none' eval --capture good --truth seq/truth --pose-only none

# export.
expect 2 '--out' export --capture good
expect 2 '--out up.fbx .glb' export --capture good --out up.fbx
expect 2 'none folder' export --capture none --out up.glb
expect 2 'nothing: joints.csv' export --capture nothing --out up.glb
expect 2 '--camera seq/camera.json floor' export --capture good --out up.glb --camera seq/camera.json
expect 2 'good/frames.csv nobody' export --capture good --out up.glb --first 100000
expect 2 'nowhere/up.glb' export --capture none --out nowhere/up.glb
expect 2 '--bvh-unit' export --capture good --out up.bvh --bvh-unit inch

# render.
expect 2 '--out' render --capture good
expect 2 'none folder' render --capture none --out film.mp4
expect 2 'nothing: joints.csv' render --capture nothing --out film.mp4
cp -r good still && rm still/vertices.pc2
expect 2 'still/vertices.pc2 missing' render --capture still --out film.mp4
expect 2 'other/vertices.pc2 10 points' render --capture other --out film.mp4
head -c 5000 good/vertices.pc2 >still/vertices.pc2
expect 2 'still/vertices.pc2 truncated' render --capture still --out film.mp4
expect 2 '--view above camera front' render --capture good --out film.mp4 --view above
expect 2 '--style gold texture' render --capture good --out film.mp4 --style gold
expect 2 '--size 0x0' render --capture good --out film.mp4 --size 0x0
expect 2 '--size wide' render --capture good --out film.mp4 --size wide
expect 2 '--sheet FILE.png' render --capture good --out film.mp4 --sheet 2x2
expect 2 '--background sky' render --capture good --out film.mp4 --background sky
expect 2 'garbage.png' render --capture good --out film.mp4 --background garbage.png
expect 2 'none.mp4' render --capture good --out film.mp4 --video none.mp4
expect 2 'seq/video.mp4 540x960 640x960 --camera' render --capture good --out film.mp4 --camera wide.json
expect 2 'film.avi .mp4' render --capture good --out film.avi
expect 2 'nowhere/film.mp4' render --capture good --out nowhere/film.mp4
expect 2 'empty/frames' render --capture good --out empty/frames --view left
expect 2 'seq/video.mp4 input' render --capture good --out seq/video.mp4
expect 2 '--first' render --capture good --out film.mp4 --first 1000
cases=$((cases + 1))
if compgen -G 'film.*' >/dev/null || ! "$livecap" -q render --capture good --out film.mp4 --side-by-side >/dev/null 2>err.txt || [[ ! -s film.mp4 ]]; then
  echo "FAILED: render, or one of the failed ones left a film"
  sed 's/^/  | /' err.txt | head -5
  failures=$((failures + 1))
fi
expect 2 '--video' eval --ablate --truth seq/truth
expect 2 '--draws 0' eval --ablate --draws 0 --truth seq/truth --video seq/video.mp4
expect_capture 2 '--draw 100 99' --draw 100
expect_capture 2 '--draw --detections' --draw 1 --detections good/detections.jsonl
expect 2 '--capture --video' eval --ablate --truth seq/truth --capture good
expect 2 'nowhere folder' eval --ablate --truth nowhere --video seq/video.mp4 --camera seq/camera.json --actor seq/actor.glb
expect 2 'none.mp4' eval --ablate --truth seq/truth --video none.mp4 --camera seq/camera.json --actor seq/actor.glb

# What it does with good input: every row of the ablation, one self-contained page.
cases=$((cases + 1))
if ! "$livecap" eval --ablate --truth seq/truth --video seq/video.mp4 --camera seq/camera.json \
  --actor seq/actor.glb --height 1.7 --smooth \
  --background seq/background.png --model lite --view view.json seq/truth/masks --out table --html table.html \
  >out.txt 2>err.txt || [[ $(grep -cE ' [0-9.]+ +[0-9.]+ +[0-9.]+ +[-+][0-9.]+ %' out.txt) -ne 21 ]] ||
  ! grep -q '"height_mm": 1700' table/full/report.json || ! grep -q '"smooth": true' table/full/report.json ||
  [[ ! -s table/ablation.json ]] || ! grep -q '</html>' table.html || grep -qE 'https?:|<script' table.html; then
  echo "FAILED: eval --ablate"
  sed 's/^/  | /' err.txt out.txt | head -20
  failures=$((failures + 1))
fi

# actor build.
ln -s seq/video.mp4 link.glb
echo '{}' >a.html
expect 2 '--images --mesh' actor build --out a.glb
expect 2 'nowhere' actor build --images nowhere --out a.glb
expect 2 'none.obj' actor build --mesh none.obj --out a.glb
expect 2 'garbage' actor build --mesh garbage --out a.glb
expect 2 '--unit feet' actor build --mesh seq/actor.glb --unit feet --out a.glb
expect 2 '--vertices 3' actor build --mesh seq/actor.glb --vertices 3 --out a.glb
expect 2 'cameras.txt' actor build --images seq/truth/masks --out a.glb
printf '1 PINHOLE 540 960 500\n' >cameras.txt
printf '1 1 0 0 0 0 0 5 1 a.png\n\n' >images.txt
expect 2 'cameras.txt line 1 PINHOLE' actor build --images seq/truth/masks --cameras . --out a.glb
expect 2 'none.mp4' actor build --video none.mp4 --out a.glb
expect 2 'seq/video.mp4 turn' actor build --video seq/video.mp4 --camera seq/camera.json --model lite --out a.glb
expect 2 '--colmap --images' actor build --colmap --mesh seq/actor.glb --out a.glb
expect 2 '--cameras --colmap' actor build --colmap --images seq/truth/masks --cameras . --out a.glb
printf 'no network at all' >net.onnx
expect 2 'net.onnx byte ModelProto' actor build --images seq/truth/masks --parser net.onnx --out a.glb
expect 2 'none.onnx' actor build --images seq/truth/masks --parser none.onnx --out a.glb
expect 2 '--parser --images' actor build --mesh seq/actor.glb --parser net.onnx --out a.glb
expect 2 '--labels --parser' actor build --images seq/truth/masks --labels seq/truth/masks --parser net.onnx --out a.glb
expect 2 '--parser-std' actor build --images seq/truth/masks --parser net.onnx --parser-std 0 1 1 --out a.glb
expect 2 '--images --video' actor build --video seq/video.mp4 --images seq/truth/masks --out a.glb
expect 2 '--camera --video' actor build --images seq/truth/masks --camera seq/camera.json --out a.glb
expect 2 'nobody' actor views builtin:nobody --out v
expect 2 'nobody' actor compare seq/actor.glb builtin:nobody
expect 2 'none.glb' actor compare none.glb seq/actor.glb
for option in --cameras --masks --labels; do
  expect 2 "$option needs --images" actor build --mesh seq/actor.glb "$option" seq/truth/masks --out a.glb
done
expect 2 '--parser-mean requires --parser' actor build --images seq/truth/masks --parser-mean 0 0 0 --out a.glb
expect 2 '--parser-std requires --parser' actor build --images seq/truth/masks --parser-std 1 1 1 --out a.glb
expect 2 '--parser-bgr requires --parser' actor build --images seq/truth/masks --parser-bgr --out a.glb
expect 2 '--out a.html: .glb' actor build --mesh seq/actor.glb --out a.html
expect 2 'nowhere/a.glb: nowhere' actor build --mesh none.obj --out nowhere/a.glb
expect 2 '--mesh seq/actor.glb overwritten --out' actor build --mesh seq/actor.glb --out seq/actor.glb
expect 2 '--joints a.html overwritten --out' actor build --mesh none.obj --joints a.html --out a.glb
expect 2 '--video overwritten' actor build --video link.glb --out link.glb
expect 2 'nowhere/c.html nowhere' actor compare none.glb seq/actor.glb --html nowhere/c.html
rm a.html link.glb
[[ ! -e a.glb ]] || { echo "FAILED: actor build left a file"; failures=$((failures + 1)); }

# actor fit.
fit=(actor fit --video seq/video.mp4 --camera seq/camera.json --out a.glb)
expect 2 '--video' actor fit --camera seq/camera.json --out a.glb
expect 2 '--camera --fov' actor fit --video seq/video.mp4 --out a.glb
expect 2 '--actor seq/actor.glb builtin:skirt' "${fit[@]}" --actor seq/actor.glb
expect 2 'nobody skirt' "${fit[@]}" --actor builtin:nobody
expect 2 '--height: between 0.8 and 2.5 metres, not 9' "${fit[@]}" --height 9
expect 2 '--fit-frames' "${fit[@]}" --fit-frames 2
expect 2 '--background-frames -1' "${fit[@]}" --background-frames -1
expect 2 '--background-frames 6: seq/video.mp4 6 frames' "${fit[@]}" --background-frames 6
expect 2 'none.png' "${fit[@]}" --background none.png
expect 2 'none.mp4' actor fit --video none.mp4 --camera seq/camera.json --out a.glb
expect 2 'wide.json 640x960 540x960' actor fit --video seq/video.mp4 --camera wide.json --out a.glb
expect 2 'seq/video.mp4 nobody' "${fit[@]}" --frames 2 --model lite
expect 2 '--out a.html: .glb' "${fit[@]:0:6}" --out a.html
expect 2 'nowhere/a.glb: nowhere' actor fit --video none.mp4 --camera seq/camera.json --out nowhere/a.glb
cp seq/camera.json a.html
expect 2 '--camera a.html overwritten --out' actor fit --video none.mp4 --camera a.html --out a.glb
rm a.html
[[ ! -e a.glb ]] || { echo "FAILED: actor fit left a file"; failures=$((failures + 1)); }
expect 2 '--legs 9 0.6 1.6' synth --legs 9 --out s
expect 2 '--crouch 60' synth --crouch 60 --out s

# actor import: a figure as Skeletool files have it, a mesh of 20 rings around 13 bones.
mkdir -p sk
awk 'BEGIN {
  n = split("root neck_1 left_shoulder left_elbow left_hand right_shoulder right_elbow right_hand left_hip left_knee " \
            "left_ankle right_hip right_knee right_ankle", name, " ")
  split("none root root left_shoulder left_elbow root right_shoulder right_elbow root left_hip left_knee root right_hip " \
        "right_knee", parent, " ")
  split("0,1000,0 0,500,0 180,450,0 270,0,0 250,0,0 -180,450,0 -270,0,0 -250,0,0 100,-50,0 0,-420,0 0,-420,0 -100,-50,0 " \
        "0,-420,0 0,-420,0", place, " ")
  out = "sk/p.skeleton"; print "Skeletool Skeleton Definition V1.0\njoints: " n >out
  for (i = 1; i <= n; ++i) {
    gsub(",", " ", place[i])
    print " ", name[i] "_rx revolute", parent[i] (i > 1 ? "_rx" : ""), place[i], "1 0 0 1" >out
  }
  print "markers: 0\nscaling joints: 0\ndofs: " n >out
  for (i = 1; i <= n; ++i) print "  dof" i " 1\n    nolimits\n    " name[i] "_rx 1" >out
  out = "sk/p.skin"; print "Skeletool character skinning file V1.0\nbones:" >out
  for (i = 1; i <= n; ++i) printf " %s", name[i] >out
  print "\nvertex weights:" >out
  for (i = 0; i < 400; ++i) print " ", i, i % n, "0.75", (i + 1) % n, "0.25" >out
  out = "sk/p.obj"; pi = 3.14159265
  for (i = 0; i < 400; ++i) {
    a = pi * (int(i / 20) + 1) / 21; b = 2 * pi * (i % 20) / 20
    print "v", 800 * sin(a) * cos(b), 900 - 900 * cos(a), -200 * sin(a) * sin(b) >out
    print 5 >"sk/p.labels"
  }
  for (i = 0; i < 380; ++i) {
    j = i - i % 20 + (i + 1) % 20
    print "f", i + 1, j + 1, j + 21, i + 21 >out
  }
  out = "sk/p.motion"; print "Skeletool Motion File V1.0" >out
  for (f = 4; f < 7; ++f) { printf "%d", f >out; for (i = 1; i <= n; ++i) printf " 0.1" >out; print "" >out }
  out = "sk/p.calibration"; print "Skeletool Camera Calibration File V1.0" >out
  for (c = 0; c < 2; ++c)
    print "name view" c "\n size 540 960\n animated 0\n intrinsic 900 0 270 0 0 900 480 0 0 0 1 0 0 0 0 1\n" \
          " extrinsic 1 0 0 0 0 -1 0 1000 0 0 -1 4000 0 0 0 1\n radial 0" >out
}'
refused() {  # PATTERN [OPTION VALUE]...: the import is refused with these options; an empty value leaves one out
  local pattern=$1 name args=()
  local -A option=([--skeleton]=sk/p.skeleton [--skin]=sk/p.skin [--mesh]=sk/p.obj [--motion]=sk/p.motion
    [--cameras]=sk/p.calibration [--camera]=view1 [--truth]=sk/truth [--labels]=sk/p.labels [--out]=sk/p.glb)
  shift
  for (( ; $#; )); do option[$1]=$2; shift 2; done
  for name in "${!option[@]}"; do [[ -z ${option[$name]} ]] || args+=("$name" "${option[$name]}"); done
  expect 2 "$pattern" actor import "${args[@]}"
}
replaced() {  # PATTERN FILE COMMAND: so it is with sk/FILE as COMMAND makes it of its lines
  local pattern=$1 file=sk/$2
  shift 2
  cp "$file" sk/whole
  "$@" <sk/whole >"$file"
  refused "$pattern"
  mv sk/whole "$file"
}
cases=$((cases + 1))
if ! "$livecap" -q actor import --skeleton sk/p.skeleton --skin sk/p.skin --mesh sk/p.obj --out sk/p.glb \
  --motion sk/p.motion --cameras sk/p.calibration --camera view1 --truth sk/truth >out.txt 2>err.txt ||
  ! grep -q "the motion's 4 to 6" out.txt || ! [[ -s sk/truth/joints.json && -s sk/truth/vertices.pc2 ]] ||
  ! grep -q '"fx": 900' sk/truth/camera.json || ! "$livecap" actor inspect sk/p.glb >out.txt 2>>err.txt ||
  ! grep -q 'bones named as in Skeletool' out.txt; then
  echo "FAILED: actor import"
  sed 's/^/  | /' err.txt out.txt | head -20
  failures=$((failures + 1))
fi
rm -rf sk/p.glb sk/p.html sk/truth
for file in skeleton skin motion calibration; do
  replaced "sk/p.$file:1: begin" "p.$file" echo garbage
  replaced "sk/p.$file:1: ends" "p.$file" head -n 1
done
replaced 'sk/p.skeleton:9: ends joint' p.skeleton head -n 9
replaced 'sk/p.skeleton:4: joint' p.skeleton sed '4s/ 1$//'
replaced 'sk/p.skeleton left_wrist --bones left_paw' p.skeleton sed 's/left_hand/left_paw/g'
replaced 'sk/p.skeleton neck_1_rx scaled' p.skeleton sed '/neck_1_rx rev/s/1$/1.2/'
replaced 'sk/p.skin:3: left_paw' p.skin sed 's/left_hand/left_paw/'
replaced 'sk/p.skin 399 sk/p.obj 400' p.skin head -n 403
replaced 'sk/p.skin:9: pairs' p.skin sed '9s/0.25$//'
replaced 'sk/p.obj triangles' p.obj echo garbage
replaced 'sk/p.obj: line 7: three' p.obj sed '7s/.*/v 1 2/'
replaced 'sk/p.skin 400 sk/p.obj 401' p.obj sed '1iv 0 0 0'
replaced 'sk/p.obj: reaches zero mm' p.obj awk '/^v/ { $2 /= 1000; $3 /= 1000; $4 /= 1000 } { print }'
replaced 'sk/p.motion:3: 13 14' p.motion sed '3s/ 0.1$//'
replaced 'sk/p.motion:3: ascend' p.motion sed '3s/^5/4/'
replaced 'sk/p.calibration: view0 intrinsic' p.calibration sed '8,$d;/size/!{/^[^nS]/d}'
for option in --skeleton --skin --mesh --texture --labels --bones --motion --cameras; do refused 'none.obj' "$option" none.obj; done
for option in --skeleton --skin --mesh --out; do refused "$option required" "$option" ''; done
printf '5\n5\n' >sk/labels.txt
refused 'sk/labels.txt 2 labels sk/p.obj 400' --labels sk/labels.txt
refused 'sk/p.obj texture vt seq/background.png' --texture seq/background.png
echo '{"left_wrist": "paw"}' >sk/bones.json
refused 'sk/bones.json left_wrist paw' --bones sk/bones.json
refused '--camera view9 sk/p.calibration view0, view1' --camera view9
refused '--camera sk/p.calibration view0, view1' --camera ''
refused '--camera requires --cameras' --cameras ''
refused '--first 7: sk/p.motion 4 to 6' --first 7
refused '--motion --truth' --truth ''
refused '--out a.html: .glb' --out a.html
refused 'nowhere/a.glb: nowhere' --out nowhere/a.glb
[[ ! -e sk/truth ]] || { echo "FAILED: a refused actor import made a folder"; failures=$((failures + 1)); }
refused 'sk/labels.txt' --truth sk/labels.txt
cp sk/bones.json sk/p.html
refused '--bones sk/p.html overwritten' --bones sk/p.html
rm sk/p.html
mkdir sk/truth
cp sk/p.motion sk/truth/joints.json
refused '--motion sk/truth/joints.json overwritten' --motion sk/truth/joints.json
cmp -s sk/p.motion sk/truth/joints.json || { echo "FAILED: actor import overwrote its motion"; failures=$((failures + 1)); }
[[ ! -e sk/p.glb ]] || { echo "FAILED: actor import left a file"; failures=$((failures + 1)); }

# calibrate.
expect 2 '--images --video' calibrate --board 9x6 --out c.json
expect 2 '--board --charuco' calibrate --images seq/truth/masks --out c.json
expect 2 '--board nine 9x6' calibrate --images seq/truth/masks --board nine --out c.json
expect 2 '--dictionary 9x9' calibrate --images seq/truth/masks --charuco 7x5 --dictionary 9x9 --out c.json
expect 2 '--marker' calibrate --images seq/truth/masks --charuco 7x5 --marker 75 --out c.json
expect 2 'nowhere/c.json: nowhere' calibrate --video none.mp4 --board 9x6 --out nowhere/c.json
expect 2 '--video seq/video.mp4 overwritten --out' calibrate --video seq/video.mp4 --board 9x6 --out seq/video.mp4
expect 2 'none.mp4' calibrate --video none.mp4 --board 9x6 --out c.json
expect 2 'nothing holds no .png' calibrate --images nothing --board 9x6 --out c.json
expect 2 'seq/truth/masks: no board with 9x6 inner corners' calibrate --images seq/truth/masks --board 9x6 --out c.json
expect 2 'seq/video.mp4: no board' calibrate --video seq/video.mp4 --charuco 7x5 --out c.json
floor=(calibrate --camera seq/camera.json --floor seq/background.png --out c.json)
expect 2 '--camera --floor' calibrate --camera seq/camera.json --board 9x6 --out c.json
expect 2 '--camera --images' "${floor[@]}" --images seq --board 9x6 --square 30
expect 2 '--square --floor' calibrate --images seq --board 9x6 --square 30 --out c.json
expect 2 '--square mm' "${floor[@]}" --board 9x6
expect 2 '--square -3' "${floor[@]}" --board 9x6 --square -3
expect 2 'seq/background.png no board with 9x6' "${floor[@]}" --board 9x6 --square 30
expect 2 'none.png' calibrate --camera seq/camera.json --out c.json --floor none.png --board 9x6 --square 30
expect 2 'none.png' calibrate --images nothing --out c.json --floor none.png --board 9x6 --square 30
expect 2 'negative.json' calibrate --camera negative.json --out c.json --floor seq/background.png --board 9x6 --square 30
[[ ! -e c.json ]] || { echo "FAILED: calibrate left a file"; failures=$((failures + 1)); }

# bench.
expect 2 'nowhere/video.mp4' bench --sequence nowhere
expect 2 '--frames' bench --frames 0
expect 2 'none.tflite' bench --sequence seq --model none.tflite
expect 2 'nonsense valid :0' bench --cnn-device nonsense
! grep -q '^synth ' err.txt || { echo "FAILED: bench makes a sequence before it looks for devices"; failures=$((failures + 1)); }
expect 2 '--trace nowhere/t.json' bench --sequence seq --trace nowhere/t.json
cases=$((cases + 1))
if ! "$livecap" -q bench --sequence seq --model lite --decoded >out.txt 2>err.txt ||
  ! grep -q '^input .*decoded before the clock starts' out.txt || ! grep -q '^  stages .* read 0\.' out.txt; then
  echo "FAILED: bench --decoded"
  sed 's/^/  | /' err.txt out.txt | head -20
  failures=$((failures + 1))
fi

echo "$cases cases, $failures failures"
[[ $failures -eq 0 ]]
