#!/usr/bin/env python3
"""Rays a second from numpy to numpy, beside embreex and Open3D: the same rays, in one run.

    pip install ./python embreex open3d
    python3 tests/peers/python_speed.py [--rays 1000000] [--devices cpu gpu]

An icosphere of 327,680 triangles; rays of a camera, from its middle in all directions, and from anywhere around it in all directions. Ours tell
`t` and `triangle` into arrays that are there, all fields into new ones, and whether anything is met; embreex tells triangles, Open3D all that it
has, of rays in a tensor of its own that is made before. Figures are medians of seven calls. embreex takes one thread; set `taskset` and `--threads` for others of the rest.
"""

import argparse
import time

import numpy as np

import eyerays


def icosphere(level):
    golden = (1 + 5**0.5) / 2
    vertices = [[-1, golden, 0], [1, golden, 0], [-1, -golden, 0], [1, -golden, 0]]
    vertices = np.concatenate([np.roll(vertices, turn, axis=1) for turn in (0, 1, 2)])
    distances = np.linalg.norm(vertices[:, None] - vertices[None], axis=-1)
    near = np.abs(distances - 2) < 1e-9
    faces = [(a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]]
    faces = np.array([(a, b, c) if np.linalg.det(vertices[[a, b, c]]) > 0 else (a, c, b) for a, b, c in faces])
    for _ in range(level):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        middle = len(vertices) + index.reshape(-1, 3)
        vertices = np.concatenate([vertices, vertices[unique].mean(axis=1)])
        (a, b, c), (ab, bc, ca) = faces.T, middle.T
        faces = np.concatenate([np.stack(t, axis=1) for t in [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]])
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def rays_of(kind, count):
    random = np.random.default_rng(0)
    if kind == "camera":
        edge = int(count**0.5)
        y, x = (np.mgrid[0:edge, 0:edge] - edge / 2) / edge * 0.8
        ways = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
        return np.tile(np.float32([0, 0, 3]), (len(ways), 1)), ways.astype(np.float32)
    ways = random.normal(size=(count, 3)).astype(np.float32)
    return (random.uniform(-1.5, 1.5, (count, 3)) if kind == "anywhere" else np.zeros((count, 3))).astype(np.float32), ways


def median(work, count, calls=7):
    times = []
    for _ in range(calls):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return count / sorted(times)[calls // 2] / 1e6


def peers(vertices, faces):
    """What makes calls of others from rays, by their names, and how long they take to build."""
    found = {}
    try:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        start = time.perf_counter()
        embree = rtcore_scene.EmbreeScene()
        TriangleMesh(scene=embree, vertices=vertices.astype(np.float32), indices=faces.astype(np.int32))
        embree.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
        found["embreex"] = lambda origins, ways: lambda: embree.run(origins, ways), time.perf_counter() - start
    except ImportError:
        pass
    try:
        import open3d as o3d

        start = time.perf_counter()
        scene = o3d.t.geometry.RaycastingScene()
        scene.add_triangles(o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32)))
        scene.cast_rays(o3d.core.Tensor(np.ones((1, 6), np.float32)))

        def rays_of_open3d(origins, ways):
            rays = o3d.core.Tensor.from_numpy(np.concatenate([origins, ways], axis=1))
            return lambda: scene.cast_rays(rays)

        found["Open3D"] = rays_of_open3d, time.perf_counter() - start
    except ImportError:
        pass
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--devices", nargs="+", default=["cpu"])
    parser.add_argument("--threads", type=int, default=0)
    given = parser.parse_args()
    vertices, faces = icosphere(7)
    start = time.perf_counter()
    scene = eyerays.Scene(vertices, faces, threads=given.threads).build()
    print(f"built in {time.perf_counter() - start:.2f} s", end="")
    others = peers(vertices, faces)
    print("".join(f", {name} {seconds:.2f} s" for name, (_, seconds) in others.items()))
    print("| rays | " + " | ".join([*(f"{of}, t and triangle | all fields | any" for of in given.devices), *others]) + " |")
    for kind in ("camera", "middle", "anywhere"):
        origins, ways = rays_of(kind, given.rays)
        out = {"t": np.empty(len(ways), np.float32), "triangle": np.empty(len(ways), np.int32)}
        row = []
        for of in given.devices:
            row.append(median(lambda: scene.closest(origins, ways, out=out, device=of), len(ways)))
            row.append(median(lambda: scene.closest(origins, ways, device=of), len(ways)))
            row.append(median(lambda: scene.any(origins, ways, device=of), len(ways)))
        row += [median(call(origins, ways), len(ways)) for call, _ in others.values()]
        print(f"| {kind} | " + " | ".join(f"{rate:.1f}" for rate in row) + " |", flush=True)


if __name__ == "__main__":
    main()
