//! `giveway database`: checks the server's database, copies it while the server runs, puts a copy back.
//!
//! Main type: [`Database`]. Exit codes: 0 all is well, 1 something is wrong or was refused. A copy is checked before it
//! gets its name, a source before anything is moved. Refuses: to overwrite a file, and to touch a database that a
//! server has.

use super::sim::Setup;
use crate::fleet::{Fleet, Ledger};
use crate::server::{Config, Flags};
use crate::store::{Store, seal};
use crate::warehouse::Warehouse;
use anyhow::{Context, ensure};
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `database`.
#[derive(Args)]
pub struct Database {
    #[command(subcommand)]
    command: Command,
    /// The database, as for `giveway serve` [default: giveway.sqlite] [env: GIVEWAY_DATABASE]
    #[arg(long, value_name = "FILE", global = true)]
    database: Option<PathBuf>,
    /// The scenario with whose map the journal is folded, as for `giveway serve` [env: GIVEWAY_SCENARIO]
    #[arg(long, value_name = "FILE", global = true)]
    scenario: Option<PathBuf>,
    /// Settings file of the server [env: GIVEWAY_CONFIG]
    #[arg(long, value_name = "FILE", global = true)]
    config: Option<PathBuf>,
    /// Print JSON
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Look for damage, load the journal and fold it. Also while a server runs; nothing is changed.
    Check,
    /// Write all that is committed into a new file, and check that. Also while a server runs.
    Backup {
        /// The new file.
        target: PathBuf,
    },
    /// Put a backup in the place of the database, after checking it. What is there is moved aside.
    Restore {
        /// The backup.
        source: PathBuf,
    },
}

/// What was found in a database.
#[derive(Debug, Serialize)]
struct Report {
    /// Whether nothing is wrong.
    ok: bool,
    /// Which file was looked at.
    database: PathBuf,
    /// Size of the main file.
    bytes: u64,
    /// Name of the map to which it belongs.
    map: Option<String>,
    /// Facts in the journal.
    facts: usize,
    /// When the last of them happened.
    last: Option<String>,
    /// Jobs, and those of them that are not over.
    jobs: u64,
    open_jobs: u64,
    /// Robots that the journal knows; nothing where it was not folded.
    robots: Option<usize>,
    /// What is wrong, or was not looked at.
    problems: Vec<String>,
    notes: Vec<String>,
    /// Where a backup is, or what was moved aside by restoring one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<PathBuf>,
}

/// The map to fold with, and whether it was asked for.
type Floor = Option<(Arc<Warehouse>, crate::fleet::Settings)>;

