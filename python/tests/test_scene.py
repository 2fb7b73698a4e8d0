"""Rays through scenes of a known shape."""

import copy
import os
import pickle
import signal
import sys
import threading
import time

import numpy as np
import pytest

import eyerays

SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
UP = np.array([0.0, 0.0, 1.0])


def icosphere(level):
    """A closed mesh around zero, of 20 * 4**level triangles."""
    g = (1 + 5**0.5) / 2
    vertices = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g]]
    vertices += [[0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8]]
    faces += [[3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]
    vertices, faces = np.array(vertices, np.float64), np.array(faces)
    for _ in range(level):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        middle = len(vertices) + index.reshape(-1, 3)
        vertices = np.concatenate([vertices, vertices[unique].mean(axis=1)])
        (a, b, c), (ab, bc, ca) = faces.T, middle.T
        faces = np.concatenate([np.stack(t, axis=1) for t in [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]])
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def intersect(vertices, faces, origin, direction):
    """The closest hit by double precision and every triangle: t, triangle, weights."""
    a, b, c = (vertices[faces[:, i]].astype(np.float64) for i in range(3))
    e, f, p = b - a, c - a, np.cross(direction, c - a)
    over = 1 / np.einsum("ij,ij->i", e, p)
    s = origin - a
    u = np.einsum("ij,ij->i", s, p) * over
    q = np.cross(s, e)
    v, t = q @ direction * over, np.einsum("ij,ij->i", f, q) * over
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), t, np.inf)
    i = int(t.argmin())
    return (t[i], i, (u[i], v[i])) if np.isfinite(t[i]) else None


def test_a_square_is_met_where_it_is():
    scene = eyerays.Scene(SQUARE, HALVES)
    hits = scene.closest([[0.5, -0.5, 2.0], [-0.5, 0.5, -4.0], [3.0, 0.0, 1.0]], [-2 * UP, UP, -UP])
    assert hits.t.tolist() == [1.0, 4.0, np.inf]
    assert hits.triangle.tolist() == [0, 1, -1] and hits.object.tolist() == [0, 0, -1]
    assert hits.uv[:2].tolist() == [[0.5, 0.25], [0.25, 0.5]]
    assert hits.point[:2].tolist() == [[0.5, -0.5, 0.0], [-0.5, 0.5, 0.0]]
    assert hits.normal[:2].tolist() == [[0, 0, 1]] * 2
    assert (hits.error[:2] > 0).all() and (hits.error[:2] < 1e-4).all()
    assert np.isnan([*hits.uv[2], *hits.normal[2], *hits.point[2], hits.error[2]]).all()
    assert hits.hit.tolist() == [True, True, False]
    assert scene.any([[0.5, -0.5, 2.0], [3.0, 0.0, 1.0]], -UP).tolist() == [True, False]


@pytest.mark.parametrize("shift", [0.0, 1e3, 1e6])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_hits_are_those_of_double_precision_and_every_triangle(kind, shift):
    vertices, faces = icosphere(2)
    vertices = (vertices * [1.0, 0.7, 1.3] + [shift, -shift, shift]).astype(kind)
    scene = eyerays.Scene(vertices, faces)
    random = np.random.default_rng(7)
    origins = vertices.mean(axis=0) + random.uniform(-2, 2, (400, 3))
    directions = random.normal(size=(400, 3))
    hits = scene.closest(origins, directions)
    # What is rounded of 1e6 in single precision is a sixteenth.
    blur = 3e-6 if kind == np.float64 or shift == 0 else 1e-6 * max(shift, 1)
    for i in range(400):
        expected = intersect(vertices, faces, origins[i], directions[i])
        if expected is None:
            # A ray that passes close by.
            if hits.hit[i]:
                assert np.abs(hits.uv[i] - 0.5).max() > 0.49 - blur * 50 or hits.uv[i].sum() > 1 - blur * 50
            continue
        assert hits.hit[i]
        t, triangle, weights = expected
        assert abs(hits.t[i] - t) <= 40 * blur * max(t, 1)
        if hits.triangle[i] == triangle:
            assert np.abs(hits.uv[i] - weights).max() <= 300 * blur
            a, b, c = vertices[faces[triangle]].astype(np.float64)
            normal = np.cross(b - a, c - a)
            normal /= np.linalg.norm(normal)
            assert np.abs(hits.normal[i] - normal).max() <= 100 * blur
            assert abs((hits.point[i] - a) @ normal) <= hits.error[i] + np.abs(a).max() * 1e-15


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_no_ray_leaks_at_vertices_and_edges_of_a_closed_mesh(shift):
    vertices, faces = icosphere(5)
    vertices = vertices + shift
    scene = eyerays.Scene(vertices, faces)
    for origin in (np.full(3, shift), shift + np.array([0.31, -0.22, 0.54])):
        middles = vertices[faces[:, [0, 1]]].mean(axis=1)
        for aims in (vertices, middles, vertices[faces].mean(axis=1)):
            assert (scene.closest(origin, aims - origin, fields="triangle").triangle >= 0).all()
            assert scene.any(origin, aims - origin).all()


