//! Virtual robots in real time, one line to the broker for each.
//!
//! Main type: [`VirtualArgs`]. The first Ctrl-C says OFFLINE for all of them. Refuses: to go on under a name that
//! another client has taken over.

use super::client::RobotClient;
use super::faults::FaultsFile;
use super::listing::{cannot, robots_file};
use super::places::{RobotPlace, of_file, of_map};
use crate::cli::files::{read, read_map, write};
use crate::cli::out::tell;
use crate::cli::serve::{asked_to_stop, trace_to_stderr};
use crate::mqtt::broker::{BrokerClient, BrokerFlags};
use crate::mqtt::{LineEvent, LineSetup, MqttLine};
use anyhow::{Context, bail, ensure};
use clap::{Args, ValueEnum};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_vda5050::robot::ChargingPlaces;
use giveway_vda5050::{Address, RobotSetup, Version};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

/// The time between two steps of a robot.
const TICK: Duration = Duration::from_millis(50);
/// Events of a line that wait for the next step.
const EVENTS: usize = 1_000;
/// The longest that taking leave may last.
const LEAVES: Duration = Duration::from_secs(2);

/// Arguments of `robot` without a subcommand.
#[derive(Args)]
pub struct VirtualArgs {
    #[command(flatten)]
    broker: BrokerFlags,
    /// The version of VDA 5050 that the robots speak: 2.0.0, 2.1.0 or 3.0.0 [default: 2.1.0, or that of --like]
    #[arg(long, value_name = "VERSION")]
    version: Option<String>,
    /// The map on which they drive, in any format that `map import` knows
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// How many robots there are, at parking places, chargers and under racks of the map [default: 1]
    #[arg(long, value_name = "N", conflicts_with = "places")]
    count: Option<usize>,
    /// Where the robots stand: {"robots": [{"serial", "node", "x", "y", "theta", "map"}]} (docs/robots.md)
    #[arg(long, value_name = "FILE")]
    places: Option<PathBuf>,
    /// The first level or levels of topics
    #[arg(long, value_name = "NAME", default_value = "uagv")]
    interface: String,
    /// The robots' manufacturer
    #[arg(long, value_name = "NAME", default_value = "giveway")]
    manufacturer: String,
    /// Write the file of robots for `giveway serve --robots`
    #[arg(long, value_name = "FILE")]
    robots_out: Option<PathBuf>,
    /// Faults of robots and of the network: {"giveway_faults": 1, "faults": [...]} (docs/robots.md)
    #[arg(long, value_name = "FILE")]
    faults: Option<PathBuf>,
    /// The seed from which faults are drawn
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Behave as a real robot was measured to: a (npm vda-5050-lib), b (PyPI vda5050-sdk), c (PyPI vda5050-core)
    #[arg(long, value_enum)]
    like: Option<RealRobot>,
}

/// A real implementation whose behaviour was measured.
#[derive(Clone, Copy, ValueEnum)]
enum RealRobot {
    A,
    B,
    C,
}

