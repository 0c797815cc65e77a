//! The timeline of one resource: holds sorted by start, and the gaps between them.
//!
//! Main types: [`Hold`], [`Line`], [`FreeWindow`]. Refuses: overlapping holds of different holders on the physical
//! layer (asserted); conflict holds may overlap one another.

use crate::id::RobotId;
use crate::time::{Time, Window};

/// Why a resource is not free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// It is held itself.
    Physical,
    /// Something in conflict with it is held.
    Conflict,
}

/// One entry of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Hold {
    pub start: Time,
    pub end: Time,
    pub holder: RobotId,
    pub serial: u64,
    pub layer: Layer,
}

/// A free window of a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeWindow {
    /// First free instant.
    pub start: Time,
    /// First instant that is not free any more.
    pub end: Time,
    /// Which of the gaps of the resource this is; stable while the line does not change.
    pub index: u32,
}

/// The beginning of all time, where the first free window of a line starts.
const BEGINNING: Time = Time(i64::MIN / 2);

/// All holds on one resource.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    holds: Vec<Hold>,
    /// For each hold its start, and the latest end of it and all before it: gaps are found without looking back, in a
    /// few lines of cache.
    edges: Vec<(Time, Time)>,
}

impl Line {
    pub fn len(&self) -> usize {
        self.holds.len()
    }

    /// Adds a hold behind those that start no later.
    pub fn insert(&mut self, hold: Hold) {
        let at = self.holds.partition_point(|h| h.start <= hold.start);
        self.holds.insert(at, hold);
        self.rebuild_edges_from(at);
    }

    /// Removes the entries (physical and conflict) of one visit. If there are none left, it does nothing: a visit can
    /// be in conflict with a resource through both its node and its lane, and the first call removes both entries.
    pub fn remove(&mut self, holder: RobotId, serial: u64) {
        let mine = |h: &Hold| h.holder == holder && h.serial == serial;
        if let Some(first) = self.holds.iter().position(mine) {
            self.holds.retain(|h| !mine(h));
            self.rebuild_edges_from(first);
        }
    }

    fn rebuild_edges_from(&mut self, at: usize) {
        let mut reach = if at == 0 { BEGINNING } else { self.edges[at - 1].1 };
        self.edges.truncate(at);
        for h in &self.holds[at..] {
            reach = reach.max(h.end);
            self.edges.push((h.start, reach));
        }
    }

    /// Gaps that end after `t`, in order.
    pub fn free_windows(&self, t: Time) -> impl Iterator<Item = FreeWindow> {
        let from = self.edges.partition_point(|(start, _)| *start <= t);
        let mut free = if from == 0 { BEGINNING } else { self.edges[from - 1].1 };
        (from..=self.edges.len()).filter_map(move |i| {
            let (end, reach) = self.edges.get(i).copied().unwrap_or((Time::MAX, Time::MAX));
            let start = std::mem::replace(&mut free, reach);
            (start < end).then_some(FreeWindow { start, end, index: i as u32 })
        })
    }

    /// The holders on either side of a free window.
    pub fn neighbours(&self, free: FreeWindow) -> (Option<RobotId>, Option<RobotId>) {
        let i = free.index as usize;
        let before = i.checked_sub(1).map(|b| self.holds[b].holder);
        (before, self.holds.get(i).map(|h| h.holder))
    }

    /// Entries that meet a window.
    pub fn during(&self, w: Window) -> impl Iterator<Item = &Hold> {
        let to = self.holds.partition_point(|h| h.start < w.end());
        self.holds[..to].iter().filter(move |h| h.end > w.start())
    }

    /// All entries in their order.
    pub fn all(&self) -> impl Iterator<Item = &Hold> {
        self.holds.iter()
    }

    /// The first other holder that stands before this visit in the order of the resource.
    pub fn first_before(&self, holder: RobotId, serial: u64) -> Option<RobotId> {
        self.before(holder, serial).map(|h| h.holder).find(|h| *h != holder)
    }

    /// Entries before this visit in the order of the resource.
    pub fn before(&self, holder: RobotId, serial: u64) -> impl Iterator<Item = &Hold> {
        let mine = |h: &Hold| h.holder == holder && h.serial == serial && h.layer == Layer::Physical;
        let own = self.holds.iter().position(mine).unwrap_or(0);
        self.holds[..own].iter()
    }

    /// Entries of other holders that come after a visit in the order. Two conflict entries do not order one another.
    pub fn followers(&self, holder: RobotId, serial: u64) -> impl Iterator<Item = &Hold> {
        let mine = self.holds.iter().position(|h| h.holder == holder && h.serial == serial);
        let (from, layer) = match mine {
            Some(m) => (m + 1, self.holds[m].layer),
            None => (self.holds.len(), Layer::Conflict),
        };
        let ordered = move |h: &&Hold| layer == Layer::Physical || h.layer == Layer::Physical;
        self.holds[from..].iter().filter(move |h| h.holder != holder).filter(ordered)
    }

    /// Changes the window of an entry in its place in the order. A visit has two conflict entries here where both its
    /// node and its lane are in conflict with this resource; `nth` says which.
    pub fn slide(&mut self, holder: RobotId, serial: u64, (layer, nth): (Layer, usize), w: Window) {
        let mine = |h: &&mut Hold| h.holder == holder && h.serial == serial && h.layer == layer;
        if let Some(h) = self.holds.iter_mut().filter(mine).nth(nth) {
            (h.start, h.end) = (w.start(), w.end());
        }
    }

    /// Two holders whose order would change if the entries were sorted by their windows as they are now.
    pub fn swapped(&self) -> Option<(RobotId, RobotId)> {
        if self.holds.is_sorted_by_key(|h| h.start) {
            return None;
        }
        let ordered = |a: &Hold, b: &Hold| {
            a.holder != b.holder && (a.layer == Layer::Physical || b.layer == Layer::Physical)
        };
        let pairs =
            self.holds.iter().enumerate().flat_map(|(i, a)| self.holds[i + 1..].iter().map(move |b| (a, b)));
        let mut swapped = pairs.filter(|(a, b)| ordered(a, b) && b.start < a.start);
        swapped.next().map(|(a, b)| (a.holder, b.holder))
    }

    /// Restores the order by start after sliding.
    pub fn sort(&mut self) {
        self.holds.sort_by_key(|h| h.start);
        self.rebuild_edges_from(0);
    }

    /// Physical holders in their order.
    #[cfg(test)]
    pub fn order(&self) -> impl Iterator<Item = RobotId> {
        self.holds.iter().filter(|h| h.layer == Layer::Physical).map(|h| h.holder)
    }

    pub fn assert_sound(&self, name: impl Fn() -> String) {
        for (i, a) in self.holds.iter().enumerate() {
            assert!(i == 0 || self.holds[i - 1].start <= a.start, "{}: holds out of order", name());
            for b in self.holds[i + 1..].iter().take_while(|b| b.start < a.end) {
                let both_conflict = a.layer == Layer::Conflict && b.layer == Layer::Conflict;
                assert!(a.holder == b.holder || both_conflict, "{} is held twice: {a:?} and {b:?}", name());
            }
        }
    }
}
