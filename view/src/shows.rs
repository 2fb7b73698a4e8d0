//! What a picture shows: light, or what tells how it is made.

use std::fmt;

use eyerays::choice::Named;
use eyerays::layers::Layer;

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shows {
    /// The picture itself.
    #[default]
    Light,
    /// The picture with its noise taken off.
    Denoised,
    /// A layer of it, in colours that tell its numbers apart.
    Layer(Layer),
    /// The edges of triangles, those that are seen.
    Wires,
}

impl Named for Shows {
    const VARIANTS: &'static [Shows] = &[
        Shows::Light,
        Shows::Denoised,
        Shows::Layer(Layer::Albedo),
        Shows::Layer(Layer::Normal),
        Shows::Layer(Layer::Depth),
        Shows::Layer(Layer::Object),
        Shows::Layer(Layer::Material),
        Shows::Layer(Layer::Primitive),
        Shows::Wires,
        Shows::Layer(Layer::Visits),
        Shows::Layer(Layer::Tests),
        Shows::Layer(Layer::Deepest),
        Shows::Layer(Layer::Idle),
        Shows::Layer(Layer::Error),
        Shows::Layer(Layer::Samples),
    ];

    fn name(self) -> &'static str {
        match self {
            Shows::Light => "light",
            Shows::Denoised => "denoised",
            Shows::Wires => "wireframe",
            Shows::Layer(layer) => layer.name(),
        }
    }

    fn help(self) -> &'static str {
        match self {
            Shows::Light => "The picture itself",
            Shows::Denoised => "The picture with its noise taken off",
            Shows::Wires => "The edges of triangles, those that are seen",
            Shows::Layer(layer) => layer.help(),
        }
    }
}

impl fmt::Display for Shows {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

impl Shows {
    /// Is it the picture, or told by its samples, so that it changes with them?
    pub(crate) fn is_of_film(self) -> bool {
        matches!(self, Shows::Light | Shows::Denoised | Shows::Layer(Layer::Error | Layer::Samples))
    }

    /// The layers that it takes.
    pub(crate) fn layers(self) -> Vec<Layer> {
        match self {
            Shows::Light | Shows::Denoised => Vec::new(),
            Shows::Layer(layer) => vec![layer],
            Shows::Wires => vec![Layer::Normal, Layer::Primitive],
        }
    }
}
