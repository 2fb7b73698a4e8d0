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
    /// A layer of it, in colours that tell its numbers apart.
    Layer(Layer),
}

impl Named for Shows {
    const VARIANTS: &'static [Shows] = &[
        Shows::Light,
        Shows::Layer(Layer::Albedo),
        Shows::Layer(Layer::Normal),
        Shows::Layer(Layer::Depth),
        Shows::Layer(Layer::Object),
        Shows::Layer(Layer::Material),
        Shows::Layer(Layer::Visits),
        Shows::Layer(Layer::Tests),
        Shows::Layer(Layer::Error),
        Shows::Layer(Layer::Samples),
    ];

    fn name(self) -> &'static str {
        match self {
            Shows::Light => "light",
            Shows::Layer(layer) => layer.name(),
        }
    }

    fn help(self) -> &'static str {
        match self {
            Shows::Light => "The picture itself",
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
    /// Is it told by samples, so that it changes with them?
    pub(crate) fn is_of_film(self) -> bool {
        matches!(self, Shows::Layer(Layer::Error | Layer::Samples))
    }
}
