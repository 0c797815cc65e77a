//! Whether a hand that moves towards the rack goes to a wrong slot.
//!
//! Main function: [`aims_wrong`]. Refuses: to name a slot while the lit one is likely enough.

use super::face::{FacePlace, PickFace};
use crate::warehouse::SlotName;

/// Who picks goes to the lit slot this often, before anything is seen of the hand.
const LIT: f64 = 0.985;
/// A warning that comes for nothing costs as much as this many that do not come: warned is above 1/(1 + it).
const COST: f64 = 1.0;
/// Where a hand meets the face is known this well at the face, metres, and so much less for each metre before it.
const NEAR_M: f64 = 0.035;
const PER_M: f64 = 0.42;
/// Hands bend their way: they go so far on in the present direction, as a share of the way to the face.
const STRAIGHT: f64 = 0.8;
/// Slower hands have no direction, metres per second; farther hands are not judged, metres.
const MOVES_MPS: f64 = 0.25;
const FAR_M: f64 = 0.45;

/// The slot that is the likeliest one where a hand goes, if the lit one is less likely than all others together.
pub fn aims_wrong(face: &PickFace, lit: SlotName, at: FacePlace, velocity: FacePlace) -> Option<SlotName> {
    let left_m = -face.depth_m(at);
    if -velocity.y < MOVES_MPS || left_m > FAR_M {
        return None;
    }
    let on_m = left_m.max(0.0) * STRAIGHT;
    let lands = at + velocity * (on_m / -velocity.y);
    let sigma_m = NEAR_M + PER_M * left_m.max(0.0);
    let weight = |slot: SlotName, front: FacePlace| {
        let off = (lands - front).xz().norm() / sigma_m;
        let prior = if slot == lit { LIT } else { (1.0 - LIT) / 19.0 };
        prior * (-off * off / 2.0).exp()
    };
    let (mut of_lit, mut others, mut best) = (0.0, 0.0, None);
    for (slot, front) in face.slots() {
        let w = weight(slot, front);
        if slot == lit {
            of_lit = w;
            continue;
        }
        others += w;
        if best.is_none_or(|(_, most)| w > most) {
            best = Some((slot, w));
        }
    }
    (others > COST * of_lit).then_some(best?.0)
}
