from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from numpy.typing import NDArray

class Surfaces:
    triangles: int
    objects: list[str]
    roundoff: float

    @staticmethod
    def of_meshes(
        meshes: Sequence[tuple[NDArray, NDArray, NDArray | None]], offset: Sequence[float], quality: str, threads: int
    ) -> Surfaces: ...
    @staticmethod
    def load(path: str, quality: str, threads: int) -> tuple[Surfaces, list[str]]: ...
    def closest(
        self,
        rays: tuple[NDArray, NDArray, NDArray | float],
        fields: dict[str, NDArray | None],
        device: str,
        progress: Callable[[int, int], Any] | None,
    ) -> None: ...
    def any(
        self,
        rays: tuple[NDArray, NDArray, NDArray | float],
        out: NDArray,
        device: str,
        progress: Callable[[int, int], Any] | None,
    ) -> None: ...
    def nearest(
        self,
        points: NDArray,
        fields: dict[str, NDArray | None],
        device: str,
        progress: Callable[[int, int], Any] | None,
    ) -> None: ...
    def crossings(
        self,
        rays: tuple[NDArray, NDArray, NDArray | float],
        names: list[str],
        device: str,
        progress: Callable[[int, int], Any] | None,
    ) -> tuple[dict[str, NDArray], NDArray]: ...
    def count(
        self,
        rays: tuple[NDArray, NDArray, NDArray | float],
        out: NDArray,
        device: str,
        progress: Callable[[int, int], Any] | None,
    ) -> None: ...

class Studio:
    samples: int
    device: str

    @staticmethod
    def open(wish: dict[str, Any]) -> tuple[Studio, list[str]]: ...
    def add(self, samples: int, progress: Callable[[int, int], Any] | None) -> None: ...
    def picture(self) -> NDArray[np.float32]: ...
    def hash(self) -> str: ...
    def layers(self) -> dict[str, NDArray]: ...
    def film(self) -> bytes: ...
    def merge(self, film: bytes) -> None: ...

def png(picture: NDArray[np.float32], exposure: float) -> bytes: ...
