#!/usr/bin/env bash
# Sets up, builds with warnings as errors, and runs the tests.
#   scripts/test.sh [--full]
# --full: also 250 broken heads, clang, sanitizers, fuzzers (five minutes each), faults by the hundred, a cluster of two nodes,
# builds that are reproducible, five minutes of random input in the window, the glTF validator, Windows by wine, the hosts and the demo.
set -euo pipefail
cd "$(dirname "$0")/.."

full=0
case "${1:-}" in
  '') ;;
  --full) full=1 ;;
  *) echo "usage: scripts/test.sh [--full]" >&2; exit 2 ;;
esac

if [ "$full" = 1 ]; then scripts/setup.sh --full; else scripts/setup.sh --test; fi

run_suite() {  # preset, build folder, extra ctest arguments
  cmake --preset "$1" >/dev/null
  cmake --build "$2"
  ctest --test-dir "$2" --output-on-failure -j2 "${@:3}"
}

run_suite ci build
if [ "$full" = 1 ]; then
  FASCIA_BROKEN_HEADS=6 build/bin/test_broken_heads --gtest_brief=1
  run_suite clang build/clang
  ASAN_OPTIONS=detect_leaks=0 run_suite asan build/asan
  # Threads share work in the tool, in crowds of faces and in batches.
  cmake --preset tsan >/dev/null
  cmake --build build/tsan --target fascia test_runtime test_snapshot test_batch
  for program in test_runtime test_snapshot test_batch; do build/tsan/bin/$program; done
  tests/determinism/same_bytes.sh build/tsan/bin/fascia build/tests/snapshots build/tests/samples
  cmake --preset fuzz >/dev/null
  cmake --build build/fuzz --target fuzz
  tests/fuzz/run.sh build/fuzz/bin 300
  # Another day, other cases; the number of one that fails repeats it.
  python3 tests/fuzz/mutate.py build/bin/fascia build/tests/samples/tiny.glb build/tests/samples/smile.csv \
    tests/fuzz/corpus/{mesh,curves,activations,edits,landmarks,snapshot,manifest}/* --head build/tests/snapshots/embedded_head.obj \
    --seed "$(date +%Y%j0000)" --seconds 300 --keep build/findings
  FASCIA_THOROUGH=1 build/bin/test_faults --gtest_brief=1  # longer than a test of ctest's may take
  cmake --preset ci -DFASCIA_FULL_TESTS=ON >/dev/null
  ctest --test-dir build --output-on-failure -R 'batch.slurm|snapshots.head'
  scripts/reproducible.sh
  # Random keys and mouse in the window, five minutes.
  ASAN_OPTIONS=detect_leaks=0 xvfb-run -a -s '-screen 0 1600x1000x24' \
    build/asan/bin/fascia view --monkey "$(date +%j)" --seconds 300
  tests/validator/validate.sh build/bin/fascia || [ $? -eq 77 ]
  cases=${FASCIA_MEASURED:-../shared}/cases
  if [ -d "$cases" ]; then python3 bench/cases/table.py build/bin/fascia "$cases"; else echo "skipped: no cases at $cases"; fi
  scripts/packages.sh
  scripts/runtime.sh
  scripts/windows.sh || [ $? -eq 77 ]
  scripts/hosts.sh
fi
