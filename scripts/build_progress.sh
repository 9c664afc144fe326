#!/usr/bin/env bash
# Reads what ninja says with NINJA_STATUS='@%f %t %e@ ' and shows it on one line: percent done and time left. Messages of
# the compiler pass through.
set -euo pipefail
while IFS= read -r line; do
  if [[ $line =~ ^@([0-9]+)\ ([0-9]+)\ ([0-9]+)[0-9.]*@ ]]; then
    done=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]} seconds=${BASH_REMATCH[3]}
    left=$((seconds * (all - done) / done))
    if [ "$left" -lt 100 ]; then left="$left s"; else left="$(((left + 59) / 60)) min"; fi
    printf '\r  demo: build  %d %%, %s left\033[K' $((100 * done / all)) "$left"
  else
    printf '\r\033[K%s\n' "$line"
  fi
done
printf '\r\033[K'
