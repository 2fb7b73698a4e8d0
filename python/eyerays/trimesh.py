"""The interface of `trimesh.ray`, answered exactly.

>>> import trimesh, eyerays.trimesh
>>> mesh = trimesh.creation.icosphere()
>>> mesh.ray = eyerays.trimesh.RayMeshIntersector(mesh)
>>> bool(mesh.contains([[0.0, 0.0, 0.5]])[0])
True
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._device import ArrayLike, host_array
from ._scene import Scene


STEEP = 1e-4
"""The least cosine between a ray and a normal where they tell of a place."""


class RayMeshIntersector:
    """Rays through a `trimesh.Trimesh`, as `trimesh.ray.ray_pyembree.RayMeshIntersector` has them.

    What is different: all crossings of a ray are found, once each, and sorted by ray and then by distance; of closed meshes they are even from outside
    and odd from inside (see `Scene.all_hits`), while a first hit is never lost at an edge. `max_hits` ends no search: it is how many
    of a ray's crossings are told. A ray that goes nowhere is a ValueError. `device` is that of `Scene.closest`.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, device: str = "auto") -> None:
        """`scale_to_box` is of no consequence: coordinates are always those of a cube around the mesh."""
        self.mesh = geometry
        self._scale_to_box, self._device = scale_to_box, device
        self._built: tuple[int, Scene] | None = None

    @property
    def _scene(self) -> Scene | None:
        """The mesh as it is now; nothing if it has no triangle."""
        if len(self.mesh.faces) == 0:
            return None
        state = hash(self.mesh)
        if self._built is None or self._built[0] != state:
            self._built = (state, Scene.from_trimesh(self.mesh))
        return self._built[1]

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[NDArray, NDArray, NDArray]:
        """Where rays hit the mesh: places (m, 3), whose rays (m,) and which triangles (m,) they are."""
        triangles, rays, places = self.intersects_id(ray_origins, ray_directions, multiple_hits, return_locations=True)
        return places, rays, triangles

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int = 100,
        return_locations: bool = False,
    ) -> tuple[NDArray, ...]:
        """Which triangles (m,) the rays (m,) hit, all of them or their first, and where (m, 3) if that is asked for."""
        origins, directions = _rays(ray_origins, ray_directions)
        fields = ["triangle", "point"] if return_locations else ["triangle"]
        scene = self._scene
        if scene is None:
            triangles, rays, places = np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 3))
        elif multiple_hits:
            hits = scene.all_hits(origins, directions, fields=fields, device=self._device)
            rays = hits.ray
            kept = np.arange(len(rays)) - hits.splits[rays] < max_hits
            triangles, rays, places = hits.triangle[kept], rays[kept], hits.point
            places = None if places is None else places[kept]
        else:
            hits = scene.closest(origins, directions, fields=fields, device=self._device)
            rays = np.flatnonzero(hits.hit)
            triangles, places = hits.triangle[rays], hits.point
            places = None if places is None else places[rays]
        if not return_locations:
            return triangles.astype(np.int64), rays
        return triangles.astype(np.int64), rays, self._along(origins[rays], directions[rays], triangles, places)

    def _along(self, origins: NDArray, directions: NDArray, triangles: NDArray, places: NDArray) -> NDArray:
        """Where rays meet the planes of their triangles, in double precision; `places` where they run along those."""
        a, b, c = np.moveaxis(self.mesh.vertices.view(np.ndarray)[self.mesh.faces[triangles]], 1, 0)
        normals = np.cross(b - a, c - a)
        turn = np.einsum("ij,ij->i", normals, directions)
        sizes = np.linalg.norm(normals, axis=1) * np.linalg.norm(directions, axis=1)
        steep = np.abs(turn) > STEEP * sizes
        t = np.divide(np.einsum("ij,ij->i", normals, a - origins), turn, out=np.zeros(len(turn)), where=steep)
        return np.where(steep[:, None], origins + t[:, None] * directions, places)

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.int64]:
        """The triangle that each ray hits first (n,), -1 where there is none."""
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._scene
        if scene is None:
            return np.full(len(origins), -1, np.int64)
        hits = scene.closest(origins, directions, out={"triangle": np.empty(len(origins), np.int64)}, device=self._device)
        return hits.triangle

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Whether each ray hits anything (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._scene
        return np.zeros(len(origins), bool) if scene is None else scene.any(origins, directions, device=self._device)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point (n, 3) is inside, of a closed mesh."""
        points = _rows("points", points)
        scene = self._scene
        return np.zeros(len(points), bool) if scene is None else scene.contains(points, device=self._device)

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, self._device)

    def __deepcopy__(self, _: Any) -> RayMeshIntersector:
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_built": None}


def _rays(origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray, NDArray]:
    origins, directions = _rows("ray_origins", origins), _rows("ray_directions", directions)
    if origins.shape != directions.shape:
        raise ValueError(f"ray origins {origins.shape} and directions {directions.shape} do not go together")
    return origins, directions


def _rows(name: str, values: ArrayLike) -> NDArray[np.float64]:
    rows = np.asarray(host_array(name, values), np.float64)
    return rows.reshape(-1, 3) if rows.size == 0 or rows.ndim == 1 else rows
