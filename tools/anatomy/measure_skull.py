#!/usr/bin/env python3
"""Measures the figures from which make_skull shapes the generic skull.

    measure_skull.py BODYPARTS3D_FOLDER anatomy/figures

The folder holds cranium.obj, mandible.obj, teeth_upper.obj and teeth_lower.obj of BodyParts3D,
(c) The Database Center for Life Science, CC BY 4.0 (mm, +x subject's left, -y front, +z up).

Written, for the left half only, in millimetres, +X left, +Y up, +Z front, midplane x = 0:

skull_cranium_sections.csv, skull_mandible_sections.csv
    Profiles of the outer surface on horizontal (y) and sagittal (x) planes: point and outward normal.
skull_teeth.csv
    Each tooth cut across its long axis at stated distances from its tip: centre and widths.

The outer surface is that of a simplified solid: sutures, sinuses and small foramina closed (a ball of
2 mm does not pass), the endocranial cavity filled, conchae and vomer left out, the nasal passage closed
behind, styloid processes left out, tooth sockets filled. Points then move along their normals onto the
measured surface where that lies within 0.8 mm.
"""
import csv
import os
import sys

import numpy as np
from contourpy import contour_generator
from scipy import ndimage
from scipy.spatial import cKDTree

MIDPLANE = -0.65  # mm, of the source's x
ORIGIN_HEIGHT = 1500.0  # mm, of the source's z
CELL = 0.8  # mm

SOURCE = ("Measured from BodyParts3D, (c) The Database Center for Life Science, CC BY 4.0 "
          "(one adult man). Written by tools/anatomy/measure_skull.py.")
FRAME = ("Millimetres; +X subject's left, +Y up, +Z front; left half, midplane x = 0; "
         "y = source z - 1500, z = -source y.")


def read_obj(path):
    """Vertices in the figures' frame, triangles, and the group name of each triangle."""
    vertices, triangles, groups, group = [], [], [], ""
    with open(path) as lines:
        for line in lines:
            if line.startswith("v "):
                vertices.append([float(t) for t in line.split()[1:4]])
            elif line.startswith("g "):
                group = line.split()[1]
            elif line.startswith("f "):
                triangles.append([int(t.split("/")[0]) - 1 for t in line.split()[1:4]])
                groups.append(group)
    v = np.array(vertices)
    v = np.stack([v[:, 0] - MIDPLANE, v[:, 2] - ORIGIN_HEIGHT, -v[:, 1]], 1)
    return v, np.array(triangles), np.array(groups)


def surface_samples(vertices, triangles, spacing=0.4):
    """Points on every triangle, no farther apart than `spacing`."""
    corners = vertices[triangles]
    edge = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(1)
    steps = np.maximum(1, np.ceil(edge / spacing).astype(int))
    out = []
    for k in np.unique(steps):
        weights = np.array([(i / k, j / k) for i in range(k + 1) for j in range(k + 1 - i)])
        weights = np.c_[1 - weights.sum(1), weights]
        out.append(np.einsum("gb,tbc->tgc", weights, corners[steps == k]).reshape(-1, 3))
    return np.vstack(out)


class Grid:
    """A box of cubic cells, and the solids on it."""

    def __init__(self, lower, upper):
        self.lower = np.array(lower, float)
        self.shape = np.ceil((np.array(upper) - self.lower) / CELL).astype(int)
        axes = [self.lower[a] + CELL * (np.arange(self.shape[a]) + 0.5) for a in range(3)]
        self.x, self.y, self.z = np.meshgrid(*axes, indexing="ij", sparse=True)

    def occupied(self, points):
        index = np.floor((points - self.lower) / CELL).astype(int)
        index = index[((index >= 0) & (index < self.shape)).all(1)]
        out = np.zeros(self.shape, bool)
        out[tuple(index.T)] = True
        return out

    def near_segment(self, start, end):
        """Distance of every cell to a segment."""
        start, along = np.array(start, float), np.array(end, float) - np.array(start, float)
        offset = [self.x - start[0], self.y - start[1], self.z - start[2]]
        t = np.clip(sum(o * d for o, d in zip(offset, along)) / (along @ along), 0, 1)
        return np.sqrt(sum((o - t * d) ** 2 for o, d in zip(offset, along)))

    def distance(self, solid):
        return ndimage.distance_transform_edt(~solid, sampling=CELL)

    def sealed(self, shell, radius, distance=None):
        """Everything that a ball of `radius` rolling outside `shell` does not touch."""
        distance = self.distance(shell) if distance is None else distance
        labels, _ = ndimage.label(distance > radius)
        outside = labels == labels[-1, -1, -1]
        return ndimage.distance_transform_edt(~outside, sampling=CELL) > radius

    def signed_distance(self, solid, smoothing):
        d = self.distance(solid) - ndimage.distance_transform_edt(solid, sampling=CELL)
        return ndimage.gaussian_filter(d, smoothing)


