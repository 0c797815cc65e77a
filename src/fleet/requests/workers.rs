//! Requests about people: who is known, who is to do what, where robots are to keep out.
//!
//! Refuses: to plan; what is asked for becomes a fact or a refusal.

use crate::fleet::requests::intake::Intake;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::heard::WorkerInput;
use crate::fleet::state::io::{Input, Reply};
use crate::fleet::state::recurring::RecurringClosure;
use crate::fleet::state::refusal::{Bounded, Refusal};
use crate::fleet::state::worker::{AssignmentRequest, AssignmentState, Closure, LastPlace};
use crate::geometry::Spot;
use crate::id::{AssignmentId, ClosureId, Dense, NodeId, SeriesId, WorkerId};
use crate::time::Time;
use crate::warehouse::NodeKind;
use std::ops::RangeInclusive;

/// How near to a place a supervisor may say that somebody is, millimetres: an unseen person is taken to get no farther.
const NARROWS_MM: RangeInclusive<i64> = 500..=8000;

impl Intake<'_> {
    /// Takes a request about people in.
    pub(in crate::fleet) fn absorb_request(&mut self, input: Input, now: Time) {
        let (token, answer) = match input {
            Input::RegisterWorker { token, name } => (token, self.register_worker(token, name, now)),
            Input::Assign { token, worker, request } => (token, self.assign(token, worker, request, now)),
            Input::Unassign { token, assignment } => (token, self.take_back(token, assignment, now)),
            Input::Finish { token, worker, assignment } => {
                (token, self.finish(token, worker, assignment, now))
            }
            Input::Close { token, area } => (token, self.close(token, area)),
            Input::Reopen { token, closure } => (token, self.reopen(token, closure, now)),
            Input::Recur { token, closure } => (token, self.recur(token, closure)),
            Input::EndSeries { token, series } => (token, self.end_series(token, series, now)),
            Input::Evacuate { token } => (token, self.evacuate(token, now)),
            Input::EndEvacuation { token } => (token, self.end_evacuation(token, now)),
            Input::ForgetWorker { token, worker } => (token, self.forget_worker(token, worker, now)),
            Input::ClearWorker { token, worker, by } => (token, self.clear_worker(token, worker, by, now)),
            Input::SignedOff { token, worker } => (token, self.sign_off(token, worker)),
            Input::NarrowWorker { token, worker, by, at, within_mm } => {
                (token, self.narrow_worker(token, worker, by, (at, within_mm), now))
            }
            Input::Halt { token, robot } => (token, self.halt(token, robot, now)),
            Input::Release { token, robot } => (token, self.release(token, robot, now)),
            Input::Station { token, station, order } => {
                (token, self.hear_station(token, station, order, now))
            }
            Input::Register { token, name, kind, node } => {
                (token, self.register(token, (name, kind), node, now))
            }
            Input::Maintain { token, robot, begins } => (token, self.maintain(token, robot, begins, now)),
            Input::Retire { token, robot } => (token, self.retire(token, robot, now)),
            Input::TakeRack { token, rack, node } => (token, self.take_rack_off(token, rack, node, now)),
            Input::Change { token, job, change } => (token, self.change(token, job, change, now)),
            Input::Reassign { token, job, robot } => (token, self.reassign(token, job, robot, now)),
            _ => unreachable!("telemetry, sightings and jobs are taken in elsewhere"),
        };
        self.core.out.replies.push(answer.unwrap_or_else(|why| Reply::Refused { token, why }));
    }

    fn register_worker(&mut self, token: u64, name: String, now: Time) -> Result<Reply, Refusal> {
        let known = self.core.ledger.workers.pairs().find(|(_, n)| **n == name).map(|(w, _)| w);
        if let Some(worker) = known {
            return Ok(Reply::WorkerRegistered { token, worker, new: false });
        }
        let workers = &self.core.ledger.workers;
        // As long as there are others, nobody gets the number of somebody who has gone.
        let worker = if workers.len() < self.core.settings.workers_max {
            WorkerId::at(workers.len())
        } else {
            let free = workers.pairs().find(|(_, name)| name.is_empty()).map(|(worker, _)| worker);
            free.ok_or(Refusal::TooMany(Bounded::Workers, workers.len()))?
        };
        self.core.record(Fact::WorkerRegistered { worker, name, at: now });
        Ok(Reply::WorkerRegistered { token, worker, new: true })
    }

    /// Whoever calls this has seen to it that no list says any more who it was.
    fn forget_worker(&mut self, token: u64, worker: WorkerId, now: Time) -> Result<Reply, Refusal> {
        let ledger = &self.core.ledger;
        if !ledger.knows(worker) {
            return Err(Refusal::UnknownWorker(worker));
        }
        let is_assigned = ledger.assignments.values().any(|a| a.worker == Some(worker));
        if is_assigned || ledger.on_floor.contains_key(&worker) {
            return Err(Refusal::WorkerBusy(worker));
        }
        self.heard.people.push(WorkerInput::Cleared(worker));
        self.core.record(Fact::WorkerRegistered { worker, name: String::new(), at: now });
        Ok(Reply::Done { token })
    }

    fn assign(
        &mut self,
        token: u64,
        worker: Option<WorkerId>,
        request: AssignmentRequest,
        now: Time,
    ) -> Result<Reply, Refusal> {
        if let Some(id) = request.key.as_ref().and_then(|k| self.core.ledger.assignment_keys.get(k)) {
            return Ok(Reply::Assigned { token, assignment: *id, new: false });
        }
        if let Some(worker) = worker.filter(|w| !self.core.ledger.knows(*w)) {
            return Err(Refusal::UnknownWorker(worker));
        }
        self.check_walkable(request.place)?;
        if self.core.ledger.assignments.len() >= self.core.settings.assignments_max {
            return Err(Refusal::TooMany(Bounded::Assignments, self.core.ledger.assignments.len()));
        }
        let assignment = AssignmentId(self.core.ledger.next_assignment);
        self.core.record(Fact::Assigned { assignment, worker, request, at: now });
        Ok(Reply::Assigned { token, assignment, new: true })
    }

    /// Whether a worker can get near a node on foot.
    fn check_walkable(&self, place: NodeId) -> Result<(), Refusal> {
        let Some(node) = self.core.warehouse().nodes.get(place) else { return Err(Refusal::UnknownPlace) };
        match self.walkways.on_floor(node.at) {
            Some(_) => Ok(()),
            None => Err(Refusal::OutOfReach(place)),
        }
    }

    fn take_back(&mut self, token: u64, id: AssignmentId, now: Time) -> Result<Reply, Refusal> {
        if !self.core.ledger.assignments.contains_key(&id) {
            return Err(Refusal::UnknownAssignment(id));
        }
        self.core.record(Fact::Advanced { assignment: id, state: AssignmentState::Cancelled, at: now });
        Ok(Reply::Done { token })
    }

    /// Takes a worker's word for it: the person who did the work knows, and devices may see a worker at the wrong
    /// place.
    fn finish(
        &mut self,
        token: u64,
        worker: WorkerId,
        id: AssignmentId,
        now: Time,
    ) -> Result<Reply, Refusal> {
        if self.core.ledger.assignments.get(&id).is_none_or(|a| a.worker != Some(worker)) {
            return Err(Refusal::UnknownAssignment(id));
        }
        self.core.record(Fact::Advanced { assignment: id, state: AssignmentState::Done, at: now });
        Ok(Reply::Done { token })
    }

    /// Whether an area can be closed.
    fn check_area(&self, area: &Closure) -> Result<(), Refusal> {
        if area.outline.len() < 3 || area.window.start() >= area.window.end() {
            return Err(Refusal::EmptyArea);
        }
        if area.outline.len() > self.core.settings.corners_max {
            return Err(Refusal::TooManyCorners(self.core.settings.corners_max));
        }
        if area.nodes.iter().any(|n| self.core.warehouse().nodes.get(*n).is_none()) {
            return Err(Refusal::UnknownPlace);
        }
        Ok(())
    }

    fn close(&mut self, token: u64, area: Closure) -> Result<Reply, Refusal> {
        self.check_area(&area)?;
        if self.core.ledger.closures.len() >= self.core.settings.closures_max {
            return Err(Refusal::TooMany(Bounded::Closures, self.core.ledger.closures.len()));
        }
        let closure = ClosureId(self.core.ledger.next_closure);
        self.core.record(Fact::Closed { closure, area });
        Ok(Reply::Closed { token, closure })
    }

    fn reopen(&mut self, token: u64, closure: ClosureId, now: Time) -> Result<Reply, Refusal> {
        if !self.core.ledger.closures.contains_key(&closure) {
            return Err(Refusal::UnknownClosure(closure));
        }
        self.core.record(Fact::Reopened { closure, at: now });
        Ok(Reply::Done { token })
    }

    fn recur(&mut self, token: u64, closure: RecurringClosure) -> Result<Reply, Refusal> {
        self.check_area(&closure.area)?;
        if !closure.can_be() {
            return Err(Refusal::Recurrence);
        }
        let ledger = &self.core.ledger;
        if ledger.recurring.len() >= self.core.settings.series_max {
            return Err(Refusal::TooMany(Bounded::Series, ledger.recurring.len()));
        }
        let series = SeriesId(ledger.next_series);
        let area = Closure { series: Some(series), ..closure.area };
        self.core.record(Fact::Recurs { series, closure: RecurringClosure { area, ..closure } });
        Ok(Reply::Recurs { token, series })
    }

    /// A closure recurs no more; what is announced of it, or in force, ends.
    fn end_series(&mut self, token: u64, series: SeriesId, now: Time) -> Result<Reply, Refusal> {
        if !self.core.ledger.recurring.contains_key(&series) {
            return Err(Refusal::UnknownSeries(series));
        }
        let closures = self.core.ledger.closures.iter();
        let open = closures.filter(|(_, c)| c.series == Some(series) && now < c.window.end());
        let open: Vec<ClosureId> = open.map(|(id, _)| *id).collect();
        self.core.record(Fact::SeriesEnded { series, at: now });
        open.into_iter().for_each(|closure| self.core.record(Fact::Reopened { closure, at: now }));
        Ok(Reply::Done { token })
    }

    /// Everybody is to leave the building; said again, it changes nothing.
    fn evacuate(&mut self, token: u64, now: Time) -> Result<Reply, Refusal> {
        if self.core.warehouse().nodes_where(|k| k == NodeKind::Exit).is_empty() {
            return Err(Refusal::NoExits);
        }
        if self.core.ledger.evacuation.is_none() {
            self.core.record(Fact::Evacuated { at: now });
        }
        Ok(Reply::Done { token })
    }

    fn end_evacuation(&mut self, token: u64, now: Time) -> Result<Reply, Refusal> {
        if self.core.ledger.evacuation.is_some() {
            self.core.record(Fact::EvacuationEnded { at: now });
        }
        Ok(Reply::Done { token })
    }

    fn clear_worker(
        &mut self,
        token: u64,
        worker: WorkerId,
        by: String,
        now: Time,
    ) -> Result<Reply, Refusal> {
        if !self.core.ledger.knows(worker) {
            return Err(Refusal::UnknownWorker(worker));
        }
        self.heard.people.push(WorkerInput::Cleared(worker));
        self.core.record(Fact::WorkerCleared { worker, by: Some(by), at: now });
        Ok(Reply::Done { token })
    }

    fn sign_off(&mut self, token: u64, worker: WorkerId) -> Result<Reply, Refusal> {
        if !self.core.ledger.knows(worker) {
            return Err(Refusal::UnknownWorker(worker));
        }
        self.heard.people.push(WorkerInput::SignedOff(worker));
        Ok(Reply::Done { token })
    }

    /// A supervisor has seen where a lost worker is.
    fn narrow_worker(
        &mut self,
        token: u64,
        worker: WorkerId,
        by: String,
        (at, within_mm): (Spot, i64),
        now: Time,
    ) -> Result<Reply, Refusal> {
        if !self.core.ledger.knows(worker) {
            return Err(Refusal::UnknownWorker(worker));
        }
        if !self.lost.contains(&worker) {
            return Err(Refusal::NotLost(worker));
        }
        let can_be = NARROWS_MM.contains(&within_mm) && self.walkways.on_floor(at.into()).is_some();
        if !can_be {
            return Err(Refusal::NoPlaceForPeople);
        }
        let place = LastPlace { at, seen: now, within_mm: Some(within_mm) };
        self.heard.people.push(WorkerInput::Narrowed(worker, place));
        self.core.record(Fact::WorkerNarrowed { worker, place, by, at: now });
        Ok(Reply::Done { token })
    }
}
