//! What a command is doing, on standard error while that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Between two redraws of a stage's line.
const REDRAW: Duration = Duration::from_millis(100);

/// Does work that cannot be counted, such as building, under a line that names it and tells its time.
pub(super) fn stage<T>(name: &'static str, quiet: bool, work: impl FnOnce() -> T) -> T {
    let line = styled(ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}", quiet).with_message(name);
    line.tick();
    line.enable_steady_tick(REDRAW);
    let done = work();
    line.finish_and_clear();
    done
}

/// A bar over the pixels of a rendering.
pub(super) fn pixels(count: u64, quiet: bool) -> ProgressBar {
    styled(ProgressBar::new(count), "rendering {bar:40} {percent:>3} % {elapsed} (left {eta})", quiet)
}

/// A bar over the samples of each pixel.
pub(super) fn samples(count: u32, quiet: bool) -> ProgressBar {
    let template = "rendering {bar:40} {pos} of {len} samples{msg} {elapsed} (left {eta})";
    styled(ProgressBar::new(count.into()), template, quiet)
}

/// A bar over the cells of a picture that ends by its noise.
pub(super) fn cells(quiet: bool) -> ProgressBar {
    let template = "rendering {bar:40} {pos} of {len} cells{msg} {elapsed}";
    styled(ProgressBar::new(1), template, quiet)
}

/// A bar over named steps.
pub(super) fn steps(count: usize, quiet: bool) -> ProgressBar {
    styled(ProgressBar::new(count as u64), "{bar:40} {pos}/{len} {elapsed} (left {eta}) {wide_msg}", quiet)
}

fn styled(bar: ProgressBar, template: &str, quiet: bool) -> ProgressBar {
    match quiet {
        true => ProgressBar::hidden(),
        false => bar.with_style(ProgressStyle::with_template(template).expect("the template is valid")),
    }
}
