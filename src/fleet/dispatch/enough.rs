//! Stations for which enough racks wait: robots fetch no more racks for them.
//!
//! Main function: [`with_enough_racks`]. Dispatch uses it, and so does the display of waiting jobs. Refuses: to say
//! which robot has its turn; traffic does.

use crate::state::floor::Floor;
use crate::state::needs::Needs;
use giveway_floor::id::{RobotId, StationId};
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// A rack that waits longer than this for a place at its station has waited for long.
const LONG: Span = Span::from_secs(60);

/// Stations for which enough robots with racks wait, or which are paused, or which a robot that cannot drive or a
/// closed area has blocked for long: fetching another rack now would leave its robot waiting while others need it.
pub(crate) fn stations_with_enough(floor: Floor<'_>, needs: &Needs, now: Time) -> BTreeSet<StationId> {
    let paused = floor.ledger.paused_stations.keys().copied();
    let blocked = floor.restrictions.cut_off.blocked_for_long(now);
    with_enough_racks(floor, needs, now).into_keys().chain(paused).chain(blocked).collect()
}

/// Stations for which enough robots with racks wait, each with the robot that has waited for the longest.
pub(crate) fn with_enough_racks(floor: Floor<'_>, needs: &Needs, now: Time) -> BTreeMap<StationId, RobotId> {
    let mut waiting: BTreeMap<StationId, (usize, Span, RobotId)> = BTreeMap::new();
    for robot in floor.ledger.present().filter(|r| floor.waits_for_room(*r)) {
        let (station, waited) =
            (floor.station_of(robot).expect("it waits for one"), needs.waited(robot, now));
        let (number, longest, first) = waiting.entry(station).or_insert((0, waited, robot));
        *number += 1;
        if waited > *longest {
            (*longest, *first) = (waited, robot);
        }
    }
    let places = |s: StationId| floor.warehouse().stations[s].queue.len() + 1;
    let enough = |s: StationId, longest: Span| enough(places(s), needs.set_off.get(&s).copied(), longest);
    let full = waiting.into_iter().filter(|(s, (number, longest, _))| *number >= enough(*s, *longest));
    full.map(|(s, (_, _, first))| (s, first)).collect()
}

/// How many robots with racks may wait for a station with this many places before robots fetch no more: twice as many
/// as places if the line moves, so that there are some to choose from if ways are long and crowded; as many as places
/// once a robot has waited for long, or the last one to set off had, or none has yet; none while the line stands.
fn enough(places: usize, last: Option<Span>, longest: Span) -> usize {
    match () {
        () if longest > LONG * 3 => 0,
        () if longest > LONG || last.is_none_or(|waited| waited > LONG) => places,
        () => 2 * places,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn racks_wait_for_a_station_as_its_line_moves() {
        let [moment, long, stands] = [10, 100, 200].map(Span::from_secs);
        assert_eq!(enough(5, None, Span::ZERO), 5, "nobody knows yet how fast it goes");
        assert_eq!(enough(5, Some(moment), moment), 10);
        assert_eq!(enough(5, Some(long), moment), 5);
        assert_eq!(enough(5, Some(moment), long), 5);
        assert_eq!(enough(5, Some(moment), stands), 0);
    }
}
