#!/usr/bin/env bash
# Draws the pictures of README.md and docs/ anew: scripts/figures.sh [FASCIA] (default build/bin/fascia).
set -euo pipefail
cd "$(dirname "$0")/.."
fascia=$(realpath "${1:-build/bin/fascia}")
folder=docs/figures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rig=out/rig.glb
if [ ! -e "$rig" ]; then
  "$fascia" demo --out "$work/demo" --quiet
  rig=$work/demo/rig.glb
fi

draw() {  # file, render's options
  "$fascia" render "$rig" --quiet -o "$1" "${@:2}"
}
smile=(--set arkit:mouthSmileLeft=0.9 --set arkit:mouthSmileRight=0.9 --set arkit:cheekSquintLeft=0.5 --set arkit:cheekSquintRight=0.5)

# README: the head, its muscles with those of a left smile pulling, skin as glass, the head again.
draw "$work/1.png" --size 480x600
draw "$work/2.png" --size 480x600 --layers skull,muscles,eyes,teeth --view three-quarter --set arkit:mouthSmileLeft=1
draw "$work/3.png" --size 480x600 --layers skin,skull,muscles,eyes
draw "$work/4.png" --size 480x600 --view three-quarter --camera -12,0
ffmpeg -y -loglevel error -i "$work/1.png" -i "$work/2.png" -i "$work/3.png" -i "$work/4.png" \
  -filter_complex hstack=inputs=4 -frames:v 1 "$folder/hero.png"

draw "$folder/smile.png" --size 600x720 --view front,three-quarter --beside-rest "${smile[@]}"
draw "$folder/strain.png" --size 720 --layers strain,eyes "${smile[@]}"
draw "$folder/smas.png" --size 900 --layers smas,skull --view three-quarter
tools/figures/draw_muscles.sh "$fascia" "$folder" >/dev/null
ls -l "$folder/hero.png" "$folder/smile.png" "$folder/strain.png" "$folder/smas.png"
