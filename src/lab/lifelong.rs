//! Lifelong planning on benchmark floors: every robot visits an endless list of goals; how many are reached per step?
//!
//! Main function: [`run`]. The planner is the product's own: each route is start → goal → own parking cell for ever
//! (planning.md section 3), under pebble rules with or without turns. An independent check examines every step of every
//! robot. Refuses: to trust the timeline for that check, and to look at a clock.
//!
//! Goals are counted as the League of Agent Runners counts them: a robot that is on its goal's cell at a step has
//! reached it, whether or not it meant to stop there, and it reaches at most one goal per step. So a list that names
//! the same cell for ever does not stall: the robot stays there and reaches one goal per step.

use super::grid::Grid;
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{NO_PEOPLE, Planner, Route, RouteQuery, Rules, Stage};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Timeline, Visit};
use std::collections::BTreeSet;

/// Duration of one step.
const STEP: Span = Span(1_000_000);

/// Parameters of a run.
#[derive(Clone, Debug)]
pub struct LifelongSetup {
    /// Start cells, one per robot; also where it parks.
    pub starts: Vec<NodeId>,
    /// Goals; robot `i` of `k` takes entries `i`, `i + k`, `i + 2k`, …
    pub tasks: Vec<NodeId>,
    /// Number of steps.
    pub steps: usize,
    /// Whether quarter turns take a step.
    pub turns: bool,
    /// Number of steps between two rounds in which all robots are planned again; zero for never.
    pub improve_every: usize,
    /// Labels that one search may expand.
    pub budget: u32,
}

/// Results of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LifelongOutcome {
    /// Goals reached.
    pub tasks: usize,
    /// Goals reached per step.
    pub tasks_per_step: f64,
    /// How often two robots were on one cell.
    pub vertex_conflicts: usize,
    /// How often two robots swapped cells.
    pub swaps: usize,
    /// How often a robot moved farther than one cell in a step.
    pub jumps: usize,
    /// Number of searches.
    pub plans: usize,
    /// Number of searches without a result.
    pub failures: usize,
    /// Total number of expanded labels.
    pub expansions: u64,
}

struct Agent {
    holder: RobotId,
    home: NodeId,
    next_task: usize,
    /// When the robot's route reaches the goal; nothing if none is planned.
    reaches: Option<Time>,
    /// The step at which a failed search is tried again.
    retry: i64,
    track: Vec<NodeId>,
}

struct Run<'a> {
    setup: &'a LifelongSetup,
    grid: &'a Grid,
    timeline: Timeline,
    planner: Planner,
    robots: Vec<Agent>,
    out: LifelongOutcome,
}

/// Parses a benchmark list: a count of at least one, then that many cells. Lines that start with `#` are skipped.
///
/// # Errors
/// What is wrong, in words.
pub fn parse_cells(grid: &Grid, text: &str) -> Result<Vec<NodeId>, String> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut numbers = lines.flat_map(str::split_whitespace).map(str::parse::<usize>);
    let count = numbers.next().and_then(Result::ok).ok_or("the list starts with a count")?;
    let cells: Vec<usize> = numbers.collect::<Result<_, _>>().map_err(|e| format!("not a cell: {e}"))?;
    if count == 0 {
        return Err("the list is empty; it needs at least one cell".into());
    }
    if cells.len() < count {
        return Err(format!("the list promises {count} cells but has {}", cells.len()));
    }
    let node = |c: &usize| grid.node(*c).ok_or(format!("cell {c} is not free floor"));
    cells[..count].iter().map(node).collect()
}

/// The first cell that occurs twice in the list. Every robot parks where it starts, so no two may start at one cell.
pub fn first_shared(cells: &[NodeId]) -> Option<NodeId> {
    let mut seen = BTreeSet::new();
    cells.iter().copied().find(|&cell| !seen.insert(cell))
}

/// Runs the benchmark; `progress` is called after each step.
///
/// # Panics
/// If start cells are not distinct, or there is no goal.
pub fn run(grid: &Grid, setup: &LifelongSetup, mut progress: impl FnMut(usize)) -> LifelongOutcome {
    assert!(!setup.tasks.is_empty(), "robots need goals");
    let rules = Rules::Pebble { step: STEP, turns: setup.turns };
    let mut run = Run {
        setup,
        grid,
        timeline: Timeline::new(grid.warehouse.clone(), Span::ZERO),
        planner: Planner::new(grid.warehouse.clone(), rules),
        robots: Vec::new(),
        out: LifelongOutcome::default(),
    };
    run.place();
    for step in 0..setup.steps {
        run.step(step as i64);
        progress(step);
    }
    run.out.tasks_per_step = run.out.tasks as f64 / setup.steps.max(1) as f64;
    run.check();
    run.out
}

