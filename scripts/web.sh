#!/usr/bin/env bash
# Builds the npm package @fascia/runtime with Debian's emscripten: build/web/npm.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v emcmake >/dev/null || { echo "web: emscripten is missing: run scripts/setup.sh --full" >&2; exit 1; }
export NODE_PATH=/usr/share/nodejs  # Debian's emscripten looks for acorn there
emcmake cmake --preset web >/dev/null
cmake --build build/web
ls -l build/web/npm