impl VirtualArgs {
    /// Runs the robots until the process is told to stop.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        trace_to_stderr();
        let line = self.broker.clone().or_environment().line()?;
        let (kind, setups) = self.setups()?;
        let addresses = setups.iter().map(|setup| Address::new(&setup.manufacturer, &setup.serial));
        let addresses = addresses.collect::<Result<Vec<Address>, _>>()?;
        let robots: Vec<(Address, RobotSetup)> = addresses.into_iter().zip(setups).collect();
        let faults = self.read_faults(&robots)?;
        if let Some(path) = &self.robots_out {
            let file = robots_file(&kind, &self.interface, &robots);
            write(Some(path), &(serde_json::to_string_pretty(&file)? + "\n"))?;
            println!("robots   {} is for `giveway serve --robots`", path.display());
        }
        if let Some((_, setup)) = robots.first() {
            println!("kind     {kind}, speaks {}", setup.version);
            cannot(setup).iter().for_each(|why| println!("         {why}"));
        }
        let clients = robots.into_iter().enumerate().map(|(i, (address, setup))| {
            println!("robot    {address} at {}", place_in_words(&setup));
            let faults = faults.of_robot(self.seed, i, address.serial());
            let name = format!("giveway-robot-{}-{}", address.manufacturer(), address.serial());
            (name, RobotClient::new(setup, address, &self.interface, faults, (self.seed, i)))
        });
        let clients = clients.collect();
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(drive(clients, Arc::new(line)))?;
        Ok(ExitCode::SUCCESS)
    }

    /// The name of the robots' kind, and what each robot is.
    fn setups(&self) -> anyhow::Result<(String, Vec<RobotSetup>)> {
        let path = self.map.as_deref().context("no map is named: add --map FILE")?;
        let map = read_map(path)?;
        let wanted = self.version.as_deref().map(|text| {
            Version::of_text(text)
                .with_context(|| format!("--version {text:?} is not spoken here: 2.0.0, 2.1.0 and 3.0.0 are"))
        });
        let wanted = wanted.transpose()?;
        let preset = self.like.map(|like| match like {
            RealRobot::A => ("like-a", "a", RobotSetup::like_a()),
            RealRobot::B => ("like-b", "b", RobotSetup::like_b()),
            RealRobot::C => ("like-c", "c", RobotSetup::like_c()),
        });
        let version = wanted.or(preset.as_ref().map(|(_, _, setup)| setup.version)).unwrap_or(Version::V2_1);
        let (kind, prefix, mut model) = match preset {
            Some((kind, prefix, setup)) => (kind.to_owned(), prefix.to_owned(), setup),
            None => {
                let short: String = version.text().chars().filter(char::is_ascii_digit).take(2).collect();
                let setup = RobotSetup::new(version, &self.manufacturer, "", &map.name, "");
                (format!("virtual-{version}"), format!("v{short}"), setup)
            }
        };
        model.version = version;
        self.fit(&mut model, &map);
        let places = match &self.places {
            Some(path) => {
                of_file(&read(path)?, &map).with_context(|| format!("{} is refused", path.display()))?
            }
            None => of_map(&map, self.count.unwrap_or(1), &prefix)?,
        };
        ensure!(!places.is_empty(), "--count 0 leaves nothing to do");
        let setup = |place: RobotPlace| RobotSetup {
            serial: place.serial,
            position: place.position,
            last_node: place.node,
            ..model.clone()
        };
        Ok((kind, places.into_iter().map(setup).collect()))
    }

    /// Tells a kind of robot of the map's nodes and chargers.
    fn fit(&self, model: &mut RobotSetup, map: &Warehouse) {
        model.manufacturer.clone_from(&self.manufacturer);
        model.places = map.nodes.iter().map(|node| (node.name.clone(), (node.at.x, node.at.y))).collect();
        let chargers = map.nodes_where(|kind| kind == NodeKind::Charger);
        let names = chargers.into_iter().map(|node| map.nodes[node].name.clone()).collect();
        model.abilities.charging_places = ChargingPlaces::Nodes(names);
    }

    fn read_faults(&self, robots: &[(Address, RobotSetup)]) -> anyhow::Result<FaultsFile> {
        let Some(path) = &self.faults else { return Ok(FaultsFile::default()) };
        let refused = || format!("{} is refused", path.display());
        let is_node = |name: &str| robots.iter().any(|(_, setup)| setup.places.contains_key(name));
        let faults = FaultsFile::parse(&read(path)?, is_node).with_context(refused)?;
        let serials: Vec<&str> = robots.iter().map(|(address, _)| address.serial()).collect();
        let unknown: Vec<&str> = faults.unknown_robots(&serials).collect();
        if !unknown.is_empty() {
            let all = serials.join(", ");
            bail!("{}: no robot here is {}; there are {all}", refused(), unknown.join(", "));
        }
        Ok(faults)
    }
}

