//! The layers of a picture hold what other ways to ask say.

use eyerays::batch::{Batch, Ray};
use eyerays::cpu;
use eyerays::job::Job;
use eyerays::layers::{self, Layer, Shown, Values};
use eyerays::method::Method;
use eyerays::picture::Picture;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{Disk, Lens, Matte, Object, PixelFilter, Primitives, Sampler, Scene, Settings, Visibility};
use eyerays::stream::Question;
use eyerays::view::{Region, View};
use eyerays_tests::covered::covered;
use eyerays_tests::shipped;
use glam::{Vec2, Vec3};

const SIZE: (u32, u32) = (48, 36);

/// What a picture is rendered for here, mostly.
const ALL: [Layer; 9] = [
    Layer::Colour,
    Layer::Albedo,
    Layer::Normal,
    Layer::Depth,
    Layer::Object,
    Layer::Material,
    Layer::Primitive,
    Layer::Direct,
    Layer::Indirect,
];

/// The picture of a scene on the CPU, and layers of it in their order.
fn layered(scene: &Scene, spp: u32, layers: &[Layer]) -> (Picture, Vec<(Layer, Values)>) {
    let settings = Settings { size: SIZE, spp, sampler: Sampler::Sobol, ..scene.settings };
    let packed = Job::new(scene, settings, Bvh::Fast.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Cpu, threads: 2, ..Choice::default() };
    let backend = Backend::new(&choice).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    let mut session = backend.open(&packed).unwrap();
    let picture = session.render(&view, 1, &|_| ()).unwrap();
    let layers = layers::render(&mut session, Shown::of(scene), &picture, layers).unwrap();
    let again = session.render(&view, 1, &|_| ()).unwrap();
    assert!(again.picture.bits_equal(&picture.picture), "layers change the session that they are of");
    (picture.picture, layers)
}

fn layer(layers: &[(Layer, Values)], wanted: Layer) -> &Picture {
    let (_, values) = layers.iter().find(|(layer, _)| *layer == wanted).expect("it was asked for");
    match values {
        Values::Light(picture) | Values::Colours(picture) | Values::Vectors(picture) | Values::Coordinates(picture) => {
            picture
        }
        other => panic!("{wanted:?} is {other:?}"),
    }
}

fn numbers(layers: &[(Layer, Values)], wanted: Layer) -> &[u32] {
    match layers.iter().find(|(layer, _)| *layer == wanted) {
        Some((_, Values::Numbers(numbers))) => numbers,
        other => panic!("{wanted:?} is {other:?}"),
    }
}

fn depths(layers: &[(Layer, Values)]) -> &[f32] {
    match layers.iter().find(|(layer, _)| *layer == Layer::Depth) {
        Some((_, Values::Lengths(depths))) => depths,
        other => panic!("depth is {other:?}"),
    }
}

/// Rays through the middles of the first camera's pixels, whose lengths are those of one that goes a unit forward.
fn rays(scene: &Scene) -> Vec<(Ray, f64)> {
    let camera = &scene.cameras[0];
    let (eye, target, up) = (camera.eye.as_dvec3(), camera.target.as_dvec3(), camera.up.as_dvec3());
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let up = right.cross(forward);
    let half = (f64::from(camera.projection.fov().unwrap()).to_radians() / 2.0).tan();
    let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
    let place = |x: u32, y: u32| {
        let across = (f64::from(2 * x + 1) - width) / height * half;
        let down = (f64::from(2 * y + 1) / height - 1.0) * half;
        let direction = forward + right * across - up * down;
        (Ray::new(camera.eye.as_dvec3(), direction), 1.0 / direction.length())
    };
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| place(x, y))).collect()
}

/// The number of the part that has a primitive.
fn part(scene: &Scene, primitive: usize) -> u32 {
    let (triangles, spheres) = (scene.mesh.triangles.len(), scene.spheres.len());
    let holds = |primitives: &Primitives| match primitives {
        Primitives::Triangles(range) => range.contains(&primitive),
        Primitives::Spheres(range) => primitive.checked_sub(triangles).is_some_and(|own| range.contains(&own)),
        Primitives::Disks(range) => primitive.checked_sub(triangles + spheres).is_some_and(|own| range.contains(&own)),
        Primitives::Instances(_) => panic!("there are none"),
    };
    1 + scene.objects.iter().position(|part| holds(&part.primitives)).expect("all primitives are of parts") as u32
}

