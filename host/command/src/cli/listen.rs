//! `eyerays listen`.

use std::net::TcpListener;
use std::process::ExitCode;

use clap::Args;
use eyerays::gpu::Around;
use eyerays_view::Listening;

use super::console;
use super::hush;
use super::look::Shown;
use super::options::size;
use crate::error::{Error, Result};

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays listen
  eyerays render scenes/room.toml --live localhost:14158      # in another terminal";

#[derive(Args)]
pub(super) struct Listen {
    /// Where renderers send to; port 0 takes any that is free. The address is printed once the window is open
    #[arg(value_name = "HOST:PORT", default_value = "127.0.0.1:14158")]
    address: String,
    /// Columns and rows that there is room for at first [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,
    #[command(flatten)]
    shown: Shown,
}

impl Listen {
    pub fn run(&self) -> Result<ExitCode> {
        let Listen { address, size, shown } = self;
        let look = shown.encoding()?;
        let bound = TcpListener::bind(address).and_then(|listener| Ok((listener.local_addr()?, listener)));
        let (place, listener) = bound.map_err(|error| {
            let remedy = "name an address of this machine and a free port, such as 127.0.0.1:0";
            Error::new(format!("{address}: {error}: {remedy}"))
        })?;
        // Nobody may read it.
        let opened = Box::new(move || drop(console::print_line(place)));
        let around = Some(hush::around as Around);
        eyerays_view::listen(Listening { listener, size: *size, look, around, opened })?;
        Ok(ExitCode::SUCCESS)
    }
}
