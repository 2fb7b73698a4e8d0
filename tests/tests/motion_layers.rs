//! How things move from picture to picture, beside what projections say of points that move.

use eyerays::job::Job;
use eyerays::layers::{self, Layer, Shown, Values};
use eyerays::picture::Picture;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{
    Camera, Disk, Instance, Mapping, Mesh, Object, Primitives, Projection, Scene, SharedMesh, Sphere, Visibility,
};
use eyerays::scene_io::{self, Loading, Shutter};
use eyerays::view::View;
use eyerays_tests::shipped;
use glam::{DMat3, DVec2, DVec3, Vec3};

const SIZE: (u32, u32) = (48, 32);

/// Layers of a scene between two others.
fn rendered(shown: Shown<'_>, layers: &[Layer]) -> Vec<Picture> {
    let settings = eyerays::scene::Settings { size: SIZE, samples: 1, spp: 0, ..shown.scene.settings };
    let packed = Job::new(shown.scene, settings, Bvh::Fast.quality()).unwrap();
    let backend = Backend::new(&Choice { device: DeviceWish::Cpu, threads: 2, ..Choice::default() }).unwrap();
    let mut session = backend.open(&packed).unwrap();
    let view = View::new(&packed, shown.camera).unwrap();
    let picture = session.render(&view, 1, &|_| ()).unwrap();
    let layers = layers::render(&mut session, shown, &picture, layers).unwrap();
    let picture = |(_, values)| match values {
        Values::Ways(picture) | Values::Vectors(picture) => picture,
        other => panic!("{other:?}"),
    };
    layers.into_iter().map(picture).collect()
}

fn middle(pixel: usize) -> DVec2 {
    let (x, y) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

fn way(picture: &Picture, pixel: usize) -> DVec2 {
    let [x, y, zero] = picture.pixels[pixel].map(f64::from);
    assert_eq!(zero, 0.0);
    DVec2::new(x, y)
}

/// A square of two triangles that a copy places, a sphere and a disk, beside each other before an empty world.
fn things(camera: Camera) -> Scene {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let mesh = Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![0; 2],
        ..Mesh::default()
    };
    let copy = Instance { mesh: 0, rows: [Vec3::X, Vec3::Y, Vec3::Z], translation: Vec3::new(-3.0, 0.0, 0.0) };
    let bounds = [Vec3::splat(-8.0), Vec3::splat(8.0)];
    let object = |primitives| Object { name: "thing".into(), primitives, bounds, visibility: Visibility::default() };
    Scene {
        mesh,
        shared: vec![SharedMesh { vertices: 0..4, triangles: 0..2 }],
        instances: vec![copy],
        spheres: vec![Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 }],
        disks: vec![Disk { center: Vec3::new(3.0, 0.0, 0.0), normal: Vec3::Z, radius: 1.0, material: 0 }],
        objects: vec![
            object(Primitives::Instances(0..1)),
            object(Primitives::Spheres(0..1)),
            object(Primitives::Disks(0..1)),
        ],
        cameras: vec![camera],
        ..shipped("lights")
    }
}

/// The first camera of all kinds, which sees all things.
fn cameras() -> Vec<Camera> {
    let eye = Vec3::new(0.5, 0.25, 7.0);
    let of = |projection| Camera::new("", eye, Vec3::new(0.25, 0.0, 0.0), projection);
    let fisheye = |mapping| of(Projection::Fisheye { fov: 200.0, mapping });
    vec![
        of(Projection::Perspective { fov: 60.0 }),
        Camera { shift: [0.1, -0.05], ..of(Projection::Perspective { fov: 60.0 }) },
        of(Projection::Orthographic { height: 6.0 }),
        of(Projection::Equirectangular),
        fisheye(Mapping::Equidistant),
        fisheye(Mapping::Equisolid),
    ]
}

