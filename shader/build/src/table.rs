//! Which modules are cut from the compiled kernels.

/// What a module promises about its arithmetic.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Policy {
    /// Every float instruction is rounded as written, and none is used whose result a device may
    /// choose.
    Exact,
    /// Only protected functions are rounded as written.
    Fast,
}

/// One committed module.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Module {
    /// The file's name without its ending.
    pub name: &'static str,
    /// What the names of its entry points begin with.
    pub prefix: &'static str,
    /// What it promises.
    pub policy: Policy,
    /// Ends of the paths of functions that must survive as protected ones: `#[inline(never)]` is
    /// lost, with no more than a warning, on a function that takes a reference into a buffer or
    /// may panic, and its arithmetic is then rounded as the device likes.
    pub protects: &'static [&'static str],
}

impl Module {
    /// The file's name within `shader/spirv`.
    pub fn file(&self) -> String {
        format!("{}.spv", self.name)
    }
}

/// The watertight test, whose proof counts on every rounding.
const TRIANGLES: &[&str] = &["triangle::intersect_watertight", "triangle::straddles_origin"];

/// Every committed module.
///
/// Methods that vote have modules of their own, so that a device without subgroups takes the others.
pub const MODULES: [Module; 5] = [
    Module { name: "exact", prefix: "exact::", policy: Policy::Exact, protects: &[] },
    Module { name: "fast", prefix: "fast::", policy: Policy::Fast, protects: TRIANGLES },
    Module { name: "exact_subgroup", prefix: "subgroup_exact::", policy: Policy::Exact, protects: &[] },
    Module { name: "fast_subgroup", prefix: "subgroup_fast::", policy: Policy::Fast, protects: TRIANGLES },
    Module { name: "numerics", prefix: "numerics::", policy: Policy::Exact, protects: &[] },
];
