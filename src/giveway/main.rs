//! The `giveway` program: arguments only.

#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    giveway::cli::run()
}
