//! What picking stations gain by knowing lines, hands and ends of visits: the same hour with each flow.
//!
//! Main types: [`StationsSetup`], [`StationsRow`]. Refuses: to compare runs of different seeds or durations.

use giveway_cell::arm::ArmMode;
use giveway_cell::{Flow, LineOutcome, Lines};
use giveway_fleet::{Fact, Fleet, JobFact, JobKind, JobState, Task};
use giveway_floor::id::{Dense, JobId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Station, Warehouse};
use giveway_sim::picker::{TrueLine, WarnedLead};
use giveway_sim::{Scenario, Simulation};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Lines confirmed this shortly before the end are not judged: pieces may be on their way.
const UNSETTLED: Span = Span::from_secs(10);

/// A scenario with picking stations, and its building.
#[derive(Clone, Debug)]
pub struct StationsSetup {
    /// The building.
    pub warehouse: Arc<Warehouse>,
    /// The scenario to simulate.
    pub scenario: Scenario,
}

/// Figures of one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StationsRow {
    /// Simulated hours.
    pub hours: f64,
    /// Lines that were done or short.
    pub lines: u64,
    /// Visits that ended.
    pub visits: u64,
    /// Share of the time at stations in which pickers had nothing to pick.
    pub picker_idle: f64,
    /// How long robots with racks for stations stood per visit before picking began, seconds.
    pub robot_wait_s: f64,
    /// Reaches to wrong slots.
    pub wrong: u64,
    /// Reaches to wrong slots with a warning before the piece was out.
    pub wrong_warned: u64,
    /// For each reach to a wrong slot with a warning: how early the warning came.
    pub warned_leads: Vec<WarnedLead>,
    /// Pieces put into wrong totes.
    pub wrong_totes: u64,
    /// Pieces put into wrong totes with a warning.
    pub wrong_totes_warned: u64,
    /// Lines that were confirmed but turned out wrong in the end.
    pub wrong_confirmed: u64,
    /// Wrongly confirmed lines without a press of a button: the hand alone confirmed them.
    pub wrong_by_hand: u64,
    /// Warnings about a right place, or about another place than the wrong one.
    pub false_warnings: u64,
    /// Racks that left while pieces were still to be taken.
    pub dismissed_early: u64,
    /// How often a station's guard stopped a moving robot because of a hand.
    pub guard_stops: u64,
    /// How often buttons were pressed.
    pub presses: u64,
    /// How often a button was pressed to release a rack with nothing left to pick.
    pub released: u64,
    /// How often an expected end was compared with the true one.
    pub ends: u64,
    /// How often the true end was between the expected 10 % and 90 % quantiles.
    pub ends_held: u64,
    /// Figures of the robot arms, if some were on.
    pub arms: ArmsRow,
    /// Number of broken laws.
    pub law_violations: u64,
    /// The first broken laws, in words.
    pub broken: Vec<String>,
}

/// Figures of the robot arms in one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmsRow {
    /// Lines that were done or short at stations with an arm.
    pub lines: u64,
    /// Pieces that arms put into totes.
    pub pieces: u64,
    /// Protective stops.
    pub stops: u64,
    /// Overlaps of a moving arm and a person.
    pub contacts: u64,
    /// How often a person touched an arm that stood.
    pub touched: u64,
    /// How long people waited for an arm, seconds.
    pub person_waits_s: f64,
}

/// Lines and visits from the facts.
#[derive(Default)]
struct Ledgered {
    /// Lines of accepted jobs, with the station where the rack is wanted next.
    lines: BTreeMap<JobId, (StationId, Vec<Lines>)>,
    over: u64,
    /// Lines that are over at stations with an arm on the map.
    over_at_arms: u64,
    visits: u64,
    /// Lines that were done, with the number of pieces, and when.
    done: BTreeMap<(JobId, usize), (u32, Time)>,
    /// Expected ends of the current visit: 10 % and 90 % quantiles.
    expected: BTreeMap<JobId, Vec<[Time; 2]>>,
    ends: [u64; 2],
    picking: BTreeSet<JobId>,
}

impl StationsSetup {
    /// The scenario with this number of robots and this flow.
    pub fn scenario(&self, robots: usize, flow: Flow) -> Scenario {
        let mut scenario = Scenario { robots, drain: Span::ZERO, ..self.scenario.clone() };
        scenario.site.flow = flow;
        scenario
    }

    /// Stations with an arm on the map.
    pub fn stations_with_arm(&self) -> Vec<String> {
        let has_arm = |s: &&Station| s.cell.as_ref().is_some_and(|cell| cell.arm.is_some());
        self.warehouse.stations.iter().filter(has_arm).map(|s| s.name.clone()).collect()
    }

    /// Runs the scenario once.
    pub fn run(&self, robots: usize, flow: Flow, seed: u64) -> StationsRow {
        self.measure(self.scenario(robots, flow), seed)
    }

