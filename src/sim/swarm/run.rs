//! One case in progress, step by step, until a law is broken or everything has ended.
//!
//! Main types: [`SwarmRun`], [`SwarmFailure`]. The laws are those of every simulation. Refuses: to go on after a
//! failure, and to catch a panic; the caller does, and reports it with [`SwarmRun::end`].

use super::case::SwarmCase;
use super::draw::SwarmSetup;
use super::tally::SwarmTally;
use crate::laws::Violation;
use crate::run::Simulation;
use giveway_fleet::{FloorAction, Input, JobAction, Request, RobotAction, StationOrder};
use giveway_floor::time::Time;

/// A run with more searches is a failure; a hundred searches per robot and hour are usual.
const SEARCHES_PER_ROBOT_HOUR: f64 = 2_000.0;

/// How a run failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SwarmFailure {
    /// Kind of failure: a law, or a panic with its place in the sources.
    pub kind: String,
    /// Simulated time of the failure.
    pub at: Time,
    /// Details of the failure.
    pub words: String,
}

/// A case in progress.
pub struct SwarmRun {
    sim: Simulation,
    tally: SwarmTally,
    robots: usize,
    /// How many searches the run may take.
    budget: usize,
    failure: Option<SwarmFailure>,
}

impl SwarmRun {
    /// A case at its start.
    pub fn new(setup: &SwarmSetup) -> SwarmRun {
        let SwarmSetup { scenario, warehouse, .. } = setup;
        let sim = Simulation::new(warehouse.clone(), scenario, &[], scenario.seed, false, || 0);
        let mut tally = SwarmTally { runs: 1, ..SwarmTally::default() };
        tally.maps.insert(warehouse.name.clone(), 1);
        let longest = (scenario.duration + scenario.drain).as_secs_f64() / 3600.0;
        let budget = (longest * scenario.robots as f64 * SEARCHES_PER_ROBOT_HOUR) as usize;
        SwarmRun { sim, tally, robots: scenario.robots, budget, failure: None }
    }

    /// Draws a case and runs it to its end.
    ///
    /// # Errors
    /// Why it cannot be drawn.
    pub fn whole(case: &SwarmCase) -> Result<(SwarmTally, Option<SwarmFailure>), String> {
        let mut run = SwarmRun::new(&SwarmSetup::draw(case)?);
        while run.step() {}
        Ok(run.end(None))
    }

    /// The simulation, for tests that break something in it.
    pub fn simulation(&mut self) -> &mut Simulation {
        &mut self.sim
    }

    /// Runs one step. Gives whether there is another one.
    pub fn step(&mut self) -> bool {
        let turn = self.sim.step();
        for input in &turn.inputs {
            if let Some(word) = word(input) {
                *self.tally.injected.entry(word).or_default() += 1;
            }
        }
        if let Some((at, violation)) = self.sim.broken().first() {
            let words = violation.to_string();
            self.failure = Some(SwarmFailure { kind: kind(violation, &words), at: *at, words });
        }
        if self.failure.is_none() && self.sim.searches() > self.budget {
            let words = format!("{} searches so far, more than {}", self.sim.searches(), self.budget);
            self.failure = Some(SwarmFailure { kind: "over budget".into(), at: self.sim.now(), words });
        }
        self.failure.is_none() && !self.sim.is_over()
    }

    /// Figures of the run, and its failure, if any. `panic` has the kind and the words of a panic that ended a step;
    /// after one, the state of the fleet is unknown.
    pub fn end(self, panic: Option<(String, String)>) -> (SwarmTally, Option<SwarmFailure>) {
        let SwarmRun { sim, mut tally, robots, mut failure, .. } = self;
        let at = sim.now();
        tally.robot_time = (at - Time::ZERO) * robots as i64;
        tally.searches = sim.searches() as u64;
        for (word, count) in sim.injected() {
            *tally.injected.entry(word).or_default() += count;
        }
        for (_, walker) in sim.world.walkers() {
            let deviations = walker.log().segments().iter().filter(|s| s.cause.is_deviation()).count();
            *tally.injected.entry("deviations_of_people").or_default() += deviations as u64;
        }
        if let Some((kind, words)) = panic {
            failure = Some(SwarmFailure { kind, at, words });
        } else {
            let is_over = sim.is_over();
            tally.deliveries = sim.fleet().ledger().counts.robot_deliveries;
            tally.human_deliveries = sim.fleet().ledger().counts.human_deliveries;
            let outcome = sim.outcome();
            tally.jobs = outcome.jobs;
            if failure.is_none() && is_over && outcome.drained == Some(false) {
                let words = outcome.broken.last().cloned().unwrap_or_default();
                failure = Some(SwarmFailure { kind: with_reason("not drained".into(), &words), at, words });
            }
        }
        tally.failures.extend(failure.iter().map(|f| (f.kind.clone(), 1)));
        (tally, failure)
    }
}

/// The kind of failure of a violation: the law's name, and the fleet's reason.
fn kind(violation: &Violation, words: &str) -> String {
    with_reason(lower(&format!("{violation:?}")), words)
}

/// The kind with the first reason at the end of the words, if there is one.
fn with_reason(kind: String, words: &str) -> String {
    let first = words.split("; ").next().unwrap_or_default();
    let reason = first.rsplit(": ").next().and_then(|r| r.strip_prefix("Some("));
    reason.map_or(kind.clone(), |r| format!("{kind}, {}", lower(r)))
}

/// The name of a variant at the start of a text, as words in lower case.
fn lower(text: &str) -> String {
    let mut words = String::new();
    for c in text.chars().take_while(|c| c.is_alphanumeric()) {
        if c.is_uppercase() && !words.is_empty() {
            words.push(' ');
        }
        words.extend(c.to_lowercase());
    }
    words
}

/// Counter for what customers and operators do by hand, besides jobs.
fn word(input: &Input) -> Option<&'static str> {
    let Input::Ask { request, .. } = input else { return None };
    match request {
        Request::Job(JobAction::Cancel(_)) => Some("cancels"),
        Request::Floor(FloorAction::Halt(_)) => Some("robot_pauses"),
        Request::Station(_, StationOrder::Pause) => Some("station_pauses"),
        Request::Station(_, StationOrder::Short) => Some("short_picks"),
        Request::Robot(RobotAction::Retire(_)) => Some("departures"),
        Request::Floor(FloorAction::Close(_)) => Some("closures"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{Task, Why};
    use giveway_floor::id::{RobotId, WorkerId};

    #[test]
    fn a_failure_is_of_the_kind_of_its_law_and_of_the_reason_that_the_fleet_has() {
        let kind = |v: &Violation| kind(v, &v.to_string());
        assert_eq!(kind(&Violation::Overlap(RobotId(0), RobotId(1))), "overlap");
        assert_eq!(kind(&Violation::Fold), "fold");
        let why = Some(Why::GivesWay(WorkerId(0)));
        assert_eq!(kind(&Violation::Stuck(RobotId(3), Task::Idle, why)), "stuck, gives way");
        assert_eq!(kind(&Violation::Stuck(RobotId(3), Task::Idle, None)), "stuck");
        let whys = ["j2 Park { robot: r6 } Waiting: Some(NoPlace(Parking))", "j3 Park: None"];
        let whys = whys.map(str::to_owned).to_vec();
        assert_eq!(kind(&Violation::NotDrained(2, 0, whys)), "not drained, no place");
        assert_eq!(kind(&Violation::NotDrained(0, 2, vec![])), "not drained");
    }
}
