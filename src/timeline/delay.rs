//! Delays: a late departure moves what follows, for the late holder and for all who come after it.
//!
//! Main function: [`Timeline::postpone`]. The order of holders on every resource stays as it was promised; only
//! the windows slide (carp.md, "Delays"; ter Mors; Maza and Castagna). Refuses: to change any order.

use super::{Holder, Layer, Timeline};
use crate::id::ResourceId;
use crate::time::{Span, Time};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::ops::Range;

/// What a postponement touched.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Slip {
    /// Holders whose windows moved, without the late one.
    pub others: BTreeSet<Holder>,
    /// How many visits moved.
    pub visits: usize,
}

impl Timeline {
    /// The holder cannot leave the visit `serial` before `depart`. Moves that departure, whatever the slack of
    /// later visits does not absorb, and the windows of all who follow on the resources concerned.
    ///
    /// Time: each moved visit once or a few times, in order of its new departure, and for each of them the
    /// entries behind it on its resources.
    pub fn postpone(&mut self, holder: Holder, serial: u64, depart: Time) -> Slip {
        let mut slip = Slip::default();
        let mut touched: BTreeSet<ResourceId> = BTreeSet::new();
        let mut due = BinaryHeap::from([Reverse((depart, holder, serial))]);
        while let Some(Reverse((depart, h, s))) = due.pop() {
            let moved = self.slide_chain(h, s, depart);
            slip.visits += moved.clone().count();
            if h != holder && !moved.is_empty() {
                slip.others.insert(h);
            }
            for m in moved.clone() {
                self.rewrite(h, m, &mut touched);
            }
            for m in moved {
                self.push_followers(h, m, &mut due);
            }
        }
        for r in touched {
            self.lines[r].sort();
        }
        slip
    }

    /// Moves one departure and, along the holder's own chain, whatever waiting does not absorb. Gives the serial
    /// numbers of the visits that changed.
    ///
    /// Each visit begins no earlier than the one before. As planned they do when both slide; but granting lets several
    /// begin at one moment, and those that were called back then slide by what each has to give.
    fn slide_chain(&mut self, h: Holder, s: u64, mut depart: Time) -> Range<u64> {
        let chain = self.chains.get_mut(&h).expect("only holders are late");
        let mut end = s;
        for serial in s.max(chain.first)..chain.end() {
            let i = (serial - chain.first) as usize;
            let visit = &mut chain.visits[i];
            if visit.depart.is_forever() || visit.depart >= depart {
                break;
            }
            let by = depart - visit.depart;
            visit.depart = depart;
            visit.leave += by;
            let granted = serial + 1 < chain.granted;
            let next = chain.visits.get_mut(i + 1).expect("only the last visit is for ever");
            if !granted {
                next.enter += by;
            }
            next.arrive += by;
            depart = next.arrive + next.stay;
            end = serial + 2;
        }
        let mut begins = Time(i64::MIN);
        for serial in s.max(chain.first)..chain.end() {
            let visit = &mut chain.visits[(serial - chain.first) as usize];
            if visit.enter >= begins && serial >= end {
                break;
            }
            if serial >= chain.granted {
                visit.enter = visit.enter.max(begins);
            }
            begins = visit.enter;
            end = end.max(serial + 1);
        }
        s..end
    }

    /// Brings the entries of a visit up to date without changing their place in any order.
    fn rewrite(&mut self, h: Holder, s: u64, touched: &mut BTreeSet<ResourceId>) {
        let warehouse = self.warehouse.clone();
        let visit = self.chains[&h].get(s).expect("it moved, so it is there");
        for (resource, window) in super::claims(&warehouse, self.clearance, visit) {
            self.lines[resource].slide(h, s, Layer::Physical, window);
            touched.insert(resource);
            for &c in warehouse.conflicts(resource) {
                self.lines[c].slide(h, s, Layer::Conflict, window);
                touched.insert(c);
            }
        }
    }

    /// Demands later departures of all who come after this visit but would come too early now.
    fn push_followers(&self, h: Holder, s: u64, due: &mut BinaryHeap<Reverse<(Time, Holder, u64)>>) {
        let Some(visit) = self.chains[&h].get(s) else { return };
        for (resource, window) in super::claims(&self.warehouse, self.clearance, visit) {
            let conflicts = self.warehouse.conflicts(resource).iter();
            for r in std::iter::once(&resource).chain(conflicts) {
                for f in self.lines[*r].followers(h, s, window.end()) {
                    self.demand(f.holder, f.serial, window.end(), due);
                }
            }
        }
    }

    /// `other` may enter its visit `serial` no earlier than `at`, so it must leave the one before later.
    fn demand(
        &self,
        other: Holder,
        serial: u64,
        at: Time,
        due: &mut BinaryHeap<Reverse<(Time, Holder, u64)>>,
    ) {
        let chain = &self.chains[&other];
        let visit = chain.get(serial).expect("every hold belongs to a visit");
        let late: Span = at - visit.enter;
        assert!(serial >= chain.granted, "{other:?} was granted what others hold before it");
        let before = chain.get(serial - 1).expect("what is not granted has a visit before it");
        due.push(Reverse((before.depart + late, other, serial - 1)));
    }
}
