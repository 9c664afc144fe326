#!/usr/bin/env bash
# Builds the bindings and runs them in the hosts that this machine has; says what it leaves out.
#   scripts/hosts.sh [RIG.glb [PART...]]      the rig of the tests, build/tests/samples/tiny.glb, and every part when left out
# Needs a built tree (scripts/test.sh). Pictures go to build/hosts. A part may take five minutes, one that compiles
# twenty, times FASCIA_PATIENCE.
set -euo pipefail
cd "$(dirname "$0")/.."
rig=$(realpath "${1:-build/tests/samples/tiny.glb}")
wanted=("${@:2}")
out=build/hosts
mkdir -p "$out"
# A whole face and a stream of its landmarks, for the way from landmarks to muscles.
head=$PWD/build/tests/samples/embedded.glb stream=$PWD/samples/capture/stream.csv
export LD_LIBRARY_PATH=$PWD/build/lib FASCIA=$PWD/build/bin/fascia
[ -f "$head" ] || build/bin/make_capture build/bin/fascia build/tests/samples
failed=()

part() {  # [seconds] name, programs it needs..., -- command...
  local limit=300 name needed code=0
  case $1 in [0-9]*) limit=$1; shift ;; esac
  name=$1
  shift
  [ ${#wanted[@]} -eq 0 ] || [[ " ${wanted[*]} " = *" $name "* ]] || return 0
  while [ "$1" != -- ]; do
    needed=$1
    shift
    command -v "$needed" >/dev/null || { echo "$name: left out, $needed is not installed"; return 0; }
  done
  shift
  timeout -k 10 $((limit * ${FASCIA_PATIENCE:-1})) bash -euo pipefail -c '"$@"' part "$@" >"$out/$name.log" 2>&1 || code=$?
  case $code in
    0) tail -n1 "$out/$name.log" ;;
    77) echo "$name: left out, $(tail -n1 "$out/$name.log")" ;;
    *)
      failed+=("$name")
      [ $code -ne 124 ] || echo "the time is up" >>"$out/$name.log"
      echo "$name: FAILED ($code), see $out/$name.log"
      tail -n5 "$out/$name.log" ;;
  esac
}

