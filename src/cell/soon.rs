//! How likely a hand is in the opening before long, so that no rack moves there.
//!
//! Main function: [`inside_soon`]. Refuses: to stop anything; the guard of the station does that.

use super::face::{FacePlace, PickFace};

/// Time that is predicted, seconds.
const SOON_S: f64 = 0.3;
/// Probability from which robots stay where they are.
pub(super) const STAYS: f64 = 0.1;
/// Uncertainty of where a hand is at that time: for a hand at rest, metres, and in addition for each metre that it
/// would go.
const REST_M: f64 = 0.03;
const PER_M: f64 = 0.35;

/// The probability that a hand at this place with this velocity is in the opening or beyond it within 0.3 s.
pub(super) fn inside_soon(face: &PickFace, at: FacePlace, velocity: FacePlace) -> f64 {
    if face.is_inside(at) {
        return 1.0;
    }
    let goes = velocity * SOON_S;
    let way_m = FacePlace::new(goes.x, goes.y.min(0.0), goes.z).norm();
    let ends = if goes.y < 0.0 { at + goes } else { at };
    if !face.is_beside_rack(ends) {
        return 0.0;
    }
    let outside_m = face.outside_m(ends);
    let sigma_m = REST_M + PER_M * way_m;
    0.5 * libm::erfc(outside_m / (sigma_m * std::f64::consts::SQRT_2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::StationId;
    use giveway_floor::warehouse::stations;

    fn face() -> PickFace {
        let w = stations();
        let (station, rack) =
            (&w.stations[StationId(0)], w.rack_types.iter().next().expect("racks have a type"));
        PickFace::new(station.cell.as_ref().expect("it has a cell"), w.nodes[station.node].at, rack)
    }

    #[test]
    fn a_hand_on_its_way_in_is_expected_inside_and_one_at_rest_or_on_its_way_out_is_not() {
        let face = face();
        let before = |m: f64| FacePlace::new(0.1, face.opening_m() + m, 1.2);
        let towards = |mps: f64| FacePlace::new(0.0, -mps, 0.0);
        let soon = |m: f64, mps: f64| inside_soon(&face, before(m), towards(mps));
        assert_eq!(soon(-0.1, 0.0), 1.0, "it is inside");
        assert!(soon(0.2, 1.2) > 0.8, "{}", soon(0.2, 1.2));
        assert!(soon(0.3, 0.0) < 1e-3 && soon(0.12, -1.0) < 0.1, "{} {}", soon(0.3, 0.0), soon(0.12, -1.0));
        assert!(soon(0.3, 0.8) > soon(0.3, 0.4), "the faster, the likelier");
        let beside = FacePlace::new(2.0, face.opening_m() + 0.1, 1.2);
        assert_eq!(inside_soon(&face, beside, towards(1.0)), 0.0, "no rack stands there");
    }
}
