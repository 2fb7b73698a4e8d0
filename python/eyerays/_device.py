"""Arrays of other libraries, which may lie on a device, as numpy has them."""

from __future__ import annotations

import ctypes
import functools
import itertools
import operator
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple, Protocol, Union

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

CPU = (1, 0)
"""DLPack's kDLCPU and its only device."""

HOST = (1, 3, 11)
"""Whose memory numpy reads: kDLCPU, kDLCUDAHost and kDLROCMHost. kDLCUDAManaged is left out: a kernel may still be writing there."""

CONTEXT, DEVICE_ORDINAL = 1, 9
"""CU_POINTER_ATTRIBUTE_..."""

INVALID_VALUE = 1
"""CUDA_ERROR_..."""


class SupportsDLPack(Protocol):
    """Arrays of torch, cupy, jax and others."""

    def __dlpack__(self, *args: Any, **kwargs: Any) -> Any: ...
    def __dlpack_device__(self) -> tuple[Any, int]: ...


class SupportsCudaArrayInterface(Protocol):
    """Arrays of numba, pycuda and others."""

    @property
    def __cuda_array_interface__(self) -> Mapping[str, Any]: ...


ArrayLike = Union[npt.ArrayLike, SupportsDLPack, SupportsCudaArrayInterface]
"""What is taken for an array."""


def host_array(name: str, values: ArrayLike) -> NDArray:
    """The values in memory that numpy reads: not copied if they are there already, else copied once.

    TypeError if they say no array, have a mask or give no copy. A `__cuda_array_interface__` that claims what CUDA has not is a ValueError, and what
    CUDA's driver can't do a RuntimeError.
    """
    if isinstance(values, np.ndarray):
        if isinstance(values, np.ma.MaskedArray):
            raise TypeError(_masked(name))
        return np.asarray(values)
    if hasattr(values, "__dlpack__"):
        return _of_dlpack(name, values)
    interface = _interface(name, values)
    if interface is not None:
        return _of_cuda(name, interface)
    try:
        return np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name} is no array: {_line(error)}") from None


def _masked(name: str) -> str:
    return f"{name} is a masked array, whose mask nothing here asks; give what is not masked"


class _HostCopy:
    """What a producer copies to the host by the array API of 2023.12, for a numpy of any age: before 2.1 it could not ask for that."""

    def __init__(self, values: SupportsDLPack) -> None:
        self._values = values

    def __dlpack__(self, **_: Any) -> Any:
        return self._values.__dlpack__(dl_device=CPU, copy=True)

    def __dlpack_device__(self) -> tuple[int, int]:
        return CPU


def _of_dlpack(name: str, values: Any) -> NDArray:
    if getattr(values, "requires_grad", False):
        raise TypeError(f"{name} requires grad, which ends here; give {name}.detach()")
    on_host = False
    refusal: Exception | None = None
    # Producers refuse by errors of all types.
    try:
        kind = values.__dlpack_device__()[0]
        # An int by the standard, but a plain Enum in Open3D.
        on_host = getattr(kind, "value", kind) in HOST
        if not on_host:
            return np.from_dlpack(_HostCopy(values))
        # Torch's DLPack loses the sign of a tensor that is negated lazily; its `__array__` doesn't.
        if not hasattr(values, "__array__"):
            return np.from_dlpack(values)
    except MemoryError:
        raise
    except Exception as error:
        refusal = error
    interface = None if on_host else _interface(name, values)
    # Nor does this have that sign.
    if interface is not None and not (hasattr(values, "is_neg") and values.is_neg()):
        return _of_cuda(name, interface)
    if hasattr(values, "__array__"):
        try:
            return np.asarray(values)
        except MemoryError:
            raise
        except Exception as error:
            refusal = error
    if on_host:
        raise TypeError(f"{name} is no array that numpy reads: {_line(refusal)}") from refusal
    raise TypeError(
        f"{name} is on a device and gives no copy of itself ({_line(refusal)}); copy it to the host, by {name}.cpu() or {name}.get()"
    ) from refusal


def _interface(name: str, values: Any) -> Mapping[str, Any] | None:
    try:
        return getattr(values, "__cuda_array_interface__", None)
    except Exception as error:
        raise TypeError(f"{name} does not tell its __cuda_array_interface__: {_line(error)}") from error


def _line(error: Any) -> str:
    return next(iter(str(error).splitlines()), "") or type(error).__name__


class _Claim(NamedTuple):
    """What a `__cuda_array_interface__` says; `is_ordered` if it says of streams, which the first two versions don't."""

    shape: tuple[int, ...]
    strides: tuple[int, ...]
    dtype: np.dtype
    address: int
    stream: int | None
    is_ordered: bool

    @property
    def span(self) -> tuple[int, int]:
        """The first address of any element, and the one behind the last: strides may be negative."""
        ways = [stride * (count - 1) for stride, count in zip(self.strides, self.shape)]
        first = self.address + sum(way for way in ways if way < 0)
        return first, self.address + sum(way for way in ways if way > 0) + self.dtype.itemsize


