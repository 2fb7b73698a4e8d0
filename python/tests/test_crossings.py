"""All crossings: each surface once, and closed meshes closed."""

import numpy as np
import pytest

import eyerays
from test_scene import HALVES, SQUARE, UP, icosphere

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], np.float64)
SIDES = np.array([[0, 3, 1], [0, 2, 3], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 7, 3], [2, 6, 7], [0, 6, 2], [0, 4, 6], [1, 3, 7], [1, 7, 5]])


def aimed(vertices, faces):
    """Vertices, middles of edges and of faces."""
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    return np.concatenate([vertices, vertices[edges].mean(axis=1), vertices[faces].mean(axis=1)])


def test_crossings_are_told_by_ray_and_then_by_distance():
    scene = eyerays.Scene(SQUARE, HALVES)
    second = scene.add_mesh(SQUARE + 2 * UP, HALVES)
    hits = scene.all_hits([[0.5, -0.5, 5.0], [9.0, 9.0, 9.0], [-0.5, 0.5, -4.0]], [-2 * UP, UP, UP])
    assert hits.splits.tolist() == [0, 2, 2, 4] and len(hits) == 4
    assert hits.ray.tolist() == [0, 0, 2, 2]
    assert np.abs(hits.t - [1.5, 2.5, 4.0, 6.0]).max() < 1e-5
    assert hits.object.tolist() == [second, 0, 0, second] and hits.triangle.tolist() == [0, 0, 1, 1]
    assert np.abs(hits.uv - [[0.5, 0.25], [0.5, 0.25], [0.25, 0.5], [0.25, 0.5]]).max() < 1e-6
    assert np.abs(hits.point - [[0.5, -0.5, 2], [0.5, -0.5, 0], [-0.5, 0.5, 0], [-0.5, 0.5, 2]]).max() < 1e-6
    assert hits.normal.tolist() == [[0, 0, 1]] * 4 and (hits.error > 0).all()
    assert scene.count([[0.5, -0.5, 5.0]], -UP, tmax=4.0).tolist() == [1]
    some = scene.all_hits([[0.5, -0.5, 5.0]], -UP, fields="t")
    assert some.triangle is None and some.t.tolist() == [3.0, 5.0]
    none = scene.all_hits(np.zeros((0, 3)), UP)
    assert len(none) == 0 and none.uv.shape == (0, 2) and none.splits.tolist() == [0]


@pytest.mark.parametrize("shift", [0.0, 1e6])
@pytest.mark.parametrize("squeeze", [1.0, 1e-4])
def test_no_ray_crosses_a_closed_mesh_the_wrong_number_of_times(shift, squeeze):
    for vertices, faces in (icosphere(4), (CUBE * 2 - 1, SIDES)):
        vertices = vertices * [1.0, squeeze, 1.0] + shift
        scene = eyerays.Scene(vertices, faces)
        aims = aimed(vertices, faces)
        for inside in ([0.0, 0.0, 0.0], [0.25, 0.125 * squeeze, -0.5], [0.31, -0.22 * squeeze, 0.54]):
            origin = np.array(inside) + shift
            assert (scene.count(origin, aims - origin) % 2 == 1).all()
        for outside in ([3.0, 0.0, 0.0], [1.0, 5.0, 1.0], [-7.0, 0.3, 1e3]):
            origin = np.array(outside) + shift
            assert (scene.count(origin, aims - origin) % 2 == 0).all()


def test_a_surface_that_is_only_touched_counts_twice_or_not_at_all():
    vertices, faces = icosphere(3)
    scene = eyerays.Scene(vertices, faces)
    along = np.cross(vertices, [0.3, 0.5, -0.7])
    counts = scene.count(vertices - 3 * along, along)
    assert set(counts.tolist()) <= {0, 2} and 0 in counts and 2 in counts


def test_points_are_inside_or_outside_wherever_they_are():
    vertices, faces = icosphere(3)
    scene = eyerays.Scene(vertices, faces)
    scene.add_mesh(vertices * 0.25, faces)
    random = np.random.default_rng(2)
    points = random.uniform(-1.2, 1.2, (20, 500, 3))
    distance = np.linalg.norm(points, axis=-1)
    inside = scene.contains(points)
    assert inside.shape == (20, 500)
    # Between the balls and the triangles in them nothing is said here; of a ball within a ball the shell is inside.
    assert (inside[(distance < 0.98) & (distance > 0.26)]).all()
    assert not inside[(distance > 1) | (distance < 0.24)].any()


def test_bad_rays_and_arrays_are_refused():
    scene = eyerays.Scene(SQUARE, HALVES)
    with pytest.raises(ValueError, match="direction of ray 1 is zero"):
        scene.count(np.zeros((2, 3)), [UP, UP * 0])
    with pytest.raises(ValueError, match="origin of ray 1 is not finite"):
        scene.all_hits([[0, 0, 0], [0, np.nan, 0]], UP)
    with pytest.raises(ValueError, match="a hit has no 'colour'"):
        scene.all_hits([0, 0, 1], -UP, fields="colour")
    with pytest.raises(TypeError, match="int32"):
        scene.count([0, 0, 1], -UP, out=np.zeros((), np.int64))
    with pytest.raises(ValueError, match="shape"):
        scene.count([[0, 0, 1]], -UP, out=np.zeros(3, np.int32))
    with pytest.raises(ValueError, match="point 2 is not finite"):
        scene.closest_point([[0, 0, 0], [1, 1, 1], [0, 0, np.inf]])
