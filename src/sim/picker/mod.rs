//! People who pick at work cells, as ground truth: arms, eyes and mistakes, and headsets that see some of it.
//!
//! Main types: [`Pickers`], [`SimPicker`], [`PickFigures`]. Refuses: to read anything of the fleet that is not on the
//! station's screen.

mod beside_arm;
pub mod eyes;
pub mod limbs;
pub mod motion;
pub mod path;
pub mod person;
#[cfg(test)]
mod rates;
pub mod screen;
pub mod watch;
pub mod work;

pub use beside_arm::ArmSeen;
pub use person::SimPicker;
pub use screen::{ShownLine, StationScreen};
pub use work::{PickFigures, TrueLine, WarnedLead};

use crate::askers::PICKERS;
use crate::random::Stream;
use crate::scenario::WorkCells;
use beside_arm::BesideArm;
use giveway_cell::arm::Capsule;
use giveway_cell::{Flow, LineChange, PickFace};
use giveway_fleet::{CellWarning, Input, Ledger, Request, StationOrder, Token};
use giveway_floor::id::{JobId, RackId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use screen::{screen, shown};
use std::collections::BTreeMap;
use watch::HandWatch;

/// Purposes of streams of random numbers.
const PERSON: u64 = 61;
const WATCH: u64 = 62;
const TREMOR: u64 = 64;
/// Delay from the arrival of hands to the warning about them, as measured through a server's sockets.
const SENDS: Span = Span::from_millis(26);
/// The token of pickers' requests.
const TOKEN: Token = Token { asker: PICKERS, number: 0 };
/// Step length for foreseeing the rest of a visit, and the longest time foreseen.
const FORESEEN: Span = Span::from_millis(20);
const FARTHEST: Span = Span::from_secs(1200);

/// Confirms a line that is already over; pressing it means that nothing is left to do.
const AGAIN: StationOrder = StationOrder::Line(0, LineChange::Done(1));

/// A robot that truly stands at a station with a rack.
#[derive(Clone, Copy, Debug)]
pub struct StandingRack {
    /// The robot.
    pub robot: RobotId,
    /// The rack on it.
    pub rack: RackId,
}

/// A person at a station.
#[derive(Debug)]
struct PickerPlace {
    station: StationId,
    picker: SimPicker,
    watch: HandWatch,
    /// Whether an arm picks there too. Then the picker never releases a rack by reporting that all is out of it.
    has_arm: bool,
    /// The visit in progress at the last look.
    visit: Option<JobId>,
    idle: Span,
    there: Span,
    beside_arm: BesideArm,
}

/// All pickers.
#[derive(Debug)]
pub struct Pickers {
    all: Vec<PickerPlace>,
    flow: Flow,
}

/// How long a picker was at a station, and how much of that with nothing to pick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PickerTime {
    /// Time at the station.
    pub there: Span,
    /// Time at the station with nothing to pick.
    pub idle: Span,
}

impl Pickers {
    /// The pickers of a scenario; none at a station whose racks have no types.
    pub(super) fn new(warehouse: &Warehouse, cells: &WorkCells, flow: Flow, seed: u64, now: Time) -> Pickers {
        let stand = |(i, habits): (usize, crate::scenario::PickerHabits)| {
            let (station, place) = warehouse.stations.pairs().find(|(_, s)| s.name == habits.station)?;
            let rack_type = warehouse.rack_types.iter().next()?;
            let face = PickFace::new(place.cell.as_ref()?, warehouse.nodes[place.node].at, rack_type);
            let random = [PERSON, TREMOR].map(|purpose| Stream::new(seed, purpose, i as u64));
            let has_arm = cells.arms.contains(&habits.station);
            let picker = SimPicker::new(habits, !flow.hears_hands(), face, random, now);
            let watch = HandWatch::new(cells.sensor, Stream::new(seed, WATCH, i as u64), now);
            let idle = Span::ZERO;
            let (visit, there, beside_arm) = (None, idle, BesideArm::new(now));
            Some(PickerPlace { station, picker, watch, has_arm, visit, idle, there, beside_arm })
        };
        let all = cells.pickers_in(warehouse).into_iter().enumerate().filter_map(stand).collect();
        Pickers { all, flow }
    }

