#!/usr/bin/env bash
# Fails when an object of the given archive that is compiled for a wide vector unit defines a weak symbol.
set -euo pipefail
nm "$1" | awk '
  /^[^ ]*_avx[0-9]*[.].*:$/ { wide = 1; seen++ ; next }
  /^[^ ]*\.o:$/   { wide = 0 }
  wide && NF > 1 && $(NF-1) ~ /^[WVuwv]$/ { print "shared: " $0; bad = 1 }
  END { if (!seen) print "no wide objects"; exit bad }'
