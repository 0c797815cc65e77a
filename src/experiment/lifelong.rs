//! Lifelong planning on benchmark floors: every robot visits an endless list of goals; how many are reached per step?
//!
//! Main function: [`run`]. The planner is the product's own: each route is start → goal → own parking cell for ever
//! (planning.md section 3), under pebble rules with or without turns. An independent check looks at every step of every
//! robot. Refuses: to trust the timeline for that check, and to look at a clock.

use super::grid::Grid;
use crate::id::{NodeId, RobotId};
use crate::route::{Ask, NO_PEOPLE, Planner, Route, Rules, Stage};
use crate::time::{Span, Time};
use crate::timeline::{Holder, Timeline, Visit};

/// One step.
const STEP: Span = Span(1_000_000);

/// What to run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Start cells, one per robot; also where it parks.
    pub starts: Vec<NodeId>,
    /// Goals; robot `i` of `k` takes entries `i`, `i + k`, `i + 2k`, …
    pub tasks: Vec<NodeId>,
    /// How long.
    pub steps: usize,
    /// Whether quarter turns take a step.
    pub turns: bool,
    /// Every how many steps all robots are planned again in turn; zero for never.
    pub improve_every: usize,
    /// Labels that one search may expand.
    pub budget: u32,
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Goals reached.
    pub tasks: usize,
    /// Goals reached per step.
    pub tasks_per_step: f64,
    /// Times two robots were on one cell.
    pub vertex_conflicts: usize,
    /// Times two robots changed places.
    pub swaps: usize,
    /// Times a robot moved farther than one cell in a step.
    pub jumps: usize,
    /// Searches.
    pub plans: usize,
    /// Searches without a result.
    pub failures: usize,
    /// Labels expanded in all.
    pub expansions: u64,
}

struct Robot {
    holder: Holder,
    home: NodeId,
    next_task: usize,
    /// Serial number of the visit at the goal, while one is planned.
    goal: Option<u64>,
    retry: i64,
    track: Vec<NodeId>,
}

struct Run<'a> {
    setup: &'a Setup,
    grid: &'a Grid,
    timeline: Timeline,
    planner: Planner,
    robots: Vec<Robot>,
    out: Outcome,
}

/// Parses a benchmark list: a count, then that many linear cells.
///
/// # Errors
/// What is wrong, in words.
pub fn parse_cells(grid: &Grid, text: &str) -> Result<Vec<NodeId>, String> {
    let mut numbers = text.split_whitespace().map(str::parse::<usize>);
    let count = numbers.next().and_then(Result::ok).ok_or("the list starts with a count")?;
    let cells: Vec<usize> = numbers.collect::<Result<_, _>>().map_err(|e| format!("not a cell: {e}"))?;
    if cells.len() < count {
        return Err(format!("the list promises {count} cells but has {}", cells.len()));
    }
    let node = |c: &usize| grid.node(*c).ok_or(format!("cell {c} is not free floor"));
    cells[..count].iter().map(node).collect()
}

/// Runs the benchmark; `progress` is called after each step.
///
/// # Panics
/// If start cells are not distinct.
pub fn run(grid: &Grid, setup: &Setup, mut progress: impl FnMut(usize)) -> Outcome {
    let rules = Rules::Pebble { step: STEP, turns: setup.turns };
    let mut run = Run {
        setup,
        grid,
        timeline: Timeline::new(grid.warehouse.clone(), Span::ZERO),
        planner: Planner::new(grid.warehouse.clone(), rules),
        robots: Vec::new(),
        out: Outcome::default(),
    };
    run.place();
    for step in 0..setup.steps {
        run.step(step as i64);
        progress(step);
    }
    run.out.tasks_per_step = run.out.tasks as f64 / setup.steps as f64;
    run.check();
    run.out
}