    /// Advances all pickers from `from` to `to`. `standing` gives the robot that truly stands at a station with its
    /// rack.
    pub(super) fn advance(
        &mut self,
        (from, to): (Time, Time),
        standing: &BTreeMap<StationId, StandingRack>,
        ledger: &Ledger,
    ) -> Vec<Input> {
        let mut inputs = Vec::new();
        for (i, stand) in self.all.iter_mut().enumerate() {
            let here = standing.get(&stand.station).filter(|s| ledger.is_picked_from(s.robot));
            let screen = screen(ledger, stand.station, here.map(|h| h.robot));
            let visit = screen.lit.map(|line| line.job);
            if visit.is_some() && visit != stand.visit {
                stand.visit = visit;
                if let Some(face) = here.and_then(|h| face_of(ledger.warehouse(), stand.station, h.rack)) {
                    stand.picker.turn_to(face);
                }
                if self.flow == Flow::Known {
                    inputs.extend(stand.foresee(to, ledger));
                }
            }
            let said = stand.live((from, to), &screen, (i as u32, self.flow.hears_hands()));
            let station = stand.station;
            // To release a rack beside an arm would state that the arm is out, too.
            let lets_go = if stand.has_arm { AGAIN } else { StationOrder::Release };
            let said = said.into_iter().map(|o| if o == StationOrder::Release { lets_go } else { o });
            inputs.extend(said.map(|order| Input::ask(TOKEN, Request::Station(station, order))));
            inputs.extend(stand.watch.come(to).into_iter().map(Input::Hands));
        }
        inputs
    }

    /// A person about to touch the arm beside them stops for a while, then goes on. Gives the stations where that
    /// happens.
    pub(super) fn give_way(
        &mut self,
        now: Time,
        by: Span,
        arm: impl Fn(StationId) -> Option<ArmSeen>,
    ) -> Vec<StationId> {
        let gives_way = |stand: &mut PickerPlace| {
            let PickerPlace { station, picker, beside_arm, .. } = stand;
            arm(*station).is_some_and(|arm| beside_arm.give_way(picker, now, by, &arm))
        };
        self.all.iter_mut().filter_map(|stand| gives_way(stand).then_some(stand.station)).collect()
    }

    /// The limbs of the person at a station.
    pub(super) fn limbs(&self, station: StationId, now: Time) -> Vec<Capsule> {
        let stand = self.all.iter().find(|s| s.station == station);
        stand.map_or_else(Vec::new, |stand| stand.picker.limbs(now))
    }

    /// How many pieces a hand truly put into the right tote for a line.
    pub(super) fn put(&self, line: (JobId, usize)) -> u32 {
        self.all.iter().filter_map(|s| s.picker.figures.lines.get(&line)).map(|l| l.right).sum()
    }

    /// Delivers a warning to the person at a station when a server would have sent it.
    pub(super) fn warn(&mut self, now: Time, warning: &CellWarning) {
        if let Some(stand) = self.all.iter_mut().find(|s| s.station == warning.station) {
            let came = stand.watch.came_at(warning.seen);
            stand.picker.warn(came.map_or(now, |came| now.max(came + SENDS)), warning.wrong);
        }
    }

    /// Stations with a person's hand in the opening or in the rack.
    pub(super) fn hands_inside(&self, now: Time) -> impl Iterator<Item = StationId> {
        self.all.iter().filter(move |s| s.picker.is_inside(now)).map(|s| s.station)
    }

    /// Stations whose picker is away.
    pub(super) fn away(&self) -> impl Iterator<Item = StationId> {
        self.all.iter().filter(|s| s.picker.is_away()).map(|s| s.station)
    }

    /// True figures of each station, with how long a person was there.
    pub fn figures(&self) -> impl Iterator<Item = (StationId, &PickFigures, PickerTime)> {
        let time = |s: &PickerPlace| PickerTime { there: s.there, idle: s.idle };
        self.all.iter().map(move |s| (s.station, &s.picker.figures, time(s)))
    }
}