impl Database {
    /// Runs the command.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let Database { command, database, scenario, config, json } = self;
        let named = scenario.is_some();
        let config = Config::read(&Flags { database, scenario, config, ..Flags::default() })?;
        let floor = if named || config.scenario.exists() {
            let setup = Setup::read(&config.scenario, None, None)?;
            Some((setup.warehouse, setup.scenario.settings()))
        } else {
            None
        };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let report = runtime.block_on(async {
            match &command {
                Command::Check => check(&config.database, floor, named).await,
                Command::Backup { target } => backup(&config.database, target, floor, named).await,
                Command::Restore { source } => restore(source, &config.database, floor, named).await,
            }
        })?;
        if json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            show(&command, &report);
        }
        Ok(if report.ok { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

/// Opens a database that is there, to be read.
async fn inspect(path: &Path) -> anyhow::Result<Store> {
    ensure!(path.is_file(), "there is no database {}: name it with --database FILE", path.display());
    Ok(Store::inspect(path).await?)
}

async fn check(path: &Path, floor: Floor, named: bool) -> anyhow::Result<Report> {
    let store = inspect(path).await?;
    let report = examine(&store, floor, named).await;
    store.close().await;
    report
}

/// Everything that can be said about a database without changing it.
async fn examine(store: &Store, floor: Floor, named: bool) -> anyhow::Result<Report> {
    let path = store.path();
    let bytes = std::fs::metadata(path).map_or(0, |m| m.len());
    let mut report = Report {
        ok: true,
        database: path.into(),
        bytes,
        map: None,
        facts: 0,
        last: None,
        jobs: 0,
        open_jobs: 0,
        robots: None,
        problems: store.integrity().await?,
        notes: Vec::new(),
        files: Vec::new(),
    };
    if let Err(e) = look_inside(store, floor, named, &mut report).await {
        report.problems.push(format!("{e:#}"));
    }
    report.ok = report.problems.is_empty();
    Ok(report)
}

async fn look_inside(store: &Store, floor: Floor, named: bool, report: &mut Report) -> anyhow::Result<()> {
    let about = store.belongs().await.context("this is no database of Giveway")?;
    let about = about.context("this database of Giveway belongs to no map: it was never used")?;
    report.map = Some(about.map.clone());
    let (facts, last) = store.scan().await?;
    (report.jobs, report.open_jobs) = store.count_jobs().await?;
    report.facts = facts;
    let time = |t: crate::time::Time| jiff::Timestamp::from_microsecond(t.0).map(|t| t.to_string());
    report.last = last.map(time).transpose()?;
    let other = |map: &Warehouse| {
        format!(
            "the journal was not folded: it belongs to the map \"{}\", and this is \"{}\"",
            about.map, map.name
        )
    };
    match floor {
        None => report.notes.push("the journal was not folded: name its scenario with --scenario".into()),
        Some((map, _)) if seal(&map) != about.seal && named => report.problems.push(other(&map)),
        Some((map, _)) if seal(&map) != about.seal => report.notes.push(other(&map)),
        Some((map, settings)) => {
            let loaded = store.load(Ledger::new(map, settings.kinematics.clearance, false)).await?;
            let (ledger, facts) = loaded.into_parts();
            let fold = move || Fleet::resume(ledger, settings, facts).ledger().robots.len();
            let folded = tokio::task::spawn_blocking(fold).await;
            report.robots = Some(folded.ok().context("the journal contradicts itself, as said above")?);
        }
    }
    Ok(())
}

async fn backup(path: &Path, target: &Path, floor: Floor, named: bool) -> anyhow::Result<Report> {
    ensure!(
        !target.exists(),
        "{} is there already: a backup never overwrites; name another",
        target.display()
    );
    let mut partial = target.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    if partial.exists() {
        std::fs::remove_file(&partial).with_context(|| format!("cannot remove {}", partial.display()))?;
    }
    let store = inspect(path).await?;
    let copied = store.copy_to(&partial).await;
    store.close().await;
    copied?;
    let mut report = check(&partial, floor, named).await?;
    if report.ok {
        // Whoever makes the name owns it: a file that came meanwhile is not overwritten.
        let claim = std::fs::File::create_new(target).and_then(|_| std::fs::rename(&partial, target));
        claim.with_context(|| format!("cannot write {}", target.display()))?;
        report.database = target.into();
        report.files.push(target.into());
    }
    Ok(report)
}

async fn restore(source: &Path, path: &Path, floor: Floor, named: bool) -> anyhow::Result<Report> {
    let store = inspect(source).await?;
    let mut report = examine(&store, floor, named).await?;
    if report.ok {
        let now = jiff::Timestamp::now().strftime("%Y-%m-%dT%H%M%SZ").to_string();
        report.files = store.restore(path, &now).await?;
        report.database = path.into();
    }
    store.close().await;
    Ok(report)
}

fn show(command: &Command, report: &Report) {
    println!("database {} ({:.1} MB)", report.database.display(), report.bytes as f64 / 1e6);
    println!("map      {}", report.map.as_deref().unwrap_or("none"));
    let last = report.last.as_deref().map_or(String::new(), |t| format!(", the last of {t}"));
    println!("journal  {} facts{last}", report.facts);
    println!("jobs     {}, of which {} are not over", report.jobs, report.open_jobs);
    if let Some(robots) = report.robots {
        println!("folded   without contradiction: {robots} robots");
    }
    report.notes.iter().for_each(|note| println!("note     {note}"));
    report.problems.iter().for_each(|problem| println!("PROBLEM  {problem}"));
    let verb = match command {
        Command::Check => "",
        Command::Backup { .. } => "written ",
        Command::Restore { .. } => "aside   ",
    };
    report.files.iter().for_each(|file| println!("{verb} {}", file.display()));
    println!("{}", if report.ok { "ok" } else { "not ok: nothing was changed" });
}
