#!/usr/bin/env python3
"""What is between surfaces beside Mitsuba (`volpath`): six scenes with the same triangles, lamps and media in both.

    pip install mitsuba numpy
    python3 tests/media_peers.py target/release/eyerays [--device gpu] [--size 64] [--samples 64] [--seeds 16] [SCENE ...]

Both programs render each scene with several seeds. An image is divided into 64 blocks; z is the difference of a block's means between
them, divided by its standard error, which comes of the seeds. With 16 seeds each, z of equal means is Student's t with about 30 degrees of
freedom: of 64 blocks the greatest is below 3.9 in 95 of 100 images. The last row of each scene is beside media that are 5 % denser, to
show what the comparison can tell. Blocks without any light do not count.
"""

import struct
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

import scene_text
from blocks import arguments, blocks, of_eyerays, row
from mitsuba_parts import mesh, pictures, read, sensor

mi.set_variant("scalar_rgb")

# Paths are followed until nothing is left of them: programs count bounces otherwise.
BOUNCES = 200

FLOOR = ((-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)), (0.5, 0.45, 0.4), (0, 0, 0)
LAMP = ((-1, 3, 1), (-1, 3, -1), (1, 3, -1), (1, 3, 1)), (0, 0, 0), (6, 5.5, 5)
BACK = ((-4, 0, -4), (4, 0, -4), (4, 4, -4), (-4, 4, -4)), (0.2, 0.4, 0.6), (0, 0, 0)


def medium(low, high, scattering, absorption, g=0.0, glass=0.0, grid=None):
    """A box of a medium, below glass of an index, or as a grid says."""
    return dict(low=low, high=high, scattering=scattering, absorption=absorption, g=g, glass=glass, grid=grid)


def smoke():
    """Numbers of 24 x 30 x 20 cells, x last."""
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in (20, 30, 24)), indexing="ij")
    ball = np.clip(1.1 - np.sqrt(x * x + y * y + z * z), 0, None)
    return (4 * ball * (1 + np.sin(7 * x + 3 * y) * np.cos(5 * z))).astype(np.float32)


def fog():
    """All is within; the camera, too."""
    return [FLOOR, LAMP, BACK], [medium((-6, -1, -5), (6, 5, 8), (0.06, 0.08, 0.1), (0.02, 0.02, 0.02), 0.5)]


def cloud():
    """White and dense."""
    return [FLOOR, LAMP, BACK], [medium((-1, 0.5, -1), (1, 2, 1), (4, 4, 4), (0.02, 0.05, 0.1))]


def forward():
    """Coloured, and scattering forward."""
    return [FLOOR, LAMP, BACK], [medium((-1, 0.3, -1), (1, 1.9, 1), (2, 1, 0.3), (0.1, 0.4, 1.0), 0.8)]


def murky():
    """Below a surface of glass."""
    return [FLOOR, LAMP, BACK], [medium((-1, 0.3, -1), (1, 1.9, 1), (3, 3, 3), (0.1, 0.3, 0.6), 0.3, glass=1.5)]


def grid():
    """As dense as numbers in space say."""
    return [FLOOR, LAMP, BACK], [medium((-1, 0.3, -1), (1, 2.3, 1), (1.5, 1.2, 1.0), (0.1, 0.2, 0.4), 0.4, grid=smoke())]


def things():
    """Two media, and a surface within one of them."""
    within = ((-0.8, 1.0, 0.4), (0.2, 0.6, 0.4), (0.2, 1.6, -0.4), (-0.8, 1.8, -0.4)), (0.7, 0.2, 0.1), (0, 0, 0)
    one = medium((-1.2, 0.2, -1), (0.4, 2, 1), (1, 1, 1), (0.1, 0.1, 0.1), -0.4)
    other = medium((0.6, 0.2, -0.5), (1.6, 1.4, 0.5), (0.2, 1, 3), (1, 0.3, 0.1), 0.6)
    return [FLOOR, LAMP, BACK, within], [one, other]


SCENES = dict(fog=fog, cloud=cloud, forward=forward, murky=murky, grid=grid, things=things)
EYE, TARGET, FOV = (0.6, 1.5, 5.5), (0, 1.1, 0), 42.0


def denser(of, share):
    """The same medium with all coefficients multiplied."""
    return dict(of, scattering=[share * c for c in of["scattering"]], absorption=[share * c for c in of["absorption"]])


def write_grid(path, numbers, low, high):
    depth, height, width = numbers.shape
    header = b"VOL\x03" + struct.pack("<5i6f", 1, width, height, depth, 1, *low, *high)
    path.write_bytes(header + numbers.tobytes())


