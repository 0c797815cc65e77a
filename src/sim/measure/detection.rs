//! How well the fleet detects when people leave their path and where they go, scored against the truth.
//!
//! Main types: [`Watch`] (collects what the fleet says), [`Score`]. Refuses: to tell the fleet anything.

use crate::walker::{CauseStretch, Log, WalkCause};
use giveway_fleet::{EncounterFact, Fact, Fleet, Guidance, GuidanceReason, GuidanceState};
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// Shorter deviations than this need not be detected.
const SHORTEST: Span = Span::from_secs(1);
/// An alarm up to this long after a deviation still counts for it.
const GRACE: Span = Span::from_secs(2);
/// Interval between two looks at the beliefs about goals.
const LOOK: Span = Span::from_secs(1);
/// A goal nearer to the true one than this counts as the same, metres.
const SAME_GOAL_M: f64 = 1.5;
/// Ends of the classes of time left to the goal, seconds.
pub const TO_GOAL_S: [f64; 5] = [2.0, 4.0, 8.0, 16.0, f64::INFINITY];

/// What the fleet says about one worker.
#[derive(Clone, Debug, Default)]
struct WorkerSaid {
    /// From when to when the fleet held that the worker is off the path.
    off_path: Vec<(Time, Time)>,
    alarms: Vec<Time>,
    goals: Vec<(Time, Point)>,
}

/// Collects the fleet's statements about workers.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    said: BTreeMap<WorkerId, WorkerSaid>,
    next_look: Time,
}

/// How well one cause was detected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CauseScore {
    /// How often the cause occurred for at least a second.
    pub times: u64,
    /// How often the fleet held that the worker was off the path. For causes that keep to the path: alarms meanwhile.
    pub noticed: u64,
}

/// How well the fleet detected deviations and goals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    /// Scores by the word of the cause.
    pub causes: BTreeMap<&'static str, CauseScore>,
    /// Delays from the beginning of each noticed deviation to its detection, seconds, ascending.
    pub delays_s: Vec<f64>,
    /// All alarms.
    pub alarms: u64,
    /// Alarms without a deviation.
    pub false_alarms: u64,
    /// Time of workers on the floor, hours.
    pub hours: f64,
    /// Per class of time left to the goal: looks, and those where the most probable goal was the true one.
    pub top1: [(u64, u64); TO_GOAL_S.len()],
}

impl Watch {
    /// Records the alarms and guidance of a step.
    pub fn note(&mut self, now: Time, facts: &[Fact], guidance: &[(WorkerId, Guidance)]) {
        for fact in facts {
            if let Fact::Encounter(EncounterFact::Deviated { worker, at }) = fact {
                self.said.entry(*worker).or_default().alarms.push(*at);
            }
        }
        for (worker, g) in guidance {
            let off = g.state == GuidanceState::Deviating
                || (g.state == GuidanceState::Redirected && g.reason == Some(GuidanceReason::LeftPath));
            let spells = &mut self.said.entry(*worker).or_default().off_path;
            let open = spells.last().is_some_and(|(_, to)| to.is_forever());
            match (open, off) {
                (false, true) => spells.push((now, Time::MAX)),
                (true, false) => spells.last_mut().expect("one is open").1 = now,
                _ => {}
            }
        }
    }

    /// Records the beliefs about goals at intervals.
    pub fn look(&mut self, now: Time, fleet: &Fleet) {
        if now < self.next_look || fleet.ledger().workers.is_empty() {
            return;
        }
        self.next_look = now + LOOK;
        for ((worker, _), view) in fleet.ledger().workers.pairs().zip(fleet.view(now).workers) {
            if let Some((goal, p)) = view.goals.first()
                && *p > view.undecided.max(view.elsewhere)
            {
                self.said.entry(worker).or_default().goals.push((now, *goal));
            } else if view.pose.is_some() {
                // The fleet names no goal: that counts as a miss.
                let nowhere = Point::new(f64::INFINITY, f64::INFINITY);
                self.said.entry(worker).or_default().goals.push((now, nowhere));
            }
        }
    }

    /// Scores the fleet's statements against the truth until `end`.
    pub fn score<'a>(&self, logs: impl Iterator<Item = (WorkerId, &'a Log)>, end: Time) -> Score {
        let mut score = Score::default();
        let silent = WorkerSaid::default();
        for (worker, log) in logs {
            score.add(self.said.get(&worker).unwrap_or(&silent), log.segments(), end);
        }
        score.delays_s.sort_by(f64::total_cmp);
        score
    }
}

