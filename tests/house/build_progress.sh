#!/usr/bin/env bash
# The line of progress says percent and time left; what the compiler says stays whole.
set -euo pipefail
said=$(printf '@1 4 30.5@ Building a\na.cpp:1: error: so\n@3 4 60.0@ Building b\n@1 9 99.9@ c\n' | "$1/scripts/build_progress.sh" |
  tr '\r' '\n' | sed 's/\x1b\[K//g')
expect() {
  grep -qxF -- "$1" <<<"$said" || { echo "missing '$1' in:"; echo "$said"; exit 1; }
}
expect '  demo: build  25 %, 90 s left'
expect 'a.cpp:1: error: so'
expect '  demo: build  75 %, 20 s left'
expect '  demo: build  11 %, 14 min left'
