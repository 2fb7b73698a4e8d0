"""Arrays that tell where they are on a CUDA device."""

import numpy as np
import pytest
from producers import Cuda, CudaArray, line
from test_scene import HALVES, SQUARE

import eyerays
from eyerays import _device
from eyerays._device import host_array

WHOLE = np.arange(60.0, dtype=np.float32).reshape(5, 4, 3)


@pytest.mark.parametrize(
    "array",
    [
        WHOLE,
        WHOLE[1:, ::2],
        WHOLE[::-1, :, 1:],
        WHOLE[3:1:-1, ::-2, ::-1],
        WHOLE.T,
        WHOLE[2, 1, 1:2],
        WHOLE[2, 1, 1, None, None],
        np.broadcast_to(WHOLE[0, 0], (7, 3)),
        np.array(2.5),
        WHOLE.astype(">f8"),
        WHOLE.astype(np.float16),
        WHOLE.astype(np.uint8),
        WHOLE > 7,
        np.zeros(9, np.dtype([("a", "i1"), ("b", "<f4")]))["b"],
        np.zeros((0, 3)),
    ],
)
def test_cuda_has_the_array_with_its_strides(cuda, array):
    copy = host_array("a", CudaArray(cuda, array))
    assert copy.shape == array.shape and copy.dtype == array.dtype and copy.tobytes() == array.tobytes()
    assert cuda.stack == [] and cuda.calls.count("cuMemcpyDtoH_v2") == (array.size > 0)


def test_nothing_is_asked_of_cuda_for_an_empty_array(cuda):
    assert host_array("a", CudaArray(cuda, np.zeros((0, 3), int), data=(0, False))).shape == (0, 3)
    assert host_array("a", CudaArray(cuda, np.zeros((0, 3), int), data=(None, False))).dtype == int
    assert cuda.calls == []


@pytest.mark.parametrize(
    ("said", "asked"),
    [
        ({"stream": 1}, "cuStreamSynchronize"),
        ({"stream": 0x5555}, "cuStreamSynchronize"),
        ({"stream": None}, None),
        ({"version": 2}, "cuCtxSynchronize"),
        ({"version": 2, "strides": ...}, "cuCtxSynchronize"),
    ],
)
def test_a_copy_is_made_when_what_writes_it_is_done(cuda, said, asked):
    array = CudaArray(cuda, np.zeros(3), **said)
    data = cuda.memory[array.__cuda_array_interface__["data"][0]].view(float)
    cuda.unfinished[said.get("stream")] = lambda: data.fill(7.0)
    assert host_array("a", array).tolist() == [7.0 if asked else 0.0] * 3
    assert [name for name in cuda.calls if name.endswith("Synchronize")] == ([asked] if asked else [])
    cuda.calls.remove("cuMemcpyDtoH_v2")
    assert not any("Memcpy" in name or "Primary" in name for name in cuda.calls)


def test_memory_of_pools_is_copied_in_its_devices_context(cuda):
    cuda.has_context = False
    assert host_array("a", CudaArray(cuda, SQUARE)).tolist() == SQUARE.tolist()
    names = ["cuDevicePrimaryCtxRetain", "cuCtxPushCurrent_v2", "cuMemcpyDtoH_v2", "cuCtxPopCurrent_v2", "cuDevicePrimaryCtxRelease_v2"]
    assert [name for name in cuda.calls if name in names] == names


