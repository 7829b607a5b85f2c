"""Loads what this folder holds into Blender: fragments with their motion, and damage volumes.

    blender --python-exit-code 1 -P import_blender.py
    blender -b --python-exit-code 1 -P import_blender.py -- --save shatter.blend

Or open it in Blender's text editor and run it. Needs Blender 3.3 or newer. The scene's frame rate and range become those of the
run; nothing that is there already is removed. docs/blender.md of Sunder explains what comes in.
"""

import argparse
import json
import math
import re
import struct
import sys
from pathlib import Path

import bpy
import numpy

# Blender up to 3.4 uses a name in its glTF importer that numpy 1.24 has dropped.
if "bool" not in numpy.__dict__:
    numpy.bool = bool

FOLDER = Path(__file__).resolve().parent if "__file__" in globals() else Path(bpy.context.space_data.text.filepath).parent


class Timing:
    """Frame numbers of the run, and how Blender counts them."""

    def __init__(self, frames):
        self.rate = frames["rate"]
        self.first = frames["first"]
        self.last = self.first + frames["count"] - 1

    def apply(self, scene):
        scene.render.fps = max(1, math.ceil(self.rate - 1e-9))
        scene.render.fps_base = scene.render.fps / self.rate
        scene.frame_start, scene.frame_end = self.first, self.last
        scene.frame_set(self.first)

    def frame_of_imported(self, frame, fps):
        """The importer puts t = 0 on frame 0 and knows no fractional frame rates."""
        number = self.first + frame / fps * self.rate
        return round(number) if abs(number - round(number)) < 1e-3 else number


def new_collection(name):
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    return collection


def move_to(collection, thing):
    for other in list(thing.users_collection):
        other.objects.unlink(thing)
    collection.objects.link(thing)


def key_visibility(thing, switches):
    """switches: (frame, visible) by rising frame."""
    for frame, visible in switches:
        for path in ("hide_viewport", "hide_render"):
            setattr(thing, path, not visible)
            thing.keyframe_insert(path, frame=frame)
    for curve in thing.animation_data.action.fcurves:
        if curve.data_path.startswith("hide_"):
            for point in curve.keyframe_points:
                point.interpolation = "CONSTANT"


def retime(thing, timing, fps):
    if not thing.animation_data or not thing.animation_data.action:
        return
    for curve in thing.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            for handle in ("handle_left", "handle_right"):
                at = getattr(point, handle)
                setattr(point, handle, (timing.frame_of_imported(at[0], fps), at[1]))
            point.co[0] = timing.frame_of_imported(point.co[0], fps)
        curve.update()


def visibility_for_scale(thing):
    """glTF can only hide a piece by scaling it to nothing; Blender has a switch for it."""
    switches = []
    if thing.animation_data and thing.animation_data.action:
        curves = thing.animation_data.action.fcurves
        for curve in [c for c in curves if c.data_path == "scale"]:
            if curve.array_index == 0:
                switches = [(point.co[0], point.co[1] > 0.5) for point in curve.keyframe_points]
            curves.remove(curve)
    visible = thing.scale[0] > 0.5
    thing.scale = (1, 1, 1)
    if switches:
        key_visibility(thing, switches)
    elif not visible:
        thing.hide_viewport = thing.hide_render = True


def read_glb(file):
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    return document, data[20 + length + 8 :]


def accessor_values(document, binary, index, width):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    offset = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", 4 * width)
    return numpy.ndarray((accessor["count"], width), "<f4", binary, offset, (stride, 4))


def damage_times_by_position(document, binary, mesh):
    times = {}
    for primitive in mesh["primitives"]:
        attributes = primitive["attributes"]
        if "_DAMAGE_TIME" not in attributes:
            continue
        positions = accessor_values(document, binary, attributes["POSITION"], 3)
        values = accessor_values(document, binary, attributes["_DAMAGE_TIME"], 1)[:, 0]
        for at, time in zip(positions.tolist(), values.tolist()):
            times[tuple(at)] = max(time, times.get(tuple(at), -1.0))
    return times


def add_damage_times(pieces, file):
    """Blender's importer drops attributes of names that it does not know."""
    document, binary = read_glb(file)
    for node in document.get("nodes", []):
        piece = pieces.get(node.get("name"))
        if piece is None or "mesh" not in node:
            continue
        times = damage_times_by_position(document, binary, document["meshes"][node["mesh"]])
        if not times:
            continue
        mesh = piece.data
        attribute = mesh.attributes.new("damage_time", "FLOAT", "POINT")
        # The importer turns (x, y, z) into (x, -z, y).
        attribute.data.foreach_set("value", [times.get((v.co.x, v.co.z, -v.co.y), -1.0) for v in mesh.vertices])


def import_fragments(file, timing, name):
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(file), merge_vertices=True)
    collection = new_collection(name)
    pieces = {}
    for thing in [t for t in bpy.data.objects if t not in before]:
        move_to(collection, thing)
        retime(thing, timing, bpy.context.scene.render.fps)
        visibility_for_scale(thing)
        pieces[thing.name] = thing
    add_damage_times(pieces, file)
    return len(pieces)


def import_obj_frames(files, timing, name):
    """Without fragments.glb: all meshes of all frames, each shown in its own frame."""
    collection = new_collection(name)
    for frame, file in files:
        before = set(bpy.data.objects)
        bpy.ops.wm.obj_import(filepath=str(file))
        for thing in [t for t in bpy.data.objects if t not in before]:
            move_to(collection, thing)
            key_visibility(thing, [(frame - 1, False), (frame, True), (frame + 1, False)])
    return len(files)


def import_volumes(files, name):
    """A damage volume lies where its piece was when it was hit, and shows in that frame."""
    collection = new_collection(name + "_damage")
    for frame, file in files:
        volume = bpy.data.volumes.new(file.stem)
        volume.filepath = str(file)
        thing = bpy.data.objects.new(file.stem, volume)
        thing.rotation_euler = (math.pi / 2, 0, 0)  # volumes come in without the turn from Y up to Z up
        collection.objects.link(thing)
        key_visibility(thing, [(frame - 1, False), (frame, True), (frame + 1, False)])
    return len(files)


def numbered(pattern, files):
    found = [(re.fullmatch(pattern, file.name), file) for file in files]
    return sorted((int(match.group(1)), file) for match, file in found if match)


def main():
    parser = argparse.ArgumentParser(prog="import_blender.py", description="Load a run of Sunder")
    parser.add_argument("--save", metavar="FILE", help="save as this .blend file afterwards")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])

    report = json.loads((FOLDER / "report.json").read_text())
    name = report["scene"]
    timing = Timing(report["frames"])
    timing.apply(bpy.context.scene)
    glb = FOLDER / "fragments.glb"
    frames = numbered(re.escape(name) + r"\.(-?\d+)\.obj", FOLDER.glob("*.obj"))
    volumes = numbered(r".+\.(-?\d+)\.vdb", (FOLDER / "vdb").glob("*.vdb"))
    if not glb.exists() and not frames:
        raise SystemExit(f"{FOLDER} holds neither fragments.glb nor {name}.####.obj")
    if glb.exists():
        print(f"Sunder: {import_fragments(glb, timing, name)} pieces")
    else:
        print(f"Sunder: {import_obj_frames(frames, timing, name)} frames")
    if volumes:
        print(f"Sunder: {import_volumes(volumes, name)} damage volumes")
    bpy.context.scene.frame_set(timing.first)
    if arguments.save:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(arguments.save).resolve()))


main()
