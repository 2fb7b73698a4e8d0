//! Whether files have changed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};

/// A program may write a file in several steps: it is read so long after the last of them.
const QUIET: Duration = Duration::from_millis(150);

/// What is known of the files that are watched.
#[derive(Default)]
struct Seen {
    watched: BTreeSet<PathBuf>,
    changed: Option<Instant>,
}

/// Files that are watched. Without a watcher, as where a system has too few of them, nothing ever changes.
pub(crate) struct Files {
    watcher: Option<RecommendedWatcher>,
    seen: Arc<Mutex<Seen>>,
    folders: BTreeSet<PathBuf>,
}

impl Files {
    /// Watches none yet. `wake` is called when one has changed.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Files {
        let seen = Arc::<Mutex<Seen>>::default();
        let own = seen.clone();
        let hear = move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else { return };
            if matches!(event.kind, EventKind::Access(_)) {
                return;
            }
            let mut seen = own.lock().unwrap_or_else(PoisonError::into_inner);
            if event.paths.iter().any(|path| seen.watched.contains(path)) {
                seen.changed = Some(Instant::now());
                drop(seen);
                wake();
            }
        };
        let watcher = notify::recommended_watcher(hear).ok();
        Files { watcher, seen, folders: BTreeSet::new() }
    }

    /// Watches these and no others. Their folders are watched, since programs put another file in the place of one.
    pub fn watch(&mut self, files: &[PathBuf]) {
        let files: BTreeSet<PathBuf> = files.iter().filter_map(|file| std::path::absolute(file).ok()).collect();
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.watched == files {
            return;
        }
        let folders: BTreeSet<PathBuf> = files.iter().filter_map(|file| file.parent()).map(Path::to_owned).collect();
        (seen.watched, seen.changed) = (files, None);
        drop(seen);
        let Some(watcher) = &mut self.watcher else { return };
        for gone in self.folders.difference(&folders) {
            let _ = watcher.unwatch(gone);
        }
        for new in folders.difference(&self.folders) {
            // A folder that can't be watched is not.
            let _ = watcher.watch(new, RecursiveMode::NonRecursive);
        }
        self.folders = folders;
    }

    /// How long until what has changed is to be read: no time at all once, and none if nothing has changed.
    pub fn due(&mut self) -> Option<Duration> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let left = QUIET.saturating_sub(seen.changed?.elapsed());
        if left.is_zero() {
            seen.changed = None;
        }
        Some(left)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn changes_within(files: &mut Files, time: Duration) -> bool {
        let start = Instant::now();
        while start.elapsed() < time {
            if files.due() == Some(Duration::ZERO) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        false
    }

    #[test]
    fn a_file_that_is_written_or_replaced_has_changed_and_its_neighbour_does_not_matter() {
        let folder = tempfile::tempdir().unwrap();
        let (file, other) = (folder.path().join("scene.toml"), folder.path().join("other.toml"));
        fs::write(&file, "a").unwrap();
        let mut files = Files::new(|| ());
        files.watch(std::slice::from_ref(&file));
        fs::write(&other, "b").unwrap();
        assert!(!changes_within(&mut files, Duration::from_millis(400)));
        fs::write(&file, "c").unwrap();
        assert!(changes_within(&mut files, Duration::from_secs(20)));
        fs::rename(&other, &file).unwrap();
        assert!(changes_within(&mut files, Duration::from_secs(20)));
        assert!(!changes_within(&mut files, Duration::from_millis(400)));
    }
}
