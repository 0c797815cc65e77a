//! Holds for those who look on: who is on a resource when, and who is promised it before somebody.
//!
//! Main type: [`Held`]. Refuses: to change anything.

use super::line::{Hold, Layer};
use super::{Holder, Timeline};
use crate::id::ResourceId;
use crate::time::Window;

/// One hold on a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// Whose.
    pub holder: Holder,
    /// When.
    pub window: Window,
    /// Whether it is held itself, or only something in conflict with it.
    pub layer: Layer,
    /// Whether the holder may be there already, rather than only being promised it.
    pub granted: bool,
}

impl Timeline {
    /// The holds on a resource that meet `window`, in their order.
    pub fn holds(&self, r: ResourceId, window: Window) -> impl Iterator<Item = Held> {
        self.lines[r].during(window).map(|h| self.held(h))
    }

    /// All holds of others on a resource, in their order, also those whose time is over.
    pub fn held_by_others(&self, r: ResourceId, own: Holder) -> impl Iterator<Item = Held> {
        self.lines[r].all().filter(move |h| h.holder != own).map(|h| self.held(h))
    }

    /// Everybody who passes before `holder` has the visit `serial`, in order, on the resource that
    /// [`Timeline::waits_for`] names; nothing where nobody does.
    pub fn before(&self, holder: Holder, serial: u64) -> Option<(ResourceId, Vec<Held>)> {
        let (resource, _) = self.waits_for(holder, serial)?;
        let first = self.lines[resource].before(holder, serial).filter(|h| h.holder != holder);
        Some((resource, first.map(|h| self.held(h)).collect()))
    }

    fn held(&self, h: &Hold) -> Held {
        let granted = self.chains.get(&h.holder).is_some_and(|c| h.serial < c.granted);
        Held { holder: h.holder, window: Window::new(h.start, h.end), layer: h.layer, granted }
    }
}
