//! The progress of long work, and how long it takes.
//!
//! Main functions: [`progress`], [`stopwatch`]. Refuses: to draw if standard error is no terminal.

/// Nanoseconds of a monotonic clock, for the figures of a run.
pub fn stopwatch() -> u64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_nanos() as u64
}

/// A progress bar on standard error; hidden if that is no terminal.
pub fn progress(length: u64, what: &'static str) -> indicatif::ProgressBar {
    let style = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    indicatif::ProgressBar::new(length)
        .with_style(style.expect("the template is well-formed"))
        .with_message(what)
}
