//! The numbers that pictures are rendered with, and the stages over them.

use eyerays_shader::camera;
use eyerays_shader::data::{Frame, Launch, Light, Material, Medium, Specialisation};
use eyerays_shader::integrator::{self, Exchange, ScatterContext, Wave};
use eyerays_shader::light::Lighting;
use eyerays_shader::photon::{Casters, Photons};
use eyerays_shader::real::{Scalar, SimdIsa, Task};
use eyerays_shader::scene::{LaunchContext, ShadingData, TraceContext};
use eyerays_shader::stage::{self, CameraTables, FilmWords, Found, TransmitInputs};
use eyerays_shader::traverse::{Primitives, WhileWhile};
use eyerays_shader::warp::Alone;
use glam::UVec4;

use crate::follow::{Query, follow};
use crate::isa::Isa;
use crate::records::Records;
use crate::way::Way;

/// The slots of a wave, and of the one after it.
pub struct Queues<'a> {
    /// Those of this one.
    pub now: &'a [u32],
    /// Those of the next are added here.
    pub next: &'a mut Vec<u32>,
}

/// What shading sees of a scene.
pub struct Shown<'a> {
    /// The launch.
    pub launch: LaunchContext<'a>,
    /// What surfaces look like.
    pub shading: ShadingData<'a>,
    /// Lights in file order.
    pub lights: &'a [Light],
    /// Light from far away.
    pub environment: &'a [u32],
}

/// What is between surfaces.
pub struct Between<'a> {
    /// What surfaces are filled with.
    pub materials: &'a [Material],
    /// Media by their numbers.
    pub media: &'a [Medium],
    /// Where they are denser.
    pub grids: &'a [u32],
    /// What light of single wavelengths does.
    pub spectra: &'a [UVec4],
}

/// A number that every stage is compiled for: `f32` and, for references, `f64`. A CPU has no faster division or root to give up
/// exactness for.
///
/// Queues are less than the launch's; records are as long as its kernels ask, see [`eyerays_shader::resources`].
pub trait Number: Scalar<Record: Send + Sync> {
    /// Starts the paths of some slots, by the tables of cameras.
    fn generate(
        frame: &Frame,
        spec: Specialisation,
        tables: CameraTables<'_>,
        slots: &[u32],
        records: &mut Records<Self>,
    );

    /// Follows the rays of some slots, with the instructions of an [`Isa`].
    fn follow(isa: Isa, way: Way, geometry: &TraceContext<'_>, slots: &[u32], query: Query<'_, Self>);

