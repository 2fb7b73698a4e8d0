#!/usr/bin/env python3
"""Light of single wavelengths beside Mitsuba (`scalar_spectral`): five scenes with the same triangles, lamps and spectra in both.

    pip install mitsuba numpy
    python3 tests/spectral_peers.py target/release/eyerays [SCENE ...] [--device gpu] [--size 64] [--samples 64] [--seeds 16]

Both programs render each scene with several seeds; see tests/media_peers.py for what z is. Each channel is compared by itself. The last
rows of a scene are beside this program's own picture in red, green and blue, to show what wavelengths change.
"""

import re
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

import scene_text
from blocks import arguments, blocks, of_eyerays, row
from mitsuba_parts import mesh, pictures, read, sensor

mi.set_variant("scalar_spectral")

SPECTRA = Path(__file__).parent.parent / "host/src/spectrum"
WAVELENGTHS = np.arange(380, 781, 5.0)
BOUNCES = 60

EYE, TARGET, FOV = (0.6, 1.5, 5.5), (0, 1.1, 0), 42.0
FLOOR = (-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)
LAMP = (-1, 3, 1), (-1, 3, -1), (1, 3, -1), (1, 3, 1)
BACK = (-4, 0, -4), (4, 0, -4), (4, 4, -4), (-4, 4, -4)
LEFT = (-2, 0, -4), (-2, 4, -4), (-2, 4, 4), (-2, 0, 4)
RIGHT = (2, 0, 4), (2, 4, 4), (2, 4, -4), (2, 0, -4)
PANEL = (-1, 0.2, 0.5), (0.8, 0.2, 0.2), (0.8, 1.8, -0.6), (-1, 1.8, -0.3)
BOX = (-1, 0.3, -1), (1, 1.9, 1)
RED, GREEN, WHITE = (0.8, 0.1, 0.05), (0.1, 0.5, 0.1), (0.6, 0.6, 0.6)


def numbers_of(file, name):
    """A table of numbers of the program's own sources."""
    text = (SPECTRA / file).read_text()
    body = text[text.index("= [", text.index(f"const {name}:")) + 2 : ]
    return np.array([float(n) for n in re.findall(r"\d+(?:\.\d+)?(?:e-?\d+)?", body[: body.index("];")])])


PRIMARIES = numbers_of("primaries.rs", "PRIMARIES").reshape(-1, 3)
D65 = numbers_of("observer.rs", "D65")


def matt(corners, colour):
    return dict(corners=corners, toml=f"diffuse = {list(colour)}", bsdf=lambda: {"type": "diffuse", "reflectance": spectrum(colour)})


def metal(corners, name, table, alpha):
    eta, k = numbers_of("metal.rs", table).reshape(-1, 2).T
    curve = lambda values: irregular(np.arange(380, 781, 20.0), values)
    bsdf = lambda: {"type": "roughconductor", "distribution": "ggx", "alpha": alpha, "eta": curve(eta), "k": curve(k)}
    return dict(corners=corners, toml=f'metal = "{name}"\nroughness = {alpha ** 0.5}', bsdf=bsdf)


def lamp(corners, toml, light):
    black = dict(corners=corners, toml=f"diffuse = [0, 0, 0]\n{toml}", bsdf=lambda: {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.0}})
    return dict(black, emitter=light)


def irregular(wavelengths, values):
    joined = lambda numbers: ", ".join(f"{number:.8g}" for number in numbers)
    return {"type": "irregular", "wavelengths": joined(wavelengths), "values": joined(values)}


def spectrum(colour):
    """That of a colour, of reflectances and coefficients."""
    return irregular(WAVELENGTHS, PRIMARIES @ np.array(colour))


def planck(kelvins):
    metres = WAVELENGTHS * 1e-9
    return 1 / (metres**5 * (np.exp(0.01438776877 / (metres * kelvins)) - 1))


def luminance(radiance):
    """Of light that a camera sees, as Mitsuba has it."""
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "path"}, "light": {"type": "constant", "radiance": radiance},
        "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "width": 64, "height": 64, "component_format": "float32"},
                   "sampler": {"type": "stratified", "sample_count": 256}},
    })
    return float(np.array(mi.render(scene))[..., :3].mean(axis=(0, 1)) @ np.array([0.2126, 0.7152, 0.0722]))


def daylight(scale):
    """D65 of this luminance."""
    base = irregular(WAVELENGTHS, D65)
    return irregular(WAVELENGTHS, D65 * scale / luminance(base))


