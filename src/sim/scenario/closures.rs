//! The part of a scenario about areas closed for a time: known from the start, in force later.
//!
//! Main type: [`Closing`]. Refuses: empty areas, impossible times, and nodes that the map does not have.

use giveway_fleet::{Binds, Closure, LocalClock, MOST_OFTEN, Recurrence, RecurringClosure, Weekdays};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::Warehouse;
use giveway_people::aware::check_area;
use giveway_site::{SiteError, check};
use serde::Deserialize;

/// A closed node is shown as a square of twice this side, metres.
const AROUND_NODE_M: f64 = 0.25;

/// An area that robots, people or both keep out of for a time.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Closing {
    /// Corners of the area, metres.
    #[serde(default)]
    pub outline: Vec<[f64; 2]>,
    /// Names of closed nodes, instead of an outline.
    #[serde(default)]
    pub nodes: Vec<String>,
    /// Beginning of the closure, seconds from the start.
    pub from_s: f64,
    /// End of the closure, seconds from the start; for ever where absent.
    #[serde(default)]
    pub until_s: Option<f64>,
    /// Interval between the beginnings of two occurrences, seconds, if the closure recurs.
    #[serde(default)]
    pub every_s: Option<f64>,
    /// Reason of the closure.
    #[serde(default = "why")]
    pub reason: String,
    /// Whether the closure keeps out robots, people or both.
    #[serde(default)]
    pub binds: BindsWord,
}

/// [`Binds`] as files name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BindsWord {
    /// Only robots.
    Robots,
    /// Only people.
    People,
    /// Robots and people.
    #[default]
    Both,
}

impl From<BindsWord> for Binds {
    fn from(word: BindsWord) -> Binds {
        match word {
            BindsWord::Robots => Binds::Robots,
            BindsWord::People => Binds::People,
            BindsWord::Both => Binds::Both,
        }
    }
}

fn why() -> String {
    "as the scenario has it".into()
}

impl Closing {
    pub(super) fn check(&self) -> Result<(), SiteError> {
        check("closures.from_s", self.from_s, 0.0..=1e7, "from 0 to 10000000")?;
        let until = self.until_s.unwrap_or(2e7);
        check("closures.until_s", until, self.from_s + 1.0..=2e7, "at least a second after from_s")?;
        if let Some(every) = self.every_s {
            let least = (until - self.from_s).max(MOST_OFTEN.as_secs_f64());
            check("closures.every_s", every, least..=1e7, "from 300 on, and no shorter than an occurrence")?;
        }
        let corners = self.outline.len();
        match (corners, self.nodes.len()) {
            (0, 1..) => Ok(()),
            (3.., 0) => Ok(()),
            (n, 0) => check("closures.outline", n as f64, 3.0..=1e9, "three corners or more, or `nodes`"),
            (n, _) => check("closures.outline", n as f64, 0.0..=0.0, "left out if `nodes` are given"),
        }
    }

    /// The recurring closure for the fleet, if it recurs.
    pub(super) fn recurring(&self, area: Closure) -> Option<RecurringClosure> {
        let (every, weekdays) = (Span::from_secs_f64(self.every_s?), Weekdays::ALL);
        let recurrence = Recurrence { every, weekdays, clock: LocalClock::default(), until: Time::MAX };
        Some(RecurringClosure::new(area, recurrence))
    }

