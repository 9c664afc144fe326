#!/usr/bin/env bash
# Writes the reference of every header to build/reference/html, by Doxygen; what has no comment stands there by its name. Fails
# where a comment is wrong: an unknown command, a parameter that is not there.
#   scripts/docs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
command -v doxygen >/dev/null || scripts/setup.sh --full
mkdir -p build/reference
doxygen docs/Doxyfile >build/reference/doxygen.log 2>&1 || { tail -20 build/reference/doxygen.log >&2; exit 1; }
faults=$(grep -E 'unknown command|argument .* not found|documented symbol .* was not' build/reference/warnings.txt | sort -u || true)
if [ -n "$faults" ]; then
  printf '%s\n' "$faults" >&2
  exit 1
fi
echo "docs: open build/reference/html/index.html"
