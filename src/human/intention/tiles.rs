//! The published static method: a Markov decision process on a small grid of tiles judges the person's actions.
//!
//! Main types: [`Tiles`] (the grid with the state values of each goal), [`TileIntention`] (the recogniser). Petković
//! 2021, section 3.2, eq. 3.2 to 3.10. Differences from the print: among shortest paths the one seen most is taken by
//! comparing (steps, −tiles seen), since the heuristic of eq. 3.1 is not admissible; bearings are absolute (eq. 3.3);
//! where no tile of the path is seen the reward is −(ε + π); eq. 3.9 discounts by 0.9. Refuses: floors that change,
//! and more than a few thousand tiles.

use super::chain::{IntentBelief, IntentState};
use super::published::{Evidence, weigh_chapter_three};
use super::{Belief, TooManyGoals};
use crate::geometry::turn_between;
use crate::id::GoalId;
use crate::time::{Span, Time};
use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_4, PI};

/// How often an action goes wrong to either side (ε of eq. 3.7).
const SLIP: f64 = 0.1;
/// Reward beside the turn that is left (ε of eq. 3.8).
const STEP_COST: f64 = 0.01;
/// Discount of eq. 3.9; the print has none.
const DISCOUNT: f64 = 0.9;
/// Values are good when their changes sum to less (η of eq. 3.10).
const STOP: f64 = 0.01;
/// Half of the field of view, radians.
const HALF_VIEW: f64 = FRAC_PI_4;
/// Actions to judge before a person is called irrational, one a second.
const PATIENCE: i64 = 3;

/// A tile and a heading in eighths of a turn, anticlockwise from the east.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stand {
    /// Column, from the west.
    pub x: usize,
    /// Row, from the south.
    pub y: usize,
    /// Heading, 0 to 7.
    pub eighth: usize,
}

/// What a person can do in a step (eq. 3.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// One tile north.
    Up,
    /// One tile south.
    Down,
    /// One tile west.
    Left,
    /// One tile east.
    Right,
    /// An eighth clockwise.
    TurnRight,
    /// An eighth anticlockwise.
    TurnLeft,
    /// Nothing.
    Stay,
}

const ACTIONS: [Action; 7] = [
    Action::Up,
    Action::Down,
    Action::Left,
    Action::Right,
    Action::TurnRight,
    Action::TurnLeft,
    Action::Stay,
];

/// A grid of tiles with goals, and how good it is to be where for each goal.
#[derive(Clone, Debug)]
pub struct Tiles {
    columns: usize,
    rows: usize,
    free: Vec<bool>,
    goals: Vec<usize>,
    /// For each goal the value of each tile and heading.
    values: Vec<Vec<f64>>,
}

impl Tiles {
    /// Reads a drawing, north up: `#` is taken, digits are goals in their order, everything else is free.
    pub fn drawn(drawing: &str) -> Tiles {
        let lines: Vec<Vec<char>> = drawing.lines().map(|l| l.trim().chars().collect()).collect();
        let lines: Vec<Vec<char>> = lines.into_iter().filter(|l: &Vec<char>| !l.is_empty()).collect();
        let (rows, columns) = (lines.len(), lines.first().map_or(0, Vec::len));
        let at = |i: usize| lines[rows - 1 - i / columns].get(i % columns).copied().unwrap_or('#');
        let free = (0..rows * columns).map(|i| at(i) != '#').collect();
        let mut goals: Vec<(char, usize)> =
            (0..rows * columns).map(|i| (at(i), i)).filter(|(c, _)| c.is_ascii_digit()).collect();
        goals.sort_unstable();
        let goals = goals.into_iter().map(|(_, i)| i).collect();
        let mut tiles = Tiles { columns, rows, free, goals, values: Vec::new() };
        let seen = tiles.seen();
        tiles.values = (0..tiles.goals.len()).map(|g| tiles.iterate(g, &seen)).collect();
        tiles
    }

