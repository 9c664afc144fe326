#!/usr/bin/env python3
"""A first hour with Fascia in Python: tutorial.py RIG.glb FOLDER draws its figures into FOLDER.

Make a rig by `fascia build HEAD -o rig.glb`, or take out/rig.glb of scripts/demo.sh.
"""
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import fascia

rig, folder = sys.argv[1], Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)

# --- A rig, and what is in it
asset = fascia.load(rig)
names = [channel["name"] for channel in asset.channels]
print(f"{len(names)} channels, vocabularies {', '.join(asset.sets)}, levels {', '.join(asset.levels)}")

# --- A pose. A head's skin may be cut into several meshes: here they are one array.
face = fascia.Face(asset, level=0, space="metres")
skins = [i for i, mesh in enumerate(asset.meshes) if mesh["part"] == "skin"]


def where():
    return np.concatenate([face.positions(i) for i in skins])  # each a view, without a copy


def by_mesh(vectors):
    ends = np.cumsum([asset.meshes[i]["vertex_count"] for i in skins])[:-1]
    return dict(zip(skins, np.split(vectors, ends)))


rest = where()


def pose(**values):
    """How far each vertex moves under members of the ARKit set, metres."""
    face.clear()
    for name, value in values.items():
        face.set("arkit:" + name, value)
    face.pose()
    return where() - rest


def draw(axes, values, title, limit):
    shown = rest[:, 2] > np.quantile(rest[:, 2], 0.45)
    picture = axes.scatter(rest[shown, 0] * 100, rest[shown, 1] * 100, c=values[shown] * 1000, s=2, cmap="magma", vmin=0, vmax=limit)
    axes.set(title=title, aspect="equal", xticks=[], yticks=[])
    return picture


poses = {"smile": dict(mouthSmileLeft=1, mouthSmileRight=1), "jaw open": dict(jawOpen=1), "brows up": dict(browInnerUp=1, browOuterUpLeft=1, browOuterUpRight=1)}
figure, all_axes = plt.subplots(1, 3, figsize=(10, 4.2), layout="constrained")
for axes, (title, values) in zip(all_axes, poses.items()):
    picture = draw(axes, np.linalg.norm(pose(**values), axis=1), title, 12)
figure.colorbar(picture, ax=all_axes, label="motion, mm", shrink=0.8)
figure.savefig(folder / "poses.png", dpi=110)

# --- Time: a smile comes and goes, and the tissue follows with its own inertia.
face.clear()
face.reset()
corner = int(np.argmax(np.linalg.norm(pose(mouthSmileLeft=1), axis=1)))
face.clear()
face.reset()
times, heights, drive, spent = np.arange(0, 1.5, 1 / 120), [], [], 0.0
for moment in times:
    value = float(0.2 < moment < 0.8)
    face.set("arkit:mouthSmileLeft", value)
    before = time.perf_counter()
    face.step(1 / 120)
    spent += time.perf_counter() - before
    drive.append(value)
    heights.append((where()[corner, 1] - rest[corner, 1]) * 1000)
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.plot(times, heights, label="corner of the mouth, mm up")
axes.plot(times, np.array(drive) * max(heights), "--", color="grey", label="what drives it")
axes.set(xlabel="seconds")
axes.legend()
figure.savefig(folder / "time.png", dpi=110)
print(f"a step of 1/120 s takes {spent / len(times) * 1000:.1f} ms")

# --- Derivatives: which muscles raise the left corner of the mouth?
face.clear()
face.pose()
slopes = np.zeros_like(rest)
slopes[corner, 1] = 1
before = time.perf_counter()
by_channel = face.gradient(by_mesh(slopes))
print(f"the derivative by all {len(names)} channels takes {(time.perf_counter() - before) * 1000:.0f} ms")
order = np.argsort(-np.abs(by_channel))[:12][::-1]
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.barh([names[i] for i in order], by_channel[order] * 1000)
axes.set(xlabel="mm upward a unit of activation, at rest", title="the left corner of the mouth")
figure.savefig(folder / "gradient.png", dpi=110)

# --- An activation found by descent: what made this face?
target = (rest + pose(mouthSmileLeft=0.7, browInnerUp=0.5)).copy()
face.clear()
values, losses = face.values, []  # a view too: writing to it drives the face
muscles = np.array([channel["group"] == "muscle" for channel in asset.channels])
low = np.array([channel["minimum"] for channel in asset.channels])
high = np.array([channel["maximum"] for channel in asset.channels])
step = None
for _ in range(25):
    face.pose()
    difference = where() - target
    losses.append(float(np.sqrt((difference**2).sum(axis=1).mean())) * 1000)
    slope = face.gradient(by_mesh(2 * difference)) * muscles
    if step is None:
        step = 0.25 / np.abs(slope).max()
    elif losses[-1] > losses[-2]:
        step *= 0.5
    values[:] = np.clip(values - step * slope, low, high)
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.plot(losses)
axes.set(xlabel="iteration", ylabel="mm (root mean square)", ylim=(0, None), title="descent on the muscles towards a target")
figure.savefig(folder / "descent.png", dpi=110)
print(f"descent: {losses[0]:.2f} mm to {min(losses):.2f} mm")
