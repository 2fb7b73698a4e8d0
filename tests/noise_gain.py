#!/usr/bin/env python3
"""What `eyerays render --noise` saves: samples to the same error, with and without it, in five scenes.

    python3 tests/noise_gain.py target/release/eyerays [SCENE=NOISE ...]

Each scene is rendered by the CPU with --noise; then without, with more and more samples, until the error is as small. Errors are root mean
squares of what is seen, as --noise has it: of the mean of the channels after the exposure, as a share of the reference's or of a 20th of
white. The reference has other numbers (--seed). Needs Python 3.9 and no package.
"""

import json
import math
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

# With the noise that is asked for: about what so many samples at most have everywhere.
SCENES = ["cornell_path=0.05", "soft_shadows=0.025", "room=0.05", "metal=0.02", "dusk=0.01"]
SIZE, MOST, REFERENCE = "96x64", 1024, 2048
FLOOR = 0.05
ROOT = Path(__file__).resolve().parent.parent


def render(program, scene, output, *more):
    """The summary of a picture as a PNG of 16 bits."""
    command = [program, "render", str(ROOT / "scenes" / f"{scene}.toml"), "--device", "cpu", "--size", SIZE, "--sampler", "sobol"]
    command += ["--integrator", "path", "--bits", "16", "-o", str(output), "--json", "-q", *more]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


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


def gain(program, scene, noise, folder):
    """Samples with --noise, those of the same error without, and the error."""
    picture = folder / "a.png"
    render(program, scene, picture, "--spp", str(REFERENCE), "--seed", "1")
    wanted = seen(picture)
    summary = render(program, scene, picture, "--noise", noise, "--spp", str(MOST))
    pixels = summary["width"] * summary["height"]
    own, found = summary["rays"]["primary"] / pixels, error(seen(picture), wanted)
    last = None
    for spp in [64, 96, 128, 192, 256, 384, 512, 768, 1024]:
        render(program, scene, picture, "--spp", str(spp), "--checkpoint", str(folder / f"{scene}.film"), "--resume")
        now = (math.log(spp), math.log(error(seen(picture), wanted)))
        if now[1] <= math.log(found):
            # Between two numbers of samples the error falls as a power.
            share = 0 if last is None else (math.log(found) - last[1]) / (now[1] - last[1])
            return own, math.exp(now[0] if last is None else last[0] + share * (now[0] - last[0])), found
        last = now
    return own, float("inf"), found


def main():
    gains = []
    for scene, noise in (named.split("=") for named in sys.argv[2:] or SCENES):
        with tempfile.TemporaryDirectory() as folder:
            own, fixed, found = gain(sys.argv[1], scene, noise, Path(folder))
        gains.append(fixed / own)
        print(f"{scene}, --noise {noise}: error {100 * found:.2f} % by {own:.0f} samples a pixel, {fixed:.0f} without: {gains[-1]:.2f} times", flush=True)
    print(f"median {sorted(gains)[len(gains) // 2]:.2f} times")


if __name__ == "__main__":
    main()
