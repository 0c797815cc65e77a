//! One simulated worker with device and radio: what it does next, and what it hears.
//!
//! Main type: [`Member`]. Refuses: to know other workers.

use super::sensor::Device;
use crate::link::Link;
use crate::random::Stream;
use crate::scenario::{Faults, Workers};
use crate::walker::{Errand, Shown, Walker, ease};
use giveway_fleet::{Assignment, AssignmentState, Guidance, GuidanceReason, GuidanceState, Ledger};
use giveway_floor::geometry::Point;
use giveway_floor::id::{AssignmentId, NodeId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_people::human::Mover;
use std::collections::BTreeSet;

/// Purpose of the streams that draw where each worker works, see [`Stream::new`].
pub(super) const TASKS: u64 = 20;
/// Interval after which a lost message is sent again, in either direction.
pub(super) const AGAIN: Span = Span::from_millis(300);
/// Interval between two workers entering.
const APART: Span = Span::from_secs(3);
/// Workers who are told that the headset is lost touch marks after this time.
const TOUCHES_MARKS: Span = Span::from_secs(15);

/// One worker with device and radio.
#[derive(Debug)]
pub(super) struct Member {
    pub name: String,
    pub id: Option<WorkerId>,
    pub mover: Mover,
    /// The doors by which the worker enters and leaves, and the nodes where the worker works, if these are fewer than
    /// those of people on foot.
    pub doors: Option<Vec<Point>>,
    pub fronts: Option<Vec<NodeId>>,
    pub enters: Time,
    /// Where the fleet knew the worker before this world began: that worker never left.
    pub stays: Option<Point>,
    pub leaves: Time,
    pub walker: Option<Walker>,
    pub device: Option<Device>,
    /// The tag that the worker also wears, if any.
    pub tag: Option<Device>,
    pub tasks: Stream,
    pub asked: u64,
    pub done: BTreeSet<AssignmentId>,
    /// The latest guidance for the worker, how often it changed, and when it was last sent.
    pub told: Option<(u64, Guidance)>,
    pub sent: Time,
    pub heard: u64,
    pub radio: Link<(u64, Guidance)>,
    /// The other direction: the assignment that the worker reports as done, and when it last did so.
    pub button: Link<AssignmentId>,
    pub pressed: Time,
    /// What the worker may do next, and the places that everybody knows.
    pub job: Option<Errand>,
    pub known: Vec<Point>,
    /// Since when the worker has been told that the headset is lost or has a poor position.
    pub asked_for_marks: Option<Time>,
}

impl Member {
    pub fn new(i: usize, workers: &Workers, faults: &Faults, seed: u64, now: Time) -> Member {
        let who = i as u64;
        let link = |purpose, delays| (Stream::new(seed, purpose, who), Stream::new(seed, delays, who));
        let (radio, button) = (link(21, 23), link(22, 24));
        let enters = now + Span::from_secs_f64(workers.enter_s) + APART * i as i64;
        let name = match i.checked_sub(workers.count) {
            None => format!("worker-{}", i + 1),
            Some(k) => format!("driver-{}", k + 1),
        };
        Member {
            name,
            id: None,
            mover: workers.mover_of(i),
            doors: None,
            fronts: None,
            enters,
            stays: None,
            leaves: workers.leave_s.map_or(Time::MAX, |s| now + Span::from_secs_f64(s)),
            walker: None,
            device: None,
            tag: None,
            tasks: Stream::new(seed, TASKS, who),
            asked: 0,
            done: BTreeSet::new(),
            told: None,
            sent: now,
            heard: 0,
            radio: Link::new(faults.into(), radio.0, radio.1),
            button: Link::new(faults.into(), button.0, button.1),
            pressed: now,
            job: None,
            known: Vec::new(),
            asked_for_marks: None,
        }
    }

    /// Notes which doors and places of work a vehicle gets to. One that gets to no door never enters.
    pub fn reach(
        &mut self,
        warehouse: &Warehouse,
        walkways: &Walkways,
        (doors, fronts): (&[Point], &[NodeId]),
    ) {
        if self.mover == Mover::OnFoot {
            return;
        }
        let (clearance_m, cut) =
            (self.mover.clearance_m(), walkways.edges_narrower_than(self.mover.clearance_m()));
        let stand = |at: Point| walkways.stand_near(at, clearance_m);
        let doors: Vec<Point> = doors.iter().filter_map(|door| stand(*door)).collect();
        let is_reached = |n: &NodeId| {
            let goal = stand(warehouse.nodes[*n].at);
            doors.first().zip(goal).is_some_and(|(door, goal)| walkways.path(*door, goal, &cut).is_some())
        };
        self.fronts = Some(fronts.iter().copied().filter(is_reached).collect());
        self.doors = Some(doors);
    }

    /// Workers who have been told for a while that the headset is lost touch marks again.
    pub fn touch_marks(&mut self, now: Time) {
        if self.asked_for_marks.is_some_and(|since| now - since >= TOUCHES_MARKS) {
            self.asked_for_marks = None;
            self.device.iter_mut().for_each(Device::begin_frame);
        }
    }

    /// Receives guidance from the radio, and asks for guidance that was lost.
    pub fn listen(&mut self, now: Time) {
        if let Some((number, _)) = &self.told
            && *number > self.heard
            && now - self.sent >= AGAIN
        {
            self.sent = now;
            self.radio.send(now, self.told.clone().expect("just seen"));
        }
        while let Some((number, guidance)) = self.radio.receive(now) {
            if number > self.heard {
                self.heard = number;
                if let Some(walker) = &mut self.walker {
                    walker.hear(now, shown(&guidance));
                }
                let asked = matches!(
                    guidance.reason,
                    Some(GuidanceReason::NotTracked | GuidanceReason::PlaceUnsure(_))
                );
                self.asked_for_marks = asked.then(|| self.asked_for_marks.unwrap_or(now));
            }
        }
    }

    /// Looks up the next errand of each worker.
    pub fn look_up(&mut self, ledger: &Ledger, doors: &[Point], walkways: &Walkways) {
        self.job = self.next_job(ledger, walkways);
        let Some(worker) = self.id else { return };
        let mine = ledger.assignments.values().filter(|a| a.worker == Some(worker));
        let places = mine.map(|a| ledger.warehouse().nodes[a.request.place].at);
        let doors = self.doors.as_deref().unwrap_or(doors);
        let places = places.filter_map(|p| stand(p, &self.mover, walkways));
        self.known = doors.iter().copied().chain(places).collect();
    }

    /// A worker's next errand: the one that the device shows, or else the first one not done.
    fn next_job(&self, ledger: &Ledger, walkways: &Walkways) -> Option<Errand> {
        let worker = self.id?;
        let all = &ledger.assignments;
        // A worker who is told to leave or to wait outside looks for no work.
        let reason = self.told.as_ref().and_then(|(_, g)| g.reason);
        if matches!(
            reason,
            Some(
                GuidanceReason::Evacuation
                    | GuidanceReason::LeavesClosure(_)
                    | GuidanceReason::PlaceClosed(_)
            )
        ) {
            return None;
        }
        let shown = self.told.as_ref().and_then(|(_, g)| g.assignment);
        let is_open = |id: &AssignmentId, a: &Assignment| {
            a.worker == Some(worker) && !a.state.is_over() && !self.done.contains(id)
        };
        let shown = shown.and_then(|id| all.get_key_value(&id)).filter(|(id, a)| is_open(id, a));
        let at_work = |a: &Assignment| a.state != AssignmentState::Waiting;
        let first = || all.iter().find(|(id, a)| is_open(id, a) && at_work(a));
        let any = || all.iter().find(|(id, a)| is_open(id, a));
        let (id, assignment) = shown.or_else(first).or_else(any)?;
        let place = ledger.warehouse().nodes[assignment.request.place].at;
        let at = stand(place, &self.mover, walkways)?;
        Some(Errand { id: *id, at, stay: assignment.request.stay })
    }
}

fn shown(g: &Guidance) -> Shown {
    Shown {
        version: g.version,
        path: g.path.clone(),
        redirected: g.state == GuidanceState::Redirected,
        stop: g.state == GuidanceState::Stop,
        leave: matches!(g.reason, Some(GuidanceReason::Evacuation | GuidanceReason::LeavesClosure(_))),
    }
}

/// Where a worker stands to reach a place.
fn stand(place: Point, mover: &Mover, walkways: &Walkways) -> Option<Point> {
    match mover {
        Mover::OnFoot => walkways.on_floor(place).map(|p| ease(p, walkways)),
        Mover::Vehicle(_) => walkways.stand_near(place, mover.clearance_m()),
    }
}
