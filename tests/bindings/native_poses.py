#!/usr/bin/env python3
"""Poses by the native library, for web_test.mjs: native_poses.py RIG.glb > POSES.json. Through the Blender add-on's ctypes
module. Each level of detail has static poses and, where `frames` is more than 0, after so many steps of 1/60 s;
positions are the bytes of 32-bit floats, in base64."""
import base64
import json
import os
import sys

import numpy as np

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(root, "hosts", "blender", "fascia_blender"))
os.environ.setdefault("FASCIA_LIBRARY", os.path.join(root, "build", "lib", "libfascia.so"))
import runtime

with open(sys.argv[1], "rb") as file:
    asset = runtime.Asset(file.read())
members = [f"{name}:{member}" for name in asset.sets for member in asset.sets[name]][:12]
poses = []
for level in range(runtime._filled(runtime._Info, "fascia_asset_get_info", asset.handle).levels):
    for member, frames in [(member, 0) for member in members] + [(members[0], 20)]:
        face = runtime.Face(asset, space="metres", level=level)
        face.set(member, 0.8)
        if frames == 0:
            face.pose()
        for _ in range(frames):
            face.step(1 / 60)
        for mesh in range(len(asset.meshes)):
            bits = np.ascontiguousarray(face.positions(mesh), dtype="<f4").tobytes()
            poses.append({"level": level, "values": {member: 0.8}, "frames": frames, "mesh": mesh,
                          "positions": base64.b64encode(bits).decode()})
json.dump({"poses": poses}, sys.stdout)
