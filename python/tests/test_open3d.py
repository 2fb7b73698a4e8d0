"""The interface of Open3D's RaycastingScene, beside Open3D's own where both must agree."""

import numpy as np
import pytest

o3d = pytest.importorskip("open3d")

from eyerays.open3d import RaycastingScene  # noqa: E402


def tensor(values, kind=np.float32):
    return o3d.core.Tensor(np.array(values, kind))


@pytest.fixture
def scenes():
    """A twisted knot, in both."""
    mesh = o3d.t.geometry.TriangleMesh.from_legacy(o3d.geometry.TriangleMesh.create_torus(1.0, 0.4, 24, 16))
    box = o3d.t.geometry.TriangleMesh.create_box().translate([3.0, 0.0, 0.0])
    both = RaycastingScene(), o3d.t.geometry.RaycastingScene()
    for scene in both:
        assert [scene.add_triangles(mesh), scene.add_triangles(box.vertex.positions, box.triangle.indices.to(o3d.core.uint32))] == [0, 1]
    return both


def asked(shape):
    random = np.random.default_rng(3)
    origins = random.uniform(-4, 4, (*shape, 3))
    aims = random.uniform(-1, 1, (*shape, 3)) + [1.5, 0, 0]
    return tensor(np.concatenate([origins, aims - origins], axis=-1)), tensor(origins)


def test_answers_are_those_of_open3d(scenes):
    rays, points = asked((30, 40))
    own, other = (scene.cast_rays(rays) for scene in scenes)
    assert own.keys() == other.keys()
    same = own["primitive_ids"].numpy() == other["primitive_ids"].numpy()
    assert same.mean() > 0.999
    for name, array in own.items():
        assert array.dtype == other[name].dtype and array.shape == other[name].shape, name
        assert np.allclose(array.numpy()[same], other[name].numpy()[same], atol=1e-4), name
    own, other = (scene.list_intersections(rays) for scene in scenes)
    assert own.keys() == other.keys()
    for name, array in own.items():
        assert array.dtype == other[name].dtype, name
    own, other = (scene.compute_closest_points(points) for scene in scenes)
    assert own.keys() == other.keys()
    # Of places that are equally near either may be told.
    own, other = (np.linalg.norm(of["points"].numpy() - points.numpy(), axis=-1) for of in (own, other))
    assert np.allclose(own, other, atol=1e-5)
    for name in ("test_occlusions", "count_intersections"):
        own, other = (getattr(scene, name)(rays) for scene in scenes)
        assert own.dtype == other.dtype and (own.numpy() == other.numpy()).mean() > 0.999, name
    for name in ("compute_distance", "compute_signed_distance", "compute_occupancy"):
        own, other = (getattr(scene, name)(points) for scene in scenes)
        assert own.dtype == other.dtype and np.allclose(own.numpy(), other.numpy(), atol=1e-5), name


def test_rays_begin_and_end_where_they_are_told(scenes):
    rays = tensor([[3.5, 0.5, 3.0, 0.0, 0.0, -1.0]] * 2)
    for scene in scenes:
        for near, far, met in ((0.0, np.inf, True), (0.0, 1.9, False), (1.9, 2.1, True), (2.1, 2.9, False), (3.1, np.inf, False)):
            assert scene.test_occlusions(rays, tnear=near, tfar=far).numpy().tolist() == [met, met], (near, far)


def test_what_meets_nothing_has_open3ds_values():
    scene = RaycastingScene()
    scene.add_triangles(o3d.t.geometry.TriangleMesh.create_box())
    told = scene.cast_rays(tensor([[9, 9, 9, 0, 0, 1]]))
    assert told["t_hit"].numpy().tolist() == [np.inf] and told["primitive_normals"].numpy().tolist() == [[0, 0, 0]]
    assert told["geometry_ids"].numpy().tolist() == told["primitive_ids"].numpy().tolist() == [RaycastingScene.INVALID_ID]


def test_a_camera_sends_rays_as_open3d_has_them():
    rays = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], [0, 0, -3], [0, 1, 0], 3, 2)
    assert list(rays.shape) == [2, 3, 6]


def test_what_makes_no_sense_is_refused(scenes):
    with pytest.raises(ValueError, match="six numbers"):
        scenes[0].cast_rays(tensor([[1, 2, 3]]))
    with pytest.raises(ValueError, match="nsamples"):
        scenes[0].compute_occupancy(tensor([[1, 2, 3]]), nsamples=2)
