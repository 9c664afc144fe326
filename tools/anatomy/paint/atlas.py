"""The generic head's skin as a grid of texels: where each lies on the head, and which way it faces."""

import json
from pathlib import Path

import numpy as np


def read_object(path, name):
    """Vertices (mm), texture coordinates and faces [(region, [(vertex, texture)...])] of one object of an OBJ."""
    vertices, textures, faces = [], [], []
    region = current = None
    for line in Path(path).read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "o":
            current = words[1]
        elif words[0] == "v":
            vertices.append([float(x) for x in words[1:4]])
        elif words[0] == "vt":
            textures.append([float(x) for x in words[1:3]])
        elif words[0] == "g":
            region = words[1]
        elif words[0] == "f" and current == name:
            faces.append((region, [tuple(int(i) - 1 for i in corner.split("/")) for corner in words[1:]]))
    return np.array(vertices), np.array(textures), faces


def vertex_normals(vertices, faces):
    normals = np.zeros_like(vertices)
    for _, corners in faces:
        ids = [v for v, _ in corners]
        p = vertices[ids]
        n = np.cross(p[2] - p[0], p[-1] - p[1])
        normals[ids] += n
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


class Atlas:
    """`place`, `normal` (size x size x 3, mm and unit), `region` (index into `names`, -1 outside the islands)."""

    def __init__(self, obj, size):
        vertices, textures, faces = read_object(obj, "skin")
        normals = vertex_normals(vertices, faces)
        self.size = size
        self.vertices = vertices
        self.names = sorted({region for region, _ in faces})
        self.place = np.zeros((size, size, 3), np.float32)
        self.normal = np.zeros((size, size, 3), np.float32)
        self.region = np.full((size, size), -1, np.int16)
        for region, corners in faces:
            index = self.names.index(region)
            for k in range(1, len(corners) - 1):
                tri = [corners[0], corners[k], corners[k + 1]]
                self._fill(index, vertices[[v for v, _ in tri]], normals[[v for v, _ in tri]],
                           textures[[t for _, t in tri]])
        self.mask = self.region >= 0

    def _fill(self, index, points, normals, uv):
        xy = np.stack([uv[:, 0] * self.size - 0.5, (1 - uv[:, 1]) * self.size - 0.5], 1)
        low = np.maximum(np.floor(xy.min(0)).astype(int), 0)
        high = np.minimum(np.ceil(xy.max(0)).astype(int), self.size - 1)
        if (high < low).any():
            return
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        a, b, c = xy
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < 1e-9:
            return
        wb = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        wc = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
        wa = 1 - wb - wc
        inside = (wa >= -1e-6) & (wb >= -1e-6) & (wc >= -1e-6)
        w = np.stack([wa[inside], wb[inside], wc[inside]], 1).astype(np.float32)
        self.place[y[inside], x[inside]] = w @ points
        self.normal[y[inside], x[inside]] = w @ normals
        self.region[y[inside], x[inside]] = index

    def is_in(self, *names):
        """Texels whose region's name begins with one of `names`."""
        chosen = [i for i, name in enumerate(self.names) if name.startswith(names)]
        return np.isin(self.region, chosen)

    def bleed(self, picture, steps=12):
        """Spreads an image (size x size x n) beyond the islands' edges, so that coarser versions stay clean."""
        picture, known = picture.copy(), self.mask.copy()
        for _ in range(steps):
            total, count = np.zeros_like(picture), np.zeros(known.shape, np.float32)
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    k = np.roll(known, (dy, dx), (0, 1))
                    total += np.roll(picture, (dy, dx), (0, 1)) * k[..., None]
                    count += k
            new = ~known & (count > 0)
            picture[new] = total[new] / count[new][:, None]
            known |= new
        return picture


def read_curves(path):
    """Named curves of landmarks.json, left side, mm."""
    data = json.loads(Path(path).read_text())
    return {curve["name"]: np.array(curve["points"]) for curve in data["curves"]}


def read_landmarks(path):
    data = json.loads(Path(path).read_text())
    return {one["name"]: np.array(one["skin"]) for one in data["landmarks"] if one.get("skin")}
