//! Whether a scene holds together and is in range, whoever made it.

mod covering;
mod finish;
mod instances;
mod medium;
mod motion;
mod settings;

use glam::Vec3;
use rayon::prelude::*;

use super::range::Range;
use super::{
    Background, Camera, Disk, Lens, Light, LightGroups, Material, Mesh, Object, Physical, Primitives, Projection,
    Scene, Sphere, Stereo, Unplaced,
};
use crate::error::{Error, Result};
use crate::spectrum::Illuminant;

impl Scene {
    /// Refuses numbers that are out of range, or that name what there is not: kernels read through them without checking
    /// them again. [`scene_io`](crate::scene_io) makes no such scene; code may.
    ///
    /// # Errors
    /// The first of them.
    pub fn check(&self) -> Result<()> {
        let of_materials = self.materials.iter().try_for_each(material);
        of_materials.and_then(|()| self.surroundings()).map_err(Error::new)?;
        covering::textures(self)?;
        geometry(self)
    }

    /// All but materials and geometry.
    fn surroundings(&self) -> Unplaced<()> {
        let scene = Owner("the scene".into());
        scene.colour("ambient", self.ambient, Range::AMOUNT)?;
        match self.background {
            Background::Colour(colour) => scene.colour("background", colour, Range::AMOUNT)?,
            Background::Gradient { horizon, zenith } => {
                scene.colour("horizon", horizon, Range::AMOUNT)?;
                scene.colour("zenith", zenith, Range::AMOUNT)?;
            }
        }
        if let Some(environment) = &self.environment {
            scene.number("environment's rotation", environment.rotation, Range::ANY)?;
            scene.number("environment's scale", environment.scale, Range::AMOUNT)?;
        }
        self.fog.iter().try_for_each(|of| medium::medium(&Owner("the fog".into()), of))?;
        self.lights.iter().enumerate().try_for_each(|(number, of)| light(number, of))?;
        let groups = LightGroups::of(self);
        groups.check()?;
        self.materials.iter().try_for_each(|of| groups.check_lit_by(of))?;
        self.cameras.iter().try_for_each(camera)?;
        self.objects.iter().try_for_each(|of| object(of, self))
    }
}

/// Whose numbers are checked.
struct Owner(String);

impl Owner {
    fn number(&self, key: &str, number: f32, range: Range) -> Unplaced<()> {
        if range.holds(number) {
            return Ok(());
        }
        Err(format!("{} has the {key} {number}; it must be {}", self.0, range.says()))
    }

    fn colour(&self, key: &str, triple: Vec3, range: Range) -> Unplaced<()> {
        let odd = triple.to_array().into_iter().find(|&number| !range.holds(number));
        odd.map_or(Ok(()), |number| self.number(key, number, range))
    }

    fn place(&self, key: &str, place: Vec3) -> Unplaced<()> {
        self.colour(key, place, Range::ANY)
    }

    fn refuse(&self, fault: &str) -> Unplaced<()> {
        Err(format!("{} {fault}", self.0))
    }
}

fn material(material: &Material) -> Unplaced<()> {
    let owner = Owner(format!("the material {:?}", material.name));
    let shares = [
        ("ambient", material.ambient()),
        ("diffuse", material.diffuse),
        ("specular", material.specular),
        ("reflection", material.reflection),
        ("transmission", material.transmission),
    ];
    shares.into_iter().try_for_each(|(key, share)| owner.colour(key, share, Range::SHARE))?;
    owner.number("shininess", material.shininess, Range::AMOUNT)?;
    owner.number("ior", material.ior, Range::IOR)?;
    owner.colour("emission", material.emission, Range::AMOUNT)?;
    illuminant(&owner, material.illuminant)?;
    material.physical.iter().try_for_each(|of| physical(&owner, of))?;
    material.volume.iter().try_for_each(|of| medium::volume(&owner, material, of))?;
    covering::material(&owner, material)?;
    material.visibility.check(&owner.0)?;
    let Some(checker) = material.checker else { return Ok(()) };
    owner.colour("checker color", checker.colour, Range::SHARE)?;
    owner.colour("checker ambient", checker.ambient, Range::SHARE)?;
    owner.number("checker size", checker.size, Range::LENGTH)
}

fn physical(owner: &Owner, of: &Physical) -> Unplaced<()> {
    let shares = [("base_color", of.base), ("transmission", of.transmission)];
    shares.into_iter().try_for_each(|(key, share)| owner.colour(key, share, Range::SHARE))?;
    owner.colour("specular_tint", of.specular_tint, Range::AMOUNT)?;
    let numbers = [
        ("metallic", of.metallic),
        ("roughness", of.roughness),
        ("anisotropy", of.anisotropy),
        ("specular_weight", of.specular_weight),
    ];
    numbers.into_iter().try_for_each(|(key, number)| owner.number(key, number, Range::SHARE))?;
    owner.number("anisotropy_rotation", of.anisotropy_rotation, Range::ANY)?;
    owner.number("ior", of.ior, Range::IOR)?;
    if let Some(absorption) = of.absorption {
        owner.colour("absorption color", absorption.colour, Range::SHARE)?;
        owner.number("absorption distance", absorption.distance, Range::LENGTH)?;
    }
    finish::finish(owner, of)?;
    let Some(conductor) = of.conductor else { return Ok(()) };
    owner.colour("conductor eta", conductor.eta, Range::INDEX)?;
    owner.colour("conductor k", conductor.k, Range::INDEX)
}

