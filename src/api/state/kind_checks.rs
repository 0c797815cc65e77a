//! Checks whether the map suits a robot kind that is to be added: this takes too long for the fleet.
//!
//! Main type: [`KindChecks`]. Refuses: two checks at once.

use crate::wire::error::{FieldError, Problem};
use giveway_fleet::RobotKind;
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Checks the map for robot kinds that are to be added, one at a time: on a large map a check takes a while.
#[derive(Clone, Debug)]
pub struct KindChecks(Arc<Semaphore>);

impl Default for KindChecks {
    fn default() -> KindChecks {
        KindChecks(Arc::new(Semaphore::new(1)))
    }
}

impl KindChecks {
    /// Whether the building's map suits robots of a kind.
    pub async fn check(&self, building: Arc<Warehouse>, kind: RobotKind) -> Result<(), Problem> {
        let busy = |_| Problem::unavailable(requests::busy(), 1);
        let place = self.0.clone().try_acquire_owned().map_err(busy)?;
        let work = move || {
            // The place is kept until the work has ended, even if the client has gone.
            let _place = place;
            building.check_body(&kind.body())
        };
        let checked = tokio::task::spawn_blocking(work).await.map_err(|e| {
            tracing::error!("kinds of robots: {e}");
            Problem::internal()
        })?;
        let wrong = |text: String| FieldError::new("footprint", requests::malformed(text));
        checked.map_err(|found| Problem::invalid(found.0.iter().map(|f| wrong(f.to_string())).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{Footprint, lab};

    #[tokio::test]
    async fn the_map_is_looked_at_for_one_kind_at_a_time() {
        let (checks, map, kind) = (KindChecks::default(), Arc::new(lab()), RobotKind::default());
        let place = checks.0.clone().try_acquire_owned().expect("no check runs");
        let busy = checks.check(map.clone(), kind.clone()).await.unwrap_err();
        assert_eq!((busy.status, busy.retry_after), (503, Some(1)));
        drop(place);
        checks.check(map.clone(), kind.clone()).await.expect("the map is for it");
        let large = Some(Footprint::Square { side_m: 9.0 });
        let wide = RobotKind { footprints: [large.clone(), large], ..kind };
        assert_eq!(checks.check(map, wide).await.unwrap_err().status, 422);
    }
}
