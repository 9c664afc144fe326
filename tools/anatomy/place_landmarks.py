#!/usr/bin/env python3
"""Lays the landmarks and curves of anatomy/data/landmarks.json on the generic head and skull.

    place_landmarks.py anatomy

Run after make_head, make_skull or a correction by hand: it rewrites data/landmarks.json and the corners in
data/tissue.json in place, and once more changes nothing but the last digit. Left side and midline are computed, the right mirrors the left.

- tangent: horizontal within the skin, away from the midplane (to the subject's left on the midplane).
- bone points with "bone_source": "measured" go to the nearest point of their bone; bone_normal is the bone's there.
- corners of the regions of data/tissue.json go to the nearest point of the skin, line by line in that file.
- curves on bone that skull_curves.csv measured come from there, the others keep their course; all are laid on the
  surface they are on, evenly spaced. Lid margins, lip line and vermilion border are the loops of head_regions.json.
"""
import csv
import json
import os
import re
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from measure_skull_frame import SMOOTHING, both_sides, thin_plate


def read_objects(path):
    """Vertices, triangles and polygons' vertex lists of each object."""
    vertices, objects, name = [], {}, None
    for line in open(path):
        if line.startswith("o "):
            name = line.split()[1]
            objects[name] = []
        elif line.startswith("v "):
            vertices.append([float(t) for t in line.split()[1:4]])
        elif line.startswith("f "):
            objects[name].append([int(t.split("/")[0]) - 1 for t in line.split()[1:]])
    vertices = np.array(vertices)
    out = {}
    for name, polygons in objects.items():
        used = np.unique(np.concatenate(polygons))
        renumber = {v: k for k, v in enumerate(used)}
        triangles = [[renumber[p[0]], renumber[p[k]], renumber[p[k + 1]]] for p in polygons for k in range(1, len(p) - 1)]
        out[name] = (vertices[used], np.array(triangles))
    return out


class Surface:
    def __init__(self, vertices, triangles):
        self.corners = vertices[triangles]
        normal = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.normal = normal / (np.linalg.norm(normal, axis=1, keepdims=True) + 1e-12)
        self.middles = cKDTree(self.corners.mean(1))
        self.reach = np.linalg.norm(self.corners - self.corners.mean(1)[:, None], axis=2).max()

    def nearest(self, point):
        """Nearest point, and the surface's normal over 2 mm about it."""
        distance, _ = self.middles.query(point)
        near = np.array(self.middles.query_ball_point(point, distance + 2 * self.reach))
        feet = closest_on_triangles(point, self.corners[near])
        k = np.argmin(np.linalg.norm(feet - point, axis=1))
        about = self.middles.query_ball_point(feet[k], 4.0) or [near[k]]
        facing = self.normal[about] @ self.normal[near[k]] > 0.3
        normal = (self.normal[about][facing]).sum(0) if facing.any() else self.normal[near[k]]
        return feet[k], normal / np.linalg.norm(normal)


def closest_on_triangles(p, t):
    """Closest point of each triangle (n, 3, 3) to p."""
    best, least = np.zeros((len(t), 3)), np.full(len(t), np.inf)
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    ab, ac, ap = b - a, c - a, p - a
    d00, d01, d11 = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
    d20, d21 = (ap * ab).sum(1), (ap * ac).sum(1)
    area = d00 * d11 - d01 ** 2 + 1e-30
    v, w = (d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area
    candidates = [(a + v[:, None] * ab + w[:, None] * ac, (v >= 0) & (w >= 0) & (v + w <= 1))]
    for s, e in ((a, b), (b, c), (c, a)):
        along = np.clip(((p - s) * (e - s)).sum(1) / (((e - s) ** 2).sum(1) + 1e-30), 0, 1)
        candidates.append((s + along[:, None] * (e - s), np.ones(len(t), bool)))
    for point, valid in candidates:
        distance = np.where(valid, ((point - p) ** 2).sum(1), np.inf)
        best[distance < least] = point[distance < least]
        least = np.minimum(least, distance)
    return best


def evenly(points, count, closed):
    """`count` points evenly spaced on a cubic spline through `points`."""
    points = np.array(points, float)
    keep = np.r_[True, np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-6]
    points = points[keep]
    if closed:
        points = np.vstack([points, points[:1]])
    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    spline = CubicSpline(s, points, bc_type="periodic" if closed else "natural")
    fine = spline(np.linspace(0, s[-1], 40 * count))
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))]
    at = np.linspace(0, length[-1], count + 1 if closed else count)
    out = np.stack([np.interp(at, length, fine[:, k]) for k in range(3)], 1)
    return out[:-1] if closed else out


