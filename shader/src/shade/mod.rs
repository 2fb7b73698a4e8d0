//! The illumination model of thesis chapters 3.1 to 3.3.

mod contact;
mod light;
mod optics;
mod surface;

pub use contact::Contact;
pub use light::{Incidence, illuminate, shadow_ray};
pub use optics::{Refraction, fresnel, reflect, refract};
pub use surface::{Surface, background};
