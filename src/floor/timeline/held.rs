//! Holds, for readers: which holder is on a resource when, and which holders are promised it before another one.
//!
//! Main type: [`Held`]. Refuses: to change anything.

use super::Timeline;
use super::line::{Hold, Layer};
use crate::id::{LineId, ResourceId, RobotId};
use crate::time::Window;

/// One hold on a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The holder.
    pub holder: RobotId,
    /// When the resource is held.
    pub window: Window,
    /// Whether the resource is held itself, or only a resource in conflict with it.
    pub layer: Layer,
    /// Whether the holder may be there already, rather than only being promised it.
    pub granted: bool,
}

impl Timeline {
    /// The holds on a resource that meet `window`, in their order, whichever robots they exclude.
    pub fn holds(&self, r: ResourceId, window: Window) -> Vec<Held> {
        let mut found: Vec<(&Hold, Held)> = (self.warehouse.lines_of(r))
            .flat_map(|line| self.lines[line].during(window))
            .map(|h| (h, self.held(h)))
            .collect();
        // A physical hold for one footprint is a conflict for all others.
        found.sort_by_key(|(h, _)| (h.start, h.holder, h.serial, h.end, h.layer));
        found.dedup_by_key(|(h, _)| (h.start, h.holder, h.serial, h.end));
        found.into_iter().map(|(_, held)| held).collect()
    }

    /// All holds of others on a timeline, in their order, including past ones.
    pub fn held_by_others(&self, line: LineId, own: RobotId) -> impl Iterator<Item = Held> {
        self.lines[line].all().filter(move |h| h.holder != own).map(|h| self.held(h))
    }

    /// The holds that come before the visit `serial` of `holder`, in order, on the resource that
    /// [`Timeline::waits_for`] names. Nothing if it waits for no other holder.
    pub fn before(&self, holder: RobotId, serial: u64) -> Option<(ResourceId, Vec<Held>)> {
        let (resource, _) = self.waits_for(holder, serial)?;
        let loaded = self.chains.get(&holder)?.get(serial)?.loaded;
        let line = self.line(holder, loaded, resource);
        let first = self.lines[line].before(holder, serial).filter(|h| h.holder != holder);
        Some((resource, first.map(|h| self.held(h)).collect()))
    }

    fn held(&self, h: &Hold) -> Held {
        let granted = self.chains.get(&h.holder).is_some_and(|c| h.serial < c.granted);
        Held { holder: h.holder, window: Window::new(h.start, h.end), layer: h.layer, granted }
    }
}
