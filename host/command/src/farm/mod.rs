//! A picture as a job of many machines: what renders its parts and puts them together, as a render farm or a cluster reads it.

mod folder;
mod parts;
mod slurm;
mod template;

pub use folder::Folder;
pub use parts::{MOST_PARTS, Parts};

/// One picture that many machines render.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// What a queue calls it: letters, digits, points, `-` and `_`.
    pub name: String,
    /// The scene's path from the root of the file system.
    pub scene: String,
    /// Options of `eyerays render`, which every part has.
    pub options: Vec<String>,
    /// The file of the picture, in the job's folder.
    pub picture: String,
    /// How the picture is divided.
    pub parts: Parts,
}

impl Job {
    /// The name for a queue that a file's name gives.
    pub fn name(stem: &str) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
        stem.chars().map(plain).take(64).collect()
    }
}

#[cfg(test)]
fn example(parts: Parts) -> Job {
    Job {
        name: Job::name("my room"),
        scene: "/scenes/my room.toml".to_owned(),
        options: ["--camera", "a 'b'"].map(str::to_owned).to_vec(),
        picture: "my room.exr".to_owned(),
        parts,
    }
}
