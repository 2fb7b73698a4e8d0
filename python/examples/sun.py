"""Solar exposure: for how many hours of a day the sun reaches each triangle.

    python sun.py MESH [--latitude 48] [--day 172] [--up z]
"""

import argparse

import numpy as np
import trimesh

import eyerays


def sun(latitude, day, hours):
    """Where the sun is (n, 3), of unit length: east, north and up, at hours of solar time (Cooper 1969)."""
    declination = np.radians(23.45) * np.sin(2 * np.pi * (284 + day) / 365)
    turn, tilt = np.radians(15 * (hours - 12)), np.radians(latitude)
    up = np.sin(tilt) * np.sin(declination) + np.cos(tilt) * np.cos(declination) * np.cos(turn)
    east = -np.cos(declination) * np.sin(turn)
    north = np.cos(tilt) * np.sin(declination) - np.sin(tilt) * np.cos(declination) * np.cos(turn)
    return np.stack([east, north, up], axis=-1)


def exposure(mesh, latitude=48.0, day=172, step=0.25):
    """Hours (m,) that the sun reaches the middle of each triangle of a mesh whose z axis is up and whose y axis is north."""
    scene = eyerays.Scene.from_trimesh(mesh)
    hours = np.zeros(len(mesh.faces))
    starts = mesh.triangles_center + mesh.face_normals * (1e-5 * mesh.scale)
    for way in sun(latitude, day, np.arange(0, 24, step)):
        if way[2] > 0:
            facing = mesh.face_normals @ way > 0
            lit = ~scene.any(starts[facing], way)
            hours[np.flatnonzero(facing)[lit]] += step
    return hours


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("--latitude", type=float, default=48.0)
    parser.add_argument("--day", type=int, default=172, help="of the year; 172 is the longest of the north")
    given = parser.parse_args()
    mesh = trimesh.load(given.mesh, force="mesh")
    hours = exposure(mesh, given.latitude, given.day)
    print(f"the sun reaches a triangle for {np.average(hours, weights=mesh.area_faces):.2f} hours on average, and {hours.max():.2f} at most")


if __name__ == "__main__":
    main()
