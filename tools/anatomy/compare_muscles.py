#!/usr/bin/env python3
"""Compares the courses of our muscles with those of BodyParts3D.

    compare_muscles.py BODYPARTS3D_FOLDER anatomy [PICTURE.png]

The muscles of BodyParts3D ((c) The Database Center for Life Science, CC BY-SA 2.1 JP, one man) are carried to the generic
head by the warp of figures/skull_frame.csv and laid over ours; nothing of them is kept. Bones do not tell where the corner
of the mouth is: the warp also takes their modiolus, the point that the muscles ending there have least far to, to ours.
Printed, in mm, for every muscle that both have: how far apart the centre lines are, in space and along the skin (that man's
skin is too thin for depths to mean anything), on average and at worst, and how much of our course the other one has.
A centre line of theirs is the middle of the surface's points within slices across our course; of fans, within shells about
the insertion.
"""
import csv
import glob
import json
import os
import sys

import numpy as np
from scipy.spatial import cKDTree

from draw_anatomy import BONE, PARTS, Panel, beside, course, sampled
from measure_skull import read_obj, surface_samples
from measure_skull_frame import SMOOTHING, both_sides, thin_plate
from place_landmarks import Surface, read_objects

SLICES = 12
# Theirs, and ours of which it is made up. Left out: orbicularis oris, a ring, and sternocleidomastoid, which we have not.
PAIRS = {
    "corrugator_supercilii": ["corrugator_supercilii_transverse"],
    "levator_labii_superioris_alaeque_nas": ["levator_labii_superioris_alaeque_nasi_labial"],
    "levator_labii_superioris": ["levator_labii_superioris_medial", "levator_labii_superioris_lateral"],
    "zygomaticus_major": ["zygomaticus_major_superior", "zygomaticus_major_inferior"],
    "zygomaticus_minor": ["zygomaticus_minor"],
    "levator_anguli_oris": ["levator_anguli_oris"],
    "risorius": ["risorius"],
    "buccinator": ["buccinator_upper", "buccinator_lower"],
    "depressor_anguli_oris": ["depressor_anguli_oris"],
    "depressor_labii_inferioris": ["depressor_labii_inferioris_medial", "depressor_labii_inferioris_lateral"],
    "mentalis": ["mentalis"],
    "nasalis": ["nasalis_transverse"],
    "depressor_septi_nasi": ["depressor_septi_nasi"],
    "procerus": ["procerus"],
    "platysma": ["platysma_labial", "platysma_modiolar"],
    "temporalis": ["temporalis_anterior", "temporalis_middle", "temporalis_posterior"],
    "medial_pterygoid": ["medial_pterygoid"],
}


def theirs(folder):
    """Points of their surfaces, the right ones mirrored, in the frame of the measured skull: a list of two for each muscle."""
    out = {}
    for name in PAIRS:
        for path in sorted(glob.glob(os.path.join(folder, "muscles", f"*_{name}.obj"))):
            v, f, _ = read_obj(path)
            samples = surface_samples(v, f, 0.8)
            out.setdefault(name, []).append(samples * [-1, 1, 1] if "_Right_" in path else samples)
    return out


def modiolus(samples, start):
    """The point with the least sum of squared distances to the muscles that end at the corner of the mouth."""
    ending_there = ("zygomaticus_major", "levator_anguli_oris", "depressor_anguli_oris", "risorius")
    trees = [cKDTree(np.vstack(samples[name])) for name in ending_there]
    point = np.array(start)
    for _ in range(50):
        point = np.mean([tree.data[tree.query(point)[1]] for tree in trees], 0)
    return point


