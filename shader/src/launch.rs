//! What host and entry points agree on beside the tables: workgroups, and the counters of a wave.

/// Threads of a workgroup.
pub const WORKGROUP: u32 = 64;

/// Threads of a row of a launch that follows a stream: more than one row, since a launch has at most 65,535
/// workgroups a dimension.
pub const ROW: u32 = 1 << 21;

/// Places in the buffer of a wave's indirect dispatches.
pub mod argument {
    /// Three words: a thread a slot. A wave changes the first of them.
    pub const SLOTS: u32 = 0;
    /// Three words: a thread for each shadow ray that a slot may ask for. A wave changes the first of them.
    pub const SHADOWS: u32 = 4;
    /// Words in all.
    pub const LENGTH: u32 = 8;
}

/// Places in the buffer of counters.
pub mod counter {
    /// How many slots this wave has.
    pub const COUNT: u32 = 0;
    /// How many slots the next wave has so far; 0 again at the end of a launch.
    pub const NEXT: u32 = 1;
    /// Rays that persistent subgroups have taken to trace in this wave.
    pub const TRACED: u32 = 2;
    /// Shadow rays that they have taken.
    pub const ASKED: u32 = 3;
    /// Waves of this launch that had rays, but for the first.
    pub const WAVES: u32 = 4;
    /// Words that every launch starts with as zeros.
    pub const LAUNCH: u32 = 5;
    /// Secondary rays of all launches since the host set it to 0, which it does before there may be 2^32.
    pub const RAYS: u32 = 5;
    /// Words in all.
    pub const LENGTH: u32 = 8;
}
