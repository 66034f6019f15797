#!/usr/bin/env bash
# bad_input_test.sh LIVECAP SOURCE_DIR: what the program does with bad usage and bad input (actors and calibration:
# bad_actor_input_test.sh). No case may crash or leave a file that looks complete.
livecap=$1
root=$2
source "$(dirname "${BASH_SOURCE[0]}")/cases.sh"
unset DISPLAY WAYLAND_DISPLAY SDL_VIDEODRIVER

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
expect 2 '--seed: whole number 18446744073709551615, not 99999999999999999999999' synth --seed 99999999999999999999999 --out s
for option in capture detect live 'actor build' 'actor fit' 'eval --ablate'; do
  expect 2 '--fov: must be between 1 and 170 degrees, not -5' $option --video seq/video.mp4 --fov -5
done
expect 2 '--fov: must be between 1 and 170 degrees, not 0' capture --video seq/video.mp4 --fov 0
expect 2 '--learn-frames: must be at least 0, not -1' capture --learn-frames -1
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
if ! "$livecap" --help | grep >/dev/null '1 the run failed .*interruption'; then
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
    model) good=$root/models/pose_landmark_lite.tflite ;;
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
expect_capture 2 'none.json' --camera seq/camera.json --floor none.json
expect_capture 2 'seq/camera.json: tells no floor' --camera seq/camera.json --floor seq/camera.json
expect 2 'none.json' live --actor builtin:skirt --camera seq/camera.json --video seq/video.mp4 --floor none.json
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
sed 's/"f\([xy]\)": *[0-9.]*/"f\1": 35/' seq/camera.json >mm.json
expect_capture 2 'mm.json fx 35 degrees pixels' --camera mm.json
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
if ! "$livecap" actor inspect builtin:skirt | grep >/dev/null '^hanging cloth: .* taut' ||
  "$livecap" actor inspect builtin:trousers | grep >/dev/null 'hanging cloth'; then
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
if ! "$livecap" devices --no-test | grep >/dev/null -E '^ +selected by +[a-z]+:0'; then
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
cp good/joints.csv bare && truncate -s -9 bare/joints.csv  # as a crash leaves it
timeout 120 "$livecap" eval --capture bare --truth seq/truth >out.txt 2>err.txt
check 'a last line that was cut off is told and left out' grep -q '^warning: bare/joints.csv: the last line' err.txt
mkdir -p tenth  # ten points, no sample
printf 'POINTCACHE2\0\1\0\0\0\12\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >tenth/vertices.pc2
expect 2 'tenth/vertices.pc2 10 points' eval --capture good --truth tenth
cp -r good other && cp tenth/vertices.pc2 other
expect 2 'other/vertices.pc2 10 points' eval --capture other --truth seq/truth
mkdir -p piped && mkfifo piped/vertices.pc2
expect 2 'piped/vertices.pc2 pipe' eval --capture good --truth piped
rm piped/vertices.pc2 && mkfifo piped/joints.json
expect 2 'piped/joints.json pipe' eval --capture good --truth piped
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
expect 2 'seq/camera.json floor' export --capture good --out up.glb --floor seq/camera.json
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
  >out.txt 2>err.txt || [[ $(grep -cE ' [0-9.]+ +[0-9.]+ +[0-9.]+ +[-+][0-9.]+ %' out.txt) -ne 29 ]] ||
  ! grep -q '"height_mm": 1700' table/full/report.json || ! grep -q '"smooth": true' table/full/report.json ||
  [[ ! -s table/ablation.json ]] || ! grep -q '</html>' table.html || grep -qE 'https?:|<script' table.html; then
  echo "FAILED: eval --ablate"
  sed 's/^/  | /' err.txt out.txt | head -20
  failures=$((failures + 1))
fi

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
ended
