//! Interrupts: a rendering ends with the samples that are done; what is half-written goes; and the exit code tells the signal as
//! shells do.

use std::fs;
use std::io;
use std::sync::Arc;
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;
use signal_hook::{flag, low_level};

use super::{console, watching};
use crate::output;

/// Ends the process on an interrupt, a request to terminate or a terminal that hangs up, whatever it does then; but a rendering is
/// asked to end by itself first, and only the next signal ends it at once. A file that would be
/// larger than the system lets it is an error of writing, not a signal that ends the process at once.
///
/// # Errors
/// If the system gives no thread to wait in.
pub(super) fn watch() -> io::Result<()> {
    // With a handler, whatever it does, the write that was too much fails.
    flag::register(SIGXFSZ, Arc::default())?;
    let ignored = ignored();
    // Whoever started the process with a signal ignored, as `nohup` does, wants it to go on.
    let watched = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let mut signals = Signals::new(watched)?;
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for signal in signals.forever() {
            if watching::end_by(signal) {
                console::say("ending with the samples that are done; once more ends at once, without a picture");
                continue;
            }
            let _discarded = output::discard();
            low_level::exit(128 + signal);
        }
    })?;
    Ok(())
}

/// A bit for every signal that is ignored, as far as the system tells: Linux does.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
