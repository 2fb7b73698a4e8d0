//! An effect that no scene has costs nothing: a copy of the kernels with another one gives the same folded modules.

use std::fs;
use std::path::{Path, PathBuf};

use eyerays::gpu::{Recipe, Target};
use eyerays::job::Job;
use eyerays::method::{Processor, Traversal};
use eyerays::plan::{Plan, Stage};
use eyerays::quality::Bvh;
use eyerays::scene_io;
use eyerays_passes::{Kernel, Kernels};
use eyerays_shader::data::{Effects, Specialisation};
use eyerays_shader::resources::RESOURCES;
use eyerays_spirv::compiler::Compiler;
use eyerays_spirv::table::{MODULES, Module, Policy};
use eyerays_spirv::{compile, pass, source};

const SHIPPED: [&str; 4] = ["cornell", "whitted", "glass", "lights"];

/// An edit of a source file.
type Edit = (&'static str, &'static str, &'static str);

/// Leaves out what takes long to compile and `auto` never takes: most methods.
const SHORTER: [Edit; 1] = [(
    "src/entry/kernels.rs",
    "        $(methods! { @$only $lanes $R, $module, $method, $($persistent)? })*\n",
    "        methods! { @$only alone $R, if_if, IfIf, }\n        methods! { @$only alone $R, while_while, WhileWhile<Alone>, }\n",
)];

/// Where the table of resources ends.
const TABLE_END: &str = "        }\n    };\n}\n#[cfg(target_arch = \"spirv\")]\npub(crate) use resources;\n";

/// One resource more, with the next number.
fn resource() -> Edit {
    let line = format!("            {} dummy DUMMY: Read UVec4, \"dummy\";\n{TABLE_END}", RESOURCES.len());
    ("src/resources.rs", TABLE_END, line.leak())
}

/// An effect that asks for it, and what it does: the dummy's light for a surface's. All bits are taken: it shares that of copies of meshes,
/// which none of these scenes has.
const DUMMY: [Edit; 5] = [
    (
        "src/data/specialisation.rs",
        "        EMISSIVE = 13;\n",
        "        EMISSIVE = 13;\n        /// Surfaces have the dummy's light.\n        DUMMY = 31;\n",
    ),
    // Of both kernels that shade.
    ("src/entry/mod.rs", "colours tangents environment] {", "colours tangents environment dummy] {"),
    ("src/entry/mod.rs", "spectra photons heads landed] {", "spectra photons heads landed dummy] {"),
    (
        "src/entry/mod.rs",
        "let shading = ShadingData { normals, materials, tangents, maps, textures };",
        "let shading = ShadingData { normals, materials, tangents, maps, textures, dummy };",
    ),
    (
        "src/integrator/whitted.rs",
        "    add(launch, sums, slot, &path, light, rays);\n    if",
        "    add(launch, sums, slot, &path, light, rays);\n    if effects.has(Effects::DUMMY) {\n        write(sums, slot, R::store(V3::splat(crate::data::numbers(read(shading.dummy, 0))), 0));\n    }\n    if",
    ),
];

/// The field that hands the dummy on.
const FIELD: Edit = (
    "src/scene.rs",
    "    /// Materials.\n    pub materials: &'a [Material],\n",
    "    /// Materials.\n    pub materials: &'a [Material],\n    /// The dummy.\n    pub dummy: &'a [UVec4],\n",
);

/// The compiler, where there is one.
fn compiler() -> Option<Compiler> {
    let toolchain = std::env::var("EYERAYS_SPIRV_TOOLCHAIN").ok();
    match Compiler::find(toolchain, std::env::var_os("EYERAYS_SPIRV_CODEGEN").map(PathBuf::from)) {
        Ok(compiler) => Some(compiler),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// The shader's crate with edits, as a workspace of its own that shares the outputs of dependencies with this one.
fn copied(folder: &Path, edits: &[Edit]) -> PathBuf {
    let (shader, root) = (source::shader(), source::shader().join(".."));
    let copy = folder.join("shader");
    copy_folder(&shader.join("src"), &copy.join("src"));
    fs::copy(shader.join("Cargo.toml"), copy.join("Cargo.toml")).unwrap();
    fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let workspace = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let rest = workspace.split_once("[workspace.package]").expect("the workspace's own keys").1;
    fs::write(
        folder.join("Cargo.toml"),
        format!("[workspace]\nresolver = \"3\"\nmembers = [\"shader\"]\n[workspace.package]{rest}"),
    )
    .unwrap();
    fs::create_dir(folder.join(".cargo")).unwrap();
    let target = root.canonicalize().unwrap().join("target");
    fs::write(folder.join(".cargo/config.toml"), format!("[build]\ntarget-dir = {:?}\n", target.join("effect")))
        .unwrap();
    for (file, old, new) in edits {
        let path = copy.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(old), "{file} has no longer: {old}");
        fs::write(path, text.replace(old, new)).unwrap();
    }
    copy
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy_folder(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// The exact kernels of a copy with these edits.
fn kernels(compiler: &Compiler, edits: &[Edit]) -> Kernels {
    let folder = tempfile::tempdir().unwrap();
    let words =
        compile::compile(compiler, &copied(folder.path(), edits), Policy::Exact).unwrap_or_else(|e| panic!("{e}"));
    let table: &Module = MODULES.iter().find(|module| module.name == "exact").expect("a module of exact kernels");
    let finished = pass::finish(&words, &Module { protects: &[], ..*table }).unwrap_or_else(|e| panic!("{e}"));
    Kernels::parse(&compile::bytes(&finished.words())).unwrap()
}

/// What each step of a scene's pictures runs by default.
fn recipes(name: &str) -> Vec<(String, Specialisation, Stage)> {
    let path = source::shader().join("../scenes").join(name).with_extension("toml");
    let (scene, _) = scene_io::load(&path).unwrap();
    let scene = Job::new(&scene, scene.settings, Bvh::Fast.quality()).unwrap();
    let traversal = Traversal::default();
    let plan = Plan::new(&scene, &traversal, |coherence| Ok(traversal.resolved(Processor::Gpu, coherence))).unwrap();
    let target = Target { exact: true, subgroups: true };
    let recipes = plan.steps().map(|&step| Recipe::new(step, target));
    recipes.map(|recipe| (recipe.name.clone(), recipe.spec, recipe.step.stage)).collect()
}

fn cut(kernels: &Kernels, name: &str, spec: Specialisation) -> Kernel {
    kernels.cut(name, &spec.constants()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn an_effect_that_no_scene_has_costs_none_of_them_anything() {
    let Some(compiler) = compiler() else { return };
    let before = kernels(&compiler, &SHORTER);
    let edits: Vec<Edit> = SHORTER.into_iter().chain([resource()]).chain(DUMMY).chain([FIELD]).collect();
    let after = kernels(&compiler, &edits);
    for scene in SHIPPED {
        for (name, spec, stage) in recipes(scene) {
            let [old, new] = [&before, &after].map(|kernels| cut(kernels, &name, spec));
            assert_eq!(old.bindings(), new.bindings(), "{scene}: {name}");
            assert!(old.words() == new.words(), "{scene}: {name} has other words");
            // And the effect is there for those that ask for it.
            if stage == Stage::Shade {
                let asked = Specialisation { effects: Effects(spec.effects.0 | 1 << 31), ..spec };
                let dummy = cut(&after, &name, asked);
                let binds = dummy.bindings().contains(&(RESOURCES.len() as u32));
                assert!(dummy.instructions() > new.instructions() && binds, "{scene}: {name}");
            }
        }
    }
}
