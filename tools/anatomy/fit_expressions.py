#!/usr/bin/env python3
"""Fits the ARKit table to measured shapes on the simulator that plays it.

    build/bin/bench_expressions --level low --rigs /tmp/rigs neutral person_3
    fit_expressions.py MEASURED/data/ict /tmp/rigs anatomy/data/expressions/arkit.json \\
        [--people neutral,person_3] [--only jawOpen,...] [--library build/lib/libfascia.so]

Each shape may use only the actuators that figures/expression_actuators.json allows it, each with the reason an
anatomist would give. The fields of single actuators, at a small activation, are combined by bounded least squares with a
ridge; then the full, nonlinear simulation is run, its fields mended by what it did, and solved again, a few times;
actuators that explain nothing are taken out. Left and right are mirror images. Fitted on some people, to be scored on
others (bench/expressions).
"""
import argparse
import ctypes
import json
import struct
from pathlib import Path

import numpy as np
from scipy.optimize import lsq_linear
from scipy.spatial import cKDTree

RIDGE = 0.004       # of a whole activation, as a share of the shape's own square
LINING = 0.25       # what a vertex of mouth or socket lining counts beside one of the face
PRUNE = 0.002       # share of the motion an actuator must explain to stay
HERE = Path(__file__).resolve().parent.parent.parent


class _Info(ctypes.Structure):
    _fields_ = [(n, ctypes.c_uint32) for n in "size levels meshes channels sets muscles".split()] + [("m", ctypes.c_float * 16)]


class _Mesh(ctypes.Structure):
    _fields_ = [(n, ctypes.c_uint32) for n in "size mesh primitive vertices triangles reserved".split()] + [
        ("name", ctypes.c_char_p), ("part", ctypes.c_char_p), ("list", ctypes.c_void_p)]


class _Channels(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("count", ctypes.c_uint32)] + [
        (n, ctypes.POINTER(ctypes.c_char_p)) for n in ("names", "groups", "units")] + [
        (n, ctypes.POINTER(ctypes.c_float)) for n in ("minimum", "maximum", "rest")]


class _FaceOptions(ctypes.Structure):
    _fields_ = [("size", ctypes.c_uint32), ("space", ctypes.c_int), ("solver", ctypes.c_int), ("level", ctypes.c_int32)]


class _Vectors(ctypes.Structure):
    _fields_ = [(n, ctypes.c_uint32) for n in "size count stride reserved".split()] + [("data", ctypes.POINTER(ctypes.c_float))]


def _sized(kind):
    return kind(ctypes.sizeof(kind))


class Face:
    """A face of a rig through the C interface; poses its mesh `head`."""

    def __init__(self, library, path, level=0):
        self.lib = library
        data = Path(path).read_bytes()
        asset, face = ctypes.c_void_p(), ctypes.c_void_p()
        self._check(library.fascia_asset_load(data, ctypes.c_size_t(len(data)), ctypes.byref(asset)))
        info, channels = _sized(_Info), _sized(_Channels)
        self._check(library.fascia_asset_get_info(asset, ctypes.byref(info)))
        self._check(library.fascia_asset_get_channels(asset, ctypes.byref(channels)))
        options = _FaceOptions(ctypes.sizeof(_FaceOptions), 1, 0, level)
        self._check(library.fascia_face_create(asset, ctypes.byref(options), ctypes.byref(face)))
        self.handle = face
        self.mesh = None
        for m in range(info.meshes):
            mesh = _sized(_Mesh)
            self._check(library.fascia_asset_get_mesh(asset, m, ctypes.byref(mesh)))
            if mesh.name == b"head":
                self.mesh = m
        self.index = {channels.names[k].decode(): k for k in range(channels.count)}
        self.minimum = list(channels.minimum[:channels.count])
        self.maximum = list(channels.maximum[:channels.count])
        values = library.fascia_face_values
        values.restype = ctypes.POINTER(ctypes.c_float)
        self.values = np.ctypeslib.as_array(values(face), (channels.count,))
        self.rest = self._positions()
        self.fields, self.mirror = {}, None

    def _check(self, result):
        if result:
            self.lib.fascia_last_message.restype = ctypes.c_char_p
            raise SystemExit(self.lib.fascia_last_message().decode())

    def _positions(self):
        vectors = _sized(_Vectors)
        self._check(self.lib.fascia_face_positions(self.handle, self.mesh, ctypes.byref(vectors)))
        return np.ctypeslib.as_array(vectors.data, (vectors.count * 3,)).reshape(-1, 3).astype(float)

    def pose(self, weights):
        """Displacement (vertices, 3) in metres of the static pose of `weights`, channel -> value."""
        self._check(self.lib.fascia_face_clear(self.handle))
        self._check(self.lib.fascia_face_reset(self.handle))
        for name, value in weights.items():
            self.values[self.index[name]] = value
        self._check(self.lib.fascia_face_pose(self.handle))
        return self._positions() - self.rest


