#!/usr/bin/env bash
# Makes the Debian packages in build/packages, has lintian look at them, and uses what they hold as a stranger would
# (tests/install), unpacked into a folder. Needs a built tree (scripts/test.sh) for the rigs of that test.
#   scripts/packages.sh [BUILD_FOLDER]     build/packaging when left out
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath -m "${1:-build/packaging}") out=$PWD/build/packages
command -v lintian >/dev/null || { echo "packages: lintian is missing: run scripts/setup.sh --full" >&2; exit 1; }
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DFASCIA_BATCHES=ON -DCMAKE_INSTALL_PREFIX=/usr \
  -DCMAKE_INSTALL_LIBDIR="lib/$(gcc -print-multiarch)" -DCMAKE_SKIP_INSTALL_ALL_DEPENDENCY=ON >/dev/null
cmake --build "$build" --target fascia fascia_manual fascia_runtime_static fascia_bullet_module fascia_snapshot_api
rm -rf "$out"
cpack --config "$build/CPackConfig.cmake" -B "$out"
rm -rf "$out/_CPack_Packages"
ls -l "$out"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
for package in "$out"/*.deb; do dpkg-deb -x "$package" "$root"; done
samples=build/tests/samples
[ -f $samples/tiny.glb ] || build/bin/make_sample_files $samples
[ -f $samples/embedded.glb ] || build/bin/make_capture build/bin/fascia $samples
LD_LIBRARY_PATH='' sh tests/install/install_test.sh "$root" tests/install "$PWD/$samples/tiny.glb" "$PWD/$samples/embedded.glb"
lintian --tag-display-limit 0 --fail-on error,warning "$out"/*.deb
