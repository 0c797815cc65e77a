//! The robot arms of a simulated floor: they follow trajectories, grip, report ten times a second, and fall silent.
//!
//! Main types: [`SimArms`], [`ArmFigures`]. Each arm has its own protective stop, which sees the picker's true limbs
//! and none of the plan. Refuses: to read anything of the fleet except which line a piece is for, which it needs to
//! count the piece.

pub mod simulated_arm;

use crate::arm::simulated_arm::{ArmStep, SimulatedArm, StopRule};
use crate::picker::ArmSeen;
use crate::random::Stream;
use crate::scenario::WorkCells;
use giveway_cell::PickFace;
use giveway_cell::arm::{
    ArmGrip, ArmKind, ArmOrder, ArmReport, ArmSaid, Capsule, GripAct, Gripped, base_of, rest,
};
use giveway_fleet::{Input, Ledger};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;

/// Purpose of the arms' stream of random numbers.
const ARM: u64 = 63;
/// Interval between an arm's reports.
const REPORTS: Span = Span::from_millis(100);
/// How long a gripper takes to find and grasp a piece, and to let go of it.
const TAKE: Span = Span::from_millis(900);
const PUT: Span = Span::from_millis(300);
/// Share of grasps that find nothing.
const EMPTY: f64 = 0.02;
/// Distance that the arm's stop leaves, metres: a hand that stood still may reach full hand speed before the arm
/// stands. So an arm nearer to a person than this does not start, in any direction.
const LEFT_M: f64 = 0.06;

/// Figures of one arm over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmFigures {
    /// How often the arm's own stop acted.
    pub stops: u64,
    /// Overlaps with a person while the arm moved: the law forbids them.
    pub contacts: u64,
    /// How often a person touched the arm while it stood.
    pub touched: u64,
    /// Pieces that the arm put into totes.
    pub pieces: u64,
    /// How often the arm fell silent.
    pub silences: u64,
    /// How long a person waited for the arm, seconds.
    pub person_waits_s: f64,
}

/// An arm at its station.
#[derive(Debug)]
struct SimArmPost {
    station: StationId,
    arm: SimulatedArm,
    face: PickFace,
    step_s: f64,
    next_report: Time,
    newest: u64,
    wanted: Option<ArmGrip>,
    /// The job and line that the arm picks for, by the last order.
    line: Option<(JobId, usize)>,
    grips: Option<(ArmGrip, Time)>,
    gripped: Option<(u64, Gripped)>,
    holds: bool,
    silent_until: Option<Time>,
    is_touched: bool,
    /// How far the person is from the arm, metres, and whether the arm stands.
    apart_m: f64,
    stands: bool,
    random: Stream,
    figures: ArmFigures,
}

/// All arms that are switched on.
#[derive(Debug)]
pub struct SimArms {
    all: Vec<SimArmPost>,
    silences_per_hour: f64,
    silent: Span,
    /// Pieces that an arm put down for a line.
    lines: BTreeMap<(JobId, usize), u32>,
    /// Lines of visits that may still be open and of which an arm has put down pieces, with the number of pieces
    /// ordered.
    watched: BTreeMap<(JobId, usize), u32>,
    /// Lines of which arm and hand together put down more pieces than were ordered.
    twice: Vec<(JobId, usize)>,
    /// Stations where arm and person touched while the arm moved.
    contacts: Vec<StationId>,
}

impl SimArms {
    /// The arms of a scenario; none if no arm is switched on.
    pub fn new(warehouse: &Warehouse, cells: &WorkCells, seed: u64, now: Time) -> Option<SimArms> {
        let post = |(i, name): (usize, &String)| {
            let (station, place) = warehouse.stations.pairs().find(|(_, s)| s.name == *name)?;
            let cell = place.cell.as_ref()?;
            let mount = cell.arm.as_ref()?;
            let face =
                PickFace::new(cell, warehouse.nodes[place.node].at, warehouse.rack_types.iter().next()?);
            let arm = SimulatedArm::new(ArmKind::named(&mount.kind)?.clone(), base_of(mount), rest());
            let arm = arm.with_rule(StopRule { left_m: LEFT_M, ..StopRule::default() });
            Some(SimArmPost {
                station,
                arm,
                face,
                step_s: 0.1,
                next_report: now,
                newest: 0,
                wanted: None,
                line: None,
                grips: None,
                gripped: None,
                holds: false,
                silent_until: None,
                is_touched: false,
                apart_m: f64::INFINITY,
                stands: true,
                random: Stream::new(seed, ARM, i as u64),
                figures: ArmFigures::default(),
            })
        };
        let all: Vec<SimArmPost> = cells.arms.iter().enumerate().filter_map(post).collect();
        let (silences_per_hour, silent) =
            (cells.arm_silences_per_hour, Span::from_secs_f64(cells.arm_silent_s));
        (!all.is_empty()).then_some(SimArms {
            all,
            silences_per_hour,
            silent,
            lines: BTreeMap::new(),
            watched: BTreeMap::new(),
            twice: Vec::new(),
            contacts: Vec::new(),
        })
    }