impl PickerPlace {
    /// Advances the person and gives what the person reports.
    fn live(
        &mut self,
        (from, to): (Time, Time),
        screen: &StationScreen,
        (person, is_watched): (u32, bool),
    ) -> Vec<StationOrder> {
        if !self.picker.is_away() {
            self.there += to - from;
            if self.picker.is_idle() && screen.lit.is_none() {
                self.idle += to - from;
            }
        }
        let mut said = Vec::new();
        while is_watched && self.watch.next() <= to {
            let at = self.watch.next();
            said.extend(self.picker.advance(at, screen));
            if self.picker.is_away() {
                self.watch.pass();
                continue;
            }
            let (face, truth) = (self.picker.face().clone(), self.picker.truth(at));
            self.watch.look((self.station, person), &face, &truth);
        }
        said.extend(self.picker.advance(to, screen));
        said.into_iter().map(|(_, order)| order).collect()
    }

    /// When the hand will be out for the last time, if everything that the person does is confirmed at once.
    fn foresee(&self, now: Time, ledger: &Ledger) -> Option<Input> {
        let job = self.visit?;
        let lines = ledger.jobs.get(&job)?.lines_now()?.clone();
        let totes = ledger.warehouse().stations[self.station].cell.as_ref()?;
        let tote = |name: &str| totes.totes.iter().position(|t| t.name == name);
        let (mut picker, mut lines, mut at) = (self.picker.clone(), lines, now);
        let mut out = now;
        while at < now + FARTHEST && lines.lit().is_some() {
            at += FORESEEN;
            let lit = shown(job, &lines, &tote);
            let said = picker.advance(at, &StationScreen { lit, is_here: true, ..StationScreen::default() });
            for (_, order) in said {
                if let StationOrder::Line(n, change) = order {
                    let _ = lines.change(n, change);
                }
            }
            out = if picker.is_inside(at) { at } else { out };
            let (Some(lit), Some(done)) = (lit, picker.pieces_put()) else { continue };
            if done.0 == (job, lit.n) && done.1 > lines.all()[lit.n].pieces {
                let _ = lines.change(lit.n, LineChange::Done(done.1 - lines.all()[lit.n].pieces));
            }
        }
        Some(Input::VisitEnds { station: self.station, at: out })
    }
}

fn face_of(warehouse: &Warehouse, station: StationId, rack: RackId) -> Option<PickFace> {
    let place = &warehouse.stations[station];
    let rack_type = &warehouse.rack_types[warehouse.racks[rack].rack_type?];
    Some(PickFace::new(place.cell.as_ref()?, warehouse.nodes[place.node].at, rack_type))
}

