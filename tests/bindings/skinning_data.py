#!/usr/bin/env python3
"""What a vertex shader gets of a posed face, and where the runtime has the vertices: skinning_data.py RIG.glb > DATA.json, for
wgsl_test.mjs. All meshes, in metres; arrays are base64 of 32-bit numbers. Through the Blender add-on's ctypes module."""
import base64
import ctypes
import json
import os
import sys

import numpy as np

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(root, "hosts", "blender", "fascia_blender"))
os.environ.setdefault("FASCIA_LIBRARY", os.path.join(root, "build", "lib", "libfascia.so"))
import runtime


class Skinning(ctypes.Structure):  # fascia_skinning
    _fields_ = [(name, ctypes.c_uint32) for name in ("struct_size", "vertex_count", "influences", "node_count")] + [
        ("rest", ctypes.POINTER(ctypes.c_float)), ("nodes", ctypes.POINTER(ctypes.c_uint32)),
        ("weights", ctypes.POINTER(ctypes.c_float)), ("jaw", ctypes.POINTER(ctypes.c_float)),
        ("eyes", ctypes.POINTER(ctypes.c_uint32))]


def packed(array):
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def mesh_data(face, mesh):
    skinning = runtime._filled(Skinning, "fascia_face_skinning", face.handle, mesh)
    count, influences = skinning.vertex_count, skinning.influences
    nodes = np.zeros((skinning.node_count, 4), np.float32)
    bones = np.zeros(48, np.float32)
    runtime._call("fascia_face_write_node_texture", face.handle, mesh, nodes.ctypes.data_as(ctypes.c_void_p),
                  ctypes.c_size_t(skinning.node_count))
    runtime._call("fascia_face_bone_matrices", face.handle, mesh, bones.ctypes.data_as(ctypes.c_void_p))
    list_of = np.ctypeslib.as_array
    return {"vertices": count, "influences": influences, "texels": packed(nodes), "bones": packed(bones),
            "rest": packed(list_of(skinning.rest, (count * 3,))), "nodes": packed(list_of(skinning.nodes, (count * influences,))),
            "weights": packed(list_of(skinning.weights, (count * influences,))), "jaw": packed(list_of(skinning.jaw, (count,))),
            "eyes": packed(list_of(skinning.eyes, (count,))), "positions": packed(face.positions(mesh))}


with open(sys.argv[1], "rb") as file:
    asset = runtime.Asset(file.read())
face = runtime.Face(asset, space="metres", level=0)
for i, member in enumerate(asset.sets["arkit"]):
    if i % 3 == 0 or "jawOpen" in member:
        face.set("arkit:" + member, 0.5)
face.pose()
json.dump([mesh_data(face, mesh) for mesh in range(len(asset.meshes))], sys.stdout)