def glow(kelvins, scale):
    values = planck(kelvins) / planck(kelvins).max()
    return irregular(WAVELENGTHS, values * scale / luminance(irregular(WAVELENGTHS, values)))


def walls():
    """Colours that light each other."""
    return [matt(FLOOR, WHITE), matt(BACK, WHITE), matt(LEFT, RED), matt(RIGHT, GREEN), lamp(LAMP, "emission = [6, 6, 6]", lambda: daylight(6))], []


def warm():
    """The same by a lamp of 2700 K."""
    surfaces, media = walls()
    return surfaces[:-1] + [lamp(LAMP, "temperature = 2700\nemission = 6", lambda: glow(2700, 6))], media


def gold():
    """A panel of gold before coloured walls."""
    surfaces, media = walls()
    return surfaces + [metal(PANEL, "gold", "GOLD", 0.2)], media


def copper():
    """A panel of copper below a lamp of 9000 K."""
    lit = lamp(LAMP, "temperature = 9000\nemission = 6", lambda: glow(9000, 6))
    return [matt(FLOOR, WHITE), matt(BACK, (0.2, 0.4, 0.6)), lit, metal(PANEL, "copper", "COPPER", 0.3)], []


def cloud():
    """A coloured medium."""
    surfaces, _ = walls()
    return surfaces, [dict(scattering=(2, 1, 0.3), absorption=(0.1, 0.4, 1.0), g=0.5)]


SCENES = dict(walls=walls, warm=warm, gold=gold, copper=copper, cloud=cloud)


def write_scene(folder, surfaces, media, is_spectral):
    keys = f"\ncompensation = false\nspectral = {str(is_spectral).lower()}"
    text = scene_text.head(BOUNCES, (0, 0, 0), (EYE, TARGET, FOV), keys)
    for number, of in enumerate(surfaces):
        text += [f'[[material]]\nname = "s{number}"\n{of["toml"]}']
        text += [scene_text.quad(of["corners"], f"s{number}")]
    for number, of in enumerate(media):
        keys = f'scattering = {list(of["scattering"])}, absorption = {list(of["absorption"])}, anisotropy = {of["g"]}, interface = false'
        text += [f'[[material]]\nname = "m{number}"\nvolume = {{ {keys} }}']
        text += [f'[[mesh]]\nshape = "box"\nmin = {list(BOX[0])}\nmax = {list(BOX[1])}\nmaterial = "m{number}"']
    (folder / "scene.toml").write_text("\n".join(text) + "\n")


def of_mitsuba(asked, surfaces, media):
    T = mi.ScalarTransform4f
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": BOUNCES + 1, "rr_depth": 6},
        "sensor": sensor(asked, EYE, TARGET, FOV),
    }
    for number, of in enumerate(surfaces):
        properties = mi.Properties()
        bsdf = of["bsdf"]()
        properties["bsdf"] = mi.load_dict({"type": "twosided", "inner": bsdf})
        if "emitter" in of:
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": of["emitter"]()})
        scene[f"s{number}"] = mesh(f"s{number}", of["corners"], [(0, 1, 2), (0, 2, 3)], properties)
    for number, of in enumerate(media):
        # This program makes a spectrum of the extinction and of the share that is scattered.
        extinction = np.add(of["scattering"], of["absorption"])
        volume = lambda values: {"type": "constvolume", "value": spectrum(values)}
        medium = {"type": "homogeneous", "albedo": volume(np.divide(of["scattering"], extinction)), "sigma_t": volume(extinction),
                  "phase": {"type": "hg", "g": of["g"]}}
        low, high = np.array(BOX[0], float), np.array(BOX[1], float)
        to_world = T().translate(list((low + high) / 2)).scale(list((high - low) / 2))
        scene[f"m{number}"] = {"type": "cube", "to_world": to_world, "bsdf": {"type": "null"}, "interior": medium}
    return pictures(asked, scene)


def main():
    asked = arguments(__doc__, SCENES)
    for name in asked.scenes:
        surfaces, media = SCENES[name]()
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_scene(folder, surfaces, media, True)
            own = list(of_eyerays(asked, folder, read))
            write_scene(folder, surfaces, media, False)
            others = {"Mitsuba": list(of_mitsuba(asked, surfaces, media)), "red, green and blue": list(of_eyerays(asked, folder, read))}
            for other, seen in others.items():
                for number, channel in enumerate(("red", "green", "blue")):
                    of = lambda all: [picture[..., number : number + 1] for picture in all]
                    row(f"{name}, {channel}", other, blocks(of(own)), of(seen))


if __name__ == "__main__":
    main()
