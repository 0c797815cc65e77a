//! Delays: a late departure moves what follows, for the late holder and for all holders after it.
//!
//! Main functions: [`Timeline::delay`] works out what moves, [`Timeline::slide`] moves it. The order of holders on
//! every resource stays as it was promised; only the windows slide (carp.md, "Delays"; ter Mors; Maza and
//! Castagna). Refuses: to change any order.

use super::{Layer, Timeline, Visit};
use crate::id::{LineId, RobotId};
use crate::time::{Span, Time};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::ops::Range;

/// A visit's new times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shift {
    /// Serial number of the visit.
    pub serial: u64,
    /// The hold on node and lane begins.
    pub enter: Time,
    /// The centre of the node is reached.
    pub arrive: Time,
    /// The holder starts to leave.
    pub depart: Time,
    /// The hold on the node ends.
    pub leave: Time,
}

impl Shift {
    /// The times of a visit.
    pub fn of(serial: u64, v: &Visit) -> Shift {
        Shift { serial, enter: v.enter, arrive: v.arrive, depart: v.depart, leave: v.leave }
    }

    /// Gives a visit these times.
    pub(super) fn apply(&self, v: &mut Visit) {
        (v.enter, v.arrive, v.depart, v.leave) = (self.enter, self.arrive, self.depart, self.leave);
    }
}

/// Holders with their visits that move.
pub type Slip = Vec<(RobotId, Vec<Shift>)>;

/// Later departures that are still to be processed, the earliest first.
type Due = BinaryHeap<Reverse<(Time, RobotId, u64)>>;

impl Timeline {
    /// What moves if the holder cannot leave the visit `serial` before `depart`: that departure, the holder's later
    /// visits as far as their slack does not absorb it, and the windows of all holders that follow on the affected
    /// resources. Nothing is changed.
    ///
    /// Time: each moved visit once or a few times, in order of its new departure, and for each of them the entries
    /// behind it on its resources.
    pub fn delay(&self, holder: RobotId, serial: u64, depart: Time) -> Slip {
        let mut draft = DelayDraft { timeline: self, moved: BTreeMap::new() };
        let mut due = BinaryHeap::from([Reverse((depart, holder, serial))]);
        while let Some(Reverse((depart, h, s))) = due.pop() {
            for moved in draft.slide_chain(h, s, depart) {
                draft.push_followers(h, moved, &mut due);
            }
        }
        draft.slip()
    }

    /// Moves visits exactly as given.
    ///
    /// # Panics
    /// If the order of holders on a resource would change, two holders would overlap, or a holder would leave a place
    /// before it is elsewhere: then the code that computed the shifts, or the record of them, is broken.
    pub fn slide(&mut self, slip: &[(RobotId, &[Shift])]) {
        let mut touched: BTreeSet<LineId> = BTreeSet::new();
        for (holder, shifts) in slip {
            for shift in *shifts {
                let chain = self.chains.get_mut(holder).expect("only holders are late");
                let index = shift.serial.checked_sub(chain.first).and_then(|i| usize::try_from(i).ok());
                let visit = index.and_then(|i| chain.visits.get_mut(i));
                shift.apply(visit.unwrap_or_else(|| panic!("{holder:?} has no visit {}", shift.serial)));
                self.rewrite(*holder, shift.serial, &mut touched);
            }
        }
        for l in touched {
            let swapped = self.lines[l].swapped();
            let name = || self.warehouse.resource_name(self.warehouse.resource_of(l));
            assert_eq!(swapped, None, "a delay changes an order on {}", name());
            self.lines[l].sort();
        }
        for (holder, shifts) in slip {
            self.assert_in_order(*holder);
            shifts.iter().for_each(|shift| self.assert_alone(*holder, shift.serial));
        }
    }

    /// Asserts that a visit overlaps with no visit of another holder.
    fn assert_alone(&self, holder: RobotId, serial: u64) {
        let visit = self.chains[&holder].get(serial).expect("it moved, so it is there");
        let clash = self.check(holder, std::slice::from_ref(visit));
        assert_eq!(clash, Ok(()), "{holder:?} cannot be late where another is");
    }

    /// Updates the entries of a visit without changing their place in any order.
    fn rewrite(&mut self, h: RobotId, s: u64, touched: &mut BTreeSet<LineId>) {
        let warehouse = self.warehouse.clone();
        let visit = self.chains[&h].get(s).expect("it moved, so it is there");
        let mut first: &[LineId] = &[];
        for (line, window) in super::entries::claims(self.context(&warehouse, h), visit) {
            self.lines[line].slide(h, s, (Layer::Physical, 0), window);
            touched.insert(line);
            for &c in warehouse.lines_in_conflict(line) {
                let nth = usize::from(first.contains(&c));
                self.lines[c].slide(h, s, (Layer::Conflict, nth), window);
                touched.insert(c);
            }
            first = warehouse.lines_in_conflict(line);
        }
    }