fn illuminant(owner: &Owner, of: Option<Illuminant>) -> Unplaced<()> {
    match of {
        Some(Illuminant::BlackBody(kelvins)) => owner.number("temperature", kelvins, Range::TEMPERATURE),
        _ => Ok(()),
    }
}

fn light(number: usize, light: &Light) -> Unplaced<()> {
    let owner = Owner(format!("light {number}"));
    illuminant(&owner, light.illuminant())?;
    match *light {
        Light::Point { position, colour, .. } => {
            owner.place("position", position)?;
            owner.colour("color", colour, Range::AMOUNT)
        }
        Light::Directional { direction, colour, .. } => {
            owner.place("direction", direction)?;
            owner.colour("color", colour, Range::AMOUNT)?;
            if direction == Vec3::ZERO { owner.refuse("has no direction; say which way it shines") } else { Ok(()) }
        }
        Light::Spot { position, target, colour, outer, inner, .. } => {
            owner.place("position", position)?;
            owner.place("target", target)?;
            owner.colour("color", colour, Range::AMOUNT)?;
            owner.number("angle", 2.0 * outer, Range::CONE)?;
            if !(0.0..=outer).contains(&inner) {
                return owner
                    .refuse(&format!("has the inner angle {inner}; it must be between 0 and the outer one, {outer}"));
            }
            if target == position { owner.refuse("shines at its own position; move its target") } else { Ok(()) }
        }
    }
}

fn camera(camera: &Camera) -> Unplaced<()> {
    let owner = Owner(format!("the camera {:?}", camera.name));
    owner.place("eye", camera.eye)?;
    owner.place("target", camera.target)?;
    owner.place("up", camera.up)?;
    match camera.projection {
        Projection::Perspective { fov } => owner.number("fov", fov, Range::CONE)?,
        Projection::Orthographic { height } => owner.number("orthographic height", height, Range::LENGTH)?,
        Projection::Equirectangular => {}
        Projection::Fisheye { fov, .. } => owner.number("fov", fov, Range::CIRCLE)?,
    }
    camera.shift.iter().try_for_each(|&shift| owner.number("shift", shift, Range::SHIFT))?;
    if let Some(of) = &camera.lens {
        lens(&owner, camera, of)?;
    }
    let [near, far] = camera.clip;
    owner.number("clip_near", near, Range::AMOUNT)?;
    if far.is_nan() || far <= near {
        return owner.refuse(&format!("sees from {near} to {far}; move clip_far behind clip_near"));
    }
    if let Some(of) = &camera.stereo {
        stereo(&owner, camera, of)?;
    }
    if camera.eye == camera.target {
        return owner.refuse("looks at its own eye; move its target");
    }
    if !camera.is_upright() { owner.refuse("has its up along its view; turn up aside") } else { Ok(()) }
}

fn lens(owner: &Owner, camera: &Camera, lens: &Lens) -> Unplaced<()> {
    owner.number("aperture", lens.radius, Range::AMOUNT)?;
    owner.number("rotation of blades", lens.rotation, Range::ANY)?;
    owner.number("roundness of blades", lens.roundness, Range::SHARE)?;
    owner.number("anamorphic ratio", lens.ratio, Range::LENGTH)?;
    if !Lens::can_have(lens.blades) {
        return owner.refuse(&format!("has {} blades; it must be 0 or from 3 to {}", lens.blades, Lens::MOST_BLADES));
    }
    if !camera.projection.is_flat() {
        return owner.refuse("goes all around, which no lens does; remove its lens");
    }
    // NaN is no distance either.
    if camera.focus_distance() > 0.0 {
        Ok(())
    } else {
        owner.refuse("is to be sharp at or behind its eye; move its focus")
    }
}

fn stereo(owner: &Owner, camera: &Camera, stereo: &Stereo) -> Unplaced<()> {
    owner.number("distance of eyes", stereo.distance, Range::LENGTH)?;
    if let Some((key, why)) = stereo.misfit(camera.projection) {
        return owner.refuse(&format!("has the key {key}, but {why}; remove it"));
    }
    stereo.convergence.map_or(Ok(()), |distance| owner.number("convergence", distance, Range::LENGTH))
}