    /// Delivers trajectories and grips to the arms; a silent arm receives nothing.
    pub fn follow(&mut self, orders: &[ArmOrder]) {
        for order in orders {
            let Some(post) = self.all.iter_mut().find(|p| p.station == order.station) else { continue };
            if post.silent_until.is_none() && order.trajectory.number > post.newest {
                post.newest = order.trajectory.number;
                post.step_s = order.trajectory.step.as_secs_f64();
                if !(post.stands && post.apart_m < LEFT_M) {
                    post.arm.follow(&order.trajectory.steps, post.step_s);
                }
                (post.wanted, post.line) = (order.grip, order.line);
            }
        }
    }

    /// What a person sees of the arm at a station.
    pub fn seen(&self, station: StationId) -> Option<ArmSeen> {
        let seen = |p: &SimArmPost| {
            let links = p.arm.links();
            ArmSeen { is_inside: p.is_inside(&links), links, moves: !p.stands }
        };
        self.all.iter().find(|p| p.station == station).map(seen)
    }

    /// Stations with an arm in the opening or in the rack.
    pub fn inside(&self) -> impl Iterator<Item = StationId> {
        self.all.iter().filter(|p| p.is_inside(&p.arm.links())).map(|p| p.station)
    }

    /// Advances all arms by one tick beside people with these limbs.
    pub fn advance(&mut self, dt: Span, limbs: impl Fn(StationId) -> Vec<Capsule>) {
        for post in &mut self.all {
            let before = *post.arm.joints();
            let ArmStep { contact, touched, stopped, distance_m } =
                post.arm.advance(dt.as_secs_f64(), &limbs(post.station));
            (post.apart_m, post.stands) = (distance_m, before == *post.arm.joints());
            post.figures.stops += u64::from(stopped);
            post.figures.contacts += u64::from(contact);
            post.figures.touched += u64::from(touched && !post.is_touched);
            post.is_touched = touched;
            self.contacts.extend(contact.then_some(post.station));
        }
    }

    /// Looks for lines of which arm and hand together put down more than was ordered. `by_hand` gives the number of
    /// pieces that a hand put down.
    pub fn note_twice(&mut self, ledger: &Ledger, by_hand: impl Fn((JobId, usize)) -> u32) {
        let (lines, twice) = (&self.lines, &mut self.twice);
        self.watched.retain(|line, ordered| {
            let all = lines.get(line).copied().unwrap_or(0) + by_hand(*line);
            if all > *ordered {
                twice.push(*line);
            }
            all <= *ordered && ledger.jobs.contains_key(&line.0)
        });
    }

    /// Counts the time that a person waits for the arm at a station.
    pub fn note_waiting(&mut self, station: StationId, dt: Span) {
        if let Some(post) = self.all.iter_mut().find(|p| p.station == station) {
            post.figures.person_waits_s += dt.as_secs_f64();
        }
    }

    /// Ends and begins grips, and returns the arms' reports. `has_rack` says whether a rack truly stands at a station.
    pub fn say(
        &mut self,
        (from, now): (Time, Time),
        ledger: &Ledger,
        has_rack: impl Fn(StationId) -> bool,
    ) -> Vec<Input> {
        let mut said = Vec::new();
        let fails = self.silences_per_hour * (now - from).as_secs_f64() / 3600.0;
        for post in &mut self.all {
            if let Some((job, line)) = post.grip(now, has_rack(post.station)) {
                *self.lines.entry((job, line)).or_default() += 1;
                let visit = ledger.jobs.get(&job).and_then(|job| job.lines_now());
                let ordered = visit.and_then(|visit| visit.all().get(line)).map(|p| p.line.quantity);
                self.watched.extend(ordered.map(|n| ((job, line), n)));
            }
            if post.silent_until.take_if(|until| now >= *until).is_some() {
                // The person who restarted the arm took out of its gripper what was in it.
                (post.holds, post.grips, post.wanted) = (false, None, None);
            }
            if fails > 0.0 && post.silent_until.is_none() && post.random.happens(fails) {
                post.silent_until = Some(now + self.silent);
                post.figures.silences += 1;
            }
            if now < post.next_report {
                continue;
            }
            post.next_report = now + REPORTS;
            if post.silent_until.is_none() {
                let (joints, is_stopped) = (*post.arm.joints(), post.arm.is_stopped());
                let report = ArmReport { joints, seen: now, is_stopped };
                said.push(Input::Arm(ArmSaid { station: post.station, report, gripped: post.gripped }));
            }
        }
        said
    }

    /// Ends all faults for good.
    pub fn end_faults(&mut self) {
        self.silences_per_hour = 0.0;
    }

    /// Stations where arm and person touched while the arm moved: for the laws.
    pub fn contacts(&self) -> &[StationId] {
        &self.contacts
    }

