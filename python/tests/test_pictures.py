"""Pictures of scenes in code and of files."""

import pickle
import threading
from pathlib import Path

import numpy as np
import pytest

import eyerays
from test_crossings import CUBE, SIDES
from test_scene import HALVES, SQUARE, icosphere

SCENES = Path(__file__).parents[2] / "scenes"
CAMERA = {"eye": [0, 0, 5], "target": [0, 0, 0], "fov": 40}


def furnace(albedo):
    """A ball in light from everywhere."""
    vertices, faces = icosphere(3)
    scene = eyerays.Scene()
    scene.add_material("matt", diffuse=[albedo] * 3)
    scene.add_mesh(vertices, faces, material="matt", smooth=True)
    scene.background = {"color": [0.5, 0.5, 0.5]}
    return scene


def test_a_matt_ball_in_a_furnace_sends_on_its_share():
    for albedo in (0.2, 0.8):
        picture = eyerays.render(furnace(albedo), CAMERA, size=(32, 24), spp=64, bounces=4, device="cpu")
        assert picture.shape == (24, 32, 3) and picture.dtype == np.float32
        assert np.abs(picture[10:14, 14:18] - 0.5 * albedo).max() < 2e-3
        assert np.abs(picture[0, 0] - 0.5).max() < 1e-6


def test_samples_may_be_added_one_after_the_other():
    scene = furnace(0.5)
    whole = eyerays.Session(scene, CAMERA, size=(16, 12), device="cpu").add(9)
    parts = eyerays.Session(scene, CAMERA, size=(16, 12), device="cpu").add(4).add(5)
    assert whole.samples == parts.samples == 9
    assert whole.hash == parts.hash and np.array_equal(whole.picture, parts.picture)
    assert whole.hash != eyerays.Session(scene, CAMERA, size=(16, 12), device="cpu", seed=1).add(9).hash
    # A film is gone on with elsewhere.
    other = eyerays.Session(scene, CAMERA, size=(16, 12), device="cpu").merge(
        eyerays.Session(scene, CAMERA, size=(16, 12), device="cpu").add(4).film
    )
    assert other.samples == 4 and other.add(5).hash == whole.hash
    with pytest.raises(ValueError):
        eyerays.Session(scene, CAMERA, size=(17, 12), device="cpu").merge(whole.film)
    with pytest.raises(ValueError):
        whole.merge(b"no film")
    assert whole.hash == parts.hash


@pytest.mark.parametrize(("name", "scene", "settings"), [
    ("glass.png", "glass.toml", {"samples": 3}),
    ("occlusion.png", "occlusion.toml", {"size": (360, 270), "spp": 64}),
])
def test_a_picture_of_a_file_has_the_bits_that_the_program_prints(name, scene, settings):
    printed = (SCENES.parent / "docs" / "pictures.toml").read_text().split(f'["{name}"]')[1]
    session = eyerays.Session(SCENES / scene, device="cpu", **settings)
    session.add(settings.get("spp") or settings["samples"] ** 2)
    assert session.hash == printed.split('film_hash = "')[1].split('"')[0]
    assert "CPU" in session.device


def test_layers_come_by_their_names():
    layers = ("depth", "normal", "object", "albedo", "direct", "indirect", "samples")
    told = eyerays.render(furnace(0.5), CAMERA, size=(32, 24), spp=4, layers=layers, device="cpu")
    assert list(told) == ["colour", *layers]
    depth, normal = told["depth"], told["normal"]
    assert depth.shape == (24, 32) and np.isinf(depth[0, 0]) and abs(depth[12, 16] - 4) < 0.02
    assert np.abs(normal[12, 16] - [0, 0, 1]).max() < 0.1
    assert set(np.unique(told["object"])) == {0, 1} and (told["samples"] == 4).all()
    assert np.allclose(told["direct"] + told["indirect"], told["colour"], atol=1e-5)
    with pytest.raises(ValueError, match="deepth"):
        eyerays.render(furnace(0.5), CAMERA, layers="deepth")


