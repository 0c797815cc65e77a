//! A timeline as a search sees it: as if some holders had given up visits, and others held a new route.
//!
//! Main type: [`Overlay`], which [`Timeline::view`] and [`Timeline::without`] make. Refuses: to change the timeline
//! beneath it, and to prove that anything is held; the result of a search must be booked on the timeline itself.
//!
//! A query about a resource costs as much as on the timeline, and allocates nothing: a binary search, then a step for
//! each window. If the line of the resource has holds that were given up, they are skipped one by one. Giving up visits
//! costs nothing per visit, so all robots can be taken off the floor for one search. Adding a route copies the lines on
//! which it has holds, a few for each of its visits, and no others.

use super::entries::{claims, for_each_hold, is_station};
use super::line::{FreeWindow, Hold, Line, NOTHING, Withdrawn};
use super::{Clash, Timeline, Visit, in_order};
use crate::id::{Dense, LineId, RobotId};
use crate::time::{Time, Window};
use smallvec::SmallVec;

/// A timeline on which some holders have given up visits, and others have new routes. The timeline itself is unchanged.
#[derive(Clone, Debug)]
pub struct Overlay<'a> {
    base: &'a Timeline,
    withdrawn: Withdrawn,
    /// The holders that have new routes.
    added: SmallVec<[RobotId; 4]>,
    changed: ChangedLines,
}

/// Lines on which new routes have holds, without the holds that were given up.
#[derive(Clone, Debug, Default)]
struct ChangedLines {
    /// For each line of the building, one more than the number of its copy, or zero. Empty if there are no copies.
    at: Vec<u32>,
    copies: Vec<Line>,
}

impl Timeline {
    /// The timeline as it is.
    pub fn view(&self) -> Overlay<'_> {
        let (added, changed) = (SmallVec::new(), ChangedLines::default());
        Overlay { base: self, withdrawn: NOTHING.clone(), added, changed }
    }

    /// The timeline as if these holders held nothing.
    pub fn without(&self, holders: &[RobotId]) -> Overlay<'_> {
        let mut overlay = self.view();
        holders.iter().for_each(|h| overlay.withdraw(*h, 0));
        overlay
    }
}

impl Overlay<'_> {
    /// Removes a holder's visits from `serial` on.
    ///
    /// # Panics
    /// If a route was added before: its lines are copied already.
    pub fn withdraw(&mut self, holder: RobotId, serial: u64) {
        assert!(self.added.is_empty(), "{holder:?} gives up visits after a route was added");
        self.withdrawn.add(holder, serial);
    }

    /// Adds visits of a holder behind those that it has kept.
    ///
    /// # Errors
    /// The first clash with the holds of others, seen through this overlay; then nothing is added.
    ///
    /// # Panics
    /// If the holder was added before, or the visits do not follow one another and those that it has kept.
    pub fn add(&mut self, holder: RobotId, visits: &[Visit]) -> Result<(), Clash> {
        assert!(!self.added.contains(&holder), "{holder:?} has a new route already");
        self.check(holder, visits)?;
        let chain = self.base.chain(holder).filter(|c| !c.is_absent());
        let first = chain.map_or(0, |c| c.end().min(self.withdrawn.first_of(holder)));
        let kept = chain.and_then(|c| c.get(first.checked_sub(1)?));
        let all: SmallVec<[&Visit; 64]> = kept.into_iter().chain(visits).collect();
        for pair in all.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            assert!(in_order(a, b), "{holder:?} has visits out of order: {a:?} then {b:?}");
        }
        let context = self.base.context(&self.base.warehouse, holder);
        for (serial, visit) in (first..).zip(visits) {
            for_each_hold(context, holder, serial, visit, |line, hold| {
                self.changed.copy_of(self.base, line, &self.withdrawn).insert(hold);
            });
        }
        self.added.push(holder);
        Ok(())
    }

    /// The free windows of a resource that end after `t`, in order, for robots with one footprint.
    pub fn free_windows(&self, line: LineId, t: Time) -> impl Iterator<Item = FreeWindow> {
        let (line, withdrawn) = self.line(line);
        line.free_windows(t, withdrawn)
    }

    /// The holders at the two ends of a free window: the last one before it and the first one after it.
    pub fn neighbours(&self, line: LineId, free: FreeWindow) -> (Option<RobotId>, Option<RobotId>) {
        let (line, withdrawn) = self.line(line);
        line.neighbours(free, withdrawn)
    }

    /// The other holders with a hold, on a resource or on something in conflict with it, that meets `window`.
    pub fn holders_during(
        &self,
        line: LineId,
        window: Window,
        own: RobotId,
    ) -> impl Iterator<Item = RobotId> {
        self.during(line, window).map(|h| h.holder).filter(move |h| *h != own)
    }

    /// The first clash of visits with the holds of others.
    pub(super) fn check(&self, holder: RobotId, visits: &[Visit]) -> Result<(), Clash> {
        let warehouse = &self.base.warehouse;
        let context = self.base.context(warehouse, holder);
        for visit in visits.iter().filter(|v| !self.base.without_conflicts || is_station(warehouse, v)) {
            for (line, wanted) in claims(context, visit) {
                if let Some(h) = self.during(line, wanted).find(|h| h.holder != holder) {
                    let resource = warehouse.resource_of(line);
                    return Err(Clash { resource, wanted, by: h.holder, held: Window::new(h.start, h.end) });
                }
            }
        }
        Ok(())
    }

    fn during(&self, line: LineId, window: Window) -> impl Iterator<Item = &Hold> {
        let (line, withdrawn) = self.line(line);
        line.during_without(window, withdrawn)
    }

    /// A line, and the holds that a query about it ignores: a copy has none of those.
    fn line(&self, line: LineId) -> (&Line, &Withdrawn) {
        match self.changed.get(line) {
            Some(copy) => (copy, &NOTHING),
            None => (&self.base.lines[line], &self.withdrawn),
        }
    }
}

impl ChangedLines {
    fn get(&self, line: LineId) -> Option<&Line> {
        let number = self.at.get(line.ix())?.checked_sub(1)?;
        Some(&self.copies[number as usize])
    }

    /// The copy of a line, made at its first change.
    fn copy_of(&mut self, base: &Timeline, line: LineId, withdrawn: &Withdrawn) -> &mut Line {
        if self.at.is_empty() {
            self.at = vec![0; base.lines.len()];
        }
        let number = &mut self.at[line.ix()];
        if *number == 0 {
            self.copies.push(base.lines[line].without(withdrawn));
            *number = self.copies.len() as u32;
        }
        &mut self.copies[*number as usize - 1]
    }
}
