//! The committed modules, cut and folded for many sets of effects.

use std::io::Write;
use std::process::{Command, Stdio};

use eyerays_passes::Kernels;
use eyerays_shader::data::{Aovs, Caustics, Effects, Finishes, Launch, Layout, Media, Order, Specialisation, Waves};
use eyerays_shader::resources::binding;

fn modules() -> [&'static [u8]; 2] {
    [eyerays_modules::exact(), eyerays_modules::fast()]
}

fn effects(bits: u32) -> Specialisation {
    Specialisation { effects: Effects(bits), ..Specialisation::default() }
}

fn between(spec: Specialisation, bits: u32) -> Specialisation {
    Specialisation { media: Media(bits), ..spec }
}

fn finished(spec: Specialisation, bits: u32) -> Specialisation {
    Specialisation { finishes: Finishes(bits), ..spec }
}

fn spectral(spec: Specialisation, bits: u32) -> Specialisation {
    Specialisation { waves: Waves(bits), ..spec }
}

fn caustic(spec: Specialisation, bits: u32) -> Specialisation {
    Specialisation { caustics: Caustics(bits), ..spec }
}

/// Nothing, everything, and what together makes the kernels of most branches.
fn specialisations() -> Vec<Specialisation> {
    let all = effects(u32::MAX);
    let stream = effects(0).with_launch(Launch::STREAM | Launch::MOLLER);
    let wave = effects(Effects::REFLECTION | Effects::REFRACTION | Effects::SMOOTH).with_launch(Launch::SECONDARY);
    let layout = |spec, bits| Specialisation { layout: Layout(bits), ..spec };
    let path = effects(Effects::LIT | Effects::EMISSIVE | Effects::SPHERE | Effects::SMOOTH | Effects::REFRACTION);
    let path = path.with_launch(Launch::SECONDARY | Launch::GOES_ON | Launch::SOBOL);
    let order = Specialisation { order: Order(Order::MORTON), ..effects(Effects::LIT) };
    let moving = effects(Effects::INSTANCED | Effects::SMOOTH | Effects::LIT);
    vec![
        effects(0),
        all,
        stream,
        wave,
        layout(wave, Layout::INDEXED),
        layout(effects(0), Layout::COMPACT),
        path,
        path.with_launch(Launch::SUBGROUPS),
        effects(Effects::DISK).with_launch(Launch::OCCLUSION | Launch::RANDOM),
        order,
        path.with_launch(Launch::CELLS | Launch::BLOCKS),
        path.with_launch(Launch::LENS | Launch::FILTERED | Launch::ROUND | Launch::CLEAR),
        path.with_launch(Launch::CLIPPED | Launch::STEREO | Launch::CLEAR | Launch::CATCHER),
        Specialisation { aovs: Aovs(u32::MAX), ..all },
        Specialisation {
            aovs: Aovs(Aovs::ALBEDO | Aovs::GROUPS),
            ..path.with_launch(Launch::CATCHER | Launch::BLOCKS)
        },
        wave.without_launch(Launch::SECONDARY).with_launch(Launch::KEPT | Launch::LENS | Launch::PARALLEL),
        moving.with_launch(Launch::KEPT | Launch::MOVING | Launch::PANNED),
        moving.with_launch(Launch::SECONDARY | Launch::MOVING | Launch::GOES_ON),
        between(path, Media::PRESENT),
        between(path.with_launch(Launch::STREAM), Media::PRESENT | Media::GRIDS | Media::GLOWING),
        between(all, u32::MAX),
        between(path, Media::PRESENT | Media::NESTED),
        finished(effects(Effects::PHYSICAL | Effects::LIT | Effects::REFRACTION | Effects::TEXTURED), u32::MAX),
        finished(effects(Effects::PHYSICAL | Effects::EMISSIVE), Finishes::COATED | Finishes::TRANSLUCENT),
        finished(between(all, u32::MAX), u32::MAX),
        spectral(path, Waves::SPECTRAL),
        spectral(between(path, Media::PRESENT | Media::GRIDS | Media::OPEN), Waves::SPECTRAL | Waves::ILLUMINANTS),
        spectral(path, Waves::ILLUMINANTS),
        caustic(path, Caustics::GATHERED),
        caustic(between(all, u32::MAX), Caustics::GATHERED),
        caustic(path, Caustics::PHOTONS),
        caustic(finished(between(all, u32::MAX), u32::MAX), Caustics::PHOTONS),
        spectral(finished(effects(Effects::PHYSICAL | Effects::EMISSIVE | Effects::REFRACTION), u32::MAX), u32::MAX),
    ]
}

