#!/bin/sh
# Compares the interface with the one released: structures may grow at their end and functions be added; nothing else.
#   abi.sh LIBRARY SNAPSHOT            the test
#   abi.sh --renew LIBRARY SNAPSHOT    writes the snapshot anew: with a release only
set -eu
if [ "$1" = --renew ]; then
  abidw --no-corpus-path --no-comp-dir-path --no-show-locs --out-file "$3" "$2"
  exit
fi
status=0
report=$(abidiff --no-show-locs "$2" "$1") || status=$?
echo "$report"
[ $((status & 3)) -eq 0 ] || { echo "abidiff could not compare" >&2; exit 1; }
# A host's structure may grow, an enumeration and the table too; what was there keeps its place, type and value.
if echo "$report" |
    grep -E "offset changed|entity changed|name changed|was (added|removed)|deletion|from value|Removed function"; then
  echo "the interface has changed in a way that breaks hosts" >&2
  exit 1
fi
