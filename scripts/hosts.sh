#!/usr/bin/env bash
# Builds the bindings and runs them in the hosts that this machine has; says what it leaves out.
#   scripts/hosts.sh [RIG.glb]      the rig of the tests, build/tests/samples/tiny.glb, when left out
# Needs a built tree (scripts/test.sh). Pictures go to build/hosts.
set -euo pipefail
cd "$(dirname "$0")/.."
rig=$(realpath "${1:-build/tests/samples/tiny.glb}")
out=build/hosts
mkdir -p "$out"
export LD_LIBRARY_PATH=$PWD/build/lib
# A whole face and a stream of its landmarks, for the way from landmarks to muscles.
head=build/tests/samples/embedded.glb stream=samples/capture/stream.csv
[ -f "$head" ] || build/bin/make_capture build/bin/fascia build/tests/samples
failed=()

part() {  # name, programs it needs..., -- command...
  local name=$1 needed
  shift
  while [ "$1" != -- ]; do
    needed=$1
    shift
    command -v "$needed" >/dev/null || { echo "$name: left out, $needed is not installed"; return 0; }
  done
  shift
  if "$@" >"$out/$name.log" 2>&1; then tail -n1 "$out/$name.log"; else
    failed+=("$name")
    echo "$name: FAILED, see $out/$name.log"
    tail -n5 "$out/$name.log"
  fi
}

python() {
  cmake -S . -B build -DFASCIA_BUILD_PYTHON=ON -DPython3_EXECUTABLE=/usr/bin/python3
  cmake --build build --target fascia_python python_wheel
  PYTHONPATH=build/python FASCIA=$PWD/build/bin/fascia /usr/bin/python3 tests/bindings/python_test.py "$rig" "$head" "$stream"
  # The wheel alone, elsewhere.
  rm -rf "$out/wheel" && mkdir "$out/wheel" && (cd "$out/wheel" && unzip -q ../../wheel/*.whl)
  env -u LD_LIBRARY_PATH PYTHONPATH="$out/wheel" /usr/bin/python3 tests/bindings/python_test.py "$rig" "$head" "$stream"
}
csharp() {
  mcs -unsafe -warnaserror -out:"$out/test.exe" bindings/csharp/Fascia.cs tests/bindings/CsharpTest.cs
  mono "$out/test.exe" "$rig" "$head" "$stream"
}
web() {
  scripts/web.sh
  /usr/bin/python3 tests/bindings/native_poses.py "$rig" >"$out/poses.json"
  node tests/bindings/web_test.mjs build/web/npm "$rig" "$out/poses.json"
}
web_page() {
  (cd samples/web && npm install --no-audit --no-fund --silent)
  node --experimental-websocket tests/bindings/page_test.mjs "$rig" "$out/page.png"
}
blender_addon() {
  FASCIA_LIBRARY=$PWD/build/lib/libfascia.so blender -b --factory-startup --python hosts/blender/test.py -- "$rig" \
    "$PWD/$out/blender.png"
}

godot3() {
  hosts/godot3/headers.sh "$out/godot3"
  hosts/godot3/build.sh "$PWD/$out/godot3/include" "$PWD/runtime/include" "$PWD/build/lib"
  HOME=$(mktemp -d) FASCIA_RIG="$rig" godot3-server --path hosts/godot3/project -s test.gd
}
unreal_syntax() {  # against stand-ins of the engine's types
  g++ -std=c++20 -fsyntax-only -Wall -Ihosts/unreal/stand_ins -Ihosts/unreal/Fascia/Source/Fascia/Public -Iruntime/include \
    hosts/unreal/Fascia/Source/Fascia/Private/FasciaFaceComponent.cpp
  echo "unreal: the syntax is right; the engine is not here"
}

part python /usr/bin/python3 unzip -- python
part csharp mcs mono -- csharp
part web emcc node -- web
part web_page emcc node npm chromium -- web_page
part godot3 godot3-server cc -- godot3
part unreal g++ -- unreal_syntax
part blender blender -- blender_addon
[ ${#failed[@]} -eq 0 ] || { echo "hosts: failed: ${failed[*]}" >&2; exit 1; }
