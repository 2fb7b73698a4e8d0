//! The records of elements that are read.

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use crate::image::srgb_to_linear;
use crate::scene::Unplaced;

/// Names of texture coordinates.
const COORDINATES: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];

/// What vertices have beside their places.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Has {
    pub normals: bool,
    pub coordinates: bool,
    pub colours: bool,
    /// Colours of faces, which count where vertices have none.
    pub face_colours: bool,
    /// Colours of which nothing says how bright they are.
    pub foreign_colours: bool,
}

impl Has {
    /// That of an element.
    pub fn of(element: &ElementDef) -> Self {
        let names = ["red", "green", "blue"];
        let has_colours = Has::all(element, &names);
        let is_light = |name: &&str| {
            let kind = element.properties.get(*name).map(|property| &property.data_type);
            matches!(
                kind,
                Some(PropertyType::Scalar(
                    ScalarType::UChar | ScalarType::UShort | ScalarType::Float | ScalarType::Double
                ))
            )
        };
        let colours = has_colours && names.iter().all(is_light);
        Has {
            normals: Has::all(element, &["nx", "ny", "nz"]),
            coordinates: COORDINATES.iter().any(|names| Has::all(element, names)),
            colours,
            face_colours: false,
            foreign_colours: has_colours && !colours,
        }
    }

    /// Does an element have all of these properties, as single numbers?
    pub fn all(element: &ElementDef, names: &[&str]) -> bool {
        let kind = |name: &&str| element.properties.get(*name).map(|property| &property.data_type);
        names.iter().all(|name| matches!(kind(name), Some(PropertyType::Scalar(_))))
    }
}

#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// Of textures, up.
    pub coordinates: [f32; 2],
    /// Linear RGB and opacity in [0, 1].
    pub colour: [f32; 4],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Vertex { position: [0.0; 3], normal: [0.0; 3], coordinates: [0.0; 2], colour: [1.0; 4] }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let to = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "s" | "u" | "texture_u" => &mut self.coordinates[0],
            "t" | "v" | "texture_v" => &mut self.coordinates[1],
            _ => return put_colour(&mut self.colour, name, &value),
        };
        let Some(number) = value.to_f32_lossy() else { return PropertyAccessResult::Ignored };
        *to = number;
        PropertyAccessResult::Set
    }
}

/// Sets the channel of this name; bytes and numbers of 16 bits are sRGB.
fn put_colour(colour: &mut [f32; 4], name: &str, value: &Property) -> PropertyAccessResult {
    let light = |share| srgb_to_linear(share) as f32;
    match name {
        "red" => put(&mut colour[0], value, light),
        "green" => put(&mut colour[1], value, light),
        "blue" => put(&mut colour[2], value, light),
        "alpha" => put(&mut colour[3], value, |share| share as f32),
        _ => PropertyAccessResult::Ignored,
    }
}

/// Sets a channel; what is beyond [0, 1] becomes the nearest value.
fn put(channel: &mut f32, value: &Property, of_share: impl Fn(f64) -> f32) -> PropertyAccessResult {
    *channel = match *value {
        Property::UChar(byte) => of_share(f64::from(byte) / 255.0),
        Property::UShort(number) => of_share(f64::from(number) / 65535.0),
        Property::Float(light) => share(light),
        Property::Double(light) => share(light as f32),
        _ => return PropertyAccessResult::Ignored,
    };
    PropertyAccessResult::Set
}

/// NaN is dark.
fn share(light: f32) -> f32 {
    if light > 0.0 { light.min(1.0) } else { 0.0 }
}

/// The corners of a face, or of strips, and its colour.
pub(super) struct Corners {
    pub list: Vec<i64>,
    /// Linear RGB and opacity in [0, 1].
    pub colour: [f32; 4],
}

impl Corners {
    /// Is this the list's name? Both are in use.
    fn is(name: &str) -> bool {
        matches!(name, "vertex_indices" | "vertex_index")
    }

    /// Refuses an element without such a list.
    ///
    /// # Errors
    /// There is none, or one of what numbers no vertices.
    pub fn check(element: &ElementDef) -> Unplaced<()> {
        let property = element.properties.iter().find(|(name, _)| Corners::is(name));
        match property.map(|(_, property)| &property.data_type) {
            Some(PropertyType::List(_, ScalarType::Float | ScalarType::Double) | PropertyType::Scalar(_)) | None => {
                Err(format!(
                    "its elements {:?} have no list vertex_indices of whole numbers; is it a mesh?",
                    element.name
                ))
            }
            Some(PropertyType::List(..)) => Ok(()),
        }
    }
}

impl PropertyAccess for Corners {
    fn new() -> Self {
        Corners { list: Vec::new(), colour: [1.0; 4] }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !Corners::is(name) {
            return put_colour(&mut self.colour, name, &value);
        }
        fn wide<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
            list.into_iter().map(Into::into).collect()
        }
        self.list = match value {
            Property::ListChar(list) => wide(list),
            Property::ListUChar(list) => wide(list),
            Property::ListShort(list) => wide(list),
            Property::ListUShort(list) => wide(list),
            Property::ListInt(list) => wide(list),
            Property::ListUInt(list) => wide(list),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// What is read to get past it.
pub(super) struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Ignored
    }
}
