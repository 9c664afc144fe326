#!/usr/bin/env bash
# What is written, as others read it: the Khronos glTF validator finds no error and no warning in rigs and in what is
# made from them, and three.js draws the vertices where our own PLY has them. Node.js, and npm's registry for both: ends
# with 77 where one is not at hand.
#   tests/validator/validate.sh PATH_OF_FASCIA [HEAD.glb|.gltf|.obj|...]...
# Without heads: the embedded one, and the cases beside the checkout (FASCIA_CASES) when they are there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
command -v npm >/dev/null || { echo "skipped: Node.js with npm is not installed" >&2; exit 77; }
fascia=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/validate.mjs" "$here/package.json" "$work/"
mkdir "$work/three"
cp "$here"/../three/*.mjs "$here/../three/package.json" "$work/three/"
for folder in "$work" "$work/three"; do
  (cd "$folder" && npm install --silent --no-audit --no-fund --prefer-offline) || { echo "skipped: npm's registry is not reached" >&2; exit 77; }
done

check_head() {  # head file, local|world: everything that can be made from it; 1 at the first thing that is wrong
  local head=$1 space=$2 out="$work/out"
  rm -rf "$out" && mkdir "$out"
  if ! "$fascia" build "$head" --detail low -o "$out/rig.glb" --quiet 2>"$out/why"; then
    echo "$head: not built: $(head -c 200 "$out/why")"
    return 1
  fi
  printf 'time,jaw_open\n0,0\n0.1,0.6\n' >"$out/curves.csv"
  { "$fascia" play "$out/rig.glb" --curves "$out/curves.csv" --fps 30 -o "$out/play.glb" --quiet &&
    "$fascia" bake "$out/rig.glb" --shapes arkit -o "$out/arkit.glb" --quiet &&
    "$fascia" bake "$out/rig.glb" --shapes arkit,visemes --correctives --keep-rig -o "$out/both.glb" --quiet &&
    "$fascia" bake "$out/both.glb" --shapes arkit --replace -o "$out/again.glb" --quiet &&
    "$fascia" pose "$out/rig.glb" --set arkit:jawOpen=1 -o "$out/pose.glb" --quiet &&
    "$fascia" pose "$out/rig.glb" --set arkit:jawOpen=1 -o "$out/pose.ply" --quiet &&
    "$fascia" export "$out/rig.glb" --part all -o "$out/all.glb" --quiet; } || return 1
  local of=()
  case "$head" in *.glb | *.vrm) of=(--of "$(realpath "$head")") ;; esac
  (cd "$work" && node validate.mjs "${of[@]}" out/rig.glb out/play.glb out/arkit.glb out/both.glb out/again.glb out/pose.glb out/all.glb) || return 1
  (cd "$work/three" && node load.mjs ../out/pose.glb - ../out/pose.ply "$space" &&
    node load.mjs ../out/arkit.glb jawOpen ../out/pose.ply "$space" &&
    node load.mjs ../out/play.glb && played_of "$head" "$out" && node load.mjs ../out/rig.glb && node load.mjs ../out/all.glb) || return 1
}

# A played file against the caches of the same take; an OBJ's cache has another order of vertices.
played_of() {
  case "$1" in *.glb) ;; *) return 0 ;; esac
  "$fascia" play "$2/rig.glb" --curves "$2/curves.csv" --fps 30 -o "$2/take.pc2" --quiet &&
    node played.mjs "$2/play.glb" 30 "$2"/take*.pc2
}

space_of() { case "$1" in *.glb | *.gltf | *.vrm) echo world ;; *) echo local ;; esac; }

failed=0
if [ $# -eq 0 ]; then
  "$fascia" demo --out "$work/demo" --quiet
  (cd "$work" && node validate.mjs demo/rig.glb demo/play.glb demo/arkit.glb)
  "$fascia" pose "$work/demo/rig.glb" -o "$work/demo/head.glb" --quiet  # the same as a glTF head
  set -- "$work/demo/head.obj" "$work/demo/head.glb"
  cases=${FASCIA_CASES:-$here/../../../shared/cases}
  [ -d "$cases" ] && while IFS= read -r head; do set -- "$@" "$head"; done < <(
    find "$cases" -path '*/faults/*' -prune -o \( -name '*.glb' -o -name '*.gltf' -o -name '*.obj' -o -name '*.ply' \) -print | sort)
fi
for head in "$@"; do
  echo "== $head"
  check_head "$head" "$(space_of "$head")" || failed=$((failed + 1))
done
echo "$failed of $# heads failed"
[ "$failed" -eq 0 ]