def lateral(normal, midline):
    if midline:
        return np.array([1.0, 0, 0])
    across = np.cross([0, 1.0, 0], normal)
    if np.linalg.norm(across) < 0.2:
        across = np.array([1.0, 0, 0]) - normal * normal[0]
    return across / np.linalg.norm(across) * (-1 if across[0] < 0 else 1)


def rounded(vector, digits):
    return [round(float(t), digits) + 0.0 for t in vector]


def mirrored(vector):
    return [-vector[0] + 0.0, vector[1], vector[2]]


MEASURED = {"orbital_rim": 36, "piriform_margin": 14, "mandible_border": 32, "zygomatic_arch_upper": 18,
            "zygomatic_arch_lower": 16, "mandibular_notch": 12, "ramus_front": 12, "foramen_magnum": 16}
DEFINITIONS = {
    "zygomatic_arch_upper": "Upper border of the zygomatic arch from behind the orbit's lateral rim to its root.",
    "zygomatic_arch_lower": "Lower border of the zygomatic arch from the zygomaxillary suture to its root.",
    "mandibular_notch": "Upper border of the ramus from the tip of the coronoid process to the condyle.",
    "ramus_front": "Front border of the ramus from the alveolus up to the tip of the coronoid process.",
    "foramen_magnum": "Rim of the foramen magnum from its front (basion) to its back (opisthion).",
    "upper_lid_crease": "Fold of the upper lid above its margin, where the skin is drawn in.",
    "alar_groove": "Groove behind the wing of the nose, from above its wing down to its foot.",
    "hairline": "Where the hair usually begins, from the midline over the temple to the root of the ear's helix.",
}
COUNTS = {"temporal_line": 16, "zygomatic_arch": 16, "brow": 12, "nasolabial_fold": 12}


def measured_curves(anatomy):
    rows = [r for r in csv.reader(l for l in open(os.path.join(anatomy, "figures/skull_frame.csv")) if l[0] != "#")][1:]
    frame = np.array([[float(t) for t in r[1:]] for r in rows])
    carry = thin_plate(*both_sides(frame[:, :3], frame[:, 3:6], frame[:, 6]), SMOOTHING)
    curves = {}
    for row in [r for r in csv.reader(l for l in open(os.path.join(anatomy, "figures/skull_curves.csv")) if l[0] != "#")][1:]:
        curves.setdefault((row[0], row[1]), []).append([float(t) for t in row[2:5]])
    return {name: (bone, carry(np.array(p))) for (name, bone), p in curves.items()}


