"""Arrays of other libraries, on devices that are not there."""

import pytest
from producers import Cuda, CudaArray, Producer

from eyerays import _device


@pytest.fixture
def cuda(monkeypatch):
    driver = Cuda()
    monkeypatch.setattr(_device, "_libcuda", lambda: driver)
    return driver


@pytest.fixture(params=["DLPack of a CPU", "DLPack of a device", "CUDA"])
def kept(request, cuda):
    """Makes an array of another library of numbers."""
    if request.param == "CUDA":
        return lambda values: CudaArray(cuda, values)
    return lambda values: Producer(values, 1 if request.param == "DLPack of a CPU" else 2)
