#!/usr/bin/env python3
"""The Python module on a rig: python_test.py RIG.glb [HEAD.glb STREAM.csv], with the module on PYTHONPATH. HEAD.glb has a whole
face, STREAM.csv landmarks of it (samples/capture). Exits 1 at the first failure."""
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

forces = face.node_forces()
assert forces.shape == face.nodes().shape and np.isfinite(forces).all()

# Members by index, and a loss's derivative by the one that matters most to it.
vocabulary = "arkit"
face.clear()
face.pose()
by_member = face.member_gradient(vocabulary, face.gradient({skin: slopes}))
assert by_member.shape == (len(asset.sets[vocabulary]),)
name = asset.sets[vocabulary][int(np.argmax(np.abs(by_member)))]
at, member = asset.find_member(f"{vocabulary}:{name}")
assert (list(asset.sets)[at], member) == (vocabulary, int(np.argmax(np.abs(by_member))))
face.set_member(at, member, 0.25)
assert face.get(f"{vocabulary}:{name}") == 0.25
face.pose()
gradient = face.gradient({skin: slopes})
by_member = face.member_gradient(vocabulary, gradient)
step = 0.01  # the jaw's turn is curved
sums = []
for sign in (1, -1):
    face.set_member(at, member, 0.25 + sign * step)
    face.pose()
    sums.append(float(positions[moved].astype(float).sum()))
difference = (sums[0] - sums[1]) / (2 * step)
assert abs(by_member[member] - difference) < 0.1 * abs(difference) + 1e-5, (by_member[member], difference)

# Layers.
face.clear()
mask = np.zeros(len(names))
mask[muscle] = 0.5
face.set_layer(1, "override", mask=mask)
assert not face.layer_values(1).flags.owndata
face.layer_values(1)[:] = 0.8
face.pose()
assert abs(face.effective_values[muscle] - 0.4) < 1e-6 and np.count_nonzero(face.effective_values) == 1
face.set_layer(1, "max")
face.layer_clear(1)
face.layer_set(1, names[muscle], 0.3)
face.pose()
assert abs(face.effective_values[muscle] - 0.3) < 1e-6
face.layer_clear(1)
face.layer_set_member(1, at, member, 0.5)
face.pose()
in_layer = face.effective_values.copy()
face.clear()
kept = face.layer_values(1)
face.layer_remove(1)
kept[:] = 0.9  # of no effect now
face.pose()
assert np.abs(in_layer).max() > 0 and not face.effective_values.any()
face.set_member(at, member, 0.5)
face.pose()
assert np.array_equal(face.effective_values, in_layer)

# The jaw, the head's motion, touches, tangents.
face.clear()
face.pose()
assert np.array_equal(face.jaw(), np.eye(4, dtype=np.float32))
face.set("jaw_open", 0.5)
face.pose()
jaw = face.jaw()
assert np.allclose(jaw[:3, :3] @ jaw[:3, :3].T, np.eye(3), atol=1e-5) and not np.array_equal(jaw, np.eye(4))
assert np.array_equal(jaw[3], [0, 0, 0, 1])
face.clear()
face.reset()
assert np.abs(positions - rest).max() < 1e-5
for frame in range(5):
    place = np.eye(4)
    place[0, 3] = 0.01 * frame ** 2  # along x: the last column
    face.move_head(place)
    face.step(1 / 60)
lag = (positions - rest).mean(0)
assert lag[0] < -1e-6 and abs(lag[0]) > abs(lag[1]), lag
fresh = fascia.Face(asset, space="metres")
fresh.touch(skin, moved, (0.0, 0.0, 0.2))
fresh.pose()
assert fresh.positions(skin)[moved, 2] > rest[moved, 2]
fresh.clear_touches()
fresh.set_acceleration((0.0, -9.81, 0.0))
fresh.pose()
assert (fresh.positions(skin) - rest)[:, 1].mean() < 0
texcoords, tangents = asset.texcoords(skin), face.tangents(skin)
assert texcoords.shape in ((len(rest), 2), (0, 2)) and tangents.shape in ((len(rest), 4), (0, 4))
if len(tangents):
    assert np.allclose(np.linalg.norm(tangents[:, :3], axis=1), 1, atol=1e-3) and (np.abs(tangents[:, 3]) == 1).all()

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

def expect_errors(*calls, says=""):
    for call in calls:
        try:
            call()
        except fascia.Error as error:
            assert str(error) and says in str(error)
        else:
            raise AssertionError("no error")

expect_errors(lambda: fascia.load(b"nothing"), lambda: face.set("no such thing", 1), lambda: face.positions(99),
              lambda: face.restore(state[:-1]), lambda: face.layer_values(1), lambda: face.layer_remove(1),
              lambda: face.set_member(at, 999, 1), lambda: asset.find_member("jaw_open"), lambda: asset.texcoords(99), lambda: fascia.run("build", "/no/such/head.obj", "-o", "/tmp/none.glb"))
for call in (lambda: face.set_layer(1, "average"), lambda: face.set_layer(1, mask=[1.0]), lambda: face.move_head(np.eye(3)),
             lambda: face.member_gradient("nobody's", gradient), lambda: face.member_gradient(vocabulary, [[1.0]])):
    try:
        call()
    except (ValueError, KeyError):
        pass
    else:
        raise AssertionError("no error")
expect_errors(lambda: fascia.Fit(asset, "ibug68"), says="landmarks")  # a patch of skin has no 68 of them

if len(sys.argv) > 3:
    head = fascia.load(sys.argv[2])
    stream = np.genfromtxt(sys.argv[3], delimiter=",", skip_header=1)[:20, 1:].reshape(-1, 68, 3)
    fit = fascia.Fit(head, "ibug68")
    assert fit.point_count == 68 and fit.dimensions == 3 and "pronasale" in fit.names
    fit.set_neutral(stream[0])
    opened = [channel["name"] for channel in head.channels].index("jaw_open")
    most = 0.0
    for points in stream:
        found = fit.push(points)
        most = max(most, found["values"][opened])
    assert found["seen"] > 20 and found["residual"] < 5e-4 and found["landmarks"].shape == (len(fit.names), 3)
    assert found["head"].shape == (4, 4) and 900 < found["scale"] < 1100  # the stream is in millimetres
    live = fascia.Face(head)
    skins = [i for i, mesh in enumerate(head.meshes) if mesh["part"] == "skin"]
    assert any(len(head.texcoords(i)) for i in skins) and all(len(live.tangents(i)) == len(head.texcoords(i)) for i in skins)
    live.values[:] = found["values"]
    assert live.step(1 / 60) and most > 0.1
    named = fascia.Fit(head, [None if name == "pronasale" else name for name in fit.names])
    assert len(named.names) == len(fit.names) - 1 and named.point_count == len(fit.names)
    skin = next(i for i, mesh in enumerate(head.meshes) if mesh["part"] == "skin")
    placed = fascia.Fit(head, [(skin, tuple(corners), (1.0, 0.0, 0.0)) for corners in head.meshes[skin]["triangles"][::200]])
    assert placed.point_count == len(head.meshes[skin]["triangles"][::200])
    expect_errors(lambda: fit.push(stream[0][:5]), lambda: fascia.Fit(head, ["no such landmark"]), lambda: fascia.Fit(head, "nobody's"))
print(f"python: fascia {fascia.version()}, {len(names)} channels, all passed")
