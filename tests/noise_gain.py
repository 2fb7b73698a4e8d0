#!/usr/bin/env python3
"""What `eyerays render --noise` saves: samples and time to the same error, with and without it, in five scenes.

    python3 tests/noise_gain.py target/release/eyerays [--device gpu] [--size 320x240] [SCENE=NOISE ...]

Each scene is rendered with --noise; then without, with more and more samples, until the error is as small. Errors are root mean squares
of what is seen, as --noise has it: of the mean of the channels after the exposure, as a share of the reference's or of a 20th of white.
The reference has other numbers (--seed) and twice the most samples. Time is that of rendering alone, the least of three. Needs Python 3.9
and no package.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

# With the noise that is asked for: about what so many samples at most have everywhere.
SCENES = ["cornell_path=0.05", "soft_shadows=0.025", "room=0.05", "metal=0.02", "dusk=0.01"]
FLOOR = 0.05
ROOT = Path(__file__).resolve().parent.parent


class Renderer:
    """The program, and what all its pictures have in common."""

    def __init__(self, asked):
        self.asked = asked

    def render(self, scene, output, *more):
        """The summary of a picture as a PNG of 16 bits."""
        asked = self.asked
        command = [asked.program, "render", str(ROOT / "scenes" / f"{scene}.toml"), "--device", asked.device, "--size", asked.size]
        command += ["--sampler", "sobol", "--integrator", "path", "--bits", "16", "-o", str(output), "--json", "-q", *more]
        return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)

    def timed(self, scene, output, *more):
        """The same, and the milliseconds that it took to render."""
        runs = [self.render(scene, output, *more) for _ in range(3 if self.asked.times else 1)]
        return runs[0], min(run["render_ms"] for run in runs)


def seen(path):
    """What is seen of each pixel of a PNG, in linear light from 0 to 1."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = int.from_bytes(data[at : at + 4], "big"), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, row, before, pixels = zlib.decompress(packed), 6 * width + 1, bytearray(6 * width), []
    for y in range(height):
        line = unfiltered(raw[y * row], bytearray(raw[y * row + 1 : (y + 1) * row]), before)
        signals = [int.from_bytes(line[i : i + 2], "big") / 65535 for i in range(0, len(line), 2)]
        light = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in signals]
        pixels += [sum(light[i : i + 3]) / 3 for i in range(0, len(light), 3)]
        before = line
    return pixels


def unfiltered(kind, line, before):
    """A line of a PNG by its filter."""
    for i in range(len(line)):
        a, b, c = (line[i - 6] if i >= 6 else 0), before[i], (before[i - 6] if i >= 6 else 0)
        nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        line[i] = (line[i] + [0, a, b, (a + b) // 2, nearest][kind]) & 255
    return line


def error(found, wanted):
    squares = [((a - b) / max(b, FLOOR)) ** 2 for a, b in zip(found, wanted)]
    return math.sqrt(sum(squares) / len(squares))


def gain(renderer, scene, noise, folder):
    """Samples and milliseconds with --noise, those of the same error without, and the error."""
    picture, most = folder / "a.png", renderer.asked.most
    renderer.render(scene, picture, "--spp", str(2 * most), "--seed", "1")
    wanted = seen(picture)
    summary, time = renderer.timed(scene, picture, "--noise", noise, "--exposure", "0", "--spp", str(most))
    pixels = summary["width"] * summary["height"]
    own, found = (summary["rays"]["primary"] / pixels, time), error(seen(picture), wanted)
    before, spp = None, 64
    while spp <= 2 * most:
        _, time = renderer.timed(scene, picture, "--spp", str(spp))
        now = [math.log(x) for x in (spp, time, error(seen(picture), wanted))]
        if now[2] <= math.log(found):
            # Between two numbers of samples the error falls as a power.
            share = 1 if before is None else (math.log(found) - before[2]) / (now[2] - before[2])
            start = before or now
            return own, [math.exp(a + share * (b - a)) for a, b in zip(start[:2], now[:2])], found
        before, spp = now, spp * 3 // 2 // 16 * 16
    return own, (math.inf, math.inf), found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*", default=SCENES, metavar="SCENE=NOISE")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--size", default="96x64")
    parser.add_argument("--most", type=int, default=1024)
    parser.add_argument("--times", action="store_true", help="measure times, too: of each picture the least of three")
    renderer = Renderer(parser.parse_intermixed_args())
    gains = []
    for scene, noise in (named.split("=") for named in renderer.asked.scenes):
        with tempfile.TemporaryDirectory() as folder:
            own, fixed, found = gain(renderer, scene, noise, Path(folder))
        gains.append([b / a for a, b in zip(own, fixed)])
        of = lambda pair: f"{pair[0]:.0f} samples a pixel in {pair[1]:.1f} ms"
        ratios = f"{gains[-1][0]:.2f} times as many, {gains[-1][1]:.2f} times as long"
        print(f"{scene}, --noise {noise}: error {100 * found:.2f} % by {of(own)}, without by {of(fixed)}: {ratios}", flush=True)
    print("medians " + ", ".join(f"{sorted(column)[len(gains) // 2]:.2f}" for column in zip(*gains)))


if __name__ == "__main__":
    main()
