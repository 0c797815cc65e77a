//! The published static method: state values on tiles judge a person's actions (Petković 2021, sections 3.2 and 3.4).
//!
//! Main types: [`TileIntention`] (the recogniser for actions), [`TileWalker`] (for poses, which it turns into actions).
//! Refuses: to see what robots block, since state values are of an empty floor.

use super::chain::IntentBelief;
use super::published::{Evidence, add_goal_of_chapter_three, weigh_chapter_three};
use super::sequence::IntentState;
use super::{Belief, TooManyGoals};
use crate::human::tiles::{Action, Stand, Tiles};
use giveway_floor::geometry::{Point, Segment, turn_between};
use giveway_floor::id::GoalId;
use giveway_floor::time::{Span, Time};
use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};

/// Number of actions to judge, one a second, before a person is called irrational.
const PATIENCE: i64 = 3;
/// After this long without movement, the person is taken to stay.
const STAYS: Span = Span::from_secs(1);
/// A person who has come this far is walking, if only slowly, metres.
const STANDS_M: f64 = 0.3;
/// A person changes tile when the new one is nearer than the last by this much, metres: sway is no step.
const SWAY_M: f64 = 0.2;
/// A person changes heading when the head is turned by this much more than half an eighth, radians.
const LOOK: f64 = 0.15;
/// Largest number of tiles and eighths from one pose to the next; farther ones begin anew.
const STRIDE: usize = 4;

/// The recogniser for actions on tiles.
#[derive(Clone, Debug)]
pub struct TileIntention {
    chain: IntentBelief,
    evidence: Evidence,
    steps: i64,
}

impl TileIntention {
    /// A recogniser without goals and observations.
    pub(super) fn without_goals() -> TileIntention {
        let evidence = Evidence::new(Span::from_secs(PATIENCE));
        TileIntention { chain: IntentBelief::undecided(), evidence, steps: 0 }
    }

    /// A recogniser without observations; the goals are those of the tiles.
    ///
    /// # Errors
    /// If the tiles have more goals than the method has room for.
    pub fn new(tiles: &Tiles) -> Result<TileIntention, TooManyGoals> {
        let mut fresh = TileIntention::without_goals();
        tiles.goals().try_for_each(|g| fresh.add_goal(g))?;
        Ok(fresh)
    }

    pub(super) fn add_goal(&mut self, goal: GoalId) -> Result<(), TooManyGoals> {
        add_goal_of_chapter_three(&mut self.chain, goal, self.steps == 0)
    }

    pub(super) fn chain(&self) -> &IntentBelief {
        &self.chain
    }

    pub(super) fn remove_goal(&mut self, goal: GoalId) {
        self.chain.remove_goal(goal, IntentState::Undecided);
    }

    /// Processes an action.
    pub fn observe(&mut self, tiles: &Tiles, s: Stand, action: Action) {
        self.steps += 1;
        self.judge(tiles, s, action, Time::ZERO + Span::from_secs(self.steps));
    }

    /// Processes an action that ended at `seen`.
    fn judge(&mut self, tiles: &Tiles, s: Stand, action: Action, seen: Time) {
        let goals: Vec<GoalId> = self.chain.goals().collect();
        let v = tiles.validate(s, action, &goals);
        let step = Time::ZERO + Span::from_secs(self.steps);
        let goes_nowhere = self.evidence.add(step, goals.into_iter().zip(v.iter().copied()).collect());
        weigh_chapter_three(&mut self.chain, &v, goes_nowhere, seen);
    }

    /// The present belief.
    pub fn belief(&self) -> Belief {
        self.chain.belief()
    }

    /// The most probable sequence of states, the oldest first.
    pub fn sequence(&self) -> Vec<IntentState> {
        self.chain.sequence().states()
    }
}

/// The recogniser for poses.
#[derive(Clone, Debug)]
pub(super) struct TileWalker {
    person: TileIntention,
    /// The person's stand after the last action, with its time.
    last: Option<(Stand, Time)>,
    /// The position from which the person has hardly moved, and since when.
    rest: Option<(Point, Time)>,
    /// The last position, from which the course is computed if the heading is not known.
    before: Option<Point>,
}

impl TileWalker {
    pub fn new() -> TileWalker {
        TileWalker { person: TileIntention::without_goals(), last: None, rest: None, before: None }
    }

    pub fn person(&self) -> &TileIntention {
        &self.person
    }

    pub fn person_mut(&mut self) -> &mut TileIntention {
        &mut self.person
    }

