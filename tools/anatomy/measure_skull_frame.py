#!/usr/bin/env python3
"""Pairs points of the measured skull with where they lie in the generic head.

    measure_skull_frame.py HEAD.obj anatomy

HEAD.obj is the skin of the ICT FaceKit's mean head (metres, +Y up, +Z front), (c) USC Institute for
Creative Technologies, MIT licence. Reads data/landmarks.json, figures/bodyparts3d_landmarks.csv and
figures/skull_cranium_sections.csv below the second argument; writes figures/skull_frame.csv:
name, source point (frame of the sections), target (frame of the landmarks), standard deviation, all mm.

Landmarks with a tissue depth are paired by name. The vault, where the table has only two, follows the
skin: points of the sections spread over it go to the skin's nearest point less a scalp of 5 to 6 mm,
found again after each fit until they rest.
"""
import csv
import json
import os
import sys

import numpy as np
from scipy.spatial import cKDTree

MIDPLANE, ORIGIN_HEIGHT = -0.65, 1500.0
SOURCE = ("Source: BodyParts3D, (c) The Database Center for Life Science, CC BY 4.0. Target: mean head of the "
          "ICT FaceKit, (c) USC Institute for Creative Technologies, MIT, less the tissue depths of Hona & "
          "Stephan 2024. Written by tools/anatomy/measure_skull_frame.py.")


def read_skin(path):
    vertices, triangles = [], []
    for line in open(path):
        if line.startswith("v "):
            vertices.append([float(t) for t in line.split()[1:4]])
        elif line.startswith("f "):
            corner = [int(t.split("/")[0]) - 1 for t in line.split()[1:]]
            triangles += [[corner[0], corner[k], corner[k + 1]] for k in range(1, len(corner) - 1)]
    v, f = np.array(vertices) * 1000, np.array(triangles)
    weights = np.array([(i / 4, j / 4) for i in range(5) for j in range(5 - i)])
    weights = np.c_[1 - weights.sum(1), weights]
    points = np.einsum("gb,tbc->tgc", weights, v[f]).reshape(-1, 3)
    face = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    normal = np.zeros_like(v)
    for k in range(3):
        np.add.at(normal, f[:, k], face)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-12
    normals = np.einsum("gb,tbc->tgc", weights, normal[f]).reshape(-1, 3)
    return points, normals / (np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12)


def thin_plate(source, target, deviation, smoothing):
    """x -> x + u(x), u a thin-plate spline in space that misses each target by about its deviation."""
    r = np.linalg.norm(source[:, None] - source[None], axis=2)
    p = np.c_[np.ones(len(source)), source]
    n = len(source)
    system = np.block([[-r + smoothing * np.diag(deviation ** 2), p], [p.T, np.zeros((4, 4))]])
    c = np.linalg.solve(system, np.r_[target - source, np.zeros((4, 3))])
    return lambda x: x + -np.linalg.norm(x[:, None] - source[None], axis=2) @ c[:n] + np.c_[np.ones(len(x)), x] @ c[n:]


SMOOTHING = 4.0  # of the warp; make_skull uses the same


def both_sides(source, target, deviation):
    side = source[:, 0] > 0
    flip = np.array([-1, 1, 1])
    return (np.r_[source, source[side] * flip], np.r_[target, target[side] * flip], np.r_[deviation, deviation[side]])


def landmark_pairs(folder):
    measured = {}
    for row in csv.reader(line for line in open(os.path.join(folder, "figures/bodyparts3d_landmarks.csv")) if line[0] != "#"):
        if row[0] != "name":
            x, y, z = map(float, row[1:])
            measured[row[0]] = np.array([x - MIDPLANE, z - ORIGIN_HEIGHT, -y])
    sd = {}
    depths = json.load(open(os.path.join(folder, "data/landmarks.json")))["landmarks"]
    for mark in depths:
        name = mark["name"]
        if mark.get("bone_source") != "depth" or name.endswith("_right") or name not in measured:
            continue
        source = measured[name]
        if name.endswith("_left"):
            right = measured[name[:-5] + "_right"] * [-1, 1, 1] if name[:-5] + "_right" in measured else source
            source = (source + right) / 2
        yield name, source, np.array(mark["bone"])


