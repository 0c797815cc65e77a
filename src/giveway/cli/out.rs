//! Standard output and standard error, whose reader may close them, as `head` does.
//!
//! Main functions: [`line()`], [`text()`], behind `println!` and `print!` of all commands, and [`error_line`] behind
//! their `eprintln!`; [`tell`] for the server. A command whose output has lost its reader ends quietly with
//! [`CLOSED_PIPE`]. Refuses: to panic because of that.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};

/// The exit code that shells show for a program ended by SIGPIPE: 128 plus the number of the signal.
pub const CLOSED_PIPE: i32 = 128 + 13;

/// `print!` for all commands: ends the process if the reader has left.
#[macro_export]
macro_rules! print {
    ($($argument:tt)*) => { $crate::cli::out::text(format_args!($($argument)*)) };
}

/// `println!` for all commands: ends the process if the reader has left.
#[macro_export]
macro_rules! println {
    () => { $crate::cli::out::text(format_args!("\n")) };
    ($($argument:tt)*) => { $crate::cli::out::line(format_args!($($argument)*)) };
}

/// `eprintln!` for all commands: the work goes on even if standard error has lost its reader.
#[macro_export]
macro_rules! eprintln {
    ($($argument:tt)*) => { $crate::cli::out::error_line(format_args!($($argument)*)) };
}

/// Prints a line to standard error, if it is still open: notes about the work are not the work, so the work goes on,
/// and the exit code reports its result.
pub fn error_line(line: Arguments<'_>) {
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}

/// Prints a line.
pub fn line(line: Arguments<'_>) {
    text(format_args!("{line}\n"));
}

/// Prints a text.
pub fn text(text: Arguments<'_>) {
    checked(io::stdout().lock().write_fmt(text));
}

/// Prints bytes.
pub fn bytes(bytes: &[u8]) {
    let mut out = io::stdout().lock();
    checked(out.write_all(bytes).and_then(|()| out.flush()));
}

/// Prints a line; the server goes on even if its output has lost its reader.
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