def skin_loops(anatomy, head):
    """Curves that are loops of the head's mesh: lid margins from inner to outer canthus, lips from the midline out."""
    loops = json.load(open(os.path.join(anatomy, "data/head_regions.json")))["objects"]["skin"]["loops"]
    points = {name: head["skin"][0][ids] for name, ids in loops.items()}
    out = {}
    lid = points["lid_margin_left"]
    inner, outer = np.argmin(lid[:, 0]), np.argmax(lid[:, 0])
    for side in (lid[np.arange(inner, inner + (outer - inner) % len(lid) + 1) % len(lid)],
                 lid[np.arange(inner, inner - (inner - outer) % len(lid) - 1, -1) % len(lid)]):
        name = "upper_lid_margin" if side[:, 1].mean() > (lid[inner, 1] + lid[outer, 1]) / 2 else "lower_lid_margin"
        out[name] = evenly(side, 13, False)
    for loop, upper, lower in (("vermilion_border", "upper_vermilion_border", "lower_vermilion_border"),
                               ("lip_contact", "lip_line", None)):
        ring = points[loop]
        left = ring[ring[:, 0] > -1e-6]
        corner = left[np.argmax(left[:, 0])]
        for name, sign in ((upper, 1), (lower, -1)):
            if name is None:
                continue
            half = np.array(sorted([p for p in left if sign * (p[1] - corner[1]) > -1e-6 or p is corner], key=lambda p: p[0]))
            if name == "lip_line":
                half = np.array(sorted(left.tolist()))
                half = half[np.r_[True, np.diff(half[:, 0]) > 0.3]]
            half[0, 0] = 0
            out[name] = evenly(half, 12, False)
    return out


def creases(landmarks):
    """Lines of the skin that the mesh has no loop for, through the named points on them."""
    at = {m["name"]: np.array(m["skin"]) for m in landmarks if "skin" in m}
    en, ex, fold = at["endocanthion_left"], at["exocanthion_left"], at["sulcus_palpebralis_superior_left"]
    lid = [en + [1.5, 4.0, 0], 0.5 * (en + fold) + [-1.5, 2.6, 0], fold, 0.5 * (ex + fold) + [1.5, 2.6, 0], ex + [2.0, 4.0, 0]]
    groove, foot = at["alar_groove_left"], at["subalare_left"]
    ala = at["alare_left"]
    alar = [ala + [-4.0, 9.0, -1.0], groove + [0, 4.5, 0], groove, 0.5 * (groove + foot) + [1.2, -0.6, 0], foot]
    temple, helix = at["frontotemporale_left"], at["otobasion_superius_left"]
    trichion = at["trichion"]
    hair = [trichion, trichion + [25, -4, -6], temple + [3, 26, -16], temple + [8, 8, -24], helix + [-2, 22, 16], helix + [0, 2, 8]]
    beside = at["mid_mandibular_border_left"]
    jaw = [at["menton"], 0.5 * (at["menton"] + beside) + [0, -3, 6], beside, at["gonion_left"], at["otobasion_inferius_left"]]
    return {"upper_lid_crease": lid, "alar_groove": alar, "hairline": hair, "jaw_line": jaw}


def place_points(marks, parts):
    bones = {"mandible": parts["mandible"], "cranium": parts["cranium"]}
    jaw = ("condylion", "coronion", "incisura_mandibulae", "gonion", "foramen_mentale", "infradentale", "supramentale",
           "pogonion", "gnathion", "menton", "mid_ramus", "mid_mandibular", "infracanine", "ectomolare_inferius")
    for mark in marks:
        if mark["side"] == "right":
            continue
        midline = mark["side"] == "midline"
        if "skin" in mark:
            mark["tangent"] = rounded(lateral(np.array(mark["normal"]), midline), 5)
        if "bone" not in mark:
            continue
        bone = bones["mandible" if mark["name"].startswith(jaw) else "cranium"]
        point = np.array(mark["bone"])
        foot, normal = bone.nearest(point)
        if mark["bone_source"] == "measured" and mark["name"] != "gnathion":
            if midline:
                foot[0] = 0
            mark["bone"] = rounded(foot, 3)
        if midline:
            normal[0] = 0
        mark["bone_normal"] = rounded(normal / np.linalg.norm(normal), 5)
    by_name = {m["name"]: m for m in marks}
    # The most lateral point of the rim itself, not of the bone behind it.
    rim = parts["orbital_rim"]
    by_name["ectoconchion_left"]["bone"] = rounded(bones["cranium"].nearest(rim[np.argmax(rim[:, 0])])[0], 3)
    pogonion = by_name["pogonion"]
    pogonion["bone"] = rounded(bones["mandible"].nearest(np.array(pogonion["bone"]))[0] * [0, 1, 1], 3)
    pogonion["bone_source"] = "measured"
    # By the mean depth it would stand before the pogonion: midway between its neighbours on the bone instead.
    gnathion = by_name["gnathion"]
    midway = 0.5 * (np.array(by_name["pogonion"]["bone"]) + by_name["menton"]["bone"])
    gnathion["bone"] = rounded(bones["mandible"].nearest(midway)[0] * [0, 1, 1], 3)
    gnathion["bone_source"] = "measured"
    for mark in marks:
        if mark["side"] == "right":
            left = by_name[mark["name"][:-5] + "left"]
            for key in ("tangent", "bone", "bone_normal"):
                if key in left:
                    mark[key] = mirrored(left[key])


