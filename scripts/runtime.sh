#!/usr/bin/env bash
# The runtime alone: configured without the builder, built, installed, and run: the samples on a rig that was released.
#   scripts/runtime.sh [BUILD_FOLDER [CMAKE_OPTION...]]      build/runtime_alone when left out; on Linux, macOS and Windows (Git's bash)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/runtime_alone}
[ $# -eq 0 ] || shift
rig=tests/data/released/rig-1.0.glb

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DFASCIA_BUILD_BUILDER=OFF -DFASCIA_BUILD_TESTS=ON -DFASCIA_BUILD_SAMPLES=ON "$@"
cmake --build "$build" --config Release --parallel "$(getconf _NPROCESSORS_ONLN || echo 2)"  # a bare --parallel starts all of them at once
rm -rf "$build/installed"
cmake --install "$build" --config Release --prefix "$build/installed"

found() {  # file names of which one is there; prints where
  local name
  for name in "$@"; do
    find "$build" -name "$name" -not -path '*/CMakeFiles/*' \( -type f -o -type l \) | head -n1 | grep . && return 0
  done
  echo "runtime: none of $* was built" >&2
  return 1
}
program() { found "$1" "$1.exe"; }
(cd "$build/installed" && test -f include/fascia/fascia.h && find . -name fasciaConfig.cmake | grep -q .)
library=$(found libfascia.so libfascia.dylib fascia.dll)

"$(program test_c99)"
"$(program table_host)" "$library" "$rig"
"$(program sample_c_host)" "$rig"
"$(program sample_hello)" "$rig" >"$build/smile.obj"
[ "$(grep -c '^v ' "$build/smile.obj")" -eq 289 ] || { echo "runtime: hello wrote another mesh" >&2; exit 1; }
printf 'time,arkit:mouthSmileLeft\n0,0\n1,1\n' >"$build/smile.csv"
"$(program sample_player)" "$rig" "$build/smile.csv" --fps 30 | tee "$build/player.log"
grep -q '31 frames' "$build/player.log"
for test in test_geometry test_drivers; do "$(program $test)" --gtest_brief=1; done
echo "runtime: built, installed and run on $(uname -s)"
