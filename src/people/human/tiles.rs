//! A small floor as tiles, with how good each tile is for a person with a given goal: a Markov decision process.
//!
//! Main types: [`Tiles`] (the grid with the state values of each goal), [`Stand`], [`Action`]. Petković 2021, section
//! 3.2, eq. 3.2 to 3.10. Differences from the print: among shortest paths the one seen most is found by comparing
//! (steps, −tiles seen), since the heuristic of eq. 3.1 is not admissible; bearings are absolute (eq. 3.3); if no tile
//! of the path is seen the reward is −(ε + π); eq. 3.9 discounts by 0.9. Refuses: floors that change, and floors of
//! more tiles than the published one: state values would take longer than a step of the fleet may.

use giveway_floor::geometry::{Point, turn_between};
use giveway_floor::id::GoalId;
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::walkway::Walkways;
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::Arc;

/// Probability that an action goes wrong to either side (ε of eq. 3.7).
const SLIP: f64 = 0.1;
/// Cost of a step besides the remaining turn (ε of eq. 3.8).
const STEP_COST: f64 = 0.01;
/// Discount of eq. 3.9; the print has none.
const DISCOUNT: f64 = 0.9;
/// Values have converged when the sum of their changes is less than this (η of eq. 3.10).
const STOP: f64 = 0.01;
/// Half of the field of view, radians.
const HALF_VIEW: f64 = FRAC_PI_4;
/// Side of a tile of a warehouse, metres; about the spacing of nodes.
const TILE_M: f64 = 1.0;
/// Largest number of tiles, as on the published floor: 20 × 20.
const TILES_MAX: usize = 400;
/// A place on no free tile belongs to a free tile whose middle is at most this far away, metres.
const BESIDE_M: f64 = 1.5;

/// The floor has too many tiles for state values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the floor has {columns} × {rows} tiles of a metre, and there is room for {TILES_MAX} in all")]
pub struct TooManyTiles {
    /// Number of tiles from west to east.
    pub columns: usize,
    /// Number of tiles from south to north.
    pub rows: usize,
}

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

/// An action of a person in a step (eq. 3.6).
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
    /// No motion.
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

/// A grid of tiles with goals, and how good each tile is for each goal.
#[derive(Clone, Debug)]
pub struct Tiles {
    /// The middle of the south-western tile.
    origin: Point,
    columns: usize,
    rows: usize,
    free: Vec<bool>,
    /// Which tiles can be seen from which, whatever the heading.
    seen: Arc<Vec<Vec<bool>>>,
    goals: BTreeMap<GoalId, TileGoal>,
}

#[derive(Clone, Debug)]
struct TileGoal {
    /// The goal's tile; nothing if there is no free one near.
    tile: Option<usize>,
    /// The value of each tile and heading.
    values: Arc<[f64]>,
}

impl Tiles {
    /// Reads a drawing, north up: `#` is blocked, digits are goals in their order, everything else is free.
    pub fn drawn(drawing: &str) -> Tiles {
        let lines: Vec<Vec<char>> = drawing.lines().map(|l| l.trim().chars().collect()).collect();
        let lines: Vec<Vec<char>> = lines.into_iter().filter(|l: &Vec<char>| !l.is_empty()).collect();
        let (rows, columns) = (lines.len(), lines.first().map_or(0, Vec::len));
        let at = |i: usize| lines[rows - 1 - i / columns].get(i % columns).copied().unwrap_or('#');
        let free = (0..rows * columns).map(|i| at(i) != '#').collect();
        let mut goals: Vec<(char, usize)> =
            (0..rows * columns).map(|i| (at(i), i)).filter(|(c, _)| c.is_ascii_digit()).collect();
        goals.sort_unstable();
        let mut tiles = Tiles::laid(Point::origin(), (columns, rows), free);
        for (g, (_, i)) in goals.into_iter().enumerate() {
            tiles.add_goal(GoalId(g as u64), tiles.middle(i));
        }
        tiles
    }

    /// Tiles over a building, free where people may walk, with a node in the middle of a tile; without goals.
    ///
    /// # Errors
    /// If there are more tiles than can be evaluated.
    pub fn of(w: &Warehouse, walkways: &Walkways) -> Result<Tiles, TooManyTiles> {
        let (origin, (columns, rows)) = Tiles::over(w)?;
        let middle = |i: usize| tile_middle(origin, columns, i);
        let free = (0..columns * rows).map(|i| walkways.is_free(middle(i))).collect();
        Ok(Tiles::laid(origin, (columns, rows), free))
    }