fn place_in_words(setup: &RobotSetup) -> String {
    let place = &setup.position;
    match setup.last_node.is_empty() {
        true => format!("({:.2}, {:.2}) of {}", place.x, place.y, place.map),
        false => format!("{} of {}", setup.last_node, place.map),
    }
}

/// Runs all robots until the process is told to stop, and then lets them take leave.
async fn drive<L>(clients: Vec<(String, RobotClient)>, line: Arc<L>) -> anyhow::Result<()>
where
    L: Fn(BrokerClient) -> LineSetup + Send + Sync + 'static,
{
    let (stop, stopped) = watch::channel(false);
    let begun = Instant::now();
    let mut tasks = tokio::task::JoinSet::new();
    for (name, client) in clients {
        tasks.spawn(drive_one(name, client, line.clone(), begun, stopped.clone()));
    }
    tokio::select! {
        signal = asked_to_stop() => signal?,
        ended = tasks.join_next() => {
            if let Some(ended) = ended {
                ended??;
            }
        }
    }
    // Robots take leave also if nobody reads what they print.
    tell(format_args!("stopping"));
    stop.send_replace(true);
    while let Some(ended) = tasks.join_next().await {
        ended??;
    }
    Ok(())
}

/// A line and what happens on it.
struct RobotLine {
    line: MqttLine,
    events: mpsc::Receiver<LineEvent>,
}

async fn drive_one<L: Fn(BrokerClient) -> LineSetup>(
    name: String,
    mut client: RobotClient,
    setup: Arc<L>,
    begun: Instant,
    stopped: watch::Receiver<bool>,
) -> anyhow::Result<()> {
    let mut line: Option<RobotLine> = None;
    let mut ticks = tokio::time::interval(TICK);
    ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let (now_us, time) = (begun.elapsed().as_micros() as i64, timestamp());
        match (client.wants_line(now_us), &line) {
            (true, None) => {
                let will = Some(client.will(&time));
                let wanted = BrokerClient { name: name.clone(), topics: client.topics(), will };
                let (sender, events) = mpsc::channel(EVENTS);
                line = Some(RobotLine { line: MqttLine::begin(setup(wanted), sender), events });
            }
            (false, Some(_)) => {
                client.lose_line();
                // The receiver goes first: the line breaks off without a farewell, and the broker says the will.
                if let Some(RobotLine { line, events }) = line.take() {
                    drop(events);
                    line.break_off();
                }
            }
            _ => {}
        }
        while let Some(event) = line.as_mut().and_then(|line| line.events.try_recv().ok()) {
            match event {
                LineEvent::Up => client.find_line(),
                LineEvent::Down(why) => {
                    tracing::warn!(robot = name, why, "the broker is gone");
                    client.lose_line();
                }
                LineEvent::Heard { topic, payload } => client.hear(now_us, &topic, &payload),
                LineEvent::Displaced => bail!("another client at the broker has taken the name {name} over"),
            }
        }
        let leaves = *stopped.borrow();
        if leaves {
            client.leave();
        }
        for message in client.step(now_us, &time) {
            if let Some(line) = &line {
                // What cannot be sent now is lost, as with any robot.
                let _is_sent = line.line.send(message);
            }
        }
        if leaves {
            return take_leave(line).await;
        }
    }
}

/// Ends a line after all that was sent on it.
async fn take_leave(line: Option<RobotLine>) -> anyhow::Result<()> {
    if let Some(RobotLine { line, mut events }) = line {
        drop(line);
        let _is_late = tokio::time::timeout(LEAVES, async { while events.recv().await.is_some() {} }).await;
    }
    Ok(())
}

/// The time as messages have it: ISO 8601 in UTC, with milliseconds.
pub fn timestamp() -> String {
    format!("{:.3}", jiff::Timestamp::now())
}