def to_generic(frame, samples, ours):
    """Carries their muscles to the generic head: by bones, then with the corner of the mouth as well."""
    bones = both_sides(frame[:, :3], frame[:, 3:6], frame[:, 6])
    by_bones = thin_plate(*bones, SMOOTHING)
    grid = frame[:, :3][np.argmin(np.linalg.norm(frame[:, 3:6] - ours, axis=1))]
    corner = modiolus(samples, grid)
    print(f"their modiolus lies {np.linalg.norm(by_bones(corner[None])[0] - ours):.1f} mm from ours by bones alone")
    pair = (corner[None], ours[None], np.ones(1))
    carry = thin_plate(*(np.r_[a, b] for a, b in zip(bones, both_sides(*pair))), SMOOTHING)
    blocks = lambda points: np.array_split(points, max(1, len(points) // 20000))
    return {name: [np.vstack([carry(b) for b in blocks(side)]) for side in sides] for name, sides in samples.items()}


def centre_lines(ours, points):
    """Middles of slices of `points` across the course `ours`, and the point of ours that each belongs to."""
    along = np.gradient(ours, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    _, nearest = cKDTree(ours).query(points)
    # What lies beyond an end of ours is no neighbour of that end.
    beyond = np.abs(((points - ours[nearest]) * along[nearest]).sum(1)) > 1.5
    points, nearest = points[~beyond], nearest[~beyond]
    step = (len(ours) - 1) // SLICES
    for k in range(SLICES):
        chosen = points[nearest // step == k]
        if len(chosen) > 20:
            yield chosen.mean(0), (k * step + step // 2), along[k * step + step // 2]


def shells(ours, points):
    """The same for fans: middles of shells about the insertion."""
    radius = np.linalg.norm(points - ours[-1], axis=1)
    own = np.linalg.norm(ours - ours[-1], axis=1)
    along = np.gradient(ours, axis=0)
    step = (len(ours) - 1) // SLICES
    for k in range(SLICES):
        at = k * step + step // 2
        chosen = points[(radius < own[k * step]) & (radius > own[(k + 1) * step])]
        if len(chosen) > 20:
            yield chosen.mean(0), at, along[at] / np.linalg.norm(along[at])


def compare(ours, samples, skin, fan):
    """Offsets across ours in space and along the skin, slice by slice: mean over the sides."""
    space, flat = [], []
    for points in samples:
        for middle, k, along in (shells if fan else centre_lines)(ours, points):
            offset = middle - ours[k]
            offset = offset - offset @ along * along
            normal = skin.nearest(ours[k])[1]
            space.append(np.linalg.norm(offset))
            flat.append(np.linalg.norm(offset - offset @ normal * normal))
    return np.array(space), np.array(flat)


def draw(path, parts, samples):
    rows = []
    for view, box in (("front", (-5, 80, -80, 75)), ("three-quarter", (-75, 85, -80, 75)), ("side", (-110, 60, -80, 75))):
        panel = Panel(view, 640, box)
        for name in ("cranium", "mandible", "teeth_upper", "teeth_lower"):
            panel.surface(*sampled(name, 0.25), BONE[None])
        for name, sides in samples.items():
            if name == "platysma":
                continue
            panel.splat(sides[0], np.array((205, 120, 105), np.uint8), 0.5)
        for name, own in PAIRS.items():
            for part in own:
                panel.line(course(parts[part]), (20, 40, 170), False, 30.0)
        rows.append(panel)
    beside(rows, ["BodyParts3D's muscles (red), our courses (blue)", "", ""]).quantize(128).save(path, optimize=True)


def main(folder, anatomy, picture=None):
    rows = [r for r in csv.reader(l for l in open(os.path.join(anatomy, "figures/skull_frame.csv")) if l[0] != "#")][1:]
    frame = np.array([[float(t) for t in r[1:]] for r in rows])
    parts = {m["name"]: m for m in json.load(open(os.path.join(anatomy, "data/muscles.json")))["muscles"]}
    ends = [part["insertion"] for part in parts.values() if "insertion" in part]
    corner = np.mean([np.mean(end["polygon"], 0) for end in ends if end["on"] == "modiolus"], 0)
    samples = to_generic(frame, theirs(folder), corner)
    head = read_objects(os.path.join(anatomy, "data/head.obj"))
    skin = Surface(*head["skin"])
    within = 0
    for name, own in PAIRS.items():
        ours = np.mean([course(parts[part]) for part in own], 0)
        space, flat = compare(ours, samples[name], skin, name == "temporalis")
        within += flat.mean() <= 4
        print(f"{name:38s} in space {space.mean():5.1f}, along the skin {flat.mean():5.1f} (worst {flat.max():5.1f}), "
              f"shared {len(flat) / len(samples[name]) / SLICES:4.0%}")
        if os.environ.get("SLICES"):
            print("   ", flat.round(1))
    print(f"{within} of {len(PAIRS)} within 4 mm along the skin")
    if picture:
        PARTS.update(read_objects(os.path.join(anatomy, "data/skull.obj")))
        draw(picture, parts, samples)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