/// What the kernels' own rays meet at the middle of a pixel is seen there.
#[test]
fn places_are_seen_at_the_pixels_whose_rays_meet_them() {
    for camera in cameras() {
        let scene = things(camera.clone());
        let positions = &rendered(Shown::of(&scene), &[Layer::Position])[0];
        let met: Vec<usize> = (0..positions.pixels.len()).filter(|&i| positions.pixels[i] != [0.0; 3]).collect();
        assert!(met.len() > 10, "{:?}: {}", camera.projection, met.len());
        for pixel in met {
            let seen = camera.seen_at(Vec3::from(positions.pixels[pixel]).as_dvec3(), SIZE).unwrap();
            let off = (seen - middle(pixel)).length();
            assert!(off < 1e-4, "{:?}: {pixel} is seen {off} away", camera.projection);
        }
    }
}

/// A turn about z by an angle, and then a step.
fn turned(angle: f64, step: DVec3) -> impl Fn(DVec3) -> DVec3 {
    let turn = DMat3::from_rotation_z(angle);
    move |place| turn * place + step
}

/// Everything turns and goes, and so does the camera: each place's way is that of its point.
#[test]
fn ways_are_those_of_points_that_turn_with_their_things() {
    for camera in cameras() {
        let scene = things(camera.clone());
        let at = |angle: f64, step: DVec3| {
            let moved = turned(angle, step);
            let vector = |v: Vec3| (DMat3::from_rotation_z(angle) * v.as_dvec3()).as_vec3();
            let place = |v: Vec3| moved(v.as_dvec3()).as_vec3();
            let mut other = scene.clone();
            // Rows are those of the transform's matrix.
            let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(vector);
            let copy = &mut other.instances[0];
            copy.rows = std::array::from_fn(|row| Vec3::from(columns.map(|column| column[row])));
            copy.translation = place(copy.translation);
            other.spheres[0].center = place(other.spheres[0].center);
            other.disks[0].center = place(other.disks[0].center);
            let eye = camera.eye + Vec3::new(0.1, 0.0, -0.2) * angle as f32;
            (other, Camera { eye, ..camera.clone() })
        };
        let moves = [(-0.2, DVec3::new(-0.1, 0.05, 0.3)), (0.3, DVec3::new(0.2, 0.1, -0.4))];
        let [before, after] = moves.map(|(angle, step)| at(angle, step));
        let neighbours = Some([(&before.0, &before.1), (&after.0, &after.1)]);
        let shown = Shown { scene: &scene, camera: &camera, neighbours };
        let all = rendered(shown, &[Layer::Position, Layer::MotionBack, Layer::MotionForward]);
        for (ways, ((_, turned_camera), (angle, step))) in all[1..].iter().zip([&before, &after].into_iter().zip(moves))
        {
            let (moved, mut met) = (turned(angle, step), 0);
            for (pixel, position) in all[0].pixels.iter().enumerate().filter(|(_, position)| **position != [0.0; 3]) {
                let place = Vec3::from(*position).as_dvec3();
                // Spheres and disks do not tell how they turn about their axes.
                let round = [0.0, 3.0].map(|x| DVec3::X * x).into_iter().find(|centre| place.distance(*centre) < 1.01);
                let there = round.map_or_else(|| moved(place), |centre| place - centre + moved(centre));
                let want = turned_camera.seen_at(there, SIZE).unwrap() - middle(pixel);
                let off = (way(ways, pixel) - want).length();
                assert!(off < 2e-4, "{:?}, {pixel}: {off}", camera.projection);
                met += 1;
            }
            assert!(met > 10);
        }
    }
}

