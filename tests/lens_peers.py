#!/usr/bin/env python3
"""Depth of field beside Mitsuba (`thinlens`) and Cycles: three scenes, the same triangles, materials and lens in each.

    pip install mitsuba numpy bpy
    python3 tests/lens_peers.py target/release/eyerays [--device gpu] [--size 64] [--samples 64] [--seeds 16] [SCENE ...]

Every program renders each scene with several seeds. An image is divided into 64 blocks; z is the difference of a block's means between
two programs, divided by its standard error, which comes of the seeds. With 16 seeds each, z of equal means is Student's t with about 30
degrees of freedom: of 64 blocks the greatest is below 3.9 in 95 of 100 images. The last row of each scene is beside a lens that is 5 %
wider, to show what the comparison can tell. Blocks without any light do not count.
"""

import contextlib
import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import mathutils
import mitsuba as mi
import numpy as np

from blocks import arguments, blocks, of_eyerays, row

mi.set_variant("scalar_rgb")

# Paths are followed until nothing is left of them: programs count bounces otherwise.
BOUNCES = 24


def quad(a, b, c, d):
    return [a, b, c, d], [(0, 1, 2), (0, 2, 3)]


def box(low, high):
    (x, y, z), (u, v, w) = low, high
    corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z), (x, y, w), (u, y, w), (u, v, w), (x, v, w)]
    sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5)]
    return corners, [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]


def lamps():
    """Small lights before black, from half the focus' distance to three times it."""
    surfaces = []
    for i in range(12):
        depth = 2.0 + i
        x, y = 0.28 * depth * math.cos(2.4 * i), 0.28 * depth * math.sin(2.4 * i)
        corners = [(x - 0.1, y - 0.1, -depth), (x + 0.1, y - 0.1, -depth), (x + 0.1, y + 0.1, -depth), (x - 0.1, y + 0.1, -depth)]
        surfaces.append((*quad(*corners), (0, 0, 0), (3.0, 2.0 + 0.2 * i, 1.0 + 0.3 * i)))
    return surfaces, (0, 0, 0), dict(eye=(0, 0, 0), target=(0, 0, -1), fov=50.0, aperture=0.15, focus=5.0)


def posts():
    """Boxes one behind the other under a sky."""
    surfaces = [(*quad((-20, 0, 20), (20, 0, 20), (20, 0, -30), (-20, 0, -30)), (0.4, 0.38, 0.35), (0, 0, 0))]
    colours = [(0.5, 0.1, 0.1), (0.1, 0.45, 0.15), (0.1, 0.2, 0.5), (0.5, 0.45, 0.1)]
    for i in range(10):
        z, x = -1.5 * i, 0.9 * math.sin(1.9 * i)
        surfaces.append((*box((x - 0.25, 0, z - 0.25), (x + 0.25, 0.6 + 0.25 * (i % 3), z + 0.25)), colours[i % 4], (0, 0, 0)))
    return surfaces, (0.7, 0.8, 1.0), dict(eye=(0.4, 1.6, 4.0), target=(0.0, 0.4, -4.0), fov=40.0, aperture=0.2, focus=7.0)


def hall():
    """Tiles of two colours and pillars below a lamp; the focus is on the middle."""
    surfaces = []
    for i in range(8):
        for k in range(8):
            x, z = i - 4.0, -k
            colour = (0.5, 0.5, 0.5) if (i + k) % 2 else (0.08, 0.06, 0.05)
            surfaces.append((*quad((x, 0, z), (x + 1, 0, z), (x + 1, 0, z - 1), (x, 0, z - 1)), colour, (0, 0, 0)))
    for k in range(4):
        for x in (-2.1, 1.9):
            surfaces.append((*box((x, 0, -2.0 * k - 1.1), (x + 0.2, 3, -2.0 * k - 0.9)), (0.45, 0.3, 0.2), (0, 0, 0)))
    surfaces.append((*quad((-4, 0, -8), (4, 0, -8), (4, 4, -8), (-4, 4, -8)), (0.3, 0.4, 0.5), (0, 0, 0)))
    surfaces.append((*quad((-1, 4, -3), (-1, 4, -5), (1, 4, -5), (1, 4, -3)), (0, 0, 0), (12.0, 11.0, 9.0)))
    return surfaces, (0.05, 0.05, 0.06), dict(eye=(0.3, 1.4, 2.5), target=(0, 1.0, -3), fov=55.0, aperture=0.12, focus=5.5)


SCENES = {"lamps": lamps, "posts": posts, "hall": hall}