def place_regions(path, skin):
    def laid(match):
        points = [skin.nearest(np.array(p))[0] for p in json.loads(match.group(2))]
        return match.group(1) + json.dumps([rounded(p, 2) for p in points])
    text = open(path).read()
    with open(path, "w", newline="\n") as out:
        out.write(re.sub(r'("polygon": )(\[\[.*?\]\])', laid, text))


ORDER = ("name", "abbreviation", "kind", "surface", "side", "required", "definition", "skin", "normal", "tangent", "bone",
         "bone_normal", "bone_source", "depth")


def write(path, document):
    def row(entry, order):
        return "    {" + ", ".join(f"{json.dumps(k)}: {json.dumps(entry[k])}" for k in order if k in entry) + "}"
    with open(path, "w", newline="\n") as out:
        out.write('{\n  "units": "mm",\n  "frame": ' + json.dumps(document["frame"]) + ',\n  "landmarks": [\n')
        out.write(",\n".join(row(m, ORDER) for m in document["landmarks"]) + "\n  ],\n  \"curves\": [\n")
        out.write(",\n".join(row(c, ("name", "midline", "on", "closed", "definition", "points")) for c in document["curves"]))
        out.write("\n  ]\n}\n")


def main(anatomy):
    path = os.path.join(anatomy, "data/landmarks.json")
    document = json.load(open(path))
    head, skull = read_objects(os.path.join(anatomy, "data/head.obj")), read_objects(os.path.join(anatomy, "data/skull.obj"))
    surfaces = {"skin": Surface(*head["skin"]), "cranium": Surface(*skull["cranium"]), "mandible": Surface(*skull["mandible"])}
    measured = measured_curves(anatomy)
    place_points(document["landmarks"], {**surfaces, "orbital_rim": measured["orbital_rim"][1]})
    loops, folds = skin_loops(anatomy, head), creases(document["landmarks"])
    curves = {c["name"]: c for c in document["curves"]}
    for name in list(MEASURED) + list(folds):
        bone = measured[name][0] if name in MEASURED else "skin"
        curves.setdefault(name, {"name": name, "on": bone, "definition": DEFINITIONS.get(name)})
    for name, curve in curves.items():
        closed = curve.get("closed", False)
        if name in loops:
            points = loops[name]
        elif name in MEASURED:
            points = evenly(measured[name][1], MEASURED[name], closed)
        elif name in folds:
            points = evenly(folds[name], 16 if name == "jaw_line" else 12, False)
        else:
            points = evenly(curve["points"], COUNTS.get(name, len(curve["points"])), closed)
        midline_start = name in ("lip_line", "upper_vermilion_border", "lower_vermilion_border", "jaw_line", "hairline")
        laid = [surfaces[curve["on"]].nearest(p)[0] for p in points]
        if midline_start:
            laid[0][0] = 0
        curve["points"] = [rounded(p, 2) for p in laid]
        moved = np.linalg.norm(np.array(laid) - points, axis=1)
        print(f"{name}: {len(points)} points, moved {moved.mean():.2f} mm, at most {moved.max():.2f}")
    document["curves"] = list(curves.values())
    write(path, document)
    place_regions(os.path.join(anatomy, "data/tissue.json"), surfaces["skin"])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
