//! Distances on foot from anywhere to each goal, on the floor as it is now.
//!
//! Main types: [`Distances`] (goals × nodes of the walkways; the matrix F of Petković 2021, section 3.3, kept up to
//! date by repair instead of computed anew), [`Vantage`] (one place, from which several goals are evaluated). On a
//! small floor, tiles with the same goals can lie beneath. Refuses: to know whose goals they are, and why edges are
//! cut.

use super::field::{Field, Graph};
use super::tiles::Tiles;
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{Dense, GoalId, WalkEdgeId, WalkNodeId};
use giveway_floor::warehouse::walkway::{EdgeSet, Walkways};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Range within which a goal can be straight ahead, metres; farther goals are reached along the graph.
const STRAIGHT_M: f64 = 2.5;
/// Ways whose lengths differ by less than this count as the same way, metres.
const SAME_WAY_M: f64 = 0.02;
/// A cut this near to a goal may change how the goal is joined to the graph, metres.
const AROUND_GOAL_M: f64 = 11.0;

/// Distances to all goals.
#[derive(Clone, Debug)]
pub struct Distances {
    /// The walkways; nothing in the open, where people walk straight anywhere.
    walkways: Option<Arc<Walkways>>,
    graph: Graph,
    cut: EdgeSet,
    goals: BTreeMap<GoalId, GoalCells>,
    /// The same floor as tiles, if requested.
    tiles: Option<Tiles>,
}

#[derive(Clone, Debug)]
struct GoalCells {
    at: Point,
    field: Field,
}

impl Distances {
    /// Distances without goals and without cut edges.
    pub fn over(walkways: Arc<Walkways>) -> Distances {
        let edges: Vec<(usize, usize, f64)> =
            walkways.edges().iter().map(|e| (e.a.ix(), e.b.ix(), e.length_m)).collect();
        let graph = Graph::new(walkways.nodes().len(), &edges);
        let (cut, goals) = (walkways.no_edges(), BTreeMap::new());
        Distances { cut, walkways: Some(walkways), graph, goals, tiles: None }
    }

    /// Adds tiles of the same floor, which get the goals that are added from now on.
    pub fn with_tiles(self, tiles: Tiles) -> Distances {
        Distances { tiles: Some(tiles), ..self }
    }

    /// The tiles, if there are any.
    pub fn tiles(&self) -> Option<&Tiles> {
        self.tiles.as_ref()
    }

    /// A floor without walls: everything is as far as the crow flies. For recordings without a map.
    pub fn in_the_open() -> Distances {
        let graph = Graph::new(0, &[]);
        Distances { cut: EdgeSet::default(), walkways: None, graph, goals: BTreeMap::new(), tiles: None }
    }

    /// The walkways beneath; nothing in the open.
    pub fn walkways(&self) -> Option<&Walkways> {
        self.walkways.as_deref()
    }

    /// The edges that are cut now.
    pub fn cut(&self) -> &EdgeSet {
        &self.cut
    }

    /// Adds a goal, or moves it.
    pub fn add_goal(&mut self, goal: GoalId, at: Point) {
        let field = Field::new(&self.graph, &self.seeds(at), |e| !self.cut.contains(WalkEdgeId::at(e)));
        self.goals.insert(goal, GoalCells { at, field });
        if let Some(tiles) = &mut self.tiles {
            tiles.add_goal(goal, at);
        }
    }

    /// Forgets a goal.
    pub fn remove_goal(&mut self, goal: GoalId) {
        self.goals.remove(&goal);
        if let Some(tiles) = &mut self.tiles {
            tiles.remove_goal(goal);
        }
    }

    /// All goals with their positions.
    pub fn goals(&self) -> impl Iterator<Item = (GoalId, Point)> {
        self.goals.iter().map(|(id, goal)| (*id, goal.at))
    }

    /// Position of a goal.
    pub fn place(&self, goal: GoalId) -> Option<Point> {
        self.goals.get(&goal).map(|g| g.at)
    }