    /// Runs the scenario once with every arm of the map on.
    pub fn run_with_arms(&self, robots: usize, mode: ArmMode, seed: u64) -> StationsRow {
        let mut scenario = self.scenario(robots, Flow::Seen);
        let cells = scenario.cells.as_mut().expect("a scenario of picking stations has cells");
        cells.arms = self.stations_with_arm();
        scenario.site.arm_mode = mode;
        self.measure(scenario, seed)
    }

    fn measure(&self, scenario: Scenario, seed: u64) -> StationsRow {
        let mut sim = Simulation::new(self.warehouse.clone(), &scenario, &[], seed, false, || 0);
        let (mut seen, mut waits) = (Ledgered::default(), Span::ZERO);
        while !sim.is_over() {
            let now = sim.now();
            let turn = sim.step();
            for fact in turn.facts() {
                seen.note(sim.fleet(), fact, now);
            }
            seen.expect(sim.fleet(), now);
            waits += waiting(sim.fleet(), now, scenario.site.period);
        }
        seen.row(sim, scenario.site.flow, waits)
    }
}

/// Total time in this step that robots with racks for stations stood.
fn waiting(fleet: &Fleet, now: Time, period: Span) -> Span {
    let ledger = fleet.ledger();
    let stands = |r: &giveway_floor::id::RobotId| {
        matches!(ledger.robots[*r].task, Task::Deliver { .. })
            && !fleet.is_picked_from(*r)
            && fleet.telemetry(*r).is_some_and(|t| t.stands() && t.seen <= now)
    };
    let robots = (0..ledger.robots.len()).map(giveway_floor::id::RobotId::at);
    Span(period.0 * robots.filter(stands).count() as i64)
}

impl Ledgered {
    fn note(&mut self, fleet: &Fleet, fact: &Fact, now: Time) {
        match fact {
            Fact::Job(JobFact::Accepted { job, request, .. }) => {
                if let JobKind::Deliver { station, .. } = request.kind
                    && !request.lines.is_empty()
                {
                    let lines = request.lines.iter().map(|l| Lines::new(l.iter().cloned())).collect();
                    self.lines.insert(*job, (station, lines));
                }
            }
            Fact::Job(JobFact::LineChanged { job, line, change, at }) => {
                let Some((station, all)) = self.lines.get_mut(job) else { return };
                let Some(lines) = all.first_mut() else { return };
                if lines.change(*line, *change) != Ok(LineOutcome::Changed) {
                    return;
                }
                let p = &lines.all()[*line];
                self.over += u64::from(p.state.is_over());
                let cell = fleet.warehouse().stations[*station].cell.as_ref();
                self.over_at_arms += u64::from(p.state.is_over() && cell.is_some_and(|c| c.arm.is_some()));
                if p.left() == 0 && p.pieces == p.line.quantity {
                    self.done.insert((*job, *line), (p.pieces, *at));
                } else {
                    self.done.remove(&(*job, *line));
                }
                self.picking.insert(*job);
            }
            Fact::Job(JobFact::Progressed { job, state: JobState::Picking { .. }, .. }) => {
                self.picking.insert(*job);
            }
            Fact::Job(JobFact::Progressed { job, .. } | JobFact::Served { job, .. }) => {
                self.end(*job, now);
                if let (Fact::Job(JobFact::Served { .. }), Some((station, all))) =
                    (fact, self.lines.get_mut(job))
                {
                    all.remove(0);
                    let then = fleet.ledger().jobs.get(job).and_then(|j| j.request.kind.station());
                    *station = then.unwrap_or(*station);
                }
            }
            _ => {}
        }
    }

    fn end(&mut self, job: JobId, now: Time) {
        let Some(expected) = self.expected.remove(&job) else { return };
        self.visits += 1;
        for [p10, p90] in expected {
            self.ends[0] += 1;
            self.ends[1] += u64::from((p10..=p90).contains(&now));
        }
        self.picking.remove(&job);
    }

    /// Records the expected ends of visits that have just begun, or of which a line has just changed.
    fn expect(&mut self, fleet: &Fleet, now: Time) {
        for job in std::mem::take(&mut self.picking) {
            let Some((station, _)) = self.lines.get(&job) else { continue };
            let is_on =
                fleet.ledger().jobs.get(&job).is_some_and(|j| matches!(j.state, JobState::Picking { .. }));
            if !is_on {
                continue;
            }
            let all = self.expected.entry(job).or_default();
            if let Some(left) = fleet.visit_left(*station, now) {
                all.push([left.p10_s, left.p90_s].map(|s| now + Span::from_secs_f64(s)));
            }
        }
    }

