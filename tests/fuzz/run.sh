#!/usr/bin/env bash
# Runs every fuzzer for a while, from its corpus; a finding ends it with what to look at.
#   run.sh FOLDER_OF_THE_PROGRAMS SECONDS [NAME...]
set -euo pipefail
programs=$1 seconds=$2; shift 2
here=$(cd "$(dirname "$0")" && pwd)
[ $# -gt 0 ] || set -- mesh landmarks activations snapshot manifest rig curves calls edits build
status=0
for name in "$@"; do
  place=$(mktemp -d)
  mkdir -p "$here/corpus/$name"
  echo "fuzz_$name, $seconds seconds"
  if ! "$programs/fuzz_$name" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=3000 -malloc_limit_mb=2000 \
       -max_len=16384 -print_final_stats=1 -artifact_prefix="$PWD/finding-$name-" "$place" "$here/corpus/$name" \
       >"$place.log" 2>&1; then
    grep -m1 -A12 'ERROR\|runtime error\|terminate' "$place.log" || tail -20 "$place.log"
    status=1
  fi
  grep 'stat::number_of_executed_units\|cov:' "$place.log" | tail -2
  rm -rf "$place" "$place.log"
done
exit $status
