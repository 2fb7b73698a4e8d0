//! What rays ask of a primitive before they look at its material.

use eyerays_shader::data::Primitive;

use super::records::{is_cutout, is_open, is_transparent};
use crate::scene::{Material, Matte, ObjectNumbers, Scene, Visibility};

/// All that its materials and objects say of who sees them.
pub(super) fn visibilities(scene: &Scene) -> impl Iterator<Item = Visibility> + '_ {
    let of_materials = scene.materials.iter().map(|material| material.visibility);
    of_materials.chain(scene.objects.iter().map(|object| object.visibility))
}

/// What pictures show of them.
pub(super) fn mattes(scene: &Scene) -> impl Iterator<Item = Matte> + '_ {
    visibilities(scene).map(|visibility| visibility.matte)
}

/// The flags of a primitive that is seen so.
fn visibility_flags(Visibility { camera, shadow, reflection, matte }: Visibility) -> u32 {
    let unless = |holds: bool, flag| if holds { 0 } else { flag };
    let matte = match matte {
        Matte::Shown => 0,
        Matte::Catcher => Primitive::CATCHER,
        Matte::Holdout => Primitive::HOLDOUT,
    };
    unless(camera, Primitive::UNSEEN)
        | unless(shadow, Primitive::SHADOWLESS)
        | unless(reflection, Primitive::UNREFLECTED)
        | matte
}

/// The flags that a material alone gives.
fn of_material(m: &Material) -> u32 {
    let flag = |flag, holds: bool| if holds { flag } else { 0 };
    flag(Primitive::TRANSPARENT, is_transparent(m))
        | flag(Primitive::CUTOUT, is_cutout(m))
        | flag(Primitive::OPEN, is_open(m))
        | flag(Primitive::HAIR, m.physical.is_some_and(|p| p.hair.is_some()))
        // Culling would leave a medium without an end.
        | flag(Primitive::TWO_SIDED, m.two_sided || m.volume.is_some())
}

/// The flags of primitives of each material, whichever object they are of.
pub(super) fn by_material(scene: &Scene) -> Vec<u32> {
    scene.materials.iter().map(|m| of_material(m) | visibility_flags(m.visibility)).collect()
}

/// The flags that an object adds, by the number of a primitive of it.
pub(super) fn by_object(scene: &Scene) -> impl Fn(u64) -> u32 + Sync + use<> {
    let flags: Vec<u32> = scene.objects.iter().map(|object| visibility_flags(object.visibility)).collect();
    let numbers = flags.iter().any(|&flags| flags != 0).then(|| ObjectNumbers::of(scene));
    move |primitive| {
        let object = numbers.as_ref().and_then(|numbers| numbers.find(primitive as usize));
        object.map_or(0, |number| flags[number as usize])
    }
}

/// The flags of each primitive, by its number and material.
pub(super) fn by_primitive(scene: &Scene) -> impl Fn(usize, u32) -> u32 + Sync + use<> {
    let flags: Vec<u32> = scene.materials.iter().map(of_material).collect();
    let seen: Vec<Visibility> = scene.materials.iter().map(|material| material.visibility).collect();
    let of_objects: Vec<Visibility> = scene.objects.iter().map(|object| object.visibility).collect();
    let is_plain = visibilities(scene).all(|visibility| visibility.is_plain());
    let numbers = (!is_plain).then(|| ObjectNumbers::of(scene));
    move |primitive, material| {
        let Some(numbers) = &numbers else { return flags[material as usize] };
        let object = numbers.find(primitive).map_or(Visibility::default(), |number| of_objects[number as usize]);
        flags[material as usize] | visibility_flags(seen[material as usize].and(object))
    }
}