    fn row(self, sim: Simulation, flow: Flow, waits: Span) -> StationsRow {
        let now = sim.now();
        let mut row = StationsRow {
            hours: now.0 as f64 / 3.6e9,
            lines: self.over,
            arms: ArmsRow { lines: self.over_at_arms, ..ArmsRow::default() },
            visits: self.visits,
            robot_wait_s: waits.as_secs_f64() / self.visits.max(1) as f64,
            // A flow that is told the true end is not judged by it.
            ends: if flow == Flow::Known { 0 } else { self.ends[0] },
            ends_held: self.ends[1],
            ..StationsRow::default()
        };
        let (mut there, mut idle) = (Span::ZERO, Span::ZERO);
        let mut truth = BTreeMap::new();
        for (_, figures, time) in sim.world.pickers().into_iter().flat_map(|p| p.figures()) {
            (there, idle) = (there + time.there, idle + time.idle);
            row.wrong += figures.wrong;
            row.wrong_warned += figures.wrong_warned;
            row.warned_leads.extend(&figures.warned_leads);
            row.wrong_totes += figures.wrong_totes;
            row.wrong_totes_warned += figures.wrong_totes_warned;
            row.false_warnings += figures.false_warnings;
            row.dismissed_early += figures.dismissed_early;
            row.presses += figures.presses;
            row.released += figures.released;
            truth.extend(figures.lines.iter().map(|(line, true_line)| (*line, *true_line)));
        }
        row.picker_idle = idle.as_secs_f64() / there.as_secs_f64().max(1e-9);
        for (_, f) in sim.world.arms().into_iter().flat_map(|arms| arms.figures()) {
            row.arms.pieces += f.pieces;
            row.arms.stops += f.stops;
            row.arms.contacts += f.contacts;
            row.arms.touched += f.touched;
            row.arms.person_waits_s += f.person_waits_s;
        }
        for (line, pieces) in sim.world.arms().into_iter().flat_map(|arms| arms.lines()) {
            truth.entry(*line).or_insert_with(TrueLine::default).right += pieces;
        }
        let settled = self.done.iter().filter(|(_, (_, at))| now - *at > UNSETTLED);
        let is_wrong = |(line, (pieces, _)): &(&(JobId, usize), &(u32, Time))| {
            truth.get(*line).is_none_or(|t| t.right != *pieces || t.wrong > 0)
        };
        let wrong: Vec<_> = settled.filter(is_wrong).collect();
        let is_pressed = |line: &(JobId, usize)| truth.get(line).is_some_and(|t| t.is_pressed);
        row.wrong_confirmed = wrong.len() as u64;
        row.wrong_by_hand = wrong.iter().filter(|(line, _)| !is_pressed(line)).count() as u64;
        row.guard_stops = sim.world.guard_stops();
        let outcome = sim.outcome();
        (row.law_violations, row.broken) = (outcome.law_violations, outcome.broken);
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::stations;

    fn setup() -> StationsSetup {
        let text = include_str!("../../scenarios/stations.json");
        let mut scenario = Scenario::parse(text).unwrap();
        scenario.duration = Span::from_secs(900);
        StationsSetup { warehouse: Arc::new(stations()), scenario }
    }

    #[test]
    fn arms_at_two_stations_pick_without_a_broken_law_and_one_seed_gives_one_row() {
        let mut setup = setup();
        assert_eq!(setup.stations_with_arm(), ["S1", "S2"]);
        // A short visit has nothing for an arm: the hand would finish first.
        setup.scenario.cells.as_mut().expect("it has cells").lines.per_visit = [6, 12];
        let run = || setup.run_with_arms(14, ArmMode::Predictive, 3);
        let row = run();
        assert_eq!((row.law_violations, row.arms.contacts), (0, 0), "{:?}", row.broken);
        assert!(row.arms.pieces > 5 && row.arms.lines > 50, "{row:?}");
        assert_eq!(row, run());
    }

    #[test]
    fn every_flow_picks_lines_without_a_broken_law_and_one_seed_gives_one_row() {
        for flow in [Flow::Usual, Flow::Counted, Flow::Hand, Flow::Seen, Flow::Known] {
            let row = setup().run(14, flow, 3);
            assert!(row.lines > 100, "{flow:?}: {row:?}");
            assert_eq!(row.law_violations, 0, "{flow:?}: {:?}", row.broken);
            assert_eq!(row.guard_stops, 0, "{flow:?}: no robot drives towards a hand");
            assert!(row.released * 10 <= row.visits, "{flow:?}: few racks wait for a button: {row:?}");
            if [Flow::Usual, Flow::Counted].contains(&flow) {
                assert!(row.wrong_confirmed > 0 && row.wrong_by_hand == 0, "{flow:?}: {row:?}");
            }
            if flow == Flow::Seen {
                assert_eq!(row, setup().run(14, flow, 3));
                assert!((row.presses as f64) < 0.3 * row.lines as f64, "hands confirm most lines: {row:?}");
            }
        }
    }
}
