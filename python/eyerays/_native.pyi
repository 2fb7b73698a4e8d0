from collections.abc import Callable, Sequence
from typing import Any

from numpy.typing import NDArray

class Surfaces:
    triangles: int
    objects: list[str]

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
