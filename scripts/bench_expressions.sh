#!/usr/bin/env bash
# How much of known expressions the simulated ones explain (docs/expressions.md), as a table: build/expressions.csv.
#   scripts/bench_expressions.sh [--check] [OPTION of bench_expressions...]      --check: only look at the data
# The data are other people's and not part of this project. They are looked for in FASCIA_MEASURED, else in ../shared, as
# data/ict and data/wild; exit 77 when none are there; one that was converted anew, with other bytes, is said and measured
# (--check: exit 1).
set -euo pipefail
cd "$(dirname "$0")/.."
measured=$(realpath -m "${FASCIA_MEASURED:-../shared}")/data

# What is read, by folder, file and SHA-256.
#
# ict: ICT-FaceKit, https://github.com/ICT-VGL/ICT-FaceKit at da5f95a6, MIT (c) 2020 USC Institute for Creative Technologies.
#   neutral.glb is the mean head of FaceXModel, each of its parts a mesh, in metres, y up. expressions.glb has the mesh
#   `head` of it with its expressions as morph targets under ARKit's names (mouthClose against an open jaw, no tongueOut).
#   person_0 .. 5 are samples of the identity modes with unit normal weights, of the same topology.
# wild: avatars with ARKit shapes of their own, as they lie in public repositories; the licences are their owners'.
#   rpm_avatar.glb      https://github.com/asanchezyali/talking-avatar-with-ai
#   brunette_t.glb      https://github.com/met4citizen/TalkingHead
#   asian_business.glb  https://github.com/hillday/arkit-blendshapes-generator
#   facecap_plain.glb   https://github.com/mrdoob/three.js, examples/models/gltf/facecap.glb, its meshopt compression undone,
#                       the morph targets' names kept
files() {
  cat <<'END'
47e8378f51f38521a9bba61421ba9af2cd7533f4d5e0e7c5b3973ee1eb27b765  ict/neutral.glb
bba75d5efe8ac9c4f705dcad54c453c5509d5e1563b502b2ca606997c7390722  ict/expressions.glb
86c450c8bb668d5f02aac1b28e166b106f7eda3ad5ae5fc80213c215f3b02856  ict/person_0.glb
7712adb7cd985bb477e942931ceea96ff69b71cfffaca85fc5e08d49df623361  ict/person_1.glb
05dfa7b2141f07232780ba9e5e223f8117a6d4674383b7d3e478f3716e349ea6  ict/person_2.glb
2881f21988ca2e4c163b93f4fb5131dd0c8385226d9585d38c7b4ca94c24cd4f  ict/person_3.glb
c3e8331480d62709bedbe5fb03bf82deefb756f1574c2ff8acc8753e4b4b3f27  ict/person_4.glb
246dccc32be0bd3be70f6da33474d1f9f60b89ad5cf159c526911866f7a15761  ict/person_5.glb
5420e200bf596ef85e72912640a90d7f80bd0845cc0c8eeca85931aebb5b7a29  wild/rpm_avatar.glb
3ca13a1e3ad8f57e50266294b823641680dd3f3f174eb4be908ddca7afc0c82a  wild/brunette_t.glb
bd08e4b5381a973ddc2439fe72114387b01650cad0baccb06877cdae25fb771e  wild/asian_business.glb
6bd76a8819b0e38c17f85e435580c584e8731e5e8d728c770e92186ba729889a  wild/facecap_plain.glb
END
}

there=0 changed=()
while read -r sum file; do
  if [ ! -f "$measured/$file" ]; then
    echo "bench_expressions: left out, $file is not there" >&2
    continue
  fi
  there=$((there + 1))
  [ "$(sha256sum <"$measured/$file" | cut -d' ' -f1)" = "$sum" ] || changed+=("$file")
done < <(files)
[ $there -gt 0 ] || { echo "bench_expressions: left out, no data in FASCIA_MEASURED (scripts/bench_expressions.sh says which)"; exit 77; }
if [ ${#changed[@]} -eq 0 ]; then
  echo "bench_expressions: $there files are what they were"
else
  echo "bench_expressions: other contents than docs/expressions.md was measured on, so other figures: ${changed[*]}" >&2
fi
[ "${1:-}" != --check ] || exit $((${#changed[@]} > 0))

cmake --preset release -DFASCIA_BUILD_BENCH=ON >/dev/null
cmake --build build --target bench_expressions fascia
FASCIA_MEASURED=${measured%/data} build/bin/bench_expressions --csv build/expressions.csv "$@"
echo "bench_expressions: $(($(wc -l <build/expressions.csv) - 1)) rows in build/expressions.csv"
