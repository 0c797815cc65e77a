//! What is remembered about visits at work cells: how long lines take, since when the lit line has been lit, and what
//! the hands do.
//!
//! Main type: [`Visits`]. Lost at a restart: then the lit line begins anew, and the pace is learned again. Refuses: to
//! promise anything.

use crate::state::fact::{Fact, JobFact};
use crate::state::io::WrongReach;
use crate::state::job::{Job, JobState};
use crate::state::job_kind::JobKind;
use crate::state::ledger::Ledger;
use giveway_cell::{
    CellHands, CellHandsEvent, CellHandsScene, HandsSeen, LineChange, LineOutcome, LineState, Lines,
    PickFace, PickPace, Remaining, SeenReach, VisitSeen,
};
use giveway_floor::id::{JobId, RackId, RackTypeId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{SlotName, Warehouse};
use giveway_people::reach::PickModel;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How long a warning is shown.
const WARNED: Span = Span::from_secs(2);
/// How long a station counts as shared after two people were seen there.
const SHARED: Span = Span::from_millis(500);
/// A piece that both the hand and a button confirm within this time is the same piece.
const SAME_PIECE: Span = Span::from_secs(2);
/// How long after a visit a button press for one of its lines is taken to belong to that visit.
const ENDED: Span = Span::from_secs(3);

/// A visit in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VisitClock {
    /// When the rack came; nothing if that was before the program started.
    since: Option<Time>,
    /// When the line that is lit now was lit.
    lit: Time,
    /// When the lit line had its last piece, or was lit.
    last: Time,
    /// Whether the program has seen the lit line from its beginning.
    whole: bool,
    /// The line that was done last, from which nothing has been learned yet.
    done: Option<DoneLine>,
    /// The end that was expected as the visit began: the times before which one in ten, half and nine in ten would end.
    expected: Option<[Time; 3]>,
    /// The end that was expected after the last change of a line (one in ten before, nine in ten before), and when.
    newest: Option<([Time; 2], Time)>,
}

/// How well the ends of visits were expected when they began, since the program started.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndsHeld {
    /// Visits whose end was expected.
    pub visits: u32,
    /// How many of these visits ended between the times before which one in ten and nine in ten were to end.
    pub held: u32,
    /// Sum of the differences from the times before which half of the visits were to end, seconds.
    pub off_s: f64,
}

/// What says that pieces are in their tote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfirmedBy {
    /// The hand, as it was seen.
    Hand,
    /// A button, a scanner or a scale.
    Button,
}

/// Pieces of a line that were confirmed a moment ago.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ConfirmedPieces {
    line: (JobId, usize),
    by: ConfirmedBy,
    pieces: u32,
    at: Time,
}

/// A line that is done, and how long it took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DoneLine {
    station: StationId,
    pieces: u32,
    seconds: f64,
    at: Time,
}

impl VisitClock {
    fn of(since: Option<Time>, now: Time) -> VisitClock {
        VisitClock {
            since,
            lit: now,
            last: now,
            whole: since.is_some(),
            done: None,
            expected: None,
            newest: None,
        }
    }
}

/// What is remembered about visits at work cells.
#[derive(Clone, Debug, Default)]
pub struct Visits {
    pace: PickPace,
    /// Whether the pace of lines is learned at all.
    learns: bool,
    /// Stations where two people were in the workplace, and when they were last seen there.
    shared: BTreeMap<StationId, Time>,
    /// When a button was last pressed at each station.
    used: BTreeMap<StationId, Time>,
    /// What was last confirmed at each station.
    confirmed: BTreeMap<StationId, ConfirmedPieces>,
    clocks: BTreeMap<JobId, VisitClock>,
    /// The hands at each station.
    cell_hands: BTreeMap<StationId, CellHands>,
    /// The face of the rack that stands at each station, or stood there last.
    faces: BTreeMap<StationId, (RackTypeId, Arc<PickFace>)>,
    /// Which robot is picked from at each station, as looked up in this step.
    looked_up: (Time, BTreeMap<StationId, Option<RobotId>>),
    /// Stations whose visit is over except for a hand that is still inside.
    kept: BTreeSet<StationId>,
    /// How well the ends of visits at each station were expected when they began.
    held: BTreeMap<StationId, EndsHeld>,
    /// The visit that ended last at each station.
    ended: BTreeMap<StationId, (JobId, Lines, Time)>,
    /// Robots that must not move because of a hand, each with the station of the hand.
    at_hands: BTreeMap<RobotId, StationId>,
    /// The last warning at each station, and when it was given.
    warned: BTreeMap<StationId, (WrongReach, Time)>,
    /// How many lines were over, and how many reaches were warned of.
    counted: [u64; 2],
    /// True ends of visits, as an experiment tells them.
    told: BTreeMap<StationId, Time>,
}

