#!/usr/bin/env bash
# Builds the runtime, its samples and its tests for 64-bit Windows with Debian's mingw-w64 and runs them under wine, beside
# the native ones: build/windows/bin/fascia.dll. Exit 77 when the compiler or wine is not there.
#   scripts/windows.sh
# Needs a built tree (scripts/test.sh). The tool is left out: what it stands on (Draco, meshoptimizer, Embree, TBB, GLFW)
# Debian does not build for mingw-w64.
set -euo pipefail
cd "$(dirname "$0")/.."
for program in x86_64-w64-mingw32-g++-posix wine; do
  command -v "$program" >/dev/null || { echo "windows: left out, $program is not installed: scripts/setup.sh --full"; exit 77; }
done
rig=build/tests/samples/tiny.glb curves=build/tests/samples/smile.csv out=build/windows/out
[ -f "$rig" ] || build/bin/make_sample_files build/tests/samples
# A home of its own for wine, without a display and without the parts that ask to be downloaded.
export WINEPREFIX=$PWD/build/windows/wine WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml=' DISPLAY=
mkdir -p "$WINEPREFIX" "$out"

cmake --preset windows >/dev/null
cmake --build build/windows
needed=$(x86_64-w64-mingw32-objdump -p build/windows/bin/fascia.dll | sed -n 's/.*DLL Name: //p' | sort | tr '\n' ' ')
[ "$needed" = 'KERNEL32.dll msvcrt.dll ' ] || { echo "windows: fascia.dll needs $needed" >&2; exit 1; }
exported=$(x86_64-w64-mingw32-objdump -p build/windows/bin/fascia.dll | sed -n 's/^\t\[ *[0-9]*\] \([A-Za-z_].*\)/\1/p' | sort)
declared=$(nm -D --defined-only build/lib/libfascia.so | awk '$2 == "T" {sub(/@.*/, "", $3); print $3}' | sort)
[ "$exported" = "$declared" ] || { echo "windows: other functions than the native library's" >&2
                                   diff <(echo "$declared") <(echo "$exported") >&2; exit 1; }

tests=0
for program in test_geometry test_drivers; do
  wine "build/windows/bin/$program.exe" --gtest_brief=1 >"$out/$program.log" 2>&1 </dev/null ||
    { grep -a -B6 'FAILED' "$out/$program.log" | head -40; echo "windows: $program failed" >&2; exit 1; }
  tests=$((tests + $(sed -n 's/.*PASSED.* \([0-9]*\) tests.*/\1/p' "$out/$program.log")))
done
wine build/windows/bin/test_c99.exe </dev/null
wine build/windows/bin/table_host.exe build/windows/bin/fascia.dll "$rig" </dev/null

# The same take on both systems, frame by frame: the farthest that a coordinate is apart.
for system in native windows; do rm -rf "$out/$system" && mkdir "$out/$system"; done
build/bin/sample_player "$rig" "$curves" --fps 30 -o "$out/native"
wine build/windows/bin/sample_player.exe "$rig" "$curves" --fps 30 -o "$out/windows" </dev/null
worst=0 frames=0
for frame in "$out"/native/*.obj; do
  worst=$(paste -d' ' "$frame" "$out/windows/${frame##*/}" | tr -d '\r' | awk -v worst="$worst" '
    $1 == "v" { if (NF != 8) exit 1
                for (i = 2; i <= 4; ++i) { d = $i - $(i + 4); if (d < 0) d = -d; if (d > worst) worst = d } }
    END { print worst }')
  frames=$((frames + 1))
done
awk -v worst="$worst" -v frames="$frames" 'BEGIN { exit !(frames > 0 && worst <= 1e-5) }' ||
  { echo "windows: $frames frames, up to $worst from the native ones" >&2; exit 1; }
echo "windows: $tests tests, table host and $frames frames under $(wine --version 2>/dev/null), $worst from native; no tool"
