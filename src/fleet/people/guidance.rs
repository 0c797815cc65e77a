//! What workers are told: path, next node, robots nearby, and their situation. It leaves in the step that decides it.
//!
//! Refuses: to decide where a worker is to go.

use crate::people::message::{Message, Words};
use crate::people::state::{HumanState, LetsPassStage, Person, WalkMode};
use crate::state::floor::Floor;
use crate::state::worker::{Guidance, GuidanceReason, GuidanceState, NearRobot};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::{Presence, Whereabouts};

/// Robots nearer than this are shown, metres.
const NEAR_M: f64 = 8.0;
/// How many robots are shown at most.
const NEAR_MOST: usize = 8;
/// A robot slower than this does not drive up to a person, metres per second.
const DRIVES_MPS: f64 = 0.1;
/// Guidance is repeated this often.
const REPEAT: Span = Span::from_millis(200);

impl HumanState {
    /// The guidance that workers get now: where it changed, or is due again. Marks what was seen of them in this step
    /// as old.
    pub(super) fn guide(&mut self, floor: Floor<'_>, now: Time) -> Vec<(WorkerId, Guidance)> {
        let mut told = Vec::new();
        for worker in self.people.ids() {
            let person = &mut self.people[worker];
            (person.fresh, person.relocated) = (false, false);
            let Some(place) = self.whereabouts(worker, now) else {
                self.people[worker].message = None;
                continue;
            };
            let words = self.words(floor, worker, &place, now);
            let against = |words| floor.stands_against(worker, words).is_some();
            let before = self.people[worker].message;
            self.people[worker].message = Some(Message::next(before, words, against, now));
            let guidance = self.guidance(floor, worker, &place, now);
            let due = match &self.people[worker].told {
                Some((last, at)) => {
                    last.state != guidance.state || last.version != guidance.version || now - *at >= REPEAT
                }
                None => true,
            };
            if due {
                self.people[worker].told = Some((guidance.clone(), now));
                told.push((worker, guidance));
            }
        }
        told
    }

    /// The guidance of a worker now.
    pub(crate) fn guidance(
        &self,
        floor: Floor<'_>,
        worker: WorkerId,
        place: &Whereabouts,
        now: Time,
    ) -> Guidance {
        let person = &self.people[worker];
        let near = floor.near(place);
        let words = person.message.map(|message| message.words);
        let (state, reason) = words.unwrap_or_else(|| self.words(floor, worker, place, now));
        let plan = person.plan.as_ref().filter(|plan| plan.is_shown);
        let path: Vec<Point> = plan.map_or(Vec::new(), |p| p.follower.ahead().to_vec());
        let length = length_of(place.at, &path);
        Guidance {
            state,
            reason,
            version: person.version,
            next: path.first().copied(),
            eta: (!path.is_empty()).then(|| now + Span::from_secs_f64(length / place.mover.usual_mps())),
            path,
            wait: person.waits().map(|w| w.until).or_else(|| person.message.and_then(Message::waits_on)),
            assignment: plan.and_then(|p| p.assignment),
            arrived: plan.is_some_and(|p| p.assignment.is_some()) && person.there_since.is_some(),
            near,
        }
    }

    /// What a worker is to be told now, whatever was said a moment ago.
    fn words(&self, floor: Floor<'_>, worker: WorkerId, place: &Whereabouts, now: Time) -> Words {
        let person = &self.people[worker];
        let (state, reason) = self.state_of(floor, person, place, &floor.near(place));
        // The published procedures' words are passed on as published.
        let ours = floor.settings.policy == HumanAwarePolicy::Giveway;
        let words = match reason {
            None if floor.ledger.evacuation.is_some() => (state, Some(GuidanceReason::Evacuation)),
            None | Some(GuidanceReason::NoWay) => match self.is_asked(floor, worker, now) {
                // A worker who is to make room is not told to stand.
                Some(asked) if state == GuidanceState::Stop && ours => {
                    (GuidanceState::Redirected, Some(asked))
                }
                asked => (state, asked.or(reason)),
            },
            Some(_) => (state, reason),
        };
        let in_the_way = matches!(words.1, Some(GuidanceReason::RobotInTheWay(_)));
        let goes = |robot: &RobotId| in_the_way || person.message.is_some_and(|m| m.goes_before(*robot, now));
        match floor.stands_against(worker, words).filter(|robot| ours && goes(robot)) {
            Some(robot) => (GuidanceState::Redirected, Some(GuidanceReason::RobotWaits(robot))),
            None => words,
        }
    }

