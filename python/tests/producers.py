"""Stand-ins for other libraries' arrays and for CUDA's driver, which keep what they are asked."""

import ctypes

import numpy as np

BASE = 0x7F_0000_0000
"""An address that only the stand-in for CUDA has."""


class Producer:
    """An array with DLPack alone, on a device by its number."""

    def __init__(self, array, device=2):
        self.array, self.device, self.asked = np.asarray(array), device, []

    def __dlpack_device__(self):
        return self.device, 0

    def __dlpack__(self, *, stream=None, max_version=None, dl_device=None, copy=None):
        self.asked.append((dl_device, copy))
        return (self.array.copy() if copy else self.array).__dlpack__()


class OldProducer(Producer):
    """As torch was before 2.9 and cupy before 13.4."""

    def __dlpack__(self, stream=None):
        raise AssertionError("an export of the device itself is of no use")


class Cuda:
    """CUDA's driver with memory of its own; `failing` says which functions fail by which error."""

    def __init__(self):
        self.memory, self.next, self.calls, self.stack = {}, BASE, [], []
        self.failing, self.unfinished, self.has_context = {}, {}, True

    def put(self, array):
        """Where an array's bytes, the whole of them, come to be."""
        address, self.next = self.next, self.next + (1 << 20)
        self.memory[address] = np.frombuffer(array.tobytes(), np.uint8).copy()
        return address

    def _bytes(self, address, size):
        for base, data in self.memory.items():
            if base <= address and address + size <= base + len(data):
                return data[address - base : address - base + size]
        return None

    def __getattr__(self, name):
        def call(*arguments):
            self.calls.append(name)
            return self.failing.get(name) or getattr(self, f"_{name}")(*arguments) or 0

        return call

    def _cuInit(self, flags):
        pass

    def _cuGetErrorName(self, code, name):
        name._obj.value = {1: b"CUDA_ERROR_INVALID_VALUE", 700: b"CUDA_ERROR_ILLEGAL_ADDRESS"}.get(code.value)

    def _cuPointerGetAttribute(self, into, attribute, address):
        if self._bytes(address.value, 1) is None:
            return 1
        into._obj.value = {1: 77 if self.has_context else None, 9: 0}[attribute.value]

    def _cuDeviceGet(self, into, ordinal):
        into._obj.value = 5 + ordinal.value

    def _cuDevicePrimaryCtxRetain(self, into, device):
        into._obj.value = {5: 99}[device.value]

    def _cuDevicePrimaryCtxRelease_v2(self, device):
        assert device.value == 5

    def _cuCtxPushCurrent_v2(self, context):
        self.stack.append(context.value)

    def _cuCtxPopCurrent_v2(self, into):
        into._obj.value = self.stack.pop()

    def _cuCtxSynchronize(self):
        assert self.stack
        for write in self.unfinished.values():
            write()

    def _cuStreamSynchronize(self, stream):
        assert self.stack
        self.unfinished.pop(stream.value, lambda: None)()

    def _cuMemcpyDtoH_v2(self, into, address, size):
        data = self._bytes(address.value, size.value)
        if data is None or not self.stack:
            return 1
        ctypes.memmove(into, data.ctypes.data, size.value)


class CudaArray:
    """An array with `__cuda_array_interface__` alone; what is said overrides what is so."""

    def __init__(self, cuda, array, **said):
        array = np.asarray(array)
        whole = array
        while isinstance(whole.base, np.ndarray):
            whole = whole.base
        address = cuda.put(whole) + array.__array_interface__["data"][0] - whole.__array_interface__["data"][0]
        strides = None if array.flags.c_contiguous else array.strides
        said = {"shape": array.shape, "typestr": array.dtype.str, "data": (address, True), "strides": strides, "version": 3, **said}
        self.__cuda_array_interface__ = {name: of for name, of in said.items() if of is not ...}


def line(raised):
    """What was raised says it in a line."""
    assert "\n" not in str(raised.value)
    return str(raised.value)