    /// Makes `cut` the set of cut edges, and repairs only what changed.
    pub fn set_cut(&mut self, cut: &EdgeSet) {
        if *cut == self.cut {
            return;
        }
        let differs = |e: &WalkEdgeId| cut.contains(*e) != self.cut.contains(*e);
        let Some(walkways) = self.walkways.clone() else { return };
        let changed: Vec<WalkEdgeId> = walkways.edges().ids().filter(differs).collect();
        self.cut.clone_from(cut);
        let numbers: Vec<usize> = changed.iter().map(|e| e.ix()).collect();
        let mut goals = std::mem::take(&mut self.goals);
        for goal in goals.values_mut() {
            let near = |e: &WalkEdgeId| (walkways.segment(*e).a - goal.at).norm() < AROUND_GOAL_M;
            let seeds = changed.iter().any(near).then(|| self.seeds(goal.at));
            let open = |e: usize| !cut.contains(WalkEdgeId::at(e));
            goal.field.repair(&self.graph, &numbers, seeds.as_deref(), open);
        }
        self.goals = goals;
    }

    fn seeds(&self, at: Point) -> Vec<(usize, f64)> {
        let Some(walkways) = &self.walkways else { return Vec::new() };
        walkways.doorsteps(at, &self.cut).into_iter().map(|(n, m)| (n.ix(), m)).collect()
    }

    /// Metres from a node of the walkways to a goal; nothing if the goal is unknown or no way leads to it.
    pub fn from_node(&self, n: WalkNodeId, goal: GoalId) -> Option<f64> {
        self.goals.get(&goal)?.field.metres(n.ix())
    }

    /// The walkways as seen from one place, to evaluate several goals.
    pub fn from(&self, at: Point) -> Vantage<'_> {
        let Some(walkways) = &self.walkways else { return Vantage { all: self, at, steps: Vec::new() } };
        let at = walkways.on_floor(at).unwrap_or(at);
        Vantage { all: self, at, steps: walkways.doorsteps(at, &self.cut) }
    }

    /// Metres from a point to a goal; nothing if no way leads there.
    pub fn to_goal(&self, goal: GoalId, at: Point) -> Option<f64> {
        self.from(at).to_goal(goal)
    }

    /// The direction in which the way to a goal begins, radians.
    pub fn towards(&self, goal: GoalId, at: Point) -> Option<f64> {
        self.from(at).towards(goal)
    }
}

/// One place, with the nodes that can be reached straight from there.
#[derive(Clone, Debug)]
pub struct Vantage<'a> {
    all: &'a Distances,
    at: Point,
    steps: Vec<(WalkNodeId, f64)>,
}