/// Where rays through the middles of pixels meet something; and coordinates that are laid over a wall by its places.
#[test]
fn positions_are_where_rays_meet_things_and_coordinates_go_with_them() {
    let mut scene = shipped("bleeding");
    let mesh = &mut scene.mesh;
    mesh.coordinates[0] = mesh.positions.iter().map(|p| Vec2::new(0.5 * p.x - p.y, p.z + 2.0 * p.y)).collect();
    let (_, layers) = layered(&scene, 1, &[Layer::Position, Layer::Uv, Layer::Depth]);
    let [positions, uv] = [Layer::Position, Layer::Uv].map(|of| layer(&layers, of));
    let (mut met, mut covered) = (0, 0);
    for (i, (ray, forward)) in rays(&scene).into_iter().enumerate() {
        let [depth, place] = [f64::from(depths(&layers)[i]), 0.0];
        if depth.is_infinite() {
            assert_eq!((positions.pixels[i], uv.pixels[i]), ([place as f32; 3], [0.0; 3]));
            continue;
        }
        let at = ray.origin + ray.direction.normalize() * (depth / forward);
        let seen = Vec3::from(positions.pixels[i]);
        assert!((at - seen.as_dvec3()).length() < 1e-4 * at.length().max(1.0), "pixel {i}: {seen} is not {at}");
        met += 1;
        let [u, v, w] = uv.pixels[i];
        if [u, v] != [0.0; 2] {
            let want = Vec2::new(0.5 * seen.x - seen.y, seen.z + 2.0 * seen.y);
            assert!((Vec2::new(u, v) - want).length() < 1e-3 && w == 0.0, "pixel {i}: {u}, {v} is not {want}");
            covered += 1;
        }
    }
    assert!(met > 500 && covered > 300, "{met} {covered}");
}

#[test]
fn depth_object_and_material_are_those_of_rays_through_the_middles_of_pixels() {
    let mut scene = shipped("bleeding");
    let camera = &scene.cameras[0];
    let center = camera.eye + 0.3 * (camera.target - camera.eye) + 0.2 * Vec3::Y;
    let normal = (camera.eye - center).normalize();
    scene.disks.push(Disk { center, normal, radius: 0.1, material: 1 });
    let bounds = [center - 0.1, center + 0.1];
    scene.objects.push(Object {
        name: "disk".into(),
        primitives: Primitives::Disks(0..1),
        bounds,
        visibility: Visibility::default(),
    });
    assert!(!scene.spheres.is_empty() && !scene.mesh.triangles.is_empty());
    let (_, layers) = layered(&scene, 1, &ALL);
    let packed = Job::new(&scene, scene.settings, Bvh::Fast.quality()).unwrap();
    let (rays, forward): (Vec<_>, Vec<_>) = rays(&scene).into_iter().unzip();
    let batch = Batch::new(&packed, &rays);
    let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 1, batch.stream(), Question::Closest).unwrap();
    let (objects, materials) = (numbers(&layers, Layer::Object), numbers(&layers, Layer::Material));
    let primitives = numbers(&layers, Layer::Primitive);
    let (mut seen, mut others) = (std::collections::BTreeSet::new(), 0);
    for (i, hit) in batch.hits(&packed, &answers).into_iter().enumerate() {
        let (depth, expected) = (f64::from(depths(&layers)[i]), hit.map(|hit| part(&scene, hit.primitive as usize)));
        if objects[i] != expected.unwrap_or(0) {
            // At an edge the direction's last bit decides.
            others += 1;
            continue;
        }
        assert_eq!(depth.is_infinite(), expected.is_none(), "pixel {i}");
        assert_eq!((materials[i] == 0, primitives[i] == 0), (expected.is_none(), expected.is_none()), "pixel {i}");
        let Some(hit) = hit else { continue };
        seen.insert(objects[i]);
        assert_eq!(primitives[i], hit.primitive + 1, "pixel {i}");
        let far = hit.t * rays[i].direction.length() * forward[i];
        assert!((depth - far).abs() <= 1e-4 * far, "pixel {i}: {depth} and {far}");
        let triangle = scene.mesh.materials.get(hit.primitive as usize);
        assert!(triangle.is_none_or(|material| materials[i] == material + 1), "pixel {i}");
    }
    let disk = scene.objects.len() as u32;
    assert!(others <= 4 && seen.len() > 5 && seen.contains(&disk), "{others} other pixels, {seen:?}");
}

#[test]
fn direct_and_indirect_light_are_all_of_it() {
    for scene in [shipped("bleeding"), covered()] {
        let mut scene = scene;
        scene.settings.transport.integrator = eyerays::scene::Integrator::Path;
        scene.settings.bounces = 4;
        let (picture, layers) = layered(&scene, 4, &ALL);
        let (direct, indirect) = (layer(&layers, Layer::Direct), layer(&layers, Layer::Indirect));
        assert!(indirect.pixels.iter().filter(|pixel| pixel.iter().any(|&c| c > 0.0)).count() > 100);
        for (i, pixel) in picture.pixels.iter().enumerate() {
            for (channel, &light) in pixel.iter().enumerate() {
                let sum = direct.pixels[i][channel] + indirect.pixels[i][channel];
                assert!((sum - light).abs() <= 1e-5 * light.max(1e-3), "pixel {i}: {sum} and {light}");
            }
        }
        scene.settings.bounces = 0;
        let (_, layers) = layered(&scene, 4, &ALL);
        assert!(layer(&layers, Layer::Indirect).pixels.iter().all(|&pixel| pixel == [0.0; 3]));
    }
}

