//! What the command says to what the library reports: the fault, and the option that helps.

use eyerays::error::{Content, Error};
use eyerays::method::Processor;
use eyerays::render::{Rendering, Why};

/// A fault without its place, and its remedy.
pub fn worded(error: &Error) -> String {
    let remedy = match error.fault() {
        Error::NoHalf { format } => {
            return format!("--half is for .exr files, not for {format}; leave it out or write .exr");
        }
        Error::NoTone { format } => {
            return format!("--tone is for .png files, not for {format}; leave it out or write .png");
        }
        Error::NoAlpha { format } => {
            return format!("--transparent is for .png and .exr files, not for {format}; leave it out or write .exr");
        }
        Error::NoLayers { format } => {
            return format!("--layers is for .exr files, not for {format}; leave it out or write .exr");
        }
        Error::NoNoise { .. } => ": drop --noise, or use --integrator path",
        Error::Threads { .. } => ": ask for fewer",
        Error::SeveralInexact => ": drop --precision, or name one --device",
        Error::ReferenceOnGpu => ": use --device cpu, or --precision exact",
        Error::NoGpu => ", or use --device cpu",
        Error::OnlySoftware { .. } => ", which --device gpu takes",
        Error::Inexact { .. } => ": use --precision fast or --device cpu",
        Error::NoSubgroups { .. } => ": use --method if-if --scheduling grid",
        Error::TooManyLights { .. } => ": remove some, or use --device cpu",
        Error::TooLarge { what: Content::Scene(_), .. } => ": use --device cpu",
        Error::TooLarge { what: Content::Block, .. } => ": lower --bounces, remove lights, or use --device cpu",
        Error::TooLarge { what: Content::Rays(_), .. } => ": use a smaller --size",
        Error::NotOpened { .. } | Error::DeviceFailed { .. } => "; use --device cpu",
        // The others name what is to be changed, in the words of the file or the option that they are of.
        _ => "",
    };
    error.message() + remedy
}

/// Why a rendering ran where it did.
pub fn why(rendering: &Rendering) -> String {
    if rendering.device.contains(" + ") {
        return "--device".to_owned();
    }
    match (&rendering.why, rendering.processor) {
        (Why::Asked, Processor::Gpu) => "--device gpu".to_owned(),
        (Why::Asked, Processor::Cpu) => "--device cpu".to_owned(),
        (Why::Instead(error), _) => worded(error),
        (other, _) => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is matched on may change; what people read stays.
    #[test]
    fn faults_end_with_the_option_that_helps() {
        let device = || "a GPU".to_owned();
        for (error, line) in [
            (
                Error::NoGpu,
                "there is no GPU that Vulkan, Metal or Direct3D 12 can use: install its driver, or use --device cpu",
            ),
            (
                Error::OnlySoftware { device: device() },
                "no hardware GPU; \"a GPU\" is software, which --device gpu takes",
            ),
            (
                Error::Inexact { device: device(), by_naga: false },
                "exact precision needs Vulkan with SPIR-V passthrough, which \"a GPU\" is without: use --precision \
                 fast or --device cpu",
            ),
            (
                Error::TooLarge { device: device(), what: Content::Rays(3), bytes: 96, limit: 64 },
                "3 rays take 96 bytes, but \"a GPU\" has buffers of at most 64: use a smaller --size",
            ),
            (Error::new("the light is too far away"), "the light is too far away"),
        ] {
            assert_eq!(worded(&error), line);
            let of_file = crate::error::Error::from(error.of("scene.toml".as_ref()));
            assert_eq!(of_file.to_string(), format!("scene.toml: {line}"));
        }
    }
}
