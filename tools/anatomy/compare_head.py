#!/usr/bin/env python3
"""Distance of the generic head to the ICT mean face, by region.

    compare_head.py PATH/ict_model.npz anatomy/data/head.obj

Points all over our faces to the closest point of the reference's skin (no alignment: both are in one frame), mm.
"""
import sys

import numpy as np
from scipy.spatial import cKDTree


def read_skin(path):
    vertices, faces, regions, mesh, region = [], [], [], None, None
    for line in open(path):
        word = line.split()
        if not word:
            continue
        if word[0] == 'v':
            vertices.append([float(c) for c in word[1:4]])
        elif word[0] == 'o':
            mesh = word[1]
        elif word[0] == 'g':
            region = word[1]
        elif word[0] == 'f' and mesh == 'skin':
            corner = [int(w.split('/')[0]) - 1 for w in word[1:]]
            for k in range(1, len(corner) - 1):
                faces.append((corner[0], corner[k], corner[k + 1]))
                regions.append(region)
    return np.array(vertices), np.array(faces), np.array(regions)


def spread(vertices, triangles, n):
    weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
    return np.einsum('wk,tkc->twc', weights, vertices[triangles])


def main(model_path, obj_path):
    model = np.load(model_path)
    points = model['base'].astype(float) * 10
    triangles = model['tri'][(model['tri'] < 14062).all(1)]
    cloud = spread(points, triangles, 6).reshape(-1, 3)
    tree = cKDTree(cloud)
    vertices, faces, regions = read_skin(obj_path)
    samples = spread(vertices, faces, 3)
    corners = vertices[faces]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    gap = tree.query(samples.reshape(-1, 3))[0].reshape(len(faces), -1)
    inside = ('mouth_lining', 'conjunctiva_left', 'conjunctiva_right', 'nostril_left', 'nostril_right')
    beyond = ('neck', 'scalp', 'submental', 'ear_left', 'ear_right')

    def report(name, chosen):
        mean = (gap[chosen].mean(1) * area[chosen]).sum() / area[chosen].sum()
        print(f'{name:24s} mean {mean:6.2f}  95 % {np.percentile(gap[chosen], 95):6.2f}  worst {gap[chosen].max():6.2f} mm')
    for name in sorted(set(regions)):
        if not name.endswith('_right'):
            report(name, regions == name)
    report('face, front of the ears', ~np.isin(regions, inside + beyond))
    report('outer skin', ~np.isin(regions, inside))


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
