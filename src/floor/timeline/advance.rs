//! Advances: a holder that need not wait as long as planned goes on earlier, with all that it holds after that.
//!
//! Main function: [`Timeline::advance`], the mirror of [`Timeline::delay`](super::Timeline::delay): it works out what
//! moves, and `slide` moves it. Refuses: to change any order, and to move other holders; each of those advances by
//! itself, once its turn has come.

use super::{Shift, Timeline, Visit};
use crate::id::RobotId;
use crate::time::{Span, Time};

impl Timeline {
    /// What moves if the holder leaves its last granted visit at `depart` instead of later: that departure, and the
    /// later visits, each as far as the one before it and no farther than to the end of other holders' holds there
    /// before it. Nothing is changed; the result is empty if nothing can be earlier.
    ///
    /// Time: each visit that moves once, and for each of them the entries before it on its resources.
    pub fn advance(&self, holder: RobotId, depart: Time) -> Vec<Shift> {
        let Some(chain) = self.chains.get(&holder) else { return Vec::new() };
        let last = chain.granted - 1;
        let here = chain.get(last).expect("what is granted is held");
        if here.depart.is_forever() || here.depart <= depart {
            return Vec::new();
        }
        let mut shifts = vec![Shift { arrive: here.arrive.min(depart), ..Shift::of(last, here) }];
        let mut by = here.depart - depart;
        for serial in last + 1..chain.end() {
            let visit = chain.get(serial).expect("it is in the chain");
            by = by.min(self.room_before(holder, serial, visit));
            if by <= Span::ZERO {
                break;
            }
            let before = shifts.last_mut().expect("the last granted visit is first");
            (before.depart, before.leave) = (before.depart - by, before.leave - by);
            let shift = Shift::of(serial, visit);
            // A robot that continues as soon as it has come holds the next place from no earlier than the present one.
            let enter = (shift.enter - by).max(before.enter);
            shifts.push(Shift { enter, arrive: shift.arrive - by, ..shift });
        }
        if shifts.len() == 1 { Vec::new() } else { shifts }
    }

    /// How much earlier a visit may begin before it meets what another holder holds there before it.
    fn room_before(&self, holder: RobotId, serial: u64, visit: &Visit) -> Span {
        let lines = super::claims(self.context(&self.warehouse, holder), visit).map(|(line, _)| line);
        let before = lines.flat_map(|l| self.lines[l].before(holder, serial));
        let ends = before.filter(|h| h.holder != holder).map(|h| h.end);
        ends.max().map_or(Span::MAX, |end| visit.enter - end)
    }
}