    /// Finds the next crossings of some rays of a stream, each past the one that is told of it.
    fn cross(geometry: &TraceContext<'_>, slots: &[u32], stream: &[Self::Record], found: &mut [Found<Self>]);

    /// Finds the triangles that are nearest to where some rays of a stream start.
    fn nearest(geometry: &TraceContext<'_>, slots: &[u32], stream: &[Self::Record], found: &mut [Found<Self>]);

    /// Shades a wave.
    fn shade(scene: &Shown<'_>, queues: Queues<'_>, records: &mut Records<Self>);

    /// Scatters the paths of a wave, which look for photons, with the instructions of an [`Isa`].
    fn scatter(
        isa: Isa,
        launch: &LaunchContext<'_>,
        context: &ScatterContext<'_>,
        of: (Queues<'_>, Photons<'_>),
        records: &mut Records<Self>,
    );

    /// Starts the photons of some slots.
    fn emit(
        launch: &LaunchContext<'_>,
        lighting: &Lighting<'_>,
        casters: &Casters<'_>,
        slots: &[u32],
        records: &mut Records<Self>,
    );

    /// Dims the light of a wave's shadow rays by what is between surfaces.
    fn transmit(scene: &TraceContext<'_>, of: &Between<'_>, slots: &[u32], records: &mut Records<Self>);

    /// Adds what slots have summed to the film.
    fn gather(frame: &Frame, spec: Specialisation, records: &Records<Self>, film: &mut [u32]);

    /// The same, with the light that their last vertices waited for.
    fn accumulate(frame: &Frame, spec: Specialisation, records: &mut Records<Self>, film: &mut [u32]);
}

/// Compiles every stage for a number.
macro_rules! number {
    ($($number:ty)*) => {
        $(impl Number for $number {
            fn generate(
                frame: &Frame,
                spec: Specialisation,
                tables: CameraTables<'_>,
                slots: &[u32],
                Records { paths, hits, .. }: &mut Records<Self>,
            ) {
                for &slot in slots {
                    stage::generate::<Self>(frame, spec, tables, slot, (&mut *paths, &mut *hits));
                }
            }

            fn follow(isa: Isa, way: Way, geometry: &TraceContext<'_>, slots: &[u32], query: Query<'_, Self>) {
                follow(isa, way, geometry, slots, query);
            }

            fn cross(geometry: &TraceContext<'_>, slots: &[u32], stream: &[Self::Record], found: &mut [Found<Self>]) {
                for (&slot, found) in slots.iter().zip(found) {
                    *found = stage::cross::<Self, WhileWhile<Alone>>(geometry, (slot, *found), stream);
                }
            }

            fn nearest(geometry: &TraceContext<'_>, slots: &[u32], stream: &[Self::Record], found: &mut [Found<Self>]) {
                for (&slot, found) in slots.iter().zip(found) {
                    *found = stage::nearest::<Self>(&geometry.hierarchy(), slot, stream);
                }
            }

            fn shade(scene: &Shown<'_>, queues: Queues<'_>, records: &mut Records<Self>) {
                let Shown { launch, shading, lights, environment } = scene;
                let Records { paths, hits, shadows, sums, .. } = records;
                queues.next.extend(queues.now.iter().filter(|&&slot| {
                    let wave = Wave::<Self> { paths: &mut *paths, hits, shadows, lights, environment, sums: &mut *sums };
                    integrator::shade(launch, shading, slot, wave)
                }));
            }

            fn scatter(
                isa: Isa,
                launch: &LaunchContext<'_>,
                context: &ScatterContext<'_>,
                (queues, photons): (Queues<'_>, Photons<'_>),
                records: &mut Records<Self>,
            ) {
                isa.run(Scatter { launch, context, queues, photons, records });
            }

            fn emit(
                launch: &LaunchContext<'_>,
                lighting: &Lighting<'_>,
                casters: &Casters<'_>,
                slots: &[u32],
                Records { paths, hits, landed, .. }: &mut Records<Self>,
            ) {
                for &slot in slots {
                    let records = (&mut paths[..], &mut hits[..], &mut landed[..]);
                    integrator::emit::<Self>(launch, lighting, casters, slot, records);
                }
            }

            fn transmit(
                scene: &TraceContext<'_>,
                &Between { materials, media, grids, spectra }: &Between<'_>,
                slots: &[u32],
                Records { paths, hits, shadows, segments, .. }: &mut Records<Self>,
            ) {
                for &slot in slots {
                    let time = Found::<Self>::time(&scene.base, slot, hits);
                    let inputs = TransmitInputs { paths, shadows, materials, media, grids, spectra };
                    stage::transmit::<Self, WhileWhile<Alone>, Primitives>(scene, inputs, (slot, time), segments);
                }
            }

            fn gather(frame: &Frame, spec: Specialisation, records: &Records<Self>, film: &mut [u32]) {
                let sample = |slot: u32| stage::Sample::of(Self::load(records.sums[slot as usize]));
                for slot in 0..frame.pixel_slots {
                    let pixel = camera::pixel(frame, spec.order, slot);
                    let words = FilmWords::of_light(stage::film_words(spec.launch, false));
                    stage::expose::<Self>(frame, (pixel, slot), words, sample, film);
                }
            }

            fn accumulate(frame: &Frame, spec: Specialisation, records: &mut Records<Self>, film: &mut [u32]) {
                let Records { shadows, segments, sums, .. } = records;
                let words = FilmWords::sampled(frame, spec);
                for slot in 0..frame.pixel_slots {
                    let sample = |slot| stage::sampled::<Self>(frame, spec.launch, slot, (sums, shadows, segments));
                    let pixel = camera::pixel(frame, spec.order, slot);
                    if spec.launch.has(Launch::BLOCKS) {
                        stage::expose_blocks::<Self>(frame, (pixel, slot), words, sample, film);
                    } else {
                        stage::expose::<Self>(frame, (pixel, slot), words, sample, film);
                    }
                    if spec.aovs.any() {
                        stage::expose_aovs::<Self>(frame, spec, (pixel, slot), (sums, shadows, segments), words, film);
                    }
                }
            }
        })*
    };
}
number!(f32 f64);

/// The scattering of a wave's paths, for the instructions of an ISA.
struct Scatter<'t, R: Scalar> {
    launch: &'t LaunchContext<'t>,
    context: &'t ScatterContext<'t>,
    queues: Queues<'t>,
    photons: Photons<'t>,
    records: &'t mut Records<R>,
}

impl<R: Scalar> Task<R> for Scatter<'_, R> {
    #[inline(always)]
    fn run<V: SimdIsa<R>>(self) {
        let Records { paths, hits, shadows, segments, sums, landed } = self.records;
        let starts = !self.launch.spec.launch.has(Launch::SECONDARY);
        for &slot in self.queues.now {
            let exchange = Exchange::<R> {
                paths: &mut *paths,
                hits,
                shadows,
                segments: &mut *segments,
                sums: &mut *sums,
                starts,
                photons: self.photons,
                landed: &mut *landed,
            };
            if integrator::scatter(self.launch, self.context, slot, exchange) {
                self.queues.next.push(slot);
            }
        }
    }
}
