#!/usr/bin/env bash
# The runtime and samples for Windows by Debian's mingw-w64, run under wine on a rig: the same vertices as here.
#   scripts/windows.sh [RIG.glb]      the rig of the tests, build/tests/samples/tiny.glb, when left out
# Needs a built tree (scripts/test.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
rig=$(realpath "${1:-build/tests/samples/tiny.glb}")
wine=$(command -v wine64 || command -v wine || true)
for program in x86_64-w64-mingw32-g++-posix "${wine:-wine}"; do
  command -v "$program" >/dev/null || { echo "windows: left out, $program is not installed"; exit 0; }
done
build=build/windows
cmake -S . -B "$build" -G Ninja --toolchain cmake/mingw-w64.cmake -DCMAKE_BUILD_TYPE=Release -DFASCIA_BATCHES=ON \
  -DFASCIA_BUILD_BUILDER=OFF -DFASCIA_BUILD_TESTS=OFF >/dev/null
cmake --build "$build" --target fascia_runtime sample_hello sample_c_host
export WINEDEBUG=-all WINEPREFIX=${WINEPREFIX:-$PWD/$build/wine}
cp "$build"/bin/*.dll "$build"/lib/*.dll "$build" 2>/dev/null || true
cp "$build"/bin/sample_*.exe "$build"
cp "$rig" "$build/rig.glb"
cd "$build"
"$wine" ./sample_c_host.exe rig.glb
"$wine" ./sample_hello.exe rig.glb | tr -d '\r' >there.obj
../bin/sample_hello rig.glb >here.obj
paste -d' ' <(grep '^v ' here.obj) <(grep '^v ' there.obj) | awk '
  function far(a, b) { return a > b ? a - b : b - a }
  NF != 8 { exit 1 }
  { for (k = 2; k <= 4; ++k) if (far($k, $(k + 4)) > 1e-3) exit 1 }  # of the rig\047s units
  END { if (NR == 0) exit 1; print "windows: " NR " vertices as here" }'
