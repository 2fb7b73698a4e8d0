//! When a scene is looked at whose files move.

/// Which animation of a glTF file its nodes follow, and when. The default is the start of the first one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moment {
    /// Without one, the first.
    pub animation: Option<AnimationWish>,
    /// Seconds after its start. Before the first key and after the last it stands still.
    pub seconds: Option<f64>,
}

/// When the shutter is open (thesis 3.4.7), in seconds after the moment of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// Its opening; may be before.
    pub open: f64,
    /// Its closing, not before it opens. What is open for no time shows no motion.
    pub close: f64,
    /// The share of that time for which each row of a picture is exposed, from the top to the bottom, as cameras of telephones do: 1
    /// for all rows at once.
    pub rolling: f64,
}

impl Shutter {
    /// One that is open for no time.
    pub const CLOSED: Shutter = Shutter { open: 0.0, close: 0.0, rolling: 1.0 };

    /// Is it open at all?
    pub fn is_open(&self) -> bool {
        self.open < self.close
    }

    /// The moment after a share of its time.
    pub fn at(&self, share: f64) -> f64 {
        self.open + (self.close - self.open) * share
    }
}

/// What of a scene is read, whose pictures may take some time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Instant {
    /// It, as it is at its moment.
    #[default]
    Alone,
    /// The same, with what may move as instances of meshes, for [`Scene::over`](crate::scene::Scene::over).
    Opening,
    /// Only where its surfaces and cameras are, likewise: no pictures.
    Later,
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
