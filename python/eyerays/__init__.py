"""Exact ray queries and pictures on GPU and CPU, with the same bits.

>>> import eyerays, numpy as np
>>> corners = np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]], np.float32)
>>> scene = eyerays.Scene(corners, [[0, 1, 2]])
>>> hits = scene.closest([[0.0, 0.0, 2.0]], [[0.0, 0.0, -1.0]])
>>> float(hits.t[0]), int(hits.triangle[0])
(2.0, 0)
"""

from ._hits import Crossings, Hits, Nearest
from ._pictures import Picture, Session, render
from ._scene import Scene, load

__all__ = ["Crossings", "Hits", "Nearest", "Picture", "Scene", "Session", "load", "render"]
