//! What a scenario says to the fleet at the start: the areas that are closed for a time.
//!
//! Main function: [`announce`]. Refuses: to say it again to a fleet that was told before a restart.

use super::customers::FIRST_TOKEN;
use crate::fleet::{Closure, Fleet, Input};

/// Requests to close an area carry tokens from here on.
const CLOSING_TOKEN: u64 = FIRST_TOKEN | 1 << 61;

/// What is said to the fleet at the start: all areas, unless it has been told of some before.
pub(super) fn announce(areas: Vec<Closure>, fleet: &Fleet) -> impl Iterator<Item = Input> + use<> {
    let told = fleet.ledger().next_closure > 1;
    let new = areas.into_iter().filter(move |_| !told);
    new.zip(CLOSING_TOKEN..).map(|(area, token)| Input::Close { token, area })
}
