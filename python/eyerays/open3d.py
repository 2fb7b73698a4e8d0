"""The interface of Open3D's `RaycastingScene`, answered exactly.

>>> import open3d as o3d, eyerays.open3d
>>> scene = eyerays.open3d.RaycastingScene()
>>> scene.add_triangles(o3d.t.geometry.TriangleMesh.create_box())
0
>>> scene.compute_occupancy(o3d.core.Tensor([[0.5, 0.5, 0.5]])).numpy().tolist()
[1.0]
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from ._device import host_array
from ._scene import Scene

NONE = 0xFFFF_FFFF


class RaycastingScene:
    """Rays and points asked of triangles, as `open3d.t.geometry.RaycastingScene` answers them.

    Tensors or arrays of other libraries go in, and tensors of the CPU come out. What is different: first hits are never lost at edges, and crossings
    of closed meshes are even from outside and odd from inside, so that `nsamples` has nothing to add. `nthreads` counts where the scene is made, and
    nowhere else. A ray that goes nowhere is a ValueError. `device` takes what Open3D has (its CPU), or a name of `Scene.closest`: "auto", "cpu", "gpu".
    """

    INVALID_ID = NONE
    """In place of a geometry or a triangle that there is not."""

    def __init__(self, nthreads: int = 0, device: Any = "auto") -> None:
        self._scene = Scene(threads=nthreads)
        self._device = device if isinstance(device, str) and device in ("auto", "cpu", "gpu") else "auto"

    def add_triangles(self, vertex_positions: Any, triangle_indices: Any = None) -> int:
        """Adds vertices (n, 3) and triangles (m, 3), or a mesh. Returns the number of the geometry."""
        if triangle_indices is None:
            mesh = vertex_positions
            vertex_positions, triangle_indices = mesh.vertex.positions, mesh.triangle.indices
        return self._scene.add_mesh(_array("vertex_positions", vertex_positions), _array("triangle_indices", triangle_indices))

    def cast_rays(self, rays: Any, nthreads: int = 0) -> dict[str, o3d.core.Tensor]:
        """What rays (..., 6), origins and directions, hit first: `t_hit`, `geometry_ids`, `primitive_ids`, `primitive_uvs`, `primitive_normals`."""
        hits = self._scene.closest(*_split(rays), device=self._device, fields=("t", "object", "triangle", "uv", "normal"))
        return {"t_hit": _tensor(hits.t), **_surfaces(hits)}

    def test_occlusions(self, rays: Any, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0) -> o3d.core.Tensor:
        """Whether rays hit anything between `tnear` and `tfar` lengths of their directions."""
        origins, directions = _split(rays)
        if tnear > 0:
            origins = origins.astype(np.float64) + np.float64(tnear) * directions
        # Below zero nothing counts.
        return _tensor(self._scene.any(origins, directions, tmax=tfar - max(tnear, 0.0), device=self._device))

    def count_intersections(self, rays: Any, nthreads: int = 0) -> o3d.core.Tensor:
        """How many triangles rays cross."""
        return _tensor(self._scene.count(*_split(rays), device=self._device))

    def list_intersections(self, rays: Any, nthreads: int = 0) -> dict[str, o3d.core.Tensor]:
        """All triangles that rays cross: `ray_splits`, `ray_ids`, `t_hit`, `geometry_ids`, `primitive_ids`, `primitive_uvs`."""
        hits = self._scene.all_hits(*_split(rays), device=self._device, fields=("t", "object", "triangle", "uv"))
        ids = {"ray_splits": _tensor(hits.splits.astype(np.uint32)), "ray_ids": _tensor(hits.ray.astype(np.uint32))}
        return {**ids, "t_hit": _tensor(hits.t), **_surfaces(hits)}

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> dict[str, o3d.core.Tensor]:
        """Where triangles come nearest to points (..., 3): `points`, `geometry_ids`, `primitive_ids`, `primitive_uvs`, `primitive_normals`."""
        fields = ("point", "object", "triangle", "uv", "normal")
        nearest = self._scene.closest_point(_array("query_points", query_points), device=self._device, fields=fields)
        return {"points": _tensor(nearest.point.astype(np.float32)), **_surfaces(nearest)}

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> o3d.core.Tensor:
        """How far points are from the nearest triangle."""
        nearest = self._scene.closest_point(_array("query_points", query_points), device=self._device, fields="distance")
        return _tensor(nearest.distance)

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> o3d.core.Tensor:
        """The same, below zero inside of closed meshes."""
        _check(nsamples)
        return _tensor(self._scene.signed_distance(_array("query_points", query_points), device=self._device).astype(np.float32))

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> o3d.core.Tensor:
        """1 inside of closed meshes, 0 outside."""
        _check(nsamples)
        return _tensor(self._scene.contains(_array("query_points", query_points), device=self._device).astype(np.float32))

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> o3d.core.Tensor:
        """Rays (height, width, 6) of a camera: by an intrinsic and an extrinsic matrix, or by field of view, what is looked at, place and up."""
        return o3d.t.geometry.RaycastingScene.create_rays_pinhole(*args, **kwargs)


def _check(nsamples: int) -> None:
    if nsamples < 1 or nsamples % 2 == 0:
        raise ValueError(f"nsamples is {nsamples}; it is odd and positive")


def _array(name: str, values: Any) -> NDArray:
    # Open3D's DLPack gives no copy on the host.
    return values.cpu().numpy() if isinstance(values, o3d.core.Tensor) else host_array(name, values)


def _tensor(array: NDArray) -> o3d.core.Tensor:
    return o3d.core.Tensor.from_numpy(np.ascontiguousarray(array))


def _split(rays: Any) -> tuple[NDArray, NDArray]:
    array = _array("rays", rays)
    if array.ndim < 2 or array.shape[-1] != 6:
        raise ValueError(f"rays have the shape {array.shape}; there are two axes or more, the last of six numbers")
    return array[..., :3], array[..., 3:]


def _surfaces(found: Any) -> Mapping[str, o3d.core.Tensor]:
    """What is told of triangles, with Open3D's names and its values where there is none."""
    told = {"geometry_ids": _tensor(found.object.astype(np.uint32)), "primitive_ids": _tensor(found.triangle.astype(np.uint32))}
    for name, array in (("primitive_uvs", found.uv), ("primitive_normals", found.normal)):
        if array is not None:
            told[name] = _tensor(np.nan_to_num(array, nan=0.0))
    return told
