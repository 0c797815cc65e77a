//! Identifiers: one newtype per kind of thing, and [`IdVec`], a vector indexed by one kind only.
//!
//! Dense ids (nodes, lanes, robots, …) are positions in an [`IdVec`]; [`JobId`] and its like grow for ever.
//! Refuses: arithmetic on ids, and using one kind of id where another is meant.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

/// A dense id: a position in an [`IdVec`].
pub trait Dense: Copy {
    /// The id at position `i`.
    fn at(i: usize) -> Self;
    /// The position.
    fn ix(self) -> usize;
}

macro_rules! dense {
    ($($(#[$doc:meta])* $name:ident $letter:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl Dense for $name {
            fn at(i: usize) -> Self {
                $name(u32::try_from(i).expect("fewer than 2^32 of a kind"))
            }
            fn ix(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($letter, "{}"), self.0)
            }
        }
    )*};
}

dense! {
    /// A node of the resource graph: a place where a robot can stand.
    NodeId "n";
    /// A lane between two nodes, whichever way it is driven.
    LaneId "l";
    /// A lane driven in one direction.
    ArcId "a";
    /// A node or a lane, as a thing that is held: nodes first, then lanes.
    ResourceId "x";
    /// A resource as robots with one footprint see it: each has a timeline of its own.
    LineId "t";
    /// A kind of robots, as the building knows it.
    BodyId "b";
    /// A robot.
    RobotId "r";
    /// A rack.
    RackId "k";
    /// An arrangement of the bins of racks.
    RackTypeId "y";
    /// A picking station.
    StationId "s";
    /// A worker.
    WorkerId "w";
    /// A node of the walkways: a point on the middle line of the free floor.
    WalkNodeId "f";
    /// An edge of the walkways.
    WalkEdgeId "e";
}

macro_rules! counted {
    ($($(#[$doc:meta])* $name:ident $letter:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u64);

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($letter, "{}"), self.0)
            }
        }
    )*};
}

counted! {
    /// A customer that submits jobs, as a digest of the name.
    CustomerId "c";
    /// A job, numbered in the order of acceptance, starting at 1.
    JobId "j";
    /// An assignment of a worker, numbered in the order of acceptance, starting at 1.
    AssignmentId "as";
    /// A closed area, numbered in the order of marking, starting at 1.
    ClosureId "cl";
    /// A recurring closure, numbered in the order of marking, starting at 1.
    SeriesId "cs";
    /// A place where a person may be going: goals come and go, so these are numbers and not positions.
    GoalId "g";
}

/// A vector indexed by one kind of dense id.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct IdVec<I, T> {
    items: Vec<T>,
    kind: PhantomData<fn(I)>,
}

impl<I: Dense, T> IdVec<I, T> {
    /// An empty vector.
    pub const fn new() -> Self {
        IdVec { items: Vec::new(), kind: PhantomData }
    }

    /// `n` copies of `item`.
    pub fn filled(item: T, n: usize) -> Self
    where
        T: Clone,
    {
        vec![item; n].into()
    }

    /// Appends and returns the new id.
    pub fn push(&mut self, item: T) -> I {
        self.items.push(item);
        I::at(self.items.len() - 1)
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there are no items.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The item, or nothing if the id is out of range.
    pub fn get(&self, i: I) -> Option<&T> {
        self.items.get(i.ix())
    }

    /// All ids, in order.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + use<I, T> {
        (0..self.items.len()).map(I::at)
    }

    /// All items, in order of their ids.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.items.iter()
    }

    /// All items, mutably.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.items.iter_mut()
    }

    /// Ids with their items.
    pub fn pairs(&self) -> impl DoubleEndedIterator<Item = (I, &T)> {
        self.items.iter().enumerate().map(|(i, t)| (I::at(i), t))
    }
}

impl<I: Dense, T> Default for IdVec<I, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<I, T> From<Vec<T>> for IdVec<I, T> {
    fn from(items: Vec<T>) -> Self {
        IdVec { items, kind: PhantomData }
    }
}

impl<I: Dense, T> FromIterator<T> for IdVec<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(iter: It) -> Self {
        iter.into_iter().collect::<Vec<_>>().into()
    }
}

impl<I: Dense, T> Index<I> for IdVec<I, T> {
    type Output = T;
    fn index(&self, i: I) -> &T {
        &self.items[i.ix()]
    }
}

impl<I: Dense, T> IndexMut<I> for IdVec<I, T> {
    fn index_mut(&mut self, i: I) -> &mut T {
        &mut self.items[i.ix()]
    }
}

impl<I, T: fmt::Debug> fmt::Debug for IdVec<I, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.items.fmt(f)
    }
}