    /// Whether a building has few enough tiles.
    ///
    /// # Errors
    /// If there are more tiles than can be evaluated.
    pub fn fit(w: &Warehouse) -> Result<(), TooManyTiles> {
        Tiles::over(w).map(|_| ())
    }

    /// Position of the first tile, and the number of tiles each way.
    fn over(w: &Warehouse) -> Result<(Point, (usize, usize)), TooManyTiles> {
        let (low, high) = w.bounds();
        let node = w.nodes.iter().map(|n| n.at).next().unwrap_or(low);
        // The last tile middle west and south of the corner, aligned with the nodes.
        let first = |low: f64, node: f64| node - ((node - low) / TILE_M - 1e-9).ceil() * TILE_M;
        let origin = Point::new(first(low.x, node.x), first(low.y, node.y));
        let count = |low: f64, high: f64| ((high - low) / TILE_M + 1e-9).ceil().max(0.0) as usize + 1;
        let (columns, rows) = (count(origin.x, high.x), count(origin.y, high.y));
        if columns.saturating_mul(rows) > TILES_MAX {
            return Err(TooManyTiles { columns, rows });
        }
        Ok((origin, (columns, rows)))
    }

    fn laid(origin: Point, (columns, rows): (usize, usize), free: Vec<bool>) -> Tiles {
        let mut tiles =
            Tiles { origin, columns, rows, free, seen: Arc::new(Vec::new()), goals: BTreeMap::new() };
        tiles.seen = Arc::new(tiles.look_around());
        tiles
    }

    /// Adds a goal, or moves it, and computes its state values.
    pub fn add_goal(&mut self, goal: GoalId, at: Point) {
        let tile = self.tile_at(at);
        let values = tile.map_or_else(Vec::new, |tile| self.iterate(tile)).into();
        self.goals.insert(goal, TileGoal { tile, values });
    }

    /// Forgets a goal.
    pub fn remove_goal(&mut self, goal: GoalId) {
        self.goals.remove(&goal);
    }

    /// The goals, sorted.
    pub fn goals(&self) -> impl Iterator<Item = GoalId> {
        self.goals.keys().copied()
    }

    /// The position of the middle of tile number `i`.
    fn middle(&self, i: usize) -> Point {
        tile_middle(self.origin, self.columns, i)
    }

    /// The position of the middle of a tile, in metres.
    pub fn place(&self, s: Stand) -> Point {
        self.middle(s.y * self.columns + s.x)
    }

    /// The free tile of a place: the one beneath it, or the nearest beside it.
    fn tile_at(&self, p: Point) -> Option<usize> {
        let free = (0..self.free.len()).filter(|i| self.free[*i]);
        let away = |i: &usize| (self.middle(*i) - p).norm();
        free.min_by(|a, b| away(a).total_cmp(&away(b))).filter(|i| away(i) <= BESIDE_M)
    }

