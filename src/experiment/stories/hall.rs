//! A large hall with 24 robots; a goal is added while the person walks (Petković 2021, section 3.5.4, figures 3.18
//! to 3.20).
//!
//! Main function: [`tell`]. Goals lie so that the text's choices come in its order, except that cyan parts from brown
//! where purple does. Robots move as in the text: eight each in the western, middle and eastern roads, each to a
//! random neighbouring node, never straight back, waiting where another has chosen the same. They do not see the person.

use super::super::dice::Dice;
use super::actor::{Act, Actor};
use super::{Event, Story, name};
use crate::geometry::Point;
use crate::human::{Distances, Intention, Method};
use crate::id::{GoalId, NodeId};
use crate::time::Time;
use crate::warehouse::walkway::Walkways;
use crate::warehouse::{Blocks, NodeKind, Warehouse};
use std::sync::Arc;

const ROBOTS_A_GROUP: usize = 8;
/// Radius of what a robot closes, metres.
const ROBOT_M: f64 = 0.7;
/// Poses a second.
const RATE: f64 = 10.0;
/// Seconds for a robot from one node to the next.
const STEP_S: f64 = 1.5;
const GOALS: [(&str, &str, f64, f64); 4] = [
    ("yellow", "#d4a017", 7.0, 10.0),
    ("brown", "#8b5a2b", 32.0, 19.0),
    ("cyan", "#17a2b8", 32.0, 4.0),
    ("purple", "#8e44ad", 26.0, 4.0),
];
const BROWN: u64 = 1;

fn hall() -> Warehouse {
    let blocks = Blocks { name: "hall".into(), groups: (2, 1), blocks: (3, 7), ..Blocks::default() };
    blocks.draft().build().expect("these parameters make a map, a test builds it")
}

/// Robots that wander.
struct Crowd {
    dice: Dice,
    /// Node before, node, node to come.
    robots: Vec<[NodeId; 3]>,
}

impl Crowd {
    fn new(w: &Warehouse, seed: u64) -> Crowd {
        let (low, high) = w.bounds();
        let aisles = w.nodes_where(|k| k == NodeKind::Aisle);
        let nearest = |at: Point| {
            let far = |n: &NodeId| (w.nodes[*n].at - at).norm();
            aisles.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).expect("a hall has aisles")
        };
        let mut robots = Vec::new();
        for column in 0..3 {
            let x = [0.0, nalgebra::center(&low, &high).x, high.x][column];
            for k in 0..ROBOTS_A_GROUP {
                let n = nearest(Point::new(
                    x,
                    low.y + (k as f64 + 0.5) * (high.y - low.y) / ROBOTS_A_GROUP as f64,
                ));
                robots.push([n; 3]);
            }
        }
        Crowd { dice: Dice::new(seed), robots }
    }

    /// All choose their next node.
    fn step(&mut self, w: &Warehouse) {
        for i in 0..self.robots.len() {
            let [_, here, next] = self.robots[i];
            let before = if here == next { self.robots[i][0] } else { here };
            let free = |n: &NodeId| {
                *n != before
                    && w.kind(*n) == NodeKind::Aisle
                    && self.robots.iter().enumerate().all(|(j, r)| j == i || (r[2] != *n && r[1] != *n))
            };
            let ways: Vec<NodeId> = w.out(next).map(|(_, a)| a.to).filter(free).collect();
            let chosen = ways.get(self.dice.below(ways.len())).copied().unwrap_or(next);
            self.robots[i] = [before, next, chosen];
        }
    }

    fn places(&self, w: &Warehouse, u: f64) -> Vec<Point> {
        let at = |n: NodeId| w.nodes[n].at;
        self.robots.iter().map(|r| at(r[1]) + (at(r[2]) - at(r[1])) * u).collect()
    }
}

/// The person passes yellow, goes east through the middle, and on to brown.
fn person() -> Actor {
    let corners = [(7.0, 10.0), (7.0, 13.0), (26.0, 13.0), (26.0, 19.0), (32.0, 19.0)];
    let acts: Vec<Act> =
        corners.into_iter().map(|(x, y)| Act::Walk(x, y, 1.2)).chain([Act::Stand(1.0)]).collect();
    Actor::new(Point::new(7.0, 5.0), std::f64::consts::FRAC_PI_2, &acts)
}

