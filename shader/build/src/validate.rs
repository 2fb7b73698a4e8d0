//! `spirv-val`, where it is installed.

use std::io::{ErrorKind, Write};
use std::process::{Command, Stdio};

use crate::error::one_line;
use crate::{Error, Result};

/// What became of a validation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Validation {
    /// The module is valid.
    Passed,
    /// There is no validator.
    Skipped,
}

/// Validates the bytes of a module's file.
pub fn run(module: &'static str, bytes: &[u8]) -> Result<Validation> {
    let invalid = |message: String| Error::Invalid { module, message };
    let child = Command::new("spirv-val")
        .args(["--target-env", "vulkan1.2", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match child {
        Ok(child) => child,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Validation::Skipped),
        Err(e) => return Err(invalid(e.to_string())),
    };
    if let Some(mut input) = child.stdin.take() {
        // A validator that stops reading early says why in its output.
        let _ = input.write_all(bytes);
    }
    let output = child.wait_with_output().map_err(|e| invalid(e.to_string()))?;
    if output.status.success() {
        return Ok(Validation::Passed);
    }
    let text = [output.stderr, output.stdout].concat();
    Err(invalid(one_line(&String::from_utf8_lossy(&text))))
}
