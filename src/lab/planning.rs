//! How long one route takes to plan while all other robots hold theirs.
//!
//! Main function: [`run`]. Many robots hold routes as in operation: as many racks are bound for each station as it has
//! places, as many robots bring a rack to storage, all others go to a rack; departures are spread over a minute. Then
//! single robots in turn get a new errand of their kind, planned against all others. With a weight, each errand is
//! planned a second time with the way ahead weighted ([`Planner::weigh`]), and compared; robots keep the plain route.
//! Refuses: to look at a clock itself; the caller passes a stopwatch in.

use giveway_floor::id::{BodyId, Dense, NodeId, RobotId, StationId};
use giveway_floor::route::{Kinematics, NO_PEOPLE, NoRoute, Planner, Route, RouteQuery, Rules, Stage};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Timeline, Visit};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_sim::starting_places;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Parameters of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct PlanningSetup {
    /// Number of robots that hold routes.
    pub robots: usize,
    /// Number of single routes to plan.
    pub queries: usize,
    /// Labels that one search may expand.
    pub budget: u32,
    /// Seed of the errands.
    pub seed: u64,
    /// The weight to compare; zero for no comparison.
    pub weight: f64,
}

/// Effect of a weight on searches.
#[derive(Clone, Debug, Default)]
pub struct Weighted {
    /// Searches that found a route, nanoseconds, ascending.
    pub found_ns: Vec<u64>,
    /// Searches that found none, nanoseconds.
    pub failed_ns: Vec<u64>,
    /// Labels expanded per search that found a route, ascending.
    pub expansions: Vec<u32>,
    /// Time to the last goal, relative to the plain search, ascending; only errands without hurry for which both found
    /// a route.
    pub last: Vec<f64>,
    /// Time to the first goal, relative to the plain search.
    pub first: Vec<f64>,
    /// Number of errands for which only the plain search found a route, then of those for which only the weighted one
    /// did.
    pub only: [usize; 2],
}

/// Results of the measurement.
#[derive(Clone, Debug, Default)]
pub struct PlanningOutcome {
    /// Searches that found a route, nanoseconds, ascending.
    pub found_ns: Vec<u64>,
    /// Searches that found none, nanoseconds, ascending.
    pub failed_ns: Vec<u64>,
    /// Total time of the first plans of all robots one after another on the empty floor, nanoseconds.
    pub cold_ns: u64,
    /// Number of robots with a route to another place than where they stand.
    pub routes: usize,
    /// Number of reservations on all resources.
    pub holds: usize,
    /// Labels expanded per search, ascending.
    pub expansions: Vec<u32>,
    /// Memory of the lower bounds, bytes.
    pub estimate_bytes: usize,
    /// Results with a weight, if one was given.
    pub weighted: Weighted,
}

struct PlanningCrowd {
    timeline: Timeline,
    planner: Planner,
    starts: Vec<NodeId>,
    ready: Vec<Time>,
    budget: u32,
    random: u64,
}

/// Plans single routes among many held ones.
pub fn run(
    warehouse: &Arc<Warehouse>,
    setup: &PlanningSetup,
    stopwatch: fn() -> u64,
    mut progress: impl FnMut(usize),
) -> PlanningOutcome {
    let PlanningSetup { robots, queries, budget, seed, weight } = *setup;
    let kinematics = Kinematics::default();
    let mut crowd = PlanningCrowd {
        timeline: Timeline::new(warehouse.clone(), kinematics.clearance),
        planner: Planner::new(warehouse.clone(), Rules::Drive(kinematics)),
        starts: starting_places(warehouse, robots, |_| BodyId(0)),
        ready: Vec::new(),
        budget,
        random: seed.wrapping_mul(2).wrapping_add(1),
    };
    let mut out = PlanningOutcome::default();
    crowd.ready = crowd.starts.clone().iter().map(|_| Time(crowd.below(60_000_000) as i64)).collect();
    for (i, &node) in crowd.starts.iter().enumerate() {
        let stand = giveway_fleet::state::ledger::stand(node, Time::ZERO);
        let holder = RobotId::at(i);
        crowd
            .timeline
            .reserve(holder, vec![stand])
            .expect("starting places are distinct and do not conflict");
    }
    let begin = stopwatch();
    for i in 0..crowd.starts.len() {
        let errand = crowd.errand(i);
        if let Ok(route) = crowd.search(i, &errand) {
            crowd.commit(i, route);
        }
    }
    out.cold_ns = stopwatch() - begin;
    for query in 0..queries {
        let i = crowd.below(crowd.starts.len());
        let errand = crowd.errand(i);
        for stage in &errand {
            crowd.planner.estimates().table(stage.goal, stage.loaded);
        }
        // The second search finds caches warm: the two take turns.
        let weighted_first = query % 2 == 1;
        let early = (weight > 0.0 && weighted_first).then(|| crowd.timed(i, &errand, weight, stopwatch));
        let (found, ns) = crowd.timed(i, &errand, 0.0, stopwatch);
        let late = (weight > 0.0 && !weighted_first).then(|| crowd.timed(i, &errand, weight, stopwatch));
        if let Some((other, ns)) = early.or(late) {
            out.weighted.note(&found, &other, ns, crowd.ready[i], budget);
        }
        match found {
            Ok(route) => {
                out.found_ns.push(ns);
                out.expansions.push(route.expansions);
                crowd.commit(i, route);
            }
            Err(_) => out.failed_ns.push(ns),
        }
        progress(query);
    }
    crowd.sum_up(&mut out);
    out
}

