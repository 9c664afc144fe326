#!/usr/bin/python3
"""Fit and warp of 100,000 points by thin plates, Fascia against its peers, in pairs of runs on one core.

usage: compare.py BUILD_BIN [--rounds N] [--core C]

Each round runs Fascia's program and then the peer's, each measured in processor time; the ratios' median over the
rounds is what counts, so that a busy machine slows both. A short fit is repeated and its median taken (not VTK's). Prints a Markdown table and how far the peers' results are from Fascia's.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"

import numpy
from scipy.interpolate import RBFInterpolator

POINTS = 100_000


def run(program, landmarks, *files):
    line = subprocess.run([program, str(landmarks), *files], check=True, capture_output=True, text=True).stdout
    figures = json.loads(line)
    return figures["fit_ms"], figures["warp_ms"]


def run_scipy(workload, landmarks, output):
    data = numpy.fromfile(workload).reshape(-1, 3)
    source, target, points = data[:landmarks], data[landmarks : 2 * landmarks], data[2 * landmarks :]
    fits = []
    for _ in range(max(1, 2000 // landmarks)):
        start = time.process_time()
        spline = RBFInterpolator(source, target, kernel="linear", degree=1)
        fits.append(1e3 * (time.process_time() - start))
    start = time.process_time()
    carried = spline(points)
    warp = 1e3 * (time.process_time() - start)
    carried.tofile(output)
    return statistics.median(fits), warp


def pairs(folder, binaries, peer, landmarks, rounds):
    """Medians (own fit, own warp, peer fit, peer warp, ratio of fits, ratio of warps) and the largest difference in metres."""
    own, other, workload = (os.path.join(folder, name) for name in ("own", "other", "workload"))
    rows = []
    for _ in range(rounds):
        mine = run(os.path.join(binaries, "bench_splines"), landmarks, own, workload)
        if peer == "SciPy":
            theirs = run_scipy(workload, landmarks, other)
        else:
            theirs = run(os.path.join(binaries, {"dense LU": "bench_splines_dense", "VTK": "bench_splines_vtk"}[peer]),
                         landmarks, other)
        rows.append((*mine, *theirs, theirs[0] / mine[0], theirs[1] / mine[1]))
    difference = numpy.abs(numpy.fromfile(own) - numpy.fromfile(other)).max()
    return [statistics.median(column) for column in zip(*rows)], difference


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("binaries")
    arguments.add_argument("--rounds", type=int, default=5)
    arguments.add_argument("--core", type=int, default=0)
    options = arguments.parse_args()
    os.sched_setaffinity(0, {options.core})
    work = [("SciPy", 100), ("SciPy", 500), ("SciPy", 2000), ("VTK", 100), ("VTK", 500),
            ("dense LU", 100), ("dense LU", 500), ("dense LU", 2000)]
    print("| peer | N | fit, peer / own (ms) | ratio | warp, peer / own (ms) | ratio | largest difference |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for peer, landmarks in work:
            if peer == "VTK" and not os.path.exists(os.path.join(options.binaries, "bench_splines_vtk")):
                print("VTK was not found when the benchmark was configured", file=sys.stderr)
                continue
            medians, difference = pairs(folder, options.binaries, peer, landmarks, options.rounds)
            fit, warp, peer_fit, peer_warp, fit_ratio, warp_ratio = medians
            print(f"| {peer} | {landmarks} | {peer_fit:.3g} / {fit:.3g} | {fit_ratio:.3g} | {peer_warp:.3g} / {warp:.3g} "
                  f"| {warp_ratio:.3g} | {1e9 * difference:.2g} nm |", flush=True)


if __name__ == "__main__":
    main()
