#!/usr/bin/env bash
# Makes the Debian packages in build/packages and has lintian look at them.
#   scripts/packages.sh [BUILD_FOLDER]     build/packaging when left out
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath -m "${1:-build/packaging}") out=$PWD/build/packages
command -v lintian >/dev/null || { echo "packages: lintian is missing: run scripts/setup.sh --full" >&2; exit 1; }
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
  -DCMAKE_INSTALL_LIBDIR="lib/$(gcc -print-multiarch)" -DCMAKE_SKIP_INSTALL_ALL_DEPENDENCY=ON >/dev/null
cmake --build "$build" --target fascia fascia_manual fascia_runtime_static fascia_bullet_module fascia_snapshot_api
rm -rf "$out"
cpack --config "$build/CPackConfig.cmake" -B "$out"
rm -rf "$out/_CPack_Packages"
ls -l "$out"
lintian --tag-display-limit 0 --fail-on error,warning "$out"/*.deb