DEVIATION = {"glabella": 0.5, "nasion": 0.8, "mid_nasal": 0.8, "rhinion": 0.3,
             "mid_infraorbital": 0.4}


def vault_points(sections):
    """Sparse, even points of the vault above the temporal fossa, midline first."""
    p = sections[(sections[:, 1] > 70) | ((sections[:, 2] < 45) & (sections[:, 1] > 15))]
    p = p[np.argsort(p[:, 0], kind="stable")]
    kept = []
    for q in p:
        if all(np.linalg.norm(q - k) > 24 for k in kept) and (q[0] == 0 or q[0] > 10):
            kept.append(q)
    return np.array(kept)


def read_sections(path):
    return np.array([[float(t) for t in row] for row in csv.reader(line for line in open(path) if line[0] not in "#a")])


def onto_sections(points, sections):
    """Each point on the plane of its nearest section point, when that is within 3 mm: the sections' solid
    rounds thin edges such as the tip of the nasal bones, and it is the solid that is to fit."""
    distance, i = cKDTree(sections[:, 2:5]).query(points)
    normal = sections[i, 5:8]
    offset = ((sections[i, 2:5] - points) * normal).sum(1)
    return points + np.where(distance < 3, offset, 0)[:, None] * normal


def main(head, folder):
    points, normals = read_skin(head)
    use = points[:, 1] > -40
    points, normals = points[use], normals[use]
    tree = cKDTree(points)
    names, source, target = zip(*landmark_pairs(folder))
    source, target = np.array(source), np.array(target)
    for a in (source, target):
        a[[not n.endswith("_left") for n in names], 0] = 0
    deviation = np.array([DEVIATION.get(n[:-5] if n.endswith("_left") else n, 1.0) for n in names])
    rows = read_sections(os.path.join(folder, "figures/skull_cranium_sections.csv"))
    jaw = read_sections(os.path.join(folder, "figures/skull_mandible_sections.csv"))
    source = onto_sections(source, np.r_[rows, jaw])
    source[target[:, 0] == 0, 0] = 0
    vault = vault_points(rows[:, 2:5])
    warp = thin_plate(*both_sides(source, target, deviation), SMOOTHING)
    for _ in range(6):
        at = warp(vault)
        _, i = tree.query(at)
        # A scalp of 5 mm at the top, 6 mm at the back.
        depth = np.where(at[:, 2] < -40, 6.0, 5.2)
        goal = at + normals[i] * (((points[i] - at) * normals[i]).sum(1) - depth)[:, None]
        goal[vault[:, 0] == 0, 0] = 0
        warp = thin_plate(*both_sides(np.r_[source, vault], np.r_[target, goal], np.r_[deviation, np.full(len(vault), 0.5)]), SMOOTHING)
    with open(os.path.join(folder, "figures/skull_frame.csv"), "w", newline="\n") as out:
        out.write(f"# Points of the measured skull and where they lie in the generic head.\n# {SOURCE}\n"
                  "# Millimetres; +X subject's left, +Y up, +Z front; left side and midline.\n"
                  "name,source_x,source_y,source_z,target_x,target_y,target_z,deviation\n")
        for k, (s, t, d) in enumerate(zip(np.r_[source, vault], np.r_[target, goal], np.r_[deviation, np.full(len(vault), 0.5)])):
            name = names[k] if k < len(names) else f"vault_{k - len(names) + 1}"
            out.write(name + "," + ",".join(f"{x + 0.0:.2f}" for x in [*s, *t, d]) + "\n")
    fitted = warp(np.r_[source, vault])
    for k, miss in enumerate(np.linalg.norm(fitted - np.r_[target, goal], axis=1)):
        print(f"{names[k] if k < len(names) else 'vault'} {miss:.2f}")
    bone = warp(rows[:, 2:5])
    _, i = tree.query(bone)
    inside = -((bone - points[i]) * normals[i]).sum(1)
    print("least cover", np.sort(inside)[:10].round(2))
    for k in np.argsort(inside)[:40:4]:
        print(bone[k].round(1), inside[k].round(2))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