fn is_valid(words: &[u32]) -> Result<(), String> {
    let mut validator = Command::new("spirv-val");
    validator.args(["--target-env", "vulkan1.2", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut validator = validator.spawn().map_err(|e| e.to_string())?;
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    validator.stdin.take().expect("a pipe").write_all(&bytes).map_err(|e| e.to_string())?;
    let output = validator.wait_with_output().map_err(|e| e.to_string())?;
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

#[test]
fn every_kernel_is_valid_whatever_is_folded() {
    if Command::new("spirv-val").arg("--version").output().is_err() {
        return eprintln!("skipped: spirv-val is not on the PATH");
    }
    for module in modules() {
        let kernels = Kernels::parse(module).unwrap();
        for entry in kernels.names() {
            for spec in specialisations() {
                let kernel = kernels.cut(&entry, &spec.constants()).unwrap();
                is_valid(&kernel.words()).unwrap_or_else(|fault| panic!("{entry}, {spec:?}: {fault}"));
            }
        }
    }
}

/// Each stands for a branch in the source that a scene without the effect has no instruction of.
#[test]
fn an_effect_costs_instructions_only_where_it_is_asked_for() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let count = |entry: &str, spec: Specialisation| kernels.cut(entry, &spec.constants()).unwrap().instructions();
    let trace = |spec| count("exact::while_while::trace", spec);
    let bare = count("exact::shade", effects(0));
    for effect in
        [Effects::SMOOTH, Effects::CHECKER, Effects::REFLECTION, Effects::REFRACTION, Effects::LIT, Effects::GRADIENT]
    {
        let with = count("exact::shade", effects(effect));
        assert!(with > bare, "{effect:#x} is nothing, or its branch is not folded");
        assert_eq!(trace(effects(effect)), trace(effects(0)));
    }
    let lit = count("exact::shade", effects(Effects::LIT));
    for effect in [Effects::SPOT, Effects::DIRECTIONAL, Effects::SPECULAR] {
        assert_eq!(count("exact::shade", effects(effect)), bare, "{effect:#x} without a light");
        assert!(count("exact::shade", effects(Effects::LIT | effect)) > lit, "{effect:#x}");
    }
    let spot = Effects::LIT | Effects::SPOT;
    assert!(count("exact::shade", effects(spot | Effects::RAMP)) > count("exact::shade", effects(spot)));
    // Only what is not opaque everywhere is asked where rays meet it.
    assert!(trace(effects(Effects::CUTOUT)) > trace(effects(0)));
    for effect in [Effects::PHYSICAL, Effects::TEXTURED, Effects::COLOURED, Effects::ENVIRONMENT, Effects::TANGENTS] {
        assert_eq!(trace(effects(effect)), trace(effects(0)), "{effect:#x}");
    }
}

/// The same where paths are scattered.
#[test]
fn what_a_path_does_not_meet_is_not_in_its_kernel() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let count = |spec: Specialisation| kernels.cut("exact::scatter", &spec.constants()).unwrap().instructions();
    let lit = effects(Effects::LIT);
    for effect in [
        Effects::SMOOTH,
        Effects::CHECKER,
        Effects::REFLECTION,
        Effects::REFRACTION,
        Effects::EMISSIVE,
        Effects::GRADIENT,
        Effects::SPOT,
        Effects::DIRECTIONAL,
        Effects::SPHERE,
        Effects::DISK,
        Effects::MANY_LIGHTS,
    ] {
        assert!(count(effects(effect | Effects::LIT)) > count(lit), "{effect:#x}");
    }
    let physical = Effects::LIT | Effects::PHYSICAL;
    assert!(count(effects(physical)) > count(lit));
    for effect in [
        Effects::CONDUCTOR,
        Effects::THIN,
        Effects::REFRACTION,
        Effects::ABSORBING,
        Effects::ANISOTROPIC,
        Effects::TANGENTS,
    ] {
        assert!(count(effects(physical | effect)) > count(effects(physical)), "{effect:#x}");
    }
    let glowing = Effects::EMISSIVE | Effects::COLOURED;
    assert!(count(effects(glowing | Effects::GLOWING_COLOURS)) > count(effects(glowing)));
    let compensated = physical | Effects::COMPENSATED;
    assert!(count(effects(compensated)) > count(effects(physical)));
    assert_eq!(count(effects(Effects::LIT | Effects::COMPENSATED)), count(lit), "nothing has facets");
    for effect in [Effects::TEXTURED, Effects::COLOURED, Effects::ENVIRONMENT] {
        assert!(count(effects(effect | Effects::LIT)) > count(lit), "{effect:#x}");
    }
    let textured = effects(Effects::TEXTURED | Effects::LIT);
    assert!(count(textured.with_launch(Launch::MIPMAPPED)) > count(textured));
    assert!(count(textured.with_launch(Launch::NEAREST)) < count(textured));
    assert!(count(lit) > count(effects(0)));
    assert!(count(effects(0).with_launch(Launch::OCCLUSION)) < count(effects(0)));
    for way in [Launch::BY_LIGHT, Launch::BY_SURFACE] {
        let emissive = effects(Effects::EMISSIVE);
        assert!(count(emissive.with_launch(way)) < count(emissive), "{way:#x} weighs nothing");
    }
}

/// Only a picture that ends by its noise pays for what decides about it.
#[test]
fn cells_and_blocks_are_in_no_kernel_that_is_not_asked_for_them() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let cut = |entry: &str, bits| kernels.cut(entry, &effects(0).with_launch(bits).constants()).unwrap();
    let [plain, cells] = [0, Launch::CELLS].map(|bits| cut("exact::generate", bits));
    assert_eq!(plain.bindings(), [binding::FRAME, binding::PATHS]);
    assert_eq!(cells.bindings(), [binding::FRAME, binding::PATHS, binding::CELLS]);
    assert!(plain.instructions() < cells.instructions());
    let [plain, blocks] = [0, Launch::BLOCKS].map(|bits| cut("exact::accumulate", bits));
    assert_eq!(plain.bindings(), blocks.bindings());
    assert!(plain.instructions() != blocks.instructions());
    assert_eq!(cut("exact::accumulate", Launch::CELLS).instructions(), plain.instructions());
    assert_eq!(cut("exact::generate", Launch::BLOCKS).bindings(), [binding::FRAME, binding::PATHS]);
}