/// The story.
pub(super) fn tell(method: Method, seed: u64) -> Story {
    let w = hall();
    let mut all = Distances::over(Arc::new(Walkways::of(&w)));
    let mut recogniser = Intention::new(method);
    for (i, (.., x, y)) in GOALS.iter().enumerate() {
        all.add_goal(GoalId(i as u64), Point::new(*x, *y));
        if i as u64 != BROWN {
            recogniser.add_goal(GoalId(i as u64), 1.0).expect("three goals");
        }
    }
    let (mut crowd, person) = (Crowd::new(&w, seed), person());
    let (added, mut stepped) = (person.begins(1) + 1.0, 0);
    let (mut beliefs, mut known) = (Vec::new(), false);
    for tick in 0..=(person.end() * RATE) as i64 {
        let t = tick as f64 / RATE;
        while stepped as f64 * STEP_S <= t {
            crowd.step(&w);
            stepped += 1;
        }
        let mut cut = all.walkways().no_edges();
        for at in crowd.places(&w, (t / STEP_S).fract()) {
            for e in all.walkways().edges_within(at, ROBOT_M) {
                cut.insert(e);
            }
        }
        all.set_cut(&cut);
        if t >= added && !known {
            recogniser.add_goal(GoalId(BROWN), 1.0).expect("four goals");
            known = true;
        }
        let pose = person.pose(t);
        recogniser.observe(Time::from_secs_f64(t), pose.at, Some(pose.heading), &all);
        beliefs.push((t, recogniser.belief()));
    }
    let events = [
        (0.0, "walks north towards yellow"),
        (person.begins(1), "passes yellow"),
        (added, "the brown goal is added"),
        (person.begins(2), "turns east: fits brown, cyan and purple"),
        (person.begins(3), "turns north towards brown"),
        (person.begins(4), "turns east towards brown"),
    ];
    Story {
        title: "A large hall with 24 robots".into(),
        subtitle: format!("{}; seed {seed}; brown becomes a goal on the way", name(method)),
        unit: "seconds",
        goals: GOALS.iter().map(|g| (g.0, g.1)).collect(),
        beliefs,
        events: events.into_iter().map(|(at, what)| Event { at, what: what.into() }).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::intention::State;

    const YELLOW: GoalId = GoalId(0);

    #[test]
    fn the_order_of_events_is_that_of_the_thesis_whichever_way_the_robots_wander() {
        for (method, seed) in [1, 2, 3].into_iter().flat_map(|s| [(Method::Chapter3, s), (Method::Detour, s)])
        {
            let story = tell(method, seed);
            let at = |words: &str, later: f64| story.at(story.when(words) + later);
            let context = format!("{method:?}, seed {seed}");
            assert_eq!(at("passes yellow", -0.5).top(), State::Goal(YELLOW), "{context}");
            let added = at("is added", 0.1);
            assert!(added.goals.len() == 4 && added.of(YELLOW) < 0.5, "{context}: {added:?}");
            let east = at("turns north", -1.0);
            let brown = east.of(GoalId(BROWN));
            assert!(brown > 0.05 && brown < 0.7 && east.of(YELLOW) < 0.1, "{context}: {east:?}");
            let end = &story.beliefs[story.beliefs.len() - 1].1;
            assert_eq!(end.top(), State::Goal(GoalId(BROWN)), "{context}: {end:?}");
        }
    }

    #[test]
    fn robots_wander_without_ever_sharing_a_node() {
        let w = hall();
        let mut crowd = Crowd::new(&w, 5);
        assert_eq!(crowd.robots.len(), 3 * ROBOTS_A_GROUP);
        let start = crowd.places(&w, 0.0);
        for _ in 0..200 {
            crowd.step(&w);
            let taken: std::collections::BTreeSet<NodeId> = crowd.robots.iter().map(|r| r[2]).collect();
            assert_eq!(taken.len(), crowd.robots.len());
        }
        let moved = crowd.places(&w, 0.0).iter().zip(&start).filter(|(a, b)| (*a - *b).norm() > 3.0).count();
        assert!(moved > 12, "{moved} of 24 have gone anywhere");
    }
}
