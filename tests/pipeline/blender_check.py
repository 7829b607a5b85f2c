"""Compares what import_blender.py has loaded with what the run says; run by blender_test.cpp."""

import json
import os

import bpy
import mathutils


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def y_up(vector):
    return (vector[0], vector[2], -vector[1])


expected = json.loads(open(os.environ["SUNDER_EXPECTED"]).read())
scene = bpy.context.scene
check((scene.frame_start, scene.frame_end) == (expected["first"], expected["last"]), "frame range")
check(abs(scene.render.fps / scene.render.fps_base - expected["rate"]) < 1e-6 * expected["rate"], "frame rate")
pieces = bpy.data.collections[expected["scene"]].objects
check(sorted(p.name for p in pieces) == sorted(expected["pieces"]), "names of pieces")
for name, piece in expected["pieces"].items():
    check(pieces[name]["parent"] == piece["parent"], name + ": parent")
    check(len(pieces[name].data.polygons) == piece["faces"], name + ": faces")
    if piece["parent"] >= 0:
        times = [value.value for value in pieces[name].data.attributes["damage_time"].data]
        check(max(times) > 0, name + ": damage times on the crack")
for frame in expected["frames"]:
    scene.frame_set(frame["number"])
    visible = sorted(p.name for p in pieces if not p.hide_render)
    check(visible == sorted(frame["positions"]), f"pieces visible in frame {frame['number']}")
    check(visible == sorted(p.name for p in pieces if not p.hide_viewport), "the viewport shows what is rendered")
    for name, position in frame["positions"].items():
        off = max(abs(a - b) for a, b in zip(y_up(pieces[name].matrix_world.translation), position))
        # Positions go through single precision twice.
        check(off < 1e-6, f"{name} in frame {frame['number']} is off by {off}")
        check((mathutils.Vector(pieces[name].scale) - mathutils.Vector((1, 1, 1))).length == 0, name + ": scale")
volumes = bpy.data.collections[expected["scene"] + "_damage"].objects
check(sorted(v.name for v in volumes) == sorted(expected["volumes"]), "names of volumes")
for volume in volumes:
    volume.data.grids.load()
    check([g.name for g in volume.data.grids] == ["surface", "damage", "damage_time"], "grids of " + volume.name)
    corners = [volume.matrix_world @ mathutils.Vector(c) for c in volume.bound_box]
    centre = y_up(sum(corners, mathutils.Vector()) / 8)
    off = max(abs(a - b) for a, b in zip(centre, expected["volumes"][volume.name]["centre"]))
    check(off < expected["volumes"][volume.name]["tolerance"], f"{volume.name} is off by {off}")
print("blender_check: all as expected")
