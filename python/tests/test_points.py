"""What points are asked of: how far surfaces are, and which see each other."""

import numpy as np
import pytest

import eyerays
from test_crossings import CUBE, SIDES
from test_scene import HALVES, SQUARE, UP, icosphere


def nearest(vertices, faces, point):
    """The least distance of any triangle, by its plane and its edges in double precision."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    height = np.einsum("ij,ij->i", point - a, n)
    foot = point - height[:, None] * n
    inside = np.ones(len(faces), bool)
    least = np.full(len(faces), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(q - p, foot - p), n) >= 0
        share = np.clip(np.einsum("ij,ij->i", point - p, q - p) / np.einsum("ij,ij->i", q - p, q - p), 0, 1)
        least = np.minimum(least, np.linalg.norm(point - p - share[:, None] * (q - p), axis=1))
    return np.where(inside, np.minimum(least, np.abs(height)), least).min()


def test_the_nearest_place_of_a_square_is_where_it_is():
    scene = eyerays.Scene(SQUARE, HALVES)
    found = scene.closest_point([[[0.5, -0.5, 2.0], [5.0, 1.0, 0.0]]])
    assert found.distance.tolist() == [[2.0, 4.0]]
    assert found.point.tolist() == [[[0.5, -0.5, 0.0], [1.0, 1.0, 0.0]]]
    assert found.triangle[0, 0] == 0 and found.object.tolist() == [[0, 0]]
    assert found.uv[0, 0].tolist() == [0.5, 0.25] and found.normal[0].tolist() == [[0, 0, 1]] * 2
    assert (found.error > 0).all() and (found.error < 1e-4).all()
    out = {"distance": np.zeros((1, 2)), "point": np.zeros((1, 2, 3))}
    same = scene.closest_point([[[0.5, -0.5, 2.0], [5.0, 1.0, 0.0]]], out=out)
    assert same.distance is out["distance"] and same.triangle is None and np.array_equal(same.point, found.point)
    assert scene.closest_point([0, 0, 1], fields="distance").distance.shape == ()


@pytest.mark.parametrize("far", [1e5, 1e18, 1e30, 1e200, 1e290])
@pytest.mark.parametrize("size", [1.0, 1e-15])
def test_far_points_are_as_far_as_they_are(far, size):
    vertices, faces = icosphere(2)
    scene = eyerays.Scene(vertices * size, faces)
    distance = np.zeros(1)
    scene.closest_point([[far, 0.0, 0.0]], out={"distance": distance})
    assert distance[0] == pytest.approx(far - size, rel=1e-6)


@pytest.mark.parametrize(
    ("error", "said", "arguments"),
    [
        (ValueError, "a nearest point has no 't'; it has distance,", {"fields": "t"}),
        (ValueError, "a nearest point has no 'hit'", {"out": {"hit": np.zeros(1)}}),
        (ValueError, "out['distance'] has the shape (2,), not (1,)", {"out": {"distance": np.zeros(2)}}),
    ],
)
def test_fields_that_nearest_points_have_not_are_refused_by_their_names(error, said, arguments):
    with pytest.raises(error) as raised:
        eyerays.Scene(SQUARE, HALVES).closest_point([[0.0, 0.0, 1.0]], **arguments)
    assert said in str(raised.value)


@pytest.mark.parametrize("pair", [[[0, 0, np.nan], [0, 0, 1]], [[0, 0, -1e308], [0, 0, 1e308]]])
def test_pairs_without_a_distance_are_refused_by_that_name(pair):
    with pytest.raises(ValueError, match="pairs"):
        eyerays.Scene(SQUARE, HALVES).visibility([pair])


def test_points_that_are_far_from_each_other_see_each_other():
    scene = eyerays.Scene(SQUARE, HALVES)
    pairs = np.array([[[0.5, -0.5, -1.0], [0.5, -0.5, 1.0]], [[3.0, 0.0, -1.0], [3.0, 0.0, 1.0]]])
    for far in (1.0, 1e6):
        assert scene.visibility(pairs * [1.0, 1.0, far]).tolist() == [False, True]
    # So far that the square of their distance is no number.
    assert scene.visibility(pairs[1] * [1.0, 1.0, 1e200])


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_distances_are_those_of_every_triangle(shift):
    vertices, faces = icosphere(2)
    vertices = vertices * [1.0, 0.2, 3.0] + shift
    scene = eyerays.Scene(vertices, faces)
    random = np.random.default_rng(3)
    points = shift + random.normal(size=(300, 3)) * 10.0 ** random.uniform(-2, 3, (300, 1))
    found = scene.closest_point(points)
    # The vertices are rounded to single precision once they have been moved.
    rounding = 3.0 * 2.0**-24
    for point, distance, place, error in zip(points, found.distance.astype(np.float64), found.point, found.error):
        expected = nearest(vertices, faces, point)
        assert abs(distance - expected) <= error + rounding + distance * 2.0**-23
        assert abs(np.linalg.norm(place - point) - distance) <= 1e-6 * max(distance, 1)


def test_distances_have_the_sign_of_the_side():
    scene = eyerays.Scene(CUBE, SIDES)
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.9], [0.5, 0.5, 2.0], [-0.5, -0.5, -0.5], [0.25, 0.5, 1.0]])
    expected = [-0.5, -0.1, 1.0, 0.75**0.5, 0.0]
    assert np.abs(scene.signed_distance(points) - expected).max() < 1e-6
    vertices, faces = icosphere(5)
    points = np.random.default_rng(1).uniform(-2, 2, (5000, 3))
    distance = eyerays.Scene(vertices, faces).signed_distance(points)
    # A ball of triangles is in its sphere, by less than this.
    assert np.abs(distance - (np.linalg.norm(points, axis=1) - 1)).max() < 6e-4


def test_points_see_each_other_unless_something_is_between():
    scene = eyerays.Scene(SQUARE, HALVES)
    above, below, beside = [0.25, 0.5, 1.0], [0.25, 0.5, -1.0], [3.0, 0.5, -1.0]
    assert scene.visibility([above, below]) == False  # noqa: E712
    assert scene.visibility([[above, beside], [above, below], [below, beside], [above, above]]).tolist() == [True, False, True, True]
    # Points on the square see what is above and below it, and one another.
    at = scene.closest(above, -UP).point
    assert scene.visibility([[at, above], [below, at], [at, at + [0.5, 0, 0]]]).all()
    assert scene.visibility([[above, below]], margin=1.5).all()
    with pytest.raises(ValueError, match="two points"):
        scene.visibility([above, below, beside])
    with pytest.raises(ValueError, match="margin"):
        scene.visibility([above, below], margin=-1)


def test_surfaces_see_each_other_as_they_do_in_a_box():
    """From the floor of an open box all of its walls are seen, whatever the size of its numbers."""
    for scale in (1e-6, 1.0, 1e6):
        scene = eyerays.Scene(CUBE * scale, SIDES[2:])
        random = np.random.default_rng(4)
        floor = random.uniform(0.05, 0.95, (1000, 3)) * [1, 1, 0]
        wall = random.uniform(0.05, 0.95, (1000, 3)) * [1, 0, 1]
        assert scene.visibility(np.stack([floor, wall], axis=1) * scale).all()
        assert not scene.visibility(np.stack([wall, wall + [0, 2, 0]], axis=1) * scale).any()
