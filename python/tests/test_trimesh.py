"""The interface of trimesh.ray."""

import copy
import pickle

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

from eyerays.trimesh import RayMeshIntersector  # noqa: E402


@pytest.fixture
def ball():
    mesh = trimesh.creation.icosphere(4)
    mesh.ray = RayMeshIntersector(mesh)
    return mesh


def test_every_ray_from_the_middle_crosses_a_ball_once(ball):
    triangles, rays, places = ball.ray.intersects_id(np.zeros_like(ball.vertices), ball.vertices, return_locations=True)
    assert rays.tolist() == list(range(len(ball.vertices)))
    assert np.abs(places - ball.vertices).max() < 1e-6
    corners = ball.faces[triangles]
    assert (corners == np.arange(len(ball.vertices))[:, None]).any(axis=1).all()
    assert (ball.ray.intersects_first(np.zeros_like(ball.vertices), ball.vertices) >= 0).all()
    assert ball.ray.intersects_any(np.zeros_like(ball.vertices), ball.vertices).all()


def test_all_hits_of_a_ray_come_in_order_and_first_ones_alone(ball):
    origins, along = [[-3.0, 0.1, 0.2], [-3.0, 5.0, 0.0], [3.0, 0.3, -0.1]], [[1.0, 0, 0], [1.0, 0, 0], [-2.0, 0, 0]]
    places, rays, triangles = ball.ray.intersects_location(origins, along)
    assert rays.tolist() == [0, 0, 2, 2] and triangles.dtype == np.int64
    assert (np.diff(places[:2, 0]) > 1.5).all() and (np.diff(places[2:, 0]) < -1.5).all()
    first, rays, _ = ball.ray.intersects_location(origins, along, multiple_hits=False)
    assert rays.tolist() == [0, 2] and np.abs(first - places[[0, 2]]).max() < 1e-6
    triangles, rays = ball.ray.intersects_id(origins, along, max_hits=1)
    assert rays.tolist() == [0, 2] and triangles.tolist() == ball.ray.intersects_first(origins, along)[[0, 2]].tolist()
    assert ball.ray.intersects_any(origins, along).tolist() == [True, False, True]


def test_a_mesh_asks_for_what_it_contains(ball):
    points = np.random.default_rng(6).uniform(-1.3, 1.3, (2000, 3))
    distance = np.linalg.norm(points, axis=1)
    inside = ball.contains(points)
    assert inside[distance < 0.99].all() and not inside[distance > 1].any()


def test_a_mesh_that_moves_is_asked_where_it_is(ball):
    assert ball.ray.intersects_any([[0, 0, 9]], [[0, 0, -1]]).tolist() == [True]
    ball.apply_translation([5, 0, 0])
    assert ball.ray.intersects_any([[0, 0, 9], [5, 0, 9]], [[0, 0, -1]] * 2).tolist() == [False, True]


def test_an_intersector_is_copied_and_pickled(ball):
    for other in (copy.copy(ball.ray), copy.deepcopy(ball.ray), pickle.loads(pickle.dumps(ball.ray))):
        assert other.intersects_any([[0, 0, 9]], [[0, 0, -1]]).tolist() == [True]


def test_what_has_no_triangle_or_no_ray_gives_empty_arrays(ball):
    nothing = RayMeshIntersector(trimesh.Trimesh())
    assert nothing.intersects_first([[0, 0, 9]], [[0, 0, -1]]).tolist() == [-1]
    assert not nothing.contains_points([[0, 0, 0]]).any()
    assert [len(of) for of in nothing.intersects_location([[0, 0, 9]], [[0, 0, -1]])] == [0, 0, 0]
    assert [of.shape for of in ball.ray.intersects_location(np.zeros((0, 3)), np.zeros((0, 3)))] == [(0, 3), (0,), (0,)]
    with pytest.raises(ValueError, match="do not go together"):
        ball.ray.intersects_any([[0, 0, 9]], [[0, 0, -1]] * 2)
