//! Whether a hand that moves towards the rack goes to a wrong slot.
//!
//! Main function: [`aims_wrong`]. Refuses: to name a slot while the lit one is likely enough.

use super::eyes::LookedAt;
use super::face::{FacePlace, PickFace};
use super::share::LitShare;
use giveway_floor::warehouse::SlotName;

/// What a warning for nothing costs, relative to one that does not come: warned is where the odds of a wrong slot
/// against the lit one are above it.
const COST: f64 = 60.0;
/// Where a hand goes is known this well of one that is at the face and moves straight in, metres, and so much less for
/// each metre before the face and for each metre that it would still move sideways.
const NEAR_M: f64 = 0.05;
const PER_M: f64 = 0.06;
const PER_SIDE: f64 = 0.35;
/// It goes on sideways for so long as it does now, seconds, or until it is at the face, but not longer than this. A
/// wrong slot must be the likelier one by both: hands pass other slots on their way along the rack.
const ON_S: f64 = 0.08;
const ON_MOST_S: f64 = 0.25;
/// Hands that do not come nearer are not judged, metres per second, and neither are those farther than this, metres.
const MOVES_MPS: f64 = 0.15;
const FAR_M: f64 = 0.12;
/// … or than this, where the eyes are measured.
const LOOKED_FAR_M: f64 = 0.25;

/// The slot that is the likeliest one where a hand goes, if the odds of all others together against the lit one are
/// high enough for a warning. The person goes to the lit slot with the probability `share`, before anything is seen of
/// the hand; the hand is here and moves so, and the eyes, where they are measured, rest on something.
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

/// The same, where a hand would be in front of a slot at this place.
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
