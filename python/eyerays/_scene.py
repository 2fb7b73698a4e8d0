"""Surfaces that rays meet."""

from __future__ import annotations

import os
import threading
import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _hits
from ._hits import Hits
from ._native import Surfaces

Progress = bool | Callable[[int, int], Any] | None
"""True for a bar of tqdm, or what is called with how many rays are done and how many there are."""

MOST_THREADS = 1024

_STAYED: list[Surfaces | None] = []
"""What forked processes have left of those that they were forked from."""

FAR = 8.0
"""A scene that is so many times its size away from zero is moved there before it is rounded."""


class Scene:
    """Triangles, alone or many times, that rays are sent through.

    Coordinates are kept in float32. Those of float64 are rounded once; a scene that is far away from zero for its size is moved to it
    before, so that nothing of its shape is lost. Rays of float64 are rounded once, too, where they meet the scene.

    Several threads may ask one scene, and processes that were forked. `threads` is how many it takes itself; 0 is one a core.
    `quality` is how well the hierarchy over the triangles is built: "fast", "medium" or "high".
    """

    def __init__(
        self,
        vertices: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        *,
        quality: str = "medium",
        threads: int = 0,
    ) -> None:
        if not 0 <= threads <= MOST_THREADS:
            raise ValueError(f"threads is {threads}; it is 0 to {MOST_THREADS}")
        if quality not in ("fast", "medium", "high"):
            raise ValueError(f'quality {quality!r} is none of "fast", "medium" and "high"')
        self._meshes: list[tuple[NDArray, NDArray, NDArray | None]] = []
        self._objects = 0
        self._quality, self._threads = quality, threads
        self._path: str | None = None
        self._forget()
        if (vertices is None) != (faces is None):
            raise ValueError("vertices and faces belong together; give both or none")
        if vertices is not None and faces is not None:
            self.add_mesh(vertices, faces)

    def add_mesh(self, vertices: ArrayLike, faces: ArrayLike) -> int:
        """Adds a mesh: vertices (n, 3) and triangles (m, 3) by their vertices. Returns the number of the object that it becomes."""
        return self._add(vertices, faces, None)

    def add_instances(self, vertices: ArrayLike, faces: ArrayLike, transforms: ArrayLike) -> range:
        """Adds copies of a mesh that is kept once: one for each matrix (k, 4, 4), which takes its vertices to the scene.

        Returns the numbers of the objects that they become.
        """
        moved = _arrays.matrices("transforms", transforms).copy()
        if len(moved) == 0:
            raise ValueError("transforms is empty; give a matrix at least")
        first = self._add(vertices, faces, moved)
        return range(first, self._objects)

    def _add(self, vertices: ArrayLike, faces: ArrayLike, transforms: NDArray | None) -> int:
        if self._path is not None:
            raise ValueError("the scene is that of a file, which takes no more meshes; make another scene")
        # Copies: what callers do to their arrays later changes nothing here.
        places = _arrays.finite_rows("vertices", vertices).copy()
        mesh = (places, _arrays.corners("faces", faces, len(places)), transforms)
        with self._lock:
            first = self._objects
            self._meshes.append(mesh)
            self._objects += 1 if transforms is None else len(transforms)
            self._surfaces = None
        return first

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, quality: str = "medium", threads: int = 0) -> Scene:
        """The surfaces of a file: TOML, glTF, OBJ, PLY or whatever else the program renders. What is warned of is a UserWarning."""
        return cls._loaded(path, quality, threads)

    @classmethod
    def _loaded(cls, path: str | os.PathLike[str], quality: str, threads: int) -> Scene:
        """What is warned of is said of the caller's caller."""
        scene = cls(quality=quality, threads=threads)
        scene._path = os.fsdecode(path)
        for warning in scene._read():
            warnings.warn(warning, stacklevel=3)
        return scene

    def _read(self) -> list[str]:
        self._surfaces, said = Surfaces.load(self._path, self._quality, self._threads)
        return said

    def _forget(self) -> None:
        """What a process has, without what it was made of."""
        self._lock = threading.Lock()
        self._surfaces: Surfaces | None = None
        self._process = os.getpid()

    def __getstate__(self) -> dict[str, Any]:
        own = ("_meshes", "_objects", "_quality", "_threads", "_path")
        state = {name: getattr(self, name) for name in own}
        return {**state, "_meshes": list(self._meshes)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._forget()

    @classmethod
    def from_trimesh(cls, mesh: Any, *, quality: str = "medium", threads: int = 0) -> Scene:
        """The surfaces of a `trimesh.Trimesh`, or of a `trimesh.Scene`: there a mesh that stands in several places is kept once."""
        scene = cls(quality=quality, threads=threads)
        if hasattr(mesh, "graph"):
            for name, geometry in mesh.geometry.items():
                nodes = mesh.graph.geometry_nodes.get(name, ())
                if hasattr(geometry, "faces") and len(geometry.faces) and len(nodes):
                    scene.add_instances(geometry.vertices, geometry.faces, [mesh.graph.get(node)[0] for node in nodes])
        elif hasattr(mesh, "faces"):
            scene.add_mesh(mesh.vertices, mesh.faces)
        if not scene._meshes:
            raise ValueError(f"this {type(mesh).__name__} has no triangle")
        return scene

    @classmethod
    def from_open3d(cls, mesh: Any, *, quality: str = "medium", threads: int = 0) -> Scene:
        """The surfaces of an Open3D mesh, of its tensors or of the older kind."""
        if hasattr(mesh, "triangle"):
            vertices, faces = mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy()
        else:
            vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
        return cls(vertices, faces, quality=quality, threads=threads)

    @property
    def triangles(self) -> int:
        """How many triangles there are, those of copies as often as they are copied; spheres and disks of files count too."""
        return self._built().triangles

    @property
    def names(self) -> list[str]:
        """The names of the objects; those that were added here have none."""
        return self._built().objects

    def build(self) -> Scene:
        """Builds the hierarchy now, which the first question does otherwise."""
        self._built()
        return self

    def _built(self) -> Surfaces:
        if self._process != os.getpid():
            # The threads have stayed behind; what waits for them when it is thrown away is kept.
            _STAYED.append(self._surfaces)
            self._forget()
        with self._lock:
            if self._surfaces is None and self._path is not None:
                self._read()
            elif self._surfaces is None:
                if not self._meshes:
                    raise ValueError("the scene is empty; add a mesh")
                offset = _offset(self._meshes)
                self._surfaces = Surfaces.of_meshes(self._meshes, offset, self._quality, self._threads)
            return self._surfaces

    def closest(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        tmax: ArrayLike = np.inf,
        device: str = "auto",
        fields: str | Iterable[str] | None = None,
        out: Mapping[str, NDArray] | None = None,
        progress: Progress = None,
    ) -> Hits:
        """What each ray meets first.

        `origins` and `directions` (..., 3) are broadcast against each other; a direction has any length but zero. Nothing that is
        farther than `tmax` lengths of its direction counts. `fields` names what is told (see `Hits`; all of it otherwise), and `out`
        has arrays that are filled instead of new ones, by their names; without `fields`, they alone. Edges and vertices belong to every
        triangle that has them; of several that are equally far, those of `add_mesh` are met before those of `add_instances`, and
        else what was added first. A ray that starts on a triangle does not meet it there.
        """
        rays, shape = _rays(origins, directions, tmax)
        arrays = _hits.arrays(shape, fields, out, (of for of in rays if isinstance(of, np.ndarray)))
        with _bar(progress) as told:
            self._built().closest(rays, _hits.native(arrays, len(rays[0])), str(device), told)
        return Hits(**arrays)

    def any(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        tmax: ArrayLike = np.inf,
        device: str = "auto",
        out: NDArray[np.bool_] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray meets anything, in an array of the rays' shape. Arguments are those of `closest`."""
        rays, shape = _rays(origins, directions, tmax)
        if out is None:
            out = np.empty(shape, np.bool_)
        elif not isinstance(out, np.ndarray) or out.dtype != np.bool_:
            raise TypeError("out is no numpy array of bool")
        elif out.shape != shape or not (out.flags.c_contiguous and out.flags.writeable):
            raise ValueError(f"out has gaps, can't be written to or has not the shape {shape}")
        with _bar(progress) as told:
            self._built().any(rays, out.reshape(-1), str(device), told)
        return out


def load(path: str | os.PathLike[str], *, quality: str = "medium", threads: int = 0) -> Scene:
    """As `Scene.load`."""
    return Scene._loaded(path, quality, threads)


def _offset(meshes: list[tuple[NDArray, NDArray, NDArray | None]]) -> list[float]:
    """The middle of what stands far away from zero for its size, if any of it was given in double precision; else zero."""
    least, greatest = np.full(3, np.inf), np.full(3, -np.inf)
    is_double = False
    for vertices, _, transforms in meshes:
        ends = np.stack([vertices.min(axis=0), vertices.max(axis=0)]).astype(np.float64)
        if transforms is not None:
            corners = np.stack(np.meshgrid(*ends.T), axis=-1).reshape(-1, 3)
            ends = (np.einsum("kij,cj->kci", transforms[:, :3, :3], corners) + transforms[:, None, :3, 3]).reshape(-1, 3)
        is_double |= vertices.dtype == np.float64 or transforms is not None
        least, greatest = np.minimum(least, ends.min(axis=0)), np.maximum(greatest, ends.max(axis=0))
    size = (greatest - least).max()
    far = np.maximum(np.abs(least), np.abs(greatest)).max() > FAR * size
    return ((least + greatest) / 2).tolist() if is_double and far else [0.0, 0.0, 0.0]


def _rays(origins: ArrayLike, directions: ArrayLike, tmax: ArrayLike) -> tuple[tuple[Any, Any, Any], tuple[int, ...]]:
    """Rays with a row each, and the shape that callers see."""
    starts, ways = _arrays.rows("origins", origins), _arrays.rows("directions", directions)
    try:
        starts, ways = np.broadcast_arrays(starts, ways)
    except ValueError:
        raise ValueError(f"origins {starts.shape} and directions {ways.shape} do not go together") from None
    shape = starts.shape[:-1]
    limits = _arrays.doubles("tmax", tmax)
    if limits.ndim:
        try:
            limits = np.ascontiguousarray(np.broadcast_to(limits, shape)).reshape(-1)
        except ValueError:
            raise ValueError(f"tmax {limits.shape} does not go with rays {shape}") from None
    else:
        limits = float(limits)
    return (starts.reshape(-1, 3), ways.reshape(-1, 3), limits), shape


class _bar:
    """What is told of progress: nothing, what the caller gave, or a bar of tqdm if that is installed."""

    def __init__(self, progress: Progress) -> None:
        self._progress, self._tqdm = progress, None

    def __enter__(self) -> Callable[[int, int], Any] | None:
        if self._progress is None or self._progress is False:
            return None
        if callable(self._progress):
            return self._progress
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return None
        self._tqdm = tqdm(unit="rays", unit_scale=True)
        return self._told

    def _told(self, done: int, count: int) -> None:
        self._tqdm.total = count
        self._tqdm.update(done - self._tqdm.n)

    def __exit__(self, *_: object) -> None:
        if self._tqdm is not None:
            self._tqdm.close()
