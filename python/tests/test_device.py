"""Arrays of other libraries, wherever arrays are taken."""

import numpy as np
import pytest
from producers import CudaArray, OldProducer, Producer, line
from test_scene import HALVES, SQUARE, UP, icosphere

import eyerays
import eyerays.trimesh
from eyerays._device import host_array


def test_all_questions_take_arrays_of_other_libraries(kept):
    vertices, faces = icosphere(2)
    random = np.random.default_rng(4)
    origins, directions = random.uniform(-2, 2, (50, 3)), random.normal(size=(50, 3)).astype(np.float32)
    tmax, pairs = random.uniform(0, 4, 50), random.uniform(-2, 2, (50, 2, 3))
    moves = np.tile(np.eye(4), (2, 1, 1))
    moves[1, :3, 3] = [3, 0, 0]

    def answers(given):
        scene = eyerays.Scene(given(vertices), given(faces))
        scene.add_mesh(given(vertices + 5), given(faces), normals=given(vertices), uv=given(vertices[:, :2]))
        scene.add_instances(given(vertices), given(faces), given(moves))
        rays = given(origins), given(directions)
        hits, crossings = scene.closest(*rays, tmax=given(tmax)), scene.all_hits(*rays, tmax=given(np.float64(3.0)))
        yield from (getattr(found, name) for found in (hits, crossings) for name in ("t", "triangle", "object", "point"))
        yield from (scene.any(*rays), scene.count(*rays), scene.contains(given(origins)), scene.visibility(given(pairs)))
        yield from (scene.closest_point(given(origins)).point, scene.signed_distance(given(origins)))

    for own, other in zip(answers(np.asarray), answers(kept)):
        assert own.dtype == other.dtype and own.tobytes() == other.tobytes()


@pytest.mark.parametrize("device", [1, 3, 11])
def test_memory_of_the_host_is_not_copied(device):
    producer = Producer(np.arange(6.0), device)
    assert np.shares_memory(host_array("a", producer), producer.array) and producer.asked[-1][1] is not True


@pytest.mark.parametrize("device", [2, 4, 8, 10, 13, 14])
def test_a_device_is_asked_once_for_a_copy_on_the_host(device):
    producer = Producer(np.arange(6.0).reshape(2, 3), device)
    array = host_array("a", producer)
    assert producer.asked == [((1, 0), True)]
    assert array.tolist() == producer.array.tolist() and not np.shares_memory(array, producer.array)


def test_arrays_of_numpy_are_themselves():
    array = np.arange(12.0).reshape(4, 3)[::2]
    assert host_array("a", array) is array
    with pytest.raises(TypeError, match="a is a masked array"):
        host_array("a", np.ma.masked_less(array, 2))


def test_what_gives_no_copy_is_read_in_another_way(cuda):
    old = OldProducer(SQUARE)
    with pytest.raises(TypeError) as raised:
        host_array("points", old)
    said = line(raised)
    assert said.startswith("points is on a device") and "dl_device" in said and "points.cpu() or points.get()" in said
    old.__cuda_array_interface__ = CudaArray(cuda, SQUARE).__cuda_array_interface__
    assert host_array("points", old).tolist() == SQUARE.tolist() and "cuMemcpyDtoH_v2" in cuda.calls

    class Copied(OldProducer):
        def __array__(self, dtype=None, copy=None):
            return self.array

    assert host_array("points", Copied(SQUARE)).tolist() == SQUARE.tolist()


@pytest.mark.parametrize("device", [1, 2])
def test_gradients_are_not_lost_unseen(device):
    producer = Producer(UP, device)
    producer.requires_grad = True
    with pytest.raises(TypeError) as raised:
        eyerays.Scene(SQUARE, HALVES).closest([0, 0, 1], producer)
    assert "directions.detach()" in line(raised)


def test_the_stand_in_for_trimesh_takes_arrays_of_other_libraries(kept):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(2)
    rays = eyerays.trimesh.RayMeshIntersector(mesh)
    origins = np.random.default_rng(5).uniform(-2, 2, (20, 3))
    assert rays.intersects_any(kept(origins), kept(-origins)).tolist() == rays.intersects_any(origins, -origins).tolist()
    assert rays.contains_points(kept(origins)).tolist() == rays.contains_points(origins).tolist()


def test_the_stand_in_for_open3d_takes_arrays_of_other_libraries(kept):
    o3d = pytest.importorskip("open3d")
    import eyerays.open3d

    tensors, others = eyerays.open3d.RaycastingScene(), eyerays.open3d.RaycastingScene()
    tensors.add_triangles(o3d.core.Tensor(SQUARE), o3d.core.Tensor(HALVES.astype(np.int32)))
    others.add_triangles(kept(SQUARE), kept(HALVES))
    rays = np.array([[0.5, -0.5, 2, 0, 0, -1], [3, 0, 2, 0, 0, -1]], np.float32)
    assert others.cast_rays(kept(rays))["t_hit"].numpy().tolist() == tensors.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy().tolist()
    assert eyerays.Scene(SQUARE, HALVES).any(o3d.core.Tensor(rays)[:, :3], -UP).tolist() == [True, False]


def test_tensors_of_torch():
    torch = pytest.importorskip("torch")
    scene = eyerays.Scene(torch.tensor(SQUARE), torch.tensor(HALVES))
    origins = torch.tensor([[0.5, -0.5, 2.0], [3.0, 0.0, 2.0]])
    assert np.shares_memory(host_array("a", origins), origins.numpy())
    assert scene.closest(origins, torch.tensor([0, 0, -1]), tmax=torch.tensor(5.0)).t.tolist() == [2.0, np.inf]
    assert scene.any(origins.half(), -UP).tolist() == [True, False]
    for said, values in [
        ("origins.detach()", origins.clone().requires_grad_()),
        ("origins.cpu()", origins.to("meta")),
        ("BFloat16", origins.bfloat16()),
        ("to_dense", origins.to_sparse()),
        # DLPack would give it with the other sign.
        ("resolve_neg", torch.complex(origins, origins).conj().imag),
    ]:
        with pytest.raises(TypeError) as raised:
            scene.closest(values, -UP)
        assert said in line(raised)


def test_arrays_of_jax():
    jax = pytest.importorskip("jax")
    scene = eyerays.Scene(jax.numpy.array(SQUARE), jax.numpy.array(HALVES))
    origins = jax.numpy.array([[0.5, -0.5, 2.0], [3.0, 0.0, 2.0]])
    assert scene.closest(origins, jax.numpy.array([0, 0, -1])).t.tolist() == [2.0, np.inf]
    with pytest.raises(TypeError, match="origins holds bfloat16"):
        scene.any(origins.astype(jax.numpy.bfloat16), -UP)
