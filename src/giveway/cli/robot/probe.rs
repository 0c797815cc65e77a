//! `giveway robot probe`: finds out what is special about a robot before it joins.
//!
//! Main type: [`ProbeArgs`]. A thin loop round [`RobotProbe`], which knows what to ask. Refuses: to move a robot
//! without `--drive`.

use super::run::timestamp;
use crate::cli::serve::{asked_to_stop, trace_to_stderr};
use crate::mqtt::broker::{BrokerClient, BrokerFlags};
use crate::mqtt::{LineEvent, LineMessage, LineSetup, MqttLine};
use anyhow::{Context, bail, ensure};
use clap::Args;
use giveway_floor::geometry::Point;
use giveway_floor::time::Time;
use giveway_links::vda5050::probe::{ProbeFindings, RobotProbe};
use giveway_vda5050::{Address, TopicKind, Version};
use serde_json::Value;
use std::process::ExitCode;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::Instant;

/// The time between two looks.
const TICK: Duration = Duration::from_millis(100);
/// Events of the line that wait for the next look.
const EVENTS: usize = 1_000;
/// A broker that is not there within this is none.
const CONNECTS: Duration = Duration::from_secs(10);
/// An instant action or order that has not reached the robot after this never does.
const EXPIRES: Duration = Duration::from_secs(3);

/// Arguments of `robot probe`.
#[derive(Args)]
pub struct ProbeArgs {
    #[command(flatten)]
    broker: BrokerFlags,
    /// The robot: MANUFACTURER/SERIAL
    #[arg(long, value_name = "MANUFACTURER/SERIAL")]
    robot: String,
    /// The first level or levels of topics
    #[arg(long, value_name = "NAME", default_value = "uagv")]
    interface: String,
    /// A place in the robot's map to drive to and back from, at least 3 m away on a straight and free way. Without it,
    /// the robot does not move, and pause and cancel on the way are not tried
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    drive: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl ProbeArgs {
    /// Probes the robot and prints what was found.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        trace_to_stderr();
        let address = self.address()?;
        let goal = self.drive.as_deref().map(place_of).transpose()?;
        let line = self.broker.clone().or_environment().line()?;
        let topics = (TopicKind::ALL.into_iter().filter(|kind| kind.is_from_robot()))
            .flat_map(|kind| [Version::V2_1, Version::V3_0].map(|v| address.topic(&self.interface, v, kind)));
        let setup = line(BrokerClient {
            name: format!("giveway-probe-{}", std::process::id()),
            topics: topics.collect(),
            will: None,
        });
        let run = jiff::Timestamp::now().as_second().to_string();
        let probe = RobotProbe::new(address.clone(), goal, &run);
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        let findings = runtime.block_on(ask(setup, probe, &address, &self.interface))?;
        let found = findings.to_json();
        if self.json {
            println!("{}", serde_json::to_string_pretty(&found)?);
        } else {
            print_table(&found, &findings);
        }
        Ok(if findings.is_heard() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    fn address(&self) -> anyhow::Result<Address> {
        let parts = self.robot.split_once('/').context("--robot takes MANUFACTURER/SERIAL")?;
        Address::new(parts.0, parts.1).context("--robot is refused")
    }
}

/// A place in metres: `X,Y`.
fn place_of(text: &str) -> anyhow::Result<Point> {
    const REMEDY: &str = "--drive takes X,Y in metres, such as 4.5,-2";
    let (x, y) = text.split_once(',').context(REMEDY)?;
    let metres = |text: &str| text.trim().parse::<f64>().ok().filter(|m| m.is_finite()).context(REMEDY);
    Ok(Point::new(metres(x)?, metres(y)?))
}

/// Runs the probe to its end.
async fn ask(
    setup: LineSetup,
    mut probe: RobotProbe,
    address: &Address,
    interface: &str,
) -> anyhow::Result<ProbeFindings> {
    let (sender, mut events) = mpsc::channel(EVENTS);
    let line = MqttLine::begin(setup, sender);
    match tokio::time::timeout(CONNECTS, events.recv()).await {
        Ok(Some(LineEvent::Up)) => {}
        Ok(Some(LineEvent::Down(why))) => bail!("the broker is not there: {why}"),
        Ok(_) | Err(_) => bail!("the broker does not answer"),
    }
    let begun = Instant::now();
    let mut ticks = tokio::time::interval(TICK);
    let mut stage = None;
    while !probe.is_over() {
        tokio::select! {
            _ = ticks.tick() => {}
            signal = asked_to_stop() => {
                signal?;
                bail!("stopped before the end; the robot may still have an order: look after it");
            }
        }
        let now = Time(begun.elapsed().as_micros() as i64);
        while let Ok(event) = events.try_recv() {
            match event {
                LineEvent::Heard { topic, payload } => {
                    if let Some((_, level, kind)) = Address::of_topic(&topic, interface) {
                        probe.hear(now, level, kind, &payload);
                    }
                }
                LineEvent::Down(why) => bail!("the broker is gone: {why}"),
                LineEvent::Displaced => bail!("another client has taken this one's name over"),
                LineEvent::Up => {}
            }
        }
        for told in probe.tick(now, &timestamp()) {
            let message = LineMessage {
                topic: address.topic(interface, told.version, told.kind),
                payload: told.payload,
                confirmed: false,
                retained: false,
                expires: Some(EXPIRES),
            };
            ensure!(line.send(message), "the broker takes no message");
        }
        if stage.replace(probe.stage()) != Some(probe.stage()) {
            eprintln!("the probe {}", probe.stage());
        }
    }
    Ok(probe.findings().clone())
}

fn print_table(found: &Value, findings: &ProbeFindings) {
    let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    for key in ["robot", "version", "factsheet", "pause", "cancel", "actions", "repeat", "reconnect", "alive"]
    {
        println!("{key:<10} {}", word(&found[key]));
    }
    for (key, value) in found["quirks"].as_object().into_iter().flatten() {
        println!("quirk      {key}: {}", word(value));
    }
    println!("kind       {}", found["kind"]);
    let questions = findings.questions();
    if questions.is_empty() {
        println!("Nothing to ask the vendor.");
    } else {
        println!("Ask the vendor:");
        questions.iter().for_each(|question| println!("- {question}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_two_numbers_and_a_robot_has_two_names() {
        assert_eq!(place_of("4.5,-2").unwrap(), Point::new(4.5, -2.0));
        for wrong in ["4", "a,b", "1,inf", ""] {
            assert!(place_of(wrong).unwrap_err().to_string().contains("--drive takes X,Y"), "{wrong}");
        }
        let of = |robot: &str| {
            let (broker, interface) = (BrokerFlags::default(), "uagv".to_owned());
            ProbeArgs { broker, robot: robot.into(), interface, drive: None, json: false }.address()
        };
        assert_eq!(of("maker/a 1").unwrap().serial(), "a 1");
        assert!(of("maker").is_err() && of("maker/a/b").is_err());
    }
}
