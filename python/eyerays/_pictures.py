"""Pictures of scenes."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import _files
from ._native import Studio, png
from ._progress import Progress, bar
from ._scene import Scene


class Picture(np.ndarray):
    """Linear light, float32 (height, width, 3), or 4 where the surroundings are left out. It shows itself in a notebook."""

    def png(self, exposure: float = 0.0) -> bytes:
        """The bytes of a PNG file, so many stops brighter."""
        return png(np.asarray(self, np.float32), exposure)

    def save(self, path: str | os.PathLike[str], exposure: float = 0.0) -> None:
        """Writes a PNG file. What is beyond a screen's white is lost there: `numpy.save` keeps the light."""
        data = self.png(exposure)
        target = os.fsdecode(path)
        with tempfile.NamedTemporaryFile(dir=os.path.dirname(target) or ".", delete=False) as file:
            try:
                file.write(data)
            except BaseException:
                os.unlink(file.name)
                raise
        os.replace(file.name, target)

    def _repr_png_(self) -> bytes | None:
        return self.png() if self.ndim == 3 and self.shape[-1] in (3, 4) else None


class Session:
    """A picture that grows by samples: those of one session, those of others, on any device, and all at once have the same bits.

    `scene` is a `Scene`, or the path of a scene file. `camera` is the name of one of its cameras, or a table of one (`eye`, `target`,
    `fov` and whatever else a scene file says of cameras); else it is the first. `size` is (width, height). `layers` names what is told
    beside the light: "depth", "normal", "albedo", "object" and others of `eyerays render --help`. `time` is the moment of what moves, in
    seconds. `device` is "auto", "cpu" or "gpu". All else is said as in `[render]` of scene files: `integrator`, `bounces`, `sampler`, `seed`,
    `transparent`, `caustics`, `spectral`. Of a scene in code it is "path" and "sobol"; a file says its own.
    """

    def __init__(
        self,
        scene: Scene | str | os.PathLike[str],
        camera: str | Mapping[str, Any] | None = None,
        *,
        size: tuple[int, int] | None = None,
        layers: Iterable[str] = (),
        time: float | None = None,
        device: str = "auto",
        precision: str = "exact",
        threads: int = 0,
        **settings: Any,
    ) -> None:
        over: dict[str, Any] = {"render": {"size": size, **settings}}
        if isinstance(camera, Mapping):
            over["camera"] = [{"name": "camera", **camera}]
            camera = None
        self._layers = [layers] if isinstance(layers, str) else list(layers)
        wish = {
            "over": _files.toml(over),
            "camera": camera,
            "seconds": time,
            "layers": self._layers,
            "device": str(device),
            "precision": str(precision),
            "threads": threads,
        }
        if isinstance(scene, Scene):
            self._studio, said = scene._drawn(wish)
        else:
            self._studio, said = Studio.open({"path": os.fspath(scene), "text": None, **wish})
        for warning in said:
            warnings.warn(warning, stacklevel=2)

    def add(self, samples: int, *, progress: Progress = None) -> Session:
        """Adds so many samples to every pixel. What ctrl-c ends has those that are done."""
        with bar(progress, "samples") as told:
            self._studio.add(samples, told)
        return self

    @property
    def samples(self) -> int:
        """How many samples every pixel has."""
        return self._studio.samples

    @property
    def device(self) -> str:
        """What renders."""
        return self._studio.device

    @property
    def picture(self) -> Picture:
        """The picture so far."""
        return self._studio.picture().view(Picture)

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """The picture, called "colour", and its layers, by their names."""
        return {"colour": self.picture, **self._studio.layers()}

    @property
    def film(self) -> bytes:
        """The film as a file of the program has it (`.film`): another session, or the program, goes on with it."""
        return self._studio.film()

    @property
    def hash(self) -> str:
        """The hash of the picture's bits, as `eyerays render --json` prints it."""
        return self._studio.hash()

    def merge(self, film: bytes) -> Session:
        """Takes the samples of a film of the same picture, none of which it has itself."""
        self._studio.merge(film)
        return self

    def _repr_png_(self) -> bytes | None:
        return self.picture._repr_png_() if self.samples else None


def render(
    scene: Scene | str | os.PathLike[str],
    camera: str | Mapping[str, Any] | None = None,
    *,
    spp: int = 64,
    layers: Iterable[str] = (),
    progress: Progress = None,
    **settings: Any,
) -> Picture | dict[str, np.ndarray]:
    """A picture with so many samples a pixel; with `layers`, it and these by their names. Arguments are those of `Session`."""
    layers = [layers] if isinstance(layers, str) else list(layers)
    session = Session(scene, camera, spp=spp, layers=layers, **settings).add(spp, progress=progress)
    return session.layers if layers else session.picture
