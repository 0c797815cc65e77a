//! What headsets report besides poses, on the wire.
//!
//! Makes a [`SensesDto`] from [`CarriedSenses`]. Refuses: to judge it.

use crate::dto::people::{GazeDto, HandsDto, SensesDto};
use crate::feed::hub::CarriedSenses;
use crate::wire::text::round3;

impl From<&CarriedSenses> for SensesDto {
    fn from(c: &CarriedSenses) -> SensesDto {
        let place = |p: [f64; 3]| p.map(round3);
        let gaze =
            c.senses.gaze.map(|g| GazeDto { kind: g.kind, origin: place(g.origin), dir: place(g.dir) });
        let hand = |i: usize| {
            c.senses.hands[i].as_ref().map(|joints| joints.iter().map(|j| j.map(round3)).collect())
        };
        SensesDto { battery: c.senses.battery, gaze, hands: HandsDto { l: hand(0), r: hand(1) } }
    }
}
