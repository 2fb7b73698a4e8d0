//! All that the command says: messages to standard error, and text to standard output.
//!
//! What is said never stops what is done: a closed or full standard error is no fault, nor is a reader of standard
//! output that is gone. Names come from files and drivers of strangers; here they are made harmless for a terminal.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use indicatif::ProgressBar;
use serde::Serialize;

use crate::error::{Error, Result, printable, steers};
use crate::output::{Destination, write_error};

/// Says one line on standard error.
pub(super) fn say(line: impl Display) {
    // Nobody is left to tell.
    let _ = io::stderr().write_all(one_line(line).as_bytes());
}

/// Says on standard error what has several lines.
pub(super) fn say_text(text: &str) {
    let _ = io::stderr().write_all(lines(text).as_bytes());
}

/// Prints one line to standard output.
///
/// # Errors
/// If it is full.
pub(super) fn print_line(line: impl Display) -> Result<()> {
    print_bytes(one_line(line).as_bytes())
}

/// Prints to standard output what has several lines.
///
/// # Errors
/// If it is full.
pub(super) fn print(text: &str) -> Result<()> {
    print_bytes(lines(text).as_bytes())
}

/// Prints a value as JSON to standard output.
///
/// # Errors
/// If it is full.
pub(super) fn print_json(value: &impl Serialize) -> Result<()> {
    print(&json(value)?)
}

/// What came of printing to standard output by other means.
///
/// # Errors
/// If it is full.
pub(super) fn printed(result: io::Result<()>) -> Result<()> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("{}: {}", Destination::Stdout, write_error(&error).message)))
        }
        _ => Ok(()),
    }
}

/// JSON to read, which holds no character that steers a terminal but its line ends.
pub(super) fn json(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::new(e.to_string()))?;
    let escape = |c: char| if steers(c) && c != '\n' { format!("\\u{:04x}", u32::from(c)) } else { c.into() };
    Ok(text.chars().map(escape).collect::<String>() + "\n")
}

/// Moves a bar over named steps on by one.
pub(super) fn step(bar: &ProgressBar, name: &str) {
    bar.set_message(printable(name));
    bar.inc(1);
}

fn print_bytes(bytes: &[u8]) -> Result<()> {
    Destination::Stdout.write(|out| out.write_all(bytes).map_err(|e| write_error(&e)))
}

fn one_line(line: impl Display) -> String {
    printable(&line.to_string()) + "\n"
}

/// Every line by itself, the last one with an end.
fn lines(text: &str) -> String {
    text.strip_suffix('\n').unwrap_or(text).split('\n').map(one_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_said_steers_a_terminal_or_forges_a_line() {
        assert_eq!(one_line("a\x1b[2J\nerror: b\r\u{9b}1m\x7f"), "a\\u{1b}[2J\\nerror: b\\r\\u{9b}1m\\u{7f}\n");
        assert_eq!(lines("a\tb\n\x1b]0;c\x07\n"), "a\\tb\n\\u{1b}]0;c\\u{7}\n");
        assert_eq!(lines("no end"), "no end\n");
    }

    #[test]
    fn json_is_read_as_it_was_and_steers_no_terminal() {
        let value = serde_json::json!({ "name": "a\x1b[2J\u{9b}1m\x7f\u{202e}\u{2066}\nb\u{e9}" });
        let text = json(&value).unwrap();
        assert!(text.chars().all(|c| !steers(c) || c == '\n'), "{text:?}");
        assert_eq!(lines(&text), text, "what is printed is JSON, too");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
