# Fascia in Blender: rigs as moving heads, channels as properties that can be keyed and driven, shape keys baked.
#
# Import a rig (File > Import > Fascia rig): its meshes become Blender's, bound to the rig's bytes, which are kept in the
# blend file. Each channel and each member of a vocabulary is a property of the head's empty, "fascia:NAME".
import os

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import runtime

bl_info = {"name": "Fascia", "author": "The Fascia developers", "version": (0, 1, 0), "blender": (3, 4, 0),
           "location": "File > Import, Sidebar > Fascia", "category": "Animation",
           "description": "Anatomical face rigs, simulated"}

PREFIX = "fascia:"  # of the properties that are a head's inputs
heads = {}  # name of a head's empty -> what moves it


class Head:
    """A loaded rig and the objects it moves."""

    def __init__(self, empty):
        self.asset = runtime.Asset(bytes(empty["fascia_rig"]))
        self.face = runtime.Face(self.asset, space="mesh")
        self.frame = None
        self.objects = [(obj, int(obj["fascia_mesh"])) for obj in empty.children_recursive if "fascia_mesh" in obj]

    def drive(self, empty):
        self.face.clear()
        for name, value in inputs(empty).items():
            if value != 0.0:
                self.face.set(name, value)

    def show(self):
        for obj, index in self.objects:
            positions = self.face.positions(index)
            moved = np.empty_like(positions)  # glTF's axes to Blender's: (x, y, z) to (x, -z, y)
            moved[:, 0], moved[:, 1], moved[:, 2] = positions[:, 0], -positions[:, 2], positions[:, 1]
            if len(obj.data.vertices) != len(moved):
                raise runtime.Error(f"{obj.name} has {len(obj.data.vertices)} vertices where the rig has {len(moved)}: "
                                    "apply no modifier that changes them, and import without merging vertices")
            obj.data.vertices.foreach_set("co", moved.ravel())
            obj.data.update()


def head_of(empty):
    if empty.name not in heads:
        heads[empty.name] = Head(empty)
    return heads[empty.name]


def inputs(empty):
    """The head's inputs: names of channels and members, and their numbers."""
    return {name[len(PREFIX):]: float(value) for name, value in empty.items()
            if name.startswith(PREFIX) and isinstance(value, (int, float))}


def add_inputs(empty, asset):
    """Gives the empty one property for each channel and member of the rig, with its range."""
    def add(name, value, **described):
        empty[PREFIX + name] = value
        empty.id_properties_ui(PREFIX + name).update(default=value, **described)

    for channel in asset.channels:
        low, high = channel["minimum"], channel["maximum"]
        add(channel["name"], channel["rest"], min=low, max=high, soft_min=low, soft_max=high,
            subtype="ANGLE" if channel["unit"] == "rad" else "NONE", description=f"Channel, {channel['group']}")
    for vocabulary, members in asset.sets.items():
        for member in members:
            add(f"{vocabulary}:{member}", 0.0, min=0.0, max=1.0, soft_min=0.0, soft_max=1.0,
                description=f"Member of {vocabulary}: adds to the channels that it drives")


def rig_empties(scene):
    return [obj for obj in scene.objects if "fascia_rig" in obj]


def update(scene, depsgraph=None):
    """Poses every head, or steps it where the timeline has gone on by one frame."""
    for empty in rig_empties(scene):
        head = head_of(empty)
        head.drive(empty)
        if empty.get("fascia_dynamics", True) and head.frame == scene.frame_current - 1:
            head.face.step(scene.render.fps_base / scene.render.fps)
        elif head.frame != scene.frame_current or not bpy.context.screen or not bpy.context.screen.is_animation_playing:
            head.face.pose()
        head.frame = scene.frame_current
        head.show()


@persistent
def on_frame(scene, depsgraph=None):
    update(scene, depsgraph)


@persistent
def on_load(*_):
    heads.clear()


def import_rig(context, path):
    """Imports a rig's meshes by Blender's own glTF importer and binds them; returns the head's empty."""
    np.bool = bool  # the importer of Blender 3.4 asks NumPy for it
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path, merge_vertices=False)
    new = [obj for obj in bpy.data.objects if obj not in before]
    with open(path, "rb") as file:
        rig = file.read()
    asset = runtime.Asset(rig)
    empty = bpy.data.objects.new(os.path.splitext(os.path.basename(path))[0], None)
    context.scene.collection.objects.link(empty)
    empty["fascia_rig"] = np.frombuffer(rig, np.uint8).tobytes()
    for obj in new:
        if obj.parent is None:
            obj.parent = empty
    bind(asset, [obj for obj in new if obj.type == "MESH"])
    add_inputs(empty, asset)
    heads[empty.name] = Head(empty)
    return empty


