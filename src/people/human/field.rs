//! Shortest distances from all nodes of a graph to one goal, repaired when edges are cut or restored.
//!
//! Main types: [`Graph`] (undirected, lengths on edges), [`Field`] (one goal). A repair visits only nodes whose
//! distance changes and their neighbours (Ramalingam and Reps 1996, for a batch of changes). Distances are whole tenths
//! of a millimetre, so that a repaired field equals a new computation exactly. Refuses: infinity; an unreachable node
//! has no distance.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Tenths of a millimetre in a metre.
const PER_METRE: f64 = 10_000.0;
/// Value of an unreachable node.
const NONE: u32 = u32::MAX;

/// An undirected graph with lengths.
#[derive(Clone, Debug)]
pub struct Graph {
    /// Where the links of each node begin, and the end of the last node's.
    start: Vec<u32>,
    links: Vec<FieldEdge>,
    ends: Vec<(u32, u32)>,
}

#[derive(Clone, Copy, Debug)]
struct FieldEdge {
    edge: u32,
    to: u32,
    length: u32,
}

/// Metres as whole units, at least one: edges of length zero would let a repair miss nodes.
fn units(metres: f64) -> u32 {
    (metres * PER_METRE).round().clamp(1.0, f64::from(NONE / 4)) as u32
}

impl Graph {
    /// The graph of `nodes` nodes with these edges: ends, and length in metres.
    pub fn new(nodes: usize, edges: &[(usize, usize, f64)]) -> Graph {
        let mut start = vec![0; nodes + 1];
        for &(a, b, _) in edges {
            start[a + 1] += 1;
            start[b + 1] += 1;
        }
        for n in 0..nodes {
            start[n + 1] += start[n];
        }
        let mut next = start.clone();
        let mut links = vec![FieldEdge { edge: 0, to: 0, length: 0 }; 2 * edges.len()];
        for (e, &(a, b, metres)) in edges.iter().enumerate() {
            for (from, to) in [(a, b), (b, a)] {
                links[next[from] as usize] =
                    FieldEdge { edge: e as u32, to: to as u32, length: units(metres) };
                next[from] += 1;
            }
        }
        Graph { start, links, ends: edges.iter().map(|e| (e.0 as u32, e.1 as u32)).collect() }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.start.len() - 1
    }

    /// Number of edges.
    pub fn edges(&self) -> usize {
        self.ends.len()
    }

    fn links(&self, n: usize) -> &[FieldEdge] {
        &self.links[self.start[n] as usize..self.start[n + 1] as usize]
    }
}

/// Distances to one goal. The goal is joined to the graph by *seeds*: nodes with a distance of their own to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    distance: Vec<u32>,
    /// Nodes joined directly to the goal, with their distances; sorted by node.
    seeds: Vec<(u32, u32)>,
    /// Scratch: whether a node lost its distance in the present repair.
    lost: Vec<bool>,
}

impl Field {
    /// Computes all distances; `open` says which edges are not cut, seeds are nodes with metres, sorted by node.
    pub fn new(graph: &Graph, seeds: &[(usize, f64)], open: impl Fn(usize) -> bool) -> Field {
        let nodes = graph.nodes();
        let mut field = Field { distance: vec![NONE; nodes], seeds: Vec::new(), lost: vec![false; nodes] };
        field.repair(graph, &[], Some(seeds), open);
        field
    }

    /// Metres from a node to the goal; nothing if no way leads there.
    pub fn metres(&self, n: usize) -> Option<f64> {
        let units = self.distance[n];
        (units != NONE).then(|| f64::from(units) / PER_METRE)
    }

    /// Updates the distances after the `changed` edges were cut or restored and, if given, the seeds replaced; `open`
    /// is the new state. Returns how many nodes were visited.
    pub fn repair(
        &mut self,
        graph: &Graph,
        changed: &[usize],
        seeds: Option<&[(usize, f64)]>,
        open: impl Fn(usize) -> bool,
    ) -> usize {
        let mut touched: Vec<u32> = Vec::new();
        if let Some(seeds) = seeds {
            touched.extend(self.seeds.iter().map(|s| s.0));
            self.seeds = seeds.iter().map(|(n, metres)| (*n as u32, units(*metres))).collect();
            touched.extend(self.seeds.iter().map(|s| s.0));
        }
        touched.extend(changed.iter().flat_map(|e| [graph.ends[*e].0, graph.ends[*e].1]));
        let lost = self.lose(graph, &touched, &open);
        let mut queue = BinaryHeap::new();
        for &n in lost.iter().chain(&touched) {
            let best = self.offer(graph, n as usize, &open);
            if best < self.distance[n as usize] {
                self.distance[n as usize] = best;
                queue.push(Reverse((best, n)));
            }
        }
        lost.iter().for_each(|n| self.lost[*n as usize] = false);
        let settled = self.spread(graph, queue, &open);
        touched.len() + lost.len() + settled
    }