/// The station at which a job's rack is wanted, and how long it stays there by the customer's word, seconds.
fn station_of(job: &Job) -> Option<(StationId, Option<f64>)> {
    match job.request.kind {
        JobKind::Deliver { station, pick, .. } => Some((station, pick.map(Span::as_secs_f64))),
        _ => None,
    }
}

impl Visits {
    /// The state of stations where nothing was picked yet. `learns` says whether the pace of lines is learned.
    pub fn new(learns: bool) -> Visits {
        Visits { learns, ..Visits::default() }
    }

    /// Notes that two people are in the workplace of a station.
    pub fn note_company(&mut self, station: StationId, now: Time) {
        self.shared.insert(station, now);
        self.cell_hands.entry(station).or_default().note_company(now);
    }

    /// Whether two people are in the workplace of a station, so that it is unknown whose hand is where.
    pub fn is_shared(&self, station: StationId, now: Time) -> bool {
        self.shared.get(&station).is_some_and(|at| now - *at < SHARED)
    }

    /// Notes that a button was pressed at a station.
    pub fn note_use(&mut self, station: StationId, now: Time) {
        self.used.insert(station, now);
    }

    /// When a button was pressed last at each station.
    pub fn used(&self) -> &BTreeMap<StationId, Time> {
        &self.used
    }

    /// Whether these pieces of a line were just confirmed the other way: by a button if this is the hand, by the hand
    /// if this is a button. A piece by hand is counted off.
    pub fn is_confirmed(
        &mut self,
        station: StationId,
        line: (JobId, usize),
        (by, pieces): (ConfirmedBy, u32),
        now: Time,
    ) -> bool {
        let is_it = |c: &&mut ConfirmedPieces| c.line == line && c.by != by && now - c.at < SAME_PIECE;
        match self.confirmed.get_mut(&station).filter(is_it) {
            Some(c) if by == ConfirmedBy::Hand && c.pieces > 0 => {
                c.pieces -= 1;
                true
            }
            Some(c) => by == ConfirmedBy::Button && c.pieces == pieces,
            None => false,
        }
    }

    /// Notes that pieces of a line are confirmed. Pieces confirmed the same way within a moment are added up.
    pub fn note_confirmed(
        &mut self,
        station: StationId,
        line: (JobId, usize),
        (by, pieces): (ConfirmedBy, u32),
        now: Time,
    ) {
        let is_it = |c: &&ConfirmedPieces| c.line == line && c.by == by && now - c.at < SAME_PIECE;
        let before = self.confirmed.get(&station).filter(is_it).map_or(0, |c| c.pieces);
        self.confirmed.insert(station, ConfirmedPieces { line, by, pieces: before + pieces, at: now });
    }

    /// Takes a fact in, before the ledger does.
    pub fn note(&mut self, ledger: &Ledger, fact: &Fact) {
        match fact {
            Fact::Job(JobFact::Progressed { job, state: JobState::Picking { .. }, at, .. }) => {
                self.clocks.insert(*job, VisitClock::of(Some(*at), *at));
                if let Some((station, _)) = ledger.jobs.get(job).and_then(station_of) {
                    self.told.remove(&station);
                    self.cell_hands.entry(station).or_default().begin();
                }
            }
            Fact::Job(JobFact::Progressed { job, at, .. } | JobFact::Served { job, at, .. }) => {
                self.end(ledger, *job, *at)
            }
            Fact::Job(JobFact::LineChanged { job, line, change, at }) => {
                self.note_line(ledger, *job, (*line, *change), *at)
            }
            _ => {}
        }
    }

    /// Notes a visit that was in progress when the program started.
    pub fn begin(&mut self, id: JobId, now: Time) {
        self.clocks.entry(id).or_insert(VisitClock::of(None, now));
    }

