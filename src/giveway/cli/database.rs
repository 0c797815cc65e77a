//! `giveway database`: checks the server's database, copies it while the server runs, restores a copy, carries the
//! database over to a changed map.
//!
//! Main type: [`DatabaseArgs`]. Exit codes: 0 the database is sound, 1 something is wrong or was refused. A copy is
//! checked before it gets its name, a source before anything is moved. Refuses: to overwrite a file, and to touch a
//! database that a server uses.

use super::files::{read_map, write};
use super::sim::Setup;
use crate::server::{Config, Flags};
use anyhow::{Context, ensure};
use clap::{Args, Subcommand};
use giveway_fleet::carry::Report as Differences;
use giveway_fleet::{Fleet, Ledger, Settings};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::formats::json;
use giveway_store::{Belongs, CarryOver, MapNote, Opening, Store, StoreError, seal};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `database`.
#[derive(Args)]
pub struct DatabaseArgs {
    #[command(subcommand)]
    command: DatabaseCommand,
    /// The database, as for `giveway serve` [default: giveway.sqlite] [env: GIVEWAY_DATABASE]
    #[arg(long, value_name = "FILE", global = true)]
    database: Option<PathBuf>,
    /// The scenario whose map the journal is folded with, as for `giveway serve` [env: GIVEWAY_SCENARIO]
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
enum DatabaseCommand {
    #[command(flatten)]
    Reported(ReportedCommand),
    /// Write the database's own map as a map file, for example a map that was published to the server. Works while a
    /// server runs.
    Map {
        /// The file to write; standard output if absent.
        #[arg(long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
}

/// Commands that end in a report about the database.
#[derive(Subcommand)]
enum ReportedCommand {
    /// Look for damage, load the journal and fold it. Works while a server runs and changes nothing. With a map other
    /// than the database's own, list what a start would carry over to it and what it would not.
    Check {
        /// A map other than the scenario's.
        #[arg(long, value_name = "FILE")]
        map: Option<PathBuf>,
    },
    /// Carry the database over to a changed map, as a start does, after a backup.
    Carry {
        /// The changed map; the scenario's if absent.
        #[arg(long, value_name = "FILE")]
        map: Option<PathBuf>,
        /// Carry the database over even if something is lost: jobs fail, assignments are cancelled, closures end, as
        /// listed.
        #[arg(long)]
        accept_losses: bool,
    },
    /// Let a database continue now although its last step is later, because the system's clock was wrong. Robots stay
    /// where they are, jobs that they had wait again, and a backup is made first.
    SetClock,
    /// Write everything committed into a new file and check that file. Works while a server runs.
    Backup {
        /// The new file.
        target: PathBuf,
    },
    /// Check a backup and replace the database by it; the database is moved aside.
    Restore {
        /// The backup.
        source: PathBuf,
    },
}

/// The effect of carrying a database over to another map.
#[derive(Debug, Serialize)]
struct Changed {
    /// Name of the other map.
    to: String,
    obstacles: Vec<String>,
    losses: Vec<String>,
    notes: Vec<String>,
}

impl Changed {
    fn new(to: &str, found: &Differences) -> Changed {
        Changed {
            to: to.to_owned(),
            obstacles: found.obstacles.iter().map(ToString::to_string).collect(),
            losses: found.losses.iter().map(ToString::to_string).collect(),
            notes: found.all_notes(),
        }
    }
}

/// The findings about a database.
#[derive(Debug, Serialize)]
struct DatabaseReport {
    /// Whether the database is sound.
    ok: bool,
    /// The file that was examined.
    database: PathBuf,
    /// Size of the main file, in bytes.
    bytes: u64,
    /// Name of the map to which the database belongs.
    map: Option<String>,
    /// How many facts the journal has.
    facts: usize,
    /// When the last fact happened.
    last: Option<String>,
    /// How many jobs there are, and how many of them are not over.
    jobs: u64,
    open_jobs: u64,
    /// How many robots the journal knows; nothing if it was not folded.
    robots: Option<usize>,
    /// Faults, and what could not be examined.
    problems: Vec<String>,
    notes: Vec<String>,
    /// What a start with the named map would do, if that is not the database's own map.
    #[serde(skip_serializing_if = "Option::is_none")]
    changed_map: Option<Changed>,
    /// The backup, or what was moved aside when one was restored.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<PathBuf>,
}

/// The map and settings with which to fold the journal; nothing if no map is known.
type FoldSettings = Option<(Arc<Warehouse>, Settings)>;

impl ReportedCommand {
    fn map(&self) -> Option<&Path> {
        match self {
            ReportedCommand::Check { map } | ReportedCommand::Carry { map, .. } => map.as_deref(),
            ReportedCommand::SetClock | ReportedCommand::Backup { .. } | ReportedCommand::Restore { .. } => {
                None
            }
        }
    }

