//! Robots that go round people instead of waiting for them: on lanes with a corridor, if their kind may leave the line.
//!
//! Three choices are compared by when the robot reaches its next stop: it waits until the people have left, as far as
//! the regions around them tell; it takes another route; it passes them within the corridor, slowly and with a detour.
//! Passing is possible only if one side of every person has room for the robot and the safe distance, the corridor goes
//! on until behind them, and no other robot comes first there. All of it is granted at once. While there is no room the
//! robot stands where it is. Refuses: to steer the robot, and to be a safety function.

use super::state::Yielding;
use crate::people::foreseen::ForeseenPerson;
use crate::people::state::HumanState;
use crate::state::binding::STOPPING;
use crate::state::displaced::OFF_ROUTE_M;
use crate::state::floor::Floor;
use crate::state::kind::ObeyedLimits;
use crate::state::passing::{HeldChoice, Passing, PassingStretch, RobotPassing, cheapest};
use crate::state::writer::Writer;
use giveway_floor::geometry::Point;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::route::{Cause, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::aware::{HumanAwarePolicy, SLOW_MPS};
use giveway_people::human::{Mover, Whereabouts};
use giveway_people::local::{LineSide, NearPerson, PassingRoom};

/// A side is free if the probability that a person is in the way there is at most this.
const DOUBT: f64 = 0.25;
/// For a robot that has begun to pass, a side stays free up to this probability.
const DOUBT_ON: f64 = 0.5;
/// A robot farther off the line than this is on one side of it, metres.
const ASIDE_M: f64 = 0.3;
/// People farther from the corridor than this do not count for passing, metres.
const FAR_M: f64 = 8.0;
/// The longest stretch for passing, metres.
const LONGEST_M: f64 = 30.0;
/// How often a robot that stands between two nodes is looked at.
const AGAIN: Span = Span::from_secs(1);
/// How long a robot beside the line stands without room.
const PATIENCE: Span = Span::from_secs(8);
/// Room to come back to the line behind the keep-out zone of the last person, metres.
const BACK_M: f64 = 1.0;
/// A worker who is done has left the way after this.
const LEAVES: Span = Span::from_secs(3);
/// How much longer than driving it takes to start aside and to come to rest on the line again, seconds.
const SWINGS_S: f64 = 2.0;

/// The prospect of passing people.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prospect {
    what: Passing,
    /// When the robot would reach its next stop.
    pub arrives: Time,
    /// Whether the robot stands where passing begins.
    is_there: bool,
}

impl Yielding {
    /// The prospect of a robot passing the people who hold it up; nothing if it cannot.
    pub(super) fn prospect(
        &self,
        floor: Floor<'_>,
        people: &HumanState,
        (robot, worker): (RobotId, WorkerId),
        now: Time,
    ) -> Option<Prospect> {
        // A robot that stands where others are slow does not get past.
        let is_able = floor.kind(robot).free_navigation && floor.obeyed_limits(robot) == ObeyedLimits::Speeds;
        let may_leave = is_able && self.state.of(robot).passing.is_none();
        if !may_leave || floor.settings.policy != HumanAwarePolicy::Giveway {
            return None;
        }
        let seen = floor.scene.fit(robot, now)?;
        let chain = floor.ledger.chain(robot);
        let is_there = seen.stands() && seen.reached == chain.first();
        let from = if is_there { chain.first() } else { chain.granted() - 1 };
        let (to, stretch, near) = floor.passes_until(people, robot, from, now)?;
        let limits = floor.passing_limits(robot);
        let room = PassingRoom::new(floor.footprint(robot), limits, stretch.line, stretch.corridor);
        let from_m = if is_there { room.along_m(seen.pose.at) } else { 0.0 };
        if is_there && room.across_m(LineSide::Left, seen.pose.at).abs() > OFF_ROUTE_M {
            return None;
        }
        if near.iter().any(|p| !p.is_seen) {
            return None;
        }
        let near: Vec<NearPerson<'_>> = near.iter().map(|p| p.near()).collect();
        let side = room.side(from_m, &near, DOUBT)?;
        let detour_m = room.detour_m(side, from_m, &near);
        let takes = floor.passing_takes(robot, room.along_m(stretch.line.b) - from_m, detour_m);
        let begins = if is_there { now } else { chain.get(from)?.arrive.max(now) };
        let late = (begins + takes - chain.get(to)?.arrive).max(Span::ZERO);
        let stop = floor.ledger.robots[robot].stops.first()?;
        // If it is known when the worker is done, waiting until then may be better than it seems.
        let leaves = people.done_at(worker, now).map(|t| t - now + LEAVES);
        if leaves.is_some_and(|waits| waits <= late) {
            return None;
        }
        let arrives = chain.get(stop.serial)?.arrive + late;
        Some(Prospect { what: Passing { worker, from, to, since: now }, arrives, is_there })
    }