impl Run<'_> {
    fn place(&mut self) {
        for (i, &home) in self.setup.starts.iter().enumerate() {
            let holder = RobotId(i as u32);
            let start = Visit {
                node: home,
                lane: None,
                loaded: false,
                enter: Time(0),
                arrive: Time(0),
                depart: Time::MAX,
                leave: Time::MAX,
                stay: Span::ZERO,
            };
            self.timeline.reserve(holder, vec![start]).expect("start cells are distinct");
            self.robots.push(Agent { holder, home, next_task: i, reaches: None, retry: 0, track: vec![] });
        }
    }

    /// Advances all robots to `step`, then plans for those without a route to their goal.
    fn step(&mut self, step: i64) {
        let now = Time(step * STEP.0);
        for i in 0..self.robots.len() {
            self.advance(i, now);
        }
        for i in 0..self.robots.len() {
            if self.robots[i].reaches.is_none() && self.robots[i].retry <= step {
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
        assert!(
            visit.arrive <= now,
            "under pebble rules a robot holds a cell from the step at which it is there"
        );
        let node = visit.node;
        let reached = node == self.goal(i);
        let robot = &mut self.robots[i];
        robot.track.push(node);
        if reached {
            robot.reaches = None;
            robot.retry = 0;
            robot.next_task += self.setup.starts.len();
            self.out.tasks += 1;
        }
        // Otherwise the robot would never be planned for again.
        assert!(
            robot.reaches.is_none_or(|goal| goal > now),
            "robot {i} is not on its goal at {now:?}, as planned"
        );
    }

    /// The robot's next goal cell.
    fn goal(&self, i: usize) -> NodeId {
        self.setup.tasks[self.robots[i].next_task % self.setup.tasks.len()]
    }

    fn plan_next(&mut self, i: usize, step: i64) {
        let now = Time(step * STEP.0);
        match self.search(i, now) {
            Some(route) => self.commit(i, route, now),
            None => self.robots[i].retry = step + 3,
        }
    }

    /// Plans a robot with a goal again, and keeps the result if it reaches the goal earlier.
    fn improve(&mut self, i: usize, now: Time) {
        let Some(planned) = self.robots[i].reaches else { return };
        if let Some(route) = self.search(i, now)
            && reached(&route, now) < planned
        {
            self.commit(i, route, now);
        }
    }

    fn search(&mut self, i: usize, now: Time) -> Option<Route> {
        let robot = &self.robots[i];
        let goal = self.goal(i);
        let here = self.timeline.chain(robot.holder)?.visits().next()?.clone();
        // A goal on this cell was counted at this step, so the next one on it needs the robot here at the next step.
        let stay = if here.node == goal { STEP } else { Span::ZERO };
        let stage = |goal, stay| Stage { stay, ..Stage::to_stay(goal) };
        let stages = [stage(goal, stay), stage(robot.home, Span::ZERO)];
        let heading = self.heading(i);
        let ask = RouteQuery {
            from: &here,
            heading,
            ready: now,
            stages: &stages,
            budget: self.setup.budget,
            conditions: &NO_PEOPLE,
            exemptions: &[],
        };
        let found = self.planner.plan(&ask, &self.timeline.without(&[robot.holder]));
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

    /// The heading of the robot's last move, east at first. Unfinished turns are not remembered.
    fn heading(&self, i: usize) -> f64 {
        let track = &self.robots[i].track;
        let at = |n: NodeId| self.grid.warehouse.nodes[n].at;
        let moved = track.windows(2).rev().find(|w| w[0] != w[1]);
        moved.map_or(0.0, |w| giveway_floor::geometry::Segment { a: at(w[0]), b: at(w[1]) }.heading())
    }

    fn commit(&mut self, i: usize, route: Route, now: Time) {
        let robot = &mut self.robots[i];
        let keep = self.timeline.chain(robot.holder).expect("placed").first();
        robot.reaches = Some(reached(&route, now));
        let reserved = self.timeline.replace(robot.holder, keep, route.kept, route.visits);
        reserved.expect("the search uses only free windows");
    }

    /// Checks the tracks alone: cells taken twice, swaps, moves beyond a neighbour.
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
            // Each pair is checked once: by the robot with the larger number.
            before = here;
        }
    }
}