def gltf(path):
    data = Path(path).read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def accessor(document, binary, index):
    entry = document["accessors"][index]
    out = np.zeros((entry["count"], 3))

    def read(part, count, kind):
        view = document["bufferViews"][part["bufferView"]]
        return np.frombuffer(binary, kind, count, view.get("byteOffset", 0) + part.get("byteOffset", 0))

    if "bufferView" in entry:
        out[:] = read(entry, 3 * entry["count"], "<f4").reshape(-1, 3)
    if "sparse" in entry:
        sparse = entry["sparse"]
        kind = {5125: "<u4", 5123: "<u2", 5121: "u1"}[sparse["indices"]["componentType"]]
        at = read(sparse["indices"], sparse["count"], kind)
        out[at] = read(sparse["values"], 3 * sparse["count"], "<f4").reshape(-1, 3)
    return out


def measured_shapes(folder):
    document, binary = gltf(folder / "expressions.glb")
    mesh = next(m for m in document["meshes"] if m["name"] == "head")
    shapes = {name: accessor(document, binary, target["POSITION"])
              for name, target in zip(mesh["extras"]["targetNames"], mesh["primitives"][0]["targets"])}
    shapes["mouthClose"] = shapes["mouthClose"] + shapes["jawOpen"]  # it corrects an open jaw
    return shapes


def face_vertices(folder, rest):
    """Which vertices of the neutral head are face, not neck, mouth or socket lining."""
    base = np.load(folder / "ict_model.npz")["base"] * 0.01
    return cKDTree(base[:14062]).query(rest)[1] < 9409


def mirror_vertices(folder, rest):
    """The vertex on the other side, for each of the neutral head's."""
    base = np.load(folder / "ict_model.npz")["base"][:14062] * 0.01
    original = cKDTree(base).query(rest)[1]
    across = cKDTree(base).query(base * (-1, 1, 1))[1]
    first = {o: k for k, o in reversed(list(enumerate(original)))}
    return np.array([first[across[o]] for o in original])


def swap(name):
    if name.endswith("_left"):
        return name[:-5] + "_right"
    return name[:-6] + "_left" if name.endswith("_right") else name


def mirrored(weights):
    return {swap(n): -v if n in ("jaw_lateral",) or n.startswith("eye_yaw") else v for n, v in weights.items()}


def parameters(entry, face):
    """What of a shape may vary: a list of (name, {channel: limit}), each from 0 to 1."""
    paired = entry.get("paired", False)
    found = []
    for word in entry["actuators"]:
        name, sign, sides = word, 1, ["left"] if paired else ["left", "right"]
        if name.startswith("other:"):
            name, sides = name[6:], ["right"]
        if name.startswith("both:"):
            name, sides = name[5:], ["left", "right"]
        if name.startswith("-"):
            name, sign = name[1:], -1
        names = [name] if name in face.index else [f"{name}_{side}" for side in sides]
        for n in names:
            if n not in face.index:
                raise SystemExit(f"{entry['shape']}: no actuator {n}")

        def limit(n):  # a muscle below 0 is one that lets go of what the shape it corrects asks of it
            return face.maximum[face.index[n]] if sign > 0 else face.minimum[face.index[n]] or -1.0

        found.append((word, {n: limit(n) for n in names}))
    return found


