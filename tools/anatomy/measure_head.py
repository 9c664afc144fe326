#!/usr/bin/env python3
"""Measure the figures of the generic head from the USC ICT-FaceKit mean face.

    measure_head.py PATH/ict_model.npz anatomy/figures

writes head_sections.csv (planar section profiles of the outer surface), head_profiles.csv (fans of section profiles
around eye, mouth, nostril and ear, with the anatomical points named on them) and head_figures.json (landmarks, eyeball,
dental arch, depth of the mouth). Left half only, symmetrised, millimetres, the frame of the ICT mean head:
+X the subject's left, +Y up, +Z front.
"""
import json
import os
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from sections import resample, section, vertex_normals, walk_inward

SOURCE = ('# Measured from the mean face of ICT-FaceKit (c) 2020 USC Institute for Creative Technologies, MIT licence '
          '(Li et al. 2020, Learning Formation of Physically-Based Face Attributes, CVPR).\n'
          '# Millimetres; +X subject\'s left, +Y up, +Z front; left half, symmetrised. Written by tools/anatomy/measure_head.py.\n')
SKIN, WHOLE = 11248, 14062  # original indices: outer skin ends, mouth and eye sockets end
UP, FRONT, LEFT = np.eye(3)[1], np.eye(3)[2], np.eye(3)[0]


def symmetrised(points):
    """The mean of a point set and its mirror image; partners by closest point (the model is symmetric to 0.06 mm)."""
    mirrored = points * [-1, 1, 1]
    return 0.5 * (points + mirrored[cKDTree(mirrored).query(points)[1]])


class Reference:
    def __init__(self, path):
        model = np.load(path)
        self.all = model['base'].astype(float) * 10
        self.vertices = symmetrised(self.all[:WHOLE])
        triangles = model['tri']
        self.triangles = triangles[(triangles < WHOLE).all(1)]
        self.outer = triangles[(triangles < SKIN).all(1)]
        self.normals = vertex_normals(self.vertices, self.triangles)

    def walk(self, seed, origin, axis, length):
        return walk_inward(self.vertices, self.triangles, self.normals, seed, origin, axis, length)

    def highest(self, u, v, along, reach=4.0, above=None):
        """Height along unit axis index `along` of the outer surface over (u, v) of the two other axes."""
        others = [k for k in range(3) if k != along]
        points = self.vertices[:SKIN]
        near = np.hypot(points[:, others[0]] - u, points[:, others[1]] - v) < reach
        if above is not None:
            near &= above(points)
        return points[near, along].max()


# --- the outer surface ------------------------------------------------------------------------------------------

def inside_ear(p):
    return (p[:, 0] > 55) & (((p[:, 2] - 0) / 24) ** 2 + ((p[:, 1] - 6) / 36) ** 2 < 1)


def inside_nostril(p, n):
    return (np.linalg.norm(p - [8.5, -2, 111], axis=1) < 8) & (n[:, 1] * -0.8 + n[:, 2] * 0.5 < 0.1)


def outer_sections(reference):
    rows = []

    def add(axis, at, spacing, keep):
        for points, normals, _ in section(reference.vertices, reference.outer, reference.normals, axis * at, axis):
            line = resample(points, spacing, normals)
            line = line[keep(line[:, :3]) & (line[:, 0] > -1e-6) & (line[:, 1] > -150)]
            line = line[~inside_ear(line[:, :3]) & ~inside_nostril(line[:, :3], line[:, 3:])]
            rows.extend((axis.argmax(), at, *row) for row in line)

    def face(p):
        return (p[:, 2] > 78) & (p[:, 1] > -82) & (p[:, 1] < 68) & (p[:, 0] < 62)

    def nose_and_lips(p):
        return (p[:, 2] > 95) & (p[:, 1] > -52) & (p[:, 1] < 32) & (p[:, 0] < 26)

    for lower, step, spacing, keep in ((-149.5, 6.0, 5.0, lambda p: ~face(p)),
                                       (-81.5, 3.0, 2.5, lambda p: face(p) & ~nose_and_lips(p)),
                                       (-52.0, 2.0, 1.7, nose_and_lips)):
        for y in np.arange(lower, 145, step):
            add(UP, y, spacing, keep)
        for x in np.arange(step / 4, 100, step):
            add(LEFT, x, spacing, keep)
    return rows


