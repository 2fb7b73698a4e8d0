//! Where rays are followed: on the CPU, and on a GPU in exact and in fast precision.

use std::fmt;
use std::sync::LazyLock;

use eyerays::cpu;
use eyerays::gpu::{AdapterRequest, Caster, Gpu, Renderer};
use eyerays::job::Job;
use eyerays::method::{Layout, Method, Scheduling, Traversal};
use eyerays::picture::Picture;
use eyerays::rays::Rays;
use eyerays::stream::{Answers, Question, Stream};
use glam::UVec4;

use crate::{Posed, gpu, traversals};

static GPU: LazyLock<Option<Gpu>> = LazyLock::new(|| gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }));

/// A device in a precision. Without a GPU there is the CPU alone.
#[derive(Clone, Copy)]
pub struct Machine {
    gpu: Option<&'static Gpu>,
    /// Is it exact precision? A CPU's always is.
    pub exact: bool,
}

impl fmt::Display for Machine {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let device = if self.gpu.is_some() { "gpu" } else { "cpu" };
        write!(out, "{device} {}", if self.exact { "exact" } else { "fast" })
    }
}

impl Machine {
    /// The CPU in exact precision.
    pub const CPU: Machine = Machine { gpu: None, exact: true };

    /// Every one.
    pub fn all() -> Vec<Machine> {
        let gpu = GPU.as_ref().into_iter().flat_map(|gpu| [true, false].map(|exact| Machine { gpu: Some(gpu), exact }));
        std::iter::once(Machine::CPU).chain(gpu).collect()
    }

    /// Is it a GPU of software, which ends loops after 65,535 rounds (lavapipe), and compiles kernels slowly?
    pub fn is_software(&self) -> bool {
        self.gpu.is_some_and(|gpu| gpu.report.is_software())
    }

    /// Is it a CPU?
    pub fn is_cpu(&self) -> bool {
        self.gpu.is_none()
    }

    /// The ways through a hierarchy that a test takes on it: all on a CPU; a software GPU is given few, for each of
    /// which it compiles a kernel.
    pub fn traversals(&self) -> Vec<Traversal> {
        match self.gpu {
            None => traversals(),
            _ if self.is_software() => {
                [Method::Wide, Method::IfIf].map(|m| Traversal { scheduling: Scheduling::Grid, ..m.into() }).into()
            }
            _ => traversals().into_iter().filter(|t| t.layout == Layout::Gathered).collect(),
        }
    }

    /// Gets a scene ready for streams of rays.
    ///
    /// # Panics
    /// If the GPU can't hold it.
    pub fn tracer<'a>(self, packed: &'a Job) -> Tracer<'a> {
        let caster = |gpu| Caster::new(gpu, packed, Layout::Gathered).unwrap_or_else(|e| panic!("{self}: {e}"));
        Tracer { machine: self, packed, caster: self.gpu.map(caster) }
    }

    /// Renders by the default method.
    ///
    /// # Panics
    /// If the device can't.
    pub fn render(&self, posed: &Posed) -> (Picture, Rays) {
        let (packed, view, traversal) = (&posed.packed, &posed.view, Traversal::default());
        let rendered = match self.gpu {
            None => cpu::render::<f32>(packed, view, traversal, 0, &|_| ()),
            Some(gpu) => Renderer::new(gpu, packed, self.exact, traversal)
                .and_then(|mut renderer| renderer.render(view, &|_| ()))
                .and_then(|rendering| Ok((rendering.film.develop()?, rendering.film.rays()))),
        };
        rendered.unwrap_or_else(|e| panic!("{self}: {e}"))
    }
}

/// A scene on a machine.
pub struct Tracer<'a> {
    machine: Machine,
    packed: &'a Job,
    caster: Option<Caster>,
}

impl Tracer<'_> {
    /// The closest hits of a stream: the bits of (t, u, v), and the slot of the triangle.
    ///
    /// # Panics
    /// If the device can't.
    pub fn closest(&self, traversal: Traversal, stream: &Stream) -> Vec<UVec4> {
        let question = Question::Closest;
        let answers = match &self.caster {
            Some(caster) => caster.upload(stream).and_then(|cast| {
                caster.trace(&cast, self.machine.exact, traversal, question)?;
                caster.answers(&cast, question)
            }),
            None => cpu::cast(self.packed, traversal, 0, stream, question).map(|(a, _)| a),
        };
        match answers {
            Ok(Answers::Closest(hits)) => hits,
            Ok(Answers::Occlusion(_)) => unreachable!("the closest hits were asked for"),
            Err(e) => panic!("{}, {traversal:?}: {e}", self.machine),
        }
    }
}
