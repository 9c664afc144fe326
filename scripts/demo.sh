#!/usr/bin/env bash
# Sets up, builds, and shows the whole way on the embedded head; the results are in out/.
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS
scripts/setup.sh --demo
cmake --preset release -DFASCIA_BUILD_TESTS=OFF >/dev/null
# What the demonstration runs, and no more; scripts/test.sh builds the rest.
if [ -t 1 ]; then
  NINJA_STATUS='@%f %t %e@ ' cmake --build build --target fascia | scripts/build_progress.sh
else
  cmake --build build --target fascia
fi
echo "demo: set up and built in $((SECONDS - started)) s"
build/bin/fascia demo --out out
