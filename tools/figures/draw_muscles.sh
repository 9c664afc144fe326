#!/bin/sh
# Redraws the figures of docs/muscles.md: draw_muscles.sh FASCIA FOLDER, such as build/bin/fascia docs/figures.
set -eu
fascia=$1 folder=$2
rigs=$(mktemp -d)
trap 'rm -rf "$rigs"' EXIT
cp "$(dirname "$0")/../../anatomy/data/head.obj" "$rigs/head.obj"
"$fascia" build "$rigs/head.obj" --detail low --fibre-spacing 1.2 --quiet -o "$rigs/rig.glb"
draw() {
  "$fascia" render "$rigs/rig.glb" --view sheet --size 640 --muscles "$2" --quiet -o "$folder/muscles_$1.png"
  echo "$folder/muscles_$1.png"
}
draw brow_eye frontalis,procerus,corrugator_supercilii,depressor_supercilii,orbicularis_oculi,levator_palpebrae_superioris
draw upper_lip levator_labii_superioris_alaeque_nasi,levator_labii_superioris,zygomaticus_minor,levator_anguli_oris,nasalis,depressor_septi_nasi
draw mouth zygomaticus_major,orbicularis_oris,incisivus_labii_superioris,incisivus_labii_inferioris,compressor_labii
draw lower_lip depressor_anguli_oris,depressor_labii_inferioris,mentalis
draw cheek risorius,buccinator,masseter,temporalis
draw neck_deep platysma,medial_pterygoid,lateral_pterygoid,digastric,mylohyoid,geniohyoid
