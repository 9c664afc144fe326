"""Planar sections of a triangle surface, as chained polylines with normals."""
import numpy as np


def vertex_normals(vertices, triangles):
    """Area-weighted unit normals, (N, 3)."""
    corners = vertices[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, triangles[:, k], face)
    return normals / (np.linalg.norm(normals, axis=1, keepdims=True) + 1e-300)


def section(vertices, triangles, normals, origin, plane_normal):
    """Cut the surface by the plane through `origin`. Returns a list of (points (M, 3), normals (M, 3), closed)."""
    distance = (vertices - origin) @ plane_normal
    # A vertex exactly on the plane would give zero-length segments.
    distance = np.where(np.abs(distance) < 1e-7, 1e-7, distance)
    above = distance > 0
    cut = np.where(above[triangles].any(1) & ~above[triangles].all(1))[0]
    points, key_of, segments = [], {}, []

    def crossing(a, b):
        key = (min(a, b), max(a, b))
        if key not in key_of:
            t = distance[key[0]] / (distance[key[0]] - distance[key[1]])
            p = vertices[key[0]] * (1 - t) + vertices[key[1]] * t
            n = normals[key[0]] * (1 - t) + normals[key[1]] * t
            key_of[key] = len(points)
            points.append(np.r_[p, n / (np.linalg.norm(n) + 1e-300)])
        return key_of[key]

    for t in triangles[cut]:
        ends = [crossing(t[k], t[(k + 1) % 3]) for k in range(3) if above[t[k]] != above[t[(k + 1) % 3]]]
        if len(ends) == 2:
            segments.append(ends)
    if not points:
        return []
    points = np.array(points)
    neighbours = [[] for _ in points]
    for a, b in segments:
        neighbours[a].append(b)
        neighbours[b].append(a)
    used, chains = np.zeros(len(points), bool), []
    starts = [i for i, n in enumerate(neighbours) if len(n) == 1] + list(range(len(points)))
    for start in starts:
        if used[start]:
            continue
        chain, here = [start], start
        used[start] = True
        while True:
            onward = [n for n in neighbours[here] if not used[n]]
            if not onward:
                break
            here = onward[0]
            used[here] = True
            chain.append(here)
        closed = len(chain) > 2 and chain[0] in neighbours[chain[-1]]
        chains.append((points[chain, :3], points[chain, 3:], closed))
    return chains


def resample(points, spacing, normals=None):
    """Points every `spacing` along a polyline, ends kept. Returns (M, 3) or with normals (M, 6)."""
    data = points if normals is None else np.hstack([points, normals])
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    count = max(1, int(round(length[-1] / spacing)))
    at = np.linspace(0, length[-1], count + 1)
    out = np.stack([np.interp(at, length, data[:, k]) for k in range(data.shape[1])], 1)
    if normals is not None:
        out[:, 3:] /= np.linalg.norm(out[:, 3:], axis=1, keepdims=True) + 1e-300
    return out


def walk_inward(vertices, triangles, normals, seed, origin, axis, length):
    """The section by the plane that holds `seed`, `origin` and the direction `axis`, followed from the surface
    point nearest `seed` towards `origin` for `length`. Returns points (M, 3) from the seed inward."""
    across = np.cross(origin - seed, axis)
    across /= np.linalg.norm(across)
    best = None
    for points, _, closed in section(vertices, triangles, normals, seed, across):
        near = np.argmin(np.linalg.norm(points - seed, axis=1))
        gap = np.linalg.norm(points[near] - seed)
        if best is None or gap < best[0]:
            best = (gap, points, near, closed)
    _, points, near, closed = best
    order = np.roll(points, -near, axis=0) if closed else points
    ways = [order, np.roll(order[::-1], 1, axis=0)] if closed else [points[near:], points[near::-1]]
    inward = (origin - seed) / np.linalg.norm(origin - seed)

    def heading(way):
        return np.mean([(p - way[0]) @ inward for p in way[1:6]]) if len(way) > 1 else -1e9
    way = max(ways, key=heading)
    along = np.r_[0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))]
    return way[along <= length]
