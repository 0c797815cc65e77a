//! Paths over the walkways that a person may take: towards a goal, or straight on.
//!
//! Main functions: [`towards_goal`], [`straight_on`], [`common_prefix`]. Refuses: probabilities.

use super::Distances;
use giveway_floor::geometry::{Point, Vector, turn_between};
use giveway_floor::id::{GoalId, WalkNodeId};
use giveway_floor::warehouse::walkway::Walkways;

/// Points closer than this are the same, metres.
const SAME_M: f64 = 0.3;

/// The shortest path from a point to a goal, up to `length_m`, following the goal's distances; nothing if there is
/// none.
pub fn towards_goal(distances: &Distances, goal: GoalId, at: Point, length_m: f64) -> Option<Vec<Point>> {
    let end = distances.place(goal)?;
    let Some(walkways) = distances.walkways() else { return Some(vec![at, end]) };
    if (end - at).norm() < 2.5 && walkways.sees_past(at, end, distances.cut()) {
        return Some(vec![at, end]);
    }
    let view = distances.from(at);
    let first = view.steps().iter().filter_map(|(n, away)| Some((*n, away + distances.from_node(*n, goal)?)));
    let (mut node, _) = first.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut path = vec![at, walkways.nodes()[node].at];
    let mut walked = (path[1] - path[0]).norm();
    let mut left = distances.from_node(node, goal)?;
    while walked < length_m {
        let next = walkways.links(node).iter().filter(|(e, _)| !distances.cut().contains(*e));
        let next = next.filter_map(|(e, n)| {
            let left = distances.from_node(*n, goal)?;
            Some((*n, left, walkways.edges()[*e].length_m))
        });
        let Some((n, l, step)) = next.min_by(|a, b| (a.1 + a.2).total_cmp(&(b.1 + b.2))) else { break };
        if l >= left {
            // No further node is nearer to the goal: the goal itself is next.
            path.push(end);
            break;
        }
        path.push(walkways.nodes()[n].at);
        (node, left, walked) = (n, l, walked + step);
    }
    Some(path)
}

/// The path over the walkways that changes the heading least, up to `length_m`: a prediction without any model.
pub fn straight_on(walkways: &Walkways, at: Point, heading: f64, length_m: f64) -> Vec<Point> {
    let mut path = vec![at];
    let mut ahead = heading;
    let near = walkways.near(at, 2.5);
    let bearing = |n: WalkNodeId, from: Point| {
        let to = walkways.nodes()[n].at - from;
        to.y.atan2(to.x)
    };
    let far_enough = near.iter().filter(|(_, d)| *d > SAME_M);
    let first = far_enough.min_by(|a, b| {
        let off = |n: WalkNodeId, d: f64| turn_between(bearing(n, at), heading) + 0.1 * d;
        off(a.0, a.1).total_cmp(&off(b.0, b.1))
    });
    let Some(&(mut node, mut walked)) = first else { return path };
    path.push(walkways.nodes()[node].at);
    let mut before = None;
    while walked < length_m {
        let here = walkways.nodes()[node].at;
        let on = walkways.links(node).iter().filter(|(_, n)| Some(*n) != before);
        let best = on.min_by(|a, b| {
            turn_between(bearing(a.1, here), ahead).total_cmp(&turn_between(bearing(b.1, here), ahead))
        });
        let Some(&(edge, next)) = best else { break };
        // People are not predicted to turn back, or to cut through.
        if turn_between(bearing(next, here), ahead) > 2.2 {
            break;
        }
        (ahead, before) = (bearing(next, here), Some(node));
        node = next;
        path.push(walkways.nodes()[node].at);
        walked += walkways.edges()[edge].length_m;
    }
    path
}

/// The common beginning of all paths.
pub fn common_prefix(paths: &[Vec<Point>]) -> Vec<Point> {
    let Some(first) = paths.first() else { return Vec::new() };
    let same = |i: usize| paths.iter().all(|p| p.get(i).is_some_and(|q| distance(*q, first[i]) < SAME_M));
    let shared = (0..first.len()).take_while(|i| same(*i)).count();
    first[..shared].to_vec()
}

fn distance(a: Point, b: Point) -> f64 {
    let d: Vector = a - b;
    d.norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;
    use std::sync::Arc;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn the_way_to_a_goal_ends_there_and_is_as_long_as_its_distance() {
        let walkways = Arc::new(Walkways::of(&thesis()));
        let mut distances = Distances::over(walkways);
        distances.add_goal(GoalId(1), p(0.0, 12.0));
        let path = towards_goal(&distances, GoalId(1), p(6.0, 3.0), 100.0).unwrap();
        assert!((path.last().unwrap() - p(0.0, 12.0)).norm() < 0.5, "{path:?}");
        let length: f64 = path.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        let far = distances.to_goal(GoalId(1), p(6.0, 3.0)).unwrap();
        assert!((length - far).abs() < 0.5, "{length} {far}");
    }

    #[test]
    fn straight_on_goes_down_the_aisle() {
        let walkways = Walkways::of(&thesis());
        let path = straight_on(&walkways, p(6.0, 2.0), std::f64::consts::FRAC_PI_2, 4.0);
        assert!(path.iter().all(|q| (q.x - 6.0).abs() < 0.3), "{path:?}");
        assert!(path.last().unwrap().y > 5.5, "{path:?}");
    }

    #[test]
    fn what_paths_share_ends_where_they_part() {
        let a = vec![p(0.0, 0.0), p(1.0, 0.0), p(2.0, 0.0)];
        let b = vec![p(0.0, 0.0), p(1.0, 0.1), p(1.0, 1.0)];
        assert_eq!(common_prefix(&[a.clone(), b]).len(), 2);
        assert_eq!(common_prefix(std::slice::from_ref(&a)), a);
        assert!(common_prefix(&[]).is_empty());
    }
}
