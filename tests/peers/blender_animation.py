"""Animated glTF files beside Blender: masks and depths of pixels' middles, five times of each animation.

    pip install bpy==5.0.1 --extra-index-url https://download.blender.org/pypi/ && pip install OpenEXR
    python tests/peers/blender_animation.py target/release/eyerays FILE.glb...

Without files it makes two of its own: a cube whose shape keys move (morph targets), and an arm of two bones (a skin). Blender imports
each file, evaluates its modifiers at each time, and casts a ray through the middle of every pixel; `eyerays render` writes the depth of
the same pixels.
"""
import json, math, subprocess, sys, tempfile
from pathlib import Path

import bpy, numpy, OpenEXR
from mathutils import Vector

SIZE = 128
# Of the distance, beyond which two depths are of different places.
TOLERANCE = 1e-3


def run(*arguments):
    return subprocess.run(arguments, capture_output=True, text=True, check=True).stdout


def to_blender(v):
    return Vector((v[0], -v[2], v[1]))


def depths_here(program, path, animation, seconds, eye, target):
    text = lambda v: ",".join(repr(float(x)) for x in v)
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "depth.exr")
        run(program, "render", path, "-q", "--device", "cpu", "--animation", animation, "--time", repr(seconds), "--size",
            f"{SIZE}x{SIZE}", "--eye", text(eye), "--target", text(target), "--fov", "45", "--integrator", "whitted",
            "--samples", "1", "--layers", "depth", "-o", out)
        channels = OpenEXR.File(out, separate_channels=True).channels()
        name = next(name for name in channels if name.lower().startswith("depth"))
        return numpy.array(channels[name].pixels, dtype=float).reshape(SIZE, SIZE)


def depths_there(eye, target):
    scene, graph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    origin, forward = to_blender(eye), (to_blender(target) - to_blender(eye)).normalized()
    right = forward.cross(Vector((0, 0, 1))).normalized()
    up, reach = right.cross(forward), math.tan(math.radians(45 / 2))
    found = numpy.full((SIZE, SIZE), numpy.inf)
    for y in range(SIZE):
        for x in range(SIZE):
            across, above = (2 * (x + 0.5) / SIZE - 1) * reach, (1 - 2 * (y + 0.5) / SIZE) * reach
            hit, place, *_ = scene.ray_cast(graph, origin, (forward + right * across + up * above).normalized())
            if hit:
                found[y, x] = (place - origin).dot(forward)
    return found


def play(name, is_only):
    """Has every object follow its track of an animation, and no other."""
    holders = list(bpy.data.objects) + [o.data.shape_keys for o in bpy.data.objects if o.type == "MESH" and o.data.shape_keys]
    for holder in holders:
        data = holder.animation_data
        for track in data.nla_tracks if data else []:
            if track.name == name or is_only:
                strip = track.strips[0]
                data.action = strip.action
                if hasattr(strip, "action_slot"):
                    data.action_slot = strip.action_slot


def compared(program, path):
    animations = json.loads(run(program, "info", path, "--json", "--bvh", "fast"))["animations"]
    worst = 1.0
    for animation in animations:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.scene.render.fps = 1000
        bpy.ops.import_scene.gltf(filepath=str(path))
        for helper in [o for o in bpy.data.objects if "Icosphere" in o.name]:
            bpy.data.objects.remove(helper)
        play(animation["name"], len(animations) == 1)
        for step in range(5):
            seconds = animation["seconds"] * step / 4
            bpy.context.scene.frame_set(int(seconds * 1000), subframe=seconds * 1000 % 1)
            said = json.loads(run(program, "info", path, "--json", "--animation", animation["name"], "--time", repr(seconds), "--bvh", "fast"))
            low, high = map(numpy.array, said["bounds"])
            target, size = (low + high) / 2, numpy.linalg.norm(high - low)
            eye = target + size * numpy.array([0.9, 0.4, 1.0])
            ours, theirs = depths_here(program, path, animation["name"], seconds, eye, target), depths_there(eye, target)
            mask = numpy.isfinite(ours) == numpy.isfinite(theirs)
            both = numpy.isfinite(ours) & numpy.isfinite(theirs)
            near = numpy.abs(ours[both] - theirs[both]) <= TOLERANCE * theirs[both]
            same = 1 - ((~mask).sum() + (~near).sum()) / SIZE**2
            worst = min(worst, same)
            print(f"{Path(path).name} {animation['name']} {seconds:.3f} s: {100 * same:.3f} % of pixels alike, {both.sum()} of them seen by both")
    return worst


def cube_with_shape_keys(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.shape_key_add(name="Basis")
    for name, change in [("wide", lambda v: Vector((v.x * 2, v.y, v.z))), ("bent", lambda v: v + Vector((0, 0, 0.7 * v.x)))]:
        key = cube.shape_key_add(name=name)
        for point in key.data:
            point.co = change(point.co)
    for frame, values in [(1, (0, 0)), (15, (1, 0.2)), (30, (0.3, 1))]:
        for key, value in zip(cube.data.shape_keys.key_blocks[1:], values):
            key.value = value
            key.keyframe_insert("value", frame=frame)
    bpy.ops.export_scene.gltf(filepath=path, export_animations=True)


def arm_of_two_bones(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cylinder_add(vertices=24, depth=4, radius=0.5)
    tube = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=6)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.armature_add(location=(0, 0, -2))
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    first = rig.data.edit_bones[0]
    first.head, first.tail = (0, 0, 0), (0, 0, 2)
    second = rig.data.edit_bones.new("second")
    second.head, second.tail, second.parent = (0, 0, 2), (0, 0, 4), first
    bpy.ops.object.mode_set(mode="OBJECT")
    tube.select_set(True)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    bone = rig.pose.bones["second"]
    bone.rotation_mode = "XYZ"
    for frame, angle in [(1, 0), (15, 1.2), (30, -0.8)]:
        bone.rotation_euler = (angle, 0, angle / 2)
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.ops.export_scene.gltf(filepath=path, export_animations=True)


def main():
    program, *files = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        if not files:
            files = [str(Path(folder) / name) for name in ("morphs.glb", "skin.glb")]
            cube_with_shape_keys(files[0])
            arm_of_two_bones(files[1])
        worst = min(compared(program, path) for path in files)
    print(f"the least alike: {100 * worst:.3f} %")
    sys.exit(0 if worst >= 0.999 else 1)


main()