    /// [`Timeline::delay`] and [`Timeline::slide`].
    pub fn postpone(&mut self, holder: RobotId, serial: u64, depart: Time) -> Slip {
        let slip = self.delay(holder, serial, depart);
        let told: Vec<(RobotId, &[Shift])> = slip.iter().map(|(h, shifts)| (*h, shifts.as_slice())).collect();
        self.slide(&told);
        slip
    }
}

/// A timeline with visits that will move.
struct DelayDraft<'a> {
    timeline: &'a Timeline,
    moved: BTreeMap<(RobotId, u64), Visit>,
}

impl DelayDraft<'_> {
    /// A visit with its new times.
    fn visit(&self, h: RobotId, s: u64) -> Option<&Visit> {
        self.moved.get(&(h, s)).or_else(|| self.timeline.chains.get(&h)?.get(s))
    }

    /// Moves one departure and, along the holder's own chain, whatever waiting does not absorb. Gives the serial
    /// numbers of the visits that changed.
    ///
    /// Each visit begins no earlier than the one before it. If both slide as they were planned, that stays true. But
    /// granting can let several begin at one moment. If they are revoked then, slack lets a later one slide by less
    /// than the one before it, so its beginning is moved up to that of the one before.
    fn slide_chain(&mut self, h: RobotId, s: u64, mut depart: Time) -> Range<u64> {
        let chain = self.timeline.chains.get(&h).expect("only holders are late");
        let mut end = s;
        for serial in s.max(chain.first)..chain.end() {
            let mut visit = self.visit(h, serial).expect("it is in the chain").clone();
            if visit.depart.is_forever() || visit.depart >= depart {
                break;
            }
            let by = depart - visit.depart;
            visit.depart = depart;
            visit.leave += by;
            let granted = serial + 1 < chain.granted;
            let mut next = self.visit(h, serial + 1).expect("only the last visit is for ever").clone();
            if !granted {
                next.enter += by;
            }
            next.arrive += by;
            depart = next.arrive + next.stay;
            end = serial + 2;
            self.moved.insert((h, serial), visit);
            self.moved.insert((h, serial + 1), next);
        }
        let mut begins = Time(i64::MIN);
        for serial in s.max(chain.first)..chain.end() {
            let visit = self.visit(h, serial).expect("it is in the chain");
            if visit.enter >= begins && serial >= end {
                break;
            }
            let enter = if serial >= chain.granted { visit.enter.max(begins) } else { visit.enter };
            if enter != visit.enter {
                let later = Visit { enter, ..visit.clone() };
                self.moved.insert((h, serial), later);
            }
            begins = enter;
            end = end.max(serial + 1);
        }
        s..end
    }

    /// Demands later departures of all holders that come after this visit and would now come too early.
    fn push_followers(&self, h: RobotId, s: u64, due: &mut Due) {
        let Some(visit) = self.visit(h, s) else { return };
        let warehouse = &self.timeline.warehouse;
        for (line, window) in super::entries::claims(self.timeline.context(warehouse, h), visit) {
            let conflicts = warehouse.lines_in_conflict(line).iter();
            for l in std::iter::once(&line).chain(conflicts) {
                for f in self.timeline.lines[*l].followers(h, s) {
                    let start = self.moved.get(&(f.holder, f.serial)).map_or(f.start, |v| v.enter);
                    if start < window.end() {
                        self.demand(f.holder, f.serial, window.end(), due);
                    }
                }
            }
        }
    }

    /// Demands that `other` leaves the visit before `serial` later, since it may enter `serial` no earlier than `at`.
    fn demand(&self, other: RobotId, serial: u64, at: Time, due: &mut Due) {
        let chain = &self.timeline.chains[&other];
        let visit = self.visit(other, serial).expect("every hold belongs to a visit");
        let late: Span = at - visit.enter;
        assert!(serial >= chain.granted, "{other:?} was granted what others hold before it");
        let before = self.visit(other, serial - 1).expect("what is not granted has a visit before it");
        due.push(Reverse((before.depart + late, other, serial - 1)));
    }

    /// The differences from the unchanged timeline.
    fn slip(self) -> Slip {
        let mut slip: Slip = Vec::new();
        for ((holder, serial), visit) in &self.moved {
            if self.timeline.chains[holder].get(*serial) == Some(visit) {
                continue;
            }
            let shift = Shift::of(*serial, visit);
            match slip.last_mut() {
                Some((last, shifts)) if last == holder => shifts.push(shift),
                _ => slip.push((*holder, vec![shift])),
            }
        }
        slip
    }
}
