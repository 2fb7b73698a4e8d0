//! The files that another file names: where they lie, and which of them may be read.

use std::cell::OnceCell;
use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};

use super::file;

/// How far below a folder a name is looked for.
const MOST_DEPTH: usize = 4;
/// How many files and folders are looked at for it.
const MOST_ENTRIES: usize = 20_000;

/// The files around one that comes from strangers. What it names is read from its folder or below, wherever it says that
/// the file lies: exporters write the folders of the machine that they ran on.
pub struct Neighbours {
    folder: PathBuf,
    allow_outside: bool,
    /// Folders of the folder, itself first, and the names of their files.
    listing: OnceCell<Vec<PathBuf>>,
}

impl Neighbours {
    /// Those of the file at `path`; with `allow_outside` also any other that it names.
    pub fn new(path: &Path, allow_outside: bool) -> Self {
        Neighbours { folder: file::folder(path).to_owned(), allow_outside, listing: OnceCell::new() }
    }

    /// The file of a name: where it says, if that is allowed, and else the one in the folder or below that shares most of
    /// the end of its path, at least its own name. Quotes and backslashes before blanks are taken off.
    pub fn find(&self, name: &str) -> Option<PathBuf> {
        let name = plain(name);
        let is_absolute = name.starts_with('/') || has_drive(&name);
        // A name of another place is not so much as looked at.
        if self.allow_outside || !is_absolute {
            let path = self.folder.join(&name);
            if path.is_file() && (self.allow_outside || self.holds(&path)) {
                return Some(if name.split('/').any(|part| part == "..") { tidied(path) } else { path });
            }
        }
        self.search(&name)
    }

    /// Is a file there once all links are followed?
    fn holds(&self, path: &Path) -> bool {
        let root = if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder };
        matches!((path.canonicalize(), root.canonicalize()), (Ok(real), Ok(root)) if real.starts_with(&root))
    }

    fn search(&self, name: &str) -> Option<PathBuf> {
        let wanted: Vec<&str> = name.rsplit('/').filter(|part| !matches!(*part, "" | "." | "..")).collect();
        let last = wanted.first()?;
        let shared = |path: &Path, same: fn(&str, &str) -> bool| {
            let parts = path.strip_prefix(&self.folder).unwrap_or(path).iter().rev();
            parts.zip(&wanted).take_while(|(part, wanted)| part.to_str().is_some_and(|part| same(part, wanted))).count()
        };
        let listing = self.listing.get_or_init(|| listing(&self.folder));
        let best = |same: fn(&str, &str) -> bool| {
            let is_named = |path: &&PathBuf| path.file_name().and_then(|n| n.to_str()).is_some_and(|n| same(n, last));
            let named = listing.iter().filter(is_named).filter(|path| path.is_file() && self.holds(path));
            // Of equals the nearest, which comes first.
            named.rev().max_by_key(|path| shared(path, same))
        };
        best(|a, b| a == b).or_else(|| best(|a, b| a.eq_ignore_ascii_case(b))).cloned()
    }
}

/// A name with slashes between folders, without quotes around it.
fn plain(name: &str) -> String {
    let name = name.trim();
    let quoted = |quote| name.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    let name = quoted('"').or_else(|| quoted('\'')).unwrap_or(name).trim();
    name.replace("\\ ", " ").replace('\\', "/").replace("//", "/")
}

fn has_drive(name: &str) -> bool {
    matches!(name.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic())
}

/// The path without steps back.
fn tidied(path: PathBuf) -> PathBuf {
    path.canonicalize().unwrap_or(path)
}

/// The files of a folder and those below, the nearest first and then by name. Links to folders are not followed.
fn listing(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut seen) = (Vec::new(), 0);
    let mut folders = VecDeque::from([(folder.to_owned(), 0)]);
    while let Some((folder, depth)) = folders.pop_front() {
        let real = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        let Ok(entries) = fs::read_dir(real) else { continue };
        let mut entries: Vec<_> = entries.flatten().take(MOST_ENTRIES - seen).collect();
        seen += entries.len();
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let path = folder.join(entry.file_name());
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && depth < MOST_DEPTH => folders.push_back((path, depth + 1)),
                Ok(kind) if !kind.is_dir() => files.push(path),
                _ => {}
            }
        }
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, name).unwrap();
        }
        folder
    }

    /// What is found of a name in the model's folder, as its content, which is its path.
    fn found(folder: &Path, name: &str, allow_outside: bool) -> Option<String> {
        let path = Neighbours::new(&folder.join("model/a.obj"), allow_outside).find(name)?;
        Some(fs::read_to_string(path).unwrap())
    }

    #[test]
    fn a_file_is_found_by_its_name_wherever_the_exporter_had_it() {
        let folder =
            folder(&["model/a.obj", "model/tex.png", "model/b c.png", "model/maps/deep/skin.png", "model/x/Wood.PNG"]);
        for (name, want) in [
            ("tex.png", "model/tex.png"),
            ("\"tex.png\"", "model/tex.png"),
            ("/home/someone/project/tex.png", "model/tex.png"),
            ("C:\\Users\\someone\\tex.png", "model/tex.png"),
            ("\\\\server\\share\\tex.png", "model/tex.png"),
            ("../tex.png", "model/tex.png"),
            ("x/../tex.png", "model/tex.png"),
            ("textures/tex.png", "model/tex.png"),
            ("b\\ c.png", "model/b c.png"),
            ("maps\\deep\\skin.png", "model/maps/deep/skin.png"),
            ("/tmp/skin.png", "model/maps/deep/skin.png"),
            ("wood.png", "model/x/Wood.PNG"),
        ] {
            assert_eq!(found(folder.path(), name, false).as_deref(), Some(want), "{name}");
        }
        for name in ["none.png", "", "..", "/", "C:"] {
            assert_eq!(found(folder.path(), name, false), None, "{name}");
        }
    }

    #[test]
    fn of_files_of_one_name_the_one_that_shares_most_of_its_path_is_taken() {
        let folder = folder(&["model/a/skin.png", "model/b/skin.png", "model/c/b/skin.png"]);
        for (name, want) in [
            ("/x/b/skin.png", "model/b/skin.png"),
            ("D:/c/b/skin.png", "model/c/b/skin.png"),
            ("/skin.png", "model/a/skin.png"),
        ] {
            assert_eq!(found(folder.path(), name, false).as_deref(), Some(want), "{name}");
        }
    }

    #[test]
    fn what_lies_outside_is_read_only_where_that_is_allowed() {
        let folder = folder(&["model/a.obj", "textures/tex.png"]);
        let absolute = folder.path().join("textures/tex.png");
        for name in ["../textures/tex.png", absolute.to_str().unwrap()] {
            assert_eq!(found(folder.path(), name, false), None, "{name}");
            assert_eq!(found(folder.path(), name, true).as_deref(), Some("textures/tex.png"), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_leads_outside_is_not_followed_by_its_name_or_by_the_search() {
        let folder = folder(&["model/a.obj", "textures/tex.png"]);
        std::os::unix::fs::symlink(folder.path().join("textures/tex.png"), folder.path().join("model/tex.png"))
            .unwrap();
        std::os::unix::fs::symlink(folder.path().join("textures"), folder.path().join("model/more")).unwrap();
        for name in ["tex.png", "/x/tex.png", "more/tex.png"] {
            assert_eq!(found(folder.path(), name, false), None, "{name}");
        }
        assert!(found(folder.path(), "more/tex.png", true).is_some());
    }
}
