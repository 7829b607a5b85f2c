"""Renders one OBJ frame of a sequence to a picture, to look at a result:

    blender -b --python-exit-code 1 -P tools/render_frame.py -- out/cup_drop/cup_drop.0030.obj frame.png [--view X,Y,Z] [--zoom 1.0]

Needs Debian's packages blender and python3-numpy. The view direction is in scene axes (Y up); without --target the camera looks at the
middle of everything in the frame.
"""
import argparse
import sys

import bpy
from mathutils import Vector

parser = argparse.ArgumentParser()
parser.add_argument("obj", nargs="+", help="frames to render together (usually one)")
parser.add_argument("picture")
parser.add_argument("--view", default="0.8,0.5,1.2", help="from the target towards the camera, Y up")
parser.add_argument("--target", help="point to look at, X,Y,Z [m]")
parser.add_argument("--size", type=float, help="extent to show [m]")
parser.add_argument("--zoom", type=float, default=1.0)
parser.add_argument("--samples", type=int, default=48)
parser.add_argument("--width", type=int, default=960)
parser.add_argument("--ground", type=float, help="height of a ground plane [m]")
options = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def to_blender(text):
    x, y, z = (float(part) for part in text.split(","))
    return Vector((x, -z, y))


COLOURS = {"glass": (0.35, 0.6, 0.62), "porcelain": (0.85, 0.85, 0.82), "terracotta": (0.62, 0.24, 0.12), "steel": (0.3, 0.3, 0.33)}

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
for path in options.obj:
    bpy.ops.wm.obj_import(filepath=path)
for material in bpy.data.materials:
    material.use_nodes = True
    colour = next((c for name, c in COLOURS.items() if material.name.startswith(name)), (0.6, 0.55, 0.5))
    if "inside" in material.name:
        colour = tuple(0.55 * c + 0.4 for c in colour)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = 0.35 if "outside" in material.name else 0.8

corners = [o.matrix_world @ Vector(c) for o in bpy.data.objects if o.type == "MESH" for c in o.bound_box]
low = Vector(min(c[i] for c in corners) for i in range(3))
high = Vector(max(c[i] for c in corners) for i in range(3))
target = to_blender(options.target) if options.target else (low + high) / 2
size = options.size or (high - low).length

ground_height = options.ground if options.ground is not None else low.z
bpy.ops.mesh.primitive_plane_add(size=60 * size, location=(target.x, target.y, ground_height))
ground = bpy.context.object
material = bpy.data.materials.new("floor")
material.use_nodes = True
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.32, 0.32, 0.34, 1)
ground.data.materials.append(material)

camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
direction = to_blender(options.view).normalized()
camera.location = target + direction * size * 1.6 / options.zoom
camera.rotation_euler = (-direction).to_track_quat("-Z", "Y").to_euler()
camera.data.lens = 50
camera.data.clip_start = size / 100
scene.camera = camera
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy = 3.0
sun.data.angle = 0.1
sun.rotation_euler = (0.7, 0.25, 0.6)
scene.collection.objects.link(sun)
scene.world = bpy.data.worlds.new("sky")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.75, 0.8, 0.9, 1)
scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.6
scene.render.engine = "CYCLES"
scene.cycles.samples = options.samples
scene.cycles.use_denoising = False
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x = options.width
scene.render.resolution_y = options.width * 9 // 16
scene.render.filepath = options.picture
bpy.ops.render.render(write_still=True)
