#!/usr/bin/env python3
"""Draws the pictures of docs/anatomy.md from the data files.

    draw_anatomy.py anatomy docs/figures

skull.png: the generic skull with its curves. landmarks.png: landmarks and curves of the skin on the generic head.
muscles.png: origins, insertions and central fibres of the muscles. regions.png: attachment zones, gliding planes, fat
compartments, aesthetic units, lids and ligaments on the face.
"""
import colorsys
import functools
import json
import os
import sys

import numpy as np
from PIL import Image, ImageDraw
from scipy.interpolate import CubicSpline

from place_landmarks import read_objects

VIEWS = {"front": 0, "three-quarter": -42, "side": -90, "back": 180}


@functools.lru_cache(None)
def sampled(key, spacing):
    return samples(*PARTS[key], spacing)


PARTS = {}


def samples(vertices, triangles, spacing):
    """Points on the triangles with smooth normals."""
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normal, triangles[:, k], face)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-12
    edge = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(1)
    steps = np.maximum(1, np.ceil(edge / spacing).astype(int))
    points, normals = [], []
    for k in np.unique(steps):
        w = np.array([(i / k, j / k) for i in range(k + 1) for j in range(k + 1 - i)])
        w = np.c_[1 - w.sum(1), w]
        points.append(np.einsum("gb,tbc->tgc", w, corners[steps == k]).reshape(-1, 3))
        normals.append(np.einsum("gb,tbc->tgc", w, normal[triangles[steps == k]]).reshape(-1, 3))
    normals = np.vstack(normals)
    return np.vstack(points), normals / (np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12)


class Panel:
    def __init__(self, view, size, box):
        a = np.radians(VIEWS[view])
        self.turn = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
        self.size, self.box = size, box
        self.scale = size / (box[3] - box[2])
        self.width = int((box[1] - box[0]) * self.scale)
        self.colour = np.full((size * self.width, 3), 250, np.uint8)
        self.depth = np.full(size * self.width, -1e9)

    def pixel(self, points):
        p = points @ self.turn.T
        return ((p[:, 0] - self.box[0]) * self.scale).astype(int), ((self.box[3] - p[:, 1]) * self.scale).astype(int), p[:, 2]

    def splat(self, points, colours, lift=0.0):
        x, y, z = self.pixel(points)
        inside = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.size)
        at, z, colours = (y * self.width + x)[inside], z[inside] + lift, np.broadcast_to(colours, (len(points), 3))[inside]
        order = np.argsort(z, kind="stable")
        at, z, colours = at[order], z[order], colours[order]
        front = z > self.depth[at]
        self.colour[at[front]] = colours[front]
        np.maximum.at(self.depth, at, z)

    def surface(self, points, normals, colours):
        n = normals @ self.turn.T
        light = 0.3 + 0.55 * np.clip(n @ [0.3, 0.45, 0.84], 0, 1) + 0.2 * np.clip(n @ [-0.7, 0.1, 0.5], 0, 1)
        light[n[:, 2] < 0] = 0.3
        self.splat(points, np.clip(colours * light[:, None], 0, 255).astype(np.uint8))

    def line(self, points, colour, closed=False, lift=1.5):
        points = np.array(points, float)
        if closed:
            points = np.vstack([points, points[:1]])
        s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
        at = np.arange(0, s[-1], 0.08)
        p = np.stack([np.interp(at, s, points[:, k]) for k in range(3)], 1)
        for dx, dy in ((0, 0), (0.3, 0), (0, 0.3), (0.3, 0.3)):
            self.splat(p + self.turn.T @ [dx, dy, 0], np.array(colour, np.uint8), lift)

    def dots(self, points, colour, radius=0.9):
        grid = np.array([(x, y, 0) for x in np.arange(-1, 1.01, 0.2) for y in np.arange(-1, 1.01, 0.2) if x * x + y * y <= 1])
        for p in points:
            self.splat(p + radius * grid @ self.turn, np.array(colour, np.uint8), 2.5)

    def image(self):
        return Image.fromarray(self.colour.reshape(self.size, self.width, 3))