def _claim(name: str, interface: Mapping[str, Any]) -> _Claim:
    try:
        typestr, strides, stream = interface["typestr"], interface.get("strides"), interface.get("stream")
        if not isinstance(typestr, str):
            raise TypeError(f"the typestr {typestr!r} is no string")
        dtype = np.dtype(typestr)
        shape = tuple(map(operator.index, interface["shape"]))
        address = operator.index(interface["data"][0] or 0)
        strides = None if strides is None else tuple(map(operator.index, strides))
        stream = None if stream is None else operator.index(stream)
    except Exception as error:
        reason = f"{error} is missing" if isinstance(error, KeyError) else _line(error)
        raise TypeError(f"{name} has a __cuda_array_interface__ that says no array: {reason}") from error
    if interface.get("mask") is not None:
        raise TypeError(_masked(name))
    # What is no number is never read: of objects, it would be addresses of Python's.
    if dtype.kind not in "iufb":
        raise TypeError(f"{name} holds {dtype}, not numbers")
    if strides is None:
        steps = itertools.accumulate(shape[:0:-1], operator.mul, initial=dtype.itemsize)
        strides = tuple(steps)[::-1][: len(shape)]
    if len(strides) != len(shape) or min(shape, default=0) < 0:
        raise ValueError(f"{name} has the shape {shape} and the strides {strides}, which do not go together")
    if stream is not None and not 0 < stream < 1 << 64:
        raise ValueError(f"{name} has the stream {stream}; it is 1 for the default stream, 2 for that of each thread, or a CUstream")
    return _Claim(shape, strides, dtype, address, stream, "stream" in interface)


def _of_cuda(name: str, interface: Mapping[str, Any]) -> NDArray:
    """A copy on the host, made when its stream has come to its end. A CUstream can't be checked: it must be one."""
    claim = _claim(name, interface)
    try:
        if 0 in claim.shape:
            return np.empty(claim.shape, claim.dtype)
        first, end = claim.span
        if not 0 < first < end < 1 << 64:
            raise ValueError("there are no such addresses")
        data = _Driver(name).copy(first, end - first, claim)
        return np.ndarray(claim.shape, claim.dtype, data, claim.address - first, claim.strides)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{name} has the shape {claim.shape} and the strides {claim.strides}, but {_line(error)}") from error


@functools.cache
def _libcuda() -> Any:
    return ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")


class _Driver:
    """CUDA's driver, asked for the argument `name`."""

    def __init__(self, name: str) -> None:
        self._name = name
        try:
            self._library = _libcuda()
        except OSError as error:
            raise RuntimeError(f"{name} is on a CUDA device, but CUDA's driver can't be loaded ({_line(error)}); copy it to the host") from error
        self._do("cuInit", ctypes.c_uint(0))

    def _do(self, function: str, *arguments: Any) -> None:
        code = getattr(self._library, function)(*arguments)
        if code:
            error = ctypes.c_char_p()
            self._library.cuGetErrorName(ctypes.c_int(code), ctypes.byref(error))
            said = error.value.decode() if error.value else f"error {code}"
            raise RuntimeError(f"{self._name} can't be copied from its CUDA device: {function} says {said}")

    def copy(self, first: int, size: int, claim: _Claim) -> NDArray[np.uint8]:
        """The bytes from the address `first` on."""
        # Both ends are asked for before memory is taken, since the size may be anything.
        if self._ordinal(first) != self._ordinal(first + size - 1):
            raise ValueError("that ends on another device than it begins")
        data = np.empty(size, np.uint8)
        with self._context(first):
            if claim.stream is not None:
                self._do("cuStreamSynchronize", ctypes.c_void_p(claim.stream))
            elif not claim.is_ordered:
                self._do("cuCtxSynchronize")
            self._do("cuMemcpyDtoH_v2", ctypes.c_void_p(data.ctypes.data), ctypes.c_uint64(first), ctypes.c_size_t(size))
        return data

    def _ordinal(self, address: int) -> int:
        """Which device an address is on."""
        ordinal = ctypes.c_int()
        asked = ctypes.byref(ordinal), ctypes.c_int(DEVICE_ORDINAL), ctypes.c_uint64(address)
        if self._library.cuPointerGetAttribute(*asked) == INVALID_VALUE:
            raise ValueError(f"no CUDA device has the address {address:#x}")
        self._do("cuPointerGetAttribute", *asked)
        return ordinal.value

    @contextmanager
    def _context(self, address: int) -> Iterator[None]:
        """Makes the context current in which an address was allocated; of pools, which have none, the device's primary context."""
        context, device = ctypes.c_void_p(), ctypes.c_int()
        self._do("cuPointerGetAttribute", ctypes.byref(context), ctypes.c_int(CONTEXT), ctypes.c_uint64(address))
        is_retained = not context.value
        if is_retained:
            self._do("cuDeviceGet", ctypes.byref(device), ctypes.c_int(self._ordinal(address)))
            self._do("cuDevicePrimaryCtxRetain", ctypes.byref(context), device)
        try:
            self._do("cuCtxPushCurrent_v2", context)
            try:
                yield
            finally:
                self._do("cuCtxPopCurrent_v2", ctypes.byref(ctypes.c_void_p()))
        finally:
            if is_retained:
                self._do("cuDevicePrimaryCtxRelease_v2", device)
