#!/usr/bin/env python3
"""Traces the named curves of the measured skull: the rims that make_skull keeps sharp.

    measure_skull_curves.py BODYPARTS3D_FOLDER anatomy/figures

Reads the same files as measure_skull.py and writes skull_curves.csv: for each curve of the left half its
points in order, outward normals of the surface there, in millimetres, +X left, +Y up, +Z front, midplane x = 0.

A rim is where the surface bends outwards most. Each is the cheapest path along the surface of the simplified
solid from the first guide point to the last, where a step costs less the more the surface bends outwards and
more the farther it is from the polyline through the guide points, read off views of the measured skull.
The foramen magnum's rim is the narrowest place at each angle about its middle; the front edge of the
septum is the foremost point of vomer and ethmoid in the midplane at each height.
"""
import os
import sys

import numpy as np
from scipy import ndimage
from scipy.interpolate import splev, splprep
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from measure_skull import CELL, SOURCE, cranium_solid, mandible_solid, read_obj, surface_samples, symmetric

SPACING = 1.8  # mm between the points written

# Name: bone, closed, guide points.
RIMS = {
    "orbital_rim": ("cranium", True, [
        (50, 21.9, 150), (49, 30.9, 154), (47.5, 36, 159), (41.3, 39.3, 163.3), (31.8, 42, 168), (21.7, 40.9, 170.6),
        (16, 37, 170), (13, 30, 167), (12.2, 21, 164), (13, 9.7, 165), (16.8, 5.6, 164), (23.6, 0.4, 162),
        (30.3, -1.5, 160.6), (36, -0.5, 156.5), (44.9, 5, 152), (48.5, 8.5, 151), (50.5, 15, 149.5)]),
    "piriform_margin": ("cranium", False, [
        (1.0, -20.5, 177), (6, -19.5, 173), (11, -15.5, 169.5), (12.8, -8.5, 168.5), (12.3, -5, 174), (9.9, -1, 178),
        (7, 3, 181.5), (4, 7, 186.5), (0.5, 10.5, 189)]),
    "zygomatic_arch_upper": ("cranium", False, [
        (49.5, 30, 148), (51, 22, 144.5), (54, 13, 140.5), (58, 8.5, 134), (62, 7, 127), (63.3, 7, 119), (62.5, 9.5, 108),
        (60.5, 12.5, 98)]),
    "zygomatic_arch_lower": ("cranium", False, [
        (45.5, -17, 147.5), (50, -8, 141.5), (55.5, -2, 135), (60, -0.5, 129), (62.7, -0.5, 123), (63, 2.5, 114),
        (61, 5, 106), (58, 4, 100)]),
    "zygomaticoalveolar_crest": ("cranium", False, [(45.5, -17, 147.5), (39, -18, 147.5), (35, -22, 146), (33.5, -26, 145)]),
    "mandible_border": ("mandible", False, [
        (3, -78, 166), (13, -77.0, 157.5), (21.4, -74.2, 147.7), (27.9, -71.3, 143.0), (33, -67, 134), (36.6, -60, 122),
        (41.1, -54.4, 111.1), (40.3, -49.8, 102.9), (38.5, -39.1, 98.4), (39, -29.2, 97), (42.6, -20.2, 95.2),
        (44.1, -8, 91.5)]),
    "ramus_front": ("mandible", False, [
        (38, -53, 143), (40, -45, 139), (42.5, -30, 134), (43.7, -20, 134), (44, -10, 136), (44, -5.8, 134.5)]),
    "mandibular_notch": ("mandible", False, [
        (44, -5.8, 134.5), (44, -11, 128), (44.8, -15.6, 120.5), (45, -10, 111), (45, -2, 103), (48, 3, 97)]),
}


class Field:
    """The simplified solid's distance, and what follows from it at the cells next to its surface."""

    def __init__(self, grid, solid, surface, smoothing):
        self.grid = grid
        self.distance = symmetric(grid, grid.signed_distance(solid, smoothing))
        self.gradient = np.stack(np.gradient(ndimage.gaussian_filter(self.distance, 1.0)), 0) / CELL
        self.bend = ndimage.gaussian_laplace(self.distance, 1.2) / CELL ** 2
        self.surface = cKDTree(surface)
        self.samples = surface

    def at(self, values, points):
        return ndimage.map_coordinates(values, ((points - self.grid.lower) / CELL - 0.5).T, order=1)

    def normals(self, points):
        n = np.stack([self.at(g, points) for g in self.gradient], 1)
        return n / np.linalg.norm(n, axis=1, keepdims=True)

    def onto(self, points):
        """Points on the solid's surface, then along their normals onto the measured one within 0.8 mm."""
        for _ in range(6):
            points = points - self.normals(points) * self.at(self.distance, points)[:, None]
        normals = self.normals(points)
        out = []
        for p, n in zip(points, normals):
            near = self.surface.query_ball_point(p, 1.0)
            offset = (self.samples[near] - p) @ n if near else np.zeros(1)
            out.append(p + n * np.clip(np.median(offset[offset > offset.max() - 0.5]), -0.8, 0.8))
        return np.array(out), normals


def densely(points, closed, spacing):
    points = np.array(points, float)
    if closed:
        points = np.vstack([points, points[:1]])
    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    at = np.linspace(0, s[-1], max(2, int(round(s[-1] / spacing)) + 1))
    return np.stack([np.interp(at, s, points[:, k]) for k in range(3)], 1)


