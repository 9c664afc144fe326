#!/usr/bin/env python3
"""make_head_parts.py FIGURES_FOLDER DATA_FOLDER: writes head_parts.obj (mm), what the generic head has besides skin,
eyes and teeth: gums, palate and tongue in one object, and lashes hair by hair. Sizes are those of
anatomy/figures/head_parts.json."""

import json
import sys
from pathlib import Path

import numpy as np

from paint.atlas import read_curves


class Mesh:
    def __init__(self, name):
        self.name, self.vertices, self.faces = name, [], []

    def add(self, point):
        self.vertices.append(np.asarray(point, float))
        return len(self.vertices) - 1

    def add_grid(self, rows):
        """Quads between rows of points of equal length, counter-clockwise when rows go right and columns up."""
        ids = [[self.add(p) for p in row] for row in rows]
        for a, b in zip(ids, ids[1:]):
            for k in range(len(a) - 1):
                self.faces.append([a[k], a[k + 1], b[k + 1], b[k]])


def read_teeth(path, name):
    """Vertices of one object of skull.obj, by the faces that use them."""
    vertices, used, current = [], set(), None
    for line in Path(path).read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(x) for x in words[1:4]])
        elif words[:1] == ["o"]:
            current = words[1]
        elif words[:1] == ["f"] and current == name:
            used.update(int(w.split("/")[0]) - 1 for w in words[1:])
    return np.array(vertices)[sorted(used)]


def smoothed(values, rounds):
    for _ in range(rounds):
        padded = np.concatenate([values[:1], values, values[-1:]])
        values = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    return values


def arch_of(teeth, centre_z, is_upper, count=81):
    """Angles about the arch's middle, and there the teeth's inner and outer radius and the height of their necks."""
    angle = np.arctan2(teeth[:, 0], teeth[:, 2] - centre_z)
    radius = np.hypot(teeth[:, 0], teeth[:, 2] - centre_z)
    last = np.percentile(np.abs(angle), 99)
    angles = np.linspace(-last, last, count)
    inner, outer, neck = [], [], []
    for a in angles:
        near = np.abs(angle - a) < 0.10
        r, y = radius[near], teeth[near, 1]
        inner.append(np.percentile(r, 6))
        outer.append(np.percentile(r, 94))
        neck.append(np.percentile(y, 97) if is_upper else np.percentile(y, 3))
    mirror = lambda v: 0.5 * (np.array(v) + np.array(v)[::-1])
    return angles, smoothed(mirror(inner), 2), smoothed(mirror(outer), 2), smoothed(mirror(neck), 3)


def add_gums(mesh, teeth, figures, is_upper):
    up = 1.0 if is_upper else -1.0
    centre = figures["arch_centre_z"]
    angles, inner, outer, neck = arch_of(teeth, centre, is_upper)
    over, high = figures["covers_tooth"], figures["height"]
    at = lambda a, r, y: (np.sin(a) * r, y, centre + np.cos(a) * r)
    rows = []
    for a, r0, r1, y in zip(angles, inner, outer, neck):
        # A scalloped margin: the gum rises between the teeth.
        scallop = 0.6 * np.cos(a * 14.0)
        margin = y - up * (over + scallop)
        rows.append([at(a, r1 - 0.6, y + up * high), at(a, r1 + 0.9, y + up * 0.6 * high), at(a, r1 + 1.0, y + up * 1.5),
                     at(a, r1 + 0.25, margin), at(a, r1 - 1.2, margin - up * 0.1), at(a, r0 + 1.0, margin - up * 0.1),
                     at(a, r0 - 0.3, margin), at(a, r0 - 1.2, y + up * 2.0), at(a, r0 - 2.6, y + up * 0.55 * high),
                     at(a, r0 - 5.0, y + up * 0.8 * high)])
    mesh.add_grid(rows if is_upper else [row[::-1] for row in rows])
    if is_upper:
        half = len(rows) // 2
        vault = []
        for left, right in zip(rows[:half], rows[::-1][:half]):
            a, b = np.array(left[-1]), np.array(right[-1])
            share = np.linspace(0, 1, 9)[:, None]
            line = a + share * (b - a)
            line[:, 1] += figures["palate_rise"] * np.minimum(1, np.linalg.norm(b - a) / 34) * (1 - (2 * share[:, 0] - 1) ** 2)
            vault.append(line)
        mesh.add_grid(vault)