    /// Removes the distance of all nodes that no neighbour supports any more. Nearest first: a node that supports
    /// another is nearer, and so already checked.
    fn lose(&mut self, graph: &Graph, touched: &[u32], open: &impl Fn(usize) -> bool) -> Vec<u32> {
        let mut queue: BinaryHeap<Reverse<(u32, u32)>> =
            touched.iter().map(|n| Reverse((self.distance[*n as usize], *n))).collect();
        let mut lost = Vec::new();
        while let Some(Reverse((distance, n))) = queue.pop() {
            let i = n as usize;
            if distance == NONE || self.lost[i] || self.is_supported(graph, i, open) {
                continue;
            }
            self.lost[i] = true;
            lost.push(n);
            for link in graph.links(i) {
                let far = self.distance[link.to as usize];
                if far != NONE && far == distance.saturating_add(link.length) && !self.lost[link.to as usize]
                {
                    queue.push(Reverse((far, link.to)));
                }
            }
        }
        lost.iter().for_each(|n| self.distance[*n as usize] = NONE);
        lost
    }

    fn is_supported(&self, graph: &Graph, n: usize, open: &impl Fn(usize) -> bool) -> bool {
        let distance = self.distance[n];
        self.seed(n) == distance
            || graph.links(n).iter().any(|l| {
                let near = self.distance[l.to as usize];
                open(l.edge as usize)
                    && near < distance
                    && near + l.length == distance
                    && !self.lost[l.to as usize]
            })
    }

    fn seed(&self, n: usize) -> u32 {
        self.seeds.binary_search_by_key(&(n as u32), |s| s.0).map_or(NONE, |i| self.seeds[i].1)
    }

    /// The best distance that a node can get from its neighbours.
    fn offer(&self, graph: &Graph, n: usize, open: &impl Fn(usize) -> bool) -> u32 {
        let links = graph.links(n).iter().filter(|l| open(l.edge as usize));
        let via = links.filter_map(|l| self.distance[l.to as usize].checked_add(l.length));
        via.min().unwrap_or(NONE).min(self.seed(n))
    }

    /// Runs Dijkstra from the nodes whose distance fell.
    fn spread(
        &mut self,
        graph: &Graph,
        mut queue: BinaryHeap<Reverse<(u32, u32)>>,
        open: &impl Fn(usize) -> bool,
    ) -> usize {
        let mut settled = 0;
        while let Some(Reverse((distance, n))) = queue.pop() {
            if distance > self.distance[n as usize] {
                continue;
            }
            settled += 1;
            for link in graph.links(n as usize).iter().filter(|l| open(l.edge as usize)) {
                let there = distance.saturating_add(link.length);
                if there < self.distance[link.to as usize] {
                    self.distance[link.to as usize] = there;
                    queue.push(Reverse((there, link.to)));
                }
            }
        }
        settled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A path of four nodes with a bypass.
    fn small() -> Graph {
        Graph::new(4, &[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (0, 3, 5.0)])
    }

    #[test]
    fn a_cut_edge_is_gone_round_and_a_restored_one_is_used_again() {
        let graph = small();
        let mut field = Field::new(&graph, &[(3, 0.5)], |_| true);
        assert_eq!(field.metres(0), Some(3.5));
        field.repair(&graph, &[1], None, |e| e != 1);
        assert_eq!((field.metres(0), field.metres(1), field.metres(2)), (Some(5.5), Some(6.5), Some(1.5)));
        field.repair(&graph, &[3], None, |e| e != 1 && e != 3);
        assert_eq!((field.metres(0), field.metres(1), field.metres(2)), (None, None, Some(1.5)));
        field.repair(&graph, &[1, 3], None, |_| true);
        assert_eq!(field, Field::new(&graph, &[(3, 0.5)], |_| true));
    }

    #[test]
    fn a_repair_far_from_the_change_looks_at_little() {
        let edges: Vec<(usize, usize, f64)> = (0..999).map(|i| (i, i + 1, 1.0)).collect();
        let graph = Graph::new(1000, &edges);
        let mut field = Field::new(&graph, &[(0, 0.1)], |_| true);
        let looked = field.repair(&graph, &[990], None, |e| e != 990);
        assert!(looked < 20, "{looked}");
        assert_eq!((field.metres(990), field.metres(991)), (Some(990.1), None));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn a_repaired_field_is_the_one_that_is_computed_anew(
            edges in prop::collection::vec((0_usize..25, 0_usize..25, 1_u32..40), 20..70),
            seeds in prop::collection::btree_map(0_usize..25, 0_u32..30, 1..4),
            steps in prop::collection::vec((prop::collection::vec(0_usize..70, 1..5), any::<bool>()), 1..15),
            moved in prop::collection::btree_map(0_usize..25, 0_u32..30, 1..4),
        ) {
            let edges: Vec<_> = edges.into_iter().filter(|e| e.0 != e.1)
                .map(|(a, b, m)| (a, b, f64::from(m) * 0.1)).collect();
            let metres = |seeds: std::collections::BTreeMap<usize, u32>| -> Vec<(usize, f64)> {
                seeds.into_iter().map(|(n, m)| (n, f64::from(m) * 0.1)).collect()
            };
            let (mut seeds, moved) = (metres(seeds), metres(moved));
            let graph = Graph::new(25, &edges);
            let mut cut = vec![false; edges.len()];
            let mut field = Field::new(&graph, &seeds, |_| true);
            for (toggled, move_goal) in steps {
                let mut changed = Vec::new();
                for e in toggled.into_iter().filter(|e| *e < edges.len()) {
                    cut[e] = !cut[e];
                    changed.push(e);
                }
                if move_goal {
                    seeds.clone_from(&moved);
                }
                field.repair(&graph, &changed, move_goal.then_some(&seeds[..]), |e| !cut[e]);
                prop_assert_eq!(&field, &Field::new(&graph, &seeds, |e| !cut[e]));
            }
        }
    }
}