/// Only films that keep layers pay for them.
#[test]
fn a_layer_that_no_film_keeps_is_in_no_kernel() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let lit = effects(Effects::LIT | Effects::EMISSIVE | Effects::PHYSICAL).with_launch(Launch::GOES_ON);
    let cut = |entry: &str, aovs| {
        let spec = Specialisation { aovs: Aovs(aovs), ..lit };
        kernels.cut(entry, &spec.constants()).unwrap()
    };
    let scatter = |aovs| cut("exact::scatter", aovs).instructions();
    for bit in 0..12 {
        assert!(scatter(1 << bit) > scatter(0), "layer {bit} is nothing");
        let (all, without) = (Aovs(u32::MAX).0, !(1 << bit));
        // Parts of a surface share their instructions.
        let is_shared = Aovs::LOBES & (1 << bit) != 0;
        assert!(is_shared || scatter(all) > scatter(without), "layer {bit} is there though none asks for it");
    }
    assert!(scatter(u32::MAX) > scatter(!Aovs::LOBES));
    assert!(cut("exact::accumulate", 1).instructions() > cut("exact::accumulate", 0).instructions());
    assert_eq!(cut("exact::accumulate", 1).bindings(), cut("exact::accumulate", 0).bindings());
    for entry in ["exact::if_if::trace", "exact::if_if::shadow", "exact::generate"] {
        assert_eq!(cut(entry, u32::MAX).words(), cut(entry, 0).words(), "{entry}");
    }
}

