#!/usr/bin/env python3
"""Building and fitting from Python, which run the fascia tool: python_tool_test.py FOLDER_OF_PROGRAMS FOLDER, with the
module on PYTHONPATH and the tool in FASCIA. The embedded head is built at low detail and posed, and the fit of the posed
mesh moves the skin as the pose did."""
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

import fascia

programs, folder = Path(sys.argv[1]), Path(sys.argv[2]) / "python_tool"
folder.mkdir(parents=True, exist_ok=True)
subprocess.run([programs / "write_embedded_head", folder], check=True)
head, rig = folder / "embedded_head.obj", folder / "rig.glb"
report = fascia.build(head, rig, detail="low", landmarks=folder / "embedded_head_landmarks.json")
assert isinstance(report, dict) and report, "no report of the build"
asset = fascia.load(rig)
assert asset.levels[0] == "low" and len(asset.channels) > 100
skins = [i for i, mesh in enumerate(asset.meshes) if mesh["part"] == "skin"]


def posed(values):
    face = fascia.Face(asset, level=0, space="metres")
    for name, value in values.items():
        face.set(name, value)
    face.pose()
    return np.concatenate([face.positions(i) for i in skins])


pose = {"zygomaticus_major_superior_left": 0.7, "zygomaticus_major_superior_right": 0.5, "frontalis_medial_left": 0.6, "jaw_open": 0.2}
(folder / "pose.json").write_text(json.dumps({"activations": pose}))
fascia.run("pose", rig, activations=folder / "pose.json", o=folder / "posed.obj")
report = fascia.fit(rig, folder / "posed.obj", folder / "found.json")
found = json.loads((folder / "found.json").read_text())["activations"]
rest, target, fitted = posed({}), posed(pose), posed(found)
left = float(np.linalg.norm(fitted - target) / np.linalg.norm(target - rest))
farthest = float(np.linalg.norm(fitted - target, axis=1).max() * 1000)
assert left < 0.1, f"{left:.3f} of the motion is left"
for name, value in pose.items():
    assert abs(found.get(name, 0) - value) < 0.1, (name, value, found.get(name))
print(f"python tool: built, posed and fitted: {left:.4f} of the motion left, at most {farthest:.3f} mm")
