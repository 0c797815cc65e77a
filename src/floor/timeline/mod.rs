//! Which robot holds which resource when, and what is free in between.
//!
//! Main types: [`Timeline`] (all holds of all holders), [`Overlay`] (a timeline as a search sees it), [`Visit`] (a stay
//! on one node as a holder plans it), [`FreeWindow`] (when a resource is free), [`Reserved`] (the proof that visits are
//! held; only this module makes one). Refuses: to hold anything twice, to forget which holder was promised a resource
//! first, and to know why a holder wants to be anywhere.
//!
//! Each resource has a list of holds sorted by start. If robots differ in footprint, it has one list for each footprint
//! ([`crate::id::LineId`]), and a robot uses the list for its own. A hold on a resource is also in the list of
//! everything that it excludes, marked [`Layer::Conflict`]: a plan writes a few hundred holds but reads thousands, so
//! writes are widened and reads are not. Lists stay short (tens of holds), so a sorted vector with binary search beats
//! a tree.

mod advance;
mod chains;
mod delay;
mod entries;
mod held;
mod line;
mod overlay;
mod refit;
mod restore;
mod truncate;

pub use delay::{Shift, Slip};
pub use held::Held;
pub use line::{FreeWindow, Layer};
pub use overlay::Overlay;
pub use restore::{ChainParts, Flaw};
pub use truncate::KeptVisits;

use crate::id::{BodyId, Dense, IdVec, LineId, NodeId, ResourceId, RobotId};
use crate::time::{Span, Time, Window};
use crate::warehouse::Warehouse;
use chains::Chains;
use entries::claims;
use line::Line;
use std::collections::VecDeque;
use std::sync::Arc;

/// A stay on one node, with the lane that leads to it.
///
/// `enter ≤ arrive ≤ depart ≤ leave`. The node is held during `[enter, leave)`: from the moment in which the holder
/// begins to move towards it (or must be sure of it, because it could no longer brake) until its tail has left. The
/// lane is held during `[enter, arrive + clearance)` if it needs holding at all.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Visit {
    /// The node.
    pub node: NodeId,
    /// The lane driven to get here, if that lane is in conflict with anything beyond its ends.
    pub lane: Option<ResourceId>,
    /// Whether node and lane are held for a robot with a rack: the robot comes with one, or leaves with one.
    pub loaded: bool,
    /// When the hold on node and lane begins.
    pub enter: Time,
    /// When the centre of the node is reached.
    pub arrive: Time,
    /// When the holder starts to leave; for ever at the last visit.
    pub depart: Time,
    /// When the hold on the node ends; for ever at the last visit.
    pub leave: Time,
    /// How long the holder must stay between `arrive` and `depart`: to turn, lift, be picked from.
    pub stay: Span,
}

impl Visit {
    /// The window in which the node is held.
    #[inline]
    pub fn window(&self) -> Window {
        Window::new(self.enter, self.leave)
    }

    /// How much of a delay this visit absorbs by waiting less.
    #[inline]
    pub fn slack(&self) -> Span {
        if self.depart.is_forever() { Span::MAX } else { self.depart - self.arrive - self.stay }
    }
}

/// The proof that visits are held. Only with it may a holder be told to drive them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reserved {
    holder: RobotId,
    first: u64,
    count: usize,
}

impl Reserved {
    /// The holder.
    #[inline]
    pub fn holder(&self) -> RobotId {
        self.holder
    }

    /// Serial numbers of the visits, see [`Chain::serial_of`].
    #[inline]
    pub fn serials(&self) -> std::ops::Range<u64> {
        self.first..self.first + self.count as u64
    }

    /// The proof for the first of these visits alone.
    pub fn first_alone(self) -> Reserved {
        Reserved { count: self.count.min(1), ..self }
    }
}

/// Two holders want one resource at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clash {
    /// The resource that both want.
    pub resource: ResourceId,
    /// When the resource was wanted.
    pub wanted: Window,
    /// The holder that has the resource.
    pub by: RobotId,
    /// When the resource is held.
    pub held: Window,
}