def field(face, name, limit):
    """Displacement a whole `limit` of an actuator would give, from a quarter of it (the jaw: most of it)."""
    key = (name, limit)
    if limit < 0 and face.minimum[face.index[name]] == 0:
        return -field(face, name, -limit)
    if key not in face.fields:
        if name.endswith("_right") and (swap(name), limit) in face.fields and face.mirror is not None:
            there = face.fields[(swap(name), limit)][face.mirror] * (-1, 1, 1)
        else:
            share = 0.7 if name == "jaw_open" else 0.25
            there = face.pose({name: share * limit}) / share
        face.fields[key] = there
    return face.fields[key]


class Fit:
    def __init__(self, faces, truths, weight, base):
        self.faces, self.weight, self.base = faces, weight, base
        self.goals = [t * weight[:, None] for t in truths]
        self.square = np.mean([(g ** 2).sum() for g in self.goals])

    def weights(self, params, x):
        total = dict(self.base)
        for (_, channels), value in zip(params, x):
            for n, limit in channels.items():
                total[n] = total.get(n, 0.0) + value * limit
        return total

    def simulate(self, params, x):
        return np.concatenate([(f.pose(self.weights(params, x)) * self.weight[:, None]).ravel() for f in self.faces])

    def cost(self, u, x):
        goal = np.concatenate([g.ravel() for g in self.goals])
        return ((u - goal) ** 2).sum() / len(self.faces) / self.square + RIDGE * (x ** 2).sum()

    def solve(self, jacobian, u, x, lower, upper):
        """Bounded step from x by the linear model."""
        goal = np.concatenate([g.ravel() for g in self.goals])
        scale = len(self.faces) * self.square
        normal = jacobian.T @ jacobian / scale + RIDGE * np.eye(len(x))
        right = jacobian.T @ (goal - u + jacobian @ x) / scale
        factor = np.linalg.cholesky(normal + 1e-12 * np.eye(len(x)))
        return lsq_linear(factor.T, np.linalg.solve(factor, right), (lower, upper)).x

    def columns(self, params):
        """Fields of the parameters a whole activation long, from single actuators at a small one."""
        out = []
        for _, channels in params:
            fields = [sum(field(face, n, limit) for n, limit in channels.items()) for face in self.faces]
            out.append(np.concatenate([(f * self.weight[:, None]).ravel() for f in fields]))
        return np.stack(out, 1)

    def run(self, params, start=None, jacobian=None, rounds=9):
        """Gauss-Newton steps within a trust region; each full simulation mends the fields along the step it took
        (Broyden's update). Returns values, displacements, cost and the mended fields."""
        x = np.zeros(len(params)) if start is None else start
        jacobian = self.columns(params) if jacobian is None else jacobian
        u = self.simulate(params, x)
        best, reach = self.cost(u, x), 0.5
        for _ in range(rounds):
            aim = self.solve(jacobian, u, x, np.maximum(x - reach, 0.0) - 1e-9, np.minimum(x + reach, 1.0) + 1e-9).clip(0, 1)
            step = aim - x
            if np.abs(step).max() < 0.01:
                break
            there = self.simulate(params, aim)
            jacobian += np.outer(there - u - jacobian @ step, step) / (step @ step)
            cost = self.cost(there, aim)
            if cost < best:
                gain, x, u, best = best - cost, aim, there, cost
                if gain < 5e-4:
                    break
            else:
                reach *= 0.4
        return x, u, best, jacobian

    def pruned(self, params):
        x, u, best, jacobian = self.run(params)
        # What each actuator explains, by the last linearisation.
        scale = len(self.faces) * self.square
        keep = [k for k in range(len(params)) if x[k] > 0.02 and (jacobian[:, k] ** 2).sum() * x[k] ** 2 / scale > PRUNE]
        if len(keep) < len(params) and keep:
            params = [params[k] for k in keep]
            x, u, best, _ = self.run(params, x[keep], jacobian[:, keep], 4)
        return params, x, u