impl PlanningCrowd {
    /// A small generator of random-looking numbers (xorshift): the figures need variety, not quality.
    fn below(&mut self, n: usize) -> usize {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as usize % n.max(1)
    }

    /// A robot's errand: a rack to a station and back, a rack to another storage node, or only a way to one. Kinds are
    /// dealt to robots by number, so that they are spread over the floor.
    fn errand(&mut self, robot: usize) -> Vec<Stage> {
        let w = self.planner.warehouse().clone();
        let stage = |goal, loaded, stay| Stage { goal, loaded, lifts: false, stay: Span::from_millis(stay) };
        let from_storage = w.nodes[self.starts[robot]].kind == NodeKind::Storage;
        let stations = w.stations.pairs();
        let places: Vec<StationId> =
            stations.flat_map(|(s, station)| std::iter::repeat_n(s, station.queue.len() + 1)).collect();
        let kinds = (self.starts.len() / places.len().max(1)).max(2);
        if from_storage && robot.is_multiple_of(kinds) && robot / kinds < places.len() {
            // Robots with neighbouring numbers go to stations far apart.
            let station = places[robot / kinds * 7 % places.len()];
            return vec![
                stage(w.stations[station].node, true, 8_000),
                stage(self.starts[robot], true, 2_200),
            ];
        }
        let loaded = from_storage && robot % kinds == 1;
        vec![stage(self.free_storage(robot), loaded, 2_200)]
    }

    fn free_storage(&mut self, robot: usize) -> NodeId {
        let places = self.planner.warehouse().nodes_where(|k| k == NodeKind::Storage);
        let others = self.timeline.chains().filter(|(h, _)| *h != RobotId::at(robot));
        let taken: BTreeSet<NodeId> = others.filter_map(|(_, chain)| chain.last()).map(|v| v.node).collect();
        loop {
            let goal = places[self.below(places.len())];
            if !taken.contains(&goal) {
                return goal;
            }
        }
    }

    fn search(&mut self, robot: usize, stages: &[Stage]) -> Result<Route, NoRoute> {
        let holder = RobotId::at(robot);
        let first: Visit = self.timeline.chain(holder).and_then(|c| c.get(0)).expect("placed").clone();
        let ask = RouteQuery {
            from: &first,
            heading: 0.0,
            ready: self.ready[robot],
            stages,
            budget: self.budget,
            conditions: &NO_PEOPLE,
            exemptions: &[],
        };
        self.planner.plan(&ask, &self.timeline.without(&[holder]))
    }

    /// A search with a weight, with its duration, nanoseconds.
    fn timed(
        &mut self,
        robot: usize,
        stages: &[Stage],
        weight: f64,
        stopwatch: fn() -> u64,
    ) -> (Result<Route, NoRoute>, u64) {
        self.planner.weigh(weight);
        let begin = stopwatch();
        let found = self.search(robot, stages);
        (found, stopwatch() - begin)
    }

    fn commit(&mut self, robot: usize, route: Route) {
        let holder = RobotId::at(robot);
        let reserved = self.timeline.replace(holder, 0, route.kept, route.visits);
        reserved.expect("the search uses only free windows");
    }

    fn sum_up(&mut self, out: &mut PlanningOutcome) {
        out.routes = self.timeline.chains().filter(|(_, c)| c.visits().len() > 1).count();
        out.holds = self.timeline.chains().map(|(_, c)| c.visits().len()).sum();
        out.estimate_bytes = self.planner.estimates().bytes();
        out.found_ns.sort_unstable();
        out.failed_ns.sort_unstable();
        out.expansions.sort_unstable();
        out.weighted.sort();
    }
}

impl Weighted {
    fn note(
        &mut self,
        plain: &Result<Route, NoRoute>,
        found: &Result<Route, NoRoute>,
        ns: u64,
        ready: Time,
        budget: u32,
    ) {
        match found {
            Ok(route) => {
                self.found_ns.push(ns);
                self.expansions.push(route.expansions);
            }
            Err(_) => self.failed_ns.push(ns),
        }
        match (plain, found) {
            (Ok(plain), Ok(found)) if plain.expansions.max(found.expansions) < budget / 2 => {
                let ratio = |f: fn(&Route) -> Time| {
                    let (plain, found) = ((f(plain) - ready).0, (f(found) - ready).0);
                    (plain > 0).then(|| found as f64 / plain as f64)
                };
                self.last.extend(ratio(|r| r.arrival));
                self.first.extend(ratio(Route::first_arrival));
            }
            (Ok(_), Err(_)) => self.only[0] += 1,
            (Err(_), Ok(_)) => self.only[1] += 1,
            _ => {}
        }
    }

    fn sort(&mut self) {
        self.found_ns.sort_unstable();
        self.failed_ns.sort_unstable();
        self.expansions.sort_unstable();
        self.last.sort_by(f64::total_cmp);
        self.first.sort_by(f64::total_cmp);
    }
}