    /// Lets the robot pass if it stands where passing begins; otherwise it drives there first.
    pub(super) fn pass(&mut self, writer: &mut Writer, robot: RobotId, prospect: Prospect) {
        if prospect.is_there {
            let Passing { from, to, .. } = prospect.what;
            assert!(from < to, "{robot:?} passes somebody on its way from {from} to {to}");
            assert!(self.state.of(robot).passing.is_none(), "{robot:?} begins to pass while it passes");
            let passing = RobotPassing { what: prospect.what, stands_since: None };
            self.state.of_mut(robot).passing = Some(passing);
            writer.scene.set_passing(robot, true);
        }
    }

    /// Lets a robot in a person's way pass that person, if it can and that is better than waiting. Returns whether it
    /// does.
    pub(super) fn pass_instead(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        (robot, worker): (RobotId, WorkerId),
        now: Time,
    ) -> bool {
        let Some(prospect) = self.prospect(writer.floor(), people, (robot, worker), now) else {
            return false;
        };
        let until = writer.floor().region_ends(robot, prospect.what, now);
        let Some(planned) = writer.floor().planned_stop(robot) else { return false };
        let waits = planned + (until - now).max(self.state.of(robot).waited(now));
        let passes = cheapest(waits, None, Some(prospect.arrives)) == HeldChoice::Pass;
        if passes {
            self.pass(writer, robot, prospect);
        }
        passes
    }

    /// Lets a robot that stands for people between two nodes go on past them, or wait: there is no other route from
    /// there.
    pub(super) fn pass_from_between(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        robot: RobotId,
        now: Time,
    ) {
        let floor = writer.floor();
        let chain = floor.ledger.chain(robot);
        let noted = self.state.of(robot);
        let looked = noted.passing_looked.is_some_and(|t| now - t < AGAIN);
        let Some(standing) = noted.stands else { return };
        if looked || !floor.kind(robot).free_navigation || chain.first() + 1 == chain.granted() {
            return;
        }
        self.state.of_mut(robot).passing_looked = Some(now);
        let Some(prospect) = self.prospect(writer.floor(), people, (robot, standing.worker), now) else {
            return;
        };
        let until = writer.floor().region_ends(robot, prospect.what, now);
        let Some(planned) = writer.floor().planned_stop(robot) else { return };
        let waits = planned + (until - now).max(now - standing.since);
        if cheapest(waits, None, Some(prospect.arrives)) == HeldChoice::Pass {
            self.pass(writer, robot, prospect);
        }
    }

    /// Updates whether robots that pass people still have room; robots past all people are on the line again.
    pub(crate) fn follow_passing(&mut self, writer: &mut Writer, people: &HumanState, now: Time) {
        let passing: Vec<(RobotId, RobotPassing)> = self.state.passing().collect();
        for (robot, mut passing) in passing {
            let chain = writer.ledger().chain(robot);
            if chain.first() >= passing.what.to || chain.granted() <= passing.what.to {
                self.state.of_mut(robot).passing = None;
                writer.scene.set_passing(robot, false);
                continue;
            }
            let has_room = has_room(writer.floor(), people, (robot, passing), now);
            passing.stands_since = if has_room { None } else { passing.stands_since.or(Some(now)) };
            self.state.of_mut(robot).passing = Some(passing);
        }
    }
}

impl RobotPassing {
    /// Whether the robot drives. After a while without room its own planner decides: a person who stands there may
    /// leave room that the forecast does not see.
    fn goes(&self, now: Time) -> bool {
        self.stands_since.is_none_or(|t| now - t > PATIENCE)
    }

    /// The robot's speed limit near these people, metres per second, and the worker for whom it stands.
    pub(super) fn limit(
        &self,
        floor: Floor<'_>,
        robot: RobotId,
        present: &[(WorkerId, Whereabouts)],
        now: Time,
    ) -> (Option<f64>, Option<WorkerId>) {
        if !self.goes(now) {
            return (Some(0.0), Some(self.what.worker));
        }
        let (at, loaded) = (floor.place_of(robot), floor.ledger.rack_on(robot).is_some());
        assert!(floor.kind(robot).free_navigation, "{robot:?} leaves its line and cannot");
        let limits = present.iter().filter_map(|(_, w)| {
            let distance_m = (at - w.at).norm() - w.reach_m;
            floor.regions(robot).towards(w).limit_mps(distance_m, loaded, w.sigma_m)
        });
        (limits.reduce(f64::min), None)
    }
}

