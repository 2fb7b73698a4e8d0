//! What host and entry points agree on: bindings, workgroups, and the counters of a wave.

/// Threads of a workgroup.
pub const WORKGROUP: u32 = 64;

/// Threads of a row of a launch that follows a stream: more than one row, since a launch has at most 65,535
/// workgroups a dimension.
pub const ROW: u32 = 1 << 21;

/// Bindings of descriptor set 0, the same for every stage.
pub mod binding {
    /// The [`Frame`](crate::data::Frame), uniform.
    pub const FRAME: u32 = 0;
    /// Child pairs.
    pub const NODES: u32 = 1;
    /// Triangles.
    pub const TRIANGLES: u32 = 2;
    /// Vertex normals.
    pub const NORMALS: u32 = 3;
    /// Materials.
    pub const MATERIALS: u32 = 4;
    /// Lights.
    pub const LIGHTS: u32 = 5;
    /// Paths.
    pub const PATHS: u32 = 6;
    /// Hit records.
    pub const HITS: u32 = 7;
    /// Shadow answers.
    pub const SHADOWS: u32 = 8;
    /// The film.
    pub const FILM: u32 = 9;
    /// Slots of this wave.
    pub const QUEUE: u32 = 10;
    /// Slots of the next wave.
    pub const NEXT: u32 = 11;
    /// The [`counter`](crate::launch::counter)s.
    pub const COUNTERS: u32 = 12;
    /// Nodes of eight children.
    pub const WIDE: u32 = 13;
    /// Bounds of the parts of split triangles.
    pub const BOUNDS: u32 = 14;
    /// How many bindings there are.
    pub const COUNT: u32 = 15;
}

/// Places in the buffer of counters.
pub mod counter {
    /// Three words for an indirect dispatch of one thread a slot.
    pub const SLOTS: u32 = 0;
    /// How many slots this wave has.
    pub const COUNT: u32 = 3;
    /// Three words for an indirect dispatch of one thread a slot and light.
    pub const SHADOWS: u32 = 4;
    /// How many slots the next wave has so far.
    pub const NEXT: u32 = 7;
    /// Secondary rays of this launch.
    pub const RAYS: u32 = 8;
    /// Rays that persistent subgroups have taken to trace in this wave.
    pub const TRACED: u32 = 9;
    /// Shadow rays that they have taken.
    pub const ASKED: u32 = 10;
    /// Words in all.
    pub const LENGTH: u32 = 12;
}

/// The specialisation constant that holds the scene's [`Features`](crate::data::Features).
pub const FEATURES_ID: u32 = 1;
/// The specialisation constant that holds the [`Tuning`](crate::data::Tuning).
pub const TUNING_ID: u32 = 2;
