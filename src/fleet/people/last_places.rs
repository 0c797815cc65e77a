//! Workers who are not seen: they are noted while they are on the floor, so that a restart knows of them; and workers
//! who take their headsets off.
//!
//! Refuses: to take a worker off the floor whom no one saw leave, or vouches for.

use crate::people::state::HumanState;
use crate::state::fact::WorkerFact;
use crate::state::floor::Floor;
use crate::state::ledger::Ledger;
use crate::state::worker::LastPlace;
use crate::state::writer::Writer;
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;
use giveway_people::human::{LastKnown, Presence};

/// A worker who is seen is noted again after this many metres, a lost worker after the second figure: after a restart
/// the worker is looked for within eight metres.
const NOTED_M: (f64, f64) = (5.0, 0.5);
/// A worker who takes the headset off within this of a door has left the floor, metres.
const DOOR_M: f64 = 3.0;

impl From<&LastPlace> for LastKnown {
    fn from(place: &LastPlace) -> LastKnown {
        let within_m = place.within_mm.map(|mm| mm as f64 / 1000.0);
        LastKnown { at: place.at.into(), seen: place.seen, within_m }
    }
}

impl HumanState {
    /// Takes over from the ledger which workers were on the floor. None has been seen since.
    pub(crate) fn remember(&mut self, ledger: &Ledger) {
        for (worker, place) in &ledger.on_floor {
            let track = &mut self.person(*worker).track;
            track.move_as(ledger.mover(*worker));
            track.remember(place.into());
        }
    }

    /// Workers on the floor whose place is not known.
    pub(crate) fn lost(&self, now: Time) -> Vec<WorkerId> {
        let present = self.present(now).into_iter();
        present.filter(|(_, place)| place.presence == Presence::Lost).map(|(worker, _)| worker).collect()
    }

    /// Notes in the ledger where workers are, coarsely.
    pub(super) fn note_places(&self, writer: &mut Writer, now: Time) {
        for (worker, place) in self.present(now) {
            let track = &self.people[worker].track;
            let Some(seen) = track.last_seen().filter(|_| !track.is_vouched()) else { continue };
            let is_far = |noted: &LastPlace| {
                let moved_m = (Point::from(noted.at) - place.at).norm();
                let lost = place.presence == Presence::Lost;
                moved_m > if lost { NOTED_M.1 } else { NOTED_M.0 } || noted.within_mm.is_some()
            };
            if writer.ledger().on_floor.get(&worker).is_none_or(is_far) {
                let place = LastPlace { at: place.at.into(), seen, within_mm: None };
                writer.record(WorkerFact::Noted { worker, place });
            }
        }
    }

    /// Handles a worker who has taken the headset off: at a door, the worker has left; anywhere else, the worker is
    /// still there, and will not be seen.
    pub(super) fn sign_off(&mut self, writer: &mut Writer, worker: WorkerId, now: Time) {
        let Some(place) = self.whereabouts(worker, now) else { return };
        if is_at_door(writer.floor(), place.at) && place.presence != Presence::Lost {
            self.clear(worker, now);
            writer.record(WorkerFact::Cleared { worker, by: None, at: now });
        } else {
            self.person(worker).track.sign_off(now);
        }
    }
}

fn is_at_door(floor: Floor<'_>, at: Point) -> bool {
    let doors = floor.warehouse().nodes_where(|kind| kind == NodeKind::Exit);
    doors.iter().any(|door| (floor.warehouse().nodes[*door].at - at).norm() <= DOOR_M)
}