def trace(field, guides, closed):
    """Cells of the cheapest path along the guides."""
    line = densely(guides, closed, 0.5)
    guide = cKDTree(line)
    lower = np.floor((line.min(0) - 6 - field.grid.lower) / CELL).astype(int).clip(0)
    upper = np.ceil((line.max(0) + 6 - field.grid.lower) / CELL).astype(int)
    box = tuple(slice(a, b) for a, b in zip(lower, upper))
    cells = np.argwhere(np.abs(field.distance[box]) < 0.75 * CELL) + lower
    points = field.grid.lower + CELL * (cells + 0.5)
    off, along = guide.query(points)
    keep = (off < 5.0) & (points[:, 0] > -CELL)
    points, cells, off, along = points[keep], cells[keep], off[keep], along[keep]
    price = np.exp(-10.0 * np.clip(field.bend[tuple(cells.T)], -0.1, 0.5)) * (1 + (off / 3.0) ** 2)
    pairs = cKDTree(points).query_pairs(1.8 * CELL, output_type="ndarray")
    a, b = pairs.T
    # A closed rim is cut at its first guide point: no step jumps from its end to its beginning.
    whole = np.abs(along[a] - along[b]) < len(line) / 2
    a, b = a[whole], b[whole]
    cost = np.linalg.norm(points[a] - points[b], axis=1) * 0.5 * (price[a] + price[b])
    graph = coo_matrix((np.r_[cost, cost], (np.r_[a, b], np.r_[b, a])), shape=(len(points),) * 2).tocsr()
    near_end = [np.linalg.norm(points - end, axis=1) < 3.5 for end in (line[0], line[-1])]
    if closed:
        near_end = [near_end[0] & (along < len(line) / 2), near_end[1] & (along > len(line) / 2)]
    ends = [np.nonzero(m)[0][np.argmin((price * (1 + np.linalg.norm(points - end, axis=1)))[m])]
            for m, end in zip(near_end, (line[0], line[-1]))]
    _, before = dijkstra(graph, indices=ends[0], return_predecessors=True)
    path = [ends[1]]
    while path[-1] != ends[0]:
        path.append(before[path[-1]])
        if path[-1] < 0:
            raise SystemExit("the guide points of a rim leave the surface")
    return points[path[::-1]]


def smooth(points, closed, spacing):
    """A smoothing spline through a path of cells, evenly spaced."""
    if closed:
        points = np.vstack([points, points[:1]])
    tck, _ = splprep(points.T, s=len(points) * (0.55 * CELL) ** 2, per=closed)
    fine = np.stack(splev(np.linspace(0, 1, 40 * len(points)), tck), 1)
    out = densely(fine, False, spacing)
    return out[:-1] if closed else out


def foramen_magnum(folder):
    """Its rim from basion to opisthion, seen along the axis of the opening."""
    v, f, groups = read_obj(os.path.join(folder, "cranium.obj"))
    samples = surface_samples(v, f[np.array(["Occipital" in g for g in groups])])
    samples[:, 0] = np.abs(samples[:, 0])
    along = np.array([0, 1 / 14, 1]) / np.hypot(1, 1 / 14)
    axis = np.cross([1, 0, 0], along)
    offset = samples - [0, -14.5, 59]
    angle, radius = np.arctan2(offset[:, 0], offset @ along), np.hypot(offset[:, 0], offset @ along)
    rim = []
    for wanted in np.linspace(0, np.pi, 26):
        near = (np.abs(angle - wanted) < 0.07) & (np.abs(offset @ axis) < 4) & (radius < 28)
        order = np.argsort(radius[near])[:12]
        rim.append(samples[near][order].mean(0))
    rim = np.array(rim)
    rim[[0, -1], 0] = 0
    return smooth(rim, False, SPACING), axis


def septum_front(folder):
    v, f, groups = read_obj(os.path.join(folder, "cranium.obj"))
    samples = surface_samples(v, f[np.array(["vomer" in g or "ethmoid" in g for g in groups])])
    samples = samples[np.abs(samples[:, 0]) < 2.5]
    out = []
    for y in np.arange(-24, 13, 3.0):
        near = samples[np.abs(samples[:, 1] - y) < 1.5]
        out.append((0, y, near[:, 2].max()))
    return np.array(out)


def main(folder, out):
    fields = {"cranium": Field(*cranium_solid(folder), 0.9), "mandible": Field(*mandible_solid(folder), 0.8)}
    rows = []
    for name, (bone, closed, guides) in RIMS.items():
        field = fields[bone]
        points, normals = field.onto(smooth(trace(field, guides, closed), closed, SPACING))
        rows += [(name, bone, p, n) for p, n in zip(points, normals)]
        print(name, len(points))
    rim, axis = foramen_magnum(folder)
    rows += [("foramen_magnum", "cranium", p, -axis) for p in rim]
    rows += [("nasal_septum_front", "cranium", p, (0, 0, 1)) for p in septum_front(folder)]
    with open(os.path.join(out, "skull_curves.csv"), "w", newline="\n") as file:
        file.write(f"# Named curves of the skull's outer surface.\n# {SOURCE.replace('measure_skull', 'measure_skull_curves')}\n"
                   "# Millimetres; +X subject's left, +Y up, +Z front; left half, midplane x = 0; frame of the sections.\n"
                   "# curve, bone, point, outward normal\ncurve,bone,x,y,z,nx,ny,nz\n")
        for name, bone, p, n in rows:
            file.write(f"{name},{bone}," + ",".join(f"{t + 0.0:.2f}" for t in p) + "," + ",".join(f"{t + 0.0:.3f}" for t in n) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
