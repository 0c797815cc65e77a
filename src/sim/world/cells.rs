//! People at work cells beside the robots that stand there.
//!
//! Refuses: to tell the fleet of the guard: it stops robots whatever the fleet commands.

use super::World;
use super::motion_before::MotionBefore;
use crate::arm::SimArms;
use crate::picker::{Pickers, StandingRack};
use giveway_fleet::{Input, Ledger};
use giveway_floor::id::{RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use std::collections::BTreeMap;

/// A robot this near to where racks stand at a station is in the way of hands there, metres.
const AT_STATION_M: f64 = 0.9;
/// A robot that is not faster than this stands, metres per second.
const STANDS_MPS: f64 = 1e-6;

/// Longest step in which people and arms are advanced side by side.
const BESIDE: Span = Span::from_millis(10);

/// Advances people and arms at work cells to `to`, side by side.
fn beside_arms(
    pickers: &mut Pickers,
    arms: &mut SimArms,
    (from, to): (Time, Time),
    standing: &BTreeMap<StationId, StandingRack>,
    ledger: &Ledger,
) -> Vec<Input> {
    let (mut inputs, mut at) = (Vec::new(), from);
    while at < to {
        let next = (at + BESIDE).min(to);
        let waiting = pickers.give_way(at, next - at, |station| arms.seen(station));
        waiting.into_iter().for_each(|station| arms.note_waiting(station, next - at));
        inputs.extend(pickers.advance((at, next), standing, ledger));
        arms.advance(next - at, |station| pickers.limbs(station, next));
        at = next;
    }
    inputs.extend(arms.say((from, to), ledger, |station| standing.contains_key(&station)));
    arms.note_twice(ledger, |line| pickers.put(line));
    inputs
}

impl World {
    /// Advances people at work cells; gives what they report, and how devices see their hands.
    pub(super) fn pick_lines(&mut self, from: Time, to: Time, ledger: &Ledger) -> Vec<Input> {
        if self.pickers.is_none() {
            return Vec::new();
        }
        let standing = self.standing();
        let pickers = self.pickers.as_mut().expect("just seen");
        let inputs = match &mut self.arms {
            Some(arms) => beside_arms(pickers, arms, (from, to), &standing, ledger),
            None => pickers.advance((from, to), &standing, ledger),
        };
        let before = std::mem::take(&mut self.hands_inside);
        self.hands_inside = pickers.hands_inside(to).collect();
        self.hands_inside.extend(self.arms.iter().flat_map(SimArms::inside));
        for station in before.into_iter().filter(|s| self.hands_inside.contains(s)) {
            let moved = |r: &&super::SimRobot| r.before.has_moved(&r.body);
            let robot = self.robots.iter().filter(|r| self.is_at(r, station)).find(moved);
            self.moved_at_hands.extend(robot.map(|r| (r.body.id, station)));
        }
        inputs
    }

    /// The guard of each station stops robots there while a hand is inside.
    pub(super) fn guard_hands(&mut self, now: Time) {
        let Some(pickers) = &self.pickers else { return };
        let mut inside: Vec<StationId> = pickers.hands_inside(now).collect();
        inside.extend(self.arms.iter().flat_map(SimArms::inside));
        for i in 0..self.robots.len() {
            let robot = &self.robots[i];
            let is_guarded = inside.iter().any(|s| self.is_at(robot, *s));
            let robot = &mut self.robots[i];
            self.guard_stops += u64::from(is_guarded && !robot.body.hand_guard && robot.body.speed_mps > 0.0);
            (robot.body.hand_guard, robot.before) = (is_guarded, MotionBefore::of(&robot.body));
        }
    }

    fn is_at(&self, robot: &super::SimRobot, station: StationId) -> bool {
        let at = self.warehouse.nodes[self.warehouse.stations[station].node].at;
        !robot.off && (robot.body.pose.at - at).norm() < AT_STATION_M
    }

    /// How often a station's guard stopped a robot that moved.
    pub fn guard_stops(&self) -> u64 {
        self.guard_stops
    }

    /// The robots that truly stand at stations with racks.
    fn standing(&self) -> BTreeMap<StationId, StandingRack> {
        let stands = |r: &super::SimRobot| {
            let NodeKind::Station(station) = self.warehouse.nodes[r.body.node].kind else { return None };
            let is_there = !r.off && r.body.speed_mps <= STANDS_MPS && !r.body.is_astray();
            let is_at_node =
                r.body.stood_on == r.body.node && self.warehouse.stations[station].node == r.body.node;
            let rack = r.body.rack.filter(|_| is_there && is_at_node)?;
            Some((station, StandingRack { robot: r.body.id, rack }))
        };
        self.robots.iter().filter_map(stands).collect()
    }

    /// The robot arms, if any is switched on.
    pub fn arms(&self) -> Option<&SimArms> {
        self.arms.as_ref()
    }

    /// The pickers at work cells, if there are any.
    pub fn pickers(&self) -> Option<&Pickers> {
        self.pickers.as_ref()
    }

    /// Stations whose picker is away: for the laws.
    pub fn pickers_away(&self) -> impl Iterator<Item = StationId> {
        self.pickers.iter().flat_map(Pickers::away)
    }

    /// Robots held at a hand by a guard alone, which would move otherwise: for the laws.
    pub fn held_at_hands(&self) -> impl Iterator<Item = (RobotId, StationId)> {
        let at = |robot: &super::SimRobot| self.hands_inside.iter().copied().find(|s| self.is_at(robot, *s));
        let held = self.robots.iter().filter(|r| r.body.hand_guard && r.body.would_move());
        held.filter_map(move |r| Some((r.body.id, at(r)?)))
    }

    /// Robots that moved at a station while a hand was inside: for the laws.
    pub fn moved_at_hands(&self) -> &[(RobotId, StationId)] {
        &self.moved_at_hands
    }
}
