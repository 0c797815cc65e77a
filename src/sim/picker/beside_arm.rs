//! How a simulated person works beside a robot arm: when the person waits for it, and when the person steps back for
//! it.
//!
//! Main types: [`ArmSeen`], [`BesideArm`]. Refuses: to know what the arm is about to do; people see where it is and
//! whether it moves.

use super::person::SimPicker;
use giveway_cell::arm::{Capsule, least_distance_m};
use giveway_floor::time::{Span, Time};

/// How far ahead people look for an arm in the way of their hands, the distance they keep from it, metres, and how long
/// they wait until they reach past an arm that stands.
const LOOKS_AHEAD: [Span; 3] = [Span::from_millis(60), Span::from_millis(120), Span::from_millis(180)];
const GIVES_WAY_M: f64 = 0.08;
const PATIENCE: Span = Span::from_millis(1500);
/// Least time that a person waits, then how long a hand takes to stop and to return to full speed, seconds.
const HESITATES: Span = Span::from_millis(250);
const STOPS_S: f64 = 0.1;
const STARTS_S: f64 = 0.4;
/// A resting person this near to an arm keeps it from starting, metres; after this time the person steps back, for this
/// time.
const RESTS_IN_IT_M: f64 = 0.02;
const RESTS_IN_IT: Span = Span::from_secs(1);
const STEPS_BACK: Span = Span::from_secs(3);
/// A person with nothing to pick who sees an arm stand in the opening this near, metres, for this long makes room for
/// it until it is out, or has not moved for [`STEPS_BACK`].
const KEEPS_IT_M: f64 = 0.4;
const KEEPS_IT: Span = Span::from_secs(5);

/// What a person sees of an arm.
#[derive(Clone, Debug)]
pub struct ArmSeen {
    /// The arm's links.
    pub links: Vec<Capsule>,
    /// Whether the links move.
    pub moves: bool,
    /// Whether any link is in the opening or beyond.
    pub is_inside: bool,
}

/// A person beside an arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct BesideArm {
    /// How long the hands have waited for an arm in their way.
    waited: Span,
    /// How long the person has rested against an arm that stands.
    rests: Span,
    /// How long an arm has stood in the opening beside a person with nothing to pick.
    keeps: Span,
    /// Whether the person has stepped back to let the arm out.
    lets_out: bool,
    /// Until when the hands wait, and their current share of full speed.
    waits_until: Time,
    pace: f64,
}

impl BesideArm {
    /// A person and an arm that are not in each other's way.
    pub fn new(now: Time) -> BesideArm {
        let none = Span::ZERO;
        BesideArm { waited: none, rests: none, keeps: none, lets_out: false, waits_until: now, pace: 1.0 }
    }

    /// Whether the hands stop for an arm in their way that moves, or that has not yet stood there for too long.
    pub fn give_way(&mut self, picker: &mut SimPicker, now: Time, by: Span, arm: &ArmSeen) -> bool {
        let apart = |at: Time| least_distance_m(&picker.limbs_there(at), &arm.links);
        let here_m = apart(now);
        if picker.is_away() {
            if arm.moves && (here_m < 2.0 * GIVES_WAY_M || (self.lets_out && arm.is_inside)) {
                picker.step_back(now + HESITATES);
            }
            return false;
        }
        self.lets_out = false;
        let soon_m = LOOKS_AHEAD.map(|ahead| apart(now + ahead)).into_iter().fold(f64::INFINITY, f64::min);
        if self.is_to_step_back(picker, here_m, by, arm) {
            (self.rests, self.keeps, self.lets_out) = (Span::ZERO, Span::ZERO, true);
            picker.step_back(now + STEPS_BACK);
            return false;
        }
        let is_in_way = soon_m < GIVES_WAY_M && soon_m < here_m;
        if !is_in_way && soon_m > 2.0 * GIVES_WAY_M {
            self.waited = Span::ZERO;
        }
        if is_in_way && (arm.moves || self.waited < PATIENCE) {
            self.waits_until = now + HESITATES;
        }
        let stops = now < self.waits_until;
        let change = by.as_secs_f64() / if stops { -STOPS_S } else { STARTS_S };
        self.pace = (self.pace + change).clamp(0.0, 1.0);
        let lost = Span::from_secs_f64(by.as_secs_f64() * (1.0 - self.pace));
        if stops {
            self.waited += by;
        }
        if lost > Span::ZERO {
            picker.wait(now, lost);
        }
        stops
    }

    /// Whether a person with resting hands has kept the arm from going on for too long.
    fn is_to_step_back(&mut self, picker: &SimPicker, here_m: f64, by: Span, arm: &ArmSeen) -> bool {
        let is_idle = picker.is_idle();
        let rests_in_it = here_m < RESTS_IN_IT_M && !arm.moves && is_idle;
        self.rests = if rests_in_it { self.rests + by } else { Span::ZERO };
        if arm.moves || !arm.is_inside {
            self.keeps = Span::ZERO;
        } else if is_idle && here_m < KEEPS_IT_M {
            // A person who presses a button meanwhile still has nothing to pick.
            self.keeps += by;
        }
        self.rests >= RESTS_IN_IT || (is_idle && self.keeps >= KEEPS_IT)
    }
}