#[test]
fn albedo_is_the_colour_of_surfaces_and_normals_are_on_the_viewers_side() {
    let scene = shipped("bleeding");
    let (_, layers) = layered(&scene, 1, &ALL);
    let (albedo, normal) = (layer(&layers, Layer::Albedo), layer(&layers, Layer::Normal));
    let forward = (scene.cameras[0].target - scene.cameras[0].eye).normalize();
    let materials = numbers(&layers, Layer::Material);
    let mut matt = 0;
    for (i, &number) in materials.iter().enumerate() {
        let width = SIZE.0 as usize;
        let around = [i.saturating_sub(1), i + 1, i.saturating_sub(width), i + width];
        // The one sample of a pixel at an edge may see something else than its middle.
        if number == 0 || !around.iter().all(|&other| materials.get(other) == Some(&number)) {
            continue;
        }
        let [colour, vector] = [albedo, normal].map(|picture| Vec3::from(picture.pixels[i]));
        assert!((vector.length() - 1.0).abs() < 1e-5, "pixel {i}: {vector}");
        assert!(vector.dot(forward) < 0.5, "pixel {i}: {vector} faces away");
        assert_eq!(colour, scene.materials[number as usize - 1].diffuse, "pixel {i}");
        matt += 1;
    }
    assert!(matt > 500, "{matt}");
}

/// What is seen before the picture: the colours of the materials that the layer of materials tells.
#[test]
fn a_preview_has_the_colours_at_the_middle_of_each_pixel() {
    let scene = shipped("bleeding");
    let settings = Settings { size: SIZE, spp: 3, sampler: Sampler::Sobol, ..scene.settings };
    let packed = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let window = Region { x: 0, y: 0, width: SIZE.0, height: SIZE.1 };
    let preview = layers::preview(&packed, &scene.cameras[0], window, 2).unwrap();
    let (_, layers) = layered(&scene, 1, &ALL);
    for (i, (&seen, &number)) in preview.pixels.iter().zip(numbers(&layers, Layer::Material)).enumerate() {
        let colour = if number == 0 { Vec3::ZERO } else { scene.materials[number as usize - 1].diffuse };
        assert_eq!(Vec3::from(seen), colour, "pixel {i}");
    }
}

/// The opacity of a picture in which all but one name are holes.
fn alone(scene: &Scene, name: &str, spp: u32) -> Vec<f32> {
    let mut scene = scene.clone();
    for object in scene.objects.iter_mut().filter(|object| object.name != name) {
        object.visibility.matte = Matte::Holdout;
    }
    layered(&scene, spp, &[]).0.alpha.expect("holes are not opaque")
}

/// Each sample counts for what its ray meets first: what is left where all else is a hole, sample for sample, through a lens and by a filter
/// that reaches beyond the pixel, too.
#[test]
fn cryptomattes_are_the_shares_of_samples_that_meet_a_name_first() {
    let mut scene = shipped("bleeding");
    for (number, object) in scene.objects.iter_mut().enumerate() {
        object.name = format!("object {}", number % 4);
    }
    scene.settings.pixel_filter = Some(PixelFilter::BlackmanHarris);
    scene.cameras[0].lens = Some(Lens::round(0.05));
    let (_, layers) = layered(&scene, 32, &[Layer::CryptoObject, Layer::CryptoMaterial]);
    let [objects, materials] = [0, 1].map(|number: usize| match &layers[number].1 {
        Values::Shares(matte) => matte,
        other => panic!("{other:?}"),
    });
    let names: Vec<String> = (0..4).map(|number| format!("object {number}")).collect();
    let mut sum = vec![0.0; objects.pixels()];
    for name in &names {
        let share = objects.share(name);
        assert_eq!(share, alone(&scene, name, 32), "{name}");
        assert!(share.iter().any(|&share| share > 0.0 && share < 1.0) && share.contains(&1.0), "{name}");
        sum.iter_mut().zip(share).for_each(|(sum, share)| *sum += share);
    }
    // Every pixel shows materials where it shows objects.
    let mut of_materials = vec![0.0; materials.pixels()];
    let unique: std::collections::BTreeSet<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    for name in unique {
        of_materials.iter_mut().zip(materials.share(name)).for_each(|(sum, share)| *sum += share);
    }
    assert_eq!(sum, of_materials);
}
