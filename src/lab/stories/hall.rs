//! A large hall with 24 robots; a goal is added while the person walks (Petković 2021, section 3.5.4, figures 3.18
//! to 3.20).
//!
//! Main function: [`tell`]. Goals lie so that the text's choices come in its order, except that cyan parts from brown
//! where purple does. Robots move as in the text: eight each in the western, middle and eastern roads, each to a random
//! neighbouring node, never straight back, waiting if another has chosen the same. Refuses: robots that see the person.

use super::super::dice::Dice;
use super::{Story, StoryEvent, name};
use giveway_floor::geometry::{Point, Pose, Segment};
use giveway_floor::id::{GoalId, NodeId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{Blocks, NodeKind, Warehouse};
use giveway_people::human::{Distances, Intention, Method, Model};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

const ROBOTS_A_GROUP: usize = 8;
/// The western, middle and eastern road.
const ROADS: [f64; 3] = [0.0, 19.0, 39.0];
/// Radius of what a robot closes, metres: the aisle that it is in, but not a road of two lanes.
const ROBOT_M: f64 = 0.45;
/// Poses per second.
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
const ADDED: &str = "the brown goal is added";
const PACE_MPS: f64 = 1.2;
/// Range within which the person knows of robots, metres.
const NEAR_M: f64 = 4.0;
/// Longest duration of a story, seconds.
const LONGEST_S: f64 = 180.0;

fn hall() -> Warehouse {
    let blocks = Blocks { name: "hall".into(), groups: (2, 2), blocks: (3, 7), ..Blocks::default() };
    blocks.draft().build().expect("these parameters make a map, a test builds it")
}

/// Robots that wander.
struct Crowd {
    dice: Dice,
    /// For each robot: the previous, the present and the next node.
    robots: Vec<[NodeId; 3]>,
}

impl Crowd {
    fn new(w: &Warehouse, seed: u64) -> Crowd {
        let aisles = w.nodes_where(|k| k == NodeKind::Aisle);
        let nearest = |at: Point| {
            let far = |n: &NodeId| (w.nodes[*n].at - at).norm();
            aisles.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).expect("a hall has aisles")
        };
        let mut robots = Vec::new();
        for x in ROADS {
            for k in 0..ROBOTS_A_GROUP {
                robots.push([nearest(Point::new(x, 5.5 * k as f64 + 2.0)); 3]);
            }
        }
        Crowd { dice: Dice::new(seed), robots }
    }

    /// Lets all robots choose their next node.
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

/// The person's errands: the next place, and the event text when the person sets off. The person walks the shortest
/// open way as far as it can be seen, and waits if there is none.
const ERRANDS: [(f64, f64, &str); 5] = [
    (7.0, 10.0, "walks north towards yellow"),
    (7.0, 13.0, "passes yellow"),
    (26.0, 13.0, "walks east: fits brown, cyan and purple"),
    (26.0, 19.0, "walks north: fits brown"),
    (32.0, 19.0, "walks east to brown"),
];

struct StoryPerson {
    pose: Pose,
    errand: usize,
}

impl StoryPerson {
    /// Walks for a tick; gives whether the person sets off on a new errand.
    fn walk(&mut self, all: &Distances) -> bool {
        let Some((x, y, _)) = ERRANDS.get(self.errand) else { return false };
        let mut near = all.walkways().expect("a hall has walkways").no_edges();
        for e in all.cut().iter() {
            if (all.walkways().expect("a hall has walkways").segment(e).point(0.5) - self.pose.at).norm()
                < NEAR_M
            {
                near.insert(e);
            }
        }
        let way = all.walkways().expect("a hall has walkways").path(self.pose.at, Point::new(*x, *y), &near);
        let mut left = PACE_MPS / RATE;
        for next in way.iter().flat_map(|w| &w.points[1..]) {
            let leg = Segment { a: self.pose.at, b: *next };
            if leg.length() > 1e-6 {
                self.pose.heading = leg.heading();
                self.pose.at = leg.point((left / leg.length()).min(1.0));
                left -= leg.length();
            }
            if left <= 0.0 {
                break;
            }
        }
        let arrived = (self.pose.at - Point::new(*x, *y)).norm() < 0.05;
        self.errand += usize::from(arrived);
        arrived
    }
}

/// Tells the story.
pub(super) fn tell(method: Method, seed: u64) -> Story {
    let w = hall();
    let mut all = Distances::over(Arc::new(Walkways::of(&w)));
    let mut recogniser = Intention::new(method, &Model::builtin());
    for (i, (.., x, y)) in GOALS.iter().enumerate() {
        all.add_goal(GoalId(i as u64), Point::new(*x, *y));
        if i as u64 != BROWN {
            recogniser.add_goal(GoalId(i as u64), 1.0).expect("three goals");
        }
    }
    let mut crowd = Crowd::new(&w, seed);
    let mut person = StoryPerson { pose: Pose { at: Point::new(7.0, 5.0), heading: FRAC_PI_2 }, errand: 0 };
    let mut events = vec![StoryEvent { at: 0.0, what: ERRANDS[0].2.into() }];
    let (mut beliefs, mut tick, mut stepped) = (Vec::new(), 0_u32, 0_u32);
    while person.errand < ERRANDS.len() && f64::from(tick) < LONGEST_S * RATE {
        let t = f64::from(tick) / RATE;
        while f64::from(stepped) * STEP_S <= t {
            crowd.step(&w);
            stepped += 1;
        }
        block(&mut all, &crowd.places(&w, (t / STEP_S).fract()));
        let added = events.iter().any(|e| e.what == ADDED);
        if !added && events.last().is_some_and(|e| e.what == ERRANDS[1].2 && t >= e.at + 1.0) {
            recogniser.add_goal(GoalId(BROWN), 1.0).expect("four goals");
            events.push(StoryEvent { at: t, what: ADDED.into() });
        }
        recogniser.observe(Time::from_secs_f64(t), person.pose.at, Some(person.pose.heading), &all);
        beliefs.push((t, recogniser.belief()));
        if person.walk(&all) {
            let next = ERRANDS.get(person.errand).map(|e| StoryEvent { at: t, what: e.2.into() });
            events.extend(next);
        }
        tick += 1;
    }
    Story {
        title: "A large hall with 24 robots".into(),
        subtitle: format!("{}; seed {seed}; brown becomes a goal on the way", name(method)),
        unit: "seconds",
        goals: GOALS.iter().map(|g| (g.0, g.1)).collect(),
        beliefs,
        events,
    }
}

/// Cuts the edges beneath robots.
fn block(all: &mut Distances, robots: &[Point]) {
    let mut cut = all.walkways().expect("a hall has walkways").no_edges();
    for at in robots {
        for e in all.walkways().expect("a hall has walkways").edges_within(*at, ROBOT_M) {
            cut.insert(e);
        }
    }
    all.set_cut(&cut);
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_people::human::Belief;

    const YELLOW: GoalId = GoalId(0);

    #[test]
    fn the_order_of_events_is_that_of_the_thesis_whichever_way_the_robots_wander() {
        for (method, seed) in [1, 2, 3].into_iter().flat_map(|s| [(Method::Chapter3, s), (Method::Detour, s)])
        {
            let story = tell(method, seed);
            let at = |words: &str, later: f64| story.at(story.when(words) + later);
            let context = format!("{method:?}, seed {seed}");
            let best = |b: &Belief| {
                b.goals.iter().copied().fold((BROWN, 0.0), |m, g| if g.1 > m.1 { (g.0.0, g.1) } else { m })
            };
            assert_eq!(best(at("passes yellow", -0.3)).0, 0, "{context}");
            let added = at("is added", 0.1);
            assert!(added.goals.len() == 4 && added.of(YELLOW) < 0.5, "{context}: {added:?}");
            let east = at("walks north: fits brown", -1.0);
            assert!(east.of(YELLOW) < 0.2, "{context}: {east:?}");
            let end = &story.beliefs[story.beliefs.len() - 1];
            assert!(end.0 < LONGEST_S - 1.0, "{context}: it never arrived");
            assert_eq!(best(&end.1).0, BROWN, "{context}: {end:?}");
            assert!(story.beliefs.iter().all(|(_, b)| (b.sum() - 1.0).abs() < 1e-9), "{context}");
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