fn object(object: &Object, scene: &Scene) -> Unplaced<()> {
    let (range, most) = match &object.primitives {
        Primitives::Triangles(range) => (range, scene.mesh.triangles.len()),
        Primitives::Spheres(range) => (range, scene.spheres.len()),
        Primitives::Disks(range) => (range, scene.disks.len()),
        Primitives::Instances(range) => (range, scene.instances.len()),
    };
    let owner = Owner(format!("the object {:?}", object.name));
    object.visibility.check(&owner.0)?;
    object.bounds.iter().try_for_each(|&corner| owner.place("bounds", corner))?;
    if range.start <= range.end && range.end <= most {
        return Ok(());
    }
    let noun = object.primitives.noun();
    owner.refuse(&format!("is made of the {noun}s {} to {}, but there are {most}", range.start, range.end))
}

fn geometry(scene: &Scene) -> Result<()> {
    let materials = scene.materials.len();
    mesh(&scene.mesh, materials)?;
    instances::check(scene)?;
    motion::check(scene)?;
    let spheres = scene.spheres.par_iter().enumerate();
    first(spheres.find_map_first(|(number, sphere)| {
        let Sphere { center, radius, material } = *sphere;
        let fault = round(center, radius, sphere.bounds(), material, materials)?;
        Some(format!("sphere {number} has {fault}"))
    }))?;
    let disks = scene.disks.par_iter().enumerate();
    first(disks.find_map_first(|(number, disk)| {
        let Disk { center, normal, radius, material } = *disk;
        let fault = upright(normal).or_else(|| round(center, radius, disk.bounds(), material, materials))?;
        Some(format!("disk {number} has {fault}"))
    }))
}

fn first(fault: Option<String>) -> Result<()> {
    fault.map_or(Ok(()), |fault| Err(Error::new(fault)))
}

/// What is wrong with a sphere or a disk.
fn round(center: Vec3, radius: f32, bounds: [Vec3; 2], material: u32, materials: usize) -> Option<String> {
    if !center.is_finite() {
        return Some(format!("the center {center}, which is not finite: move it"));
    }
    if !(radius.is_finite() && radius > 0.0) {
        return Some(format!("the radius {radius}: make it finite and greater than 0"));
    }
    if !bounds.iter().all(|corner| corner.is_finite()) {
        return Some(format!("the radius {radius}, which leaves the range of single precision: make it smaller"));
    }
    let is_there = (material as usize) < materials;
    (!is_there).then(|| format!("material {material}, but there are {materials}"))
}

/// What is wrong with a normal.
fn upright(normal: Vec3) -> Option<String> {
    /// How far the length may be from 1, for normals that code calculates in single precision.
    const OFF: f64 = 1e-3;
    let length = normal.as_dvec3().length();
    let is_unit = (length - 1.0).abs() <= OFF;
    (!is_unit).then(|| format!("a normal of length {length}: make it 1"))
}

fn mesh(mesh: &Mesh, materials: usize) -> Result<()> {
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    if mesh.materials.len() != triangles {
        let own = mesh.materials.len();
        return Err(Error::new(format!(
            "the mesh has {triangles} triangles and {own} materials of them: give each one"
        )));
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != vertices {
        let own = mesh.normals.len();
        return Err(Error::new(format!("the mesh has {vertices} vertices and {own} normals: give each one, or none")));
    }
    covering::counts(mesh)?;
    of_triangles(mesh, materials)?;
    of_vertices(mesh)?;
    covering::vertices(mesh)
}

/// Refuses triangles of vertices or materials that there are not.
fn of_triangles(mesh: &Mesh, materials: usize) -> Result<()> {
    let vertices = mesh.positions.len();
    let corners = mesh.triangles.par_iter().zip(&mesh.materials).enumerate();
    first(corners.find_map_first(|(triangle, (corners, &material))| {
        if let Some(vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Some(format!("triangle {triangle} has vertex {vertex}, but there are {vertices}"));
        }
        let is_there = (material as usize) < materials;
        (!is_there).then(|| format!("triangle {triangle} has material {material}, but there are {materials}"))
    }))
}

/// Refuses positions that are not finite, and normals that are neither of unit length nor zero.
fn of_vertices(mesh: &Mesh) -> Result<()> {
    let odd = mesh.positions.par_iter().position_first(|position| !position.is_finite());
    first(odd.map(|vertex| {
        let whose = mesh.triangles.iter().position(|corners| corners.contains(&(vertex as u32)));
        let whose = whose.map_or_else(|| "the mesh".into(), |triangle| format!("triangle {triangle}"));
        format!("{whose} has vertex {vertex} at {}, which is not finite: move it", mesh.positions[vertex])
    }))?;
    let normals = mesh.normals.par_iter().enumerate();
    first(normals.find_map_first(|(vertex, &normal)| {
        let fault = upright(normal).filter(|_| normal != Vec3::ZERO)?;
        Some(format!("vertex {vertex} has {fault}"))
    }))
}

#[cfg(test)]
mod tests;
