//! `eyerays completions` and `eyerays manual`: what shells and `man` know of the command line.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use super::{Cli, console, plural};
use crate::error::{Error, Result};
use crate::output;

pub(super) const COMPLETIONS: &str = "\
Examples:
  eyerays completions bash > ~/.local/share/bash-completion/completions/eyerays
  eyerays completions zsh > ~/.zfunc/_eyerays
  eyerays completions fish > ~/.config/fish/completions/eyerays.fish
  eyerays completions powershell >> $PROFILE";

pub(super) const MANUAL: &str = "\
Examples:
  eyerays manual ~/.local/share/man/man1
  man eyerays-render";

#[derive(Args)]
pub(super) struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub fn run(&self) -> Result<ExitCode> {
        // Into memory: clap panics where standard output fails.
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "eyerays", &mut script);
        console::print(&String::from_utf8_lossy(&script))?;
        Ok(ExitCode::SUCCESS)
    }
}

#[derive(Args)]
pub(super) struct Manual {
    /// A folder for the pages, which is made where it is missing
    folder: PathBuf,
}

impl Manual {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let cannot = |error: std::io::Error| {
            Error::new(format!("{}: can't be made: {error}: name a folder for the pages", self.folder.display()))
        };
        fs::create_dir_all(&self.folder).map_err(cannot)?;
        let pages = pages();
        for (name, page) in &pages {
            write(&self.folder.join(name), page)?;
        }
        if !quiet {
            console::say(format_args!("wrote {} to {}", plural(pages.len(), "page"), self.folder.display()));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn write(path: &Path, page: &[u8]) -> Result<()> {
    output::write_atomically(path, |out| out.write_all(page).map_err(|error| output::write_error(&error)))
}

/// Each page with its name: of the program, and of each of its commands.
fn pages() -> Vec<(String, Vec<u8>)> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let of_commands = program.get_subcommands().map(|command| {
        let name = format!("eyerays-{}", command.get_name());
        page(command.clone().display_name(name))
    });
    [page(program.clone())].into_iter().chain(of_commands).collect()
}

fn page(of: Command) -> (String, Vec<u8>) {
    let man = Man::new(of);
    let mut page = Vec::new();
    man.render(&mut page).expect("memory takes any number of bytes");
    (man.get_filename(), page)
}
