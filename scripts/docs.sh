#!/usr/bin/env bash
# Writes the reference of every header to build/reference/html, by Doxygen; what has no comment stands there by its name. Fails
# where a comment is wrong (an unknown command, a parameter that is not there) and where a member of the public headers,
# runtime/include, has none.
#   scripts/docs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
command -v doxygen >/dev/null || scripts/setup.sh --full
mkdir -p build/reference

run_doxygen() { # settings from stdin, LOG
  doxygen - >"$1" 2>&1 || { tail -20 "$1" >&2; exit 1; }
}
run_doxygen build/reference/doxygen.log <docs/Doxyfile
# The public headers by themselves, for their warnings alone.
run_doxygen build/reference/public.log <<END
$(cat docs/Doxyfile)
INPUT                  = runtime/include
USE_MDFILE_AS_MAINPAGE =
EXTRACT_ALL            = NO
GENERATE_HTML          = NO
WARN_LOGFILE           = build/reference/public_warnings.txt
END

faults=$({
  grep -E 'unknown command|argument .* not found|documented symbol .* was not' build/reference/warnings.txt || true
  grep -F runtime/include/ build/reference/public_warnings.txt || true
} | sort -u)
if [ -n "$faults" ]; then
  printf '%s\n' "$faults" >&2
  exit 1
fi
echo "docs: open build/reference/html/index.html"
