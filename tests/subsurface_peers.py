#!/usr/bin/env python3
"""Wax, skin and a thin slab beside Cycles, Blender's renderer: as volumes, which are the same physics in both, and as its subsurface.

    pip install bpy==5.0.1 --extra-index-url https://download.blender.org/pypi/ && pip install OpenEXR numpy
    python3 tests/subsurface_peers.py target/release/eyerays [--device gpu] [--size 64] [--samples 64] [--seeds 16] [SCENE ...]

Both programs render each scene with several seeds; z is that of `media_peers.py`. A body has a colour and a mean free path for each
channel; this program's own volume of them is seen open, without a surface, and below glass. It is beside a volume of the same
coefficients in Cycles, beside one that scatters a tenth less, to show what the comparison can tell, and beside the random walk of Cycles'
Principled BSDF of the same colour and mean free paths. That one is another model: its albedos are of another fit, light leaves it as
from a matt surface, nothing is reflected back inside, and a walk ends after 256 collisions. Its mean free path is the radius divided by
4 pi. Below glass there is much noise: take 128 samples.
"""

import math
import tempfile
from pathlib import Path

import bpy

import scene_text
from blocks import arguments, blocks, of_eyerays, row
from finish_peers import EYE, FLOOR, FOV, LAMP, SKY, TARGET, in_blender, lamp, node_material, pictures, quad, read

# The most that Cycles counts: paths are followed until nothing is left of them.
BOUNCES = 1024
GREY = 0.4
BEHIND = (-1, 0.2, -1.5), (1, 0.2, -1.5), (1, 2.0, -1.5), (-1, 2.0, -1.5)
IOR = 1.4


def box(low, high):
    (x, y, z), (u, v, w) = low, high
    corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z), (x, y, w), (u, y, w), (u, v, w), (x, v, w)]
    sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5)]
    return corners, [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]


def icosahedron(center, radius):
    long = (1 + math.sqrt(5)) / 2
    scale = radius / math.hypot(1, long)
    corners = [(-1, long, 0), (1, long, 0), (-1, -long, 0), (1, -long, 0), (0, -1, long), (0, 1, long), (0, -1, -long), (0, 1, -long),
               (long, 0, -1), (long, 0, 1), (-long, 0, -1), (-long, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return [tuple(round(at + scale * own, 6) for at, own in zip(center, corner)) for corner in corners], faces


# The body's corners and faces, its colour and mean free paths, and the radiance of the lamps above and behind.
BODIES = {
    "wax": (box((-0.8, 0.1, -0.7), (0.6, 1.5, 0.5)), (0.8, 0.8, 0.8), (0.1, 0.1, 0.1), 8, 0),
    "skin": (icosahedron((0, 0.95, 0), 0.85), (0.8, 0.5, 0.4), (0.3, 0.15, 0.08), 8, 0),
    "slab": (box((-1.2, 0.1, -0.06), (1.2, 1.9, 0.06)), (0.8, 0.7, 0.5), (0.08, 0.06, 0.05), 0, 8),
}
SCENES = {f"{name}, {seen}": (*body, seen) for name, body in BODIES.items() for seen in ("open", "below glass")}


def lamps(above, behind):
    return [of for of in (("lamp", LAMP, above), ("behind", BEHIND, behind)) if of[2]]


def coefficients(colour, distance):
    """Scattering and absorption, as docs/media.md has them: by the albedo of Kulla and Conty, 2017."""
    root = [4.09712 + 4.20863 * c - math.sqrt(9.59217 + 41.6808 * c + 17.7126 * c * c) for c in colour]
    return [(1 - s * s) / d for s, d in zip(root, distance)], [s * s / d for s, d in zip(root, distance)]


def write_scene(folder, body, colour, distance, above, behind, seen):
    corners, faces = body
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / "body.obj").write_text("\n".join(lines) + "\n")
    text = scene_text.head(BOUNCES, SKY, (EYE, TARGET, FOV))
    text += [f'[[material]]\nname = "floor"\ndiffuse = {[GREY] * 3}']
    for name, _, light in lamps(above, behind):
        text += [f'[[material]]\nname = "{name}"\ndiffuse = [0, 0, 0]\nemission = {[light] * 3}']
    volume = f"color = {list(colour)}, distance = {list(distance)}"
    if seen == "open":
        text += [f'[[material]]\nname = "body"\nvolume = {{ {volume}, interface = false }}']
    else:
        text += [f'[[material]]\nname = "body"\ntransmission = [1, 1, 1]\nior = {IOR}\nvolume = {{ {volume} }}']
    for name, corners, _ in [("floor", FLOOR, 0), *lamps(above, behind)]:
        text += [scene_text.quad(corners, name)]
    text += ['[[mesh]]\nfile = "body.obj"\nmaterial = "body"']
    (folder / "scene.toml").write_text("\n".join(text) + "\n")


def floor():
    material, nodes, links, output = node_material("floor")
    matt = nodes.new("ShaderNodeBsdfDiffuse")
    matt.inputs["Color"].default_value = (GREY, GREY, GREY, 1)
    links.new(matt.outputs[0], output.inputs["Surface"])
    return material


def volume(colour, distance, seen, share=1.0):
    """What the own program's body is of."""
    material, nodes, links, output = node_material("body")
    inside = nodes.new("ShaderNodeVolumeCoefficients")
    scattering, absorption = coefficients(colour, distance)
    inside.inputs["Scatter Coefficients"].default_value = [share * c for c in scattering]
    inside.inputs["Absorption Coefficients"].default_value = absorption
    links.new(inside.outputs[0], output.inputs["Volume"])
    if seen != "open":
        glass = nodes.new("ShaderNodeBsdfGlass")
        glass.inputs["Color"].default_value = (1, 1, 1, 1)
        glass.inputs["Roughness"].default_value, glass.inputs["IOR"].default_value = 0, IOR
        links.new(glass.outputs[0], output.inputs["Surface"])
    return material


def subsurface(colour, distance, seen):
    """The same colour and mean free paths by the Principled BSDF: with its reflection, if what it is beside is below glass."""
    material, nodes, links, output = node_material("body")
    own = nodes.new("ShaderNodeBsdfPrincipled")
    own.distribution, own.subsurface_method = "MULTI_GGX", "RANDOM_WALK"
    inputs = {"Base Color": (*colour, 1), "Subsurface Weight": 1, "Subsurface Radius": distance, "Subsurface Scale": 4 * math.pi,
              "Roughness": 0 if seen != "open" else 1, "IOR": IOR, "Specular IOR Level": 0.5 if seen != "open" else 0}
    for key, value in inputs.items():
        own.inputs[key].default_value = value
    links.new(own.outputs[0], output.inputs["Surface"])
    return material


def of_cycles(asked, folder, body, above, behind, material, *of):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    quad("floor", FLOOR, floor())
    for name, corners, light in lamps(above, behind):
        quad(name, corners, lamp(name, light))
    corners, faces = body
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata([in_blender(corner) for corner in corners], [], faces)
    mesh.materials.append(material(*of))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("body", mesh))
    yield from pictures(asked, folder, BOUNCES)


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        body, colour, distance, above, behind, seen = SCENES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_scene(folder, *SCENES[name])
            own = blocks(of_eyerays(asked, folder, read))
            others = {
                "Cycles, a volume": (volume, colour, distance, seen),
                "Cycles, a volume that scatters a tenth less": (volume, colour, distance, seen, 0.9),
                "Cycles, subsurface": (subsurface, colour, distance, seen),
            }
            for other, of in others.items():
                row(name, other, own, of_cycles(asked, folder, body, above, behind, *of))


if __name__ == "__main__":
    main()