def explained(u, goal, mask):
    return 1 - ((u - goal)[mask] ** 2).sum() / (goal[mask] ** 2).sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measured", type=Path)
    parser.add_argument("rigs", type=Path)
    parser.add_argument("table", type=Path, help="the table, rewritten in place")
    parser.add_argument("--people", default="neutral,person_3")
    parser.add_argument("--only", default="")
    parser.add_argument("--library", default=str(HERE / "build/lib/libfascia.so"))
    parser.add_argument("--actuators", type=Path, default=HERE / "anatomy/figures/expression_actuators.json")
    options = parser.parse_args()

    library = ctypes.CDLL(options.library)
    faces = [Face(library, options.rigs / f"{p}.glb") for p in options.people.split(",")]
    shapes = measured_shapes(options.measured)
    document, binary = gltf(options.measured / "neutral.glb")
    mesh = next(m for m in document["meshes"] if m["name"] == "head")
    rest = accessor(document, binary, mesh["primitives"][0]["attributes"]["POSITION"])
    on_face = face_vertices(options.measured, rest)
    for face in faces:
        face.mirror = mirror_vertices(options.measured, rest)
    weight = np.where(on_face, 1.0, np.sqrt(LINING))
    table = json.loads(options.table.read_text())
    rows = {e["name"]: e for e in table["expressions"]}
    scores = []
    only = [n for n in options.only.split(",") if n]
    for entry in json.loads(options.actuators.read_text())["shapes"]:
        shape = entry["shape"]
        if only and shape not in only:
            continue
        name = shape + "Left" if entry.get("paired") else shape
        base = dict(rows[entry["corrects"]]["weights"]) if "corrects" in entry else {}
        base.update(entry.get("given", {}))
        base.update(entry.get("bones", {}))  # muscles of mastication, which move the jaw beside its own channels
        fit = Fit(faces, [shapes[name]] * len(faces), weight, base)
        params, x, u = fit.pruned(parameters(entry, faces[0]))
        found = {}
        for (_, channels), value in zip(params, x):
            for n, limit in channels.items():
                found[n] = round(found.get(n, 0.0) + float(value) * limit, 3)
        found = {n: v for n, v in found.items() if abs(v) >= 0.005}
        for n, v in entry.get("given", {}).items():
            found[n] = v
        for n, v in entry.get("bones", {}).items():
            found.setdefault(n, v)
        order = sorted(found, key=lambda n: -abs(found[n]))
        rows[name]["weights"] = {n: found[n] for n in order}
        if entry.get("paired"):
            rows[shape + "Right"]["weights"] = mirrored(rows[name]["weights"])
        elif name.endswith("Left"):  # the whole mouth or jaw to one side
            rows[name[:-4] + "Right"]["weights"] = mirrored(rows[name]["weights"])
        size = len(shapes[name])
        score = np.mean([explained((u[3 * size * k:3 * size * (k + 1)].reshape(-1, 3) / weight[:, None]), shapes[name], on_face)
                         for k in range(len(faces))])
        scores += [score] * (2 if entry.get("paired") else 1)
        print(f"{name:20s} {score:6.3f}  " + " ".join(f"{n} {v:g}" for n, v in rows[name]["weights"].items()), flush=True)
        write(options.table, table)
    print(f"mean over the face, people fitted on: {np.mean(scores):.3f}")


def write(path, table):
    """One expression a line."""
    lines = ["{"]
    for key, value in table.items():
        if key == "expressions":
            continue
        lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)},")
    lines.append('  "expressions": [')
    rows = [f"    {json.dumps(e, ensure_ascii=False)}" for e in table["expressions"]]
    lines.append(",\n".join(rows))
    lines += ["  ]", "}"]
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