# --- fans of profiles -------------------------------------------------------------------------------------------

def eye_fan(reference, count=32):
    """From the orbital rim inward over lid and lid margin into the conjunctival sac; index 0 is medial, then upward."""
    for i in range(count):
        t = np.pi - 2 * np.pi * i / count
        seed = np.array([32.8 + 21.0 * np.cos(t), 36.5 + (16.5 if np.sin(t) > 0 else 15.5) * np.sin(t), 0])
        origin = np.array([32 + 8.5 * np.cos(t), 34.4 + 0.6 * np.cos(t), 0])
        seed[2] = origin[2] = reference.highest(seed[0], seed[1], 2, 2.5)
        line = resample(reference.walk(seed, origin, FRONT, 34), 0.4)
        outward = (seed - origin) / np.linalg.norm(seed - origin)
        radius = (line - origin) @ outward
        front = int(np.argmax(np.where(np.arange(len(line)) > 10, line[:60, 2].max() == line[:, 2], False)))
        front = max(front, int(np.argmin(np.abs(radius - 8.0))))
        near = np.arange(len(line)) <= front + 14
        shallow = line[:, 2] > line[front, 2] - 4.0
        inner = int(np.argmin(np.where(near & shallow, radius, 1e9)))
        outside = max(0, inner - 12)
        chord = line[inner] - line[outside]
        away = np.linalg.norm(np.cross(line[outside:inner + 1] - line[outside], chord), axis=1)
        outer = outside + int(np.argmax(away))
        yield line, {outer: 'margin_outer', inner: 'margin_inner'}


def lip_border(landmarks):
    """The vermilion border as polylines (x, y): upper and lower, midline to cheilion."""
    upper = np.array([landmarks[k] for k in ('labiale_superius', 'crista_philtri_left', 'lip_upper_left', 'cheilion_left')])
    lower = np.array([landmarks[k] for k in ('labiale_inferius', 'lip_lower_medial_left', 'lip_lower_left', 'cheilion_left')])
    at = np.linspace(0, 1, 60)

    def fine(points):
        s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
        return CubicSpline(s / s[-1], points, bc_type='natural')(at)
    return fine(upper), fine(lower)


def mouth_fan(reference, landmarks, intervals=24):
    """From the skin around the lips over the vermilion to the lining; index 0 upper midline, last lower midline."""
    borders = lip_border(landmarks)
    for i in range(intervals + 1):
        t = np.pi / 2 - np.pi * i / intervals
        c, s = np.cos(t), np.sin(t)
        seed = np.array([31.0 * abs(c) ** 0.9, -35.0 + (13.0 if s > 0 else 15.0) * s, 0])
        origin = np.array([min(0.70 * seed[0], 19.5), -33.6 - 1.0 * c, 0])
        seed[2] = origin[2] = reference.highest(seed[0], seed[1], 2, 2.0)
        if i in (0, intervals):
            origin[0] = 0
        if i == intervals // 2:
            corner, inner = np.array(landmarks['cheilion_left']), np.array(landmarks['cheilion_inner_left'])
            line = reference.walk(seed, corner, FRONT, 40)
            line = line[:np.argmin(np.linalg.norm(line - corner, axis=1)) + 1]
            line = resample(np.vstack([line, inner]), 0.6)
            yield line, {int(np.argmin(np.linalg.norm(line - corner, axis=1))): 'vermilion_border', len(line) - 1: 'contact'}
            continue
        line = resample(reference.walk(seed, origin, FRONT, 40), 0.6)
        outward = (seed - origin) / np.linalg.norm(seed - origin)
        radius = (line - origin) @ outward
        contact = int(np.argmin(radius))
        border = borders[0] if s > 0 else borders[1]
        gap = cKDTree(border).query(line)[0]
        yield line, {int(np.argmin(gap[:max(contact, 2)])): 'vermilion_border', contact: 'contact'}


