#!/usr/bin/env python3
"""What lies on surfaces beside Cycles, Blender's renderer: coats, sheen, diffuse transmission and films on the same quads.

    pip install bpy==5.0.1 --extra-index-url https://download.blender.org/pypi/ && pip install OpenEXR numpy
    python3 tests/finish_peers.py target/release/eyerays [--device gpu] [--size 64] [--samples 64] [--seeds 16] [SCENE ...]

Both programs render each scene with several seeds; z is that of `media_peers.py`. The last row of each scene is beside Cycles where
what the scene is about is a tenth weaker, to show what the comparison can tell. Models differ in part: Cycles' coat reflects as
Fresnel's equations say, this program's by Schlick's approximation, as glTF has it; its film is seen by tables of the eye.
"""

import math
import tempfile
from pathlib import Path

import bpy
import mathutils
import numpy as np
import OpenEXR

import scene_text
from blocks import arguments, blocks, of_eyerays, row

BOUNCES = 32
SKY = (0.25, 0.28, 0.35)
FLOOR = (-6, 0, 6), (6, 0, 6), (6, 0, -6), (-6, 0, -6)
WALL = (-1.6, 0.1, -0.6), (1.2, 0.1, -1.2), (1.2, 2.0, -1.0), (-1.6, 2.0, -0.4)
LAMP = (-1, 3.2, 1), (-1, 3.2, -0.4), (1.4, 3.2, -0.4), (1.4, 3.2, 1)
BEHIND = (-1, 0.2, -3), (-1, 2.4, -3), (1, 2.4, -3), (1, 0.2, -3)
EYE, TARGET, FOV = (0.4, 1.3, 4.5), (0, 0.9, 0), 40.0

# Keys of a scene file, and inputs of Blender's Principled BSDF or of a mixture of its diffuse and translucent ones; the key to weaken.
SCENES = {
    "coat on paint": (
        "base_color = [0.6, 0.15, 0.1]\nspecular_weight = 0\nroughness = 1\ncoat = { weight = 1, roughness = 0.3 }",
        {"Base Color": (0.6, 0.15, 0.1), "Specular IOR Level": 0, "Roughness": 1, "Coat Weight": 1, "Coat Roughness": 0.3},
        "Coat Weight",
    ),
    "coat on metal": (
        "base_color = [0.9, 0.6, 0.3]\nmetallic = 1\nroughness = 0.5\ncoat = { weight = 0.8, roughness = 0.15 }",
        {"Base Color": (0.9, 0.6, 0.3), "Metallic": 1, "Roughness": 0.5, "Coat Weight": 0.8, "Coat Roughness": 0.15},
        "Coat Weight",
    ),
    "sheen": (
        "base_color = [0.1, 0.05, 0.1]\nspecular_weight = 0\nroughness = 1\nsheen = { color = [0.9, 0.6, 0.8], roughness = 0.4 }",
        {"Base Color": (0.1, 0.05, 0.1), "Specular IOR Level": 0, "Roughness": 1, "Sheen Weight": 1, "Sheen Roughness": 0.4,
         "Sheen Tint": (0.9, 0.6, 0.8)},
        "Sheen Weight",
    ),
    "leaf": (
        "base_color = [0.3, 0.6, 0.2]\nspecular_weight = 0\nroughness = 1\n"
        "diffuse_transmission = { weight = 0.4, color = [0.5, 0.7, 0.1] }",
        {"near": (0.3, 0.6, 0.2), "far": (0.5, 0.7, 0.1), "share": 0.4},
        "share",
    ),
    "film": (
        "base_color = [0, 0, 0]\nior = 1.8\nroughness = 0.3\nfilm = { ior = 1.33, thickness = 450 }",
        {"Base Color": (0, 0, 0), "IOR": 1.8, "Roughness": 0.3, "Thin Film Thickness": 450, "Thin Film IOR": 1.33},
        "Thin Film Thickness",
    ),
}


