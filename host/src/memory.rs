//! How much memory this process may still take, so that what does not fit is refused with a line and not ended by
//! the system.

use std::fs;
use std::path::{Component, Path, PathBuf};

use sysinfo::{MemoryRefreshKind, System};

/// The least of the limits on this process' memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Room {
    /// What may still be taken.
    pub bytes: u64,
    /// What limits it, in words.
    pub limit: &'static str,
}

impl Room {
    /// The room that there is now: the least of the limit on address space (`ulimit -v`), the limits of the control
    /// groups around this process, and what the machine has available.
    pub fn now() -> Room {
        let root = Path::new("/");
        let limits = [address_space(root).map(Room::less_threads), group(root), machine()];
        let least = limits.into_iter().flatten().min_by_key(|room| room.bytes);
        // Where the system does not say, no limit is assumed.
        least.unwrap_or(Room { bytes: u64::MAX, limit: "this system" })
    }

    /// Without the address space that the threads of a rendering will have, one a core.
    fn less_threads(self) -> Room {
        let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
        Room { bytes: self.bytes.saturating_sub(threads * THREAD), ..self }
    }

    /// Refuses what takes more than there is.
    ///
    /// # Errors
    /// What it would take, what there is and what limits it.
    pub fn check(&self, bytes: u64) -> Result<(), String> {
        if bytes <= self.bytes {
            return Ok(());
        }
        Err(format!("take about {} of memory, and {} leaves {}", size(bytes), self.limit, size(self.bytes)))
    }
}

/// The most memory that this process held at once, in bytes, where the system tells it.
pub fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    Some(field(&status, "VmHWM:")? * 1024)
}

/// Bytes in a unit that gives a few digits.
fn size(bytes: u64) -> String {
    match bytes {
        0..1_000_000_000 => format!("{} MB", bytes / 1_000_000),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// Memory without swapping, and swap.
fn machine() -> Option<Room> {
    let mut system = System::new().ok()?;
    system.refresh_memory_specifics(MemoryRefreshKind::everything());
    Some(Room { bytes: system.available_memory() + system.free_swap(), limit: "this machine" })
}

/// Address space that the C library sets aside for a thread's allocations (64 MiB) and its stack, taken or not.
const THREAD: u64 = 68 << 20;

/// What `ulimit -v` leaves of the address space. Systems without these files do not enforce it.
fn address_space(root: &Path) -> Option<Room> {
    let limits = fs::read_to_string(root.join("proc/self/limits")).ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    let status = fs::read_to_string(root.join("proc/self/status")).ok()?;
    let taken: u64 = field(&status, "VmSize:")? * 1024;
    Some(Room { bytes: most.saturating_sub(taken), limit: "the limit on address space (ulimit -v)" })
}

/// What the control groups around this process leave, the least of all of them.
fn group(root: &Path) -> Option<Room> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let rooms = groups.lines().flat_map(|line| {
        let mut fields = line.splitn(3, ':').skip(1);
        match (fields.next(), fields.next()) {
            (Some(""), Some(path)) => around(&root.join("sys/fs/cgroup"), path, &SECOND),
            (Some(kinds), Some(path)) if kinds.split(',').any(|kind| kind == "memory") => {
                around(&root.join("sys/fs/cgroup/memory"), path, &FIRST)
            }
            _ => Vec::new(),
        }
    });
    let bytes = rooms.min()?;
    Some(Room { bytes, limit: "the memory limit of its control group" })
}

/// The files of a version of control groups.
struct Version {
    most: &'static str,
    taken: &'static str,
    /// Of `memory.stat`: pages of files, which are given back where memory is short.
    cached: [&'static str; 2],
}

const FIRST: Version = Version {
    most: "memory.limit_in_bytes",
    taken: "memory.usage_in_bytes",
    cached: ["total_inactive_file", "total_active_file"],
};

const SECOND: Version =
    Version { most: "memory.max", taken: "memory.current", cached: ["inactive_file", "active_file"] };

/// What the group at `path` and each of those around it leave. A container may see its own group as the outermost,
/// at another path than the one reported, so paths that do not exist are skipped.
fn around(outermost: &Path, path: &str, version: &Version) -> Vec<u64> {
    let names = Path::new(path).components().filter(|part| matches!(part, Component::Normal(_)));
    let inside: PathBuf = names.collect();
    inside.ancestors().filter_map(|group| left(&outermost.join(group), version)).collect()
}

fn left(group: &Path, version: &Version) -> Option<u64> {
    let number = |name: &str| fs::read_to_string(group.join(name)).ok()?.trim().parse::<u64>().ok();
    let stat = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let cached = version.cached.iter().filter_map(|name| field(&stat, name)).sum();
    let taken = number(version.taken)?.saturating_sub(cached);
    Some(number(version.most)?.saturating_sub(taken))
}

/// The number after a name at the start of a line.
fn field(text: &str, name: &str) -> Option<u64> {
    let mut lines = text.lines().map(|line| line.split_whitespace());
    let mut words = lines.find_map(|mut words| (words.next() == Some(name)).then_some(words))?;
    words.next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root of these files.
    fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, content) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
        root
    }

    #[test]
    fn address_space_is_what_the_limit_leaves() {
        let status = ("proc/self/status", "Name:\teyerays\nVmSize:\t    1024 kB\n");
        let limits = |most: &'static str| ("proc/self/limits", most);
        let some = root(&[status, limits("Limit  Soft  Hard  Units\nMax address space   4194304  unlimited  bytes\n")]);
        assert_eq!(address_space(some.path()).unwrap().bytes, 4194304 - 1024 * 1024);
        let none = root(&[status, limits("Max address space  unlimited  unlimited  bytes\n")]);
        assert_eq!(address_space(none.path()), None);
        assert_eq!(address_space(root(&[]).path()), None);
    }

    #[test]
    fn the_narrowest_of_nested_groups_counts_and_pages_of_files_are_free() {
        let nested = root(&[
            ("proc/self/cgroup", "1:name=systemd:/x\n0::/outer/inner\n"),
            ("sys/fs/cgroup/outer/memory.max", "5000\n"),
            ("sys/fs/cgroup/outer/memory.current", "4000\n"),
            ("sys/fs/cgroup/outer/memory.stat", "anon 1\ninactive_file 300\nactive_file 200\n"),
            ("sys/fs/cgroup/outer/inner/memory.max", "max\n"),
            ("sys/fs/cgroup/outer/inner/memory.current", "10\n"),
        ]);
        assert_eq!(group(nested.path()).unwrap().bytes, 1500);
        let container = root(&[
            ("proc/self/cgroup", "5:cpu,memory:/docker/0123\n0::/\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "7000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "6000\n"),
            ("sys/fs/cgroup/memory/memory.stat", "inactive_file 9\ntotal_inactive_file 100\n"),
        ]);
        assert_eq!(group(container.path()).unwrap().bytes, 1100);
        assert_eq!(group(root(&[("proc/self/cgroup", "0::/\n")]).path()), None);
    }

    #[test]
    fn there_is_room_for_a_megabyte_and_not_for_all_that_can_be_numbered() {
        let room = Room::now();
        assert_eq!(room.check(1_000_000), Ok(()));
        let refusal = room.check(u64::MAX).unwrap_err();
        assert!(refusal.starts_with("take about 18446744073.7 GB of memory, and ") && refusal.contains(" leaves "));
    }
}
