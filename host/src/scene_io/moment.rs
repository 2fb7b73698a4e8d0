//! When a scene is looked at whose files move.

/// Which animation of a glTF file its nodes follow, and when. The default is the start of the first one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moment {
    /// Without one, the first.
    pub animation: Option<AnimationWish>,
    /// Seconds after its start. Before the first key and after the last it stands still.
    pub seconds: Option<f64>,
}

/// An animation that somebody asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum AnimationWish {
    /// None: everything is where its nodes say.
    Rest,
    /// That of a name, or else of a number, counted from 0.
    Named(String),
}

impl AnimationWish {
    /// What stands for no animation.
    pub const REST: &str = "none";

    /// By a name or a number, or [`AnimationWish::REST`].
    pub fn of(text: &str) -> AnimationWish {
        if text == Self::REST { AnimationWish::Rest } else { AnimationWish::Named(text.to_owned()) }
    }
}
