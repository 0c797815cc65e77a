//! The cost of updating distances to goals after one edge was cut or restored.
//!
//! Main function: [`run`]. The published system computes all distances between 228 nodes anew (Petković 2021, section
//! 4.3.2: 3.456 ms). Refuses: to look at a clock; the stopwatch is passed in.

use super::dice::Dice;
use giveway_floor::geometry::Point;
use giveway_floor::id::Dense;
use giveway_floor::warehouse::Warehouse;
use giveway_people::human::{Field, Graph};

/// A graph to measure on.
#[derive(Debug)]
pub struct DistanceSetup {
    /// Name of the graph.
    pub name: String,
    nodes: Vec<Point>,
    edges: Vec<(usize, usize, f64)>,
    goals: Vec<usize>,
}

impl DistanceSetup {
    /// The road graph of a map with a goal near each corner and one in the middle, or with all nodes as goals.
    pub fn of_map(w: &Warehouse, all: bool) -> DistanceSetup {
        let nodes: Vec<Point> = w.nodes.iter().map(|n| n.at).collect();
        let edges = w.lanes.iter().map(|l| (l.a.ix(), l.b.ix(), l.length_m)).collect();
        let goals = if all { (0..nodes.len()).collect() } else { spread(&nodes) };
        DistanceSetup { name: format!("{} roads", w.name), nodes, edges, goals }
    }

    /// A square grid with nodes a metre or slightly more apart (hardly any two ways are equally long, so that cuts
    /// matter), with a goal near each corner and one in the middle.
    pub fn grid(side: usize) -> DistanceSetup {
        let nodes: Vec<Point> =
            (0..side * side).map(|i| Point::new((i % side) as f64, (i / side) as f64)).collect();
        let metres = |i: usize| 1.0 + (i * 7919 % 1009) as f64 / 5000.0;
        let east = (0..side * side).filter(|i| i % side + 1 < side).map(|i| (i, i + 1, metres(2 * i)));
        let north = (0..side * (side - 1)).map(|i| (i, i + side, metres(2 * i + 1)));
        let edges = east.chain(north).collect();
        let goals = spread(&nodes);
        DistanceSetup { name: format!("grid {side} × {side}"), nodes, edges, goals }
    }
}

/// The nodes nearest to the corners and to the middle.
fn spread(nodes: &[Point]) -> Vec<usize> {
    let first = nodes.first().copied().unwrap_or_else(Point::origin);
    let (low, high) = nodes.iter().fold((first, first), |(l, h), p| (l.inf(p), h.sup(p)));
    let places =
        [low, Point::new(high.x, low.y), Point::new(low.x, high.y), high, nalgebra::center(&low, &high)];
    let nearest = |place: &Point| {
        (0..nodes.len()).min_by(|a, b| (nodes[*a] - place).norm().total_cmp(&(nodes[*b] - place).norm()))
    };
    places.iter().filter_map(nearest).collect()
}

/// Measured durations, nanoseconds, ascending.
#[derive(Debug)]
pub struct DistanceOutcome {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of goals.
    pub goals: usize,
    /// Durations of repairing the distances to all goals after one edge changed.
    pub repair_ns: Vec<u64>,
    /// Durations of computing the distances to all goals anew.
    pub anew_ns: Vec<u64>,
}

/// Cuts `changes` random edges one by one, each restored at once; both repairs are measured.
pub fn run(setup: &DistanceSetup, changes: usize, seed: u64, stopwatch: fn() -> u64) -> DistanceOutcome {
    let graph = Graph::new(setup.nodes.len(), &setup.edges);
    let mut dice = Dice::new(seed);
    let anew = |cut: Option<usize>| -> Vec<Field> {
        setup.goals.iter().map(|g| Field::new(&graph, &[(*g, 0.0)], |e| Some(e) != cut)).collect()
    };
    let mut fields = anew(None);
    let (mut repair_ns, mut anew_ns) = (Vec::new(), Vec::new());
    for change in 0..changes {
        let e = dice.below(graph.edges());
        for cut in [Some(e), None] {
            let start = stopwatch();
            for field in &mut fields {
                field.repair(&graph, &[e], None, |e| Some(e) != cut);
            }
            repair_ns.push(stopwatch() - start);
            if change % 50 == 0 {
                let start = stopwatch();
                let fresh = anew(cut);
                anew_ns.push(stopwatch() - start);
                assert!(fresh == fields, "a repair is no repair: edge {e} of {}", setup.name);
            }
        }
    }
    repair_ns.sort_unstable();
    anew_ns.sort_unstable();
    let (nodes, edges, goals) = (graph.nodes(), graph.edges(), setup.goals.len());
    DistanceOutcome { nodes, edges, goals, repair_ns, anew_ns }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;

    #[test]
    fn repairs_on_the_graph_of_the_thesis_are_what_a_new_computation_gives() {
        let out = run(&DistanceSetup::of_map(&thesis(), true), 60, 1, || 0);
        assert_eq!((out.nodes, out.edges, out.goals), (228, 348, 228));
        assert_eq!((out.repair_ns.len(), out.anew_ns.len()), (120, 4));
        let out = run(&DistanceSetup::grid(12), 60, 1, || 0);
        assert_eq!((out.nodes, out.edges, out.goals), (144, 264, 5));
    }
}
