#!/bin/sh
# A host is a sample to copy from: each has at most 400 lines of its own, without tests and stand-ins of an engine.
#   host_size.sh SOURCE_FOLDER
set -eu
cd "$1/hosts"
status=0
for host in */; do
  lines=$(find "$host" -name stand_ins -prune -o -type f \( -name '*.c' -o -name '*.cpp' -o -name '*.h' -o -name '*.cs' -o -name '*.py' \
    -o -name '*.gd' -o -name '*.sh' -o -name CMakeLists.txt \) ! -name 'test.*' ! -path '*/build*/*' -exec cat {} + | wc -l)
  echo "${host%/}: $lines lines"
  [ "$lines" -gt 0 ] && [ "$lines" -le 400 ] || { echo "hosts/$host is not within 1 to 400 lines" >&2; status=1; }
done
exit $status
