"""Noise over places in space: no seams at the borders of texture islands, the same on every run."""

import numpy as np

_TABLE = np.random.default_rng(20).random(1 << 16, dtype=np.float32)
_STEPS = np.array([40503, 30011, 52183], np.int64)


def _cell(places, period):
    q = (places / np.float32(period)).astype(np.float32)
    i = np.floor(q)
    return i.astype(np.int64), (q - i).astype(np.float32)


def value(places, period, seed):
    """Smooth noise in 0..1 with features `period` mm apart; `places` is n x 3 in mm."""
    i, f = _cell(places, period)
    f = f * f * (3 - 2 * f)
    first = (i * _STEPS).sum(1) + seed * 7919
    planes = []
    for x in (0, 1):
        rows = []
        for y in (0, 1):
            at = first + (x * _STEPS[0] + y * _STEPS[1])
            low, high = _TABLE[at & 0xFFFF], _TABLE[(at + _STEPS[2]) & 0xFFFF]
            rows.append(low + f[:, 2] * (high - low))
        planes.append(rows[0] + f[:, 1] * (rows[1] - rows[0]))
    return planes[0] + f[:, 0] * (planes[1] - planes[0])


def layers(places, period, seed, count=4, decay=0.55):
    """Noise of several sizes, each half as wide; mean 0.5."""
    total, weight = np.zeros(len(places), np.float32), 0.0
    for k in range(count):
        w = decay ** k
        total += w * value(places, period / 2 ** k, seed + k)
        weight += w
    return total / weight


def cells(places, period, seed):
    """Distance to the nearest of points scattered `period` mm apart, and to the next, in periods (Worley)."""
    i, f = _cell(places, period)
    base = (i * _STEPS).sum(1) + seed * 7919
    first = np.full(len(places), 9.0, np.float32)
    second = first.copy()
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for dz in (-1, 0, 1):
                at = base + int(np.dot([dx, dy, dz], _STEPS))
                d = np.zeros(len(places), np.float32)
                for k, o in enumerate((dx, dy, dz)):
                    away = f[:, k] - (o + _TABLE[(at + 12289 * (k + 1)) & 0xFFFF])
                    d += away * away
                second = np.minimum(second, np.maximum(first, d))
                first = np.minimum(first, d)
    return np.sqrt(first), np.sqrt(second)