    /// The closures for the fleet, if the scenario begins at `start`: one for an outline, or one for each node.
    pub(super) fn areas(&self, warehouse: &Warehouse, start: Time) -> Result<Vec<Closure>, SiteError> {
        let at = |s: f64| start + Span::from_secs_f64(s);
        let window = Window::new(at(self.from_s), self.until_s.map_or(Time::MAX, at));
        let area = |corners: &mut dyn Iterator<Item = Point>, nodes: Vec<NodeId>| Closure {
            outline: corners.map(Spot::from).collect(),
            nodes,
            window,
            reason: self.reason.clone(),
            binds: self.binds.into(),
            series: None,
        };
        if self.nodes.is_empty() {
            let corners: Vec<Point> = self.outline.iter().map(|c| Point::new(c[0], c[1])).collect();
            let binds = Binds::from(self.binds);
            check_area(warehouse, &corners, binds.robots(), binds.people())
                .map_err(|why| SiteError::Wrong { key: "closures.outline", message: why.to_string() })?;
            return Ok(vec![area(&mut corners.into_iter(), Vec::new())]);
        }
        let around = |name: &String| {
            let node = warehouse.node_named(name).ok_or_else(|| SiteError::Number {
                key: "closures.nodes".to_owned(),
                found: format!("\"{name}\""),
                wanted: "names of nodes of the map",
            })?;
            let (p, d) = (warehouse.nodes[node].at, AROUND_NODE_M);
            let corners = [(-d, -d), (d, -d), (d, d), (-d, d)];
            Ok(area(&mut corners.into_iter().map(|(x, y)| Point::new(p.x + x, p.y + y)), vec![node]))
        };
        self.nodes.iter().map(around).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scenario;
    use super::*;
    use giveway_floor::warehouse::lab;

    fn scenario(closure: &str) -> Result<Scenario, SiteError> {
        Scenario::parse(&format!(
            r#"{{"giveway_scenario": 1, "name": "x", "map": "m", "robots": 1, "closures": [{closure}]}}"#
        ))
    }

    #[test]
    fn an_area_is_closed_between_its_times_counted_from_the_start() {
        let s = scenario(r#"{"outline": [[0, 0], [1, 0], [1, 1]], "from_s": 60, "until_s": 120}"#).unwrap();
        let areas = s.areas(&lab(), Time(5_000_000)).unwrap();
        assert_eq!((areas.len(), areas[0].outline.len()), (1, 3));
        assert_eq!(areas[0].window, Window::new(Time(65_000_000), Time(125_000_000)));
    }

    #[test]
    fn each_node_is_an_area_of_its_own() {
        let s = scenario(r#"{"nodes": ["R32", "R33"], "from_s": 60}"#).unwrap();
        let areas = s.areas(&lab(), Time::ZERO).unwrap();
        let inside = areas.iter().map(|a| a.nodes.clone());
        let wanted = ["R32", "R33"].map(|n| vec![lab().node_named(n).unwrap()]);
        assert_eq!(inside.collect::<Vec<_>>(), wanted);
    }

    #[test]
    fn what_cannot_be_closed_is_refused() {
        for (closure, what) in [
            (r#"{"outline": [[0, 0], [1, 0]], "from_s": 0}"#, "closures.outline"),
            (r#"{"outline": [[0, 0], [1, 0], [1, 1]], "nodes": ["R32"], "from_s": 0}"#, "closures.outline"),
            (r#"{"nodes": ["R32"], "from_s": 60, "until_s": 60}"#, "closures.until_s"),
            (r#"{"nodes": ["R32"], "from_s": -1}"#, "closures.from_s"),
            (r#"{"nodes": ["R32"]}"#, "from_s"),
        ] {
            let error = scenario(closure).expect_err(closure).to_string();
            assert!(error.contains(what), "{closure}: {error}");
        }
        for (outline, what) in [
            ("[[0, 0], [2, 2], [2, 0], [0, 2]]", "crosses itself"),
            ("[[1000, 1000], [2000, 1000], [2000, 2000]]", "far off the floor"),
        ] {
            let s = scenario(&format!(r#"{{"outline": {outline}, "from_s": 0}}"#)).unwrap();
            let error = s.areas(&lab(), Time::ZERO).expect_err(outline).to_string();
            assert!(error.contains(what), "{outline}: {error}");
        }
        let nowhere = scenario(r#"{"nodes": ["nowhere"], "from_s": 0}"#).unwrap();
        assert!(nowhere.areas(&lab(), Time::ZERO).unwrap_err().to_string().contains("nowhere"));
    }
}
