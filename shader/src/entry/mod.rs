//! The kernels: each binds what it names of the table of [resources](crate::resources), and hands it to a stage.
//!
//! A kernel's path is its precision (`exact` or `fast`, with `subgroup_` before it where its lanes vote), the method if
//! it follows rays, and the stage: `exact::while_while::trace`. Compiled natively, the same lines are lists of what the
//! stages bind, which tests compare with the modules.

/// Declares `entry!`, which makes a kernel: a name with the threads of a workgroup, built-in parameters, a name for its
/// [`Specialisation`](crate::data::Specialisation), the resources that it binds, and what it does.
#[cfg(target_arch = "spirv")]
macro_rules! declare_entry {
    ($d:tt $($binding:tt $resource:ident $constant:ident: $access:ident $record:ty, $name:literal;)*) => {
        macro_rules! entry {
            ($d(#[$d doc:meta])* $d kernel:ident<$d threads:tt>($d($d built_in:tt)*) $d spec:ident
                [$d($d bound:ident)*] $d body:block) => {
                entry! { @bind ($d(#[$d doc])* $d kernel $d threads $d spec $d body) [$d($d built_in)*]
                    [$d($d bound $d bound)*] }
            };
            $((@bind $d kernel:tt [$d($d have:tt)*] [$resource $d bound:ident $d($d rest:tt)*]) => {
                entry! { @$access $d kernel [$d($d have)*] [$d($d rest)*] $binding $d bound $record }
            };)*
            (@Uniform $d kernel:tt [$d($d have:tt)*] $d rest:tt $d binding:tt $d bound:ident $d record:ty) => {
                entry! { @bind $d kernel [$d($d have)*
                    #[spirv(uniform, descriptor_set = 0, binding = $d binding)] $d bound: &$d record,] $d rest }
            };
            (@Read $d kernel:tt [$d($d have:tt)*] $d rest:tt $d binding:tt $d bound:ident $d record:ty) => {
                entry! { @bind $d kernel [$d($d have)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $d binding)] $d bound: &[$d record],]
                    $d rest }
            };
            (@Write $d kernel:tt [$d($d have:tt)*] $d rest:tt $d binding:tt $d bound:ident $d record:ty) => {
                entry! { @bind $d kernel [$d($d have)*
                    #[spirv(storage_buffer, descriptor_set = 0, binding = $d binding)] $d bound: &mut [$d record],]
                    $d rest }
            };
            (@bind ($d(#[$d doc:meta])* $d kernel:ident $d threads:tt $d spec:ident $d body:block) [$d($d have:tt)*] []) => {
                $d(#[$d doc])*
                #[spirv(compute(threads($d threads)))]
                pub fn $d kernel(
                    #[spirv(spec_constant(id = 1, default = 0))] effects: u32,
                    #[spirv(spec_constant(id = 2, default = 0))] tuning: u32,
                    #[spirv(spec_constant(id = 3, default = 0))] launch: u32,
                    #[spirv(spec_constant(id = 4, default = 0))] layout: u32,
                    #[spirv(spec_constant(id = 5, default = 0))] order: u32,
                    #[spirv(spec_constant(id = 6, default = 0))] aovs: u32,
                    #[spirv(spec_constant(id = 7, default = 0))] media_bits: u32,
                    #[spirv(spec_constant(id = 8, default = 0))] finish_bits: u32,
                    #[spirv(spec_constant(id = 9, default = 0))] waves: u32,
                    #[spirv(spec_constant(id = 10, default = 0))] caustics: u32,
                    $d($d have)*
                ) {
                    let $d spec = Specialisation {
                        effects: Effects(effects),
                        tuning: Tuning(tuning),
                        launch: Launch(launch),
                        layout: Layout(layout),
                        order: Order(order),
                        aovs: Aovs(aovs),
                        media: Media(media_bits),
                        finishes: Finishes(finish_bits),
                        waves: Waves(waves),
                        caustics: Caustics(caustics),
                    };
                    $d body
                }
            };
        }
    };
}

/// Natively, a list of what a stage binds.
#[cfg(not(target_arch = "spirv"))]
macro_rules! entry {
    ($(#[$doc:meta])* $kernel:ident<$threads:tt>($($built_in:tt)*) $spec:ident [$($bound:ident)*] $body:block) => {
        $(#[$doc])*
        #[allow(non_upper_case_globals)]
        pub const $kernel: &[&str] = &[$(stringify!($bound)),*];
    };
}

/// The stages that follow no ray, over the numbers `R`.
macro_rules! shading {
    ($R:ty) => {
        entry! {
            /// Shades the slots of a wave.
            shade<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame primitives instances normals materials lights paths hits shadows sums queue next counters
             maps textures texels coordinates colours tangents environment] {
                let slot = slot(spec, frame, id.x, queue, counters);
                if slot == IDLE {
                    return;
                }
                let launch = LaunchContext::new(frame, spec, primitives, instances);
                let textures = Textures { textures, texels, coordinates, colours };
                let shading = ShadingData { normals, materials, tangents, maps, textures };
                let wave = Wave { paths, hits, shadows, lights, environment, sums };
                let goes_on = integrator::shade::<$R>(&launch, &shading, slot, wave);
                enqueue(spec, goes_on, slot, next, counters);
            }
        }

        entry! {
            /// Scatters the paths of a wave.
            scatter<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame primitives instances normals materials paths hits shadows segments sums queue next counters emitters emissions
             physicals maps textures texels coordinates colours tangents environment albedos light_nodes media grids finishes
             spectra photons heads landed] {
                // One kernel for all waves, since it is the one that drivers take longest to compile.
                let starts = !spec.launch.has(Launch::GOES_ON) || read(counters, counter::WAVES) == 0;
                let count = if starts { frame.slots } else { read(counters, counter::COUNT) };
                if id.x >= count {
                    return;
                }
                let slot = if starts { id.x } else { read(queue, id.x) };
                let launch = LaunchContext::new(frame, spec, primitives, instances);
                let textures = Textures { textures, texels, coordinates, colours };
                let shading = ShadingData { normals, materials, tangents, maps, textures };
                let lighting = Lighting { emitters, nodes: light_nodes, emissions, textures, environment, spectra };
                let context =
                    ScatterContext { shading, physicals, finishes, albedos: Albedos(albedos), lighting, media, grids };
                let photons = Photons { records: photons, heads };
                let exchange = Exchange { paths, hits, shadows, segments, sums, starts, photons, landed };
                let goes_on = integrator::scatter::<$R>(&launch, &context, slot, exchange);
                if spec.launch.has(Launch::GOES_ON) {
                    enqueue(spec, goes_on, slot, next, counters);
                }
            }
        }

        entry! {
            /// Dims the light of a wave's shadow rays by what is between surfaces.
            transmit<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame nodes primitives instances materials paths hits shadows segments queue counters wide media grids
             opacities textures texels coordinates colours spectra] {
                let slot = slot(spec, frame, id.x, queue, counters);
                if slot == IDLE {
                    return;
                }
                let base = LaunchContext::new(frame, spec, primitives, instances);
                let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                let scene = TraceContext { base, nodes, wide, cutout };
                let time = stage::Found::<$R>::time(&base, slot, hits);
                let inputs = TransmitInputs { paths: &*paths, shadows, materials, media, grids, spectra };
                stage::transmit::<$R, WhileWhile<Alone>, Primitives>(&scene, inputs, (slot, time), segments);
            }
        }

        entry! {
            /// Starts the paths of a launch.
            generate<64>(#[spirv(global_invocation_id)] id: UVec3,) spec [frame instances paths hits cells optics] {
                if id.x < frame.slots {
                    let tables = CameraTables { cells, optics, instances };
                    stage::generate::<$R>(frame, spec, tables, id.x, (paths, hits));
                }
            }
        }

        entry! {
            /// Starts the photons of a launch.
            emit<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame primitives instances paths hits emitters emissions textures texels coordinates colours environment light_nodes
             spectra casters landed] {
                if id.x < frame.slots {
                    let launch = LaunchContext::new(frame, spec, primitives, instances);
                    let textures = Textures { textures, texels, coordinates, colours };
                    let lighting = Lighting { emitters, nodes: light_nodes, emissions, textures, environment, spectra };
                    let casters = Casters { records: casters };
                    integrator::emit::<$R>(&launch, &lighting, &casters, id.x, (paths, hits, landed));
                }
            }
        }

        entry! {
            /// Puts the photons of a launch into the lists of their grid.
            file<64>(#[spirv(global_invocation_id)] id: UVec3,) _spec [frame heads landed] {
                if id.x < frame.slots {
                    photon::file(frame, id.x, landed, move |list, first| exchange(heads, list, first));
                }
            }
        }

        entry! {
            /// Adds what slots have summed, and the light that their last vertices waited for, to the film.
            accumulate<64>(#[spirv(global_invocation_id)] id: UVec3,) spec [frame shadows segments sums film] {
                let pixel = camera::pixel(frame, spec.order, id.x);
                let words = stage::FilmWords::sampled(frame, spec);
                if spec.aovs.any() {
                    stage::expose_aovs::<$R>(frame, spec, (pixel, id.x), (&mut *sums, &*shadows, &*segments), words, film);
                }
                // By value: a pointer to the constants would lie in the closure.
                let sample = move |slot| stage::sampled::<$R>(frame, spec.launch, slot, (&*sums, &*shadows, &*segments));
                if spec.launch.has(Launch::BLOCKS) {
                    stage::expose_blocks::<$R>(frame, (pixel, id.x), words, sample, film);
                } else {
                    stage::expose::<$R>(frame, (pixel, id.x), words, sample, film);
                }
            }
        }

        entry! {
            /// Turns to the next wave.
            advance<1>() _spec [counters arguments] {
                advance_wave(counters, arguments);
            }
        }

        entry! {
            /// Adds what slots have summed to the film.
            gather<64>(#[spirv(global_invocation_id)] id: UVec3,) spec [frame sums film] {
                let sample = |slot| stage::Sample::of(<$R>::load(read(sums, slot)));
                let pixel = camera::pixel(frame, spec.order, id.x);
                let words = stage::FilmWords::of_light(stage::film_words(spec.launch, false));
                stage::expose::<$R>(frame, (pixel, id.x), words, sample, film);
            }
        }
    };
}

/// What only streams are asked, by no method, over the numbers `R`.
// In exact precision alone: who asks wants to know.
#[cfg(any(feature = "exact", not(target_arch = "spirv")))]
macro_rules! asking {
    ($R:ty) => {
        entry! {
            /// Finds the next crossing of each ray of a stream.
            cross<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame nodes primitives instances paths hits wide opacities textures texels coordinates colours] {
                let slot = thread(spec, id);
                if slot < frame.slots {
                    let base = LaunchContext::new(frame, spec, primitives, instances);
                    let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                    let scene = TraceContext { base, nodes, wide, cutout };
                    let before = stage::Found::<$R>::load(&base, slot, hits);
                    stage::cross::<$R, WhileWhile<Alone>>(&scene, (slot, before), paths).store(&base, slot, hits);
                }
            }
        }

        entry! {
            /// Finds the triangle that is nearest to where each ray of a stream starts.
            nearest<64>(#[spirv(global_invocation_id)] id: UVec3,) spec [frame nodes primitives instances paths hits] {
                let slot = thread(spec, id);
                if slot < frame.slots {
                    let base = LaunchContext::new(frame, spec, primitives, instances);
                    stage::nearest::<$R>(&crate::scene::Hierarchy { base, nodes }, slot, paths).store(&base, slot, hits);
                }
            }
        }
    };
}

/// The stages that follow rays over the numbers `R` by a method, a thread a ray.
macro_rules! tracing {
    ($R:ty, $method:ty) => {
        entry! {
            /// Traces the rays of a wave.
            trace<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame nodes primitives instances paths hits queue counters wide
             opacities textures texels coordinates colours] {
                let slot = slot(spec, frame, thread(spec, id), queue, counters);
                if slot == IDLE {
                    return;
                }
                let base = LaunchContext::new(frame, spec, primitives, instances);
                let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                let scene = TraceContext { base, nodes, wide, cutout };
                let time = stage::Found::<$R>::time(&base, slot, hits);
                stage::trace::<$R, $method, Primitives>(&scene, (slot, time), paths).store(&base, slot, hits);
            }
        }

        entry! {
            /// Traces the shadow rays of a wave: one row of threads a light.
            shadow<64>(#[spirv(global_invocation_id)] id: UVec3,) spec
            [frame nodes primitives instances lights paths hits shadows queue counters wide
             opacities textures texels coordinates colours] {
                let slot = slot(spec, frame, thread(spec, id), queue, counters);
                if slot == IDLE {
                    return;
                }
                let base = LaunchContext::new(frame, spec, primitives, instances);
                let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                let scene = TraceContext { base, nodes, wide, cutout };
                let light = if spec.launch.has(Launch::STREAM) { 0 } else { id.y };
                let answer = stage::shadow::<$R, $method, Primitives>(&scene, ShadowInputs { lights, paths, hits }, slot, light);
                write(shadows, light * frame.slots + slot, answer);
            }
        }
    };
}

/// The same in persistent subgroups.
macro_rules! persistent_tracing {
    ($R:ty, $method:ty) => {
        entry! {
            /// Traces the rays of a wave.
            trace<64>(#[spirv(subgroup_local_invocation_id)] lane: u32,) spec
            [frame nodes primitives instances paths hits queue counters wide
             opacities textures texels coordinates colours] {
                let base = LaunchContext::new(frame, spec, primitives, instances);
                let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                let scene = TraceContext { base, nodes, wide, cutout };
                let (count, paths, queue) = (slots(spec, frame, counters), &*paths, &*queue);
                stage::persistent::<$R, $method, Primitives, Closest, Subgroup, _>(
                    &scene,
                    (count, hits),
                    move |wants| take(wants, lane, counters, counter::TRACED),
                    move |hits, number| {
                        let slot = queued(spec, number, queue);
                        let time = stage::Found::<$R>::time(&base, slot, hits);
                        let (ray, limit) = stage::ray::<$R>(&scene, (slot, time), paths);
                        (ray, limit, true)
                    },
                    move |hits, number, _, ray, hit| {
                        stage::Found::of(&scene, ray, hit).store(&base, queued(spec, number, queue), hits);
                    },
                );
            }
        }

        entry! {
            /// Traces the shadow rays of a wave, light after light.
            shadow<64>(#[spirv(subgroup_local_invocation_id)] lane: u32,) spec
            [frame nodes primitives instances lights paths hits shadows queue counters wide
             opacities textures texels coordinates colours] {
                let base = LaunchContext::new(frame, spec, primitives, instances);
                let cutout = Cutout { opacities, textures: Textures { textures, texels, coordinates, colours } };
                let scene = TraceContext { base, nodes, wide, cutout };
                let inputs = ShadowInputs { lights, paths: &*paths, hits: &*hits };
                let (count, queue) = (slots(spec, frame, counters), &*queue);
                // A launch without slots takes no number; the guard spares the division's panic.
                let row = if count == 0 { 1 } else { count };
                let rows = if spec.launch.has(Launch::STREAM) { 1 } else { frame.shadow_rays };
                stage::persistent::<$R, $method, Primitives, Occlusion, Subgroup, _>(
                    &scene,
                    (count * rows, shadows),
                    move |wants| take(wants, lane, counters, counter::ASKED),
                    move |_, number| {
                        let slot = queued(spec, number % row, queue);
                        let (segment, faces) = stage::shadow_ray(&scene, inputs, slot, number / row);
                        let time = stage::Found::<$R>::time(&base, slot, inputs.hits);
                        (segment.ray().at(time), segment.limit, faces)
                    },
                    move |shadows, number, traced, _, hit| {
                        let answer = if traced { stage::visibility(hit) } else { stage::FACES_AWAY };
                        let slot = queued(spec, number % row, queue);
                        write(shadows, number / row * frame.slots + slot, answer);
                    },
                );
            }
        }
    };
}

/// What each stage binds, by its name and the names of [resources](crate::resources::RESOURCES).
#[cfg(not(target_arch = "spirv"))]
pub mod bound {
    shading!(f32);
    asking!(f32);
    tracing!(f32, ());

    /// Of persistent subgroups.
    pub mod persistent {
        persistent_tracing!(f32, ());
    }
}

#[cfg(target_arch = "spirv")]
pub mod kernels;
