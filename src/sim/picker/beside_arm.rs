//! How a simulated person gets on with the robot arm beside them: who waits for it, and who steps back for it.
//!
//! Main types: [`ArmSeen`], [`BesideArm`]. Refuses: to know what the arm is about to do; people see where it is and
//! whether it moves.

use super::person::SimPicker;
use giveway_cell::arm::{Capsule, least_distance_m};
use giveway_floor::time::{Span, Time};

/// People look so far ahead whether an arm is in the way of their hands, keep so far from it, metres, and wait for so
/// long until they reach past an arm that stands.
const LOOKS_AHEAD: [Span; 3] = [Span::from_millis(60), Span::from_millis(120), Span::from_millis(180)];
const GIVES_WAY_M: f64 = 0.08;
const PATIENCE: Span = Span::from_millis(1500);
/// Who waits does so for at least this long. A hand takes so long to come to a stand, and so long until it is as fast
/// as before, seconds.
const HESITATES: Span = Span::from_millis(250);
const STOPS_S: f64 = 0.1;
const STARTS_S: f64 = 0.4;
/// Who rests so near to an arm that it may not start steps back after this time, for this time.
const RESTS_IN_IT_M: f64 = 0.02;
const RESTS_IN_IT: Span = Span::from_secs(1);
const STEPS_BACK: Span = Span::from_secs(3);
/// Who has nothing to pick, and sees an arm stand in the opening so near for so long, makes room for it until it is
/// out, or has not moved for [`STEPS_BACK`].
const KEEPS_IT_M: f64 = 0.4;
const KEEPS_IT: Span = Span::from_secs(5);

/// What a person sees of an arm.
#[derive(Clone, Debug)]
pub struct ArmSeen {
    /// Its links.
    pub links: Vec<Capsule>,
    /// Whether they move.
    pub moves: bool,
    /// Whether any of it is in the opening or beyond.
    pub is_inside: bool,
}

/// A person beside an arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct BesideArm {
    /// How long the hands have waited for an arm that is in their way.
    waited: Span,
    /// How long the person has rested in an arm that stands.
    rests: Span,
    /// How long an arm has stood in the opening beside a person with nothing to pick.
    keeps: Span,
    /// Whether the person has stepped back to let it out.
    lets_out: bool,
    /// Until when the hands wait, and the share of their speed that they have.
    waits_until: Time,
    pace: f64,
}

impl BesideArm {
    /// Neither is in the other's way.
    pub fn new(now: Time) -> BesideArm {
        let none = Span::ZERO;
        BesideArm { waited: none, rests: none, keeps: none, lets_out: false, waits_until: now, pace: 1.0 }
    }

    /// Whether the hands stop because an arm is in their way that moves, or has stood there for not too long.
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

    /// Whether a person whose hands rest keeps the arm from going on for too long.
    fn is_to_step_back(&mut self, picker: &SimPicker, here_m: f64, by: Span, arm: &ArmSeen) -> bool {
        let is_idle = picker.is_idle();
        let rests_in_it = here_m < RESTS_IN_IT_M && !arm.moves && is_idle;
        self.rests = if rests_in_it { self.rests + by } else { Span::ZERO };
        if arm.moves || !arm.is_inside {
            self.keeps = Span::ZERO;
        } else if is_idle && here_m < KEEPS_IT_M {
            // Who presses a button meanwhile has still nothing to pick.
            self.keeps += by;
        }
        self.rests >= RESTS_IN_IT || (is_idle && self.keeps >= KEEPS_IT)
    }
}