def largest_part(solid):
    labels, count = ndimage.label(solid)
    sizes = ndimage.sum(solid, labels, range(1, count + 1))
    return labels == 1 + np.argmax(sizes)


def cranium_solid(folder):
    """The cranium's simplified solid, and samples of its measured surface."""
    grid = Grid([-14, -90, -25], [82, 142, 198])
    x, y, z, a = grid.x, grid.y, grid.z, np.abs(grid.x)
    v, f, groups = read_obj(os.path.join(folder, "cranium.obj"))
    left_out = np.array(["concha" in g or "vomer" in g for g in groups])
    ethmoid = np.array(["ethmoid" in g for g in groups])
    surface = surface_samples(v, f[~left_out & ~ethmoid])
    shell = grid.occupied(surface)
    shell |= grid.occupied(surface_samples(v, f[ethmoid])) & ~((a < 11) & (y < 16))
    tv, tf, _ = read_obj(os.path.join(folder, "teeth_upper.obj"))
    shell |= grid.occupied(surface_samples(tv, tf)) & (y > -33)  # roots fill the sockets
    shell |= (a < 19) & (np.abs(y + 16 - (z - 38) / 14) < 1.2) & (z > 36) & (z < 82)  # foramen magnum
    labels, _ = ndimage.label(grid.distance(shell) > 8)
    inside = labels[tuple(((np.array([0, 70, 60]) - grid.lower) / CELL).astype(int))]
    shell |= grid.distance(labels == inside) <= 8.2  # the endocranial cavity
    shell |= (a < 13) & (y > -14) & (y < 32) & (z > 84) & (z < 131)  # behind the nasal passage
    shell |= (a < 13) & (y > -22) & (y < 0) & (z > 108) & (z < 131)
    shell |= (a < 9) & (y > 24) & (y < 40) & (z > 84) & (z < 165)  # ethmoid between the orbits
    shell |= grid.near_segment([36.5, 6.5, 146], [25, 12.5, 126]) < 3.4  # inferior orbital fissure
    distance = grid.distance(shell)
    solid = grid.sealed(shell, 2.0, distance)
    solid |= grid.sealed(shell, 6.5, distance) & (a < 47) & (y > -12) & (y < 52) & (z > 92) & (z < 152)
    solid |= grid.sealed(shell, 3.2, distance) & (y < 15) & (z < 100) & (a < 40)
    near_sinus = np.broadcast_to((a > 11) & (a < 36) & (z > 128) & (y < 20), grid.shape)
    for axis in (0, 1):
        fill_slices(solid, near_sinus, axis, 700.0)
    opened = grid.distance(ndimage.distance_transform_edt(solid, sampling=CELL) > 1.9) <= 1.9
    solid = np.where((y < 2) & (z < 96), opened & solid, solid)  # styloid process
    # Thin plates that a mesh of 3 mm cannot carry: pterygoid processes, inner face of the nasal bones.
    plates = (a < 42) & (y < 9) & (z > 92) & (z < 137)
    closed = grid.sealed(solid, 4.0)
    solid = np.where(plates | ((z > 158) & (y > 6) & (a < 14)), closed, solid)
    opened = grid.distance(ndimage.distance_transform_edt(solid, sampling=CELL) > 1.9) <= 1.9
    solid = np.where(plates, opened & solid, solid)
    solid = largest_part(solid)
    return grid, ~largest_part(~solid), surface


def fill_slices(solid, where, axis, largest=1200.0):
    """Fills cavities that a plane across `axis` shows as closed, up to `largest` mm^2, inside `where`."""
    for k in range(solid.shape[axis]):
        at = tuple(k if i == axis else slice(None) for i in range(3))
        cavity = ndimage.binary_fill_holes(solid[at]) & ~solid[at]
        labels, count = ndimage.label(cavity)
        if count:
            area = ndimage.sum(cavity, labels, range(1, count + 1)) * CELL * CELL
            within = ndimage.mean(where[at], labels, range(1, count + 1))
            solid[at] |= np.isin(labels, 1 + np.nonzero((area < largest) & (within > 0.6))[0])