    /// Notes that a job changes its state, which ends its visit if one was in progress.
    fn end(&mut self, ledger: &Ledger, id: JobId, at: Time) {
        let Some(clock) = self.clocks.remove(&id) else { return };
        self.learn(clock.done);
        let Some(job) = ledger.jobs.get(&id) else { return };
        let (Some((station, _)), Some(lines)) = (station_of(job), job.lines_now()) else { return };
        // If the rack leaves at the last grasp, its lit line has taken until now.
        if let Some(lit) = lines.lit().filter(|_| clock.whole && clock.done.is_none_or(|d| d.at != at)) {
            let (pieces, seconds) = (lines.all()[lit].line.quantity, (at - clock.lit).as_secs_f64());
            self.learn(Some(DoneLine { station, pieces, seconds, at }));
        }
        if let Some([p10, p50, p90]) = clock.expected {
            let held = self.held.entry(station).or_default();
            held.visits += 1;
            held.held += u32::from(p10 <= at && at <= p90);
            held.off_s += (at - p50).as_secs_f64().abs();
            self.learn_end([p10, p90], at);
        }
        if let Some((ends, _)) = clock.newest.filter(|(_, seen)| clock.since.is_some_and(|s| *seen > s)) {
            self.learn_end(ends, at);
        }
        self.ended.insert(station, (id, lines.clone(), at));
    }

    /// Learns from whether a visit ended as expected. Exact ends that an experiment tells teach nothing.
    fn learn_end(&mut self, [p10, p90]: [Time; 2], at: Time) {
        if self.learns && p10 < p90 {
            self.pace.learn_end(p10 <= at && at <= p90);
        }
    }

    fn learn(&mut self, done: Option<DoneLine>) {
        if let Some(DoneLine { station, pieces, seconds, .. }) = done.filter(|_| self.learns) {
            self.pace.learn(station, pieces, seconds);
        }
    }

    /// Notes a change of a line. A line that was lit all the time teaches how long lines take, once it is done by
    /// itself: where several lines are confirmed at once, it is unknown how long each has taken.
    fn note_line(&mut self, ledger: &Ledger, id: JobId, (n, change): (usize, LineChange), at: Time) {
        let Some(job) = ledger.jobs.get(&id) else { return };
        let (Some((station, _)), Some(lines)) = (station_of(job), job.lines_now()) else { return };
        let mut after = lines.clone();
        if after.change(n, change) != Ok(LineOutcome::Changed) {
            return;
        }
        let clock = self.clocks.entry(id).or_insert(VisitClock::of(None, at));
        let (before, now) = (&lines.all()[n], &after.all()[n]);
        let is_alone = clock.done.is_none_or(|d| d.at != at);
        let is_done = before.state == LineState::Lit && now.state == LineState::Done;
        let (pieces, seconds) = (before.line.quantity, (at - clock.lit).as_secs_f64());
        let done = (is_alone && is_done && clock.whole).then_some(DoneLine { station, pieces, seconds, at });
        let earlier = std::mem::replace(&mut clock.done, done).filter(|_| is_alone);
        // What the arm does says nothing about the hand.
        if before.state != LineState::Arm && now.state != LineState::Arm {
            clock.last = at;
        }
        if lines.lit() != after.lit() {
            (clock.lit, clock.whole) = (at, is_alone);
        }
        self.counted[0] += u64::from(now.state.is_over() && !before.state.is_over());
        if now.state.is_over() {
            self.cell_hands.entry(station).or_default().forget(before.line.slot);
        }
        self.learn(earlier);
    }

    /// Notes how long a visit is expected to last. What was expected when the visit began, and after the last change of
    /// a line, is compared with its end.
    pub fn expect(&mut self, id: JobId, left: &Remaining, now: Time) {
        let Some(clock) = self.clocks.get_mut(&id).filter(|c| c.since.is_some()) else { return };
        let [p10, p50, p90] = [left.p10_s, left.p50_s, left.p90_s].map(|s| now + Span::from_secs_f64(s));
        clock.expected = clock.expected.or(Some([p10, p50, p90]));
        if clock.newest.is_none_or(|(_, at)| at < clock.last) {
            clock.newest = Some(([p10, p90], now));
        }
    }

    /// How well the ends of visits at a station were expected.
    pub fn ends_held(&self, station: StationId) -> EndsHeld {
        self.held.get(&station).copied().unwrap_or_default()
    }

    /// When the rack of a job came to the station where it is, unless that was before the program started.
    pub fn since(&self, id: JobId) -> Option<Time> {
        self.clocks.get(&id)?.since
    }

    /// How long a robot with a job's rack is planned to stay at the station where it is wanted now; nothing for a job
    /// without lines.
    pub fn stay(&self, job: &Job) -> Option<Span> {
        let ((station, said_s), lines) = (station_of(job)?, job.lines_now()?);
        let seen = VisitSeen { said_s, ..VisitSeen::default() };
        Some(Span::from_secs_f64(self.pace.remaining(station, lines, seen).mean_s))
    }

