"""How far a question has come."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Progress = bool | Callable[[int, int], Any] | None
"""True for a bar of tqdm, or what is called with how many are done and how many there are."""


class bar:
    """What is told of progress: nothing, what the caller gave, or a bar of tqdm if that is installed."""

    def __init__(self, progress: Progress, unit: str = "rays") -> None:
        self._progress, self._unit, self._tqdm = progress, unit, None

    def __enter__(self) -> Callable[[int, int], Any] | None:
        if self._progress is None or self._progress is False:
            return None
        if callable(self._progress):
            return self._progress
        if self._progress is not True:
            raise TypeError(f"progress is {self._progress!r}; it is True, None or a function of two numbers")
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return None
        self._tqdm = tqdm(unit=f" {self._unit}", unit_scale=True)
        return self._told

    def _told(self, done: int, count: int) -> None:
        self._tqdm.total = count
        self._tqdm.update(done - self._tqdm.n)

    def __exit__(self, *_: object) -> None:
        if self._tqdm is not None:
            self._tqdm.close()
