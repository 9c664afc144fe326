#!/usr/bin/env bash
# Writes the reference of every header to build/reference/html, by Doxygen. Fails where a function or type of the C interface is
# not documented, or a comment anywhere is wrong; counts what other headers leave out.
#   scripts/docs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
command -v doxygen >/dev/null || scripts/setup.sh --full
mkdir -p build/reference
doxygen docs/Doxyfile >build/reference/doxygen.log 2>&1 || { tail -20 build/reference/doxygen.log >&2; exit 1; }
warnings=build/reference/warnings.txt
sort -u -o "$warnings" "$warnings"
holes=$(grep -E 'runtime/include/.*(\(function\)|\(typedef\)|Compound).*not documented|unknown command|argument .* not found' "$warnings" || true)
if [ -n "$holes" ]; then
  printf '%s\n' "$holes" >&2
  echo "docs: $(printf '%s\n' "$holes" | wc -l) places to mend" >&2
  exit 1
fi
echo "docs: open build/reference/html/index.html ($(grep -c 'not documented' "$warnings" || true) members speak by their names alone)"
