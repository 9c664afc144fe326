"""The add-on's panel drawn by Blender itself in a window, on a display in memory:
xvfb-run -a blender --factory-startup --python blender_panel.py -- RIG.glb. Exits 1 where drawing raises or does not happen."""
import os
import sys
import traceback

import bpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../hosts/blender"))
import fascia_blender

rig = sys.argv[sys.argv.index("--") + 1]
sliders = []


def end(code, message):
    os.write(1, (message + "\n").encode())
    os._exit(code)  # Blender would go on


class Panel(fascia_blender.FASCIA_PT_panel):
    bl_idname = "FASCIA_PT_panel_test"
    bl_category = "Item"  # the tab that is open when Blender starts

    def draw(self, context):
        try:
            super().draw(context)
        except Exception:
            end(1, traceback.format_exc())
        if context.object is not None and "fascia_rig" in context.object:
            sliders.append(len(fascia_blender.inputs(context.object)))


def show():
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        bpy.ops.fascia.import_rig(filepath=rig)
        (empty,) = fascia_blender.rig_empties(bpy.context.scene)
        bpy.context.view_layer.objects.active = empty
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.spaces[0].show_region_ui = True
    bpy.app.timers.register(redraw, first_interval=1)


def redraw():
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=3)
    if not sliders:
        end(1, "blender panel: it was not drawn")
    end(0, f"blender panel: {sliders[-1]} sliders drawn in a window")


fascia_blender.register()
bpy.utils.register_class(Panel)
bpy.app.timers.register(show, first_interval=1)
