//! Labels of the search and their storage.
//!
//! Main types: [`Label`], [`Labels`] (an arena with, per node, free window and stage, the list of undominated labels).
//! Refuses: to know what labels are good for.

use super::motion::MotionState;
use crate::id::{ArcId, NodeId};
use crate::timeline::FreeWindow;

/// Label index that means "none".
pub(super) const NONE: u32 = u32::MAX;
/// Number of rolling labels of one node, free window, stage and heading that are kept: they differ only in how long the
/// start of their run can still be delayed, and beyond a few that never decides anything.
const INTERVALS: usize = 4;
/// The arrival heading of a robot that starts with a heading of its own.
pub(super) const OWN_HEADING: u8 = u8::MAX;

/// A state of the search: at a node in one of its free windows, with a heading and a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    /// Earliest arrival (or readiness, after a stop), microseconds.
    pub lo: i64,
    /// Latest arrival that the windows on the way allow, for rolling labels.
    pub hi: i64,
    pub node: NodeId,
    pub free: FreeWindow,
    pub slot: u8,
    pub motion: MotionState,
    pub stage: u8,
    /// Whether the window is for a robot with a rack, where that makes a difference.
    pub loaded: bool,
    /// When the first goal was reached; zero before that.
    pub first: i64,
    /// Duration of the drive to here, microseconds.
    pub span: i64,
    /// Cost of the route to here beyond its time, microseconds.
    pub price: i64,
    pub dominated: bool,
    /// Index of the previous label, or [`NONE`].
    pub parent: u32,
    /// The arc driven to get here; nothing after a stop at a goal.
    pub arc: Option<ArcId>,
    /// The next label of the same node, free window and stage.
    next: u32,
}

impl Label {
    #[allow(clippy::too_many_arguments, reason = "a label is a plain record; its list link stays private")]
    pub fn new(
        (lo, hi): (i64, i64),
        node: NodeId,
        free: FreeWindow,
        slot: u8,
        motion: MotionState,
        stage: u8,
        parent: u32,
        arc: Option<ArcId>,
    ) -> Label {
        Label {
            lo,
            hi,
            node,
            free,
            slot,
            motion,
            stage,
            loaded: false,
            parent,
            arc,
            first: 0,
            span: 0,
            price: 0,
            dominated: false,
            next: NONE,
        }
    }

    /// This label with the time at which the first goal was reached.
    pub fn with_first(self, first: i64) -> Label {
        Label { first, ..self }
    }

    /// This label in a window for a robot with a rack, or for one without.
    pub fn with_room(self, loaded: bool) -> Label {
        Label { loaded, ..self }
    }

    /// This label with the duration and cost of the route to it.
    pub fn with_way(self, span: i64, price: i64) -> Label {
        Label { span, price, ..self }
    }

    fn key(&self) -> u64 {
        let window = u64::from(self.free.index) << 1 | u64::from(self.loaded);
        u64::from(self.node.0) << 32 | window << 4 | u64::from(self.stage)
    }
}

#[derive(Clone, Copy, Debug)]
struct LabelSlot {
    key: u64,
    head: u32,
    generation: u32,
}

/// All labels of one search. Clearing is free: slots carry the generation of the search that wrote them.
#[derive(Clone, Debug)]
pub(super) struct Labels {
    arena: Vec<Label>,
    slots: Vec<LabelSlot>,
    used: usize,
    generation: u32,
}

impl Default for Labels {
    fn default() -> Labels {
        let empty = LabelSlot { key: 0, head: NONE, generation: 0 };
        Labels { arena: Vec::new(), slots: vec![empty; 1 << 12], used: 0, generation: 1 }
    }
}

impl Labels {
    pub fn clear(&mut self) {
        self.arena.clear();
        self.used = 0;
        self.generation = self.generation.checked_add(1).unwrap_or_else(|| {
            self.slots.iter_mut().for_each(|s| s.generation = 0);
            1
        });
    }

    pub fn get(&self, index: u32) -> &Label {
        &self.arena[index as usize]
    }

    /// Adds a label unless one of its list dominates it; labels that it dominates are marked. `dominates(a, b)` tells
    /// whether `a` is at least as good as `b` in every respect.
    pub fn add(&mut self, label: Label, dominates: impl Fn(&Label, &Label) -> bool) -> Option<u32> {
        if self.used * 2 > self.slots.len() {
            self.grow();
        }
        let at = self.find(label.key());
        let fresh = self.slots[at].generation != self.generation;
        let head = if fresh { NONE } else { self.slots[at].head };
        let (mut i, mut head, mut link) = (head, head, NONE);
        let mut rolling = 0;
        while i != NONE {
            let known = &self.arena[i as usize];
            let after = known.next;
            if dominates(known, &label) {
                return None;
            }
            if known.motion == label.motion
                && known.motion == MotionState::Rolling
                && known.slot == label.slot
            {
                rolling += 1;
                if rolling >= INTERVALS && known.lo <= label.lo {
                    return None;
                }
            }
            if dominates(&label, known) {
                self.arena[i as usize].dominated = true;
                // A dominated label is never looked at again: take it out of the list.
                match link {
                    NONE => head = after,
                    l => self.arena[l as usize].next = after,
                }
            } else {
                link = i;
            }
            i = after;
        }
        let index = self.arena.len() as u32;
        self.arena.push(Label { next: head, ..label });
        self.slots[at] = LabelSlot { key: label.key(), head: index, generation: self.generation };
        self.used += usize::from(fresh);
        Some(index)
    }

    /// The slot of a key, or the free one where it belongs (linear probing).
    fn find(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[at].generation == self.generation && self.slots[at].key != key {
            at = (at + 1) & mask;
        }
        at
    }

    fn grow(&mut self) {
        let empty = LabelSlot { key: 0, head: NONE, generation: 0 };
        let old = std::mem::take(&mut self.slots);
        self.slots = vec![empty; old.len() * 2];
        for slot in old.into_iter().filter(|s| s.generation == self.generation) {
            let at = self.find(slot.key);
            self.slots[at] = slot;
        }
    }
}
