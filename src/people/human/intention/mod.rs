//! Where a person is going, with what probability.
//!
//! Main types: [`Intention`] (one person's recogniser; [`Method`] chooses which), [`Belief`] (its probabilities),
//! [`TileIntention`] (the published static method on small grids, for actions). Refuses: to decide anything. A belief
//! is honest only as far as its goals are known; *elsewhere* is the rest.

mod chain;
mod detour;
mod motion;
mod published;
mod report;
mod sequence;
mod tile;

#[cfg(test)]
mod tests;

pub use detour::{DetourPlace, PurposeModel};
pub use report::{Credible, reported_goals};
pub use sequence::{IntentEpisode, IntentState};
pub use tile::TileIntention;

use super::{Distances, Model};
use detour::Detour;
use giveway_floor::geometry::Point;
use giveway_floor::id::GoalId;
use giveway_floor::time::Time;
use published::{Chapter, Published};
use sequence::IntentSequence;
use tile::TileWalker;

/// The method of recognising goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Petković 2021, sections 3.3 and 3.4: states for goals, *undecided* and *elsewhere*; nine goals at most.
    Chapter3,
    /// The states of chapter 3, with steps judged by a Markov decision process on tiles (section 3.2): small floors
    /// only, and robots block nothing.
    Chapter3Tiles,
    /// Petković 2021, section 4.3.2: states for goals only, among them the end of the person's own path.
    Chapter4,
    /// Our method: metres of detour as log-likelihood, changes of mind per time, the worker's task as prior,
    /// *elsewhere*.
    Detour,
}

/// Error: the method cannot tell that many goals apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this method has room for {at_most} goals")]
pub struct TooManyGoals {
    /// Largest number of goals for the method.
    pub at_most: usize,
}

impl Method {
    /// Whether the method is chapter 3 of the thesis, with either validator.
    pub fn is_chapter_three(self) -> bool {
        matches!(self, Method::Chapter3 | Method::Chapter3Tiles)
    }
}

/// Probabilities that sum to one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Belief {
    /// Probability of each goal, sorted by id.
    pub goals: Vec<(GoalId, f64)>,
    /// Probability of preferring several goals; only chapter 3 has such a state.
    pub undecided: f64,
    /// Probability of going to none of the goals.
    pub elsewhere: f64,
}

/// One person's recogniser.
#[derive(Clone, Debug)]
pub struct Intention {
    inner: Inner,
}

#[derive(Clone, Debug)]
enum Inner {
    Published(Box<Published>),
    Tiles(Box<TileWalker>),
    Detour(Box<Detour>),
}

impl Intention {
    /// A recogniser without goals and observations. The published methods have figures of their own.
    pub fn new(method: Method, model: &Model) -> Intention {
        let inner = match method {
            Method::Chapter3 => Inner::Published(Box::new(Published::new(Chapter::Three))),
            Method::Chapter3Tiles => Inner::Tiles(Box::new(TileWalker::new())),
            Method::Chapter4 => Inner::Published(Box::new(Published::new(Chapter::Four))),
            Method::Detour => Inner::Detour(Box::new(Detour::new(model.purpose.clone(), model.motion))),
        };
        Intention { inner }
    }

    /// Adds a goal, at any time. `weight` is how much more probable than others it is at first (the worker's own task
    /// has more than 1); the published methods ignore it.
    pub fn add_goal(&mut self, goal: GoalId, weight: f64) -> Result<(), TooManyGoals> {
        match &mut self.inner {
            Inner::Published(p) => p.add_goal(goal),
            Inner::Tiles(t) => t.person_mut().add_goal(goal),
            Inner::Detour(d) => {
                d.add_goal(goal, weight);
                Ok(())
            }
        }
    }

    /// Removes a goal; its probability goes to *undecided*, or to *elsewhere* if there is no such state.
    pub fn remove_goal(&mut self, goal: GoalId) {
        match &mut self.inner {
            Inner::Published(p) => p.remove_goal(goal),
            Inner::Tiles(t) => t.person_mut().remove_goal(goal),
            Inner::Detour(d) => d.remove_goal(goal),
        }
    }

    /// Sets where the person has work to do, if anywhere: a person there stays until it is done. The published methods
    /// have no such notion.
    pub fn has_work_at(&mut self, goal: Option<GoalId>) {
        if let Inner::Detour(d) = &mut self.inner {
            d.has_work_at(goal);
        }
    }

    /// Whether there are more goals than the method was found to tell apart well.
    pub fn is_doubtful(&self) -> bool {
        match &self.inner {
            Inner::Published(p) => p.is_doubtful(),
            Inner::Tiles(t) => t.person().chain().goals().count() > published::GOALS_WELL,
            Inner::Detour(_) => false,
        }
    }

    /// Processes a pose. Poses may come at any rate; most change nothing until the person has moved on.
    ///
    /// Goals must also be known to `distances`; `heading` is where the person faces, radians, if known. Chapter 3 uses
    /// it; ours uses the walked course, because heads look aside.
    ///
    /// # Panics
    /// If the method needs tiles and the distances have none.
    pub fn observe(&mut self, seen: Time, at: Point, heading: Option<f64>, distances: &Distances) {
        match &mut self.inner {
            Inner::Published(p) => p.observe(seen, at, heading, distances),
            Inner::Tiles(t) => {
                let tiles = distances.tiles().expect("the method was chosen for a floor with tiles");
                t.observe(seen, at, heading, tiles);
            }
            Inner::Detour(d) => d.observe(seen, at, distances),
        }
    }

    /// Sets the accuracy of positions, as one standard deviation in metres: steps of that size are ignored. The
    /// published methods have no such notion.
    pub fn expect_error(&mut self, sigma_m: f64) {
        if let Inner::Detour(d) = &mut self.inner {
            d.expect_error(sigma_m);
        }
    }

    /// The present belief.
    pub fn belief(&self) -> Belief {
        match &self.inner {
            Inner::Published(p) => p.chain().belief(),
            Inner::Tiles(t) => t.person().belief(),
            Inner::Detour(d) => d.belief(),
        }
    }

    /// The most probable sequence of states, oldest first: one before the first update, and one for each update.
    pub fn sequence(&self) -> Vec<IntentState> {
        self.best().states()
    }

    /// The most probable sequence as stretches of one state, with their times.
    pub fn episodes(&self) -> Vec<IntentEpisode> {
        self.best().episodes()
    }

    fn best(&self) -> &IntentSequence {
        match &self.inner {
            Inner::Published(p) => p.chain().sequence(),
            Inner::Tiles(t) => t.person().chain().sequence(),
            Inner::Detour(d) => d.sequence(),
        }
    }
}