def write_scene(folder, surfaces, media):
    text = scene_text.head(BOUNCES, (0.1, 0.12, 0.15), (EYE, TARGET, FOV))
    for number, (corners, colour, light) in enumerate(surfaces):
        text += [f'[[material]]\nname = "s{number}"\ndiffuse = {list(colour)}\nemission = {list(light)}']
        text += [scene_text.quad(corners, f"s{number}")]
    for number, of in enumerate(media):
        keys = f'scattering = {list(of["scattering"])}, absorption = {list(of["absorption"])}, anisotropy = {of["g"]}'
        glass = of["glass"]
        surface = f"transmission = [1, 1, 1]\nior = {glass}\n" if glass else ""
        keys += "" if glass else ", interface = false"
        if of["grid"] is not None:
            write_grid(folder / f"m{number}.vol", of["grid"], of["low"], of["high"])
            keys += f', density = "m{number}.vol"'
        text += [f'[[material]]\nname = "m{number}"\n{surface}volume = {{ {keys} }}']
        text += [f'[[mesh]]\nshape = "box"\nmin = {list(of["low"])}\nmax = {list(of["high"])}\nmaterial = "m{number}"']
    (folder / "scene.toml").write_text("\n".join(text) + "\n")


def rgb(values):
    return {"type": "rgb", "value": [float(value) for value in values]}


def volume(values):
    return {"type": "constvolume", "value": rgb(values)}


def medium_of_mitsuba(of, folder, number):
    extinction = np.add(of["scattering"], of["absorption"])
    albedo = np.divide(of["scattering"], extinction)
    phase = {"type": "hg", "g": of["g"]}
    if of["grid"] is None:
        return mi.load_dict({"type": "homogeneous", "albedo": volume(albedo), "sigma_t": volume(extinction), "phase": phase})
    # One number a channel: extinction is their product with the grid's.
    numbers = of["grid"][..., None] * extinction.astype(np.float32)
    T = mi.ScalarTransform4f
    low, high = np.array(of["low"], float), np.array(of["high"], float)
    to_world = T().translate(list(low)).scale(list(high - low))
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(np.ascontiguousarray(numbers)), "raw": True, "to_world": to_world}
    return mi.load_dict({"type": "heterogeneous", "albedo": volume(albedo), "sigma_t": grid, "phase": phase})


def box(low, high):
    (x, y, z), (u, v, w) = low, high
    corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z), (x, y, w), (u, y, w), (u, v, w), (x, v, w)]
    sides = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5)]
    return corners, [face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))]


def of_mitsuba(asked, folder, surfaces, media):
    inside = lambda of: all(low < at < high for low, at, high in zip(of["low"], EYE, of["high"]))
    made = [medium_of_mitsuba(of, folder, number) for number, of in enumerate(media)]
    around = [own for of, own in zip(media, made) if inside(of)]
    camera = sensor(asked, EYE, TARGET, FOV)
    if around:
        camera["medium"] = around[0]
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": BOUNCES + 1, "rr_depth": 6},
        "sensor": camera,
        "sky": {"type": "constant", "radiance": rgb((0.1, 0.12, 0.15))},
    }
    for number, (corners, colour, light) in enumerate(surfaces):
        properties = mi.Properties()
        properties["bsdf"] = mi.load_dict({"type": "twosided", "inner": {"type": "diffuse", "reflectance": rgb(colour)}})
        if any(light):
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": rgb(light)})
        # What lies in a medium has it on both sides.
        if around:
            properties["exterior"] = around[0]
        scene[f"s{number}"] = mesh(f"s{number}", corners, [(0, 1, 2), (0, 2, 3)], properties)
    for number, (of, own) in enumerate(zip(media, made)):
        properties = mi.Properties()
        glass = {"type": "dielectric", "int_ior": of["glass"], "ext_ior": 1.0} if of["glass"] else {"type": "null"}
        properties["bsdf"], properties["interior"] = mi.load_dict(glass), own
        scene[f"m{number}"] = mesh(f"m{number}", *box(of["low"], of["high"]), properties)
    return pictures(asked, scene)


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        surfaces, media = SCENES[name]()
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_scene(folder, surfaces, media)
            own = blocks(of_eyerays(asked, folder, read))
            others = {
                "Mitsuba volpath": of_mitsuba(asked, folder, surfaces, media),
                "Mitsuba, 5 % denser": of_mitsuba(asked, folder, surfaces, [denser(of, 1.05) for of in media]),
            }
            for other, seen in others.items():
                row(name, other, own, seen)


if __name__ == "__main__":
    main()
