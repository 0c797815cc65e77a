//! Where a simulated picker's limbs truly are: arms by head and hands, trunk and head.
//!
//! Main function: [`limbs`]. Lengths are shares of the body height (Winter, Biomechanics and Motor Control of Human
//! Movement). Refuses: to match what the fleet believes; elbows hang differently from what it assumes.

use giveway_cell::arm::Capsule;
use giveway_cell::{FacePlace, PickFace};

/// Half the width of the shoulders, and how far they are below the middle of the head, shares of the height.
const HALF_WIDTH: f64 = 0.115;
const DROP: f64 = 0.125;
/// Upper and lower arm, shares of the height.
const UPPER: f64 = 0.186;
const LOWER: f64 = 0.146;
/// From the finger tips to the wrist, metres.
const HAND_M: f64 = 0.17;
/// Radii, metres.
const UPPER_M: f64 = 0.05;
const LOWER_M: f64 = 0.042;
const FINGERS_M: f64 = 0.04;
const HEAD_M: f64 = 0.11;
const TRUNK_M: f64 = 0.16;
/// How far the elbow is lifted sideways, radians.
const SWIVEL: f64 = 0.55;

/// Upper arm, lower arm and hand of both sides, head and trunk; map frame.
pub fn limbs(face: &PickFace, height_m: f64, head: FacePlace, grips: [FacePlace; 2]) -> Vec<Capsule> {
    let capsule =
        |a: FacePlace, b: FacePlace, radius_m| Capsule { a: face.on_map(a), b: face.on_map(b), radius_m };
    let mut all = Vec::with_capacity(8);
    let neck = head - FacePlace::new(0.0, 0.0, DROP * height_m);
    for (side, grip) in [-1.0, 1.0].into_iter().zip(grips) {
        let mut shoulder = neck + FacePlace::new(side * HALF_WIDTH * height_m, 0.02, 0.0);
        let back = (shoulder - grip).try_normalize(1e-6).unwrap_or_else(FacePlace::z);
        let wrist = grip + back * HAND_M;
        let (upper, lower) = (UPPER * height_m, LOWER * height_m);
        let lacks_m = (wrist - shoulder).norm() - 0.99 * (upper + lower);
        // If the hand is farther than the arm is long, the shoulder moves along with it.
        shoulder -= back * lacks_m.max(0.0);
        let way = wrist - shoulder;
        let far = way.norm().max((upper - lower).abs() + 0.02);
        let ahead = way.try_normalize(1e-6).unwrap_or_else(|| -FacePlace::z());
        let along = (upper * upper - lower * lower + far * far) / (2.0 * far);
        let aside = (upper * upper - along * along).max(0.0).sqrt();
        let down = FacePlace::new(side * libm::sin(SWIVEL), 0.1, -libm::cos(SWIVEL));
        let down = (down - ahead * down.dot(&ahead)).try_normalize(1e-6).unwrap_or_else(FacePlace::y);
        let elbow = shoulder + ahead * along + down * aside;
        all.push(capsule(shoulder, elbow, UPPER_M));
        all.push(capsule(elbow, wrist, LOWER_M));
        all.push(capsule(wrist, grip, FINGERS_M));
    }
    all.push(capsule(head, head, HEAD_M));
    let hip = FacePlace::new(neck.x, neck.y, 0.52 * height_m);
    all.push(capsule(neck, hip, TRUNK_M));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::StationId;
    use giveway_floor::warehouse::stations;

    #[test]
    fn bones_keep_their_lengths_and_hands_are_where_they_are() {
        let w = stations();
        let place = &w.stations[StationId(0)];
        let rack = w.rack_types.iter().next().unwrap();
        let face = PickFace::new(place.cell.as_ref().unwrap(), w.nodes[place.node].at, rack);
        let head = FacePlace::new(0.0, 1.05, 1.63);
        for (_, slot) in face.slots() {
            let all = limbs(&face, 1.75, head, [slot, FacePlace::new(0.22, 0.95, 0.95)]);
            let length = |k: usize| (all[k].b - all[k].a).norm();
            assert_eq!(all.len(), 8);
            for side in [0, 3] {
                assert!((length(side) - 0.186 * 1.75).abs() < 0.01, "{}", length(side));
                assert!((length(side + 1) - 0.146 * 1.75).abs() < 0.01, "{}", length(side + 1));
            }
            assert!((face.of(all[2].b) - slot).norm() < 1e-9);
        }
    }
}
