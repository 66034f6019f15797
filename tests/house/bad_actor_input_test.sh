#!/usr/bin/env bash
# bad_actor_input_test.sh LIVECAP: what `livecap actor` and `livecap calibrate` do with bad usage and bad input.
livecap=$1
source "$(dirname "${BASH_SOURCE[0]}")/cases.sh"

"$livecap" -q synth --actor builtin:trousers --motion raise --frames 6 --empty-frames 2 --out seq >/dev/null || exit 1
head -c 4000 /dev/zero | tr '\0' 'x' >garbage
sed 's/"width": *540/"width": 640/' seq/camera.json >wide.json
sed 's/"fx": *[0-9.]*/"fx": -1/' seq/camera.json >negative.json
mkdir nothing

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
ended
