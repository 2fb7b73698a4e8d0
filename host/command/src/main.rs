//! The command `eyerays`.

fn main() -> std::process::ExitCode {
    eyerays_command::cli::run()
}