def test_copies_are_met_where_their_matrices_put_them():
    places = np.tile(np.eye(4), (3, 1, 1))
    places[:, :3, 3] = [[0, 0, 0], [0, 0, 5], [10, 0, 0]]
    places[2, :3, :3] *= 2
    scene = eyerays.Scene()
    assert scene.add_mesh(SQUARE - [0, 0, 7], HALVES) == 0
    assert scene.add_instances(SQUARE, HALVES, places) == range(1, 4)
    assert scene.add_mesh(SQUARE + [50, 0, 0], HALVES) == 4
    origins = [[0.5, -0.5, 9], [0.5, -0.5, 4], [0.5, -0.5, -1], [11, -1, 3], [50.5, -0.5, 3]]
    hits = scene.closest(origins, -UP)
    assert hits.object.tolist() == [2, 1, 0, 3, 4] and hits.triangle.tolist() == [0] * 5
    assert np.abs(hits.t - [4, 4, 6, 3, 3]).max() < 1e-5
    assert np.abs(hits.uv - [0.5, 0.25]).max() < 1e-6 and scene.triangles == 10


def test_a_limit_is_in_lengths_of_the_direction():
    scene = eyerays.Scene(SQUARE, HALVES)
    origins, directions = np.tile([0.5, -0.5, 6.0], (4, 1)), np.tile(-2 * UP, (4, 1))
    assert scene.any(origins, directions, tmax=[2.9, 3.1, np.inf, -1]).tolist() == [False, True, True, False]
    assert scene.closest(origins, directions, tmax=2.9).triangle.tolist() == [-1] * 4


def test_arrays_of_any_strides_shapes_and_kinds_are_read():
    scene = eyerays.Scene(np.asfortranarray(SQUARE), HALVES.astype(np.uint8))
    grid = np.zeros((4, 5, 6))
    grid[..., 0], grid[..., 2] = 0.5, -0.5
    grid[..., 4] = 3
    hits = scene.closest(grid[..., ::2], np.array([0, 0, -1], np.int8))
    assert hits.t.shape == (4, 5) and hits.point.shape == (4, 5, 3) and (hits.t == 3).all()
    single = scene.closest([0.5, -0.5, 3], -UP)
    assert single.t.shape == () and float(single.t) == 3
    none = scene.closest(np.empty((0, 3)), -UP)
    assert none.t.shape == (0,) and scene.any(np.empty((0, 3)), -UP).shape == (0,)


def test_arrays_of_the_caller_are_filled():
    scene = eyerays.Scene(SQUARE, HALVES)
    t, triangle, met = np.zeros(3), np.zeros(3, np.int64), np.zeros(3, bool)
    hits = scene.closest(np.tile([0.5, -0.5, 2.0], (3, 1)), -UP, out={"t": t, "triangle": triangle})
    assert hits.t is t and hits.triangle is triangle and hits.uv is None
    assert t.tolist() == [2.0] * 3 and triangle.tolist() == [0] * 3
    assert scene.any(np.tile([0.5, -0.5, 2.0], (3, 1)), -UP, out=met) is met and met.all()


