"""A depth sensor that turns: beams one above the other, without noise.

    python lidar.py SCENE [out.npy] [--at X,Y,Z] [--beams 64] [--columns 2048]
"""

import argparse

import numpy as np

import eyerays


def scan(scene, at, beams=64, columns=2048, low=-25.0, high=15.0, most=120.0):
    """Ranges (beams, columns), infinite for nothing within `most`, and places (beams, columns, 3); up is y."""
    height = np.radians(np.linspace(high, low, beams))[:, None]
    turn = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None, :]
    ways = np.stack(np.broadcast_arrays(np.cos(height) * np.cos(turn), np.sin(height), np.cos(height) * np.sin(turn)), axis=-1)
    hits = scene.closest(at, ways, tmax=most, fields=("t", "point"))
    return hits.t, hits.point


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("out", nargs="?", default="scan.npy")
    parser.add_argument("--at", type=lambda text: [float(x) for x in text.split(",")], default=[0.0, 1.0, 0.0])
    parser.add_argument("--beams", type=int, default=64)
    parser.add_argument("--columns", type=int, default=2048)
    given = parser.parse_args()
    ranges, _ = scan(eyerays.load(given.scene), given.at, given.beams, given.columns)
    np.save(given.out, ranges)
    met = np.isfinite(ranges)
    print(f"{given.out}: {met.mean():.1%} of {ranges.size} beams meet something, {ranges[met].mean():.3f} away on average")


if __name__ == "__main__":
    main()
