#!/usr/bin/env python3
"""Poses by the native library, for web_test.mjs: native_poses.py RIG.glb > POSES.json. Through the Blender add-on's ctypes module."""
import json
import os
import sys

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(root, "hosts", "blender", "fascia_blender"))
os.environ.setdefault("FASCIA_LIBRARY", os.path.join(root, "build", "lib", "libfascia.so"))
import runtime

with open(sys.argv[1], "rb") as file:
    asset = runtime.Asset(file.read())
members = [f"{name}:{member}" for name in asset.sets for member in asset.sets[name]][:12]
poses = []
for level in (0,):
    for member in members:
        face = runtime.Face(asset, space="metres", level=level)
        face.set(member, 0.8)
        face.pose()
        for mesh in range(len(asset.meshes)):
            positions = [round(float(x), 7) for x in face.positions(mesh).ravel()]
            poses.append({"level": level, "values": {member: 0.8}, "mesh": mesh, "positions": positions})
json.dump({"poses": poses}, sys.stdout)
