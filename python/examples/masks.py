"""Pictures with masks and depths for training: things that lie about in front of a camera.

    python masks.py FOLDER [--count 8] [--size 160x120] [--spp 16]
"""

import argparse
from pathlib import Path

import numpy as np

import eyerays

CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float64)
SIDES = np.array([[0, 3, 1], [0, 2, 3], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 7, 3], [2, 6, 7], [0, 6, 2], [0, 4, 6], [1, 3, 7], [1, 7, 5]])
FLOOR = np.array([[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], np.float64)


def example(seed, size=(160, 120), spp=16, things=5):
    """A picture (height, width, 3), the number of the thing in each pixel (1 is the floor, 0 nothing), and depths."""
    random = np.random.default_rng(seed)
    scene = eyerays.Scene()
    scene.add_material("floor", diffuse=[0.5, 0.5, 0.5])
    scene.add_mesh(FLOOR, [[0, 1, 2], [0, 2, 3]], material="floor")
    for thing in range(things):
        scene.add_material(f"thing{thing}", diffuse=random.uniform(0.1, 0.9, 3))
        turn, size_of = random.uniform(0, 2 * np.pi), random.uniform(0.2, 0.5)
        around = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
        place = [random.uniform(-2, 2), size_of, random.uniform(-2, 1)]
        scene.add_mesh(CUBE * size_of @ around.T + place, SIDES, material=f"thing{thing}")
    scene.background = {"horizon": [0.8, 0.85, 0.9], "zenith": [0.3, 0.5, 0.8]}
    camera = {"eye": [random.uniform(-2, 2), 2.5, 5], "target": [0, 0.3, 0]}
    told = eyerays.render(scene, camera, size=size, spp=spp, layers=("object", "depth"))
    return told["colour"], told["object"], told["depth"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=8)
    parser.add_argument("--size", type=lambda text: tuple(int(x) for x in text.split("x")), default=(160, 120))
    parser.add_argument("--spp", type=int, default=16)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for number in range(given.count):
        picture, masks, depths = example(number, given.size, given.spp)
        picture.save(given.folder / f"{number:04}.png")
        np.savez_compressed(given.folder / f"{number:04}.npz", masks=masks, depths=depths)
    print(f"{given.folder}: {given.count} pictures with masks and depths")


if __name__ == "__main__":
    main()
