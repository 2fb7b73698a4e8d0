"""A GPU's answers have the bits of a CPU's."""

import os

import numpy as np
import pytest

import eyerays
from test_scene import icosphere


@pytest.fixture
def scene():
    """A ball and copies of it, where there is a GPU."""
    vertices, faces = icosphere(4)
    scene = eyerays.Scene(vertices, faces)
    scene.add_instances(vertices, faces, [np.diag([0.3, 0.4, 0.2, 1.0]), np.eye(4) + np.eye(4, k=3) * 3])
    try:
        scene.any([0, 0, 0], [0, 0, 1], device="gpu")
    except RuntimeError as error:
        if os.environ.get("EYERAYS_REQUIRE_GPU") == "1":
            raise
        pytest.skip(str(error))
    return scene


def rays(count):
    random = np.random.default_rng(5)
    return random.uniform(-2, 2, (count, 3)), random.normal(size=(count, 3))


def test_rays_of_many_chunks_are_answered_in_their_order(scene):
    """Of one call after the other, whose chunks lie where others did, and after one that has failed between."""

    def stop(done, count):
        raise KeyboardInterrupt

    for count in (400_000, 70_001, 400_001):
        origins, directions = rays(count)
        for ask in (lambda **how: scene.closest(origins, directions, fields=("t", "triangle"), **how), lambda **how: scene.any(origins, directions, **how)):
            with pytest.raises(KeyboardInterrupt):
                ask(device="gpu", progress=stop)
            cpu, gpu = ask(device="cpu"), ask(device="gpu")
            if isinstance(cpu, np.ndarray):
                assert np.array_equal(cpu, gpu)
            else:
                assert np.array_equal(cpu.t, gpu.t) and np.array_equal(cpu.triangle, gpu.triangle)


def test_a_gpu_answers_as_a_cpu_does(scene):
    origins, directions = rays(20_000)
    cpu, gpu = (scene.closest(origins, directions, device=device) for device in ("cpu", "gpu"))
    for name in ("t", "triangle", "object", "uv", "normal", "point", "error"):
        assert getattr(cpu, name).tobytes() == getattr(gpu, name).tobytes(), name
    for question in (scene.all_hits, lambda origins, directions, device: scene.closest_point(origins + directions, device=device)):
        told = [question(origins, directions, device=device) for device in ("cpu", "gpu")]
        for name in set(vars(told[0])):
            assert getattr(told[0], name).tobytes() == getattr(told[1], name).tobytes(), name
    assert np.array_equal(*(scene.count(origins, directions, device=device) for device in ("cpu", "gpu")))
    for limit in (np.inf, 1.0):
        met = [scene.any(origins, directions, tmax=limit, device=device) for device in ("cpu", "gpu")]
        assert np.array_equal(*met)
    assert 0.1 < cpu.hit.mean() < 0.9
