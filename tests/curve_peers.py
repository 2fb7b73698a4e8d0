#!/usr/bin/env python3
"""Curves beside Mitsuba's, which meets the curves themselves where this program meets triangles of them.

    pip install mitsuba==3.9.1
    python3 tests/curve_peers.py target/release/eyerays [--device gpu] [--size 64] [--samples 64] [--seeds 16] [SCENE ...]

Both programs render each scene with several seeds; z is that of `media_peers.py`. The last row of each scene is beside Mitsuba's curves
that are a tenth thinner, to show what the comparison can tell. Ends of curves are below the floor, as Mitsuba's are open.
"""

import math
import tempfile
from pathlib import Path

import mitsuba as mi

mi.set_variant("scalar_rgb")

import scene_text  # noqa: E402
from blocks import arguments, blocks, of_eyerays, row  # noqa: E402
from mitsuba_parts import mesh, pictures, read, sensor  # noqa: E402

BOUNCES = 12
SKY = (0.35, 0.38, 0.45)
FLOOR = (-6, 0, 6), (6, 0, 6), (6, 0, -6), (-6, 0, -6)
LAMP = (-1, 3.2, 1), (-1, 3.2, -0.4), (1.4, 3.2, -0.4), (1.4, 3.2, 1)
EYE, TARGET, FOV = (0.4, 1.5, 4.5), (0, 0.55, 0), 30.0
STEEL = {"eta": (2.9, 2.9, 2.6), "k": (3.1, 2.9, 2.8)}


def hair():
    """Locks that bend and get thinner, of 7 points from below the floor to below it again."""
    for number in range(90):
        around, out = 2.399963 * number, 0.13 * math.sqrt(number)
        x, z = out * math.cos(around), out * math.sin(around)
        tall = 0.7 + 0.35 * math.sin(5.0 * number)
        heights = (-0.5, -0.2, 0.5, 1.0, 0.8, -0.2, -0.6)
        yield [(x + 0.07 * k * math.cos(3 * number), tall * height, z + 0.07 * k * math.sin(7 * number), 0.035 - 0.003 * k)
               for k, height in enumerate(heights)]


def wire():
    """A coil that dives into the floor at both of its ends."""
    points = [(1.0 * math.cos(0.7 * k), 0.62 + 0.045 * k * math.sin(1.3 * k), 0.8 * math.sin(0.7 * k), 0.09) for k in range(32)]
    yield [(1.6, -1, 0.4, 0.09), (1.5, -0.8, 0.2, 0.09), (1.3, -0.3, 0.1, 0.09), *points, (1, -0.5, 0, 0.09), (0.9, -1, 0, 0.09), (0.9, -1.4, 0, 0.09)]


# Strands; keys of a scene file's material; Mitsuba's own.
SCENES = {
    "matt hair": (hair, "diffuse = [0.7, 0.5, 0.3]", {"type": "diffuse", "reflectance": {"type": "rgb", "value": (0.7, 0.5, 0.3)}}),
    "steel wire": (
        wire,
        f"roughness = 0.5\nconductor = {{ eta = {list(STEEL['eta'])}, k = {list(STEEL['k'])} }}",
        {"type": "roughconductor", "distribution": "ggx", "alpha": 0.25}
        | {key: {"type": "rgb", "value": value} for key, value in STEEL.items()},
    ),
    "hair": (
        hair,
        "hair = { melanin = 0.3, roughness = 0.3, radial_roughness = 0.3, tilt = 2 }\nior = 1.55",
        {
            "type": "hair",
            "eumelanin": 0.3,
            "pheomelanin": 0.0,
            "longitudinal_roughness": 0.3,
            "azimuthal_roughness": 0.3,
            "scale_tilt": 2.0,
            "int_ior": 1.55,
            "ext_ior": 1.0,
        },
    ),
}


def strands(folder, curves, share=1.0):
    """A file of them, as Mitsuba reads them, whose radii are less by a share."""
    lines = ["\n".join(f"{x:.6f} {y:.6f} {z:.6f} {share * radius:.6f}" for x, y, z, radius in curve) for curve in curves]
    path = folder / "strands.txt"
    path.write_text("\n\n".join(lines) + "\n")
    return path


def write_scene(folder, keys):
    text = scene_text.head(BOUNCES, SKY, (EYE, TARGET, FOV), "\ncompensation = false")
    text += [f'[[material]]\nname = "own"\n{keys}', '[[material]]\nname = "floor"\ndiffuse = [0.6, 0.6, 0.6]']
    text += ['[[material]]\nname = "lamp"\ndiffuse = [0, 0, 0]\nemission = [9, 9, 9]']
    text += ['[[mesh]]\nfile = "strands.txt"\nbasis = "b-spline"\nmaterial = "own"\nsides = 48\ntolerance = 1e-4']
    for corners, material in ((FLOOR, "floor"), (LAMP, "lamp")):
        text += [scene_text.quad(corners, material)]
    (folder / "scene.toml").write_text("\n".join(text) + "\n")


def quad(name, corners, bsdf, light=None):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    if light:
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": {"type": "rgb", "value": light}})
    return mesh(name, corners, [(0, 1, 2), (0, 2, 3)], properties)


def of_mitsuba(asked, path, bsdf):
    matt = lambda value: {"type": "diffuse", "reflectance": {"type": "rgb", "value": value}}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": BOUNCES + 1, "rr_depth": 1000},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": SKY}},
        "camera": sensor(asked, EYE, TARGET, FOV),
        "curves": {"type": "bsplinecurve", "filename": str(path), "bsdf": bsdf},
        "floor": quad("floor", FLOOR, {"type": "twosided", "of": matt(0.6)}),
        "lamp": quad("lamp", LAMP, matt(0.0), 9.0),
    }
    yield from pictures(asked, scene)


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        of, keys, bsdf = SCENES[name]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            strands(folder, of())
            write_scene(folder, keys)
            own = blocks(of_eyerays(asked, folder, read))
            for other, share in (("Mitsuba", 1.0), ("Mitsuba, a tenth thinner", 0.9)):
                row(name, other, own, of_mitsuba(asked, strands(folder, of(), share), bsdf))


if __name__ == "__main__":
    main()
