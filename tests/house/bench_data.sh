#!/bin/sh
# scripts/bench_expressions.sh says which of its data are missing (77) or are not what they were (1): bench_data.sh SOURCE_FOLDER
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
check() { FASCIA_MEASURED=$folder bash "$1/scripts/bench_expressions.sh" --check 2>&1; }
said=$(check "$1"); code=$?
[ $code -eq 77 ] || { echo "without data: $code, $said"; exit 1; }
mkdir -p "$folder/data/ict"
echo other >"$folder/data/ict/neutral.glb"
said=$(check "$1"); code=$?
[ $code -eq 1 ] || { echo "other data: $code, $said"; exit 1; }
case $said in *"other contents"*ict/neutral.glb*) ;; *) echo "$said"; exit 1 ;; esac
