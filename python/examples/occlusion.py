"""Ambient occlusion of vertices: how much of a white sky each sees.

    python occlusion.py MESH [out.ply] [--rays 256]
"""

import argparse

import numpy as np
import trimesh

import eyerays


def occlusion(mesh, rays=256, seed=0):
    """The share of the sky (n,) that vertices see, over their normals and by the cosine."""
    scene = eyerays.Scene.from_trimesh(mesh)
    random = np.random.default_rng(seed)
    # Lambert's cosine: a place on a sphere that touches the surface.
    sphere = random.normal(size=(rays, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    normals = mesh.vertex_normals
    # A start off the surface, by the scene's own size: vertices belong to several triangles, whose planes lie beside each other.
    starts = mesh.vertices + normals * (1e-4 * mesh.scale)
    seen = np.zeros(len(normals))
    for way in sphere:
        seen += ~scene.any(starts, normals + way * 0.999)
    return seen / rays


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("out", nargs="?", default="occlusion.ply")
    parser.add_argument("--rays", type=int, default=256)
    given = parser.parse_args()
    mesh = trimesh.load(given.mesh, force="mesh")
    seen = occlusion(mesh, given.rays)
    mesh.visual.vertex_colors = np.repeat((255 * seen).astype(np.uint8)[:, None], 3, axis=1)
    mesh.export(given.out)
    print(f"{given.out}: vertices see {seen.mean():.1%} of the sky on average")


if __name__ == "__main__":
    main()
