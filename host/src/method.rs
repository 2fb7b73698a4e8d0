//! Ways through the hierarchy, by name.

use eyerays_shader::data::Tuning;
use eyerays_shader::modules;

/// How rays are followed (thesis chapter 6.2). Every method finds the same hits.
///
/// On the CPU a ray is a packet of its own, so that methods that vote become their single-ray kin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Method {
    /// Every ray by itself, one pair of boxes and one triangle at a time
    #[default]
    IfIf,
    /// Every ray by itself, pairs of boxes until it is at a leaf
    WhileWhile,
    /// As while-while, but on past a leaf until every ray of a subgroup has one
    Speculative,
    /// The rays of a subgroup together, by votes
    Packet,
    /// Together until a small stack is full, then each ray by itself
    SequentialStack,
    /// Together where enough rays want a node, the others of it in the end by themselves
    SequentialCut,
    /// Together until a small stack is full, each ray by itself below
    InterleavedStack,
    /// Together where enough rays want a node, else each ray by itself below it
    InterleavedCut,
}

impl Method {
    /// Every method.
    pub const ALL: [Method; 8] = [
        Method::IfIf,
        Method::WhileWhile,
        Method::Speculative,
        Method::Packet,
        Method::SequentialStack,
        Method::SequentialCut,
        Method::InterleavedStack,
        Method::InterleavedCut,
    ];

    /// Does it vote across the lanes of a subgroup?
    pub fn votes(self) -> bool {
        !matches!(self, Method::IfIf | Method::WhileWhile)
    }

    /// Its part of an entry point's name.
    pub(crate) fn entry(self) -> &'static str {
        match self {
            Method::IfIf => "if_if",
            Method::WhileWhile => "while_while",
            Method::Speculative => "speculative",
            Method::Packet => "packet",
            Method::SequentialStack => "sequential_stack",
            Method::SequentialCut => "sequential_cut",
            Method::InterleavedStack => "interleaved_stack",
            Method::InterleavedCut => "interleaved_cut",
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

/// A method, and when it parts if it is a hybrid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Traversal {
    /// How rays are followed.
    pub method: Method,
    /// When a hybrid's packet parts.
    pub tuning: Tuning,
}

impl From<Method> for Traversal {
    fn from(method: Method) -> Self {
        Traversal { method, tuning: Tuning::default() }
    }
}