/// The visits of one holder, oldest first. Each has a serial number that never changes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Chain {
    first: u64,
    visits: VecDeque<Visit>,
    granted: u64,
    /// Whether the holder has left the floor: its last visit is known but holds nothing.
    absent: bool,
}

impl Chain {
    /// Whether the holder has left the floor.
    #[inline]
    pub fn is_absent(&self) -> bool {
        self.absent
    }

    /// Serial number of the visit at `index`.
    #[inline]
    pub fn serial_of(&self, index: usize) -> u64 {
        self.first + index as u64
    }

    /// Serial number of the oldest visit still held.
    #[inline]
    pub fn first(&self) -> u64 {
        self.first
    }

    /// One past the serial number of the last visit.
    #[inline]
    pub fn end(&self) -> u64 {
        self.first + self.visits.len() as u64
    }

    /// One past the serial number of the last granted visit.
    #[inline]
    pub fn granted(&self) -> u64 {
        self.granted
    }

    /// The visit with this serial number, if it is still held.
    #[inline]
    pub fn get(&self, serial: u64) -> Option<&Visit> {
        self.visits.get(usize::try_from(serial.checked_sub(self.first)?).ok()?)
    }

    /// The visits still held, oldest first.
    #[inline]
    pub fn visits(&self) -> impl DoubleEndedIterator<Item = &Visit> + ExactSizeIterator {
        self.visits.iter()
    }

    /// The last visit.
    #[inline]
    pub fn last(&self) -> Option<&Visit> {
        self.visits.back()
    }
}

/// A holder, the serial number of the visit that it keeps, that visit with new times, and the visits after it.
pub type Replacement = (RobotId, u64, Visit, Vec<Visit>);

/// All holds of all holders. Equal timelines hold the same.
#[derive(Clone, Debug)]
pub struct Timeline {
    warehouse: Arc<Warehouse>,
    clearance: Span,
    lines: IdVec<LineId, Line>,
    chains: Chains,
    /// The kind of each robot. Robots beyond the end are of the first kind.
    bodies: Vec<BodyId>,
    /// Whether holders pass through one another; only for the bound on throughput.
    without_conflicts: bool,
}

impl PartialEq for Timeline {
    fn eq(&self, o: &Timeline) -> bool {
        self.chains == o.chains && self.clearance == o.clearance
    }
}

impl Timeline {
    /// An empty timeline. `clearance` is the time by which a hold outlasts the moment in which the tail has left;
    /// strictly positive on a real floor, so that no ring of robots can rotate (DESIGN §5, invariant b).
    pub fn new(warehouse: Arc<Warehouse>, clearance: Span) -> Timeline {
        let lines = IdVec::filled(Line::default(), warehouse.line_count());
        let (chains, bodies) = (Chains::default(), Vec::new());
        Timeline { warehouse, clearance, lines, chains, bodies, without_conflicts: false }
    }

    /// A timeline on which holders pass through one another everywhere except at stations, where there is still only
    /// one person to pick: it gives the bound on throughput (DESIGN §8).
    pub fn without_conflicts(warehouse: Arc<Warehouse>, clearance: Span) -> Timeline {
        Timeline { without_conflicts: true, ..Timeline::new(warehouse, clearance) }
    }

