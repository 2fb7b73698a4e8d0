"""The examples do what they say."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import eyerays
from test_crossings import CUBE, SIDES

EXAMPLES = Path(__file__).parents[1] / "examples"


def example(name):
    return runpy.run_path(str(EXAMPLES / f"{name}.py"))


def test_a_sensor_in_a_box_has_the_ranges_of_the_box():
    scene = eyerays.Scene(CUBE * 2 - 1, SIDES)
    ranges, places = example("lidar")["scan"](scene, [0.0, 0.0, 0.0], beams=9, columns=32)
    assert ranges.shape == (9, 32) and (ranges >= 1 - 1e-6).all() and (ranges <= 3**0.5 + 1e-6).all()
    assert np.abs(np.abs(places).max(axis=-1) - 1).max() < 1e-6


def test_masks_tell_things_and_the_floor_apart():
    picture, masks, depths = example("masks")["example"](3, size=(48, 36), spp=2)
    assert picture.shape == (36, 48, 3) and masks.shape == depths.shape == (36, 48)
    assert len(np.unique(masks)) > 3 and np.isinf(depths[masks == 0]).all() and np.isfinite(depths[masks > 0]).all()


def test_the_sun_is_where_almanacs_have_it_and_a_wall_throws_its_shadow():
    trimesh = pytest.importorskip("trimesh")
    of = example("sun")
    # Over the tropic of Cancer at noon of the solstice; at the horizon at 6 on the equator in spring.
    assert of["sun"](23.45, 172, np.array([12.0]))[0, 2] > 0.9999
    assert np.abs(of["sun"](0.0, 81, np.array([6.0]))[0] - [1, 0, 0]).max() < 0.01
    floor = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    alone = of["exposure"](floor, 0.0, 81)
    # A wall in the east as high as the day is long: the sun comes at noon.
    wall = trimesh.Trimesh([[1.2, -900, -1], [1.2, 900, -1], [1.2, 0, 900]], [[0, 1, 2]])
    behind = of["exposure"](trimesh.util.concatenate([floor, wall]), 0.0, 81)[:2]
    assert np.abs(alone - 12).max() <= 0.25 and np.abs(behind - 6).max() <= 0.5


def test_vertices_of_a_ball_see_the_sky_and_those_of_a_hollow_one_none():
    trimesh = pytest.importorskip("trimesh")
    seen = example("occlusion")["occlusion"](trimesh.creation.icosphere(2), 64)
    assert seen.min() > 0.97
    turned = trimesh.creation.icosphere(2)
    turned.invert()
    assert example("occlusion")["occlusion"](turned, 64).max() < 0.03