@pytest.mark.parametrize(
    ("error", "said", "make"),
    [
        (ValueError, "vertices[1] is not finite", lambda: eyerays.Scene([[0, 0, 0], [0, np.nan, 0], [1, 0, 0]], [[0, 1, 2]])),
        (ValueError, "its last axis must have three numbers", lambda: eyerays.Scene([[0, 0], [0, 1]], [[0, 1, 1]])),
        (ValueError, "faces[0] is [0, 1, 9], but the vertices are 0 to 3", lambda: eyerays.Scene(SQUARE, [[0, 1, 9]])),
        (ValueError, "faces[1] is [0, -1, 2]", lambda: eyerays.Scene(SQUARE, [[0, 1, 2], [0, -1, 2]])),
        (ValueError, "not (n, 3)", lambda: eyerays.Scene(SQUARE, [[0, 1, 2, 3]])),
        (TypeError, "faces holds float64, not integers", lambda: eyerays.Scene(SQUARE, [[0.0, 1.0, 2.0]])),
        (TypeError, "vertices holds", lambda: eyerays.Scene([["a", "b", "c"]], [[0, 0, 0]])),
        (ValueError, "faces is empty", lambda: eyerays.Scene(SQUARE, np.empty((0, 3), int))),
        (ValueError, "belong together", lambda: eyerays.Scene(SQUARE)),
        (ValueError, "the scene is empty", lambda: eyerays.Scene().any([0, 0, 0], UP)),
        (ValueError, "not (n, 4, 4)", lambda: eyerays.Scene().add_instances(SQUARE, HALVES, np.eye(3))),
        (ValueError, "not 0, 0, 0, 1", lambda: eyerays.Scene().add_instances(SQUARE, HALVES, 2 * np.eye(4))),
        (ValueError, "quality 'best' is none of", lambda: eyerays.Scene(quality="best")),
        (ValueError, "vertices[0] is beyond 1e+18", lambda: eyerays.Scene(SQUARE * 1e30, HALVES)),
        (ValueError, "vertices is empty", lambda: eyerays.Scene(np.empty((0, 3)), HALVES)),
        (TypeError, "is a masked array", lambda: eyerays.Scene(np.ma.masked_less(SQUARE, 0), HALVES)),
        (ValueError, "str has no triangle", lambda: eyerays.Scene.from_trimesh("a mesh")),
        (ValueError, "threads is 100000", lambda: eyerays.Scene(threads=100_000)),
        (ValueError, "threads is -1", lambda: eyerays.Scene(threads=-1)),
        (FileNotFoundError, "nowhere.obj", lambda: eyerays.load("nowhere.obj")),
    ],
)
def test_a_scene_that_is_none_is_refused_in_a_line(error, said, make):
    with pytest.raises(error) as raised:
        make()
    assert said in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("error", "said", "arguments"),
    [
        (ValueError, "the origin of ray 2 is not finite", {"origins": [[0, 0, 1], [0, 0, 1], [0, np.inf, 1]]}),
        (ValueError, "the direction of ray 1 is zero", {"directions": [[0, 0, 1], [0, 0, 0], [0, 0, 1]]}),
        (ValueError, "the direction of ray 0 is not finite", {"directions": [0, np.nan, 0]}),
        (ValueError, "do not go together", {"directions": np.ones((4, 3))}),
        (ValueError, "tmax of ray 1 is not a number", {"tmax": [1, np.nan, 1]}),
        (ValueError, "does not go with rays", {"tmax": [1, 2]}),
        (ValueError, "a hit has no 'distance'", {"fields": ["distance"]}),
        (ValueError, 'is none of "auto", "cpu" and "gpu"', {"device": "tpu"}),
        (TypeError, "out['t'] holds int64", {"out": {"t": np.zeros(3, int)}}),
        (ValueError, "has the shape (2,), not (3,)", {"out": {"t": np.zeros(2)}}),
        (ValueError, "has gaps", {"out": {"t": np.zeros(6)[::2]}}),
        (TypeError, "is no numpy array", {"out": {"t": [0, 0, 0]}}),
        (TypeError, "out maps names of fields", {"out": np.zeros(3)}),
        (TypeError, "tmax holds <U1", {"tmax": "a"}),
        (ValueError, "origins is no array", {"origins": [[0, 0, 1], [0, 0]]}),
        (TypeError, "fields is 5; it is a name or several", {"fields": 5}),
        (TypeError, "fields is [['t']]", {"fields": [["t"]]}),
        (TypeError, "progress is 5", {"progress": 5}),
        (ValueError, "out['error'] shares memory", {"out": dict.fromkeys(("t", "error"), np.zeros(3, np.float32))}),
    ],
)
def test_rays_that_are_none_are_refused_in_a_line(error, said, arguments):
    scene = eyerays.Scene(SQUARE, HALVES)
    arguments = {"origins": np.tile([0.5, -0.5, 2.0], (3, 1)), "directions": -UP, **arguments}
    with pytest.raises(error) as raised:
        scene.closest(**arguments)
    assert said in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_arrays_in_the_order_of_fortran_are_read(kind):
    vertices, faces = icosphere(1)
    origins, directions = np.random.default_rng(8).normal(size=(2, 50, 3)).astype(kind)
    turned, c = np.asfortranarray, eyerays.Scene(vertices, faces)
    fortran = eyerays.Scene(turned(vertices), turned(faces))
    assert fortran.closest(turned(origins), turned(directions)).point.tobytes() == c.closest(origins, directions).point.tobytes()
    assert fortran.closest_point(turned(origins)).point.tobytes() == c.closest_point(origins).point.tobytes()


