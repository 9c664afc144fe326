#!/usr/bin/env bash
# Builds twice, in two folders of different names, without a compiler's cache, installs both and compares every file.
#   scripts/reproducible.sh [--runtime]     --runtime: the runtime alone, which takes a fraction of the time
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
options=()
[ "${1:-}" != --runtime ] || options=(-DFASCIA_BUILD_BUILDER=OFF)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
export SOURCE_DATE_EPOCH=0 CCACHE_DISABLE=1
for name in one another-and-longer; do
  mkdir -p "$place/$name"
  # Only what is under version control: a folder's leftovers must not matter either.
  git -C "$root" archive HEAD | tar -x -C "$place/$name"
  cmake -S "$place/$name" -B "$place/$name/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DFASCIA_BUILD_TESTS=OFF \
        -DFASCIA_BUILD_SAMPLES=OFF -DCMAKE_INSTALL_PREFIX=/usr "${options[@]}" >/dev/null
  cmake --build "$place/$name/build" >/dev/null
  DESTDIR="$place/$name/installed" cmake --install "$place/$name/build" >/dev/null
done
cd "$place/one/installed" && find . -type f | LC_ALL=C sort >"$place/files"
cmp "$place/files" <(cd "$place/another-and-longer/installed" && find . -type f | LC_ALL=C sort)
differ=0
while IFS= read -r file; do
  cmp -s "$file" "$place/another-and-longer/installed/$file" || { echo "differs: $file"; differ=1; }
done <"$place/files"
[ "$differ" = 0 ] && echo "$(wc -l <"$place/files") files, all alike; $(find . -type f -exec sha256sum {} + | LC_ALL=C sort -k2 | sha256sum | cut -d' ' -f1)"
exit "$differ"