    /// The building.
    #[inline]
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        &self.warehouse
    }

    /// How long a hold outlasts the moment in which the tail has left.
    pub fn clearance(&self) -> Span {
        self.clearance
    }

    /// Sets the kind of a robot, before it holds anything.
    ///
    /// # Panics
    /// If the robot holds something.
    pub fn set_body(&mut self, robot: RobotId, body: BodyId) {
        let holds = self.chain(robot).is_some_and(|chain| !chain.absent);
        assert!(!holds, "{robot:?} holds as another kind");
        if self.bodies.len() <= robot.ix() {
            self.bodies.resize(robot.ix() + 1, BodyId(0));
        }
        self.bodies[robot.ix()] = body;
    }

    /// The kind of a holder.
    #[inline]
    pub fn body(&self, holder: RobotId) -> BodyId {
        self.bodies.get(holder.ix()).copied().unwrap_or(BodyId(0))
    }

    /// The timeline of a resource that a holder uses, without or with a rack.
    #[inline]
    pub fn line(&self, holder: RobotId, loaded: bool, r: ResourceId) -> LineId {
        self.warehouse.line(self.body(holder), loaded, r)
    }

    /// All holders with their visits; for one that has left the floor, the place where it stood last.
    #[inline]
    pub fn chains(&self) -> impl Iterator<Item = (RobotId, &Chain)> {
        self.chains.iter()
    }

    /// The visits of one holder.
    #[inline]
    pub fn chain(&self, holder: RobotId) -> Option<&Chain> {
        self.chains.get(&holder)
    }

    /// The other holders with a hold, on a resource or on something in conflict with it, that meets `window`.
    pub fn holders_during(
        &self,
        line: LineId,
        window: Window,
        own: RobotId,
    ) -> impl Iterator<Item = RobotId> {
        self.lines[line].during(window).map(|h| h.holder).filter(move |h| *h != own)
    }

    /// Puts a holder on the floor with its first visits.
    ///
    /// # Errors
    /// The first clash; then nothing is held.
    pub fn reserve(&mut self, holder: RobotId, visits: Vec<Visit>) -> Result<Reserved, Clash> {
        assert!(!visits.is_empty(), "{holder:?} reserves nothing");
        assert!(!self.chains.contains_key(&holder), "{holder:?} stands somewhere already");
        self.check(holder, &visits)?;
        let count = visits.len();
        self.chains.insert(holder, Chain::default());
        self.put(holder, visits);
        self.assert_in_order(holder);
        Ok(Reserved { holder, first: 0, count })
    }

    /// Replaces everything after the visit `keep` by new visits. The kept visit takes its new `depart` and `leave` (and
    /// `stay`) from `kept`.
    ///
    /// # Errors
    /// The first clash; then everything is as before.
    ///
    /// # Panics
    /// If `keep` is not a visit of the holder or granted visits would be lost.
    pub fn replace(
        &mut self,
        holder: RobotId,
        keep: u64,
        kept: Visit,
        visits: Vec<Visit>,
    ) -> Result<Reserved, Clash> {
        let reserved = self.replace_all(vec![(holder, keep, kept, visits)])?;
        Ok(reserved.into_iter().next().expect("one in, one out"))
    }

    /// As [`Timeline::replace`] for several holders at once: each may be promised what another of them gives up.
    ///
    /// # Errors
    /// The first clash; then everything is as before.
    ///
    /// # Panics
    /// As [`Timeline::replace`].
    pub fn replace_all(&mut self, routes: Vec<Replacement>) -> Result<Vec<Reserved>, Clash> {
        let mut old = Vec::new();
        for (holder, keep, kept, _) in &routes {
            let chain = &self.chains[holder];
            let before = chain.get(*keep).expect("the kept visit is one of the holder's");
            assert_eq!(before.node, kept.node, "{holder:?} replaces its route from where it is not");
            assert!(chain.granted <= keep + 1, "{holder:?} was granted more than it wants to keep");
            old.push((*holder, *keep, self.take_from(*holder, *keep)));
        }
        let mut reserved = Vec::new();
        let ends: Vec<_> =
            routes.iter().map(|(holder, keep, kept, _)| (*holder, *keep, kept.leave)).collect();
        for (holder, keep, kept, visits) in routes {
            let count = visits.len();
            let wanted: Vec<Visit> = std::iter::once(kept).chain(visits).collect();
            if let Err(clash) = self.check(holder, &wanted) {
                old.iter().for_each(|(h, k, _)| drop(self.take_from(*h, *k)));
                old.into_iter().for_each(|(h, _, visits)| self.put(h, visits));
                return Err(clash);
            }
            self.put(holder, wanted);
            reserved.push(Reserved { holder, first: keep + 1, count });
        }
        for (holder, keep, leave) in ends {
            self.end_by(holder, keep, leave);
            self.assert_in_order(holder);
        }
        Ok(reserved)
    }

    /// Ends the holds on visits before `keep` by `leave`: a broken robot kept them for ever, and now drives on.
    fn end_by(&mut self, holder: RobotId, keep: u64, leave: Time) {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        let chain = self.chains.get_mut(&holder).expect("only holders replace");
        let first = chain.first;
        for (serial, visit) in (first..keep).zip(&mut chain.visits).filter(|(_, v)| v.leave > leave) {
            Self::erase(&mut self.lines, context, holder, serial, visit);
            visit.leave = leave;
            Self::write(&mut self.lines, context, holder, serial, visit);
        }
    }

    /// Drops the visits before `serial`, which the holder has left.
    pub fn release(&mut self, holder: RobotId, serial: u64) {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        let chain = self.chains.get_mut(&holder).expect("only holders release");
        assert!(serial < chain.end(), "{holder:?} must stay somewhere");
        while chain.first < serial {
            let visit = chain.visits.pop_front().expect("serial < end");
            Self::erase(&mut self.lines, context, holder, chain.first, &visit);
            chain.first += 1;
        }
        chain.granted = chain.granted.max(chain.first);
        // A holder that stands on a node is off the lane that led there.
        let (first, here) = (chain.first, &mut chain.visits[0]);
        if here.lane.is_some() {
            Self::erase(&mut self.lines, context, holder, first, here);
            here.lane = None;
            Self::write(&mut self.lines, context, holder, first, here);
        }
        self.assert_in_order(holder);
    }

    /// Removes a holder that has left the floor: it holds nothing any more. Its last place, and the numbers of its
    /// visits, stay known: it may be placed again.
    pub fn depart(&mut self, holder: RobotId) {
        let first = self.chains.get(&holder).expect("only holders leave").first;
        let mut visits = self.take_from(holder, first);
        visits.truncate(1);
        let chain = self.chains.get_mut(&holder).expect("just seen");
        let here = visits.first_mut().expect("it stood somewhere");
        (here.depart, here.leave, here.lane) = (Time::MAX, Time::MAX, None);
        (chain.granted, chain.absent) = (first + 1, true);
        chain.visits.extend(visits);
    }

    /// Removes a holder altogether, with the numbers of its visits.
    pub fn remove(&mut self, holder: RobotId) {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        if let Some(mut chain) = self.chains.remove(&holder) {
            while let Some(visit) = chain.visits.pop_front() {
                Self::erase(&mut self.lines, context, holder, chain.first, &visit);
                chain.first += 1;
            }
        }
    }

    /// The holders that come after a visit in the order of its resources.
    pub fn after(&self, holder: RobotId, serial: u64) -> Vec<RobotId> {
        let Some(visit) = self.chains.get(&holder).and_then(|c| c.get(serial)) else { return Vec::new() };
        let mut found: Vec<RobotId> = (claims(self.context(&self.warehouse, holder), visit))
            .flat_map(|(l, _)| std::iter::once(l).chain(self.warehouse.lines_in_conflict(l).iter().copied()))
            .flat_map(|r| self.lines[r].followers(holder, serial).map(|h| h.holder))
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The proof that a holder may drive up to its last granted visit.
    #[inline]
    pub fn granted(&self, holder: RobotId) -> Option<Reserved> {
        let chain = self.chains.get(&holder)?;
        Some(Reserved { holder, first: chain.first, count: (chain.granted - chain.first) as usize })
    }

    /// The resource and the first other holder that `holder` waits for before it may have the visit `serial`, in the
    /// order of the node, of the lane, or of anything in conflict with them.
    pub fn waits_for(&self, holder: RobotId, serial: u64) -> Option<(ResourceId, RobotId)> {
        let visit = self.chains.get(&holder)?.get(serial)?;
        let node = self.warehouse.node_resource(visit.node);
        std::iter::once(node).chain(visit.lane).find_map(|r| {
            let line = self.line(holder, visit.loaded, r);
            Some((r, self.lines[line].first_before(holder, serial)?))
        })
    }

    /// Marks visits up to and including `serial` as granted: the holder may be there from `now` on, so the holds
    /// begin no later than `now`.
    ///
    /// # Panics
    /// If another holder is before this one in the order of a resource.
    pub fn grant(&mut self, holder: RobotId, serial: u64, now: Time) {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        let from = self.chains[&holder].granted;
        for s in from..=serial {
            assert_eq!(self.waits_for(holder, s), None, "{holder:?} is granted what others hold before it");
            let chain = self.chains.get_mut(&holder).expect("checked above");
            let visit = &mut chain.visits[(s - chain.first) as usize];
            if visit.enter > now {
                Self::erase(&mut self.lines, context, holder, s, visit);
                visit.enter = now;
                Self::write(&mut self.lines, context, holder, s, visit);
            }
            chain.granted = s + 1;
        }
        self.assert_in_order(holder);
    }

    /// Marks the visits after `serial` as held only: the holder will not be there before they are granted anew.
    ///
    /// # Panics
    /// If `serial` is not granted.
    pub fn revoke(&mut self, holder: RobotId, serial: u64) {
        let chain = self.chains.get_mut(&holder).expect("only holders have grants");
        assert!((chain.first..chain.granted).contains(&serial), "{holder:?} keeps what it was granted");
        chain.granted = serial + 1;
    }

    /// Removes and returns the visits from `serial` on.
    fn take_from(&mut self, holder: RobotId, serial: u64) -> Vec<Visit> {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        let chain = self.chains.get_mut(&holder).expect("only holders replace");
        let old: Vec<Visit> = chain.visits.drain((serial - chain.first) as usize..).collect();
        for (i, v) in old.iter().enumerate() {
            Self::erase(&mut self.lines, context, holder, serial + i as u64, v);
        }
        old
    }

    fn put(&mut self, holder: RobotId, visits: impl IntoIterator<Item = Visit>) {
        let warehouse = self.warehouse.clone();
        let context = self.context(&warehouse, holder);
        let chain = self.chains.get_mut(&holder).expect("only holders replace");
        for v in visits {
            Self::write(&mut self.lines, context, holder, chain.end(), &v);
            chain.visits.push_back(v);
        }
    }

    /// The first clash of visits with the holds of others.
    fn check(&self, holder: RobotId, visits: &[Visit]) -> Result<(), Clash> {
        self.view().check(holder, visits)
    }

    /// Asserts that no resource is held twice and that every chain is in order. For laws and tests: checks everything.
    pub fn assert_sound(&self) {
        for l in self.lines.ids() {
            self.lines[l].assert_sound(|| self.warehouse.resource_name(self.warehouse.resource_of(l)));
        }
        self.chains.iter().for_each(|(holder, _)| self.assert_in_order(holder));
    }

    /// Asserts that the visits of a holder follow one another and that granted visits are held: after every change of a
    /// chain, in every build. O(its visits).
    fn assert_in_order(&self, holder: RobotId) {
        let chain = &self.chains[&holder];
        for (a, b) in chain.visits.iter().zip(chain.visits.iter().skip(1)) {
            assert!(in_order(a, b), "{holder:?} has visits out of order: {a:?} then {b:?}");
        }
        let granted = chain.first..=chain.end();
        assert!(granted.contains(&chain.granted), "{holder:?} was granted visits that it does not hold");
    }
}

/// Whether two visits of one holder can follow one another: it is at the second before it has left the first. The first
/// may be held for longer than the second: a repaired robot gives back at once all places that it broke down on, and a
/// delay then moves the end of the first by more than that of the second, which waits less.
fn in_order(a: &Visit, b: &Visit) -> bool {
    a.enter <= b.enter && a.arrive <= a.depart && b.enter <= b.arrive && b.arrive <= a.leave
}

#[cfg(test)]
mod tests;