def test_arrays_that_lie_at_odd_addresses_are_read():
    def odd(array):
        return np.frombuffer(b"\0" + array.tobytes(), np.uint8)[1:].view(array.dtype).reshape(array.shape)

    scene = eyerays.Scene(odd(SQUARE), odd(HALVES))
    scene.add_instances(odd(SQUARE), odd(HALVES), odd(np.eye(4)))
    origins, directions = np.tile([0.5, -0.5, 2.0], (3, 1)), np.tile(-UP, (3, 1))
    assert scene.closest(odd(origins), odd(directions), tmax=odd(np.full(3, 9.0))).t.tolist() == [2.0] * 3


def test_copies_of_a_mesh_that_stands_far_away_are_where_it_is():
    far = np.array([4e7 + 0.3, -3e7, 0])
    alone, copied = eyerays.Scene(SQUARE + far, HALVES), eyerays.Scene()
    copied.add_instances(SQUARE + far, HALVES, np.eye(4))
    origins, directions = far + [[0.5, -0.5, 2.0]], -UP
    assert abs(alone.closest(origins, directions).t[0] - 2) < 1e-5
    assert abs(copied.closest(origins, directions).t[0] - 2) < 1e-5


@pytest.mark.parametrize("length", [1e-300, 1e-170, 1e-30, 1.0, 1e30, 1e200])
def test_directions_of_any_length_count_in_it(length):
    scene = eyerays.Scene(SQUARE, HALVES)
    t = np.zeros(1)
    met = scene.closest([[0.5, -0.5, 2.0]], -UP * length, out={"t": t}, fields=["t", "triangle"])
    assert met.triangle[0] == 0 and abs(t[0] * length - 2) < 1e-6
    assert scene.any([0.5, -0.5, 2.0], -UP * length, tmax=2.1 / length)
    assert not scene.any([0.5, -0.5, 2.0], -UP * length, tmax=1.9 / length)
    # Farther than float32 counts, but not infinitely far.
    assert scene.closest([[0.5, -0.5, 2.0]], -UP * length, fields="t").hit[0]


def test_what_is_met_is_met_up_to_its_distance():
    scene = eyerays.Scene(*icosphere(3))
    random = np.random.default_rng(4)
    origins, directions = random.uniform(-3, 3, (3000, 3)), random.normal(size=(3000, 3))
    hits = scene.closest(origins, directions, out={"t": np.zeros(3000)}, fields=["t", "triangle"])
    assert np.array_equal(scene.any(origins, directions, tmax=hits.t), hits.hit)
    assert np.array_equal(scene.closest(origins, directions, tmax=hits.t).triangle, hits.triangle)
    assert not scene.any(origins[hits.hit], directions[hits.hit], tmax=hits.t[hits.hit] * (1 - 1e-5)).any()


