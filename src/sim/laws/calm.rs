//! The laws of calm guidance: a message stands for two seconds unless it becomes more severe, and no person is told to
//! stand for a robot that waits for that person.
//!
//! Main types: [`CalmLaws`], [`CalmFigures`]. They check the fleet's guidance at each step for every policy; the
//! published policies do not promise the second law. Refuses: to judge the content of a message.

use super::violation::Violation;
use giveway_fleet::{Edge, Fleet, GuidanceReason, GuidanceState, MESSAGE, Party, STANDOFF, replaces};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::HumanAwarePolicy;
use std::collections::BTreeMap;

/// How calm guidance was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CalmFigures {
    /// Messages that replaced another one.
    pub changes: u64,
    /// How many of these messages told a worker to stop.
    pub stops: u64,
    /// For how long, in total, people were told to stop for a robot that waited for them.
    pub against: Span,
}

/// Current message of each worker, and since when.
#[derive(Debug, Default)]
pub(super) struct CalmLaws {
    told: BTreeMap<WorkerId, (Words, Time)>,
    /// Workers who are told to stop for a robot that waits for them: the robot, and since when.
    against: BTreeMap<WorkerId, (RobotId, Time)>,
    looked: Option<Time>,
    pub figures: CalmFigures,
}

type Words = (GuidanceState, Option<GuidanceReason>);

impl CalmLaws {
    pub fn check(&mut self, now: Time, fleet: &Fleet) -> Vec<Violation> {
        let mut broken = Vec::new();
        let step = now - self.looked.replace(now).unwrap_or(now);
        for worker in fleet.ledger().workers.ids() {
            let Some((state, reason, _)) = fleet.message(worker) else {
                self.told.remove(&worker);
                self.against.remove(&worker);
                continue;
            };
            broken.extend(self.hear(worker, (state, reason), now));
            let robot = reason.filter(|_| state == GuidanceState::Stop).and_then(GuidanceReason::stands_for);
            let waits = |r: &RobotId| fleet.wait(Party::Robot(*r)).edge == Edge::On(Party::Worker(worker));
            let Some(robot) = robot.filter(waits) else {
                self.against.remove(&worker);
                continue;
            };
            self.figures.against += step;
            let (_, since) = *self.against.entry(worker).or_insert((robot, now));
            // A message from just before the limit stands as long as any message.
            if now - since > STANDOFF + MESSAGE && fleet.settings().policy == HumanAwarePolicy::Giveway {
                self.against.insert(worker, (robot, now));
                broken.push(Violation::Standoff(worker, robot));
            }
        }
        broken
    }

    /// Takes the message that a worker gets now.
    fn hear(&mut self, worker: WorkerId, words: Words, now: Time) -> Option<Violation> {
        let Some((before, since)) = self.told.get(&worker).copied() else {
            self.told.insert(worker, (words, now));
            return None;
        };
        if before.0 == words.0 {
            // The reason is always the current one, and it decides which message may replace this one.
            self.told.insert(worker, (words, since));
            return None;
        }
        self.told.insert(worker, (words, now));
        self.figures.changes += 1;
        self.figures.stops += u64::from(words.0 == GuidanceState::Stop && before.0 != GuidanceState::Stop);
        let flickers = now - since < MESSAGE && !replaces(words, before);
        flickers.then_some(Violation::Flickers(worker))
    }
}
