#!/bin/sh
# The shared library needs libc (libm and the loader are parts of it) and libstdc++, and shows fascia_ alone.
# All functions of the headers are there, and in the table of api.h.
# usage: needs.sh LIBRARY FOLDER_OF_HEADERS
set -eu
needed=$(readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
echo "$needed"
[ -n "$needed" ]
for library in $needed; do
  case "$library" in
    libc.so.6 | libm.so.6 | libstdc++.so.6 | ld-linux*.so.*) ;;
    *) echo "not allowed: $library" >&2; exit 1 ;;
  esac
done
symbols=$(nm -D --defined-only --format=posix "$1" | cut -d' ' -f1 | grep -v '^FASCIA_0' || true)
foreign=$(echo "$symbols" | grep -v '^fascia_' || true)
[ -z "$foreign" ] || { echo "shown beside the interface: $foreign" >&2; exit 1; }
count=$(echo "$symbols" | grep -c '^fascia_')
declared=$(cat "$2"/*.h | grep -c '^FASCIA_API')
listed=$(grep -c '^  .*(\*[a-z_]*)(' "$2/api.h")
[ "$listed" -eq $((declared - 1)) ] || { echo "api.h lists $listed functions of $((declared - 1))" >&2; exit 1; }
[ "$count" -eq "$declared" ] || { echo "$count symbols for $declared declarations" >&2; exit 1; }
