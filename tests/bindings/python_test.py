#!/usr/bin/env python3
"""The Python module on a rig: python_test.py RIG.glb, with the module on PYTHONPATH. Exits 1 at the first failure."""
import gc
import sys

import numpy as np

import fascia

asset = fascia.load(sys.argv[1])
names = [channel["name"] for channel in asset.channels]
assert len(names) > 3 and len(set(names)) == len(names)
skin = next(i for i, mesh in enumerate(asset.meshes) if mesh["part"] == "skin")
triangles = asset.meshes[skin]["triangles"]
assert triangles.shape[1] == 3 and triangles.max() < asset.meshes[skin]["vertex_count"]

face = fascia.Face(asset, space="metres")
positions = face.positions(skin)
assert positions.dtype == np.float32 and positions.shape == (asset.meshes[skin]["vertex_count"], 3)
assert not positions.flags.writeable and not positions.flags.owndata  # a view
rest = positions.copy()
values = face.values
assert values.flags.writeable and not values.flags.owndata
muscle = next(i for i, channel in enumerate(asset.channels) if channel["group"] == "muscle")
values[muscle] = 0.6
face.pose()
assert np.abs(positions - rest).max() > 1e-4  # the same view shows the pose
assert face.effective_values[muscle] == np.float32(0.6)
assert np.allclose(np.linalg.norm(face.normals(skin), axis=1), 1, atol=1e-3)

# The derivative of a pose against a difference.
slopes = np.zeros_like(rest)
moved = int(np.argmax(np.linalg.norm(positions - rest, axis=1)))
slopes[moved] = 1
gradient = face.gradient({skin: slopes})
step = 0.05
sums = []
for sign in (1, -1):
    values[muscle] = 0.6 + sign * step
    face.pose()
    sums.append(float(positions[moved].astype(float).sum()))
difference = (sums[0] - sums[1]) / (2 * step)
assert abs(gradient[muscle] - difference) < 0.1 * abs(difference) + 1e-5, (gradient[muscle], difference)

# A state goes on with the same bits.
values[muscle] = 0.3
for _ in range(5):
    assert face.step(1 / 60)
state = face.save()
face.step(1 / 60)
after = positions.copy()
face.restore(state)
face.step(1 / 60)
assert np.array_equal(positions, after)

energies = face.energies()
assert abs(energies["total"] - sum(value for name, value in energies.items() if name != "total")) < 1e-9
assert len(face.fibre_forces()) == len(asset.fibres(face.level)["muscles"])
assert face.nodes().shape == asset.lattice(face.level)["rest"].shape

# Views keep what they show alive.
kept = fascia.Face(asset, space="metres").positions(skin)
gc.collect()
assert np.array_equal(kept, rest)

curves = fascia.load_curves(b"time," + names[muscle].encode() + b"\n0,0\n1,1\n")
assert curves.duration == 1.0
face.clear()
face.apply(curves, 0.5)
face.pose()
assert abs(face.effective_values[muscle] - 0.5) < 1e-6

for wrong in (lambda: fascia.load(b"nothing"), lambda: face.set("no such thing", 1), lambda: face.positions(99),
              lambda: face.restore(state[:-1]), lambda: fascia.run("build", "/no/such/head.obj", "-o", "/tmp/none.glb")):
    try:
        wrong()
    except fascia.Error as error:
        assert str(error)
    else:
        raise AssertionError("no error")
print(f"python: fascia {fascia.version()}, {len(names)} channels, all passed")
