"""What surfaces are asked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _hits
from ._device import ArrayLike
from ._hits import Crossings, Hits, Nearest
from ._native import Surfaces
from ._progress import Progress, bar

INWARD = (0.48, 0.36, 0.8)
"""Where rays go that tell inside from outside: along no axis, where most scenes have their faces."""

MARGIN = 128
"""Roundoffs that `visibility` leaves out at either end: what a point of `closest` may be off its triangle, twice."""


class Queries:
    """Questions of rays and points. Arguments that several have mean the same to all.

    Arrays may be numpy's, lists, or those of other libraries that have DLPack or `__cuda_array_interface__` (torch, cupy, jax, numba, ...): read where
    they are if that is the host, and else copied there once, since wgpu can't take another API's memory. What requires grad is a TypeError:
    give `x.detach()`. Answers are arrays of numpy.

    `device` is "auto" (a GPU in hardware for 65,536 rays and more if there is one, else the CPU), "cpu" or "gpu"; all have the same
    bits. `progress` is True for a bar of tqdm, or a function that is called with how many are done and how many there are.
    """

    def _built(self) -> Surfaces:
        raise NotImplementedError

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
        with bar(progress) as told:
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
        return self._any(rays, shape, device, out, progress)

    def _any(self, rays, shape, device, out, progress) -> NDArray[np.bool_]:
        out = _arrays.to_fill(out, shape, np.bool_, rays)
        with bar(progress) as told:
            self._built().any(rays, out.reshape(-1), str(device), told)
        return out

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        tmax: ArrayLike = np.inf,
        device: str = "auto",
        fields: str | Iterable[str] | None = None,
        progress: Progress = None,
    ) -> Crossings:
        """All triangles that each ray crosses, the nearest first; of those that are equally far, in the order of `closest`.

        Unlike `closest`, a ray through an edge or a vertex crosses one of the triangles there where it goes through the surface, and two or none
        where it only touches it: as if it were moved by next to nothing, the same way for every triangle. So a closed mesh is crossed an
        even number of times from outside and an odd number from inside. A ray in a triangle's plane does not cross that.
        Arguments are those of `closest`.
        """
        rays, _ = _rays(origins, directions, tmax)
        names = _hits.names(fields)
        with bar(progress) as told:
            arrays, ends = self._built().crossings(rays, names, str(device), told)
        return Crossings(splits=ends, **arrays)

    def count(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        tmax: ArrayLike = np.inf,
        device: str = "auto",
        out: NDArray[np.int32] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.int32]:
        """How many triangles each ray crosses, counted as `all_hits` does. Arguments are those of `closest`."""
        rays, shape = _rays(origins, directions, tmax)
        out = _arrays.to_fill(out, shape, np.int32, rays)
        with bar(progress) as told:
            self._built().count(rays, out.reshape(-1), str(device), told)
        return out

    def contains(
        self,
        points: ArrayLike,
        *,
        device: str = "auto",
        out: NDArray[np.bool_] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether each point (..., 3) is inside, of closed meshes: whether a ray from there crosses them an odd number of times.

        Of meshes that are in one another, every second is inside. A point on a surface is on either side of it.
        """
        counts = self.count(_arrays.rows("points", points), INWARD, device=device, progress=progress)
        out = _arrays.to_fill(out, counts.shape, np.bool_)
        return np.bitwise_and(counts, 1, out=out, casting="unsafe")

    def closest_point(
        self,
        points: ArrayLike,
        *,
        device: str = "auto",
        fields: str | Iterable[str] | None = None,
        out: Mapping[str, NDArray] | None = None,
        progress: Progress = None,
    ) -> Nearest:
        """Where triangles come nearest to each point (..., 3). `fields` and `out` are as in `closest`, with the fields of `Nearest`.

        Which triangle that is is decided in single precision, so that another may be nearer by at most `error`; all that is told of it is
        computed in double precision.
        """
        rows = _arrays.rows("points", points)
        shape = rows.shape[:-1]
        renamed = _hits.of_nearest(fields, out)
        arrays = _hits.arrays(shape, *renamed, (rows,), called={"t": "distance"})
        rows = rows.reshape(-1, 3)
        with bar(progress) as told:
            self._built().nearest(rows, _hits.native(arrays, len(rows)), str(device), told)
        return Nearest(distance=arrays.pop("t", None), **arrays)

    def signed_distance(
        self,
        points: ArrayLike,
        *,
        device: str = "auto",
        out: NDArray[np.float64] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.float64]:
        """How far each point (..., 3) is from closed meshes, below zero inside of them; see `closest_point` and `contains`."""
        rows = _arrays.rows("points", points)
        out = _arrays.to_fill(out, rows.shape[:-1], np.float64)
        self.closest_point(rows, device=device, out={"distance": out}, progress=progress)
        return np.negative(out, out=out, where=self.contains(rows, device=device, progress=progress))

    def visibility(
        self,
        pairs: ArrayLike,
        *,
        margin: float | None = None,
        device: str = "auto",
        out: NDArray[np.bool_] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether two points see each other, for each pair of them (..., 2, 3).

        Nothing counts that is nearer than `margin` to either, so that both may lie on surfaces: 128 roundoffs of the scene's size unless it is
        given. Points that are closer to each other than two margins see each other.
        """
        ends = _arrays.rows("pairs", pairs)
        if ends.ndim < 2 or ends.shape[-2] != 2:
            raise ValueError(f"pairs has the shape {ends.shape}; its last axes must be two points of three numbers")
        if margin is None:
            margin = MARGIN * self._built().roundoff
        elif not isinstance(margin, (int, float, np.number)) or not 0 <= margin < np.inf:
            raise ValueError(f"margin is {margin!r}; it is a number that is zero or more")
        if not np.isfinite(ends).all():
            raise ValueError("pairs is not finite")
        starts = ends[..., 0, :].astype(np.float64)
        with np.errstate(over="ignore", invalid="ignore"):
            ways = ends[..., 1, :] - starts
            # By their largest number, whose square may be none.
            largest = np.abs(ways).max(axis=-1)
            lengths = largest * np.linalg.norm(ways / np.where(largest > 0, largest, 1)[..., None], axis=-1)
        if not np.isfinite(lengths).all():
            raise ValueError("pairs has points that are too far apart for their distance to be a number; choose a larger unit")
        far = lengths > 2 * margin
        # Those that are close to each other go anywhere, but no way.
        ways[lengths == 0] = INWARD
        left = np.divide(margin, lengths, out=np.zeros_like(lengths), where=far)
        starts += ways * left[..., None]
        rays, shape = _rays(starts, ways, np.where(far, 1 - 2 * left, -1.0))
        met = self._any(rays, shape, device, out, progress)
        return np.logical_not(met, out=met)


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
