//! The committed modules, cut and folded for many sets of effects.

use std::io::Write;
use std::process::{Command, Stdio};

use eyerays_passes::Kernels;
use eyerays_shader::data::{Features, Tuning};
use eyerays_shader::launch::{FEATURES_ID, TUNING_ID};
use eyerays_shader::modules;

const MODULES: [&[u8]; 4] = [modules::EXACT, modules::FAST, modules::EXACT_SUBGROUP, modules::FAST_SUBGROUP];

/// None, all, and those together that make the kernels of most branches.
fn effects() -> Vec<u32> {
    let all_of_the_camera = Features::SECONDARY - 1;
    let stream = Features::STREAM | Features::SPLIT | Features::MOLLER;
    let wave = Features::SECONDARY | Features::REFLECTION | Features::REFRACTION | Features::SMOOTH;
    vec![0, all_of_the_camera, stream, wave, wave | Features::SPLIT | Features::INDEXED, Features::COMPACT]
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
    for module in MODULES {
        let kernels = Kernels::parse(module).unwrap();
        for entry in kernels.names() {
            for features in effects() {
                let kernel = kernels.cut(&entry, &[(FEATURES_ID, features), (TUNING_ID, Tuning::default().0)]).unwrap();
                is_valid(&kernel.words()).unwrap_or_else(|fault| panic!("{entry}, {features:#x}: {fault}"));
            }
        }
    }
}

/// Each stands for a branch in the source that a scene without the effect has no instruction of.
#[test]
fn an_effect_costs_instructions_only_where_it_is_asked_for() {
    let kernels = Kernels::parse(modules::EXACT).unwrap();
    let count = |entry: &str, features: u32| kernels.cut(entry, &[(FEATURES_ID, features)]).unwrap().instructions();
    let bare = count("exact_shade", 0);
    for effect in [
        Features::SMOOTH,
        Features::CHECKER,
        Features::REFLECTION,
        Features::REFRACTION,
        Features::SPOT,
        Features::DIRECTIONAL,
        Features::SPECULAR,
        Features::GRADIENT,
    ] {
        assert!(count("exact_shade", effect) > bare, "{effect:#x} is nothing, or its branch is not folded");
        assert_eq!(
            count("exact_trace_while_while", effect & !Features::REFRACTION),
            count("exact_trace_while_while", 0)
        );
    }
    assert_ne!(count("exact_trace_while_while", Features::SPLIT), count("exact_trace_while_while", 0));
}

#[test]
fn a_kernel_binds_what_it_reads_and_writes() {
    use eyerays_shader::launch::binding::*;
    let kernels = Kernels::parse(modules::EXACT).unwrap();
    let bindings = |entry: &str, features: u32| kernels.cut(entry, &[(FEATURES_ID, features)]).unwrap().bindings();
    assert_eq!(bindings("exact_advance", 0), [FRAME, COUNTERS]);
    assert_eq!(bindings("exact_trace_if_if", 0), [FRAME, NODES, TRIANGLES, HITS]);
    assert_eq!(bindings("exact_trace_if_if", Features::SPLIT), [FRAME, NODES, TRIANGLES, HITS, BOUNDS]);
    let further = [FRAME, NODES, TRIANGLES, PATHS, HITS, QUEUE, COUNTERS];
    assert_eq!(bindings("exact_trace_if_if", Features::SECONDARY), further);
    let shade = bindings("exact_shade", 0);
    assert!(!shade.contains(&NORMALS) && !shade.contains(&PATHS) && !shade.contains(&QUEUE), "{shade:?}");
    assert!(bindings("exact_shade", Features::SMOOTH).contains(&NORMALS));
}
