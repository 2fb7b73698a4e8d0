//! The tip below an unknown option.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};
use eyerays::scene_io::nearest;

/// What clap says, but of an unknown option: that names the nearest one only if it is near. Clap's own tip names any that
/// shares some letters, or tells how to render a scene that is called like the option.
pub fn mended(mut said: Error, mut program: Command, arguments: &[String]) -> Error {
    let Some(unknown) = unknown(&said) else { return said };
    program.build();
    let mut names = arguments.iter().skip(1);
    let name = names.find(|argument| !argument.starts_with('-')).filter(|name| program.find_subcommand(name).is_some());
    let Some(command) = name.and_then(|name| program.find_subcommand_mut(name)) else { return said };
    said.remove(ContextKind::Suggested);
    said.remove(ContextKind::SuggestedArg);
    let known = command.get_arguments().filter_map(clap::Arg::get_long);
    if let Some(near) = nearest(&unknown, known) {
        said.insert(ContextKind::SuggestedArg, ContextValue::String(format!("--{near}")));
    }
    // Clap's shows the option that it thinks was meant.
    said.insert(ContextKind::Usage, ContextValue::StyledStr(command.render_usage()));
    said
}

/// The option that does not exist, without its dashes.
fn unknown(said: &Error) -> Option<String> {
    match (said.kind(), said.get(ContextKind::InvalidArg)?) {
        (ErrorKind::UnknownArgument, ContextValue::String(argument)) => argument.strip_prefix("--").map(str::to_owned),
        _ => None,
    }
}