/// What is between surfaces costs nothing where nothing is.
#[test]
fn media_are_in_no_kernel_of_a_scene_without() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let lit = effects(Effects::LIT | Effects::EMISSIVE | Effects::HIDDEN).with_launch(Launch::GOES_ON);
    let cut = |entry: &str, bits| kernels.cut(entry, &between(lit, bits).constants()).unwrap();
    let scatter = |bits| cut("exact::scatter", bits);
    let binds = |bits, resource| scatter(bits).bindings().contains(&resource);
    assert!(!binds(0, binding::MEDIA) && binds(Media::PRESENT, binding::MEDIA));
    let (present, grids) = (Media::PRESENT, Media::PRESENT | Media::GRIDS);
    assert!(!binds(present, binding::GRIDS) && binds(grids, binding::GRIDS));
    assert!(scatter(0).instructions() < scatter(present).instructions());
    for further in [Media::OPEN, Media::GLOWING, Media::GRIDS, Media::NESTED] {
        assert!(scatter(present).instructions() != scatter(present | further).instructions(), "{further:#x}");
    }
    for entry in ["exact::if_if::shadow", "exact::accumulate", "exact::shade"] {
        assert_eq!(cut(entry, u32::MAX).words(), cut(entry, 0).words(), "{entry}");
    }
}

/// What lies on surfaces costs nothing where nothing does, or where no material is by microfacets.
#[test]
fn finishes_are_in_no_kernel_of_a_scene_without() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let physical =
        effects(Effects::LIT | Effects::EMISSIVE | Effects::PHYSICAL | Effects::REFRACTION | Effects::TEXTURED);
    let cut = |spec, bits| kernels.cut("exact::scatter", &finished(spec, bits).constants()).unwrap();
    let bare = cut(physical, 0);
    assert!(!bare.bindings().contains(&binding::FINISHES));
    let each = [Finishes::COATED, Finishes::FIBROUS, Finishes::TRANSLUCENT, Finishes::FILMED, Finishes::DISPERSIVE];
    for one in each.into_iter().chain([Finishes::HAIR]) {
        let with = cut(physical, one);
        assert!(with.bindings().contains(&binding::FINISHES), "{one:#x}");
        assert!(with.instructions() > bare.instructions(), "{one:#x}");
    }
    for entry in ["exact::if_if::trace", "exact::if_if::shadow", "exact::accumulate", "exact::generate"] {
        let of = |bits| kernels.cut(entry, &finished(physical, bits).constants()).unwrap();
        assert_eq!(of(!Finishes::HAIR).words(), of(0).words(), "{entry}");
        // Rays do not meet hair from behind.
        let is_traced = entry.contains("if_if");
        assert_eq!(of(Finishes::HAIR).words() != of(0).words(), is_traced, "{entry}");
    }
}

