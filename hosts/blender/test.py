"""blender -b --factory-startup --python test.py -- RIG.glb PICTURE.png"""
import os
import sys
import tempfile
import traceback

import bpy
import numpy as np

rig, picture = sys.argv[sys.argv.index("--") + 1:]
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))


def fail_loudly(kind, value, trace):
    os.write(2, "".join(traceback.format_exception(kind, value, trace)).encode())
    os._exit(1)


sys.excepthook = fail_loudly
import fascia_blender

fascia_blender.register()
bpy.ops.wm.read_homefile(use_empty=True)
scene = bpy.context.scene
bpy.ops.fascia.import_rig(filepath=rig)
(empty,) = fascia_blender.rig_empties(scene)
bound = [obj for obj in empty.children_recursive if "fascia_mesh" in obj]
head = fascia_blender.head_of(empty)
assert len(bound) == len(head.asset.meshes), (len(bound), len(head.asset.meshes))
skins = [obj for obj in bound if head.asset.meshes[obj["fascia_mesh"]]["part"] == "skin"]


def places():
    lists = []
    for skin in skins:
        here = np.empty(3 * len(skin.data.vertices), np.float32)
        skin.data.vertices.foreach_get("co", here)
        lists.append(here.reshape(-1, 3))
    return np.concatenate(lists)


rest = places()
channels = empty["fascia_channels"]
channels["arkit:mouthSmileLeft"] = 0.0
empty.keyframe_insert('["fascia_channels"]["arkit:mouthSmileLeft"]', frame=1)
channels["arkit:mouthSmileLeft"] = 1.0
empty.keyframe_insert('["fascia_channels"]["arkit:mouthSmileLeft"]', frame=10)
motion = []
for frame in range(1, 13):
    scene.frame_set(frame)
    motion.append(float(np.linalg.norm(places() - rest, axis=1).max()))
assert motion[0] < 1e-6 and motion[-1] > 5 * motion[1] and motion[-1] > 0.01 * np.ptp(rest), motion

# A driver: the right side follows the left.
driver = empty.driver_add('["fascia_channels"]["arkit:mouthSmileRight"]').driver
variable = driver.variables.new()
variable.targets[0].id, variable.targets[0].data_path = empty, '["fascia_channels"]["arkit:mouthSmileLeft"]'
driver.expression = variable.name
scene.frame_set(1)
scene.frame_set(10)
assert abs(channels["arkit:mouthSmileRight"] - 1.0) < 1e-6

# Saved and loaded: the rig is in the file.
folder = tempfile.mkdtemp()
names = [skin.name for skin in skins]
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "head.blend"))
bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "head.blend"))
scene = bpy.context.scene
(empty,) = fascia_blender.rig_empties(scene)
skins = [bpy.data.objects[name] for name in names]
scene.frame_set(1)
scene.frame_set(10)
assert np.linalg.norm(places() - rest, axis=1).max() > 0.5 * motion[-1]

# Baked, exported and imported again.
count = fascia_blender.bake(empty)
moved = []
for skin in skins:
    assert len(skin.data.shape_keys.key_blocks) == count + 1
    here = np.empty(3 * len(skin.data.vertices), np.float32)
    skin.data.shape_keys.key_blocks["mouthSmileLeft"].data.foreach_get("co", here)
    moved.append(here.reshape(-1, 3))
assert np.linalg.norm(np.concatenate(moved) - rest, axis=1).max() > 0.5 * motion[-1]
out = os.path.join(folder, "out.glb")
bpy.ops.export_scene.gltf(filepath=out, export_animations=False)
before = set(bpy.data.objects)
bpy.ops.import_scene.gltf(filepath=out)
again = [obj for obj in bpy.data.objects if obj not in before and obj.type == "MESH" and obj.data.shape_keys]
assert any("jawOpen" in obj.data.shape_keys.key_blocks for obj in again)
for obj in [obj for obj in bpy.data.objects if obj not in before]:
    bpy.data.objects.remove(obj)

# A picture.
for name, value in (("mouthSmileLeft", 1.0), ("mouthSmileRight", 1.0), ("jawOpen", 0.15)):
    for obj in empty.children_recursive:
        if obj.type == "MESH" and obj.data.shape_keys and name in obj.data.shape_keys.key_blocks:
            obj.data.shape_keys.key_blocks[name].value = value
bpy.context.view_layer.update()
corners = np.array([skin.matrix_world @ vertex.co for skin in skins for vertex in skin.data.vertices])
centre, size = (corners.min(0) + corners.max(0)) / 2, np.ptp(corners, axis=0).max()
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = centre + np.array([0.5, -2.6, 0.15]) * size
camera.data.lens = 70
camera.data.clip_start, camera.data.clip_end = size / 100, size * 100
aim = camera.constraints.new("TRACK_TO")
target = bpy.data.objects.new("target", None)
target.location = centre
aim.target = target
light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
light.data.energy = 4
light.rotation_euler = (0.9, 0.2, 0.5)
for obj in (camera, target, light):
    scene.collection.objects.link(obj)
scene.camera = camera
scene.world = scene.world or bpy.data.worlds.new("world")
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.device, scene.cycles.use_denoising = 8, "CPU", False
scene.render.resolution_x = scene.render.resolution_y = 480
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
print(f"blender: {len(bound)} meshes bound, {count} shape keys, all passed")
