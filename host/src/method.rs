//! Ways through the hierarchy, by name.

use eyerays_shader::modules;

/// How rays are followed (thesis chapter 6.2). Every method finds the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Method {
    /// Every ray by itself, one pair of boxes and one triangle at a time
    #[default]
    IfIf,
    /// The rays of a subgroup together, by votes; on the CPU packets of one
    Packet,
}

impl Method {
    /// Every method.
    pub const ALL: [Method; 2] = [Method::IfIf, Method::Packet];

    /// Does it vote across the lanes of a subgroup?
    pub fn votes(self) -> bool {
        self == Method::Packet
    }

    /// Its part of an entry point's name.
    pub(crate) fn entry(self) -> &'static str {
        match self {
            Method::IfIf => "if_if",
            Method::Packet => "packet",
        }
    }

    /// The module with its kernels, and how their names begin.
    pub(crate) fn module(self, exact: bool) -> (&'static [u8], &'static str) {
        match (exact, self.votes()) {
            (true, false) => (modules::EXACT, "exact"),
            (false, false) => (modules::FAST, "fast"),
            (true, true) => (modules::EXACT_SUBGROUP, "subgroup_exact"),
            (false, true) => (modules::FAST_SUBGROUP, "subgroup_fast"),
        }
    }
}
