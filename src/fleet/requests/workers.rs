//! Requests about people: which workers are known, where one is, what one is to do.
//!
//! Refuses: to plan; what is asked for becomes a fact or a refusal.

use crate::requests::intake::Intake;
use crate::state::fact::{AssignmentFact, WorkerFact};
use crate::state::heard::WorkerInput;
use crate::state::refusal::{Bounded, Refusal, WorkerRefusal};
use crate::state::request::{Answer, Answered, Made};
use crate::state::worker::{AssignmentRequest, AssignmentState, LastPlace};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{AssignmentId, Dense, NodeId, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::Mover;
use std::ops::RangeInclusive;

/// Distances from a place that a supervisor may vouch for, millimetres: an unseen person is taken to get no farther.
const NARROWS_MM: RangeInclusive<i64> = 500..=8000;

impl Intake<'_> {
    pub(super) fn register_worker(&mut self, name: String, now: Time) -> Answered {
        let known = self.writer.ledger().workers.pairs().find(|(_, n)| **n == name).map(|(w, _)| w);
        if let Some(worker) = known {
            return Ok(Answer::Worker(Made { id: worker, new: false }));
        }
        let workers = &self.writer.ledger().workers;
        // As long as there are other numbers, no worker gets the number of one who has gone.
        let worker = if workers.len() < self.writer.settings.limits.workers {
            WorkerId::at(workers.len())
        } else {
            let free = workers.pairs().find(|(_, name)| name.is_empty()).map(|(worker, _)| worker);
            free.ok_or(Refusal::TooMany(Bounded::Workers, workers.len()))?
        };
        self.writer.record(WorkerFact::Registered { worker, name, at: now });
        Ok(Answer::Worker(Made { id: worker, new: true }))
    }

    /// Notes what a worker moves as. Nothing happens if that is known.
    pub(super) fn move_as(&mut self, worker: WorkerId, mover: Mover, now: Time) -> Answered {
        if !self.writer.ledger().knows(worker) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        if self.writer.ledger().mover(worker) != mover {
            self.writer.record(WorkerFact::Moves { worker, mover, at: now });
        }
        Ok(Answer::Done)
    }

    /// Forgets a worker. The caller has made sure that no list says any more who it was.
    pub(super) fn forget_worker(&mut self, worker: WorkerId, now: Time) -> Answered {
        let ledger = &self.writer.ledger();
        if !ledger.knows(worker) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        let is_assigned = ledger.assignments.values().any(|a| a.worker == Some(worker));
        if is_assigned || ledger.on_floor.contains_key(&worker) {
            return Err(Refusal::Worker(WorkerRefusal::Busy(worker)));
        }
        self.heard.people.push(WorkerInput::Cleared(worker));
        self.writer.record(WorkerFact::Registered { worker, name: String::new(), at: now });
        Ok(Answer::Done)
    }

    pub(super) fn assign(
        &mut self,
        worker: Option<WorkerId>,
        request: AssignmentRequest,
        now: Time,
    ) -> Answered {
        if let Some(id) = request.key.as_ref().and_then(|k| self.writer.ledger().assignment_keys.get(k)) {
            return Ok(Answer::Assignment(Made { id: *id, new: false }));
        }
        if let Some(worker) = worker.filter(|w| !self.writer.ledger().knows(*w)) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        self.check_reached(worker, request.place)?;
        if self.writer.ledger().assignments.len() >= self.writer.settings.limits.open_assignments {
            return Err(Refusal::TooMany(Bounded::Assignments, self.writer.ledger().assignments.len()));
        }
        let assignment = AssignmentId(self.writer.ledger().next_assignment);
        self.writer.record(AssignmentFact::Assigned { assignment, worker, request, at: now });
        Ok(Answer::Assignment(Made { id: assignment, new: true }))
    }

    /// Checks that a worker can get near a node: on foot, or with the vehicle.
    fn check_reached(&self, worker: Option<WorkerId>, place: NodeId) -> Result<(), Refusal> {
        let Some(node) = self.writer.warehouse().nodes.get(place) else { return Err(Refusal::UnknownPlace) };
        let mover = worker.map_or(Mover::OnFoot, |w| self.writer.ledger().mover(w));
        match self.walkways.stand_near(node.at, mover.clearance_m()) {
            Some(_) => Ok(()),
            None => Err(Refusal::Worker(WorkerRefusal::OutOfReach(place))),
        }
    }

    pub(super) fn take_back(&mut self, id: AssignmentId, now: Time) -> Answered {
        if !self.writer.ledger().assignments.contains_key(&id) {
            return Err(Refusal::Worker(WorkerRefusal::UnknownAssignment(id)));
        }
        self.writer.record(AssignmentFact::Advanced {
            assignment: id,
            state: AssignmentState::Cancelled,
            at: now,
        });
        Ok(Answer::Done)
    }

    /// Takes the worker's word for it: the person who did the work knows, and devices may see a worker in the wrong
    /// place.
    pub(super) fn finish(&mut self, worker: WorkerId, id: AssignmentId, now: Time) -> Answered {
        if self.writer.ledger().assignments.get(&id).is_none_or(|a| a.worker != Some(worker)) {
            return Err(Refusal::Worker(WorkerRefusal::UnknownAssignment(id)));
        }
        self.writer.record(AssignmentFact::Advanced {
            assignment: id,
            state: AssignmentState::Done,
            at: now,
        });
        Ok(Answer::Done)
    }

    pub(super) fn clear_worker(&mut self, worker: WorkerId, by: String, now: Time) -> Answered {
        if !self.writer.ledger().knows(worker) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        self.heard.people.push(WorkerInput::Cleared(worker));
        self.writer.record(WorkerFact::Cleared { worker, by: Some(by), at: now });
        Ok(Answer::Done)
    }

    pub(super) fn sign_off(&mut self, worker: WorkerId) -> Answered {
        if !self.writer.ledger().knows(worker) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        self.heard.people.push(WorkerInput::SignedOff(worker));
        Ok(Answer::Done)
    }

    /// Takes a supervisor's word for where a lost worker is.
    pub(super) fn narrow_worker(
        &mut self,
        worker: WorkerId,
        by: String,
        (at, within_mm): (Spot, i64),
        now: Time,
    ) -> Answered {
        if !self.writer.ledger().knows(worker) {
            return Err(Refusal::Worker(WorkerRefusal::Unknown(worker)));
        }
        if !self.lost.contains(&worker) {
            return Err(Refusal::Worker(WorkerRefusal::NotLost(worker)));
        }
        let can_be = NARROWS_MM.contains(&within_mm) && self.walkways.on_floor(at.into()).is_some();
        if !can_be {
            return Err(Refusal::Worker(WorkerRefusal::NoPlaceForPeople));
        }
        let place = LastPlace { at, seen: now, within_mm: Some(within_mm) };
        self.heard.people.push(WorkerInput::Narrowed(worker, place));
        self.writer.record(WorkerFact::Narrowed { worker, place, by, at: now });
        Ok(Answer::Done)
    }
}
