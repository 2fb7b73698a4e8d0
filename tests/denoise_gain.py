#!/usr/bin/env python3
"""What `eyerays render --denoise` saves: FLIP and root mean square errors beside pictures of many samples, before and after, in ten scenes.

    python3 tests/denoise_gain.py target/release/eyerays [--device gpu] [--size 320x240] [--reference 4096] [--by oidn] [SCENE=STOPS ...]

The reference has other numbers (--seed). Both errors are what `eyerays diff --flip` tells of the pictures as a screen shows them. Needs
Python 3.9 and no package.
"""

import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

# With stops that make what is lit neither dark nor white.
SCENES = "cornell_path=1.5 soft_shadows=1 bleeding=0 occlusion=0.5 room=2 metal=0.3 frosted=1 dusk=0 cornell=0 lights=0".split()
SAMPLES = [4, 16, 64]
ROOT = Path(__file__).resolve().parent.parent


def run(asked, *arguments, codes=(0,)):
    """The JSON that a command prints."""
    done = subprocess.run([asked.program, *map(str, arguments), "--json"], capture_output=True)
    if done.returncode not in codes:
        raise SystemExit(done.stderr.decode())
    return json.loads(done.stdout)


def render(asked, scene, output, *more):
    path = ROOT / "scenes" / f"{scene}.toml"
    integrator = "ao" if scene == "occlusion" else "path"
    shared = ["--device", asked.device, "--size", asked.size, "--sampler", "sobol", "--integrator", integrator, "-o", output]
    return run(asked, "render", path, *shared, *more)


def errors(asked, picture, reference):
    """Mean FLIP and root mean square error."""
    told = run(asked, "diff", picture, reference, "--flip", codes=(0, 1))
    return told["mean_flip"], told["comparison"]["rmse"]


def gains(asked, scene, folder):
    """By numbers of samples: the errors before and after."""
    scene, stops = scene.split("=")
    reference, noisy, denoised = (folder / f"{name}.png" for name in ("reference", "noisy", "denoised"))
    shown = ["--exposure", stops, "--bits", 16]
    render(asked, scene, reference, "--spp", asked.reference, "--seed", 1, *shown)
    for samples in SAMPLES:
        render(asked, scene, noisy, "--spp", samples, *shown)
        render(asked, scene, denoised, "--spp", samples, *shown, f"--denoise={asked.by}")
        yield samples, *(errors(asked, picture, reference) for picture in (noisy, denoised))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--reference", type=int, default=4096)
    parser.add_argument("--by", default="own")
    asked = parser.parse_args()
    ratios = {samples: ([], []) for samples in SAMPLES}
    print("| scene | samples | FLIP | denoised | RMSE | denoised |\n|---|---|---|---|---|---|")
    for scene in asked.scenes:
        with tempfile.TemporaryDirectory() as folder:
            for samples, before, after in gains(asked, scene, Path(folder)):
                print(f"| {scene.split('=')[0]} | {samples} | {before[0]:.4f} | {after[0]:.4f} | {before[1]:.4f} | {after[1]:.4f} |", flush=True)
                for ratio, a, b in zip(ratios[samples], before, after):
                    ratio.append(b / a)
    for samples, (flip, rmse) in ratios.items():
        print(f"{samples} samples: FLIP {statistics.median(flip):.3f} of before in the median, {max(flip):.3f} at most;", end=" ")
        print(f"RMSE {statistics.median(rmse):.3f} and {max(rmse):.3f}")


if __name__ == "__main__":
    main()
