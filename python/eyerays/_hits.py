"""What rays have met."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Hits:
    """What each ray meets first, in arrays of the rays' shape; those that were not asked for are None.

    Where a ray meets nothing, `t` is infinite, `triangle` and `object` are -1, and all else is NaN.
    """

    t: NDArray[np.floating] | None = None
    """How far, in lengths of the ray's direction: the ray is at `origin + t * direction`."""
    triangle: NDArray[np.signedinteger] | None = None
    """Which triangle of its object, by its row in `faces`."""
    object: NDArray[np.signedinteger] | None = None
    """Which object: what `add_mesh` returned, or one of what `add_instances` returned."""
    uv: NDArray[np.float32] | None = None
    """Where on the triangle, two numbers a ray: the weights of its second and third vertex."""
    normal: NDArray[np.float32] | None = None
    """The triangle's unit normal, on the side from where its vertices go counter-clockwise."""
    point: NDArray[np.float64] | None = None
    """Where in space, computed from the triangle and `uv`: nearer to the surface than a point along the ray."""
    error: NDArray[np.float32] | None = None
    """A bound of how far rounding has moved `point` off the triangle."""

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Which rays have met anything."""
        if self.triangle is not None:
            return self.triangle >= 0
        if self.object is not None:
            return self.object >= 0
        if self.t is not None:
            return np.isfinite(self.t)
        raise ValueError("none of t, triangle and object was asked for, which tell of hits")


@dataclass(frozen=True, eq=False, kw_only=True)
class Crossings(Hits):
    """All that rays cross, a row each: first those of the first ray, the nearest first. What was not asked for is None."""

    splits: NDArray[np.int64]
    """Where the rows of each ray begin, and how many rows there are: ray `i` has those from `splits[i]` to before `splits[i + 1]`."""

    def __len__(self) -> int:
        return int(self.splits[-1])

    @property
    def ray(self) -> NDArray[np.int64]:
        """Whose each row is, by the ray's number in the order of their broadcast shape."""
        return np.repeat(np.arange(len(self.splits) - 1), np.diff(self.splits))


@dataclass(frozen=True, eq=False)
class Nearest:
    """Where triangles come nearest to points, in arrays of the points' shape; those that were not asked for are None."""

    distance: NDArray[np.floating] | None = None
    """How far away."""
    triangle: NDArray[np.signedinteger] | None = None
    """Which triangle of its object, by its row in `faces`; -1 if there is none at all."""
    object: NDArray[np.signedinteger] | None = None
    """Which object."""
    uv: NDArray[np.float32] | None = None
    """Where on the triangle: the weights of its second and third vertex."""
    normal: NDArray[np.float32] | None = None
    """The triangle's unit normal."""
    point: NDArray[np.float64] | None = None
    """Where in space."""
    error: NDArray[np.float32] | None = None
    """A bound of how much nearer any other triangle may be."""


NAMES = tuple(field.name for field in fields(Hits))
"""The fields' names in their order."""

NEAREST = tuple(field.name for field in fields(Nearest))
"""Those of nearest points."""

SHAPES = {"t": (), "triangle": (), "object": (), "uv": (2,), "normal": (3,), "point": (3,), "error": ()}
"""What an array has beside the rays' shape."""

TYPES = {
    "t": (np.float32, np.float64),
    "triangle": (np.int32, np.int64),
    "object": (np.int32, np.int64),
    "uv": (np.float32,),
    "normal": (np.float32,),
    "point": (np.float64,),
    "error": (np.float32,),
}
"""What an array may hold; the first is what is made."""


def names(fields: str | Iterable[str] | None, more: Iterable[str] = ()) -> list[str]:
    """The names of what is asked for, all of them if nothing is said, and more."""
    wanted = list(dict.fromkeys((*(NAMES if fields is None else _listed(fields)), *more)))
    for name in wanted:
        if name not in SHAPES:
            raise ValueError(f"a hit has no {name!r}; it has {', '.join(NAMES)}")
    return wanted


def _listed(fields: str | Iterable[str]) -> tuple[str, ...]:
    listed = (fields,) if isinstance(fields, str) else tuple(fields) if isinstance(fields, Iterable) else (None,)
    if not all(isinstance(name, str) for name in listed):
        raise TypeError(f"fields is {fields!r}; it is a name or several")
    return listed


def of_nearest(fields: str | Iterable[str] | None, out: Mapping[str, NDArray] | None):
    """Both as those of hits have them, whose `t` is the distance."""
    given, out = None if fields is None else _listed(fields), _mapping(out)
    for name in (*(given or ()), *out):
        if name not in NEAREST:
            raise ValueError(f"a nearest point has no {name!r}; it has {', '.join(NEAREST)}")
    hits = {"distance": "t"}
    if given is not None:
        given = tuple(hits.get(name, name) for name in given)
    return given, {hits.get(name, name): array for name, array in out.items()} or None


def _mapping(out) -> dict[str, NDArray]:
    if out is not None and not isinstance(out, Mapping):
        raise TypeError("out maps names of fields to arrays")
    return {} if out is None else dict(out)


def arrays(
    shape: tuple[int, ...], fields, out, inputs: Iterable[NDArray], called: Mapping[str, str] = MappingProxyType({})
) -> dict[str, NDArray]:
    """The arrays to be filled: those of `out`, none of which is one of `inputs`, and new ones for what else is asked for. `called` has other
    names of theirs, for errors."""
    out = _mapping(out)
    wanted = names(tuple(out) if fields is None and out else fields, out)
    made = {
        name: _checked(name, out[name], shape, called.get(name, name)) if name in out else np.empty(shape + SHAPES[name], TYPES[name][0])
        for name in wanted
    }
    others = list(inputs)
    for name in out:
        if any(np.may_share_memory(made[name], other) for other in others):
            raise ValueError(f"out[{called.get(name, name)!r}] shares memory with other arrays of this call; give an array of its own")
        others.append(made[name])
    return made


def _checked(name: str, array, shape: tuple[int, ...], called: str) -> NDArray:
    wanted = shape + SHAPES[name]
    if not isinstance(array, np.ndarray) or isinstance(array, np.ma.MaskedArray):
        raise TypeError(f"out[{called!r}] is no numpy array")
    if array.dtype not in TYPES[name]:
        kinds = " or ".join(np.dtype(kind).name for kind in TYPES[name])
        raise TypeError(f"out[{called!r}] holds {array.dtype}, not {kinds}")
    if array.shape != wanted:
        raise ValueError(f"out[{called!r}] has the shape {array.shape}, not {wanted}")
    if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
        raise ValueError(f"out[{called!r}] has gaps or can't be written to; give an array of its own")
    return array


def native(given: dict[str, NDArray], count: int) -> dict[str, NDArray | None]:
    """The arrays with a row a ray, as Rust takes them."""
    return {name: given[name].reshape((count, *SHAPES[name])) if name in given else None for name in NAMES}