    /// How many goals.
    pub fn goals(&self) -> usize {
        self.goals.len()
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// Whether a tile is free.
    pub fn is_free(&self, x: usize, y: usize) -> bool {
        x < self.columns && y < self.rows && self.free[y * self.columns + x]
    }

    /// Where a goal is.
    pub fn goal(&self, g: usize) -> (usize, usize) {
        (self.goals[g] % self.columns, self.goals[g] / self.columns)
    }

    /// Where an action leads, or nothing where a taken tile or the border is in the way.
    pub fn after(&self, s: Stand, action: Action) -> Option<Stand> {
        let moved = |dx: isize, dy: isize| {
            let (x, y) = (s.x.checked_add_signed(dx)?, s.y.checked_add_signed(dy)?);
            self.is_free(x, y).then_some(Stand { x, y, ..s })
        };
        match action {
            Action::Up => moved(0, 1),
            Action::Down => moved(0, -1),
            Action::Left => moved(-1, 0),
            Action::Right => moved(1, 0),
            Action::TurnRight => Some(Stand { eighth: (s.eighth + 7) % 8, ..s }),
            Action::TurnLeft => Some(Stand { eighth: (s.eighth + 1) % 8, ..s }),
            Action::Stay => Some(s),
        }
    }

    fn index(&self, s: Stand) -> usize {
        (s.y * self.columns + s.x) * 8 + s.eighth
    }

    fn stand(&self, i: usize) -> Stand {
        Stand { x: i / 8 % self.columns, y: i / 8 / self.columns, eighth: i % 8 }
    }

    /// Which tiles can be seen from which, whatever the heading.
    fn seen(&self) -> Vec<Vec<bool>> {
        let n = self.columns * self.rows;
        let row = |i: usize| (0..n).map(|j| self.free[i] && self.free[j] && self.sees(i, j)).collect();
        (0..n).map(row).collect()
    }

    /// Whether the straight line between two tiles' middles crosses free tiles only.
    fn sees(&self, i: usize, j: usize) -> bool {
        let at = |i: usize| ((i % self.columns) as f64, (i / self.columns) as f64);
        let ((ax, ay), (bx, by)) = (at(i), at(j));
        let steps = 4 * ((bx - ax).abs().max((by - ay).abs()) as usize).max(1);
        (0..=steps).all(|k| {
            let u = k as f64 / steps as f64;
            self.is_free((ax + (bx - ax) * u).round() as usize, (ay + (by - ay) * u).round() as usize)
        })
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> {
        let s = Stand { x: i % self.columns, y: i / self.columns, eighth: 0 };
        ACTIONS[..4].iter().filter_map(move |a| self.after(s, *a)).map(|s| s.y * self.columns + s.x)
    }

    /// Steps from each tile to a goal.
    fn steps_to(&self, goal: usize) -> Vec<usize> {
        let mut steps = vec![usize::MAX; self.free.len()];
        let mut queue = VecDeque::from([goal]);
        steps[goal] = 0;
        while let Some(i) = queue.pop_front() {
            for j in self.neighbours(i).collect::<Vec<_>>() {
                if steps[j] == usize::MAX {
                    steps[j] = steps[i] + 1;
                    queue.push_back(j);
                }
            }
        }
        steps
    }

    /// The mean bearing of the tiles that the person sees of the shortest path that it sees most of (eq. 3.2);
    /// nothing where it sees none.
    fn bearing(&self, s: Stand, steps: &[usize], order: &[usize], seen: &[Vec<bool>]) -> Option<f64> {
        let here = s.y * self.columns + s.x;
        let bearing = |i: usize| {
            let (dx, dy) = ((i % self.columns) as f64 - s.x as f64, (i / self.columns) as f64 - s.y as f64);
            dy.atan2(dx)
        };
        let heading = s.eighth as f64 * FRAC_PI_4;
        let sees =
            |i: usize| i != here && seen[here][i] && turn_between(heading, bearing(i)) <= HALF_VIEW + 1e-9;
        // The most tiles seen from each tile on to the goal, nearest to the goal first.
        let mut most = vec![0_usize; self.free.len()];
        for &i in order.iter().take_while(|i| steps[**i] < steps[here]) {
            let on = self.neighbours(i).filter(|j| steps[*j] < steps[i]).map(|j| most[j]).max();
            most[i] = on.unwrap_or(0) + usize::from(sees(i));
        }
        let (mut at, mut sum) = (here, (0.0, 0.0));
        while steps[at] > 0 {
            let next = self.neighbours(at).filter(|j| steps[*j] < steps[at]);
            at = next.max_by_key(|j| (most[*j], std::cmp::Reverse(*j)))?;
            if sees(at) {
                sum = (sum.0 + bearing(at).sin(), sum.1 + bearing(at).cos());
            }
        }
        (sum != (0.0, 0.0)).then(|| sum.0.atan2(sum.1))
    }

    /// The immediate rewards for one goal (eq. 3.8).
    fn rewards(&self, g: usize, seen: &[Vec<bool>]) -> Vec<f64> {
        let steps = self.steps_to(self.goals[g]);
        let mut order: Vec<usize> = (0..steps.len()).filter(|i| steps[*i] != usize::MAX).collect();
        order.sort_by_key(|i| steps[*i]);
        let reward = |i: usize| {
            let s = self.stand(i);
            match steps[i / 8] {
                0 => PI,
                usize::MAX => -(STEP_COST + PI),
                _ => {
                    let off = self.bearing(s, &steps, &order, seen);
                    let off = off.map_or(PI, |b| turn_between(b, s.eighth as f64 * FRAC_PI_4));
                    -(STEP_COST + off)
                }
            }
        };
        (0..self.free.len() * 8).map(reward).collect()
    }

    /// Where an action leads with what probability (eq. 3.7); what is impossible becomes to stay.
    fn outcomes(&self, s: Stand, action: Action) -> [(usize, f64); 3] {
        let sure = 1.0 - 2.0 * SLIP;
        let outcomes = match action {
            Action::Up | Action::Down => [(action, sure), (Action::Left, SLIP), (Action::Right, SLIP)],
            Action::Left | Action::Right => [(action, sure), (Action::Up, SLIP), (Action::Down, SLIP)],
            Action::TurnRight | Action::TurnLeft => {
                [(action, 1.0 - SLIP), (Action::Stay, SLIP), (Action::Stay, 0.0)]
            }
            Action::Stay => [(Action::Stay, 1.0), (Action::Stay, 0.0), (Action::Stay, 0.0)],
        };
        outcomes.map(|(a, p)| (self.index(self.after(s, a).unwrap_or(s)), p))
    }

    /// Value iteration (eq. 3.9, 3.10). The value of a state holds its own reward.
    fn iterate(&self, g: usize, seen: &[Vec<bool>]) -> Vec<f64> {
        let rewards = self.rewards(g, seen);
        let states: Vec<usize> = (0..rewards.len()).filter(|i| self.free[i / 8]).collect();
        let ways: Vec<[[(usize, f64); 3]; 7]> =
            states.iter().map(|i| ACTIONS.map(|a| self.outcomes(self.stand(*i), a))).collect();
        let mut values = vec![0.0; rewards.len()];
        loop {
            let gain = |i: &(usize, f64)| i.1 * (rewards[i.0] + DISCOUNT * values[i.0]);
            let best = |ways: &[[(usize, f64); 3]; 7]| {
                ways.iter().map(|w| w.iter().map(gain).sum::<f64>()).fold(f64::NEG_INFINITY, f64::max)
            };
            let next: Vec<f64> = ways.iter().map(best).collect();
            let change: f64 = states.iter().zip(&next).map(|(i, v)| (v - values[*i]).abs()).sum();
            states.iter().zip(next).for_each(|(i, v)| values[*i] = v);
            if change < STOP {
                let reward_and_value = |i: usize| rewards[i] + DISCOUNT * values[i];
                return (0..rewards.len()).map(reward_and_value).collect();
            }
        }
    }

    /// How good an action is for each goal: 1 for the best there is in that state, 0 for the worst.
    pub fn validate(&self, s: Stand, action: Action) -> Vec<f64> {
        let gain = |values: &[f64], a: Action| -> f64 {
            self.outcomes(s, a).iter().map(|(i, p)| p * values[*i]).sum()
        };
        let judge = |values: &Vec<f64>| {
            let gains = ACTIONS.map(|a| gain(values, a));
            let (low, high) = gains.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            if high > low { (gain(values, action) - low) / (high - low) } else { 0.5 }
        };
        self.values.iter().map(judge).collect()
    }
}

/// The recogniser for actions on tiles. Goal `i` of the drawing is `GoalId(i)`.
#[derive(Clone, Debug)]
pub struct TileIntention {
    chain: IntentBelief,
    evidence: Evidence,
    steps: i64,
}

impl TileIntention {
    /// Nothing was seen yet.
    pub fn new(tiles: &Tiles) -> Result<TileIntention, TooManyGoals> {
        if tiles.goals() > 9 {
            return Err(TooManyGoals { at_most: 9 });
        }
        let goals = (0..tiles.goals()).map(|g| IntentState::Goal(GoalId(g as u64)));
        let states: Vec<IntentState> =
            goals.chain([IntentState::Undecided, IntentState::Elsewhere]).collect();
        let start = states.iter().map(|s| if *s == IntentState::Undecided { 1.0 } else { 0.0 }).collect();
        let evidence = Evidence::new(Span::from_secs(PATIENCE));
        Ok(TileIntention { chain: IntentBelief::new(states, start), evidence, steps: 0 })
    }

    /// Takes in an action.
    pub fn observe(&mut self, tiles: &Tiles, s: Stand, action: Action) {
        let v = tiles.validate(s, action);
        self.steps += 1;
        let by_goal = v.iter().enumerate().map(|(g, v)| (GoalId(g as u64), *v)).collect();
        let goes_nowhere = self.evidence.add(Time::ZERO + Span::from_secs(self.steps), by_goal);
        weigh_chapter_three(&mut self.chain, &v, goes_nowhere);
    }

    /// What it believes now.
    pub fn belief(&self) -> Belief {
        self.chain.belief()
    }

    /// The most probable sequence of states, the oldest first.
    pub fn sequence(&self) -> Vec<IntentState> {
        self.chain.sequence()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room() -> Tiles {
        Tiles::drawn("#######\n#.....#\n#.###.#\n#0....#\n#######")
    }

    #[test]
    fn the_best_action_faces_and_approaches_the_goal() {
        let tiles = room();
        let facing = Stand { x: 4, y: 1, eighth: 4 };
        assert!(tiles.validate(facing, Action::Left)[0] > 0.99);
        assert!(tiles.validate(facing, Action::Right)[0] < 0.2);
        let away = Stand { eighth: 0, ..facing };
        let turn = tiles.validate(away, Action::TurnLeft)[0];
        assert!(turn > tiles.validate(away, Action::Right)[0]);
        let there = Stand { x: 1, y: 1, eighth: 4 };
        assert!(tiles.validate(there, Action::Stay)[0] > 0.9, "who has arrived stays");
    }

    #[test]
    fn taken_tiles_stop_a_move_and_hide_what_is_behind() {
        let tiles = room();
        assert_eq!(tiles.after(Stand { x: 3, y: 1, eighth: 0 }, Action::Up), None);
        let (columns, _) = tiles.size();
        assert!(!tiles.sees(columns + 3, 3 * columns + 3) && tiles.sees(columns + 1, columns + 5));
    }

    #[test]
    fn among_shortest_paths_the_one_in_view_is_taken() {
        // An open room: all paths to the far corner are equally short; facing north, the one north comes first.
        let tiles = Tiles::drawn("....1\n.....\n.....\n.....\n.....");
        let seen = tiles.seen();
        let steps = tiles.steps_to(tiles.goals[0]);
        let mut order: Vec<usize> = (0..steps.len()).collect();
        order.sort_by_key(|i| steps[*i]);
        let bearing = |eighth| tiles.bearing(Stand { x: 0, y: 0, eighth }, &steps, &order, &seen);
        let (north, east) = (bearing(2).expect("seen"), bearing(0).expect("seen"));
        assert!(north > FRAC_PI_4 && east < FRAC_PI_4, "{north} {east}");
        assert_eq!(bearing(5), None, "facing the other way nothing of it is seen");
    }
}