def both(points, midline=False):
    points = np.array(points, float)
    return [points] if midline else [points, points * [-1, 1, 1]]


def inside(polygon, points):
    """Which points lie within the polygon, seen along its mean normal and as near to its plane as the builder takes them."""
    centre = polygon.mean(0)
    depth = 20 + 0.5 * np.linalg.norm(polygon - centre, axis=1).max()
    near = (np.abs(points - centre) < 1.2 * np.abs(polygon - centre).max(0) + 15).all(1)
    out = np.zeros(len(points), bool)
    points = points[near]
    _, _, axes = np.linalg.svd(polygon - centre)
    p, q = (points - centre) @ axes.T, (polygon - centre) @ axes.T
    result = np.zeros(len(points), bool)
    for a, b in zip(q, np.roll(q, -1, 0)):
        if a[1] == b[1]:
            continue
        crosses = ((a[1] > p[:, 1]) != (b[1] > p[:, 1])) & (p[:, 0] < a[0] + (p[:, 1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
        result ^= crosses
    out[near] = result & (np.abs(p[:, 2]) < depth)
    return out


def beside(panels, titles):
    images = [p.image() for p in panels]
    out = Image.new("RGB", (sum(i.width for i in images), images[0].height), "white")
    x = 0
    for image, title in zip(images, titles):
        out.paste(image, (x, 0))
        ImageDraw.Draw(out).text((x + 8, 6), title, fill="black")
        x += image.width
    return out


SKIN, BONE = np.array([224, 190, 168.0]), np.array([232, 224, 204.0])
RED, BLUE, GREEN = (190, 30, 30), (30, 60, 190), (20, 120, 60)


def draw_skull(document):
    panels = []
    for view, box in (("front", (-80, 80, -80, 145)), ("three-quarter", (-105, 85, -80, 145)),
                      ("side", (-120, 90, -80, 145)), ("back", (-80, 80, -80, 145))):
        panel = Panel(view, 520, box)
        for name, colour in (("cranium", BONE), ("mandible", BONE * 0.93), ("teeth_upper", np.full(3, 245.0)),
                             ("teeth_lower", np.full(3, 245.0))):
            panel.surface(*sampled(name, 0.4), colour[None])
        for curve in document["curves"]:
            if curve["on"] != "skin":
                for points in both(curve["points"]):
                    panel.line(points, RED, curve.get("closed", False))
        panel.dots([np.array(m["bone"]) for m in document["landmarks"] if "bone" in m], BLUE)
        panels.append(panel)
    return beside(panels, ["landmarks (blue), curves (red)", "", "", ""])


def draw_landmarks(document):
    panels = []
    for view, box in (("front", (-90, 90, -100, 150)), ("three-quarter", (-115, 95, -100, 150)),
                      ("side", (-130, 110, -100, 150))):
        panel = Panel(view, 520, box)
        for name, colour in (("skin", SKIN), ("eye_left", np.full(3, 240.0)), ("eye_right", np.full(3, 240.0))):
            panel.surface(*sampled(name, 0.4), colour[None])
        for curve in document["curves"]:
            if curve["on"] == "skin":
                for points in both(curve["points"]):
                    panel.line(points, RED)
        panel.dots([np.array(m["skin"]) for m in document["landmarks"] if "skin" in m and not m["required"]], BLUE)
        panel.dots([np.array(m["skin"]) for m in document["landmarks"] if "skin" in m and m["required"]], GREEN, 1.3)
        panels.append(panel)
    return beside(panels, ["landmarks (blue; to be placed: green), curves", "", ""])


def course(part, count=61):
    """Evenly spaced points of the centre line from the middle of the origin through the waypoints to that of the insertion."""
    ends = [np.mean(part[end]["polygon"], 0) for end in ("origin", "insertion")]
    knots = np.array([ends[0], *part.get("waypoints", []), ends[1]])
    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))]
    fine = CubicSpline(s, knots)(np.linspace(0, s[-1], 400)) if len(knots) > 2 else np.linspace(*knots, 400)
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))]
    return np.stack([np.interp(np.linspace(0, length[-1], count), length, fine[:, k]) for k in range(3)], 1)


