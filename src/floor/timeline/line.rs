//! The timeline of one resource: holds sorted by start, and the gaps between them.
//!
//! Main types: [`Hold`], [`Line`], [`FreeWindow`], [`Withdrawn`] (holds that a query ignores). Refuses: overlapping
//! holds of different holders on the physical layer (asserted); conflict holds may overlap one another.

use crate::id::{Dense, RobotId};
use crate::time::{Time, Window};

/// Why a resource is not free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// The resource itself is held.
    Physical,
    /// A resource in conflict with it is held.
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
    /// First instant that is no longer free.
    pub end: Time,
    /// Distinguishes the gaps of one resource, while neither its line nor the ignored holds change.
    pub index: u32,
}

/// The beginning of all time, where the first free window of a line starts.
const BEGINNING: Time = Time(i64::MIN / 2);

/// Holds that a query ignores, as if their holders had given them up: for each holder those from some visit on.
#[derive(Clone, Debug)]
pub(super) struct Withdrawn {
    /// For each holder, the serial number of the first visit that it has given up. A holder with the largest number, or
    /// beyond the end, has given up nothing.
    from: Vec<u64>,
    /// The bits of the holders that have given up something, see [`bit`].
    holders: u64,
}

/// No holder has given up anything.
pub(super) static NOTHING: Withdrawn = Withdrawn { from: Vec::new(), holders: 0 };

impl Withdrawn {
    /// Ignores a holder's visits from `serial` on.
    pub fn add(&mut self, holder: RobotId, serial: u64) {
        if self.from.len() <= holder.ix() {
            self.from.resize(holder.ix() + 1, u64::MAX);
        }
        self.from[holder.ix()] = self.from[holder.ix()].min(serial);
        self.holders |= bit(holder);
    }

    /// The serial number of the first visit that a holder has given up; the largest number if it has given up none.
    pub fn first_of(&self, holder: RobotId) -> u64 {
        self.from.get(holder.ix()).copied().unwrap_or(u64::MAX)
    }

    fn has(&self, hold: &Hold) -> bool {
        hold.serial >= self.first_of(hold.holder)
    }
}

/// The bit of a holder in a set of holders that may contain a few too many: some holders share a bit.
fn bit(holder: RobotId) -> u64 {
    1 << (holder.ix() % 64)
}

fn bits(holds: &[Hold]) -> u64 {
    holds.iter().fold(0, |all, h| all | bit(h.holder))
}

/// All holds on one resource.
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    holds: Vec<Hold>,
    /// For each hold its start, and the latest end of it and all before it: gaps are found without looking back, in a
    /// few lines of cache.
    edges: Vec<(Time, Time)>,
    /// The bits of all holders, see [`bit`]: most lines have no ignored hold, and this detects it.
    holders: u64,
}

impl Line {
    /// A copy of the line without the ignored holds.
    pub fn without(&self, withdrawn: &Withdrawn) -> Line {
        let holds: Vec<Hold> = self.holds.iter().filter(|h| !withdrawn.has(h)).cloned().collect();
        let mut line = Line { holders: bits(&holds), holds, edges: Vec::new() };
        line.rebuild_edges_from(0);
        line
    }

    /// Adds a hold after all that start no later.
    pub fn insert(&mut self, hold: Hold) {
        self.holders |= bit(hold.holder);
        let at = self.holds.partition_point(|h| h.start <= hold.start);
        self.holds.insert(at, hold);
        self.rebuild_edges_from(at);
    }

