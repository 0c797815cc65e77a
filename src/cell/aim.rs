//! Whether a hand that moves towards the rack is heading for a wrong slot.
//!
//! Main function: [`aims_wrong`]. Refuses: to name a slot while the lit one is likely enough.

use super::eyes::LookedAt;
use super::face::{FacePlace, PickFace};
use super::share::LitShare;
use giveway_floor::warehouse::SlotName;

/// Cost of a false warning relative to a missed one: a warning is given when the odds of a wrong slot against the lit
/// one exceed it.
const COST: f64 = 60.0;
/// Uncertainty of where a hand will arrive: metres for a hand at the face that moves straight in, and the addition per
/// metre before the face and per metre of sideways motion still to come.
const NEAR_M: f64 = 0.05;
const PER_M: f64 = 0.06;
const PER_SIDE: f64 = 0.35;
/// Seconds for which the present sideways motion is extrapolated, and the longest extrapolation until the hand is at
/// the face. A wrong slot must be the likelier one by both: hands pass other slots on their way along the rack.
const ON_S: f64 = 0.08;
const ON_MOST_S: f64 = 0.25;
/// Slowest approach that is judged, metres per second, and farthest hand from the face that is judged, metres.
const MOVES_MPS: f64 = 0.15;
const FAR_M: f64 = 0.12;
/// Farthest hand from the face that is judged where the eyes are measured, metres.
const LOOKED_FAR_M: f64 = 0.25;

/// The likeliest slot for a hand, if the odds of all other slots together against the lit one are high enough for a
/// warning. `share` is the probability that the person goes to the lit slot before anything is seen of the hand; `at`
/// and `velocity` are the hand's, and `looked` is what the eyes rest on, where they are measured.
pub(super) fn aims_wrong(
    face: &PickFace,
    (lit, share): (SlotName, LitShare),
    (at, velocity): (FacePlace, FacePlace),
    looked: Option<LookedAt>,
) -> Option<SlotName> {
    let left_m = -face.depth_m(at);
    let far_m = if looked.is_some() { LOOKED_FAR_M } else { FAR_M };
    if -velocity.y < MOVES_MPS || left_m > far_m {
        return None;
    }
    let to_face_s = (left_m.max(0.0) / -velocity.y).min(ON_MOST_S);
    let by = |on_s: f64| {
        let aside_m = (velocity * on_s).xz().norm();
        let sigma_m = NEAR_M + PER_M * left_m.max(0.0) + PER_SIDE * aside_m;
        wrong_by(face, (lit, share.get()), (at + velocity * on_s, sigma_m), looked)
    };
    by(to_face_s).and(by(ON_S))
}

/// As `aims_wrong`, for a hand that would arrive in front of the slots at this place with this uncertainty.
fn wrong_by(
    face: &PickFace,
    (lit, share): (SlotName, f64),
    (lands, sigma_m): (FacePlace, f64),
    looked: Option<LookedAt>,
) -> Option<SlotName> {
    let likely = |front: FacePlace| {
        let off = (lands - front).xz().norm() / sigma_m;
        (-off * off / 2.0).exp() * looked.map_or(1.0, |looked| looked.ratio(front))
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
    let odds = others / count * (1.0 - share) / (of_lit * share);
    (odds > COST).then_some(best?.0)
}
