#!/usr/bin/env bash
# Compares the instructions that a frame takes, as callgrind counts them on the baseline's loops, with those kept in
# instruction_counts.txt: a slow-down is seen without a stopwatch. 3 % more or less fails; after an improvement,
# or with another compiler, write the printed counts into the file.
#   instruction_counts.sh PROGRAM COUNTS
set -euo pipefail
if ! command -v valgrind >/dev/null; then
  echo "SKIPPED: valgrind is not installed (scripts/setup.sh --test)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
count() {
  FASCIA_SIMD=baseline valgrind --tool=callgrind --callgrind-out-file="$folder/out" "$1" "$2" "$3" 2>&1 |
    sed -n 's/.*Collected : *\([0-9]*\).*/\1/p'
}
bad=0
while read -r what kept; do
  case "$what" in ''|'#'*) continue ;; esac
  few=$(count "$1" "$what" 2) many=$(count "$1" "$what" 12)
  now=$(( (many - few) / 10 ))
  echo "$what $now instructions a frame, $kept kept"
  if [ $((100 * now)) -gt $((103 * kept)) ] || [ $((100 * now)) -lt $((97 * kept)) ]; then bad=1; fi
done <"$2"
exit $bad
