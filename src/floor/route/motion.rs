//! How long robots take: kinematics, and tables of durations per arc.
//!
//! Main types: [`Rules`] (what a move is), [`Kinematics`] (a real robot's figures), [`Pace`] (durations of every arc
//! and turn of one warehouse). Refuses: to know where any robot is.
//!
//! Speeds are planned in two states, standing and rolling. A run of several lanes is driven as: speed up, cruise,
//! brake. With speed `v` and acceleration `a` a run of length `L ≥ v²/a` takes `L/v + v/a`: the sum of its lanes at
//! cruise plus `v/2a` for the start and `v/2a` for the stop. A single lane shorter than `v²/a` from rest to rest takes
//! `2·√(L/a)`. Short runs of several lanes are thereby planned up to 0.4 s too slow, never too fast.

use crate::geometry::turn_between;
use crate::id::{ArcId, Dense, IdVec, NodeId};
use crate::time::Span;
use crate::warehouse::Warehouse;

/// Headings closer than this count as straight on, radians.
const STRAIGHT: f64 = 0.1;

/// A robot's figures. Defaults: safety.md 1.5 (RAWSim-O's robots with a loaded acceleration of 0.5 m/s²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// Top speed without a rack, metres per second.
    pub speed_mps: f64,
    /// Top speed with a rack, metres per second.
    pub speed_loaded_mps: f64,
    /// Acceleration and braking without a rack, metres per second squared.
    pub accel_unloaded_mps2: f64,
    /// Acceleration and braking with a rack, metres per second squared.
    pub accel_loaded_mps2: f64,
    /// Speed of turning in place, radians per second.
    pub turn_radps: f64,
    /// Time to lift a rack, or to set it down.
    pub lift: Span,
    /// How long a hold outlasts the moment in which the robot stands on the next node.
    pub clearance: Span,
    /// Delay from sending a grant until the robot acts on it.
    pub reaction: Span,
}

impl Default for Kinematics {
    fn default() -> Self {
        Kinematics {
            speed_mps: 1.5,
            speed_loaded_mps: 1.5,
            accel_unloaded_mps2: 1.0,
            accel_loaded_mps2: 0.5,
            turn_radps: std::f64::consts::TAU / 2.5,
            lift: Span::from_millis(2200),
            clearance: Span::from_millis(100),
            reaction: Span::from_millis(100),
        }
    }
}

impl Kinematics {
    /// Top speed, metres per second.
    pub fn top_mps(&self, loaded: bool) -> f64 {
        if loaded { self.speed_loaded_mps } else { self.speed_mps }
    }

    /// Acceleration and braking, metres per second squared.
    pub fn accel_mps2(&self, loaded: bool) -> f64 {
        if loaded { self.accel_loaded_mps2 } else { self.accel_unloaded_mps2 }
    }

    /// Distance in which a robot at speed `v` (metres per second) comes to rest, metres.
    pub fn braking_m(&self, v: f64, loaded: bool) -> f64 {
        v * v / (2.0 * self.accel_mps2(loaded))
    }
}

/// The model of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rules {
    /// Robots with inertia: a robot holds two nodes while it drives between them.
    Drive(Kinematics),
    /// One lane a step, hand-over in an instant, no exchange of places: pebble motion on graphs.
    Pebble {
        /// The length of a step.
        step: Span,
        /// Whether a quarter turn takes a step, too.
        turns: bool,
    },
}

/// Durations of every arc and turn of one warehouse under one set of rules.
#[derive(Clone, Debug)]
pub struct Pace {
    rules: Rules,
    /// For each arc its index in `drive`: floors have few different lanes, so the durations stay in the cache.
    class: IdVec<ArcId, u16>,
    drive: Vec<[Span; 8]>,
    turn_start: Vec<u32>,
    turns: Vec<Span>,
    straight: Vec<bool>,
    rolls_on: Vec<bool>,
    fastest_in: IdVec<NodeId, [Span; 2]>,
    fastest_out: IdVec<NodeId, [Span; 2]>,
}

/// Whether a robot stands or rolls when its centre passes a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MotionState {
    /// At rest: it may wait, turn, lift.
    Standing,
    /// At cruising speed: it goes straight on at once.
    Rolling,
}

