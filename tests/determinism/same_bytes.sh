#!/usr/bin/env bash
# Rig, pose, bake, play, snapshot and picture are the same bytes at any number of threads, in any order, from any folder,
# under any language, time zone, address space and size of environment.
#   same_bytes.sh FASCIA FOLDER_OF_THE_EMBEDDED_HEAD FOLDER_OF_THE_SMALL_RIG
set -euo pipefail
tool=$(realpath "$1") heads=$(realpath "$2") samples=$(realpath "$3")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cp "$heads"/embedded_head.obj "$heads"/embedded_head_landmarks.json "$samples"/tiny.glb "$samples"/smile.csv "$place"

outputs="rig.glb pose.glb bake.glb play.glb snapshot.json picture.png"

make() {  # folder, output, then the words every command gets
  local out=$1 name=$2; shift 2
  case "$name" in
    rig.glb) set -- build embedded_head.obj --landmarks embedded_head_landmarks.json --detail low "$@" ;;
    pose.glb) set -- pose tiny.glb --set zygomaticus_major_left=0.8 "$@" ;;
    bake.glb) set -- bake tiny.glb --shapes arkit "$@" ;;
    play.glb) set -- play tiny.glb --curves smile.csv "$@" ;;
    snapshot.json) set -- snapshot record tiny.glb --curves smile.csv "$@" ;;
    picture.png) set -- render tiny.glb --set jaw_open=0.5 --size 120 "$@" ;;
  esac
  "$tool" "$@" --quiet -o "$out/$name"
}

make_all() {  # folder, then the words every command gets
  local out=$1 name; shift
  mkdir -p "$out"
  for name in $outputs; do make "$out" "$name" "$@"; done
}

reversed() {
  local name all=
  for name in $outputs; do all="$name $all"; done
  echo "$all"
}

# A language with a decimal comma that the machine may not have.
mkdir "$place/locales"
if ! localedef -i de_DE -f UTF-8 "$place/locales/de_DE.UTF-8" >/dev/null 2>&1; then
  locale -a | grep -qi 'de_DE.utf-\?8' || { echo "de_DE.UTF-8 cannot be made: install Debian's package locales"; exit 1; }
fi

cd "$place"
make_all one --threads 1
make_all two --threads 2
# Another language, time zone, size of environment and order of commands, addresses that are not random.
(LOCPATH=$place/locales
 [ -e "$LOCPATH/de_DE.UTF-8" ] || unset LOCPATH
 export ${LOCPATH:+LOCPATH} LC_ALL=de_DE.UTF-8 LANG=tr_TR.UTF-8 TZ=Asia/Kathmandu JUNK=$(head -c 20000 /dev/zero | tr "\0" x)
 [ "$(locale decimal_point)" = , ] || { echo "de_DE.UTF-8 is not in force"; exit 1; }
 setarch --addr-no-randomize bash -c \
   "set -e; $(declare -f make make_all); tool=$tool; outputs='$(reversed)'; make_all three") ||
 { echo "the third way failed"; exit 1; }
mkdir -p deep/er && cp ./*.obj ./*.json ./*.glb ./*.csv deep/er/ && (cd deep/er && make_all four --threads 3)
mv deep/er/four four  # made beside its inputs as the others were: a snapshot names its takes from its own folder

status=0
for other in two three four; do
  for file in $outputs; do
    cmp "one/$file" "$other/$file" || status=1
  done
done
exit $status
