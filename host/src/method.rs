//! Ways through the hierarchy, by name, and the switches around them.

use eyerays_shader::data::{Features, Tuning};

use crate::choice::choices;

choices! {
    /// How rays are followed (thesis chapter 6.2). Every method finds the same hits.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Method {
        /// What was measured to be fastest for the device and each kind of ray
        #[default]
        Auto = "auto",
        /// Every ray by itself, one pair of boxes and one triangle at a time
        IfIf = "if-if",
        /// Every ray by itself, pairs of boxes until it is at a leaf
        WhileWhile = "while-while",
        /// As while-while, but on past a leaf until every ray of a subgroup has one
        Speculative = "speculative",
        /// Every ray by itself, through nodes of eight boxes: on a GPU quantised ones (CWBVH)
        Wide = "wide",
        /// The rays of a subgroup together, by votes
        Packet = "packet",
        /// Together until a small stack is full, then each ray by itself
        SequentialStack = "sequential-stack",
        /// Together where enough rays want a node, the others of it in the end by themselves
        SequentialCut = "sequential-cut",
        /// Together until a small stack is full, each ray by itself below
        InterleavedStack = "interleaved-stack",
        /// Together where enough rays want a node, else each ray by itself below it
        InterleavedCut = "interleaved-cut",
    }
}

impl Method {
    /// Every method but [`Method::Auto`], which is one of them.
    pub const ALL: [Method; 9] = [
        Method::IfIf,
        Method::WhileWhile,
        Method::Speculative,
        Method::Wide,
        Method::Packet,
        Method::SequentialStack,
        Method::SequentialCut,
        Method::InterleavedStack,
        Method::InterleavedCut,
    ];

    /// Does it vote across the lanes of a subgroup?
    pub fn votes(self) -> bool {
        !matches!(self, Method::IfIf | Method::WhileWhile | Method::Wide)
    }

    /// Can it go on with another ray at any step, as persistent subgroups ask?
    pub fn is_resumable(self) -> bool {
        !self.votes()
    }

    /// Its part of an entry point's name.
    fn entry(self) -> &'static str {
        match self {
            Method::Auto | Method::IfIf => "if_if",
            Method::WhileWhile => "while_while",
            Method::Speculative => "speculative",
            Method::Wide => "wide",
            Method::Packet => "packet",
            Method::SequentialStack => "sequential_stack",
            Method::SequentialCut => "sequential_cut",
            Method::InterleavedStack => "interleaved_stack",
            Method::InterleavedCut => "interleaved_cut",
        }
    }
}

choices! {
    /// How a GPU's subgroups come by their rays (thesis 6.1).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Scheduling {
        /// What was measured to be fastest for the method and each kind of ray
        #[default]
        Auto = "auto",
        /// A thread a ray
        Grid = "grid",
        /// As many threads as the GPU holds, which take new rays when they are done
        Persistent = "persistent",
    }
}

choices! {
    /// Which pixels' rays lie beside each other (thesis 6.1).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Order {
        /// Blocks of 8x4 pixels, row by row
        #[default]
        Tiled = "tiled",
        /// Pixels row by row
        Linear = "linear",
        /// Pixels along a Morton curve in squares of 64
        Morton = "morton",
    }
}

choices! {
    /// How the hierarchy and its triangles lie in memory.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Layout {
        /// Each triangle with its vertices, in the order of the hierarchy
        #[default]
        Gathered = "gathered",
        /// Three indices a triangle, and the vertices once
        Indexed = "indexed",
        /// As gathered, and the boxes of pairs of nodes on a grid of 16 bits
        Compact = "compact",
    }
}

choices! {
    /// How a ray is tested against a triangle.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum TriangleTest {
        /// No ray slips between two triangles that share an edge (Woop, Benthin and Wald 2013)
        #[default]
        Watertight = "watertight",
        /// The test of Moeller and Trumbore (1997), which lets some rays through: fast precision only
        Moller = "moller",
    }
}

/// A method and its switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Traversal {
    /// How rays are followed.
    pub method: Method,
    /// When a hybrid's packet parts.
    pub tuning: Tuning,
    /// How subgroups come by their rays; a CPU has none.
    pub scheduling: Scheduling,
    /// Which pixels' rays lie beside each other.
    pub order: Order,
    /// How the hierarchy and its triangles lie in memory.
    pub layout: Layout,
    /// How a ray is tested against a triangle; in exact and reference precision always the watertight way.
    pub triangle: TriangleTest,
}

impl From<Method> for Traversal {
    fn from(method: Method) -> Self {
        Traversal { method, ..Traversal::default() }
    }
}

/// What kind of processor follows the rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Processor {
    /// Through wgpu.
    Gpu,
    /// By threads.
    Cpu,
}

/// How alike neighbouring rays are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Coherence {
    /// From one point, side by side: primary rays.
    Primary,
    /// From neighbouring places to one point: shadow rays of primary hits.
    Shadow,
    /// Mirrored or refracted, and the shadow rays of their hits.
    Secondary,
    /// Every way, as the light that surfaces scatter.
    Scattered,
}

impl Traversal {
    /// The bits that kernels are specialised for.
    pub fn features(&self) -> Features {
        let order = match self.order {
            Order::Tiled => 0,
            Order::Linear => Features::LINEAR,
            Order::Morton => Features::MORTON,
        };
        let layout = match self.layout {
            Layout::Gathered => 0,
            Layout::Indexed => Features::INDEXED,
            Layout::Compact => Features::COMPACT,
        };
        let triangle = match self.triangle {
            TriangleTest::Watertight => 0,
            TriangleTest::Moller => Features::MOLLER,
        };
        Features(order | layout | triangle)
    }

    /// The method and scheduling that [`Method::Auto`] and [`Scheduling::Auto`] stand for: the fastest of
    /// docs/benchmarks.md.
    pub fn resolved(self, processor: Processor, coherence: Coherence) -> Traversal {
        let method = match (self.method, processor, coherence) {
            (Method::Auto, Processor::Cpu, Coherence::Primary) => Method::Packet,
            (Method::Auto, Processor::Cpu, _) => Method::Wide,
            (Method::Auto, Processor::Gpu, Coherence::Shadow) => Method::IfIf,
            (Method::Auto, Processor::Gpu, _) => Method::WhileWhile,
            (chosen, ..) => chosen,
        };
        let scheduling = match (self.scheduling, processor, coherence) {
            _ if !method.is_resumable() => Scheduling::Grid,
            (Scheduling::Auto, Processor::Gpu, Coherence::Scattered) => Scheduling::Persistent,
            (Scheduling::Auto, ..) => Scheduling::Grid,
            (chosen, ..) => chosen,
        };
        Traversal { method, scheduling, ..self }
    }

    /// Its kernels' part of an entry point's name.
    pub(crate) fn entry(&self) -> String {
        let persistent = if self.scheduling == Scheduling::Persistent { "_persistent" } else { "" };
        format!("{}{persistent}", self.method.entry())
    }

    /// Do its kernels vote across the lanes of a subgroup?
    pub fn votes(&self) -> bool {
        self.method.votes() || self.scheduling == Scheduling::Persistent
    }
}
