"""Arrays as callers have them, and as Rust takes them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._device import ArrayLike, host_array

LARGEST = 1e18
"""Coordinates are below this, so that squares of them are numbers of float32."""


def floats(name: str, values: ArrayLike) -> NDArray:
    """An array of float32 or float64: itself if it is one, whatever its strides."""
    array = _numbers(name, values, "iufb")
    if array.dtype not in (np.float32, np.float64):
        array = array.astype(np.float32 if array.dtype == np.float16 else np.float64)
    return array if array.flags.aligned else array.copy()


def doubles(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """An array of float64, aligned."""
    return np.require(_numbers(name, values, "iufb"), np.float64, "A")


def _numbers(name: str, values: ArrayLike, kinds: str) -> NDArray:
    array = host_array(name, values)
    if array.dtype.kind not in kinds:
        raise TypeError(f"{name} holds {array.dtype}, not {'integers' if kinds == 'iu' else 'numbers'}")
    return array


def rows(name: str, values: ArrayLike) -> NDArray:
    """An array of float32 or float64 whose last axis has three numbers."""
    array = floats(name, values)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}; its last axis must have three numbers")
    return array


def finite_rows(name: str, values: ArrayLike) -> NDArray:
    """As `rows`, of two axes and without NaN or infinities."""
    array = rows(name, values)
    if array.ndim != 2:
        raise ValueError(f"{name} has the shape {array.shape}, not (n, 3)")
    if len(array) == 0:
        raise ValueError(f"{name} is empty; a mesh has a triangle at least")
    bad = ~np.isfinite(array).all(axis=1)
    if bad.any():
        raise ValueError(f"{name}[{int(bad.argmax())}] is not finite")
    large = (np.abs(array) > LARGEST).any(axis=1)
    if large.any():
        raise ValueError(f"{name}[{int(large.argmax())}] is beyond {LARGEST:g}; choose a larger unit")
    return array


def corners(name: str, values: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    """Rows of three numbers of vertices, all of which there are, in an array of their own."""
    given = host_array(name, values)
    if given.size == 0:
        raise ValueError(f"{name} is empty; a mesh has a triangle at least")
    array = _numbers(name, given, "iu")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}, not (n, 3)")
    least, greatest = int(array.min()), int(array.max())
    if least < 0 or greatest >= vertices:
        row = int(((array < 0) | (array >= vertices)).any(axis=1).argmax())
        raise ValueError(f"{name}[{row}] is {array[row].tolist()}, but the vertices are 0 to {vertices - 1}")
    return array.astype(np.uint32)


def of_vertices(name: str, values: ArrayLike, shape: tuple[int, int]) -> NDArray:
    """Finite rows of numbers, one a vertex, in an array of their own."""
    array = floats(name, values)
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}, not {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite")
    return array.copy()


def matrices(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Matrices of four rows and columns that move points, one or an axis of them."""
    given = doubles(name, values)
    array = given[None] if given.ndim == 2 else given
    if array.ndim != 3 or array.shape[1:] != (4, 4):
        raise ValueError(f"{name} has the shape {given.shape}, not (n, 4, 4)")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite")
    if (np.abs(array) > LARGEST).any():
        raise ValueError(f"{name} has a number beyond {LARGEST:g}; choose a larger unit")
    if not np.allclose(array[:, 3], [0, 0, 0, 1], rtol=0, atol=1e-9):
        raise ValueError(f"{name} has a last row that is not 0, 0, 0, 1")
    return array


def to_fill(out: NDArray | None, shape: tuple[int, ...], kind: type, inputs: Iterable[Any] = ()) -> NDArray:
    """The array `out` if it can be filled with a number a ray and is none of the inputs, or a new one if there is none."""
    if out is None:
        return np.empty(shape, kind)
    if not isinstance(out, np.ndarray) or out.dtype != kind:
        raise TypeError(f"out is no numpy array of {np.dtype(kind).name}")
    if out.shape != shape or not (out.flags.c_contiguous and out.flags.aligned and out.flags.writeable):
        raise ValueError(f"out has gaps, can't be written to or has not the shape {shape}")
    if any(isinstance(other, np.ndarray) and np.may_share_memory(out, other) for other in inputs):
        raise ValueError("out shares memory with other arrays of this call; give an array of its own")
    return out