run_python() {
  cmake -S . -B build -DFASCIA_BUILD_PYTHON=ON -DPython3_EXECUTABLE=/usr/bin/python3
  cmake --build build --target fascia_python python_wheel
  /usr/bin/python3 tests/bindings/stubs_test.py bindings/python/fascia/_runtime.pyi build/python
  PYTHONPATH=build/python /usr/bin/python3 tests/bindings/python_test.py "$rig" "$head" "$stream"
  # The wheel alone, elsewhere.
  rm -rf "$out/wheel" && mkdir "$out/wheel" && (cd "$out/wheel" && unzip -q ../../wheel/*.whl)
  env -u LD_LIBRARY_PATH PYTHONPATH="$out/wheel" /usr/bin/python3 tests/bindings/python_test.py "$rig" "$head" "$stream"
}
run_python_tool() {
  PYTHONPATH=build/python /usr/bin/python3 tests/bindings/python_tool_test.py build/bin "$out"
}
run_tutorial() {
  rm -rf "$out/tutorial"
  PYTHONPATH=build/python /usr/bin/python3 bindings/python/tutorial/tutorial.py "$head" "$out/tutorial"
  for figure in bindings/python/tutorial/*.png; do test -s "$out/tutorial/${figure##*/}"; done
  echo "tutorial: $(ls "$out/tutorial" | wc -l) figures"
}
run_csharp() {
  mcs -unsafe -warnaserror -out:"$out/test.exe" bindings/csharp/*.cs tests/bindings/CsharpTest.cs
  mono "$out/test.exe" "$rig" "$head" "$stream"
}
run_unity() {  # against stand-ins of the engine's types
  mcs -unsafe -warnaserror -target:library -out:"$out/unity.dll" hosts/unity/stand_ins/UnityEngine.cs bindings/csharp/*.cs \
    hosts/unity/Runtime/FaceBehaviour.cs
  echo "unity: the component compiles; the engine is not here"
}
run_web() {
  scripts/web.sh
  for each in "$rig" "$head"; do
    /usr/bin/python3 tests/bindings/native_poses.py "$each" >"$out/poses.json"
    node tests/bindings/web_test.mjs build/web/npm "$each" "$out/poses.json"
  done
}
run_web_types() {
  (cd bindings/web/types && npm install --no-audit --no-fund --silent && npx tsc --noEmit -p .)
  node tests/bindings/three_test.mjs bindings/web/types/node_modules
  echo "web types: TypeScript takes them, and three.js the attributes"
}
run_browser() { node tests/bindings/browser_test.mjs; }
run_web_page() {
  (cd samples/web && npm install --no-audit --no-fund --silent)
  "$FASCIA" play "$rig" --curves build/tests/samples/smile.csv --fps 30 -o "$out/played.glb" --quiet
  node tests/bindings/page_test.mjs "$head" "$rig" "$out/played.glb" "$out/page.png"
}
run_wgsl() {
  /usr/bin/python3 tests/bindings/skinning_data.py "$head" >"$out/skinning.json"
  node tests/bindings/wgsl_test.mjs runtime/shaders/skinning.wgsl "$out/skinning.json"
}
run_blender_addon() {
  FASCIA_LIBRARY=$PWD/build/lib/libfascia.so blender -b --factory-startup --python hosts/blender/test.py -- "$rig" \
    "$PWD/$out/blender.png"
  local verdict  # repeated as the last line, which Blender would have otherwise
  verdict=$(grep '^blender:' "$out/blender.log")
  if command -v xvfb-run >/dev/null; then  # the panel, which is drawn in a window only
    FASCIA_LIBRARY=$PWD/build/lib/libfascia.so xvfb-run -a blender --factory-startup --python tests/bindings/blender_panel.py -- "$rig"
    verdict+=", $(grep '^blender panel:' "$out/blender.log")"
  fi
  echo "$verdict"
}
run_godot3_headers() {
  hosts/godot3/headers.sh "$out/godot3"
  hosts/godot3/build.sh "$PWD/$out/godot3/include" "$PWD/runtime/include" "$PWD/build/lib"
}
run_godot3() {
  run_godot3_headers
  HOME=$(mktemp -d) FASCIA_RIG="$rig" FASCIA_HEAD=$(realpath "$head") godot3-server --path hosts/godot3/project -s test.gd
}
run_godot3_scene() {  # the scene in a window, on a display in memory
  run_godot3_headers
  rm -f "$out/godot3.png"
  HOME=$(mktemp -d) FASCIA_RIG=$(realpath "$head") FASCIA_PICTURE="$PWD/$out/godot3.png" xvfb-run -a -s '-screen 0 640x640x24' \
    godot3-runner --path hosts/godot3/project --video-driver GLES2 --audio-driver Dummy
  [ "$(wc -c <"$out/godot3.png")" -gt 20000 ] || { echo "the picture is empty"; exit 1; }
  echo "godot scene: the head smiles in $out/godot3.png"
}
run_godot4_syntax() {  # against stand-ins of godot-cpp's types
  g++ -std=c++20 -fsyntax-only -Wall -Wextra -Werror -Ihosts/godot4/stand_ins -Iruntime/include hosts/godot4/fascia_godot.cpp
  echo "godot 4: only the syntax was checked; godot-cpp and the engine are not here"
}
run_unreal_syntax() {  # against stand-ins of the engine's types
  g++ -std=c++20 -fsyntax-only -Wall -Ihosts/unreal/stand_ins -Ihosts/unreal/Fascia/Source/Fascia/Public -Iruntime/include \
    hosts/unreal/Fascia/Source/Fascia/Private/FasciaFaceComponent.cpp
  echo "unreal: the syntax is right; the engine is not here"
}
export rig head stream out
export -f $(compgen -A function run_)

part 1200 python /usr/bin/python3 unzip -- run_python
part 600 python_tool /usr/bin/python3 -- run_python_tool
part tutorial /usr/bin/python3 -- run_tutorial
part csharp mcs mono -- run_csharp
part unity mcs -- run_unity
part 1200 web emcc node -- run_web
part web_types npm node -- run_web_types
part browser node chromium -- run_browser
part web_page emcc node npm chromium -- run_web_page
part wgsl node chromium -- run_wgsl
part godot3 godot3-server cc -- run_godot3
part godot3_scene godot3-runner xvfb-run cc -- run_godot3_scene
part godot4 g++ -- run_godot4_syntax
part unreal g++ -- run_unreal_syntax
part blender blender -- run_blender_addon
[ ${#failed[@]} -eq 0 ] || { echo "hosts: failed: ${failed[*]}" >&2; exit 1; }
