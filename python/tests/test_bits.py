"""A GPU's answers have the bits of a CPU's."""

import os

import numpy as np
import pytest

import eyerays
from test_scene import icosphere


def test_a_gpu_answers_as_a_cpu_does():
    vertices, faces = icosphere(4)
    scene = eyerays.Scene(vertices, faces)
    scene.add_instances(vertices, faces, [np.diag([0.3, 0.4, 0.2, 1.0]), np.eye(4) + np.eye(4, k=3) * 3])
    random = np.random.default_rng(5)
    origins, directions = random.uniform(-2, 2, (20_000, 3)), random.normal(size=(20_000, 3))
    cpu = scene.closest(origins, directions, device="cpu")
    try:
        gpu = scene.closest(origins, directions, device="gpu")
    except RuntimeError as error:
        if os.environ.get("EYERAYS_REQUIRE_GPU") == "1":
            raise
        pytest.skip(str(error))
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