def draw_muscles(muscles):
    panels = []
    for view, box in (("front", (-5, 85, -90, 110)), ("three-quarter", (-80, 85, -90, 110)), ("side", (-115, 70, -90, 110))):
        panel = Panel(view, 620, box)
        for name, colour in (("cranium", BONE), ("mandible", BONE * 0.93), ("teeth_upper", np.full(3, 245.0)),
                             ("teeth_lower", np.full(3, 245.0))):
            panel.surface(*sampled(name, 0.3), colour[None])
        for k, part in enumerate(m for m in muscles if "origin" in m):
            tint = tuple(int(235 * c) for c in colorsys.hsv_to_rgb(0.61803 * k % 1, 0.85, 0.8))
            panel.line(course(part), tint, False, 30.0)
            panel.line(part["origin"]["polygon"], RED, True, 30.0)
            panel.line(part["insertion"]["polygon"], BLUE, True, 30.0)
        panels.append(panel)
    return beside(panels, ["origins (red), insertions (blue)", "central fibres; rings of lips and lids are bands", ""])


def draw_regions(tissue):
    lists = [("skin_attachments", "SMAS to skin: attachment"),
             ("gliding_planes", "gliding planes, ligaments (red: at the bone)")]
    points, normals = sampled("skin", 0.6)
    rows = []
    for view, box in (("front", (-85, 85, -100, 115)), ("three-quarter", (-95, 95, -100, 115))):
        panels = []
        for key, _ in lists:
            panel = Panel(view, 380, box)
            colours = np.repeat(SKIN[None], len(points), 0)
            for k, zone in enumerate(tissue[key]):
                tint = 255 * np.array(colorsys.hsv_to_rgb(0.61803 * k % 1, 0.55, 0.95))
                for polygon in both(zone["polygon"], zone.get("midline", False)):
                    colours[inside(polygon, points)] = tint
            panel.surface(points, normals, colours)
            for eye in ("eye_left", "eye_right"):
                panel.surface(*sampled(eye, 0.5), np.full((1, 3), 240.0))
            for zone in tissue[key]:
                for polygon in both(zone["polygon"], zone.get("midline", False)):
                    panel.line(polygon, (60, 40, 40), True, 3.0)
            if key == "gliding_planes":
                for ligament in tissue["ligaments"]:
                    for bone, skin in zip(both(ligament["bone"]), both(ligament["skin"])):
                        panel.line(skin, BLUE, False, 3.0) if len(skin) > 1 else panel.dots(skin, BLUE)
                        for b, s in zip(bone, skin):
                            panel.line([b, s], BLUE, False, 40.0)
                            panel.dots([b + panel.turn.T @ [0, 0, 40.0]], RED, 0.8)
            panels.append(panel)
        rows.append(beside(panels, [title for _, title in lists] if view == "front" else [""] * len(lists)))
    out = Image.new("RGB", (max(r.width for r in rows), sum(r.height for r in rows)), "white")
    y = 0
    for row in rows:
        out.paste(row, (0, y))
        y += row.height
    return out


def main(anatomy, figures):
    load = lambda name: json.load(open(os.path.join(anatomy, "data", name)))
    for name in ("skull", "head"):
        PARTS.update(read_objects(os.path.join(anatomy, f"data/{name}.obj")))
    document = load("landmarks.json")
    for name, image in (("skull", draw_skull(document)), ("landmarks", draw_landmarks(document)),
                        ("muscles", draw_muscles(load("muscles.json")["muscles"])),
                        ("regions", draw_regions(load("tissue.json")))):
        image.quantize(200).save(os.path.join(figures, name + ".png"), optimize=True)
        print(name, image.size)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