@pytest.mark.parametrize(
    ("error", "said", "claimed"),
    [
        (TypeError, "points is a masked array", {"mask": object()}),
        (TypeError, "points holds object, not numbers", {"typestr": "|O"}),
        (TypeError, "points holds complex64, not numbers", {"typestr": "<c8"}),
        (TypeError, "points holds", {"typestr": "<f4,<f4"}),
        (TypeError, "points holds", {"typestr": "<M8[s]"}),
        (TypeError, "says no array", {"typestr": "float of some kind"}),
        (TypeError, "the typestr None is no string", {"typestr": None}),
        (TypeError, "'typestr' is missing", {"typestr": ...}),
        (TypeError, "'shape' is missing", {"shape": ...}),
        (TypeError, "'data' is missing", {"data": ...}),
        (TypeError, "says no array", {"data": None}),
        (TypeError, "says no array", {"data": ()}),
        (TypeError, "says no array", {"data": ("here", False)}),
        (TypeError, "says no array", {"shape": (2.5, 3)}),
        (TypeError, "says no array", {"shape": 12}),
        (TypeError, "says no array", {"strides": 4}),
        (TypeError, "says no array", {"stream": "default"}),
        (ValueError, "the stream 0", {"stream": 0}),
        (ValueError, "the stream -1", {"stream": -1}),
        (ValueError, "the stream", {"stream": 1 << 64}),
        (ValueError, "do not go together", {"strides": (4,)}),
        (ValueError, "do not go together", {"shape": (-4, 3)}),
        (ValueError, "no CUDA device has the address", {"shape": (5, 3)}),
        (ValueError, "no CUDA device has the address", {"shape": (10**18,)}),
        (ValueError, "array is too big", {"shape": (10**18, 3), "strides": (0, 8)}),
        (ValueError, "no CUDA device has the address", {"strides": (-12, 4)}),
        (ValueError, "no CUDA device has the address", {"data": (0x1234, False)}),
        (ValueError, "there are no such addresses", {"shape": (10**30, 3)}),
        (ValueError, "there are no such addresses", {"strides": (-(10**18), 4)}),
        (ValueError, "there are no such addresses", {"data": (0, False)}),
        (ValueError, "there are no such addresses", {"data": (-8, False)}),
        (ValueError, "there are no such addresses", {"data": ((1 << 64) - 8, False)}),
        (ValueError, "points has the shape", {"shape": (0, 10**30)}),
        (ValueError, "points has the shape", {"shape": (10**19, 3), "strides": (0, 4)}),
        (ValueError, "points has the shape", {"shape": (1,) * 100}),
    ],
)
def test_what_cuda_has_not_is_refused_in_a_line(cuda, error, said, claimed):
    scene = eyerays.Scene(SQUARE, HALVES)
    with pytest.raises(error) as raised:
        scene.contains(CudaArray(cuda, SQUARE, **claimed))
    assert said in line(raised) and cuda.stack == []


@pytest.mark.parametrize(
    "function",
    [
        *("cuInit", "cuPointerGetAttribute", "cuDeviceGet", "cuDevicePrimaryCtxRetain", "cuCtxPushCurrent_v2", "cuStreamSynchronize"),
        *("cuMemcpyDtoH_v2", "cuCtxPopCurrent_v2", "cuDevicePrimaryCtxRelease_v2"),
    ],
)
@pytest.mark.parametrize(("code", "name"), [(700, "CUDA_ERROR_ILLEGAL_ADDRESS"), (12345, "error 12345")])
def test_what_fails_is_told_in_a_line(cuda, function, code, name):
    cuda.has_context, cuda.failing = False, {function: code}
    with pytest.raises(RuntimeError) as raised:
        host_array("vertices", CudaArray(cuda, SQUARE, stream=1))
    assert line(raised) == f"vertices can't be copied from its CUDA device: {function} says {name}"
    assert len(cuda.stack) == (function == "cuCtxPopCurrent_v2")
    assert cuda.calls.count("cuDevicePrimaryCtxRelease_v2") == (cuda.calls.count("cuDevicePrimaryCtxRetain") and function != "cuDevicePrimaryCtxRetain")


def test_no_driver_is_told_in_a_line(monkeypatch):
    def missing(name):
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(_device.ctypes, "CDLL", missing)
    _device._libcuda.cache_clear()
    with pytest.raises(RuntimeError) as raised:
        eyerays.Scene(CudaArray(Cuda(), SQUARE), HALVES)
    assert line(raised).startswith("vertices is on a CUDA device, but CUDA's driver can't be loaded") and "copy it to the host" in line(raised)


def test_an_interface_that_fails_is_told_in_a_line():
    class Broken:
        @property
        def __cuda_array_interface__(self):
            raise RuntimeError("one line\nand another")

    with pytest.raises(TypeError) as raised:
        host_array("faces", Broken())
    assert line(raised) == "faces does not tell its __cuda_array_interface__: one line"