/// The far distance turns with the camera and does not come nearer; a scene that stands still has no way at all.
#[test]
fn nothing_moves_but_by_the_camera_where_nothing_is() {
    let camera = cameras().remove(0);
    let scene = things(camera.clone());
    let nearer = Camera { eye: camera.eye * 0.5, target: camera.target * 0.5, ..camera.clone() };
    let aside = Camera { target: camera.eye + Vec3::new(0.1, 0.0, -1.0), ..camera.clone() };
    let neighbours = Some([(&scene, &nearer), (&scene, &aside)]);
    let all = rendered(
        Shown { scene: &scene, camera: &camera, neighbours },
        &[Layer::Position, Layer::MotionBack, Layer::MotionForward],
    );
    let is_far = |&pixel: &usize| all[0].pixels[pixel] == [0.0; 3];
    let far: Vec<usize> = (0..all[0].pixels.len()).filter(is_far).collect();
    assert!(far.iter().all(|&pixel| way(&all[1], pixel).length() < 1e-5), "what is far comes nearer");
    assert!(far.iter().all(|&pixel| way(&all[2], pixel).x < -1.0), "what is far does not turn");
    let neighbours = Some([(&scene, &camera); 2]);
    let still = rendered(Shown { scene: &scene, camera: &camera, neighbours }, &[Layer::MotionBack]);
    assert!(still[0].pixels.iter().all(|way| *way == [0.0; 3]));
}

/// With an open shutter what moves is numbered behind what stands still, in each picture that which moves in it; ways are of its opening.
#[test]
fn ways_of_blurred_pictures_are_those_of_sharp_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let text =
        "[[camera]]\nname = \"c\"\neye = [0.0, 0.0, 9.0]\ntarget = [0.0, 0.0, 0.0]\northographic = 8.0\n".to_owned();
    let mesh = |at: f32, last: f32, start: f32| {
        format!(
            "[[mesh]]\nshape = \"box\"\nmin = [-0.5, -0.5, -0.5]\nmax = [0.5, 0.5, 0.5]\n[[mesh.key]]\ntime = {start:.1}\ntranslate = [{at:.1}, 0.0, 0.0]\n[[mesh.key]]\ntime = {:.1}\ntranslate = [{at:.1}, {last:.1}, 0.0]\n",
            start + 1.0
        )
    };
    // The first stands still from one second on, the second goes on.
    let text = text + &mesh(-2.0, 2.0, 0.0) + &mesh(2.0, -2.0, 0.5);
    std::fs::write(&path, text).unwrap();
    let at = |seconds: f64, shutter: Shutter| {
        let mut loading = Loading { shutter: Some(shutter), ..Loading::default() };
        loading.moment.seconds = Some(seconds);
        scene_io::load_as(&path, loading).unwrap().0
    };
    let (open, closed) = (Shutter { open: 0.0, close: 0.125, rolling: 1.0 }, Shutter::CLOSED);
    let ways = |shutter: Shutter| {
        let [before, now, after] = [0.75, 0.9375, 1.125].map(|seconds| at(seconds, shutter));
        let neighbours = Some([(&before, &before.cameras[0]), (&after, &after.cameras[0])]);
        let shown = Shown { neighbours, ..Shown::of(&now) };
        (now.motion.is_some(), rendered(shown, &[Layer::MotionBack, Layer::MotionForward]))
    };
    let ((is_blurred, blurred), (is_sharp, sharp)) = (ways(open), ways(closed));
    assert!(is_blurred && !is_sharp);
    // Four pixels are a unit: one goes 2 a second up until it stands, the other down.
    let pixel = |x: f64| (SIZE.1 / 2 * SIZE.0) as usize + (24.0 + 4.0 * x) as usize;
    let rows = |ways: &Picture, x: f64| -> Vec<f64> {
        let column = pixel(x) % SIZE.0 as usize;
        let all = (0..SIZE.1 as usize).map(|row| way(ways, row * SIZE.0 as usize + column));
        let mut moved: Vec<f64> =
            all.filter(|way| way.y != 0.0).inspect(|way| assert!(way.x.abs() < 1e-5)).map(|way| way.y).collect();
        moved.dedup_by(|a, b| (*a - *b).abs() < 1e-5);
        moved
    };
    for ways in [&blurred, &sharp] {
        for (of, x, want) in [(0, -2.0, 1.5), (0, 2.0, -1.5), (1, -2.0, -0.5), (1, 2.0, 1.5)] {
            let got = rows(&ways[of], x);
            assert!(got.len() == 1 && (got[0] - want).abs() < 1e-4, "{of} at {x}: {got:?}, not {want}");
        }
    }
}
