#!/bin/sh
# Fails, with the places, when a source is not as .clang-format wants it.
#   formatted.sh CLANG_FORMAT SOURCE_FOLDER
set -eu
cd "$2"
case "$("$1" --version)" in *" 14."*) ;; *) echo "skipped: needs clang-format 14"; exit 77 ;; esac
folders=$(find . -mindepth 1 -maxdepth 1 -type d \( -name builder -o ! -name 'build*' \) ! -name out ! -name node_modules ! -name '.*')
find $folders -name node_modules -prune -o -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.hpp' -o -name '*.c' \) -print0 |
  xargs -0 "$1" --dry-run --Werror