/// Whether the visit that a robot is picked from has lines.
pub(super) fn has_lines(ledger: &Ledger, robot: RobotId) -> bool {
    let job = ledger.robots.get(robot).and_then(|record| record.task.job());
    job.and_then(|job| ledger.jobs.get(&job)).is_some_and(|job| job.lines_now().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;
    use giveway_cell::arm::least_distance_m;
    use giveway_floor::warehouse::stations;

    const TICK: Span = Span::from_millis(50);

    /// A person at `S1` who has nothing to pick and never goes away.
    fn idle_person() -> PickerPlace {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/stations.json")).unwrap();
        let cells = scenario.cells.as_mut().unwrap();
        for habits in cells.pickers.iter_mut().flatten() {
            habits.away_per_hour = 0.0;
        }
        Pickers::new(&stations(), cells, Flow::default(), 1, Time::ZERO).all.swap_remove(0)
    }

    /// Advances a person beside an arm by `seconds`. Gives whether the person is away at the end.
    fn passes(stand: &mut PickerPlace, now: &mut Time, seconds: f64, arm: &ArmSeen) -> bool {
        let until = *now + Span::from_secs_f64(seconds);
        while *now < until {
            let from = *now;
            *now += TICK;
            stand.beside_arm.give_way(&mut stand.picker, *now, TICK, arm);
            stand.live((from, *now), &StationScreen::default(), (0, false));
        }
        stand.picker.is_away()
    }

    /// The capsules, `by_m` higher.
    fn raised(all: &[Capsule], by_m: f64) -> Vec<Capsule> {
        let by = nalgebra::Vector3::new(0.0, 0.0, by_m);
        all.iter().map(|c| Capsule { a: c.a + by, b: c.b + by, ..*c }).collect()
    }

    #[test]
    fn who_rests_in_an_arm_that_stands_steps_back_and_comes_back_when_it_does_not_move_there() {
        let (mut stand, mut now) = (idle_person(), Time::ZERO);
        let stands = ArmSeen { links: stand.picker.limbs(now), moves: false, is_inside: false };
        let moves = ArmSeen { moves: true, ..stands.clone() };
        assert!(!passes(&mut stand, &mut now, 0.9, &stands), "too soon");
        assert!(passes(&mut stand, &mut now, 0.2, &stands), "the person rests in the arm");
        assert!(stand.picker.limbs(now).is_empty(), "nothing of the person is in its way");
        assert!(passes(&mut stand, &mut now, 10.0, &moves), "the arm moves where the person would be");
        assert!(!passes(&mut stand, &mut now, 0.5, &stands), "the person is back beside an arm that stands");
    }

    #[test]
    fn who_has_nothing_to_pick_makes_room_for_an_arm_that_stands_in_the_opening_until_it_is_out() {
        let (mut stand, mut now) = (idle_person(), Time::ZERO);
        let limbs = stand.picker.limbs(now);
        let apart_m = least_distance_m(&limbs, &raised(&limbs, 2.0));
        let stands = ArmSeen { links: raised(&limbs, 2.0 - apart_m + 0.3), moves: false, is_inside: true };
        let moves = ArmSeen { moves: true, ..stands.clone() };
        let out = ArmSeen { is_inside: false, ..moves.clone() };
        assert!(!passes(&mut stand, &mut now, 4.9, &stands), "too soon");
        assert!(passes(&mut stand, &mut now, 0.2, &stands), "the person makes room");
        assert!(passes(&mut stand, &mut now, 10.0, &moves), "it is on its way out");
        assert!(!passes(&mut stand, &mut now, 0.5, &out), "the person is back");
        assert!(!passes(&mut stand, &mut now, 20.0, &out), "an arm that is out, or moves, asks for no room");
        assert!(!passes(&mut stand, &mut now, 4.9, &stands), "it has just come to a stand");
    }

    #[test]
    fn a_warning_is_heard_no_sooner_than_a_server_sends_it_after_the_hands_came() {
        let mut stand = idle_person();
        let (face, truth) = (stand.picker.face().clone(), stand.picker.truth(Time::ZERO));
        (0..10).for_each(|_| stand.watch.look((stand.station, 0), &face, &truth));
        let now = Time::from_secs_f64(0.5);
        let seen = stand.watch.come(now).last().expect("something has come").seen;
        let (station, came) = (stand.station, stand.watch.came_at(seen).expect("it has come"));
        let wrong = giveway_fleet::WrongReach::Tote(0);
        let mut pickers = Pickers { all: vec![stand], flow: Flow::Seen };
        pickers.warn(came, &CellWarning { station, person: 0, wrong, seen });
        let mut heard = |at: Time| {
            pickers.all[0].picker.advance(at, &StationScreen::default());
            pickers.all[0].picker.figures.false_warnings
        };
        assert_eq!((heard(came + SENDS - Span(1)), heard(came + SENDS)), (0, 1));
    }

    #[test]
    fn a_rack_with_nothing_left_to_pick_is_let_go_after_three_seconds_and_one_with_lines_is_not() {
        let is_let_go = |is_over: bool, seconds: f64| {
            let mut stand = idle_person();
            let screen = StationScreen { is_here: true, is_over, ..StationScreen::default() };
            let until = Time::from_secs_f64(seconds);
            let mut at = Time::ZERO;
            let mut said = Vec::new();
            while at < until {
                at += TICK;
                said.extend(stand.picker.advance(at, &screen));
            }
            said.iter().any(|(_, order)| *order == StationOrder::Release)
        };
        assert!(!is_let_go(true, 2.95) && is_let_go(true, 6.0));
        assert!(!is_let_go(false, 60.0), "the arm may be at work");
    }

    #[test]
    fn who_rests_beside_an_arm_or_before_one_that_moves_stays() {
        let (mut stand, mut now) = (idle_person(), Time::ZERO);
        let there = ArmSeen { links: stand.picker.limbs(now), moves: true, is_inside: false };
        assert!(!passes(&mut stand, &mut now, 5.0, &there), "an arm that moves gives way itself");
        let beside = ArmSeen { links: raised(&there.links, 5.0), moves: false, ..there };
        assert!(!passes(&mut stand, &mut now, 5.0, &beside), "the arm is elsewhere");
    }
}