/// Wavelengths cost nothing where light has none; lamps of other spectra have one more integer looked at where it does not matter.
#[test]
fn spectra_are_in_no_kernel_of_a_picture_without() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let lit = effects(Effects::LIT | Effects::EMISSIVE | Effects::PHYSICAL | Effects::CONDUCTOR);
    let cut = |entry, spec, bits| kernels.cut(entry, &spectral(spec, bits).constants()).unwrap();
    let bare = cut("exact::scatter", lit, 0);
    assert!(!bare.bindings().contains(&binding::SPECTRA));
    let plain = cut("exact::scatter", lit, Waves::ILLUMINANTS | Waves::MEASURED);
    assert!(!plain.bindings().contains(&binding::SPECTRA));
    assert!(plain.instructions() < bare.instructions() + 16);
    let all = cut("exact::scatter", lit, Waves::SPECTRAL);
    assert!(all.bindings().contains(&binding::SPECTRA));
    for more in [Waves::ILLUMINANTS, Waves::MEASURED] {
        assert!(cut("exact::scatter", lit, Waves::SPECTRAL | more).instructions() > all.instructions(), "{more:#x}");
    }
    let smoky = between(lit, Media::PRESENT | Media::GRIDS);
    assert!(!cut("exact::transmit", smoky, 0).bindings().contains(&binding::SPECTRA));
    assert!(cut("exact::transmit", smoky, Waves::SPECTRAL).bindings().contains(&binding::SPECTRA));
    for entry in ["exact::if_if::trace", "exact::if_if::shadow", "exact::accumulate", "exact::generate"] {
        assert_eq!(cut(entry, lit, Waves::SPECTRAL | Waves::MEASURED).words(), cut(entry, lit, 0).words(), "{entry}");
    }
}

/// Photons cost nothing where there are none; a launch of them asks no lamp and adds to no sum.
#[test]
fn photons_are_in_no_kernel_of_a_picture_without() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let lit = effects(Effects::LIT | Effects::EMISSIVE | Effects::PHYSICAL | Effects::REFRACTION);
    let cut = |entry, bits| kernels.cut(entry, &caustic(lit, bits).constants()).unwrap();
    let binds = |bits, resource| cut("exact::scatter", bits).bindings().contains(&resource);
    for resource in [binding::PHOTONS, binding::HEADS, binding::LANDED] {
        assert!(!binds(0, resource), "{resource}");
    }
    assert!(binds(Caustics::GATHERED, binding::PHOTONS) && binds(Caustics::GATHERED, binding::HEADS));
    assert!(!binds(Caustics::GATHERED, binding::LANDED) && binds(Caustics::PHOTONS, binding::LANDED));
    for resource in [binding::PHOTONS, binding::SUMS, binding::SEGMENTS, binding::EMITTERS] {
        assert!(!binds(Caustics::PHOTONS, resource), "{resource}");
    }
    for entry in ["exact::if_if::trace", "exact::if_if::shadow", "exact::accumulate", "exact::generate"] {
        assert_eq!(cut(entry, Caustics::GATHERED).words(), cut(entry, 0).words(), "{entry}");
    }
}

/// Functions of their own that one effect, or any of some, alone needs.
#[test]
fn a_kernel_reaches_no_function_of_an_effect_that_nothing_has() {
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let all =
        Effects::LIT | Effects::EMISSIVE | Effects::PHYSICAL | Effects::COMPENSATED | Effects::SPHERE | Effects::DISK;
    let all = all | Effects::CONDUCTOR | Effects::REFRACTION | Effects::THIN | Effects::ANISOTROPIC;
    for (entry, of, function) in [
        ("exact::if_if::trace", Effects::SPHERE, "geometry::sphere::intersect_sphere"),
        ("exact::if_if::trace", Effects::DISK, "geometry::disk::intersect_disk"),
        ("exact::scatter", Effects::CONDUCTOR, "material::fresnel::conductors"),
        ("exact::scatter", Effects::REFRACTION | Effects::THIN, "material::fresnel::glass"),
        ("exact::scatter", Effects::REFRACTION, "material::refraction::refracted"),
    ] {
        let reached = |bits: u32| {
            let kernel = kernels.cut(entry, &effects(bits).constants()).unwrap();
            kernel
                .functions()
                .iter()
                .filter(|name| name.contains(function))
                .map(|&name| name.to_owned())
                .collect::<Vec<_>>()
        };
        assert!(!reached(all).is_empty(), "no kernel has a function {function}");
        assert_eq!(reached(all & !of), [""; 0], "{entry} without the effects {of:#x}");
    }
}

