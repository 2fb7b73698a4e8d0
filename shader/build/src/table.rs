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

impl Policy {
    /// The feature of the kernels' crate that has the kernels of this policy, by which the folder of what is built is named, too.
    /// The compiler has one thread, so that those of each are compiled beside the others.
    pub fn feature(self) -> &'static str {
        match self {
            Policy::Exact => "exact",
            Policy::Fast => "fast",
        }
    }
}

/// One committed module.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Module {
    /// The file's name without its ending.
    pub name: &'static str,
    /// What the names of its entry points begin with: any of these.
    pub prefixes: &'static [&'static str],
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
const TRIANGLES: &[&str] = &["triangle::intersect_watertight", "edge_on::cut"];

/// Every committed module. A kernel that is cut out of one asks a device only for what it uses itself.
pub const MODULES: [Module; 5] = [
    Module { name: "exact", prefixes: &["exact::", "subgroup_exact::"], policy: Policy::Exact, protects: &[] },
    Module { name: "fast", prefixes: &["fast::", "subgroup_fast::"], policy: Policy::Fast, protects: TRIANGLES },
    Module { name: "numerics", prefixes: &["numerics::"], policy: Policy::Exact, protects: &[] },
    Module { name: "refit", prefixes: &["refit::"], policy: Policy::Exact, protects: &[] },
    Module { name: "screen", prefixes: &["screen::"], policy: Policy::Exact, protects: &[] },
];
