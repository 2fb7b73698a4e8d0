"""Pictures of two programs side by side: the means of their blocks, and how far these are apart."""

import argparse
import subprocess

import numpy as np

BLOCKS = 8


def blocks(pictures):
    """Means of 64 blocks, in the mean of seeds, and their variances."""
    stack = np.stack([picture.mean(axis=2) for picture in pictures]).astype(np.float64)
    seeds, size, _ = stack.shape
    means = stack.reshape(seeds, BLOCKS, size // BLOCKS, BLOCKS, size // BLOCKS).mean(axis=(2, 4)).reshape(seeds, -1)
    return means.mean(axis=0), means.var(axis=0, ddof=1) / seeds


def compared(own, other):
    """The greatest z, the root of the mean of its square (1 where all is chance), and the difference of the whole image as a share."""
    error = np.sqrt(own[1] + other[1])
    lit = error > 0
    z = (own[0] - other[0])[lit] / error[lit]
    return np.abs(z).max(), np.sqrt((z * z).mean()), own[0].mean() / other[0].mean() - 1


def arguments(doc, scenes):
    """What a comparison of these scenes is asked for; it begins the table of what is found."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*", default=list(scenes))
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=16)
    asked = parser.parse_intermixed_args()
    print("| scene | beside | greatest z of 64 | root mean square of z | difference of the image |\n|---|---|---|---|---|")
    return asked


def of_eyerays(asked, folder, read):
    """The pictures of the folder's scene by this program, a seed each, as `read` takes them from files."""
    for seed in range(asked.seeds):
        output = folder / "picture.exr"
        shared = ["--device", asked.device, "--size", f"{asked.size}x{asked.size}", "--spp", str(asked.samples), "--quiet"]
        subprocess.run([asked.program, "render", folder / "scene.toml", *shared, "--seed", str(seed), "-o", output], check=True)
        yield read(output)


def row(scene, beside, own, pictures):
    """The row of the table that tells how far another program's pictures are from the own ones' blocks."""
    greatest, spread, share = compared(own, blocks(pictures))
    print(f"| {scene} | {beside} | {greatest:.2f} | {spread:.2f} | {100 * share:+.2f} % |", flush=True)