def mandible_solid(folder):
    grid = Grid([-14, -84, 84], [60, 12, 180])
    v, f, _ = read_obj(os.path.join(folder, "mandible.obj"))
    surface = surface_samples(v, f)
    shell = grid.occupied(surface)
    tv, tf, _ = read_obj(os.path.join(folder, "teeth_lower.obj"))
    shell |= grid.occupied(surface_samples(tv, tf)) & (grid.y < -54)
    solid = grid.sealed(shell, 1.6)
    near_sockets = np.broadcast_to((grid.y < -40) & (grid.z > 120), grid.shape)
    fill_slices(solid, near_sockets, 1, 150.0)
    solid = largest_part(solid)
    return grid, ~largest_part(~solid), surface


def section_points(grid, distance, surface, planes):
    """Profiles on planes (axis, position, spacing along the profile): axis, position, point, normal."""
    tree = cKDTree(surface)
    gradient = np.stack(np.gradient(ndimage.gaussian_filter(distance, 1.0)), 0)
    rows = []
    for axis, at, spacing in planes:
        position = (at - grid.lower[axis]) / CELL - 0.5
        k = int(np.floor(position))
        t = position - k
        index = [slice(None)] * 3
        index[axis] = k
        low = distance[tuple(index)]
        index[axis] = k + 1
        plane = (1 - t) * low + t * distance[tuple(index)]
        u, w = [i for i in range(3) if i != axis]
        for line in contour_generator(z=plane.T).lines(0.0):
            step = np.r_[0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))] * CELL
            if step[-1] < 6:
                continue
            count = max(3, int(round(step[-1] / spacing)))
            s = (np.arange(count) + 0.5) / count * step[-1]
            grid_points = np.zeros((count, 3))
            grid_points[:, u] = np.interp(s, step, line[:, 0])
            grid_points[:, w] = np.interp(s, step, line[:, 1])
            grid_points[:, axis] = position
            points = grid.lower + CELL * (grid_points + 0.5)
            normals = np.stack([ndimage.map_coordinates(g, grid_points.T, order=1) for g in gradient], 1)
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            for p, n in zip(points, normals):
                if p[0] < -1e-6:
                    continue
                near = tree.query_ball_point(p, 1.0)
                if near:
                    offset = (surface[near] - p) @ n
                    p = p + n * np.clip(np.median(offset[offset > offset.max() - 0.5]), -0.8, 0.8)
                if axis == 0 and at == 0:
                    p[0], n[0] = 0, 0
                rows.append((axis, at, *p, *(n / np.linalg.norm(n))))
    return np.array(rows)


def thinned(rows, spacing):
    """Rows in order, without those closer than spacing(point) to one already kept and facing alike."""
    tree = cKDTree(rows[:, 2:5])
    kept = np.zeros(len(rows), bool)
    for i, row in enumerate(rows):
        near = [j for j in tree.query_ball_point(row[2:5], spacing(row[2:5])) if kept[j]]
        kept[i] = not any(rows[j, 5:8] @ row[5:8] > 0.3 for j in near)
    return rows[kept]


def write_sections(path, title, rows):
    with open(path, "w", newline="\n") as out:
        out.write(f"# {title}\n# {SOURCE}\n# {FRAME}\n# axis of the plane (0: x, 1: y), its position, point, outward normal\n")
        out.write("axis,at,x,y,z,nx,ny,nz\n")
        for r in rows:
            out.write(f"{int(r[0])},{r[1]:g}," + ",".join(f"{t + 0.0:.2f}" for t in r[2:5]) + "," +
                      ",".join(f"{t + 0.0:.3f}" for t in r[5:8]) + "\n")


def in_vault(p):
    return p[1] > 62 or (p[2] < 70 and p[1] > 22)


def measure_cranium(folder, out):
    grid, solid, surface = cranium_solid(folder)
    distance = symmetric(grid, grid.signed_distance(solid, 0.9))
    planes = [(0, 0.0, 3.0)] + [(1, float(y), 3.0) for y in range(-51, 64, 3)]
    planes += [(1, float(y), 7.0) for y in range(69, 137, 7)]
    planes += [(0, float(x), 3.0) for x in range(3, 75, 4)]
    rows = section_points(grid, distance, surface, planes)
    rows = thinned(rows, lambda p: 6.0 if in_vault(p) else 2.2)
    write_sections(os.path.join(out, "skull_cranium_sections.csv"), "Sections of the cranium's outer surface.", rows)
    print("cranium", len(rows))


def symmetric(grid, distance):
    """The field meets its mirror image smoothly at x = 0."""
    width = int(round(-grid.lower[0] / CELL))
    near = distance[:2 * width]
    t = np.clip(np.abs(np.arange(2 * width) + 0.5 - width) * CELL / 12, 0, 1)
    own = 0.5 + 0.5 * t * t * (3 - 2 * t)
    own = np.where(np.arange(2 * width) < width, 1 - own, own)[:, None, None]
    out = distance.copy()
    out[:2 * width] = own * near + (1 - own) * near[::-1]
    return out


