#!/usr/bin/env python3
"""Compares the generic skull with what it was measured on.

    compare_skull.py BODYPARTS3D_FOLDER anatomy [PICTURE.png]

Prints, in mm: the distance of data/skull.obj to the reference's surface carried over by the warp of
figures/skull_frame.csv and by similarity alone, and where it is worst; the depth at every landmark with a tissue depth
against the table. With PICTURE.png, draws the warped reference over ours.
"""
import csv
import json
import os
import sys

import numpy as np
from scipy.spatial import cKDTree

from draw_anatomy import BONE, PARTS, Panel, beside, sampled
from measure_skull import read_obj, surface_samples
from measure_skull_frame import SMOOTHING, both_sides, thin_plate


def read_parts(path):
    parts, part, first, total = {}, None, 1, 0
    for line in open(path):
        if line.startswith("o "):
            part = parts[line.split()[1]] = ([], [])
            first = total + 1
        elif line.startswith("v "):
            part[0].append([float(t) for t in line.split()[1:]])
            total += 1
        elif line.startswith("f "):
            part[1].append([int(t) - first for t in line.split()[1:]])
    return {name: (np.array(v), np.array(f)) for name, (v, f) in parts.items()}


def similarity(source, target):
    a, b = source - source.mean(0), target - target.mean(0)
    u, s, vt = np.linalg.svd(a.T @ b)
    d = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    rotation = (u @ d @ vt).T
    scale = (s * np.diag(d)).sum() / (a ** 2).sum()
    return lambda x: scale * (x - source.mean(0)) @ rotation.T + target.mean(0)


def ray_depth(origin, direction, triangles):
    """Distance along a ray to the nearest of `triangles` (n, 3, 3); nan when it misses."""
    e1, e2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(direction, e2)
    with np.errstate(all="ignore"):
        inverse = 1 / (e1 * p).sum(1)
        s = origin - triangles[:, 0]
        u = (s * p).sum(1) * inverse
        q = np.cross(s, e1)
        v = (q @ direction) * inverse
        t = (e2 * q).sum(1) * inverse
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    return t[hit].min() if hit.any() else np.nan


def draw(path, parts, reference):
    """Ours in the colour of bone; the reference's points red where they stand out of it."""
    PARTS.update(parts)
    panels = []
    for view, box in (("front", (-80, 80, -80, 145)), ("three-quarter", (-105, 85, -80, 145)),
                      ("side", (-120, 90, -80, 145)), ("back", (-80, 80, -80, 145))):
        panel = Panel(view, 520, box)
        for name in parts:
            panel.surface(*sampled(name, 0.4), BONE[None])
        panel.splat(reference, np.array((190, 60, 40), np.uint8), 0.0)
        panels.append(panel)
    image = beside(panels, ["ours; BodyParts3D where it stands out (red)", "", "", ""])
    image.quantize(64).save(path, optimize=True)


def main(folder, anatomy, picture=None):
    parts = read_parts(os.path.join(anatomy, "data/skull.obj"))
    rows = [r for r in csv.reader(l for l in open(os.path.join(anatomy, "figures/skull_frame.csv")) if l[0] != "#")][1:]
    frame = np.array([[float(t) for t in r[1:]] for r in rows])
    pairs = both_sides(frame[:, :3], frame[:, 3:6], frame[:, 6])
    maps = {"warp": thin_plate(*pairs, SMOOTHING), "similarity": similarity(pairs[0], pairs[1])}
    warped = []
    for name in ("cranium", "mandible", "teeth_upper", "teeth_lower"):
        v, f, _ = read_obj(os.path.join(folder, name + ".obj"))
        reference = surface_samples(v, f, 0.8)
        ours = surface_samples(*parts[name], 2.0)
        for kind, carry in maps.items():
            carried = np.vstack([carry(block) for block in np.array_split(reference, max(1, len(reference) // 20000))])
            if kind == "warp":
                warped.append(carried)
            distance, _ = cKDTree(carried).query(ours)
            face = (ours[:, 2] > 50) & (ours[:, 1] < 65) if name == "cranium" else np.ones(len(ours), bool)
            for region, mask in (("face", face), ("elsewhere", ~face)):
                if mask.any():
                    d = distance[mask]
                    at = ours[mask][np.argmax(d)].round(0)
                    print(f"{name} {region} by {kind}: mean {d.mean():.2f}, 95 % {np.percentile(d, 95):.2f}, "
                          f"worst {d.max():.2f} at {at}")
    triangles = np.vstack([v[f] for v, f in parts.values()])
    for mark in json.load(open(os.path.join(anatomy, "data/landmarks.json")))["landmarks"]:
        if mark.get("bone_source") == "depth" and not mark["name"].endswith("_right"):
            skin, normal = np.array(mark["skin"]), np.array(mark["normal"])
            wanted = np.linalg.norm(skin - np.array(mark["bone"]))
            near = min(np.linalg.norm(surface_samples(*p, 1.0) - mark["bone"], axis=1).min() for p in parts.values())
            print(f"{mark['name']}: {ray_depth(skin, -normal, triangles):.1f} (table {wanted:.1f}), bone point {near:.1f} from the surface")
    if picture:
        draw(picture, parts, np.vstack(warped))


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
