//! `giveway serve`: runs the server until it is told to stop.
//!
//! Main type: [`Serve`]. Prints on standard output where the server listens and what it restored; traces go to standard
//! error. Refuses: to end with 0 if anything was lost.

use super::sim::Setup;
use crate::server::{Config, Flags, ServedFloor, Server};
use anyhow::Context;
use clap::Args;
use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// Arguments of `serve`.
#[derive(Args, Default)]
pub struct Serve {
    #[command(flatten)]
    flags: Flags,
    /// What was learned about people (`giveway learn`); the scenario's own, or the built-in figures, if absent.
    #[arg(long)]
    model: Option<std::path::PathBuf>,
    /// What was learned about pickers (`giveway learn picks`); the built-in figures if absent.
    #[arg(long)]
    pick_model: Option<std::path::PathBuf>,
    /// A map other than the scenario's, in any format that `map import` knows. The database is carried over to it. A
    /// map published to the running server since then takes precedence over the same file.
    #[arg(long)]
    map: Option<std::path::PathBuf>,
    /// How many times as fast as real time the floor runs. Only a floor on which everything is simulated can: no
    /// robots of other vendors, and no headsets. The floor's clock runs ahead of the system's, and stays ahead in this
    /// database.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=20))]
    speed: u32,
}

impl Serve {
    /// Serves until SIGINT or SIGTERM.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        trace_to_stderr();
        #[cfg(unix)]
        keep_files_private();
        let config = Config::read(&self.flags)?;
        #[cfg(unix)]
        warn_of_readers(&config.database);
        let floor = config.floor();
        let mut setup = match Setup::of_floor(&floor, self.map.as_deref()) {
            Err(e) if !floor.path().exists() => return Err(e.context(NOTHING)),
            read => read?,
        };
        setup.use_model(self.model.as_deref())?;
        setup.use_pick_model(self.pick_model.as_deref())?;
        setup.use_robots(config.broker()?, config.robots.as_deref())?;
        if let Some(word) = &config.method {
            let refused = "the setting `method` is refused";
            let site = &mut setup.scenario.site;
            site.method =
                giveway_site::words::method_of(word).map_err(anyhow::Error::msg).context(refused)?;
            site.check_method(&setup.warehouse, "method").context(refused)?;
        }
        let mut floor = setup.served();
        floor.source.speed = self.speed;
        if self.speed > 1 && floor.source.simulation().is_none() {
            anyhow::bail!(REAL);
        }
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(serve(&config, floor))?;
        Ok(ExitCode::SUCCESS)
    }
}

/// The server's files show which person was where: files and folders are accessible only to the server's own user.
#[cfg(unix)]
fn keep_files_private() {
    use rustix::fs::Mode;
    rustix::process::umask(Mode::RWXG | Mode::RWXO);
}

/// A database that other users of this machine may read is left so, since an operator may want that, but a warning is
/// logged.
#[cfg(unix)]
fn warn_of_readers(database: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let Ok(file) = std::fs::metadata(database) else { return };
    let others = file.permissions().mode() & 0o077;
    if others != 0 {
        let path = database.display();
        tracing::warn!("{path} can be used by other users of this machine; `chmod go= {path}*` ends that");
    }
}

/// Sends traces to standard error; `RUST_LOG` selects them.
pub(super) fn trace_to_stderr() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .init();
}

/// The error if no floor is named.
const NOTHING: &str = "there is nothing to run: name a site with --site, or a scenario with --scenario";

/// The error if a floor that is not simulated is to be fast.
const REAL: &str = "--speed is for floors on which everything is simulated; robots of other vendors live in real time: \
                    leave --speed out";

/// Prints a line; the server goes on if its output was closed.
macro_rules! say {
    ($($argument:tt)*) => { super::out::tell(format_args!($($argument)*)) };
}

async fn serve(config: &Config, floor: ServedFloor) -> anyhow::Result<()> {
    let speed = floor.source.speed;
    outlive_limits().context("cannot prepare for a limit on the size of files")?;
    // A start may wait indefinitely for room on the disk.
    let mut server = tokio::select! {
        server = Server::start(config, floor) => server?,
        signal = asked_to_stop() => {
            signal?;
            say!("stopped before the start was over; nothing was accepted");
            return Ok(());
        }
    };
    let found = server.summary();
    let scheme = if server.identity().is_some() { "https" } else { "http" };
    say!("Giveway is at {scheme}://{}/", server.address());
    if let Some(identity) = server.identity() {
        say!("tls      {}, SHA-256 {}", identity.certificate.display(), identity.fingerprint);
        if !identity.names.is_empty() {
            say!("         self-signed, for {}", identity.names.join(", "));
        }
    }
    match found.robots {
        0 if found.listed == 0 => say!("map      {}, no robots: the site has no link to any", found.map),
        0 => say!("map      {}", found.map),
        robots => say!("map      {}, {robots} robots (simulated)", found.map),
    }
    if speed > 1 {
        say!("speed    {speed} times as fast as time: the floor's clock runs ahead of this machine's");
    }
    if let Some(broker) = &found.broker {
        say!("broker   {broker}, {} robots are listed", found.listed);
    }
    if let Some(map) = &found.published {
        let at = jiff::Timestamp::from_microsecond(map.at.0)?;
        say!("         published by {} at {at} (number {}); the map file is not used", map.by, map.number);
    }
    say!("database {}", config.database.display());
    say!("restored {} jobs ({} not over) from {} facts", found.jobs, found.open_jobs, found.facts);
    if let Some(why) = found.idle {
        say!("jobs     {why}");
    }
    if let Some(trouble) = &found.trouble {
        say!("BROKEN   {trouble}");
    }
    say!("Giveway is an efficiency layer, not a safety function.");
    tokio::select! {
        ended = server.ended() => return ended,
        signal = asked_to_stop() => signal?,
    }
    say!("stopping");
    server.stop().await?;
    say!("stopped; everything is written");
    Ok(())
}

/// Treats a file that may not grow any more (RLIMIT_FSIZE, `ulimit -f`) as a full disk, not as the end: a process that
/// handles SIGXFSZ gets an error for writes beyond the limit. The handler stays for good; nothing waits for the signal.
#[cfg(unix)]
fn outlive_limits() -> std::io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    /// The number is the same on Linux except MIPS, on macOS and on the BSDs.
    const SIGXFSZ: i32 = 25;
    signal(SignalKind::from_raw(SIGXFSZ)).map(drop)
}

#[cfg(not(unix))]
fn outlive_limits() -> std::io::Result<()> {
    Ok(())
}

#[cfg(unix)]
pub(super) async fn asked_to_stop() -> std::io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate())?;
    tokio::select! {
        interrupted = tokio::signal::ctrl_c() => interrupted,
        _ = terminate.recv() => Ok(()),
    }
}

#[cfg(not(unix))]
pub(super) async fn asked_to_stop() -> std::io::Result<()> {
    tokio::signal::ctrl_c().await
}