def test_scenes_in_code_have_materials_lights_copies_and_what_moves():
    scene = eyerays.Scene()
    scene.add_material("red", diffuse=[0.8, 0.1, 0.1])
    places = np.tile(np.eye(4), (2, 1, 1))
    places[:, 0, 3] = [-1.5, 1.5]
    scene.add_instances(CUBE - 0.5, SIDES, places, material="red")
    scene.add_mesh(SQUARE * 9 - [0, 0, 2], HALVES, uv=SQUARE[:, :2], key=[{"time": 0.0}, {"time": 1.0, "translate": [0, 0, -40]}])
    scene.add_light("point", position=[0, 0, 8], intensity=200.0)
    scene.background = {"color": [0, 0, 0]}
    told = eyerays.render(scene, CAMERA, size=(48, 24), spp=4, device="cpu", bounces=1, layers="depth")
    picture, depth = told["colour"], told["depth"]
    assert picture[12, 13, 0] > 4 * picture[12, 13, 1] > 0, "a red cube on the left"
    assert picture[12, 34, 0] > 4 * picture[12, 34, 1] > 0, "and on the right"
    assert abs(depth[12, 24] - 7) < 1e-3
    later = eyerays.render(scene, CAMERA, size=(48, 24), spp=4, time=1.0, device="cpu", layers="depth")["depth"]
    assert abs(later[12, 24] - 47) < 1e-2
    assert scene.closest([0, 0, 5], [0, 0, -1]).t == 7
    assert pickle.loads(pickle.dumps(scene))._materials == {"red": {"diffuse": [0.8, 0.1, 0.1]}}


def test_a_picture_shows_itself_and_is_saved(tmp_path):
    picture = eyerays.render(furnace(0.5), CAMERA, size=(8, 6), spp=1, device="cpu")
    data = picture._repr_png_()
    assert data.startswith(b"\x89PNG") and picture[..., 0]._repr_png_() is None
    picture.save(tmp_path / "p.png")
    assert (tmp_path / "p.png").read_bytes() == data and len(list(tmp_path.iterdir())) == 1
    clear = eyerays.render(furnace(0.5), CAMERA, size=(8, 6), spp=1, transparent=True, device="cpu")
    assert clear.shape == (6, 8, 4) and clear[0, 0, 3] == 0 and clear[3, 4, 3] == 1
    assert clear._repr_png_().startswith(b"\x89PNG")
    session = eyerays.Session(furnace(0.5), CAMERA, size=(8, 6), device="cpu")
    assert session._repr_png_() is None and session.add(1)._repr_png_() == data


def test_progress_is_told_and_may_end_a_picture():
    session = eyerays.Session(furnace(0.5), CAMERA, size=(64, 48), device="cpu")
    heard = []
    session.add(8, progress=lambda done, of: heard.append((done, of)))
    assert heard and heard[-1] == (8, 8) and session.samples == 8

    def ends(done, of):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        session.add(1 << 20, progress=ends)
    assert 8 <= session.samples < 1 << 20
    before = session.hash
    assert session.add(1).hash != before


def test_threads_share_a_session():
    session = eyerays.Session(furnace(0.5), CAMERA, size=(16, 12), device="cpu")
    threads = [threading.Thread(target=session.add, args=(3,)) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert session.samples == 12 and session.hash == eyerays.Session(furnace(0.5), CAMERA, size=(16, 12), device="cpu").add(12).hash


def test_what_makes_no_sense_is_refused_in_a_line():
    scene = furnace(0.5)
    for wrong, message in (
        ({"bouncs": 3}, "bouncs"),
        ({"spp": 0}, "spp"),
        ({"integrator": "pth"}, "pth"),
        ({"size": (0, 4)}, "size"),
        ({"camera": "front"}, "front"),
        ({"camera": {"eye": [0, 0, 0], "target": [0, 0, 0]}}, "target"),
        ({"device": "tpu"}, "tpu"),
        ({"precision": "double"}, "double"),
    ):
        with pytest.raises(ValueError, match=message):
            eyerays.render(scene, **wrong)
    with pytest.raises(FileNotFoundError, match="nowhere.toml"):
        eyerays.render("nowhere.toml")
    with pytest.raises(ValueError, match="there is no sample"):
        eyerays.Session(scene, CAMERA, device="cpu").picture
    with pytest.raises(ValueError, match="grid"):
        eyerays.render(scene, CAMERA, sampler="regular", spp=5)
    with pytest.raises(ValueError, match="empty"):
        eyerays.render(eyerays.Scene())
    with pytest.raises(TypeError, match="translate"):
        scene.add_mesh(SQUARE, HALVES, translate=[1, 0, 0])
    with pytest.raises(ValueError, match="uv has the shape"):
        scene.add_mesh(SQUARE, HALVES, uv=np.zeros((3, 2)))
    wrong = eyerays.Scene(SQUARE, HALVES)
    wrong.add_material("red", diffus=[1, 0, 0])
    with pytest.raises(ValueError, match="diffus"):
        eyerays.render(wrong)