impl Pace {
    /// Computes all durations. Arcs are few (tens of thousands at most), so this takes milliseconds.
    pub fn new(warehouse: &Warehouse, rules: Rules) -> Pace {
        let mut pace = Pace {
            rules,
            class: IdVec::new(),
            drive: Vec::new(),
            turn_start: vec![0],
            turns: Vec::new(),
            straight: Vec::new(),
            rolls_on: Vec::new(),
            fastest_in: IdVec::filled([Span::ZERO; 2], warehouse.nodes.len()),
            fastest_out: IdVec::filled([Span::ZERO; 2], warehouse.nodes.len()),
        };
        for arc in warehouse.arcs.iter() {
            let mut spans = [Span::ZERO; 8];
            for (i, span) in spans.iter_mut().enumerate() {
                let (loaded, from, to) = (i & 4 != 0, motion(i & 2 != 0), motion(i & 1 != 0));
                *span = drive_span(&rules, arc.length_m, arc.speed_limit_mps, loaded, from, to);
            }
            let class = pace.drive.iter().position(|d| *d == spans).unwrap_or(pace.drive.len());
            if class == pace.drive.len() {
                pace.drive.push(spans);
            }
            pace.class.push(u16::try_from(class).expect("a floor has fewer than 65536 different lanes"));
            for &heading in warehouse.headings(arc.from) {
                pace.turns.push(turn_span(&rules, heading, arc.heading));
                pace.straight.push(turn_between(heading, arc.heading) < STRAIGHT);
            }
            pace.turn_start.push(pace.turns.len() as u32);
            let goes_on = |a: &crate::warehouse::Arc| turn_between(arc.heading, a.heading) < STRAIGHT;
            pace.rolls_on.push(pace.can_roll() && warehouse.out(arc.to).any(|(_, a)| goes_on(a)));
        }
        if pace.holds_while_driving() {
            pace.note_fastest(warehouse);
        }
        pace
    }

    /// Fills `fastest_in` and `fastest_out`.
    fn note_fastest(&mut self, warehouse: &Warehouse) {
        use MotionState::{Rolling, Standing};
        self.fastest_in.iter_mut().for_each(|s| *s = [Span::MAX; 2]);
        self.fastest_out.iter_mut().for_each(|s| *s = [Span::MAX; 2]);
        for (id, arc) in warehouse.arcs.pairs() {
            for loaded in [false, true] {
                let rolls = self.lead(loaded) + self.drive(id, loaded, Rolling, Standing);
                let way_in = rolls.min(self.drive(id, loaded, Standing, Standing));
                let out =
                    self.drive(id, loaded, Standing, Rolling).min(self.drive(id, loaded, Standing, Standing));
                let best_in = &mut self.fastest_in[arc.to][usize::from(loaded)];
                *best_in = way_in.min(*best_in);
                let best_out = &mut self.fastest_out[arc.from][usize::from(loaded)];
                *best_out = out.min(*best_out);
            }
        }
    }

    /// Time from the end of one robot's hold on a node to the earliest stop of the next robot there.
    pub fn fastest_in(&self, node: NodeId, loaded: bool) -> Span {
        self.fastest_in[node][usize::from(loaded)]
    }

    /// Time from the earliest departure to the earliest arrival at any next node.
    pub fn fastest_out(&self, node: NodeId, loaded: bool) -> Span {
        self.fastest_out[node][usize::from(loaded)]
    }

    /// The rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Whether robots may roll through nodes at all.
    pub fn can_roll(&self) -> bool {
        matches!(self.rules, Rules::Drive(_))
    }

    /// Whether a robot holds the next node from the moment it departs (else from the moment it arrives).
    pub fn holds_while_driving(&self) -> bool {
        matches!(self.rules, Rules::Drive(_))
    }

    /// Duration of an arc from node centre to node centre.
    pub fn drive(&self, arc: ArcId, loaded: bool, from: MotionState, to: MotionState) -> Span {
        let i = usize::from(loaded) << 2 | usize::from(from == MotionState::Rolling) << 1;
        self.drive[usize::from(self.class[arc])][i | usize::from(to == MotionState::Rolling)]
    }

    /// Duration of turning in place from arrival heading `slot` of the arc's start to the arc.
    pub fn turn(&self, arc: ArcId, slot: u8) -> Span {
        self.turns[self.turn_start[arc.ix()] as usize + usize::from(slot)]
    }

    /// Whether the arc continues arrival heading `slot` of its start without a turn.
    pub fn is_straight(&self, arc: ArcId, slot: u8) -> bool {
        self.straight[self.turn_start[arc.ix()] as usize + usize::from(slot)]
    }

    /// Whether a robot can roll through the arc's end: some arc continues it without a turn.
    pub fn rolls_on(&self, arc: ArcId) -> bool {
        self.rolls_on[arc.ix()]
    }

