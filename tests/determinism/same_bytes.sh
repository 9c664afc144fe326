#!/usr/bin/env bash
# Rig, pose, bake, play, snapshot and picture are the same bytes at any number of threads, from any folder, under any
# language, time zone, address space and size of environment.
#   same_bytes.sh FASCIA FOLDER_OF_THE_EMBEDDED_HEAD FOLDER_OF_THE_SMALL_RIG
set -euo pipefail
tool=$1 heads=$2 samples=$3
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cp "$heads"/embedded_head.obj "$heads"/embedded_head_landmarks.json "$samples"/tiny.glb "$samples"/smile.csv "$place"

make_all() {  # folder, then the words every command gets
  local out=$1; shift
  mkdir -p "$out"
  "$tool" build embedded_head.obj --landmarks embedded_head_landmarks.json --detail low --quiet -o "$out/rig.glb" "$@"
  "$tool" pose tiny.glb --set zygomaticus_major_left=0.8 --quiet -o "$out/pose.glb" "$@"
  "$tool" bake tiny.glb --shapes arkit --quiet -o "$out/bake.glb" "$@"
  "$tool" play tiny.glb --curves smile.csv --quiet -o "$out/play.glb" "$@"
  "$tool" snapshot record tiny.glb --curves smile.csv --quiet -o "$out/snapshot.json" "$@"
  "$tool" render tiny.glb --set jaw_open=0.5 --size 120 --quiet -o "$out/picture.png" "$@"
}

cd "$place"
make_all one --threads 1
make_all two --threads 2
(export LC_ALL=de_DE.UTF-8 LANG=tr_TR.UTF-8 TZ=Asia/Kathmandu JUNK=$(head -c 20000 /dev/zero | tr '\0' x)
 setarch --addr-no-randomize bash -c "$(declare -f make_all); tool=$tool; make_all three") ||
 { [ "$?" = 1 ] && echo "the third way failed"; exit 1; }
mkdir -p "$place/deep/er" && cp ./*.obj ./*.json ./*.glb ./*.csv deep/er/ && (cd deep/er && make_all four --threads 3)
mv deep/er/four four  # made beside its inputs as the others were: a snapshot names its takes from its own folder

status=0
for other in two three four; do
  for file in rig.glb pose.glb bake.glb play.glb snapshot.json picture.png; do
    cmp "one/$file" "$other/$file" || status=1
  done
done
exit $status