impl Vantage<'_> {
    /// The nodes in sight, with their distances in metres.
    pub fn steps(&self) -> &[(WalkNodeId, f64)] {
        &self.steps
    }

    /// Position of the goal, if it can be reached straight.
    fn straight(&self, goal: GoalId) -> Option<(Point, f64)> {
        let to = self.all.place(goal)?;
        let away = (to - self.at).norm();
        let Some(walkways) = &self.all.walkways else { return Some((to, away)) };
        (away <= STRAIGHT_M && walkways.sees_past(self.at, to, &self.all.cut)).then_some((to, away))
    }

    /// Ways over each node in sight: the node's position, its distance, and the total length, metres.
    fn ways(&self, goal: GoalId) -> impl Iterator<Item = (Point, f64, f64)> {
        let nodes = self
            .all
            .walkways
            .iter()
            .flat_map(|w| self.steps.iter().map(move |(n, away)| (w.nodes()[*n].at, *n, *away)));
        nodes.filter_map(move |(at, n, away)| Some((at, away, away + self.all.from_node(n, goal)?)))
    }

    /// Metres to a goal: straight, or the shortest way over a node in sight (the leg to the node counts, which
    /// eq. 3.14 of Petković 2021 leaves out).
    pub fn to_goal(&self, goal: GoalId) -> Option<f64> {
        if let Some((_, away)) = self.straight(goal) {
            return Some(away);
        }
        self.ways(goal).map(|(.., all)| all).min_by(f64::total_cmp)
    }

    /// The direction in which the way to a goal begins, radians: towards the farthest node in sight on it, so that a
    /// node close by does not turn it.
    pub fn towards(&self, goal: GoalId) -> Option<f64> {
        let target = match self.straight(goal) {
            Some((to, _)) => to,
            None => {
                let least = self.to_goal(goal)?;
                let good = self.ways(goal).filter(|(.., all)| *all <= least + SAME_WAY_M);
                good.max_by(|a, b| a.1.total_cmp(&b.1))?.0
            }
        };
        Some(Segment { a: self.at, b: target }.heading())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{kiva, lab, thesis};

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    const G: GoalId = GoalId(7);

    #[test]
    fn the_distance_is_that_of_the_shortest_way_and_the_direction_goes_down_it() {
        let w = thesis();
        let walkways = Arc::new(Walkways::of(&w));
        let mut all = Distances::over(walkways.clone());
        all.add_goal(G, p(6.0, 10.0));
        for from in [p(3.0, 2.0), p(0.0, 0.0), p(9.2, 12.0), p(6.0, 9.0), p(11.0, 7.2)] {
            let way = walkways.path(from, p(6.0, 10.0), all.cut()).expect("a way").length_m;
            let found = all.to_goal(G, from).expect("a way");
            assert!((way - found).abs() < 0.01, "{from}: {way} and {found}");
            let heading = all.towards(G, from).expect("a way");
            let next = from + giveway_floor::geometry::Vector::new(heading.cos(), heading.sin()) * 0.3;
            let fell = found - all.to_goal(G, next).expect("a way");
            assert!(fell > 0.27, "{from}: walking 0.3 m that way brings {fell} m");
        }
    }

    #[test]
    fn in_the_open_one_walks_straight() {
        let mut all = Distances::in_the_open();
        all.add_goal(G, p(3.0, 4.0));
        assert_eq!(all.to_goal(G, p(0.0, 0.0)), Some(5.0));
        assert_eq!(all.towards(G, p(3.0, 0.0)), Some(std::f64::consts::FRAC_PI_2));
        assert_eq!(all.to_goal(GoalId(1), p(0.0, 0.0)), None);
    }

    #[test]
    fn a_robot_before_the_goal_makes_the_way_longer_and_two_make_it_unreachable() {
        let w = lab();
        let mut all = Distances::over(Arc::new(Walkways::of(&w)));
        all.add_goal(G, p(4.0, 4.0));
        let (from, mut cut) = (p(6.0, 1.0), all.walkways().unwrap().no_edges());
        let before = all.to_goal(G, from).expect("a way");
        let block = |all: &Distances, at: Point, cut: &mut EdgeSet| {
            all.walkways().unwrap().edges_within(at, 0.7).into_iter().for_each(|e| assert!(cut.insert(e)));
        };
        block(&all, p(6.0, 3.0), &mut cut);
        all.set_cut(&cut);
        let after = all.to_goal(G, from).expect("the other way round");
        assert!(after > before + 4.0, "{before} and {after}");
        block(&all, p(3.0, 2.0), &mut cut);
        block(&all, p(0.0, 2.0), &mut cut);
        all.set_cut(&cut);
        assert_eq!((all.to_goal(G, from), all.towards(G, from)), (None, None));
        all.set_cut(&all.walkways().unwrap().no_edges());
        assert_eq!(all.to_goal(G, from), Some(before));
        all.remove_goal(G);
        assert_eq!(all.to_goal(G, from), None);
    }

    #[test]
    fn fields_that_were_repaired_again_and_again_are_those_of_a_fresh_start() {
        let walkways = Arc::new(Walkways::of(&kiva()));
        let mut all = Distances::over(walkways.clone());
        let goals = [p(3.0, 20.0), p(40.0, 61.5), p(63.0, 0.0)];
        goals.iter().enumerate().for_each(|(i, at)| all.add_goal(GoalId(i as u64), *at));
        let mut cut = walkways.no_edges();
        for step in 0..30_u64 {
            cut = walkways.no_edges();
            for robot in 0..12_u64 {
                let (x, y) = ((robot * 17 + step * 3) % 64, (robot * 29 + step * 5) % 70);
                for e in walkways.edges_within(p(x as f64, y as f64), 1.0) {
                    cut.insert(e);
                }
            }
            all.set_cut(&cut);
        }
        let mut fresh = Distances::over(walkways.clone());
        fresh.set_cut(&cut);
        goals.iter().enumerate().for_each(|(i, at)| fresh.add_goal(GoalId(i as u64), *at));
        for goal in 0..3 {
            for n in walkways.nodes().ids() {
                assert_eq!(all.from_node(n, GoalId(goal)), fresh.from_node(n, GoalId(goal)), "{n:?}");
            }
        }
    }
}
