//! Which extensions are read, and what is said of the others.

use super::document::Document;
use super::notes::Notes;
use crate::scene::Unplaced;

/// Those that are drawn.
const KNOWN: [&str; 21] = [
    "EXT_mesh_gpu_instancing",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_scatter",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    VARIANTS,
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

const VARIANTS: &str = "KHR_materials_variants";

/// Those that change nothing of a picture.
const IDLE: [&str; 2] = ["KHR_xmp", "KHR_xmp_json_ld"];

/// The most that are named one by one.
const MOST_NAMED: usize = 20;

/// Refuses what a file can't be drawn without, and says what it is drawn without.
///
/// # Errors
/// An extension that is required and not read.
pub fn check(document: &Document, notes: &mut Notes) -> Unplaced<()> {
    if document.extensions_used.iter().any(|name| name == VARIANTS) {
        notes.left_out(
            VARIANTS,
            &format!("variants of materials ({VARIANTS}) are left out: meshes have what they are made of without one"),
        );
    }
    let is_unknown = |name: &&String| !KNOWN.contains(&name.as_str()) && !IDLE.contains(&name.as_str());
    if let Some(name) = document.extensions_required.iter().find(is_unknown) {
        return Err(format!("extensionsRequired: {name:?} is not read; {}", remedy(name)));
    }
    for name in document.extensions_used.iter().filter(is_unknown).take(MOST_NAMED) {
        notes.left_out(name, &format!("the extension {name:?} is left out: the picture may look different"));
    }
    Ok(())
}

/// How to do without an extension that a file requires.
fn remedy(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "save its meshes without compression, as Blender does unless it is asked to"
        }
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" => "save its textures as PNG or JPEG",
        _ => "save the file without it",
    }
}
