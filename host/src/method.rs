//! Traversal methods by name, and their options.

use eyerays_kernels_cpu::Way;
use eyerays_shader::data::{Launch, Layout as LayoutBits, Order as OrderBits, Tuning};

use crate::choice::choices;

/// Makes the enum of the shader's table of methods.
macro_rules! methods {
    ([] $(#[doc = $help:literal] $variant:ident $path:ident $name:literal:
        gpu($lanes:ident, $gpu:ty), persistent($($persistent:ty)?), cpu($($cpu:tt)*);)*) => {
        choices! {
            /// How rays are followed (thesis chapter 6.2). Every method finds the same hits.
            #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
            pub enum Method {
                /// What was measured to be fastest for the device and each kind of ray
                #[default]
                Auto = "auto",
                $(#[doc = $help] $variant = $name,)*
            }
        }

        impl Method {
            /// Every method but [`Method::Auto`], which is one of them.
            pub const ALL: [Method; [$(Method::$variant),*].len()] = [$(Method::$variant),*];

            /// Does it vote across the lanes of a subgroup?
            pub fn votes(self) -> bool {
                matches!(self.row().1, "subgroup")
            }

            /// Can it go on with another ray at any step, as persistent subgroups ask?
            pub fn is_resumable(self) -> bool {
                !self.row().2.is_empty()
            }

            /// Its kernels for a CPU.
            pub(crate) fn way(self) -> Way {
                match self {
                    Method::Auto => Way::IfIf,
                    $(Method::$variant => Way::$variant,)*
                }
            }

            /// Its part of its kernels' paths, whose lanes vote, and the type of persistent subgroups.
            fn row(self) -> (&'static str, &'static str, &'static str) {
                match self {
                    Method::Auto => Method::IfIf.row(),
                    $(Method::$variant => (stringify!($path), stringify!($lanes), stringify!($($persistent)?)),)*
                }
            }
        }
    };
}
eyerays_shader::for_each_method!(methods);

/// How a method's rays are followed on a CPU, from the shader's table: by the functions that are called `alone`, `together` and `plainly`
/// where this stands, and by the given one where a CPU walks nodes of eight.
#[doc(hidden)]
#[macro_export]
macro_rules! follower {
    ([$method:ident $nodes:expr] $(#[$help:meta] $variant:ident $path:ident $name:literal:
        gpu($($gpu:tt)*), persistent($($persistent:tt)*), cpu($way:ident $(, $type:ty)?);)*) => {
        match $method {
            $crate::method::Method::Auto => alone::<IfIf>,
            $($crate::method::Method::$variant => $crate::follower!(@ $nodes, $way $(, $type)?),)*
        }
    };
    (@ $nodes:expr, nodes) => { $nodes };
    (@ $nodes:expr, $way:ident, $type:ty) => { $way::<$type> };
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

impl Order {
    /// The constant of kernels.
    pub fn bits(self) -> OrderBits {
        OrderBits(match self {
            Order::Tiled => 0,
            Order::Linear => OrderBits::LINEAR,
            Order::Morton => OrderBits::MORTON,
        })
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

impl Layout {
    /// Bits of the constant of kernels, see [`LayoutBits`].
    pub fn bits(self) -> u32 {
        match self {
            Layout::Gathered => 0,
            Layout::Indexed => LayoutBits::INDEXED,
            Layout::Compact => LayoutBits::COMPACT,
        }
    }
}

choices! {
    /// How a ray is tested against a triangle.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum TriangleTest {
        /// No ray slips between two triangles that share an edge (Woop, Benthin and Wald 2013)
        #[default]
        Watertight = "watertight",
        /// The test of Moeller and Trumbore (1997), which lets some rays through: a GPU's fast precision only
        Moller = "moller",
    }
}

impl TriangleTest {
    /// Bits of the constant of kernels, see [`Launch`].
    pub fn bits(self) -> u32 {
        match self {
            TriangleTest::Watertight => 0,
            TriangleTest::Moller => Launch::MOLLER,
        }
    }
}

/// A method and its switches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Traversal {
    /// How rays are followed.
    pub method: Method,
    /// When a hybrid's packet splits.
    pub tuning: Tuning,
    /// How rays are distributed to subgroups; a CPU has none.
    pub scheduling: Scheduling,
    /// Which pixels' rays lie beside each other.
    pub order: Order,
    /// How the hierarchy and its triangles lie in memory.
    pub layout: Layout,
    /// How a ray is tested against a triangle; always the watertight way on a CPU and in exact precision.
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

    /// Its part of the paths of its kernels.
    pub(crate) fn path(&self) -> String {
        let persistent = if self.scheduling == Scheduling::Persistent { "persistent::" } else { "" };
        format!("{persistent}{}::", self.method.row().0)
    }

    /// Do its kernels vote across the lanes of a subgroup?
    pub fn votes(&self) -> bool {
        self.method.votes() || self.scheduling == Scheduling::Persistent
    }
}
