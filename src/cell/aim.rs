//! Whether a hand that moves towards the rack goes to a wrong slot.
//!
//! Main function: [`aims_wrong`]. Refuses: to name a slot while the lit one is likely enough.

use super::face::{FacePlace, PickFace};
use crate::warehouse::SlotName;

/// Who picks goes to the lit slot this often, before anything is seen of the hand.
const LIT: f64 = 0.985;
/// What a warning for nothing costs, relative to one that does not come: warned is where the odds of a wrong slot
/// against the lit one are above it.
const COST: f64 = 60.0;
/// Where a hand is in front of its slot is known this well at the face, metres, and so much less for each metre
/// before it.
const NEAR_M: f64 = 0.045;
const PER_M: f64 = 0.3;
/// It goes on sideways for so long as it does now, seconds.
const ON_S: f64 = 0.08;
/// Hands that do not come nearer are not judged, metres per second, and neither are those farther than this, metres.
const MOVES_MPS: f64 = 0.15;
const FAR_M: f64 = 0.18;

/// The slot that is the likeliest one where a hand goes, if the odds of all others together against the lit one are
/// high enough for a warning.
pub fn aims_wrong(face: &PickFace, lit: SlotName, at: FacePlace, velocity: FacePlace) -> Option<SlotName> {
    let left_m = -face.depth_m(at);
    if -velocity.y < MOVES_MPS || left_m > FAR_M {
        return None;
    }
    let lands = at + velocity * ON_S;
    let sigma_m = NEAR_M + PER_M * left_m.max(0.0);
    let likely = |front: FacePlace| {
        let off = (lands - front).xz().norm() / sigma_m;
        (-off * off / 2.0).exp()
    };
    let (mut of_lit, mut others, mut count, mut best) = (0.0, 0.0, 0.0, None);
    for (slot, front) in face.slots() {
        let w = likely(front);
        if slot == lit {
            of_lit = w;
            continue;
        }
        (others, count) = (others + w, count + 1.0);
        if best.is_none_or(|(_, most)| w > most) {
            best = Some((slot, w));
        }
    }
    let odds = others / count * (1.0 - LIT) / (of_lit * LIT);
    (odds > COST).then_some(best?.0)
}