def write_scene(folder, surfaces, sky, camera):
    obj, mtl, first = ["mtllib scene.mtl"], [], 1
    for number, (vertices, faces, colour, light) in enumerate(surfaces):
        mtl += [f"newmtl m{number}", "Kd %g %g %g" % colour, "Ke %g %g %g" % light]
        obj += [f"usemtl m{number}"] + ["v %r %r %r" % tuple(map(float, v)) for v in vertices]
        obj += ["f %d %d %d" % tuple(first + i for i in face) for face in faces]
        first += len(vertices)
    (folder / "scene.obj").write_text("\n".join(obj) + "\n")
    (folder / "scene.mtl").write_text("\n".join(mtl) + "\n")
    lens = "\n".join(f"{key} = {list(value) if isinstance(value, tuple) else value}" for key, value in camera.items())
    lit = "light = []\n"
    (folder / "scene.toml").write_text(
        f'{lit}[render]\nintegrator = "path"\nsampler = "sobol"\nbounces = {BOUNCES}\npixel_filter = "box"\n'
        f"[background]\ncolor = {list(sky)}\n[[camera]]\nname = \"lens\"\n{lens}\n[[mesh]]\nfile = \"scene.obj\"\n"
    )


def read(path):
    return np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def of_mitsuba(asked, surfaces, sky, camera):
    T = mi.ScalarTransform4f
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": BOUNCES + 1, "rr_depth": 1000},
        "sensor": {
            "type": "thinlens",
            "fov": camera["fov"],
            "fov_axis": "y",
            "aperture_radius": camera["aperture"],
            "focus_distance": camera["focus"],
            "to_world": T().look_at(list(camera["eye"]), list(camera["target"]), [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": asked.size, "height": asked.size, "rfilter": {"type": "box"},
                     "component_format": "float32", "pixel_format": "rgb"},
            "sampler": {"type": "independent", "sample_count": asked.samples},
        },
    }
    if any(sky):
        scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(sky)}}
    for number, (vertices, faces, colour, light) in enumerate(surfaces):
        properties = mi.Properties()
        diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(colour)}}
        properties["bsdf"] = mi.load_dict({"type": "twosided", "inner": diffuse})
        if any(light):
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": list(light)}})
        mesh = mi.Mesh(f"m{number}", len(vertices), len(faces), props=properties)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = np.array(vertices, dtype=np.float32).ravel()
        parameters["faces"] = np.array(faces, dtype=np.uint32).ravel()
        parameters.update()
        scene[f"m{number}"] = mesh
    scene = mi.load_dict(scene)
    for seed in range(asked.seeds):
        yield np.array(mi.render(scene, seed=seed))


def material_of_cycles(number, colour, light):
    material = bpy.data.materials.new(f"m{number}")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shines = any(light)
    shader = nodes.new("ShaderNodeEmission" if shines else "ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*(light if shines else colour), 1.0)
    material.node_tree.links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def of_cycles(asked, folder, surfaces, sky, camera):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    for number, (vertices, faces, colour, light) in enumerate(surfaces):
        mesh = bpy.data.meshes.new(f"m{number}")
        mesh.from_pydata(vertices, [], faces)
        mesh.materials.append(material_of_cycles(number, colour, light))
        scene.collection.objects.link(bpy.data.objects.new(f"m{number}", mesh))
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*sky, 1.0)
    lens = bpy.data.cameras.new("lens")
    lens.sensor_fit, lens.sensor_height = "VERTICAL", 24.0
    lens.lens = 12.0 / math.tan(math.radians(camera["fov"]) / 2)
    lens.dof.use_dof, lens.dof.focus_distance = True, camera["focus"]
    lens.dof.aperture_fstop = lens.lens * 1e-3 / (2 * camera["aperture"])
    eye, target = mathutils.Vector(camera["eye"]), mathutils.Vector(camera["target"])
    back = (eye - target).normalized()
    right = mathutils.Vector((0, 1, 0)).cross(back).normalized()
    axes = mathutils.Matrix((right, back.cross(right), back)).transposed().to_4x4()
    scene.camera = bpy.data.objects.new("lens", lens)
    scene.camera.matrix_world = mathutils.Matrix.Translation(eye) @ axes
    scene.collection.objects.link(scene.camera)
    render, cycles = scene.render, scene.cycles
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", asked.size, asked.size
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = asked.samples, False, False
    cycles.pixel_filter_type, cycles.light_sampling_threshold = "BOX", 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = BOUNCES
    for seed in range(asked.seeds):
        cycles.seed = seed
        render.filepath = str(folder / "cycles.exr")
        with quiet():
            bpy.ops.render.render(write_still=True)
        yield np.array(mi.Bitmap(render.filepath).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


@contextlib.contextmanager
def quiet():
    """Blender says on standard output what it writes."""
    sys.stdout.flush()
    own, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        os.dup2(own, 1)
        os.close(own)
        os.close(nothing)


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        surfaces, sky, camera = SCENES[name]()
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_scene(folder, surfaces, sky, camera)
            own = blocks(of_eyerays(asked, folder, read))
            wider = dict(camera, aperture=1.05 * camera["aperture"])
            others = {
                "Mitsuba thinlens": of_mitsuba(asked, surfaces, sky, camera),
                "Cycles": of_cycles(asked, folder, surfaces, sky, camera),
                "Mitsuba, 5 % wider": of_mitsuba(asked, surfaces, sky, wider),
            }
            for other, pictures in others.items():
                row(name, other, own, pictures)


if __name__ == "__main__":
    main()