    pub fn observe(&mut self, seen: Time, at: Point, heading: Option<f64>, tiles: &Tiles) {
        let course =
            self.before.filter(|b| (at - b).norm() >= SWAY_M).map(|b| Segment { a: b, b: at }.heading());
        if course.is_some() || self.before.is_none() {
            self.before = Some(at);
        }
        let rest = self.rest.filter(|(place, _)| (at - place).norm() < STANDS_M);
        let (_, rests) = *self.rest.insert(rest.unwrap_or((at, seen)));
        let Some((last, since)) = self.last else {
            let faces = heading.or(course).unwrap_or(0.0);
            self.last = tiles.stand_at(at, faces).map(|s| (s, seen));
            return;
        };
        let facing = heading.or(course).unwrap_or(last.eighth as f64 * FRAC_PI_4);
        let Some(now) = steady(tiles, last, at, facing) else { return };
        if now == last {
            // Whether staying fits a goal depends on where the person faces.
            if heading.is_some() && seen - since.max(rests) >= STAYS {
                self.act(tiles, last, Action::Stay, seen);
                self.last = Some((last, seen));
            }
            return;
        }
        match way(tiles, last, now) {
            Some(actions) => {
                let mut stand = last;
                for action in actions {
                    self.act(tiles, stand, action, seen);
                    stand = tiles.after(stand, action).expect("the way keeps to free tiles");
                }
            }
            // Nobody walks like that: evidence starts anew from here.
            None => self.person.evidence = Evidence::new(Span::from_secs(PATIENCE)),
        }
        self.last = Some((now, seen));
    }

    fn act(&mut self, tiles: &Tiles, s: Stand, action: Action, seen: Time) {
        self.person.steps += 1;
        self.person.judge(tiles, s, action, seen);
    }
}

/// The present stand of a person whose last one was `last`: a different one only if that is beyond doubt.
fn steady(tiles: &Tiles, last: Stand, at: Point, facing: f64) -> Option<Stand> {
    let now = tiles.stand_at(at, facing)?;
    let (old, new) = ((tiles.place(last) - at).norm(), (tiles.place(now) - at).norm());
    let moved = old - new > SWAY_M;
    let turned = turn_between(last.eighth as f64 * FRAC_PI_4, facing) > FRAC_PI_8 + LOOK;
    let eighth = if turned { now.eighth } else { last.eighth };
    Some(if moved { Stand { eighth, ..now } } else { Stand { eighth, ..last } })
}

/// The actions from one stand to another: turns first, since people look where they go, then tiles, a diagonal as two
/// steps; nothing if the other stand is too far or a blocked tile lies between.
fn way(tiles: &Tiles, from: Stand, to: Stand) -> Option<Vec<Action>> {
    let anticlockwise = (to.eighth + 8 - from.eighth) % 8;
    let turns = match anticlockwise {
        0..=4 => vec![Action::TurnLeft; anticlockwise],
        _ => vec![Action::TurnRight; 8 - anticlockwise],
    };
    let (dx, dy) = (to.x as isize - from.x as isize, to.y as isize - from.y as isize);
    if dx.unsigned_abs() + dy.unsigned_abs() > STRIDE {
        return None;
    }
    let across = vec![if dx < 0 { Action::Left } else { Action::Right }; dx.unsigned_abs()];
    let along = vec![if dy < 0 { Action::Down } else { Action::Up }; dy.unsigned_abs()];
    let both = [[across.clone(), along.clone()].concat(), [along, across].concat()];
    let free = |steps: &Vec<Action>| {
        let turned = Stand { eighth: to.eighth, ..from };
        steps.iter().try_fold(turned, |s, a| tiles.after(s, *a)).is_some()
    };
    both.into_iter().find(free).map(|steps| [turns, steps].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_is_two_steps_round_the_corner_that_is_free() {
        let tiles = Tiles::drawn("...\n#..\n..0");
        let (from, to) = (Stand { x: 1, y: 1, eighth: 0 }, Stand { x: 0, y: 2, eighth: 3 });
        let turns = [Action::TurnLeft; 3].to_vec();
        assert_eq!(way(&tiles, from, to), Some([turns, vec![Action::Up, Action::Left]].concat()));
        let shut = Tiles::drawn(".#.\n#..\n..0");
        assert_eq!(way(&shut, from, to), None);
    }

    #[test]
    fn sway_and_a_glance_are_no_actions_and_standing_is_one_a_second() {
        let tiles = Tiles::drawn(".....\n....0\n.....");
        let mut walker = TileWalker::new();
        tiles.goals().for_each(|g| walker.person_mut().add_goal(g).expect("room"));
        let mut see = |ms: i64, x: f64, heading: f64| {
            walker.observe(Time(ms * 1000), Point::new(x, 1.0), Some(heading), &tiles);
            walker.person().steps
        };
        assert_eq!(see(0, 1.0, 0.0), 0);
        assert_eq!(see(300, 1.55, 0.4), 0, "half a tile, and half an eighth");
        assert_eq!(see(900, 1.8, 0.0), 1, "a step");
        assert_eq!(see(1900, 2.2, 0.0), 1, "who walks slowly has not chosen to stay");
        assert_eq!(see(2950, 2.1, 0.0), 2, "who has been standing for a second has");
        assert_eq!(see(3050, 2.0, 1.6), 4, "a quarter of a turn is two eighths");
    }
}