    /// Whether the command uses the map that a start would use: the published one, if there is one.
    fn is_as_published(&self) -> bool {
        self.map().is_none() && !matches!(self, ReportedCommand::Carry { .. })
    }

    /// The file to read: the backup, or the database itself.
    fn read_from<'a>(&'a self, database: &'a Path) -> &'a Path {
        if let ReportedCommand::Restore { source } = self { source } else { database }
    }
}

impl DatabaseArgs {
    /// Runs the command.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let DatabaseArgs { command, database, scenario, config, json } = self;
        let readable = scenario.is_some();
        let config = Config::read(&Flags { database, scenario, config, ..Flags::default() })?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let command = match command {
            DatabaseCommand::Reported(command) => command,
            DatabaseCommand::Map { output } => {
                let text = runtime.block_on(map_of(&config.database))?;
                write(output.as_deref(), &text)?;
                return Ok(ExitCode::SUCCESS);
            }
        };
        let named = readable || command.map().is_some();
        let floor = if readable || config.floor().path().exists() {
            let floor = Setup::of_floor(&config.floor(), command.map())?.served();
            let file = command.read_from(&config.database);
            let floor = match command.is_as_published() {
                true => runtime.block_on(floor.with_map_of(file))?,
                false => floor,
            };
            Some((floor.map, floor.source.site().settings()))
        } else {
            command.map().map(read_map).transpose()?.map(|map| (map, Settings::default()))
        };
        let report = runtime.block_on(async {
            match &command {
                ReportedCommand::Check { .. } => check(&config.database, floor, named).await,
                ReportedCommand::Carry { accept_losses, .. } => carry(&config, floor, *accept_losses).await,
                ReportedCommand::SetClock => set_clock(&config, floor).await,
                ReportedCommand::Backup { target } => backup(&config.database, target, floor, named).await,
                ReportedCommand::Restore { source } => restore(source, &config.database, floor, named).await,
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

/// The database's own map as a map file.
async fn map_of(path: &Path) -> anyhow::Result<String> {
    let store = inspect(path).await?;
    let map = store.map().await;
    store.close().await;
    let none =
        "the database has no map yet: it was last used by a Giveway that did not write it down, or never";
    Ok(json::write(&map?.context(none)?))
}

/// Opens an existing database for reading.
async fn inspect(path: &Path) -> anyhow::Result<Store> {
    ensure!(path.is_file(), "there is no database {}: name it with --database FILE", path.display());
    Ok(Store::inspect(path).await?)
}

async fn look(path: &Path, floor: FoldSettings, named: bool) -> anyhow::Result<DatabaseReport> {
    let store = inspect(path).await?;
    let report = examine(&store, floor, named).await;
    store.close().await;
    report
}

async fn check(path: &Path, floor: FoldSettings, named: bool) -> anyhow::Result<DatabaseReport> {
    let mut report = look(path, floor, named).await?;
    if let Some(changed) = &report.changed_map {
        let (obstacles, losses) = (changed.obstacles.len(), changed.losses.len());
        let text = format!(
            "a start with the map \"{}\" is refused: {obstacles} obstacles and {losses} losses, as listed",
            changed.to
        );
        report.problems.extend((named && obstacles + losses > 0).then_some(text));
        report.ok = report.problems.is_empty();
    }
    Ok(report)
}

/// Carries a database over to the map; if that is refused, reports why.
async fn carry(config: &Config, floor: FoldSettings, accept_losses: bool) -> anyhow::Result<DatabaseReport> {
    let path = &config.database;
    ensure!(path.is_file(), "there is no database {}: name it with --database FILE", path.display());
    let (map, settings) = floor
        .clone()
        .context("name the changed map with --map FILE, or its scenario with --scenario FILE")?;
    let stamp = jiff::Timestamp::now().strftime("%Y-%m-%dT%H%M%SZ").to_string();
    let wanted = CarryOver { kinds: settings.site_kinds, accept_losses, stamp };
    let (traces, note) = (vec![config.past_folder()], MapNote::Forget);
    let opening = Opening { new: None, traces, carry: Some(wanted), note };
    let store = match Store::open_as(path, &map, &opening).await {
        Err(StoreError::ChangedMap { .. }) => return check(path, floor, true).await,
        opened => opened?,
    };
    let carried = store.carried().cloned();
    store.close().await;
    let mut report = check(path, floor, true).await?;
    match carried {
        None => report.notes.push("it belongs to this map already: there was nothing to carry over".into()),
        Some(carried) => {
            report.changed_map = Some(Changed::new(&map.name, &carried.report));
            report.files.extend(carried.backup);
        }
    }
    Ok(report)
}

/// Lets a database whose last step is later continue now.
async fn set_clock(config: &Config, floor: FoldSettings) -> anyhow::Result<DatabaseReport> {
    let path = &config.database;
    ensure!(path.is_file(), "there is no database {}: name it with --database FILE", path.display());
    let (map, settings) = floor.clone().context("name its scenario with --scenario FILE")?;
    let now = jiff::Timestamp::now();
    let stamp = now.strftime("%Y-%m-%dT%H%M%SZ").to_string();
    let store = Store::open_as(path, &map, &Opening::default()).await?;
    let folders = [config.past_folder()];
    let set =
        store.set_clock(&map, &settings.site_kinds, Time(now.as_microsecond()), (&folders, &stamp)).await;
    store.close().await;
    let set = set?;
    let mut report = check(path, floor, true).await?;
    match set {
        None => {
            report.notes.push("its last step is not later than it is now: there was nothing to set".into())
        }
        Some(carried) => {
            report.notes.extend(carried.report.notes);
            report.files.extend(carried.backup);
        }
    }
    Ok(report)
}

/// All findings about a database that need no change to it.
async fn examine(store: &Store, floor: FoldSettings, named: bool) -> anyhow::Result<DatabaseReport> {
    let path = store.path();
    let bytes = std::fs::metadata(path).map_or(0, |m| m.len());
    let mut report = DatabaseReport {
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
        changed_map: None,
        files: Vec::new(),
    };
    if let Err(e) = look_inside(store, floor, named, &mut report).await {
        report.problems.push(format!("{e:#}"));
    }
    report.ok = report.problems.is_empty();
    Ok(report)
}

async fn look_inside(
    store: &Store,
    floor: FoldSettings,
    named: bool,
    report: &mut DatabaseReport,
) -> anyhow::Result<()> {
    let about = store.belongs().await.context("this is not a Giveway database")?;
    let about = about.context("this Giveway database belongs to no map: it was never used")?;
    report.map = Some(about.map.clone());
    let (facts, last) = store.scan().await?;
    (report.jobs, report.open_jobs) = store.count_jobs().await?;
    report.facts = facts;
    let time = |t: giveway_floor::time::Time| jiff::Timestamp::from_microsecond(t.0).map(|t| t.to_string());
    report.last = last.map(time).transpose()?;
    let old_kinds = store.old_kinds().await?;
    match floor {
        _ if !old_kinds.is_empty() => report.notes.push(format!(
            "the journal was not folded: the kinds {} were added with an earlier Giveway; a start takes them up",
            old_kinds.join(", ")
        )),
        None => report.notes.push("the journal was not folded: name its scenario with --scenario".into()),
        Some((map, settings)) if seal(&map) != about.seal => {
            compare(store, &about, (map, settings), named, report).await?;
        }
        Some((map, settings)) => {
            let loaded = store.load(Ledger::new(map, &settings.site_kinds, false)).await?;
            let (ledger, facts) = loaded.into_parts();
            let fold = move || Fleet::resume(ledger, settings, facts).ledger().robots.len();
            let folded = tokio::task::spawn_blocking(fold).await;
            report.robots = Some(folded.ok().context("the journal contradicts itself, as said above")?);
        }
    }
    Ok(())
}

/// The effect of starting with another map. The journal is folded with the database's own map, if that is known.
async fn compare(
    store: &Store,
    about: &Belongs,
    (map, settings): (Arc<Warehouse>, Settings),
    named: bool,
    report: &mut DatabaseReport,
) -> anyhow::Result<()> {
    let (theirs, ours) = (&about.map, &map.name);
    match store.compare(&map, &settings.site_kinds).await {
        Ok(found) => {
            let found = found.unwrap_or_default();
            let text = format!("it belongs to the map \"{theirs}\"; compared with \"{ours}\" below");
            report.notes.push(text);
            report.changed_map = Some(Changed::new(ours, &found));
        }
        Err(StoreError::UnknownMap { .. }) => {
            let text = format!(
                "the journal was not folded: it belongs to the map \"{theirs}\", and this is \"{ours}\"; the map \
                 itself is not in the database until this Giveway has opened it once with that map"
            );
            if named { report.problems.push(text) } else { report.notes.push(text) }
        }
        Err(e) => return Err(e.into()),
    }
    Ok(())
}

async fn backup(
    path: &Path,
    target: &Path,
    floor: FoldSettings,
    named: bool,
) -> anyhow::Result<DatabaseReport> {
    ensure!(
        !target.exists(),
        "{} exists already: a backup never overwrites a file; name another",
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
    let mut report = look(&partial, floor, named).await?;
    if report.ok {
        // Creating the name claims it: a file that appeared meanwhile is not overwritten.
        let claim = std::fs::File::create_new(target).and_then(|_| std::fs::rename(&partial, target));
        claim.with_context(|| format!("cannot write {}", target.display()))?;
        report.database = target.into();
        report.files.push(target.into());
    }
    Ok(report)
}

async fn restore(
    source: &Path,
    path: &Path,
    floor: FoldSettings,
    named: bool,
) -> anyhow::Result<DatabaseReport> {
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

fn show(command: &ReportedCommand, report: &DatabaseReport) {
    println!("database {} ({:.1} MB)", report.database.display(), report.bytes as f64 / 1e6);
    println!("map      {}", report.map.as_deref().unwrap_or("none"));
    let last = report.last.as_deref().map_or(String::new(), |t| format!(", the last of {t}"));
    println!("journal  {} facts{last}", report.facts);
    println!("jobs     {}, of which {} are not over", report.jobs, report.open_jobs);
    if let Some(robots) = report.robots {
        println!("folded   without contradiction: {robots} robots");
    }
    report.notes.iter().for_each(|note| println!("note     {note}"));
    if let Some(changed) = &report.changed_map {
        println!("changed  to the map \"{}\"", changed.to);
        changed.obstacles.iter().for_each(|entry| println!("obstacle {entry}"));
        changed.losses.iter().for_each(|entry| println!("loss     {entry}"));
        changed.notes.iter().for_each(|entry| println!("map      {entry}"));
    }
    report.problems.iter().for_each(|problem| println!("PROBLEM  {problem}"));
    let verb = match command {
        ReportedCommand::Check { .. } => "",
        ReportedCommand::Carry { .. } | ReportedCommand::SetClock => "backup  ",
        ReportedCommand::Backup { .. } => "written ",
        ReportedCommand::Restore { .. } => "aside   ",
    };
    report.files.iter().for_each(|file| println!("{verb} {}", file.display()));
    println!("{}", if report.ok { "ok" } else { "not ok: nothing was changed" });
}
