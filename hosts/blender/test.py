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


class Layout:
    """Takes what Blender's layout takes: a structure of its own with that property, and the parameters it knows."""

    def __init__(self):
        self.shown = []

    def known(self, function, keywords):
        parameters = bpy.types.UILayout.bl_rna.functions[function].parameters
        assert all(keyword in parameters for keyword in keywords), (function, keywords)

    def label(self, **keywords):
        self.known("label", keywords)

    def column(self, **keywords):
        self.known("column", keywords)
        return self

    def operator(self, name, **keywords):
        self.known("operator", keywords)
        module, function = name.split(".")
        getattr(getattr(bpy.ops, module), function).get_rna_type()  # raises where there is none

    def prop(self, data, path, **keywords):
        self.known("prop", keywords)
        if not isinstance(data, bpy.types.bpy_struct):
            raise TypeError(f"UILayout.prop(): error with argument 1, \"data\" - {type(data).__name__}")
        self.shown.append((keywords["text"], data.path_resolve(path)))


class Panel:
    draw = fascia_blender.FASCIA_PT_panel.draw

    def __init__(self):
        self.layout = Layout()


# The panel: a slider with a range for each channel and member.
bpy.context.view_layer.objects.active = empty
panel = Panel()
panel.draw(bpy.context)
shown = dict(panel.layout.shown)
assert len(shown) == len(head.asset.channels) + sum(map(len, head.asset.sets.values())), len(shown)
for channel in head.asset.channels:
    assert shown[channel["name"]] == channel["rest"], channel
    described = empty.id_properties_ui("fascia:" + channel["name"]).as_dict()
    assert (described["min"], described["max"]) == (channel["minimum"], channel["maximum"]), described
described = empty.id_properties_ui("fascia:arkit:mouthSmileLeft").as_dict()
assert (described["min"], described["max"], described["default"]) == (0.0, 1.0, 0.0), described

rest = places()
left, right = "fascia:arkit:mouthSmileLeft", "fascia:arkit:mouthSmileRight"
empty[left] = 0.0
empty.keyframe_insert(f'["{left}"]', frame=1)
empty[left] = 1.0
empty.keyframe_insert(f'["{left}"]', frame=10)
motion = []
for frame in range(1, 13):
    scene.frame_set(frame)
    motion.append(float(np.linalg.norm(places() - rest, axis=1).max()))
assert motion[0] < 1e-6 and motion[-1] > 5 * motion[1] and motion[-1] > 0.01 * np.ptp(rest), motion

# A driver: the right side follows the left, and the face moves with it.
half = rest[:, 0] < np.median(rest[:, 0])  # the subject's right
scene.frame_set(1)
scene.frame_set(10)
before = np.linalg.norm(places() - rest, axis=1)[half].max()
driver = empty.driver_add(f'["{right}"]').driver
variable = driver.variables.new()
variable.targets[0].id, variable.targets[0].data_path = empty, f'["{left}"]'
driver.expression = variable.name
scene.frame_set(1)
scene.frame_set(10)
assert abs(empty[right] - 1.0) < 1e-6
driven = np.linalg.norm(places() - rest, axis=1)[half].max()
assert driven > 2 * before and driven > 0.01 * np.ptp(rest), (before, driven)

# Whole numbers count as numbers.
empty.driver_remove(f'["{right}"]')
for value in (0, 1, 1.0):
    empty[right] = value
    bpy.ops.fascia.pose()
    reached = np.linalg.norm(places() - rest, axis=1)[half].max()
    assert (reached > 2 * before) == (value == 1), (value, reached)
empty[right] = 0.0

# The rig is written as it was read.
folder = tempfile.mkdtemp()
written = os.path.join(folder, "rig.glb")
assert bpy.ops.fascia.export_rig(filepath=written) == {"FINISHED"}
with open(rig, "rb") as first, open(written, "rb") as second:
    assert first.read() == second.read()

# Saved and loaded: the rig is in the file.
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
