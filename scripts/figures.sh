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

# README: the head at rest and smiling, the muscles that do it, half a face taken off.
draw "$work/1.png" --size 480x600 --camera 0,0,1.22
draw "$work/2.png" --size 480x600 --camera 0,0,1.22 "${smile[@]}"
draw "$work/3.png" --size 480x600 --camera 0,0,1.22 --layers skull,muscles,eyes,teeth --view three-quarter "${smile[@]}"
draw "$work/4.png" --size 480x600 --camera 0,0,1.22 --layers skin,skull,muscles,eyes,teeth --reveal left "${smile[@]}"
ffmpeg -y -loglevel error -i "$work/1.png" -i "$work/2.png" -i "$work/3.png" -i "$work/4.png" \
  -filter_complex hstack=inputs=4 -frames:v 1 "$folder/hero.png"

draw "$folder/smile.png" --size 600x720 --camera 0,0,1.22 --view front,three-quarter --beside-rest "${smile[@]}"
draw "$folder/strain.png" --size 720 --layers strain,eyes "${smile[@]}"
draw "$folder/smas.png" --size 900 --layers smas,skull --view three-quarter
"$fascia" face anatomy/data/skull.obj -o "$work/face.glb" --sheet "$folder/reconstruction.png" --quiet
# The window, where there is something like a display.
if command -v xvfb-run >/dev/null; then
  cat >"$work/window.txt" <<'STEPS'
size 1280 800
click "Try the embedded head"
wait idle
layers skin,muscles,skull
click Muscles
wait 2
click "Search muscles"
type "major superior left"
wait 2
click zygomaticus_major_superior_left
wait 2
click Contract
view three-quarter
wait idle
screenshot view.png
quit
STEPS
  (cd "$work" && xvfb-run -a -s "-screen 0 1600x1000x24" "$fascia" view --script window.txt --quiet)
  cp "$work/view.png" "$folder/view.png"
fi
tools/figures/draw_muscles.sh "$fascia" "$folder" >/dev/null
ls -l "$folder/hero.png" "$folder/smile.png" "$folder/strain.png" "$folder/smas.png"
