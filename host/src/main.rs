//! The command `eyerays`.

fn main() -> std::process::ExitCode {
    eyerays::cli::run()
}