#[test]
fn a_kernel_binds_what_it_reads_and_writes() {
    use eyerays_shader::resources::binding::*;
    let kernels = Kernels::parse(eyerays_modules::exact()).unwrap();
    let bindings =
        |entry: &str, spec: Specialisation| kernels.cut(entry, &spec.constants()).unwrap().bindings().to_vec();
    assert_eq!(bindings("exact::advance", effects(0)), [COUNTERS, ARGUMENTS]);
    assert_eq!(bindings("exact::gather", effects(0)), [FRAME, SUMS, FILM]);
    assert_eq!(bindings("exact::if_if::trace", effects(0)), [FRAME, NODES, PRIMITIVES, HITS]);
    let further = [FRAME, NODES, PRIMITIVES, PATHS, HITS, QUEUE, COUNTERS];
    assert_eq!(bindings("exact::if_if::trace", effects(0).with_launch(Launch::SECONDARY)), further);
    for (launch, wanted) in [(0, &[FRAME, PATHS][..]), (Launch::ROUND, &[FRAME, PATHS])] {
        assert_eq!(bindings("exact::generate", effects(0).with_launch(launch)), wanted);
    }
    for launch in [Launch::LENS, Launch::FILTERED, Launch::LENS | Launch::KEPT] {
        assert_eq!(bindings("exact::generate", effects(0).with_launch(launch)), [FRAME, PATHS, OPTICS]);
    }
    let launch = Launch::MOVING | Launch::KEPT;
    assert_eq!(bindings("exact::generate", effects(Effects::INSTANCED).with_launch(launch)), [FRAME, PATHS, HITS]);
    assert_eq!(bindings("exact::generate", effects(0).with_launch(Launch::PANNED)), [FRAME, PATHS, INSTANCES]);
    assert_eq!(bindings("exact::shade", effects(0)), [FRAME, PRIMITIVES, MATERIALS, HITS, SUMS]);
    let lit = [FRAME, PRIMITIVES, NORMALS, MATERIALS, LIGHTS, HITS, SHADOWS, SUMS];
    assert_eq!(bindings("exact::shade", effects(Effects::SMOOTH | Effects::LIT)), lit);
}

/// The list of what a stage binds is what its kernels reach for some scene, no less and no more.
#[test]
fn a_stage_names_no_resource_that_its_kernels_do_not_use() {
    use eyerays_shader::entry::bound;
    use eyerays_shader::resources::RESOURCES;
    for module in modules() {
        let kernels = Kernels::parse(module).unwrap();
        for entry in kernels.names() {
            let persistent = entry.contains("::persistent::");
            let named: &[&str] = match entry.rsplit("::").next().unwrap() {
                "trace" if persistent => bound::persistent::trace,
                "shadow" if persistent => bound::persistent::shadow,
                "trace" => bound::trace,
                "shadow" => bound::shadow,
                "shade" => bound::shade,
                "scatter" => bound::scatter,
                "emit" => bound::emit,
                "cross" => bound::cross,
                "nearest" => bound::nearest,
                "file" => bound::file,
                "transmit" => bound::transmit,
                "generate" => bound::generate,
                "accumulate" => bound::accumulate,
                "advance" => bound::advance,
                "gather" => bound::gather,
                other => panic!("a stage {other}"),
            };
            let mut reached: Vec<&str> = Vec::new();
            for spec in specialisations() {
                let kernel = kernels.cut(&entry, &spec.constants()).unwrap();
                reached.extend(kernel.bindings().iter().map(|&binding| RESOURCES[binding as usize].parameter));
            }
            reached.sort_unstable();
            reached.dedup();
            let mut named = named.to_vec();
            named.sort_unstable();
            // The stages of all methods share a list. Only `wide` walks that hierarchy, and inside instances the binary one.
            named.retain(|resource| *resource != "wide" || entry.contains("::wide::"));
            assert_eq!(reached, named, "{entry}");
        }
    }
}
