//! Standard output and standard error that may be closed by their reader, as by `head`.
//!
//! Main functions: [`line()`], [`text()`], behind `println!` and `print!` of all commands, and [`error_line`] behind
//! their `eprintln!`; [`tell`] for the server. A command that lost the reader of its output ends quietly with
//! [`CLOSED_PIPE`]. Refuses: to panic over it.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

/// The exit code of a program that SIGPIPE ended, as shells know it: 128 and the number of the signal.
pub const CLOSED_PIPE: i32 = 128 + 13;

/// `print!` for all commands: ends the process where the reader has left.
#[macro_export]
macro_rules! print {
    ($($argument:tt)*) => { $crate::cli::out::text(format_args!($($argument)*)) };
}

/// `println!` for all commands: ends the process where the reader has left.
#[macro_export]
macro_rules! println {
    () => { $crate::cli::out::text(format_args!("\n")) };
    ($($argument:tt)*) => { $crate::cli::out::line(format_args!($($argument)*)) };
}

/// `eprintln!` for all commands: a lost reader of standard error changes nothing about the work.
#[macro_export]
macro_rules! eprintln {
    ($($argument:tt)*) => { $crate::cli::out::error_line(format_args!($($argument)*)) };
}

/// Prints a line to standard error, if anybody reads that: notes about the work are not the work, so it goes on, and
/// the exit code says how it went.
pub fn error_line(line: Arguments<'_>) {
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}

/// Prints a line.
pub fn line(line: Arguments<'_>) {
    text(format_args!("{line}\n"));
}

/// Prints.
pub fn text(text: Arguments<'_>) {
    checked(io::stdout().lock().write_fmt(text));
}

/// Prints bytes.
pub fn bytes(bytes: &[u8]) {
    let mut out = io::stdout().lock();
    checked(out.write_all(bytes).and_then(|()| out.flush()));
}

/// Prints a line for its reader; a server goes on without one.
pub fn tell(line: Arguments<'_>) {
    let _ = io::stdout().lock().write_fmt(format_args!("{line}\n"));
}

fn checked(result: io::Result<()>) {
    let Err(e) = result else { return };
    if e.kind() != ErrorKind::BrokenPipe {
        eprintln!("giveway: cannot write to standard output: {e}");
        std::process::exit(1);
    }
    std::process::exit(CLOSED_PIPE);
}
