"""Surfaces that rays meet."""

from __future__ import annotations

import os
import tempfile
import threading
import warnings
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _files
from ._device import ArrayLike
from ._native import Studio, Surfaces
from ._queries import Queries

MOST_THREADS = 1024

_STAYED: list[Surfaces | None] = []
"""What forked processes have left of those that they were forked from."""

FAR = 8.0
"""A scene that is so many times its size away from zero is moved there before it is rounded."""


IN_CODE = {"integrator": "path", "sampler": "sobol"}
"""How a scene in code is drawn unless it is said otherwise."""

STANDS = ("file", "shape", "scale", "rotate", "translate", "place", "on")
"""What a mesh in code says by its vertices."""


@dataclass(frozen=True)
class _Mesh:
    """Vertices, triangles, where copies stand if it is copied, and what it looks like."""

    vertices: NDArray
    faces: NDArray[np.uint32]
    transforms: NDArray[np.float64] | None
    normals: NDArray | None
    uv: NDArray | None
    look: Mapping[str, Any]


class Scene(Queries):
    """Triangles, alone or many times, that rays are sent through.

    Coordinates are kept in float32. Those of float64 are rounded once; a scene that is far away from zero for its size is moved to it
    before, so that nothing of its shape is lost. Rays of float64 are rounded once, too, where they meet the scene.

    `render` draws it, too: `add_material`, `add_light` and `background` say with the words of scene files what that shows.

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
        self._meshes: list[_Mesh] = []
        self._materials: dict[str, dict[str, Any]] = {}
        self._lights: list[dict[str, Any]] = []
        self.background: Mapping[str, Any] | None = None
        """What is behind all, for pictures: the keys of `[background]`, such as `color`, or `environment` with the path of a picture."""
        self._objects = 0
        self._quality, self._threads = quality, threads
        self._path: str | None = None
        self._forget()
        if (vertices is None) != (faces is None):
            raise ValueError("vertices and faces belong together; give both or none")
        if vertices is not None and faces is not None:
            self.add_mesh(vertices, faces)

    def add_mesh(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        **look: Any,
    ) -> int:
        """Adds a mesh: vertices (n, 3) and triangles (m, 3) by their vertices. Returns the number of the object that it becomes.

        All else is for pictures: normals (n, 3) and texture coordinates (n, 2) of the vertices, the second up, and keys of `[[mesh]]` of scene files,
        such as `material` (a name that `add_material` has), `smooth`, `visible`, and `key` for what moves. Rays meet the mesh where
        its vertices are.
        """
        return self._add(vertices, faces, None, (normals, uv, look))

    def add_instances(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        transforms: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        **look: Any,
    ) -> range:
        """Adds copies of a mesh that is kept once: one for each matrix (k, 4, 4), which takes its vertices to the scene.

        Returns the numbers of the objects that they become. All else is as in `add_mesh`.
        """
        moved = _arrays.matrices("transforms", transforms).copy()
        if len(moved) == 0:
            raise ValueError("transforms is empty; give a matrix at least")
        first = self._add(vertices, faces, moved, (normals, uv, look))
        return range(first, self._objects)

    def _add(self, vertices: ArrayLike, faces: ArrayLike, transforms: NDArray | None, drawn: tuple) -> int:
        if self._path is not None:
            raise ValueError("the scene is that of a file, which takes no more meshes; make another scene")
        # Copies: what callers do to their arrays later changes nothing here.
        places = _arrays.finite_rows("vertices", vertices).copy()
        corners = _arrays.corners("faces", faces, len(places))
        normals, uv, look = drawn
        for key in STANDS:
            if key in look:
                raise TypeError(f"a mesh in code has no {key!r}: it stands where its vertices are")
        normals = None if normals is None else _arrays.of_vertices("normals", normals, (len(places), 3))
        uv = None if uv is None else _arrays.of_vertices("uv", uv, (len(places), 2))
        with self._lock:
            first = self._objects
            self._meshes.append(_Mesh(places, corners, transforms, normals, uv, dict(look)))
            self._objects += 1 if transforms is None else len(transforms)
            self._surfaces = None
        return first

    def add_material(self, name: str, **keys: Any) -> str:
        """Adds a material for pictures, with the keys of `[[material]]` of scene files (`base_color`, `metallic`, `roughness`, ...). Returns its name."""
        self._in_code("materials")
        self._materials[str(name)] = dict(keys)
        return str(name)

    def add_light(self, kind: str, **keys: Any) -> None:
        """Adds a light for pictures: "point", "spot", "directional", ... with the keys of `[[light]]` of scene files."""
        self._in_code("lights")
        self._lights.append({"kind": kind, **keys})

    def _in_code(self, what: str) -> None:
        if self._path is not None:
            raise ValueError(f"the scene is that of a file, which has its own {what}; make another scene")

    def _drawn(self, wish: Mapping[str, Any]) -> tuple[Studio, list[str]]:
        """What draws the scene, and what is warned of."""
        if self._path is not None:
            return Studio.open({"path": self._path, "text": None, **wish})
        if not self._meshes:
            raise ValueError("the scene is empty; add a mesh")
        with tempfile.TemporaryDirectory(prefix="eyerays-") as folder:
            meshes = []
            for number, mesh in enumerate(self._meshes):
                name = f"mesh{number}"
                data = _files.glb(name, mesh.vertices, mesh.faces, mesh.normals, mesh.uv, mesh.transforms)
                Path(folder, f"{name}.glb").write_bytes(data)
                meshes.append({"file": f"{name}.glb", "material": "default", **mesh.look})
            materials = [{"name": name, **keys} for name, keys in self._materials.items()]
            tables = {"render": IN_CODE, "background": self.background, "light": self._lights or None}
            text = _files.toml({**tables, "material": materials or None, "mesh": meshes})
            try:
                return Studio.open({"path": os.path.join(folder, "scene.toml"), "text": text, **wish})
            except ValueError as error:
                # The folder is gone when that is read.
                raise ValueError(str(error).replace(folder + os.sep, "")) from None

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
        own = ("_meshes", "_materials", "_lights", "background", "_objects", "_quality", "_threads", "_path")
        state = {name: getattr(self, name) for name in own}
        return {**state, **{name: copy(state[name]) for name in ("_meshes", "_materials", "_lights")}}

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
            vertices, faces = mesh.vertex.positions.cpu().numpy(), mesh.triangle.indices.cpu().numpy()
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
                meshes = [(of.vertices, of.faces, of.transforms) for of in self._meshes]
                self._surfaces = Surfaces.of_meshes(meshes, _offset(meshes), self._quality, self._threads)
            return self._surfaces


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
