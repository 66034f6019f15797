#!/usr/bin/env bash
# A room includes only rooms below it (docs/architecture.md); the network side and the solver side never meet; each big
# foreign library stays in its rooms; public headers, `livecap capture` and the C interface know no room at all.
set -euo pipefail
cd "$1"
bad=$(mktemp)
trap 'rm -f "$bad"' EXIT

# Bottom to top, as in CMakeLists.txt.
find src include tools tests -name '*.h' -o -name '*.cpp' | sort | xargs grep -HnE '^[[:space:]]*#[[:space:]]*include' |
  awk -v rooms='base ocl geometry actor image meshing raster picture match nn detect solve pose surface cloth export synth eval report level render calibrate views scan texture fit acquire capture c_api' '
  BEGIN {
    n = split(rooms, list, " ")
    for (i = 1; i <= n; ++i) level[list[i]] = i
    network["nn"]; network["detect"]
    solver["solve"]; solver["pose"]; solver["surface"]; solver["cloth"]
    home["opencv2"] = "image cloth synth report render calibrate views acquire"; home["OpenMesh"] = "actor meshing"; home["clblast.h"] = "nn"
    home["tiny_gltf.h"] = "actor meshing export"; home["CLI"] = ""
  }
  function offence(why) { print file ":" line ": " what " " why }
  {
    split($0, part, ":"); file = part[1]; line = part[2]
    what = $0; sub(/^[^:]*:[^:]*:[^"<]*/, "", what); sub(/[">][^">]*$/, "", what)
    quoted = what ~ /^"/; what = substr(what, 2)
    split(what, target, "/"); to = target[1]
    split(file, source, "/"); from = source[1] == "src" ? source[2] : source[1]

    if (source[1] == "src" && !(from in level)) offence("is in a room the list does not know")
    if (source[1] == "src" && quoted) {
      if (to in level) {
        if (level[to] > level[from]) offence("is a room above " from)
        if ((from in network && to in solver) || (from in solver && to in network)) offence("meets the other context")
      } else if (index(what, "/") && to !~ /^(livecap|shared|terms)$/) {
        offence("is no room")
      }
    }
    if (source[1] == "include" && quoted && to != "livecap") offence("is private, this header is public")
    if (file == "tools/livecap/cmd_capture.cpp" && quoted && index(what, "/") && to != "livecap") {
      offence("is private; livecap capture is a client of include/livecap only")
    }
    if (from == "c_api" && source[1] == "src" && quoted && to != "livecap") {
      offence("is private; the C interface is a client of include/livecap only")
    }
    if (source[1] == "src" && !quoted && to in home && index(" " home[to] " ", " " from " ") == 0) {
      offence("is not for room " from)
    }
  }' >"$bad"

cat "$bad"
[[ ! -s $bad ]]