def write_scene(folder, keys):
    text = scene_text.head(BOUNCES, SKY, (EYE, TARGET, FOV))
    text += [f'[[material]]\nname = "own"\n{keys}']
    for name, light in (("lamp", 8.0), ("behind", 5.0)):
        text += [f'[[material]]\nname = "{name}"\ndiffuse = [0, 0, 0]\nemission = {[light] * 3}']
    for corners, material in ((FLOOR, "own"), (WALL, "own"), (LAMP, "lamp"), (BEHIND, "behind")):
        text += [scene_text.quad(corners, material)]
    (folder / "scene.toml").write_text("\n".join(text) + "\n")


def read(path):
    channels = OpenEXR.File(str(path)).channels()
    return np.asarray(channels["RGBA" if "RGBA" in channels else "RGB"].pixels)[..., :3]


def in_blender(place):
    """Blender's third axis is up."""
    x, y, z = place
    return x, -z, y


def quad(name, corners, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([in_blender(corner) for corner in corners], [], [(0, 1, 2), (0, 2, 3)])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def node_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    return material, nodes, material.node_tree.links, nodes.new("ShaderNodeOutputMaterial")


def lamp(name, strength):
    """It shines from its front alone."""
    material, nodes, links, output = node_material(name)
    light, dark, mix, place = (nodes.new(f"ShaderNode{of}") for of in ("Emission", "Emission", "MixShader", "NewGeometry"))
    light.inputs["Strength"].default_value, dark.inputs["Strength"].default_value = strength, 0
    links.new(place.outputs["Backfacing"], mix.inputs["Fac"])
    links.new(light.outputs[0], mix.inputs[1])
    links.new(dark.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return material


def surface(inputs):
    material, nodes, links, output = node_material("own")
    if "share" in inputs:
        near, far, mix = (nodes.new(f"ShaderNode{of}") for of in ("BsdfDiffuse", "BsdfTranslucent", "MixShader"))
        near.inputs["Color"].default_value, far.inputs["Color"].default_value = (*inputs["near"], 1), (*inputs["far"], 1)
        mix.inputs["Fac"].default_value = inputs["share"]
        links.new(near.outputs[0], mix.inputs[1])
        links.new(far.outputs[0], mix.inputs[2])
        links.new(mix.outputs[0], output.inputs["Surface"])
        return material
    own = nodes.new("ShaderNodeBsdfPrincipled")
    own.distribution = "MULTI_GGX"
    for key, value in inputs.items():
        own.inputs[key].default_value = (*value, 1) if isinstance(value, tuple) else value
    links.new(own.outputs[0], output.inputs["Surface"])
    return material


def of_cycles(asked, folder, inputs):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    own = surface(inputs)
    for name, corners, material in (("floor", FLOOR, own), ("wall", WALL, own), ("lamp", LAMP, lamp("lamp", 8)), ("behind", BEHIND, lamp("behind", 5))):
        quad(name, corners, material)
    yield from pictures(asked, folder, BOUNCES)


def pictures(asked, folder, bounces):
    """What Cycles sees of the things in Blender's scene, a seed each."""
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("front")
    camera.sensor_fit, camera.angle = "VERTICAL", math.radians(FOV)
    front = bpy.data.objects.new("front", camera)
    eye, target = mathutils.Vector(in_blender(EYE)), mathutils.Vector(in_blender(TARGET))
    front.location, front.rotation_euler = eye, (target - eye).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(front)
    scene.camera, scene.world = front, bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*SKY, 1)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = asked.size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = asked.samples, False, False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type = "BOX"
    cycles.blur_glossy = 0
    for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{kind}_bounces", bounces)
    scene.render.filepath = str(folder / "cycles.exr")
    for seed in range(asked.seeds):
        cycles.seed = seed
        bpy.ops.render.render(write_still=True)
        yield read(folder / "cycles.exr")


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        keys, inputs, weakened = SCENES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_scene(folder, keys)
            own = blocks(of_eyerays(asked, folder, read))
            for other, of in {"Cycles": inputs, "Cycles, a tenth weaker": {**inputs, weakened: 0.9 * inputs[weakened]}}.items():
                row(name, other, own, of_cycles(asked, folder, of))


if __name__ == "__main__":
    main()
