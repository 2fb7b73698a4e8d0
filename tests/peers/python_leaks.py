#!/usr/bin/env python3
"""Rays that closed meshes lose, beside trimesh with embreex and Open3D.

    pip install ./python trimesh embreex open3d
    python3 tests/peers/python_leaks.py [--rays 10000000] [--device auto] [MESH.ply ...]

Each mesh is closed. From places inside of it rays go to its vertices, to places on its edges and in its triangles; every one of them must
hit the mesh ("lost" counts those that do not) and cross it an odd number of times; from places outside the same rays must cross it an
even number of times ("parity" counts those that do not). Places are inside by the mesh's winding number in double precision. Nothing of
that needs to know where a ray should hit. Meshes of files that have holes have them filled first, by a triangle fan each.
"""

import argparse
import sys
import time

import numpy as np
import open3d as o3d
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

import eyerays

BLOCK = 1 << 20


class Eyerays:
    name = "eyerays"

    def __init__(self, vertices, faces, device):
        self.scene, self.device = eyerays.Scene(vertices, faces), device

    def hits(self, origins, directions):
        return self.scene.closest(origins, directions, fields="triangle", device=self.device).hit

    def counts(self, origins, directions):
        return self.scene.count(origins, directions, device=self.device)


class Embreex:
    name = "trimesh, embreex"

    def __init__(self, vertices, faces, device):
        self.of = RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))

    def hits(self, origins, directions):
        return self.of.intersects_first(origins, directions) >= 0

    def counts(self, origins, directions):
        _, rays = self.of.intersects_id(origins, directions, multiple_hits=True)
        return np.bincount(rays, minlength=len(origins))


class Open3D:
    name = "Open3D"

    def __init__(self, vertices, faces, device):
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32)))

    def rays(self, origins, directions):
        return o3d.core.Tensor(np.concatenate([origins, directions], axis=1).astype(np.float32))

    def hits(self, origins, directions):
        return np.isfinite(self.scene.cast_rays(self.rays(origins, directions))["t_hit"].numpy())

    def counts(self, origins, directions):
        return self.scene.count_intersections(self.rays(origins, directions)).numpy()


def ball(level):
    of = trimesh.creation.icosphere(level)
    return np.array(of.vertices), np.array(of.faces)


def slivers(around, along):
    """A ball of stripes: triangles some hundred times as long as they are wide."""
    of = trimesh.creation.uv_sphere(count=[along, around])
    return np.array(of.vertices), np.array(of.faces)


def scales(level):
    """A ball that a fine net of waves makes rough, so that rays graze it everywhere."""
    vertices, faces = ball(level)
    waves = np.sin(40 * vertices).prod(axis=1) + 0.3 * np.sin(90 * vertices[:, ::-1]).prod(axis=1)
    return vertices * (1 + 0.05 * waves[:, None]), faces


def of_file(path):
    of = trimesh.load(path, force="mesh", process=False)
    of.merge_vertices()
    of.update_faces(of.unique_faces() & of.nondegenerate_faces())
    open_edges = of.edges[trimesh.grouping.group_rows(of.edges_sorted, require_count=1)]
    vertices, faces = np.array(of.vertices), np.array(of.faces)
    after = {}
    for a, b in open_edges:
        after.setdefault(b, []).append(a)
    while after:
        start, loop = next(iter(after)), []
        at = start
        while at in after:
            loop.append(at)
            ways = after[at]
            following = ways.pop()
            if not ways:
                del after[at]
            at = following
        hub = len(vertices)
        vertices = np.concatenate([vertices, vertices[loop].mean(axis=0, keepdims=True)])
        loop = np.array(loop)
        faces = np.concatenate([faces, np.stack([loop, np.roll(loop, -1), np.full(len(loop), hub)], axis=1)])
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    if (np.unique(edges, axis=0, return_counts=True)[1] % 2).any():
        sys.exit(f"{path} is not closed")
    return vertices, faces


