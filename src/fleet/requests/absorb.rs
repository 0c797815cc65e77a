//! First phase: take everything in. Observations go to the scene, requests become facts or refusals.
//!
//! Refuses: to decide anything about robots.

use crate::requests::intake::Intake;
use crate::state::fact::FloorFact;
use crate::state::heard::{StepNews, WorkerInput};
use crate::state::io::{Input, Telemetry};
use crate::state::request::{
    Answer, Answered, FloorAction, JobAction, Request, RobotAction, Token, WorkerAction,
};
use crate::state::scene::SILENCE;
use crate::state::writer::Writer;
use giveway_floor::id::{Dense, WorkerId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::walkway::Walkways;

/// Takes all inputs in: observations of robots go to the scene, requests become facts or refusals. `walkways` is where
/// workers can walk, `lost` are the workers whose place is not known.
pub(crate) fn absorb(
    writer: &mut Writer,
    (walkways, lost): (&Walkways, &[WorkerId]),
    now: Time,
    inputs: Vec<Input>,
) -> StepNews {
    let mut intake = Intake { writer, walkways, lost, heard: StepNews::default() };
    intake.take_in(now, inputs);
    intake.heard
}

// A new request that no code carries out must not compile.
#[deny(clippy::wildcard_enum_match_arm)]
impl Intake<'_> {
    /// Takes all inputs in.
    fn take_in(&mut self, now: Time, inputs: Vec<Input>) {
        self.writer.scene.begin(now);
        self.expire_keys(now);
        for input in inputs {
            self.take(input, now);
        }
        self.move_arms(now);
        self.let_kept_go(now);
    }

    /// Takes one input in.
    fn take(&mut self, input: Input, now: Time) {
        match input {
            Input::Telemetry(t) if t.robot.ix() >= self.writer.ledger().robots.len() => {
                tracing::warn!(robot = ?t.robot, "telemetry from an unknown robot");
            }
            Input::Telemetry(t) if self.is_from_before(&t, now) => {}
            Input::Telemetry(t) => self.writer.scene.see(t, now),
            Input::Link(robot, state) if robot.ix() < self.writer.ledger().robots.len() => {
                self.writer.scene.hear_link(robot, state, now);
            }
            Input::Link(robot, _) => tracing::warn!(?robot, "a link knows a robot that is not here"),
            Input::Sighted(s) if self.writer.ledger().knows(s.worker) => {
                self.heard.people.push(WorkerInput::Seen(s));
            }
            Input::Sighted(s) => tracing::warn!(worker = ?s.worker, "sighting of an unknown worker"),
            Input::Hands(seen) => self.hear_hands(&seen, now),
            Input::Arm(said) => self.hear_arm(&said, now),
            Input::VisitEnds { station, at } => self.writer.visits.tell(station, at),
            Input::Ask { token, request } => self.answer(token, request, now),
        }
    }

    /// Whether this report is older than what is durable of its robot. Just after a start the number of a report does
    /// not tell, since none has come yet. A robot does not go back behind what it has left; a robot that still reports
    /// so when others would count as silent is believed.
    fn is_from_before(&self, t: &Telemetry, now: Time) -> bool {
        let scene = &self.writer.scene;
        let is_first = scene.robot(t.robot).is_none();
        let just_began = scene.began().is_none_or(|began| now - began < SILENCE);
        is_first
            && just_began
            && self.writer.ledger().timeline().chain(t.robot).is_some_and(|chain| t.reached < chain.first())
    }

    /// Carries a request out or refuses it, and notes which facts it caused.
    fn answer(&mut self, token: Token, request: Request, now: Time) {
        let before = self.writer.facts().len();
        let answer = match request {
            Request::Job(action) => self.take_job(action, now),
            Request::Robot(action) => self.take_robot(action, now),
            Request::Station(station, order) => self.hear_station(station, order, now),
            Request::Worker(action) => self.take_worker(action, now),
            Request::Floor(action) => self.take_floor(action, now),
        };
        let facts = before..self.writer.facts().len();
        self.writer.answer(token, answer, facts);
    }

    fn take_job(&mut self, action: JobAction, now: Time) -> Answered {
        match action {
            JobAction::Submit(request) => self.submit(request, now).map(Answer::Job),
            JobAction::SubmitBatch(requests) => {
                Ok(Answer::Jobs(requests.into_iter().map(|request| self.submit(request, now)).collect()))
            }
            JobAction::Cancel(job) => self.cancel(job, now),
            JobAction::Change(job, change) => self.change(job, change, now),
            JobAction::Reassign(job, robot) => self.reassign(job, robot, now),
        }
    }

    fn take_robot(&mut self, action: RobotAction, now: Time) -> Answered {
        match action {
            RobotAction::Register { name, kind, node, link } => self.register((name, kind, link), node, now),
            RobotAction::BeginMaintenance(robot) => self.begin_maintenance(robot, now),
            RobotAction::EndMaintenance(robot) => self.end_maintenance(robot),
            RobotAction::Retire(robot) => self.retire(robot, now),
            RobotAction::TakeRack { rack, node } => self.take_rack_off(rack, node, now),
        }
    }

    fn take_worker(&mut self, action: WorkerAction, now: Time) -> Answered {
        match action {
            WorkerAction::Register(name) => self.register_worker(name, now),
            WorkerAction::MoveAs(worker, mover) => self.move_as(worker, mover, now),
            WorkerAction::Forget(worker) => self.forget_worker(worker, now),
            WorkerAction::Clear { worker, by } => self.clear_worker(worker, by, now),
            WorkerAction::Narrow { worker, by, at, within_mm } => {
                self.narrow_worker(worker, by, (at, within_mm), now)
            }
            WorkerAction::SignOff(worker) => self.sign_off(worker),
            WorkerAction::Assign { worker, request } => self.assign(worker, request, now),
            WorkerAction::Unassign(assignment) => self.take_back(assignment, now),
            WorkerAction::Finish(worker, assignment) => self.finish(worker, assignment, now),
        }
    }

    fn take_floor(&mut self, action: FloorAction, now: Time) -> Answered {
        match action {
            FloorAction::Close(area) => self.close(area),
            FloorAction::Reopen(closure) => self.reopen(closure, now),
            FloorAction::Recur(closure) => self.recur(closure),
            FloorAction::EndSeries(series) => self.end_series(series, now),
            FloorAction::Evacuate => self.evacuate(now),
            FloorAction::EndEvacuation => self.end_evacuation(now),
            FloorAction::Halt(robot) => self.halt(robot, now),
            FloorAction::Release(robot) => self.release(robot, now),
            FloorAction::PutKind(kind) => self.put_kind(kind, now),
            FloorAction::RemoveKind(name) => self.remove_kind(name, now),
        }
    }

    /// Forgets some of the keys that are too old.
    fn expire_keys(&mut self, now: Time) {
        let (jobs, assignments) =
            (self.writer.ledger().keys.expired(now), self.writer.ledger().assignment_keys.expired(now));
        if !jobs.is_empty() || !assignments.is_empty() {
            self.writer.record(FloorFact::KeysExpired { jobs, assignments });
        }
    }
}
