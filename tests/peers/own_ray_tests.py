#!/usr/bin/env python3
"""The ray tests of trimesh and Open3D, run on eyerays by its stand-ins for both.

    pip install ./python trimesh embreex open3d pytest rtree scipy
    python3 tests/peers/own_ray_tests.py --trimesh CHECKOUT --open3d CHECKOUT

CHECKOUT is a clone of the project (of Open3D its folder `python/test` will do). Whatever asks for a ray intersector of trimesh, or for Open3D's
`RaycastingScene`, gets that of eyerays.
"""

import argparse
import sys
from pathlib import Path

import pytest


def of_trimesh(checkout):
    import trimesh

    import eyerays.trimesh

    for module in (trimesh.ray.ray_pyembree, trimesh.ray.ray_triangle):
        module.RayMeshIntersector = eyerays.trimesh.RayMeshIntersector
    tests = checkout / "tests"
    return pytest.main(["-q", "-p", "no:cacheprovider", str(tests / "test_ray.py"), str(tests / "test_proximity.py")])


def of_open3d(checkout):
    import open3d

    import eyerays.open3d

    open3d.t.geometry.RaycastingScene = eyerays.open3d.RaycastingScene
    (tests,) = checkout.rglob("test_raycasting_scene.py")
    return pytest.main(["-q", "-p", "no:cacheprovider", str(tests)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trimesh", type=Path)
    parser.add_argument("--open3d", type=Path)
    given = parser.parse_args()
    runs = [(of_trimesh, given.trimesh), (of_open3d, given.open3d)]
    sys.exit(max([int(run(checkout)) for run, checkout in runs if checkout is not None], default=2))


if __name__ == "__main__":
    main()