def nostril_fan(reference, count=16):
    """From outside the rim into the cavity; index 0 in front (apex), then lateral, sill, columella."""
    axis = np.array([0.22, -0.80, 0.55])
    axis /= np.linalg.norm(axis)
    centre = np.array([8.6, -4.4, 114.0])
    forward = np.array([-0.45, 0.45, 0.80])
    forward -= axis * (forward @ axis)
    forward /= np.linalg.norm(forward)
    lateral = np.cross(forward, axis)
    lateral *= np.sign(lateral[0])
    for i in range(count):
        t = 2 * np.pi * i / count
        direction = forward * np.cos(t) + lateral * np.sin(t)
        across = np.cross(direction, axis)
        best = None
        for points, normals, closed in section(reference.vertices, reference.triangles, reference.normals, centre, across):
            if closed:
                points, normals = np.vstack([points] * 3), np.vstack([normals] * 3)
            radius, height = (points - centre) @ direction, (points - centre) @ axis
            start = np.argmin(np.hypot(radius - 3, height + 5) + 100 * (radius < 0.3))
            gap = np.hypot(radius[start] - 3, height[start] + 5)
            if closed:
                start += len(points) // 3
            if best is None or gap < best[0]:
                best = (gap, points, normals, start)
        _, points, normals, start = best
        ways = [slice(start, None), slice(start, None, -1)]
        ways = [w for w in ways if len(points[w]) > 3]
        out = max(ways, key=lambda w: ((points[w] - points[start]) @ axis)[:8].mean())
        inward = [w for w in ways if w is not out]
        line, facing = points[out], normals[out] @ axis
        along = np.r_[0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
        near = along < 13
        rim = int(np.argmax(near & (facing > 0.5))) if (near & (facing > 0.5)).any() else int(np.argmax(np.where(near, facing, -2)))
        head = line[along <= along[rim] + 1.9]
        deep = points[inward[0]][1:] if inward else points[:0]
        keep = np.cumsum(np.linalg.norm(np.diff(np.vstack([points[start], deep]), axis=0), axis=1)) < 6.0
        whole = np.vstack([head[::-1], deep[keep]])
        profile = resample(whole, 0.5)
        mark = int(np.argmin(np.linalg.norm(profile - line[rim], axis=1)))
        yield profile, {mark: 'rim'}


def ear_fan(reference, count=32):
    """From the head over the back of the ear, the helix and the antihelix into the concha; index 0 in front, then upward."""
    tilt = np.radians(12)
    along, upward = np.array([0, np.sin(tilt), np.cos(tilt)]), np.array([0, np.cos(tilt), -np.sin(tilt)])
    for i in range(count):
        t = 2 * np.pi * i / count
        seed = np.array([0, 6.0, 1.0]) + along * 23.0 * np.cos(t) + upward * 37.0 * np.sin(t)
        origin = np.array([0, 7.0, 4.0]) + upward * 7.0 * np.sin(t)
        points = reference.vertices[:SKIN]
        near = (np.hypot(points[:, 2] - seed[2], points[:, 1] - seed[1]) < 4) & (points[:, 0] > 0)
        seed[0] = origin[0] = points[near, 0].min()
        line = reference.walk(seed, origin, LEFT, 130)
        outward = (seed - origin) / np.linalg.norm(seed - origin)
        radius = (line - origin) @ outward
        beyond = np.where(radius < 0.8)[0]
        line = resample(line[:beyond[0] + 1] if len(beyond) else line, 0.8)
        height = line[:, 0]
        crest = len(line) // 2
        for k in range(2, len(line) - 3):
            if height[k] == height[max(0, k - 6):k + 7].max() and height[k] - height[k:].min() > 1.5 and height[k] - height[:k].min() > 2:
                crest = k
                break
        yield line, {crest: 'crest'}


# --- landmarks and organs ---------------------------------------------------------------------------------------

MULTI_PIE = {  # numbers of the 68-point scheme (from 0); the subject's left
    'nasion_soft': 27, 'rhinion_soft': 29, 'pronasale': 30, 'subnasale': 33, 'subalare_left': 35,
    'endocanthion_left': 42, 'palpebra_upper_medial_left': 43, 'palpebra_upper_lateral_left': 44, 'exocanthion_left': 45,
    'palpebra_lower_lateral_left': 46, 'palpebra_lower_medial_left': 47, 'brow_medial_left': 22, 'brow_2_left': 23,
    'brow_3_left': 24, 'brow_4_left': 25, 'brow_lateral_left': 26, 'labiale_superius': 51, 'crista_philtri_left': 52,
    'lip_upper_left': 53, 'cheilion_left': 54, 'lip_lower_left': 55, 'lip_lower_medial_left': 56, 'labiale_inferius': 57,
    'cheilion_inner_left': 64, 'stomion_superius': 62, 'stomion_inferius': 66, 'menton_soft': 8, 'jaw_angle_left': 12,
    'zygion_soft_left': 16}


def landmarks_of(reference, folder):
    with open(os.path.join(folder, 'landmarks68.json')) as file:
        indices = json.load(file)['multi_pie_68_vertex_indices']
    out = {name: reference.all[indices[number]].copy() for name, number in MULTI_PIE.items()}
    for name, point in out.items():
        if not name.endswith('_left'):
            point[0] = 0.0
    return {name: [round(float(c), 2) for c in point] for name, point in out.items()}


def sphere(points):
    system = np.c_[2 * points, np.ones(len(points))]
    solution = np.linalg.lstsq(system, (points ** 2).sum(1), rcond=None)[0]
    return solution[:3], float(np.sqrt(solution[3] + solution[:3] @ solution[:3]))


def organs(reference):
    eye = reference.all[21451:22221]
    globe, radius = sphere(eye[eye[:, 2] < np.percentile(eye[:, 2], 60)])
    teeth = reference.all[17039:21451]
    sac = reference.all[11248:13294]
    slices = []
    for z in range(10, 108, 8):
        near = np.abs(sac[:, 2] - z) < 5
        if near.sum() > 6:
            p = sac[near]
            slices.append([z, *(round(float(c), 2) for c in (p[:, 0].max(), p[:, 1].min(), p[:, 1].max()))])
    return {
        'eyeball': {'centre_left': [round(float(c), 2) for c in globe], 'radius': round(radius, 2),
                    'cornea_front': round(float(eye[:, 2].max()), 2)},
        'teeth': {'lower': [round(float(c), 2) for c in teeth.min(0)], 'upper': [round(float(c), 2) for c in teeth.max(0)]},
        'mouth_slices_z_halfwidth_bottom_top': slices}


def write_rows(path, header, rows):
    with open(path, 'w') as file:
        file.write(SOURCE + header + '\n')
        for row in rows:
            file.write(','.join(c if isinstance(c, str) else f'{c:.2f}'.rstrip('0').rstrip('.') for c in row) + '\n')


def main(model, folder):
    reference = Reference(model)
    landmarks = landmarks_of(reference, os.path.dirname(model))
    write_rows(os.path.join(folder, 'head_sections.csv'), 'axis,at,x,y,z,nx,ny,nz', outer_sections(reference))
    fans = {'eye': eye_fan(reference), 'mouth': mouth_fan(reference, landmarks), 'nostril': nostril_fan(reference),
            'ear': ear_fan(reference)}
    rows = [(organ, str(i), *point, marks.get(k, ''))
            for organ, fan in fans.items() for i, (line, marks) in enumerate(fan) for k, point in enumerate(line)]
    write_rows(os.path.join(folder, 'head_profiles.csv'), 'organ,profile,x,y,z,mark', rows)
    figures = {'source': SOURCE.replace('# ', '').strip(), 'landmarks': landmarks, **organs(reference)}
    with open(os.path.join(folder, 'head_figures.json'), 'w') as file:
        json.dump(figures, file, indent=1)
        file.write('\n')


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
