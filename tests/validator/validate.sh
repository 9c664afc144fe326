#!/usr/bin/env bash
# Runs the Khronos glTF validator over rigs and what is made from them; any error or warning fails.
#   tests/validator/validate.sh PATH_OF_FASCIA
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
fascia=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/validate.mjs" "$work/"
(cd "$work" && npm install --silent --no-audit --no-fund)
"$fascia" demo --out "$work/out" --quiet
(cd "$work" && node validate.mjs out/rig.glb out/play.glb out/arkit.glb)