    /// Removes the entries (physical and conflict) of one visit. Does nothing if none are left: a visit can be in
    /// conflict with a resource through both its node and its lane, and the first call removes both entries.
    pub fn remove(&mut self, holder: RobotId, serial: u64) {
        let mine = |h: &Hold| h.holder == holder && h.serial == serial;
        if let Some(first) = self.holds.iter().position(mine) {
            self.holds.retain(|h| !mine(h));
            self.holders = bits(&self.holds);
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

    /// Gaps that end after `t`, in order, as if the ignored holds were not there.
    pub fn free_windows<'a>(&'a self, t: Time, withdrawn: &'a Withdrawn) -> Gaps<'a> {
        let from = self.edges.partition_point(|(start, _)| *start <= t);
        let withdrawn = (self.holders & withdrawn.holders != 0).then_some(withdrawn);
        let free = match withdrawn {
            Some(withdrawn) => self.reach(from, withdrawn),
            None if from == 0 => BEGINNING,
            None => self.edges[from - 1].1,
        };
        Gaps { line: self, withdrawn, next: from, free }
    }

    /// The latest end of the first `count` holds except for the ignored ones. It looks back only until no earlier hold
    /// can end later, which is a step or two where few holds overlap.
    fn reach(&self, count: usize, withdrawn: &Withdrawn) -> Time {
        let mut reach = BEGINNING;
        for i in (0..count).rev() {
            if self.edges[i].1 <= reach {
                break;
            }
            if !withdrawn.has(&self.holds[i]) {
                reach = reach.max(self.holds[i].end);
            }
        }
        reach
    }

    /// The holders on either side of a free window, as if the ignored holds were not there.
    pub fn neighbours(&self, free: FreeWindow, withdrawn: &Withdrawn) -> (Option<RobotId>, Option<RobotId>) {
        let (before, after) = self.holds.split_at(self.edges.partition_point(|(start, _)| *start < free.end));
        let stays = |h: &&Hold| !withdrawn.has(h);
        (before.iter().rfind(stays).map(|h| h.holder), after.iter().find(stays).map(|h| h.holder))
    }

    /// Entries that meet a window, as if the ignored holds were not there.
    pub fn during_without(&self, w: Window, withdrawn: &Withdrawn) -> impl Iterator<Item = &Hold> {
        self.during(w).filter(|h| !withdrawn.has(h))
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

    /// The first other holder that comes before this visit in the order of the resource.
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

    /// Changes the window of an entry without changing its place in the order. A visit has two conflict entries here if
    /// both its node and its lane are in conflict with this resource; `nth` selects one.
    pub fn slide(&mut self, holder: RobotId, serial: u64, (layer, nth): (Layer, usize), w: Window) {
        let mine = |h: &&mut Hold| h.holder == holder && h.serial == serial && h.layer == layer;
        if let Some(h) = self.holds.iter_mut().filter(mine).nth(nth) {
            (h.start, h.end) = (w.start(), w.end());
        }
    }

    /// Two holders whose order would change if the entries were sorted by their present windows.
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
        assert_eq!(self.holders, bits(&self.holds), "{}: the set of holders is not theirs", name());
        for (i, a) in self.holds.iter().enumerate() {
            assert!(i == 0 || self.holds[i - 1].start <= a.start, "{}: holds out of order", name());
            for b in self.holds[i + 1..].iter().take_while(|b| b.start < a.end) {
                let both_conflict = a.layer == Layer::Conflict && b.layer == Layer::Conflict;
                assert!(a.holder == b.holder || both_conflict, "{} is held twice: {a:?} and {b:?}", name());
            }
        }
    }
}

/// The gaps of a line, in order.
pub(super) struct Gaps<'a> {
    line: &'a Line,
    /// The ignored holds, if the line may have any of them.
    withdrawn: Option<&'a Withdrawn>,
    /// Index of the hold at which the next gap ends, unless it is ignored.
    next: usize,
    /// The latest end of all holds before that one.
    free: Time,
}

impl Iterator for Gaps<'_> {
    type Item = FreeWindow;

    fn next(&mut self) -> Option<FreeWindow> {
        while self.next <= self.line.edges.len() {
            let i = self.next;
            self.next += 1;
            let (end, reach) = match (self.line.edges.get(i), self.withdrawn) {
                (None, _) => (Time::MAX, Time::MAX),
                (Some(edge), None) => *edge,
                (Some(_), Some(withdrawn)) if withdrawn.has(&self.line.holds[i]) => continue,
                (Some((start, _)), Some(_)) => (*start, self.free.max(self.line.holds[i].end)),
            };
            let start = std::mem::replace(&mut self.free, reach);
            if start < end {
                return Some(FreeWindow { start, end, index: i as u32 });
            }
        }
        None
    }
}