/// Whether there is room ahead of a robot that passes people, on the side on which the robot is if it is on one.
fn has_room(
    floor: Floor<'_>,
    people: &HumanState,
    (robot, passing): (RobotId, RobotPassing),
    now: Time,
) -> bool {
    let from = floor.ledger.chain(robot).first();
    let Some(stretch) = floor.stretch(robot, from, passing.what.to) else { return false };
    let limits = floor.passing_limits(robot);
    let room = PassingRoom::new(floor.footprint(robot), limits, stretch.line, stretch.corridor);
    let near = people.foreseen(floor, middle(stretch), reach_m(stretch), now);
    if near.iter().any(|p| p.mover != Mover::OnFoot) {
        return false;
    }
    let near: Vec<NearPerson<'_>> = near.iter().map(|p| p.near()).collect();
    let at = floor.place_of(robot);
    let (from_m, left_m) = (room.along_m(at), room.across_m(LineSide::Left, at));
    let doubt = if passing.stands_since.is_none() { DOUBT_ON } else { DOUBT };
    let is_free = |side| room.is_free(side, from_m, &near, doubt);
    match left_m {
        m if m > ASIDE_M => is_free(LineSide::Left),
        m if m < -ASIDE_M => is_free(LineSide::Right),
        _ => is_free(LineSide::Left) || is_free(LineSide::Right),
    }
}

fn middle(stretch: PassingStretch) -> Point {
    stretch.line.point(0.5)
}

fn reach_m(stretch: PassingStretch) -> f64 {
    stretch.line.length() / 2.0 + stretch.corridor.widest_m() + FAR_M
}

impl Floor<'_> {
    /// The visit at which a robot that leaves the line at `from` would be on it again: the first one behind all people
    /// who hold it up, with room to come back to the line, if the corridor leads there and nothing else keeps the robot
    /// from it. Also the people nearby.
    fn passes_until(
        self,
        people: &HumanState,
        robot: RobotId,
        from: u64,
        now: Time,
    ) -> Option<(u64, PassingStretch, Vec<ForeseenPerson>)> {
        let chain = self.ledger.chain(robot);
        let stop = self.ledger.robots[robot].stops.first()?.serial;
        let soon = Window::new(now, now + STOPPING);
        let binds = |serial: u64, by_people: bool| {
            let node = chain.get(serial).map(|v| v.node);
            node.is_some_and(|n| {
                self.conditions(robot).of(n).iter().any(|c| {
                    let hard = matches!(c.effect, Effect::Closed | Effect::NoEntryOrExit);
                    hard && c.window.overlaps(soon) && matches!(c.cause, Cause::Worker(_)) == by_people
                })
            })
        };
        for to in from + 1..=stop {
            let stretch = self.stretch(robot, from, to)?;
            let is_granted = to < chain.granted();
            let turn = || self.ledger.timeline().waits_for(robot, to);
            if stretch.line.length() > LONGEST_M || !is_granted && (turn().is_some() || binds(to, false)) {
                return None;
            }
            if !binds(to, true) {
                let near = people.foreseen(self, middle(stretch), reach_m(stretch), now);
                // The local planner knows people on foot alone.
                if near.iter().any(|p| p.mover != Mover::OnFoot) {
                    return None;
                }
                let apart_m = self.regions(robot).keep_out_radius_m(false, 0.0) + BACK_M;
                if near.iter().all(|p| (p.at - stretch.line.b).norm() >= apart_m) {
                    return Some((to, stretch, near));
                }
            }
        }
        None
    }

    /// How long passing takes: slowly within a person's keep-out zone, both before and behind, and aside.
    fn passing_takes(&self, robot: RobotId, length_m: f64, detour_m: f64) -> Span {
        let loaded = self.ledger.rack_on(robot).is_some();
        let near_m = length_m.min(2.0 * self.regions(robot).keep_out_radius_m(loaded, 0.0));
        let top_mps = self.kinematics(robot).top_mps(loaded);
        let slow_mps = SLOW_MPS.min(top_mps);
        let seconds = (near_m + detour_m) / slow_mps + (length_m - near_m) / top_mps + SWINGS_S;
        Span::from_secs_f64(seconds)
    }

    /// When a robot reaches its next stop, as planned.
    fn planned_stop(&self, robot: RobotId) -> Option<Time> {
        let stop = self.ledger.robots[robot].stops.first()?;
        self.ledger.chain(robot).get(stop.serial).map(|v| v.arrive)
    }

    /// Until when people are expected to hold a robot up between two visits.
    fn region_ends(&self, robot: RobotId, what: Passing, now: Time) -> Time {
        let chain = self.ledger.chain(robot);
        let nodes = (what.from..=what.to).filter_map(|s| chain.get(s)).map(|v| v.node);
        let hard = nodes.flat_map(|n| self.conditions(robot).of(n)).filter(|c| {
            matches!(c.effect, Effect::Closed | Effect::NoEntryOrExit) && matches!(c.cause, Cause::Worker(_))
        });
        hard.map(|c| c.window.end()).fold(now, Time::max)
    }
}