    /// The stand of a person at a place with a heading; nothing if no free tile is near.
    pub fn stand_at(&self, p: Point, heading: f64) -> Option<Stand> {
        let tile = self.tile_at(p)?;
        let eighth = (heading / FRAC_PI_4).round().rem_euclid(8.0) as usize % 8;
        Some(Stand { x: tile % self.columns, y: tile / self.columns, eighth })
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// Whether a tile is free.
    pub fn is_free(&self, x: usize, y: usize) -> bool {
        x < self.columns && y < self.rows && self.free[y * self.columns + x]
    }

    /// Where an action leads; nothing if a blocked tile or the border is in the way.
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

    fn look_around(&self) -> Vec<Vec<bool>> {
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

    /// Number of steps from each tile to a goal.
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

    /// The mean bearing of the visible tiles of the shortest path that the person sees most of (eq. 3.2); nothing if
    /// none is visible.
    fn bearing(&self, s: Stand, steps: &[usize], order: &[usize]) -> Option<f64> {
        let here = s.y * self.columns + s.x;
        let bearing = |i: usize| {
            let (dx, dy) = ((i % self.columns) as f64 - s.x as f64, (i / self.columns) as f64 - s.y as f64);
            dy.atan2(dx)
        };
        let heading = s.eighth as f64 * FRAC_PI_4;
        let sees = |i: usize| {
            i != here && self.seen[here][i] && turn_between(heading, bearing(i)) <= HALF_VIEW + 1e-9
        };
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

    /// The immediate rewards for a goal on one tile (eq. 3.8).
    fn rewards(&self, goal: usize) -> Vec<f64> {
        let steps = self.steps_to(goal);
        let mut order: Vec<usize> = (0..steps.len()).filter(|i| steps[*i] != usize::MAX).collect();
        order.sort_by_key(|i| steps[*i]);
        let reward = |i: usize| {
            let s = self.stand(i);
            match steps[i / 8] {
                0 => PI,
                usize::MAX => -(STEP_COST + PI),
                _ => {
                    let off = self.bearing(s, &steps, &order);
                    let off = off.map_or(PI, |b| turn_between(b, s.eighth as f64 * FRAC_PI_4));
                    -(STEP_COST + off)
                }
            }
        };
        (0..self.free.len() * 8).map(reward).collect()
    }

    /// Where an action leads, with probabilities (eq. 3.7); an impossible move becomes staying.
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

    /// Value iteration (eq. 3.9, 3.10). The value of a state includes its own reward.
    fn iterate(&self, goal: usize) -> Vec<f64> {
        let rewards = self.rewards(goal);
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

    /// How good an action is for each of `goals`: 1 for the best possible in that state, 0 for the worst; 0 for a goal
    /// that is on no tile.
    pub fn validate(&self, s: Stand, action: Action, goals: &[GoalId]) -> Vec<f64> {
        let gain = |values: &[f64], a: Action| -> f64 {
            self.outcomes(s, a).iter().map(|(i, p)| p * values[*i]).sum()
        };
        let judge = |values: &[f64]| {
            let gains = ACTIONS.map(|a| gain(values, a));
            let (low, high) = gains.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            if high > low { (gain(values, action) - low) / (high - low) } else { 0.5 }
        };
        let known = |g: &GoalId| self.goals.get(g).filter(|goal| goal.tile.is_some());
        goals.iter().map(|g| known(g).map_or(0.0, |goal| judge(&goal.values))).collect()
    }
}

fn tile_middle(origin: Point, columns: usize, i: usize) -> Point {
    Point::new(origin.x + (i % columns) as f64 * TILE_M, origin.y + (i / columns) as f64 * TILE_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{kiva, thesis};

    const ONE: [GoalId; 1] = [GoalId(0)];

    fn room() -> Tiles {
        Tiles::drawn("#######\n#.....#\n#.###.#\n#0....#\n#######")
    }

    #[test]
    fn the_best_action_faces_and_approaches_the_goal() {
        let tiles = room();
        let facing = Stand { x: 4, y: 1, eighth: 4 };
        assert!(tiles.validate(facing, Action::Left, &ONE)[0] > 0.99);
        assert!(tiles.validate(facing, Action::Right, &ONE)[0] < 0.2);
        let away = Stand { eighth: 0, ..facing };
        let turn = tiles.validate(away, Action::TurnLeft, &ONE)[0];
        assert!(turn > tiles.validate(away, Action::Right, &ONE)[0]);
        let there = Stand { x: 1, y: 1, eighth: 4 };
        assert!(tiles.validate(there, Action::Stay, &ONE)[0] > 0.9, "who has arrived stays");
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
        let goal = tiles.goals[&GoalId(0)].tile.expect("a goal on a tile");
        let steps = tiles.steps_to(goal);
        let mut order: Vec<usize> = (0..steps.len()).collect();
        order.sort_by_key(|i| steps[*i]);
        let bearing = |eighth| tiles.bearing(Stand { x: 0, y: 0, eighth }, &steps, &order);
        let (north, east) = (bearing(2).expect("seen"), bearing(0).expect("seen"));
        assert!(north > FRAC_PI_4 && east < FRAC_PI_4, "{north} {east}");
        assert_eq!(bearing(5), None, "facing the other way nothing of it is seen");
    }

    #[test]
    fn a_building_has_a_node_in_the_middle_of_a_tile_and_a_large_one_is_refused() {
        let w = thesis();
        let walkways = Walkways::of(&w);
        let tiles = Tiles::of(&w, &walkways).expect("it is small");
        let aisle = w.nodes_where(|k| k == giveway_floor::warehouse::NodeKind::Aisle);
        let on_tile = |n: &giveway_floor::id::NodeId| {
            let at = w.nodes[*n].at;
            tiles.stand_at(at, 0.1).is_some_and(|s| (tiles.place(s) - at).norm() < 1e-6 && s.eighth == 0)
        };
        let found = aisle.iter().filter(|n| walkways.is_free(w.nodes[**n].at) && on_tile(n)).count();
        assert!(found > 50, "{found} aisle nodes are middles of free tiles");
        assert_eq!(tiles.stand_at(Point::new(-90.0, 0.0), 0.0), None, "nobody stands beyond the floor");
        let refused = Tiles::fit(&kiva()).expect_err("it is large").to_string();
        assert!(refused.contains("tiles of a metre") && refused.contains("room for 400"), "{refused}");
    }
}
