//! What can go wrong, each in one line that names the remedy.

use std::path::{Path, PathBuf};

/// The result of every fallible function here.
pub type Result<T> = std::result::Result<T, Error>;

/// A failure of the build; its text is one line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be read or written.
    #[error("cannot {action} {path}: {source}")]
    File {
        /// What was tried.
        action: &'static str,
        /// On which file.
        path: PathBuf,
        /// Why it failed.
        source: std::io::Error,
    },
    /// No usable compiler.
    #[error("no rust-gpu compiler: {0}; name one with --toolchain and --codegen")]
    Compiler(String),
    /// A variable of the environment would change the modules.
    #[error("{0} is set and would change the modules; unset it")]
    Environment(&'static str),
    /// The kernels do not compile.
    #[error("the kernels do not compile: {0}; the compiler's messages are above")]
    Compile(String),
    /// The compiler's module is not what a pass expects.
    #[error("unexpected SPIR-V: {0}")]
    Malformed(String),
    /// No entry point has a prefix of a module.
    #[error("no entry point is of the module `{0}`; add one to shader/src/entry/kernels.rs or drop the module")]
    NoEntry(&'static str),
    /// A pass cannot work on the compiler's module.
    #[error(transparent)]
    Pass(#[from] eyerays_passes::Error),
    /// A function that must be protected was inlined.
    #[error("`{0}` is no function of its own; pass it values, not references, and let nothing in it panic")]
    Unprotected(&'static str),
    /// An instruction that a module's policy forbids.
    #[error("`{function}` holds {what}, which {why}")]
    Forbidden {
        /// The function's name in the source.
        function: String,
        /// The instruction, type or constant.
        what: String,
        /// The reason and the way out.
        why: &'static str,
    },
    /// A pointer that drivers cannot follow.
    #[error("{0}; pass references apart, or inline the code that holds them together")]
    Pointer(String),
    /// `spirv-val` refuses a module.
    #[error("spirv-val refuses {module}: {message}")]
    Invalid {
        /// The module's name.
        module: &'static str,
        /// The validator's first line.
        message: String,
    },
    /// The modules outgrew what is committed.
    #[error("the modules hold {bytes} bytes, more than {limit}; share code between entry points")]
    TooLarge {
        /// Their size together.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// A committed file differs from a fresh build.
    #[error("{0} is stale; run: {command}", command = crate::output::COMMAND)]
    Stale(PathBuf),
    /// The lock file or the manifest lacks something.
    #[error("{path}: {problem}")]
    Record {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}

impl Error {
    /// Wraps an input or output failure: `.map_err(Error::file("read", path))`.
    pub fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Error::File { action, path, source }
    }

    /// A record at `path` that cannot be used.
    pub fn record(path: &Path, problem: impl ToString) -> Self {
        Error::Record { path: path.to_owned(), problem: one_line(&problem.to_string()) }
    }
}

/// `text` without its line breaks.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
