//! The `giveway-lab` program: arguments only.

#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    giveway_lab::commands::run()
}