    fn state_of(
        &self,
        floor: Floor<'_>,
        person: &Person,
        place: &Whereabouts,
        near: &[NearRobot],
    ) -> (GuidanceState, Option<GuidanceReason>) {
        if place.presence == Presence::Lost {
            return (GuidanceState::Stop, Some(GuidanceReason::NotTracked));
        }
        if let Some(robot) = near.iter().map(|n| n.robot).find(|r| self.drives_up(floor, *r, place)) {
            return (GuidanceState::Stop, Some(GuidanceReason::RobotComes(robot)));
        }
        if let Some(lets_pass) = person.lets_pass {
            let robot = lets_pass.robot;
            return match lets_pass.stage {
                LetsPassStage::TouchesMarks => {
                    (GuidanceState::Stop, Some(GuidanceReason::PlaceUnsure(robot)))
                }
                LetsPassStage::Walks => (GuidanceState::Redirected, Some(GuidanceReason::RobotWaits(robot))),
                LetsPassStage::Stands => (GuidanceState::Stop, Some(GuidanceReason::RobotPasses(robot))),
                LetsPassStage::Waits => (GuidanceState::Stop, Some(GuidanceReason::RobotCrosses(robot))),
            };
        }
        match person.mode {
            WalkMode::Idle => (GuidanceState::Idle, person.by_closure),
            WalkMode::Following => (GuidanceState::Following, person.by_closure),
            WalkMode::Redirected => {
                let blocked = person.blocked_since.map(|(r, _)| GuidanceReason::RobotInTheWay(r));
                let reason = person.by_closure.or(blocked);
                (GuidanceState::Redirected, reason)
            }
            WalkMode::Deviating { since } if person.plan.as_ref().is_some_and(|p| p.made >= since) => {
                (GuidanceState::Redirected, Some(GuidanceReason::LeftPath))
            }
            WalkMode::Deviating { .. } => (GuidanceState::Deviating, Some(GuidanceReason::LeftPath)),
            WalkMode::Stopped { .. } => match person.blocked_since {
                Some((robot, _)) => (GuidanceState::Stop, Some(GuidanceReason::RobotInTheWay(robot))),
                None => (GuidanceState::Stop, Some(GuidanceReason::NoWay)),
            },
        }
    }

    /// Whether a robot within region 1 comes nearer: whatever the fleet does about it, the worker should stand.
    pub(crate) fn drives_up(&self, floor: Floor<'_>, robot: RobotId, place: &Whereabouts) -> bool {
        let Some(seen) = floor.scene.robot(robot).filter(|t| t.speed_mps > DRIVES_MPS) else { return false };
        let loaded = floor.ledger.rack_on(robot).is_some();
        let radius_m =
            floor.regions(robot).towards(place).stop_radius_at_m(seen.speed_mps, loaded, place.sigma_m);
        let to = place.at - seen.pose.at;
        let along = Vector::new(seen.pose.heading.cos(), seen.pose.heading.sin());
        to.norm() < radius_m && along.dot(&to) > 0.0
    }
}

impl Floor<'_> {
    fn near(&self, place: &Whereabouts) -> Vec<NearRobot> {
        let mut near: Vec<NearRobot> = (self.ledger.present())
            .filter_map(|robot| {
                let seen = self.scene.robot(robot)?;
                let to = seen.pose.at - place.at;
                let distance_m = to.norm();
                let heading = seen.pose.heading;
                let velocity = Vector::new(heading.cos(), heading.sin()) * seen.speed_mps;
                let closest = closest_approach(to, velocity - place.velocity);
                let (bearing, speed_mps) = (to.y.atan2(to.x), seen.speed_mps);
                (distance_m < NEAR_M).then_some(NearRobot { robot, distance_m, bearing, closest, speed_mps })
            })
            .collect();
        near.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.robot.cmp(&b.robot)));
        near.truncate(NEAR_MOST);
        near
    }
}

/// When two bodies that move evenly are nearest to one another; nothing if that is over.
fn closest_approach(apart: Vector, velocity: Vector) -> Option<Span> {
    let speed = velocity.norm_squared();
    let t = if speed < 1e-4 { 0.0 } else { -apart.dot(&velocity) / speed };
    (t > 0.0 && t < 60.0).then(|| Span::from_secs_f64(t))
}

fn length_of(from: Point, path: &[Point]) -> f64 {
    let mut at = from;
    path.iter().map(|p| (p - std::mem::replace(&mut at, *p)).norm()).sum()
}