def measure_mandible(folder, out):
    grid, solid, surface = mandible_solid(folder)
    distance = symmetric(grid, grid.signed_distance(solid, 0.8))
    planes = [(0, 0.0, 2.5)] + [(1, float(y) + 0.5, 2.5) for y in range(-78, 8, 3)]
    planes += [(0, float(x), 2.5) for x in range(3, 54, 3)]
    rows = thinned(section_points(grid, distance, surface, planes), lambda p: 1.9)
    write_sections(os.path.join(out, "skull_mandible_sections.csv"), "Sections of the mandible's outer surface.", rows)
    print("mandible", len(rows))


TEETH = ["central_incisor", "lateral_incisor", "canine", "first_premolar", "second_premolar", "first_molar",
         "second_molar"]
SOURCE_NAMES = {"central_incisor": "{}_central_incisor", "lateral_incisor": "{}_lateral_incisor",
                "canine": "{}_canine", "first_premolar": "first_{}_premolar",
                "second_premolar": "second_{}_premolar", "first_molar": "first_{}_molar",
                "second_molar": "second_{}_molar"}
LEVELS = [0.4, 1.0, 2.0, 3.5, 5.0, 6.5, 8.0, 10.0, 12.0]  # mm from the tip


def tooth_rows(jaw, name, vertices, arch_direction):
    """Widths of one tooth across its long axis; `arch_direction` is the dental arch's tangent there."""
    towards_tip = np.array([0, -1.0, 0]) if jaw == "upper" else np.array([0, 1.0, 0])
    centred = vertices - vertices.mean(0)
    axis = np.linalg.svd(centred, full_matrices=False)[2][0]
    axis *= np.sign(axis @ towards_tip)
    if "molar" in name:  # short teeth: the longest axis is not the tooth's
        axis = 0.5 * axis + towards_tip if axis @ towards_tip > 0.6 else towards_tip
        axis /= np.linalg.norm(axis)
    mesial = arch_direction - axis * (arch_direction @ axis)
    mesial /= np.linalg.norm(mesial)
    buccal = np.cross(axis, mesial)
    if buccal @ np.array([vertices.mean(0)[0], 0, vertices.mean(0)[2] - 135]) < 0:
        buccal = -buccal
    height = vertices @ axis
    for level in LEVELS:
        band = vertices[np.abs(height - (height.max() - level)) < max(0.35, 0.25 * level if level < 2 else 0.45)]
        if len(band) < 6:
            continue
        m, b = band @ mesial, band @ buccal
        centre = mesial * (m.max() + m.min()) / 2 + buccal * (b.max() + b.min()) / 2 + axis * (height.max() - level)
        yield [jaw, name, level, *centre, *axis, *mesial, (m.max() - m.min()) / 2, (b.max() - b.min()) / 2]


def measure_teeth(folder, out):
    with open(os.path.join(out, "skull_teeth.csv"), "w", newline="\n") as file:
        file.write(f"# Teeth cut across their long axes.\n# {SOURCE}\n# {FRAME}\n"
                   "# level: mm from the tip along the axis; centre, axis towards the tip, mesio-distal direction, half widths\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow("jaw,tooth,level,x,y,z,ax,ay,az,mx,my,mz,half_mesiodistal,half_buccolingual".split(","))
        for jaw in ("upper", "lower"):
            v, f, groups = read_obj(os.path.join(folder, f"teeth_{jaw}.obj"))
            parts = []
            for name in TEETH:
                want = SOURCE_NAMES[name].format(jaw)
                mask = np.array(["left_" + want in g.lower() for g in groups])
                points = surface_samples(v, f[mask], 0.25)
                tip = points[:, 1].min() if jaw == "upper" else points[:, 1].max()
                parts.append((name, points, points[np.abs(points[:, 1] - tip) < 6].mean(0)))
            middles = np.array([p[2] for p in parts])
            for i, (name, points, _) in enumerate(parts):
                before = middles[i - 1] if i else middles[0] * [-1, 1, 1]
                after = middles[i + 1] if i + 1 < len(middles) else 2 * middles[i] - middles[i - 1]
                for row in tooth_rows(jaw, name, points, before - after):
                    writer.writerow(row[:2] + [f"{t + 0.0:.3f}".rstrip("0").rstrip(".") for t in row[2:]])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    os.makedirs(sys.argv[2], exist_ok=True)
    measure_teeth(*sys.argv[1:])
    measure_mandible(*sys.argv[1:])
    measure_cranium(*sys.argv[1:])