    /// Lines that both arm and hand picked: for the laws.
    pub fn twice(&self) -> &[(JobId, usize)] {
        &self.twice
    }

    /// Figures of each arm.
    pub fn figures(&self) -> impl Iterator<Item = (StationId, ArmFigures)> {
        self.all.iter().map(|p| (p.station, p.figures))
    }

    /// Pieces that arms truly put into totes, by line.
    pub fn lines(&self) -> &BTreeMap<(JobId, usize), u32> {
        &self.lines
    }
}

impl SimArmPost {
    /// Whether any link except the base is in the opening or beyond it.
    fn is_inside(&self, links: &[Capsule]) -> bool {
        links.iter().skip(1).any(|l| [l.a, l.b].iter().any(|at| self.face.is_inside(self.face.of(*at))))
    }

    /// Advances a grip. Gives the line for which a piece was put down.
    fn grip(&mut self, now: Time, has_rack: bool) -> Option<(JobId, usize)> {
        let is_done = |number: u64| self.gripped.is_some_and(|(done, _)| done == number);
        if let Some(wanted) = self.wanted.filter(|w| self.grips.is_none() && !is_done(w.number)) {
            let takes = if matches!(wanted.act, GripAct::Take(_)) { TAKE } else { PUT };
            self.grips = Some((wanted, now + takes));
        }
        let (grip, _) = self.grips.take_if(|(_, ends)| now >= *ends)?;
        self.wanted = None;
        let finds = match grip.act {
            GripAct::Take(_) => has_rack && !self.random.happens_of(EMPTY),
            GripAct::Put(_) | GripAct::LayAside => true,
        };
        self.gripped = Some((grip.number, if finds { Gripped::Done } else { Gripped::Empty }));
        let held = std::mem::replace(&mut self.holds, finds && matches!(grip.act, GripAct::Take(_)));
        let puts = held && matches!(grip.act, GripAct::Put(_));
        self.figures.pieces += u64::from(puts);
        self.line.filter(|_| puts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Simulation;
    use crate::scenario::Scenario;
    use giveway_cell::LineChange;
    use giveway_cell::arm::ArmMode;
    use giveway_fleet::{Fact, JobFact};
    use giveway_floor::warehouse::stations;
    use std::sync::Arc;

    /// A scenario with long visits: with the usual short ones an arm puts down about one piece in ten minutes.
    fn scenario(mode: ArmMode, seconds: i64) -> Scenario {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/stations.json")).unwrap();
        (scenario.robots, scenario.duration, scenario.drain) = (14, Span::from_secs(seconds), Span::ZERO);
        let cells = scenario.cells.as_mut().unwrap();
        cells.arms = vec!["S1".into(), "S2".into()];
        cells.lines.per_visit = [6, 12];
        scenario.site.arm_mode = mode;
        scenario
    }

    fn simulation(scenario: &Scenario) -> Simulation {
        Simulation::new(Arc::new(stations()), scenario, &[], 3, false, || 0)
    }

    /// Runs a simulation to its end; counts the lines given to the arm and those given back to the hand.
    fn run(sim: &mut Simulation) -> [usize; 2] {
        let mut given = [0; 2];
        while !sim.is_over() {
            for fact in sim.step().facts() {
                match fact {
                    Fact::Job(JobFact::LineChanged { change: LineChange::ToArm, .. }) => given[0] += 1,
                    Fact::Job(JobFact::LineChanged { change: LineChange::ToHand, .. }) => given[1] += 1,
                    _ => {}
                }
            }
        }
        given
    }

    #[test]
    fn a_robot_whose_way_changes_while_a_hand_is_in_the_opening_says_what_is_so() {
        let scenario = scenario(ArmMode::Turns, 260);
        let mut sim = Simulation::new(Arc::new(stations()), &scenario, &[], 7, false, || 0);
        run(&mut sim);
        assert!(sim.broken().is_empty(), "{:?}", sim.broken());
    }

    #[test]
    fn arms_pick_lines_beside_people_in_every_mode_touch_nobody_and_no_line_is_picked_twice() {
        // In mode `Turns`, an arm picks about one piece every seven minutes.
        for (mode, seconds) in [(ArmMode::Turns, 1200), (ArmMode::Reactive, 600), (ArmMode::Predictive, 600)]
        {
            let mut sim = simulation(&scenario(mode, seconds));
            let given = run(&mut sim);
            let arms = sim.world.arms().expect("they are on");
            let all: Vec<ArmFigures> = arms.figures().map(|(_, f)| f).collect();
            assert!(all.iter().any(|f| f.pieces > 0), "{mode:?}: {all:?}");
            assert!(all.iter().all(|f| f.contacts == 0), "{mode:?}: {all:?}");
            assert!(given[0] > 1 && sim.broken().is_empty(), "{mode:?}: {given:?} {:?}", sim.broken());
        }
    }
}
