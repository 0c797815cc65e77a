//! Reports of robot arms as recordings have them.
//!
//! Main type: [`ArmRow`]. Refuses: to round, since a recording must play again to the same digest.

use giveway_cell::arm::{ArmReport, ArmSaid, Gripped};
use giveway_floor::id::StationId;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};

/// Station, seen, joints (nothing for one that is not a number), whether the arm's own stop holds it, the last grip
/// that ended and whether it was in vain.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct ArmRow(u32, i64, [Option<f64>; 6], bool, Option<(u64, bool)>);

impl From<&ArmSaid> for ArmRow {
    fn from(said: &ArmSaid) -> ArmRow {
        let ArmReport { joints, seen, is_stopped } = said.report;
        let gripped = said.gripped.map(|(number, came)| (number, came == Gripped::Empty));
        let joints = joints.map(|q| Some(q).filter(|q| q.is_finite()));
        ArmRow(said.station.0, seen.0, joints, is_stopped, gripped)
    }
}

impl From<ArmRow> for ArmSaid {
    fn from(ArmRow(station, seen, joints, is_stopped, gripped): ArmRow) -> ArmSaid {
        let joints = joints.map(|q| q.unwrap_or(f64::NAN));
        let came = |in_vain| if in_vain { Gripped::Empty } else { Gripped::Done };
        ArmSaid {
            station: StationId(station),
            report: ArmReport { joints, seen: Time(seen), is_stopped },
            gripped: gripped.map(|(number, in_vain)| (number, came(in_vain))),
        }
    }
}