@pytest.mark.parametrize("distance", [1e2, 1e6, 1e10, 1e14])
def test_rays_of_double_precision_come_from_afar(distance):
    scene = eyerays.Scene(*icosphere(4))
    random = np.random.default_rng(6)
    aims = random.uniform(-0.5, 0.5, (500, 3))
    ways = random.normal(size=(500, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    hits = scene.closest(aims - distance * ways, ways)
    assert hits.hit.all()
    beside = hits.point - aims
    beside -= np.einsum("ij,ij->i", beside, ways)[:, None] * ways
    assert np.abs(beside).max() < 1e-5 + distance * 1e-15


def test_what_callers_do_to_their_arrays_later_changes_nothing():
    vertices, faces = SQUARE.copy(), HALVES.copy()
    scene = eyerays.Scene(vertices, faces)
    vertices += 5
    faces[:] = 0
    scene.add_mesh(SQUARE + [9, 0, 0], HALVES)
    assert scene.closest([0.5, -0.5, 2.0], -UP).t == 2


def test_vertices_that_no_triangle_has_are_not_there():
    far = np.vstack([SQUARE[:1] * 1e17, SQUARE])
    assert eyerays.Scene(far, HALVES + 1).closest([0.5, -0.5, 2.0], -UP).t == 2


def test_scenes_are_copied_and_pickled():
    scene = eyerays.Scene(SQUARE, HALVES).build()
    others = [copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))]
    assert scene.add_mesh(SQUARE + [10, 0, 0], HALVES) == 1
    for other in others:
        assert other.closest([[0.5, -0.5, 2.0], [10.5, -0.5, 2.0]], -UP).object.tolist() == [0, -1]
        assert other.add_mesh(SQUARE + [5, 0, 0], HALVES) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_asks_on():
    scene = eyerays.Scene(*icosphere(4))
    directions = np.random.default_rng(3).normal(size=(5000, 3))
    expected = scene.closest(np.zeros(3), directions).t
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        os._exit(0 if np.array_equal(scene.closest(np.zeros(3), directions).t, expected) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_a_claim_of_a_billion_rays_takes_no_memory_before_it_fails():
    scene = eyerays.Scene(SQUARE, HALVES)
    # Rows that lie over each other: 24 GB in name alone.
    many = np.broadcast_to(np.zeros(3), (1_000_000_000, 3))
    with pytest.raises(ValueError, match="the direction of ray 0 is zero"):
        scene.any(many, many)


def test_threads_may_share_a_scene():
    scene = eyerays.Scene(*icosphere(4))
    directions = np.random.default_rng(1).normal(size=(20_000, 3))
    alone = scene.closest(np.zeros(3), directions)
    found = []

    def ask():
        found.append(scene.closest(np.zeros(3), directions))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(found) == 8
    for other in found:
        assert all(np.array_equal(getattr(alone, of), getattr(other, of), equal_nan=True) for of in ("t", "triangle", "uv"))


def test_progress_is_told_and_what_it_raises_ends_the_work():
    scene = eyerays.Scene(SQUARE, HALVES)
    rays = np.tile([0.5, -0.5, 2.0], (3_000_000, 1)).astype(np.float32)
    told = []
    scene.any(rays, -UP, progress=lambda done, count: told.append((done, count)))
    assert told[-1] == (3_000_000, 3_000_000) and len(told) > 1 and told == sorted(told)

    def stop(done, count):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        scene.any(rays, -UP, progress=stop)


def test_an_interrupt_ends_the_work_and_is_heard_by_the_thread_that_asks():
    scene = eyerays.Scene(SQUARE, HALVES)
    rays = np.broadcast_to(np.float32([0.5, -0.5, 2.0]), (40_000_000, 3))
    told = []

    def interrupt(done, count):
        told.append(threading.get_ident())
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        scene.any(rays, -UP, progress=interrupt)
    assert told == [threading.get_ident()]
    out = np.zeros(len(rays), bool)

    def interrupt_the_first_block():
        while not out[0]:
            time.sleep(1e-4)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        threading.Thread(target=interrupt_the_first_block, daemon=True).start()
        scene.any(rays, -UP, out=out, device="cpu")
    assert not out[-1], "the work went on to its end"


def test_scenes_may_ask_each_other_while_they_tell_of_progress():
    """Each has one thread of its own, which must not wait for the other's."""
    one, other = (eyerays.Scene(SQUARE, HALVES, threads=1) for _ in range(2))
    rays = np.broadcast_to(np.float32([0.5, -0.5, 2.0]), (3_000_000, 3))

    answers = []

    def ask(of, beside):
        answers.append(of.any(rays, -UP, progress=lambda *_: beside.any(rays[:1000], -UP)).all())

    pairs = [(one, other), (other, one), (one, other), (other, one)]
    threads = [threading.Thread(target=ask, args=pair, daemon=True) for pair in pairs]
    [thread.start() for thread in threads]
    [thread.join(60) for thread in threads]
    assert answers == [True] * len(pairs)


def test_outputs_are_no_inputs():
    scene = eyerays.Scene(SQUARE, HALVES)
    memory = np.zeros(9, np.float32)
    origins = memory.reshape(3, 3)
    for ask, kind in ((scene.any, bool), (scene.count, np.int32)):
        with pytest.raises(ValueError, match="out shares memory"):
            ask(origins, UP, out=memory.view(kind)[:3])


def test_a_limit_counts_where_products_of_it_are_no_numbers():
    vertices, faces = icosphere(1)
    scene = eyerays.Scene(vertices * 1e-10, faces)
    met = scene.any([0, 0, -1], [0, 0, 1e-300], tmax=5e299)
    assert not met and scene.any([0, 0, -1], [0, 0, 1e-300], tmax=2e300)


def test_memory_does_not_grow():
    resource = pytest.importorskip("resource")
    scene = eyerays.Scene(*icosphere(3))
    directions = np.random.default_rng(2).normal(size=(256, 3))

    def ask(times):
        for _ in range(times):
            scene.closest(np.zeros(3), directions)
        # In bytes on macOS, in KB elsewhere.
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // (1024 if sys.platform == "darwin" else 1)

    before = ask(1_000)
    assert ask(10_000) - before < 16 * 1024, "in KB"