/// When a route planned `now` reaches its first goal; for a goal on the starting cell, at the next step.
fn reached(route: &Route, now: Time) -> Time {
    route.first_arrival().max(now + STEP)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Seven cells in a row, numbers 0 to 6, with a bay below each of the first three, numbers 7 to 9.
    const CORRIDOR: &str = "type octile\nheight 2\nwidth 7\nmap\n.......\n...@@@@\n";

    fn corridor() -> Grid {
        Grid::parse(CORRIDOR).expect("a floor")
    }

    fn setup(grid: &Grid, starts: &str, tasks: &str) -> LifelongSetup {
        let cells = |text| parse_cells(grid, text).expect("cells of the floor");
        let (starts, tasks) = (cells(starts), cells(tasks));
        LifelongSetup { starts, tasks, steps: 12, turns: false, improve_every: 1, budget: 1000 }
    }

    /// Number of goals reached in twelve steps by robots from these cells.
    fn reached_by(starts: &str, tasks: &str) -> usize {
        let grid = corridor();
        let out = run(&grid, &setup(&grid, starts, tasks), |_| {});
        assert_eq!([out.vertex_conflicts, out.swaps, out.jumps], [0; 3]);
        out.tasks
    }

    #[test]
    fn lists_are_read_with_comments_and_refused_in_words_where_no_robot_could_use_them() {
        let grid = corridor();
        let read = |text| parse_cells(&grid, text).map(|cells| cells.len());
        assert_eq!(read("# version for LoRR 2026\n2\n0\n6\n"), Ok(2));
        assert_eq!(read("0\n"), Err("the list is empty; it needs at least one cell".into()));
        assert_eq!(read("2\n0\n"), Err("the list promises 2 cells but has 1".into()));
        assert_eq!(read("1\n11\n"), Err("cell 11 is not free floor".into()));
    }

    #[test]
    fn a_start_cell_that_two_robots_share_is_found() {
        let cells = |text| parse_cells(&corridor(), text).expect("cells of the floor");
        assert_eq!(first_shared(&cells("4 3 0 1 0")), corridor().node(0));
        assert_eq!(first_shared(&cells("3 3 0 1")), None);
    }

    #[test]
    fn a_goal_where_the_robot_stands_at_the_start_is_reached_in_the_first_step() {
        // Step 0: cell 0; step 6: cell 6; step 12 is not simulated.
        assert_eq!(reached_by("1 0", "2 0 6"), 2);
    }

    #[test]
    fn the_same_goal_twice_in_a_row_is_reached_in_two_successive_steps() {
        // Steps 5 and 6: cell 5; step 11: cell 0.
        assert_eq!(reached_by("1 0", "3 5 5 0"), 3);
    }

    #[test]
    fn a_list_of_one_cell_is_reached_once_a_step_and_ends() {
        // Steps 3 to 11.
        assert_eq!(reached_by("1 0", "1 3"), 9);
    }

    #[test]
    fn a_goal_on_the_way_back_is_reached_in_passing() {
        // Steps 6, 7, 8, 9, 10, 11: cells 6 to 1.
        assert_eq!(reached_by("1 0", "6 6 5 4 3 2 1"), 6);
    }

    #[test]
    fn two_robots_that_exchange_goals_all_the_time_get_round_one_another() {
        // Goals 5 and 6 in turn, parking in the bays of cells 0 and 1.
        assert!(reached_by("2 7 8", "4 5 6 6 5") >= 2);
    }

    #[test]
    fn two_robots_that_want_each_others_parking_cell_wait_and_the_run_ends() {
        let grid = corridor();
        let out = run(&grid, &setup(&grid, "2 7 8", "2 8 7"), |_| {});
        assert_eq!(out.tasks, 0);
        assert!(out.failures > 0);
    }

    proptest! {
        #[test]
        fn no_list_of_goals_makes_the_run_panic_collide_or_count_twice_in_a_step(
            homes in prop::sample::subsequence((0usize..10).collect::<Vec<_>>(), 1..4),
            goals in prop::collection::vec(0usize..10, 1..8),
            turns: bool,
            improve_every in 0usize..3,
        ) {
            let grid = corridor();
            let nodes = |cells: &[usize]| cells.iter().map(|&c| grid.node(c).expect("free")).collect();
            let (starts, tasks) = (nodes(&homes), nodes(&goals));
            let setup = LifelongSetup { starts, tasks, steps: 25, turns, improve_every, budget: 1000 };
            let out = run(&grid, &setup, |_| {});
            prop_assert_eq!([out.vertex_conflicts, out.swaps, out.jumps], [0; 3]);
            prop_assert!(out.tasks <= setup.steps * homes.len());
        }
    }
}