    /// How long a job's rack stays at the station where it is wanted now, from now on if it is there; nothing for a job
    /// without lines. A visit ends when the last piece is in its tote, or when the hand is out for the last time.
    pub fn remaining(&self, id: JobId, job: &Job, ends_out: bool, now: Time) -> Option<Remaining> {
        let ((station, said_s), lines) = (station_of(job)?, job.lines_now()?);
        if let Some(end) = self.told.get(&station).filter(|_| self.clocks.contains_key(&id)) {
            return Some(Remaining::exactly((*end - now).as_secs_f64()));
        }
        let seen = VisitSeen { said_s, ends_out, ..self.seen(id, station, lines, now) };
        Some(self.pace.remaining(station, lines, seen))
    }

    /// What is seen of a visit, if it is in progress.
    fn seen(&self, id: JobId, station: StationId, lines: &Lines, now: Time) -> VisitSeen {
        let Some(clock) = self.clocks.get(&id) else { return VisitSeen::default() };
        let lit = lines.lit().map(|lit| lines.all()[lit].line.slot);
        let piece = lit.and_then(|slot| self.cell_hands.get(&station)?.phase(slot, now));
        VisitSeen { lit_s: (now - clock.last).as_secs_f64().max(0.0), piece, ..VisitSeen::default() }
    }

    /// How long the hand still needs for its lines of a visit, on average, seconds.
    pub fn hand_s(&self, id: JobId, job: &Job, now: Time) -> Option<f64> {
        let ((station, said_s), lines) = (station_of(job)?, job.lines_now()?);
        let seen = VisitSeen { said_s, ..self.seen(id, station, lines, now) };
        Some(self.pace.hand_s(station, lines, seen))
    }

    /// How long the hand takes for this many pieces of one line, and the arm for one piece, on average, seconds.
    pub fn line_s(&self, station: StationId, pieces: u32) -> (f64, f64) {
        (self.pace.line_s(station, pieces), self.pace.arm_piece_s(station))
    }

    /// Takes in the hands seen at a station, and learns from the phase that they have ended.
    pub fn see(&mut self, scene: CellHandsScene<'_>, seen: &HandsSeen) -> SmallVec<[CellHandsEvent; 4]> {
        let hands = self.cell_hands.entry(seen.station).or_default();
        let events = hands.see(scene, seen);
        if let Some(spent) = hands.spent() {
            self.pace.learn_phases(seen.station, &[spent]);
        }
        events
    }

    /// A robot arm took so long for a piece, or for nothing.
    pub fn learn_arm(&mut self, station: StationId, seconds: f64) {
        self.pace.learn_arm(station, seconds);
    }

    /// The hands at a station.
    pub fn hands_at(&mut self, station: StationId) -> &mut CellHands {
        self.cell_hands.entry(station).or_default()
    }

    /// The face of the rack at a station or, without a rack, of the rack before; nothing if there was none, the rack
    /// has no slots, or the station has no cell.
    pub fn face(
        &mut self,
        warehouse: &Arc<Warehouse>,
        station: StationId,
        rack: Option<RackId>,
    ) -> Option<&Arc<PickFace>> {
        let rack_type = rack.and_then(|rack| warehouse.racks[rack].rack_type);
        if let Some(id) = rack_type.filter(|id| self.faces.get(&station).is_none_or(|(known, _)| known != id))
        {
            let place = &warehouse.stations[station];
            let stands = warehouse.nodes[place.node].at;
            let face = PickFace::new(place.cell.as_ref()?, stands, &warehouse.rack_types[id]);
            self.faces.insert(station, (id, Arc::new(face)));
        }
        self.faces.get(&station).map(|(_, face)| face)
    }

    /// The robot that is picked from at a station, as looked up in this step; the outer `None` if it was not looked up.
    pub fn looked_up(&self, station: StationId, now: Time) -> Option<Option<RobotId>> {
        let (at, robots) = &self.looked_up;
        robots.get(&station).filter(|_| *at == now).copied()
    }

    /// Notes for the rest of the step which robot is picked from at a station.
    pub fn note_robot(&mut self, station: StationId, robot: Option<RobotId>, now: Time) {
        if self.looked_up.0 != now {
            self.looked_up = (now, BTreeMap::new());
        }
        self.looked_up.1.insert(station, robot);
    }

