"""What documents show is what happens."""

import doctest
import importlib
import re
from pathlib import Path

import numpy as np
import pytest

import eyerays

PYTHON = Path(__file__).parents[1]


@pytest.mark.parametrize("name", ["eyerays", "eyerays._scene", "eyerays._queries", "eyerays._pictures", "eyerays._hits", "eyerays.trimesh", "eyerays.open3d"])
def test_examples_of_docstrings(name):
    pytest.importorskip(name.removeprefix("eyerays.") if name in ("eyerays.trimesh", "eyerays.open3d") else "numpy")
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0
    assert "._" in name or result.attempted > 0


@pytest.mark.parametrize("page", ["README.md", "../docs/python.md"])
def test_pages_run_and_tell_what_they_say(page):
    blocks = re.findall(r"```python\n(.*?)```", (PYTHON / page).read_text(), re.DOTALL)
    assert blocks
    names = {}
    for block in blocks:
        exec(block, names)
    hits, scene = names["hits"], names["scene"]
    assert hits.t.tolist() == [2.0] and hits.triangle.tolist() == [0]
    assert hits.point.tolist() == [[0.5, -0.5, 0.0]]
    assert not scene.any([0.5, -0.5, 2.0], [0.0, 0.0, 1.0])


def test_all_that_is_public_has_a_docstring():
    public = [getattr(eyerays, name) for name in eyerays.__all__]
    members = [member for of in public if isinstance(of, type) for name, member in vars(of).items() if not name.startswith("_")]
    for of in [*public, *members]:
        assert isinstance(of, (np.ndarray, type(None))) or of.__doc__, of