impl Score {
    fn add(&mut self, said: &WorkerSaid, segments: &[CauseStretch], end: Time) {
        for s in segments {
            let to = s.to.min(end);
            self.hours += (to - s.from).as_secs_f64() / 3600.0;
            let entry = self.causes.entry(s.cause.word()).or_default();
            if !s.cause.is_deviation() {
                entry.times += 1;
            } else if to - s.from >= SHORTEST {
                entry.times += 1;
                let spell = said.off_path.iter().find(|(from, until)| *from < to + GRACE && *until > s.from);
                if let Some((from, _)) = spell {
                    entry.noticed += 1;
                    self.delays_s.push((*from - s.from).as_secs_f64().max(0.0));
                }
            }
            self.add_goals(said, s, to, end);
        }
        for alarm in &said.alarms {
            self.alarms += 1;
            let about =
                |s: &&CauseStretch| s.from <= *alarm && *alarm < s.to + GRACE && s.cause.is_deviation();
            if !segments.iter().any(|s| about(&s)) {
                self.false_alarms += 1;
                let during = segments.iter().find(|s| s.from <= *alarm && *alarm < s.to);
                let word = during.map_or(WalkCause::OnPath, |s| s.cause).word();
                self.causes.entry(word).or_default().noticed += 1;
            }
        }
    }

    /// Only stretches that were walked to their end show how early the goal was known.
    fn add_goals(&mut self, said: &WorkerSaid, s: &CauseStretch, to: Time, end: Time) {
        let Some(goal) = s.goal.filter(|_| s.to < end) else { return };
        for (at, top) in said.goals.iter().filter(|(at, _)| s.from <= *at && *at < to) {
            let left = (to - *at).as_secs_f64();
            let class = TO_GOAL_S.iter().position(|t| left < *t).expect("the last class has no end");
            self.top1[class].0 += 1;
            self.top1[class].1 += u64::from((top - goal).norm() < SAME_GOAL_M);
        }
    }

    /// Share of alarms that were about a deviation.
    pub fn precision(&self) -> Option<f64> {
        (self.alarms > 0).then(|| 1.0 - self.false_alarms as f64 / self.alarms as f64)
    }

    /// Deviations that occurred.
    pub fn deviations(&self) -> u64 {
        let is_deviation = |word: &str| WalkCause::ALL.iter().any(|c| c.word() == word && c.is_deviation());
        self.causes.iter().filter(|(word, _)| is_deviation(word)).map(|(_, c)| c.times).sum()
    }

    /// Adds another score to this one.
    pub fn merge(&mut self, other: &Score) {
        for (word, theirs) in &other.causes {
            let ours = self.causes.entry(word).or_default();
            (ours.times, ours.noticed) = (ours.times + theirs.times, ours.noticed + theirs.noticed);
        }
        self.delays_s.extend(&other.delays_s);
        self.delays_s.sort_by(f64::total_cmp);
        self.alarms += other.alarms;
        self.false_alarms += other.false_alarms;
        self.hours += other.hours;
        for (ours, theirs) in self.top1.iter_mut().zip(other.top1) {
            *ours = (ours.0 + theirs.0, ours.1 + theirs.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Time {
        Time::from_secs_f64(s)
    }

    fn segment(from: f64, to: f64, cause: WalkCause, goal: Option<Point>) -> CauseStretch {
        CauseStretch { from: at(from), to: at(to), cause, goal }
    }

    #[test]
    fn alarms_are_matched_with_deviations_and_late_ones_with_none() {
        let there = Point::new(5.0, 5.0);
        let shop = Some(there);
        let log = [
            segment(0.0, 10.0, WalkCause::OnPath, None),
            segment(10.0, 20.0, WalkCause::Scripted, shop),
            segment(20.0, 30.0, WalkCause::Pause, None),
            segment(30.0, 30.5, WalkCause::Detour, shop),
            segment(30.5, 60.0, WalkCause::UnknownGoal, shop),
        ];
        let said = WorkerSaid {
            off_path: vec![(at(12.5), at(21.0)), (at(25.0), at(26.0))],
            alarms: vec![at(12.5), at(25.0)],
            goals: vec![(at(11.0), Point::origin()), (at(17.0), Point::new(5.0, 6.0)), (at(19.0), there)],
        };
        let mut score = Score::default();
        score.add(&said, &log, at(60.0));
        assert_eq!(score.causes["scripted"], CauseScore { times: 1, noticed: 1 });
        assert_eq!(score.causes["unknown_goal"], CauseScore { times: 1, noticed: 0 });
        assert_eq!(score.causes["pause"], CauseScore { times: 1, noticed: 1 });
        assert_eq!(score.causes["detour"], CauseScore { times: 0, noticed: 0 }, "too short to ask for");
        assert_eq!(score.delays_s, vec![2.5]);
        assert_eq!((score.alarms, score.false_alarms, score.deviations()), (2, 1, 2));
        assert_eq!(score.precision(), Some(0.5));
        assert_eq!(score.top1, [(1, 1), (1, 1), (0, 0), (1, 0), (0, 0)]);
        assert!((score.hours - 60.0 / 3600.0).abs() < 1e-9);
    }
}