def add_tongue(mesh, figures):
    tip, root, columns = figures["tip_z"], figures["root_z"], 17
    rows = []
    for z in np.linspace(root, tip, 19):
        share = (z - root) / (tip - root)
        width = np.interp(z, figures["half_width"]["z"], figures["half_width"]["x"])
        top = np.interp(share, [0, 0.35, 0.75, 1.0], figures["top"])
        row = []
        for s in np.linspace(-1, 1, columns):
            # Round sides that turn under, a furrow along the middle.
            angle = s * np.radians(125)
            x = width * np.sin(angle) / np.sin(np.radians(90))
            y = top - figures["thickness"] * (1 - np.cos(angle)) * 0.5
            y -= figures["furrow"] * np.exp(-(s / 0.10) ** 2) * min(1, 2.5 * (1 - share))
            row.append((x, y, z + (0 if share < 1 else -1.5 * abs(s))))
        rows.append(row)
    end = np.mean(rows[-1], axis=0) + np.array([0, -1.0, 1.6])
    rows.append([np.array(p) * 0.25 + 0.75 * end for p in rows[-1]])
    mesh.add_grid(rows)


def add_lashes(mesh, curve, eye, figures, is_upper, side, random):
    lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    lengths /= lengths[-1]
    for k in range(figures["count"]):
        s = np.clip((k + 0.5 + random.uniform(-0.35, 0.35)) / figures["count"], 0.03, 0.985)
        root = np.array([np.interp(s, lengths, curve[:, axis]) for axis in range(3)])
        ahead = np.array([np.interp(min(1, s + 0.03), lengths, curve[:, axis]) for axis in range(3)])
        along = (ahead - root) / np.linalg.norm(ahead - root)
        out = (root - eye) / np.linalg.norm(root - eye)
        out -= 0.35 * (out @ [0, 1, 0]) * np.array([0, 1, 0])
        fan = np.interp(s, [0, 0.5, 1], [-0.45, 0.05, 0.75]) + random.normal(0, 0.07)
        turn = 1.0 if is_upper else -1.0
        length = figures["length"] * np.interp(s, [0, 0.25, 0.65, 1], [0.55, 0.85, 1.0, 0.75]) * random.uniform(0.8, 1.08)
        root = root + 0.35 * out + turn * np.array([0, random.uniform(-0.25, 0.1), 0])
        point, pitch = root.copy(), np.radians(figures["start"] + random.normal(0, 5))
        stations = []
        for j in range(6):
            direction = np.cos(pitch) * out + turn * np.sin(pitch) * np.array([0, 1, 0]) + fan * along * 0.6
            direction /= np.linalg.norm(direction)
            stations.append((point.copy(), figures["width"] * (1 - j / 5.5)))
            point = point + length / 5 * direction
            pitch += np.radians(figures["curl"]) / 5
        ids = []
        for place, width in stations:
            a, b = place - 0.5 * width * along, place + 0.5 * width * along
            for p in (a, b):
                ids.append(mesh.add(p * np.array([side, 1, 1])))
        for j in range(5):
            quad = [ids[2 * j], ids[2 * j + 1], ids[2 * j + 3], ids[2 * j + 2]]
            mesh.faces.append(quad if side > 0 else quad[::-1])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    figures = json.loads((Path(sys.argv[1]) / "head_parts.json").read_text())
    eye = np.array(json.loads((Path(sys.argv[1]) / "head_figures.json").read_text())["eyeball"]["centre_left"])
    data = Path(sys.argv[2])
    curves = read_curves(data / "landmarks.json")
    mouth, lashes = Mesh("mouth_interior"), Mesh("lashes")
    for row in ("upper", "lower"):
        add_gums(mouth, read_teeth(data / "skull.obj", "teeth_" + row), figures["gums"], row == "upper")
    add_tongue(mouth, figures["tongue"])
    for side in (1.0, -1.0):
        random = np.random.default_rng(5)
        for lid in ("upper", "lower"):
            add_lashes(lashes, curves[lid + "_lid_margin"], eye, figures["lashes"][lid], lid == "upper", side, random)
    lines, first = ["# Written by tools/anatomy/make_head_parts.py. Millimetres; +X subject's left, +Y up, +Z front."], 1
    for mesh in (mouth, lashes):
        lines.append("o " + mesh.name)
        lines += ["v " + " ".join("%.3f" % x for x in p) for p in mesh.vertices]
        lines += ["f " + " ".join(str(i + first) for i in face) for face in mesh.faces]
        first += len(mesh.vertices)
    (data / "head_parts.obj").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