    /// Duration of turning in place between any two headings.
    pub fn turn_between(&self, from: f64, to: f64) -> Span {
        turn_span(&self.rules, from, to)
    }

    /// How long before leaving a node a rolling robot must be sure of the next one, since it could no longer stop: the
    /// time of its braking distance at cruising speed, plus its reaction.
    pub fn lead(&self, loaded: bool) -> Span {
        match self.rules {
            Rules::Drive(k) => {
                Span::from_secs_f64(k.top_mps(loaded) / (2.0 * k.accel_mps2(loaded))) + k.reaction
            }
            Rules::Pebble { .. } => Span::ZERO,
        }
    }

    /// The largest extra time for starting from rest, compared with rolling on.
    pub fn start_cost(&self, loaded: bool) -> Span {
        match self.rules {
            Rules::Drive(k) => {
                Span::from_secs_f64(k.top_mps(loaded) / (2.0 * k.accel_mps2(loaded))) + Span(1)
            }
            Rules::Pebble { .. } => Span::ZERO,
        }
    }

    /// How long a hold outlasts the arrival at the next node.
    pub fn clearance(&self) -> Span {
        match self.rules {
            Rules::Drive(k) => k.clearance,
            Rules::Pebble { .. } => Span::ZERO,
        }
    }
}

fn motion(rolling: bool) -> MotionState {
    if rolling { MotionState::Rolling } else { MotionState::Standing }
}

/// Duration from node centre to node centre over a lane with a speed limit.
pub(super) fn drive_span(
    rules: &Rules,
    length: f64,
    limit: f64,
    loaded: bool,
    from: MotionState,
    to: MotionState,
) -> Span {
    match rules {
        Rules::Pebble { step, .. } => *step,
        Rules::Drive(k) => {
            let (v, a) = (k.top_mps(loaded).min(limit), k.accel_mps2(loaded));
            let ramps =
                f64::from(u8::from(from == MotionState::Standing) + u8::from(to == MotionState::Standing));
            let seconds = if ramps == 2.0 && length < v * v / a {
                2.0 * (length / a).sqrt()
            } else {
                length / v + ramps * v / (2.0 * a)
            };
            Span::from_secs_f64(seconds)
        }
    }
}

fn turn_span(rules: &Rules, from: f64, to: f64) -> Span {
    let angle = turn_between(from, to);
    match rules {
        Rules::Pebble { turns: false, .. } => Span::ZERO,
        Rules::Pebble { step, turns: true } => *step * (angle / std::f64::consts::FRAC_PI_2).round() as i64,
        Rules::Drive(_) if angle < STRAIGHT => Span::ZERO,
        Rules::Drive(k) => Span::from_secs_f64(angle / k.turn_radps),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(length: f64, loaded: bool, from: MotionState, to: MotionState) -> f64 {
        let rules = Rules::Drive(Kinematics::default());
        drive_span(&rules, length, f64::INFINITY, loaded, from, to).as_secs_f64()
    }

    #[test]
    fn a_long_run_takes_its_cruise_plus_one_ramp() {
        use MotionState::*;
        let lanes = 10;
        let run = span(1.0, false, Standing, Rolling)
            + (lanes - 2) as f64 * span(1.0, false, Rolling, Rolling)
            + span(1.0, false, Rolling, Standing);
        assert!((run - (10.0 / 1.5 + 1.5)).abs() < 1e-4, "{run}");
    }

    #[test]
    fn one_short_lane_is_a_triangle_of_speed() {
        assert!(
            (span(1.0, true, MotionState::Standing, MotionState::Standing) - 2.0 * 2f64.sqrt()).abs() < 1e-5
        );
    }

    #[test]
    fn a_robot_with_a_rack_may_be_slower() {
        let k = Kinematics { speed_loaded_mps: 0.5, ..Kinematics::default() };
        let cruise = |loaded| {
            let rolling = (MotionState::Rolling, MotionState::Rolling);
            drive_span(&Rules::Drive(k), 3.0, f64::INFINITY, loaded, rolling.0, rolling.1)
        };
        assert_eq!((cruise(false), cruise(true)), (Span::from_secs(2), Span::from_secs(6)));
    }

    #[test]
    fn a_quarter_turn_is_a_quarter_of_a_full_one() {
        let quarter = turn_span(&Rules::Drive(Kinematics::default()), 0.0, std::f64::consts::FRAC_PI_2);
        assert_eq!(quarter, Span::from_millis(625));
    }
}