impl Run<'_> {
    fn place(&mut self) {
        for (i, &home) in self.setup.starts.iter().enumerate() {
            let holder = Holder::Robot(RobotId(i as u32));
            let start = Visit {
                node: home,
                lane: None,
                enter: Time(0),
                arrive: Time(0),
                depart: Time::MAX,
                leave: Time::MAX,
                stay: Span::ZERO,
            };
            self.timeline.reserve(holder, vec![start]).expect("start cells are distinct");
            self.robots.push(Robot { holder, home, next_task: i, goal: None, retry: 0, track: vec![] });
        }
    }

    /// Advances everybody to `step`, then plans for those without a goal.
    fn step(&mut self, step: i64) {
        let now = Time(step * STEP.0);
        for i in 0..self.robots.len() {
            self.advance(i, now);
        }
        for i in 0..self.robots.len() {
            if self.robots[i].goal.is_none() && self.robots[i].retry <= step {
                self.plan_next(i, step);
            }
        }
        if self.setup.improve_every > 0 && (step as usize + 1).is_multiple_of(self.setup.improve_every) {
            for i in 0..self.robots.len() {
                self.improve(i, now);
            }
        }
    }

    fn advance(&mut self, i: usize, now: Time) {
        let holder = self.robots[i].holder;
        let chain = self.timeline.chain(holder).expect("placed");
        let left = chain.visits().take_while(|v| v.leave <= now).count() as u64;
        let here = chain.first() + left;
        self.timeline.release(holder, here);
        let visit = self.timeline.chain(holder).and_then(|c| c.get(here)).expect("a chain has no holes");
        self.robots[i].track.push(visit.node);
        let robot = &mut self.robots[i];
        if robot.goal == Some(here) && visit.arrive <= now {
            robot.goal = None;
            robot.next_task += self.setup.starts.len();
            self.out.tasks += 1;
        }
    }

    fn plan_next(&mut self, i: usize, step: i64) {
        let now = Time(step * STEP.0);
        match self.search(i, now) {
            Some(route) => self.commit(i, route),
            None => self.robots[i].retry = step + 3,
        }
    }

    /// Plans a robot with a goal again and keeps the result where the goal is reached earlier.
    fn improve(&mut self, i: usize, now: Time) {
        let Some(goal) = self.robots[i].goal else { return };
        let chain = self.timeline.chain(self.robots[i].holder).expect("placed");
        let planned = chain.get(goal).expect("the goal is ahead").arrive;
        if let Some(route) = self.search(i, now)
            && reached(&route) < planned
        {
            self.commit(i, route);
        }
    }

    fn search(&mut self, i: usize, now: Time) -> Option<Route> {
        let robot = &self.robots[i];
        let goal = self.setup.tasks[robot.next_task % self.setup.tasks.len()];
        let stage = |goal| Stage { goal, loaded: false, stay: Span::ZERO };
        let stages = [stage(goal), stage(robot.home)];
        let here = self.timeline.chain(robot.holder)?.visits().next()?.clone();
        let heading = self.heading(i);
        let ask = Ask {
            from: &here,
            heading,
            ready: now,
            stages: &stages,
            budget: self.setup.budget,
            conditions: &NO_PEOPLE,
            away: &[],
        };
        let planner = &mut self.planner;
        let found = self.timeline.without(&[robot.holder], |others| planner.plan(&ask, others));
        self.out.plans += 1;
        match found {
            Ok(route) => {
                self.out.expansions += u64::from(route.expansions);
                Some(route)
            }
            Err(_) => {
                self.out.failures += 1;
                None
            }
        }
    }

    /// The heading with which the robot came, east at first. Turns that are under way are not remembered.
    fn heading(&self, i: usize) -> f64 {
        let track = &self.robots[i].track;
        let at = |n: NodeId| self.grid.warehouse.nodes[n].at;
        let moved = track.windows(2).rev().find(|w| w[0] != w[1]);
        moved.map_or(0.0, |w| crate::geometry::Segment { a: at(w[0]), b: at(w[1]) }.heading())
    }

    fn commit(&mut self, i: usize, route: Route) {
        let robot = &mut self.robots[i];
        let keep = self.timeline.chain(robot.holder).expect("placed").first();
        robot.goal = Some(keep + route.stops[0] as u64);
        let reserved = self.timeline.replace(robot.holder, keep, route.kept, route.visits);
        reserved.expect("the search uses only free windows");
    }

    /// Looks at the tracks alone: cells taken twice, places exchanged, moves beyond a neighbour.
    fn check(&mut self) {
        let nodes = self.grid.warehouse.nodes.len();
        let mut before = vec![usize::MAX; nodes];
        for step in 0..self.setup.steps {
            let mut here = vec![usize::MAX; nodes];
            for (i, robot) in self.robots.iter().enumerate() {
                let cell = robot.track[step];
                let taken = std::mem::replace(&mut here[cell.0 as usize], i);
                self.out.vertex_conflicts += usize::from(taken != usize::MAX);
                let Some(last) = step.checked_sub(1).map(|s| robot.track[s]) else { continue };
                self.out.jumps += usize::from(!self.grid.adjacent(last, cell));
                let other = before[cell.0 as usize];
                let swapped = last != cell
                    && other != usize::MAX
                    && other < i
                    && self.robots[other].track[step] == last
                    && self.robots[other].track[step - 1] == cell;
                self.out.swaps += usize::from(swapped);
            }
            // A pair is seen once: the one with the larger number looks at the smaller one.
            before = here;
        }
    }
}

/// When a route reaches its first goal.
fn reached(route: &Route) -> Time {
    route.first_arrival()
}