def bind(asset, objects):
    """Splits nothing and guesses nothing: a mesh is an object's when its vertices are the file's, one by one."""
    face = runtime.Face(asset, space="mesh")
    for index, mesh in enumerate(asset.meshes):
        positions = face.positions(index)
        for obj in objects:
            if "fascia_mesh" in obj or len(obj.data.vertices) != len(positions):
                continue
            here = np.empty(3 * len(positions), np.float32)
            obj.data.vertices.foreach_get("co", here)
            here = here.reshape(-1, 3)
            if np.abs(np.stack([here[:, 0], here[:, 2], -here[:, 1]], 1) - positions).max() < 1e-4:
                obj["fascia_mesh"] = index
                break
        else:
            print(f"fascia: no object for the mesh {mesh['name']} ({mesh['part']}); it stays as it is")


def bake(empty, vocabulary="arkit"):
    """Gives every bound object one shape key for each member of a vocabulary; returns how many."""
    head = head_of(empty)
    members = head.asset.sets[vocabulary]
    head.face.clear()
    head.face.pose()
    head.show()
    for obj, _ in head.objects:
        if obj.data.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
    for member in members:
        head.face.clear()
        head.face.set(f"{vocabulary}:{member}", 1.0)
        head.face.pose()
        for obj, index in head.objects:
            positions = head.face.positions(index)
            key = obj.shape_key_add(name=member, from_mix=False)
            key.data.foreach_set("co", np.stack([positions[:, 0], -positions[:, 2], positions[:, 1]], 1).ravel())
    head.face.clear()
    return len(members)


class FASCIA_OT_import(bpy.types.Operator, ImportHelper):
    """Import a rig that `fascia build` has made"""
    bl_idname = "fascia.import_rig"
    bl_label = "Fascia rig (.glb)"
    bl_options = {"UNDO"}
    filename_ext = ".glb"
    filter_glob: bpy.props.StringProperty(default="*.glb", options={"HIDDEN"})

    def execute(self, context):
        try:
            context.view_layer.objects.active = import_rig(context, self.filepath)
        except runtime.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class OfHead:
    """An operator for the active head."""

    @classmethod
    def poll(cls, context):
        return context.object is not None and "fascia_rig" in context.object


class FASCIA_OT_export(OfHead, bpy.types.Operator, ExportHelper):
    """Write the active head's rig as it was imported: the file that engines load"""
    bl_idname = "fascia.export_rig"
    bl_label = "Fascia rig (.glb)"
    filename_ext = ".glb"
    filter_glob: bpy.props.StringProperty(default="*.glb", options={"HIDDEN"})

    def execute(self, context):
        try:
            with open(self.filepath, "wb") as file:
                file.write(bytes(context.object["fascia_rig"]))
        except OSError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class FASCIA_OT_bake(OfHead, bpy.types.Operator):
    """Add a shape key for each ARKit shape to the active head"""
    bl_idname = "fascia.bake"
    bl_label = "Bake shape keys"
    bl_options = {"UNDO"}

    def execute(self, context):
        self.report({"INFO"}, f"{bake(context.object)} shape keys")
        return {"FINISHED"}


class FASCIA_OT_pose(bpy.types.Operator):
    """Pose the heads by their present values"""
    bl_idname = "fascia.pose"
    bl_label = "Update"

    def execute(self, context):
        for head in heads.values():
            head.frame = None
        update(context.scene)
        return {"FINISHED"}


class FASCIA_PT_panel(bpy.types.Panel):
    bl_label = "Fascia"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Fascia"

    def draw(self, context):
        empty = context.object
        if empty is None or "fascia_rig" not in empty:
            self.layout.label(text="Select a head's empty")
            return
        self.layout.operator("fascia.pose")
        self.layout.operator("fascia.bake")
        self.layout.operator("fascia.export_rig", text="Export Fascia rig")
        column = self.layout.column(align=True)
        for name in sorted(inputs(empty)):
            column.prop(empty, f'["{bpy.utils.escape_identifier(PREFIX + name)}"]', text=name, slider=True)


def import_menu(self, context):
    self.layout.operator(FASCIA_OT_import.bl_idname)


def export_menu(self, context):
    self.layout.operator(FASCIA_OT_export.bl_idname)


classes = (FASCIA_OT_import, FASCIA_OT_export, FASCIA_OT_bake, FASCIA_OT_pose, FASCIA_PT_panel)


def register():
    for entry in classes:
        bpy.utils.register_class(entry)
    bpy.types.TOPBAR_MT_file_import.append(import_menu)
    bpy.types.TOPBAR_MT_file_export.append(export_menu)
    bpy.app.handlers.frame_change_post.append(on_frame)
    bpy.app.handlers.load_post.append(on_load)


def unregister():
    bpy.app.handlers.load_post.remove(on_load)
    bpy.app.handlers.frame_change_post.remove(on_frame)
    bpy.types.TOPBAR_MT_file_export.remove(export_menu)
    bpy.types.TOPBAR_MT_file_import.remove(import_menu)
    for entry in reversed(classes):
        bpy.utils.unregister_class(entry)