def winding(vertices, faces, point):
    """How often a closed mesh goes around a point (Van Oosterom and Strackee 1983)."""
    a, b, c = (vertices[faces[:, i]] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(p, axis=1) for p in (a, b, c))
    dot = lambda p, q: np.einsum("ij,ij->i", p, q)  # noqa: E731
    over = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return np.arctan2(dot(a, np.cross(b, c)), over).sum() / (2 * np.pi)


def places(vertices, faces, random, count):
    """Places inside and outside of a mesh."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    inside = [np.array((low + high) / 2)] if round(winding(vertices, faces, (low + high) / 2)) % 2 else []
    while len(inside) < count:
        place = random.uniform(low, high)
        if round(winding(vertices, faces, place)) % 2:
            inside.append(place)
    middle, size = (low + high) / 2, (high - low).max()
    outside = [middle + 2 * size * random.normal(size=3) + size * np.eye(3)[i % 3] * 3 for i in range(count)]
    return inside, outside


def aims(vertices, faces, random, count):
    """Vertices first, then places on edges and in triangles, as many in all as are asked for."""
    rows = vertices[faces[random.integers(len(faces), size=count)]]
    share = random.uniform(size=(count, 1))
    on_edges = rows[:, 0] * share + rows[:, 1] * (1 - share)
    weights = random.dirichlet([1, 1, 1], count)
    in_faces = np.einsum("ij,ijk->ik", weights, rows)
    middles = (rows[:, 0] + rows[:, 1]) / 2
    every = np.concatenate([vertices[: count // 2], np.stack([on_edges, middles, in_faces], axis=1).reshape(-1, 3)])
    return every[:count]


def wrong(engine, origins, targets, odd):
    """Rays that hit nothing, and rays that cross the mesh the wrong number of times."""
    lost = parity = 0
    for origin in origins:
        for start in range(0, len(targets), BLOCK):
            directions = targets[start : start + BLOCK] - origin
            starts = np.broadcast_to(origin, directions.shape)
            if odd:
                lost += int((~engine.hits(starts, directions)).sum())
            parity += int((engine.counts(starts, directions) % 2 != odd).sum())
    return lost, parity


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="*", metavar="MESH")
    parser.add_argument("--rays", type=int, default=10_000_000, help="from inside, of all meshes together")
    parser.add_argument("--device", default="auto", help="of eyerays")
    parser.add_argument("--engines", default="eyerays,embreex,open3d")
    given = parser.parse_args()
    engines = [{"eyerays": Eyerays, "embreex": Embreex, "open3d": Open3D}[name] for name in given.engines.split(",")]
    meshes = [("icosphere", ball(7)), ("stripes", slivers(2000, 16)), ("rough ball", scales(7))]
    meshes.append(("icosphere at 1e6", tuple(f(x) for f, x in zip((lambda v: v + 1e6, lambda t: t), ball(6)))))
    meshes += [(path.rsplit("/", 1)[-1], of_file(path)) for path in given.meshes]
    origins = 4
    each = given.rays // (len(meshes) * origins)
    print("| mesh | rays from inside | " + " | ".join(f"{e.name}: lost, parity in, out" for e in engines) + " |")
    print("|---|---|" + "---|" * len(engines))
    for name, (vertices, faces) in meshes:
        random = np.random.default_rng(1)
        inside, outside = places(vertices, faces, random, origins)
        targets = aims(vertices, faces, random, each)
        cells = []
        for kind in engines:
            start = time.monotonic()
            engine = kind(vertices, faces, given.device)
            lost, odd = wrong(engine, inside, targets, 1)
            _, even = wrong(engine, outside, targets, 0)
            cells.append(f"{lost:,}, {odd:,}, {even:,}")
            print(f"{name}: {kind.name} took {time.monotonic() - start:.0f} s", file=sys.stderr)
        print(f"| {name}, {len(faces):,} triangles | {origins * len(targets):,} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