    /// Notes whether the rack of a visit that is over is kept at a station because a hand is inside.
    pub fn keep(&mut self, station: StationId, is_kept: bool) {
        if is_kept {
            self.kept.insert(station);
        } else {
            self.kept.remove(&station);
        }
    }

    /// Stations where racks are kept because a hand is inside.
    pub fn kept(&self) -> Vec<StationId> {
        self.kept.iter().copied().collect()
    }

    /// The visit that ended at a station a moment ago.
    pub fn ended(&self, station: StationId, now: Time) -> Option<(JobId, &Lines)> {
        let (job, lines, at) = self.ended.get(&station)?;
        (now - *at <= ENDED).then_some((*job, lines))
    }

    /// Notes the true end of the visit in progress at a station.
    pub fn tell(&mut self, station: StationId, at: Time) {
        self.told.insert(station, at);
    }

    /// Stations where a hand is in the opening or beyond it, or will be in a moment, or where two people are.
    pub fn hands_inside(&self, now: Time) -> Vec<StationId> {
        let comes = |(station, hands): (&StationId, &CellHands)| {
            let (_, face) = self.faces.get(station).filter(|_| hands.sees(now))?;
            hands.comes_inside(face, now).then_some(*station)
        };
        let shared = self.shared.keys().copied().filter(|s| self.is_shared(*s, now));
        self.cell_hands.iter().filter_map(comes).chain(shared).collect()
    }

    /// Whether a hand is seen in the opening of a station or beyond it.
    pub fn sees_inside(&self, station: StationId, now: Time) -> bool {
        let known = self.cell_hands.get(&station).zip(self.faces.get(&station));
        known.is_some_and(|(hands, (_, face))| hands.is_inside(face, now))
    }

    /// Takes the robots that were not to move because of hands; until `stop_at_hands` is called again, all may move.
    pub fn begin_hands(&mut self) -> BTreeMap<RobotId, StationId> {
        std::mem::take(&mut self.at_hands)
    }

    /// Notes robots that must not move because of hands, each with the station of the hand.
    pub fn stop_at_hands(&mut self, robots: impl IntoIterator<Item = (RobotId, StationId)>) {
        self.at_hands.extend(robots);
    }

    /// The station whose hands keep a robot from moving.
    pub fn at_hands(&self, robot: RobotId) -> Option<StationId> {
        self.at_hands.get(&robot).copied()
    }

    /// Notes that a person at a station is warned.
    pub fn note_warning(&mut self, station: StationId, wrong: WrongReach, now: Time) {
        self.counted[1] += 1;
        self.warned.insert(station, (wrong, now));
    }

    /// Whether any of these hands is where it can be wrong: at the face of the rack or in a tote. For hands elsewhere
    /// nothing more needs to be looked up.
    pub fn can_be_wrong(&self, seen: &HandsSeen) -> bool {
        let Some((_, face)) = self.faces.get(&seen.station) else { return false };
        seen.hands.iter().flatten().map(|hand| face.of(hand.grip())).any(|at| face.is_near(at))
    }

    /// The warning that these hands, seen now, would cause.
    pub fn would_warn(
        &self,
        model: &Arc<PickModel>,
        (lit, tote): (Option<SlotName>, Option<usize>),
        seen: &HandsSeen,
    ) -> Option<CellHandsEvent> {
        let (hands, (_, face)) = self.cell_hands.get(&seen.station).zip(self.faces.get(&seen.station))?;
        hands.would_warn(CellHandsScene { face, model, lit, tote }, seen)
    }

    /// Where the hands at a station are going.
    pub fn reaches(&self, station: StationId, now: Time) -> SmallVec<[SeenReach; 4]> {
        self.cell_hands.get(&station).map(|hands| hands.reaches(now)).unwrap_or_default()
    }

    /// Whether the hands of exactly one person were seen at a station lately.
    pub fn saw_hands(&self, station: StationId, now: Time) -> bool {
        self.cell_hands.get(&station).is_some_and(|hands| hands.saw_of_late(now))
    }

    /// How many lines were over, and how many reaches were warned of, since the program started.
    pub fn counted(&self) -> [u64; 2] {
        self.counted
    }

    /// The warning that was given at a station a moment ago.
    pub fn warning(&self, station: StationId, now: Time) -> Option<WrongReach> {
        self.warned.get(&station).filter(|(_, at)| now - *at < WARNED).map(|(wrong, _)| *wrong)
    }
}
