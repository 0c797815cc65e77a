//! Where virtual robots stand when they are switched on: at places of the map, or as a file says.
//!
//! Main type: [`RobotPlace`]; main functions: [`of_map`], [`of_file`]. Refuses: two robots of one serial number or at
//! one place.

use anyhow::ensure;
use giveway_floor::geometry::Point;
use giveway_floor::id::NodeId;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_vda5050::{Address, Position};
use serde::Deserialize;

/// Robots nearer to one another than this stand at one place, metres.
const SAME_PLACE_M: f64 = 0.2;

/// A robot and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotPlace {
    /// The robot's serial number.
    pub serial: String,
    /// The node on which it stands; empty if on none.
    pub node: String,
    /// Its pose, with its name of the map.
    pub position: Position,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlacesFile {
    robots: Vec<PlaceFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceFile {
    serial: String,
    node: Option<String>,
    x: Option<f64>,
    y: Option<f64>,
    #[serde(default)]
    theta: f64,
    map: Option<String>,
}

/// This many robots at places where robots may stay. Those that a server simulates begin at chargers, so these take
/// parking places first, and the last ones of each kind.
pub fn of_map(map: &Warehouse, count: usize, prefix: &str) -> anyhow::Result<Vec<RobotPlace>> {
    let kinds = [NodeKind::Parking, NodeKind::Charger, NodeKind::Storage];
    let places = kinds.into_iter().flat_map(|wanted| {
        let nodes = map.nodes_where(|kind| kind == wanted);
        nodes.into_iter().rev()
    });
    let places: Vec<NodeId> = places.take(count).collect();
    ensure!(
        places.len() == count,
        "the map has {} parking, charging and storage places, too few for --count {count}",
        places.len()
    );
    let place = |(i, node): (usize, NodeId)| {
        let node = &map.nodes[node];
        RobotPlace {
            serial: format!("{prefix}-{}", i + 1),
            node: node.name.clone(),
            position: position(node.at, 0.0, &map.name),
        }
    };
    Ok(places.into_iter().enumerate().map(place).collect())
}

/// The robots of a file, `{"robots": [{"serial", "node", "x", "y", "theta", "map"}]}`. Everything that is wrong is told
/// at once.
pub fn of_file(text: &str, map: &Warehouse) -> anyhow::Result<Vec<RobotPlace>> {
    let file: PlacesFile = serde_json::from_str(text)?;
    let (mut places, mut faults) = (Vec::<RobotPlace>::new(), Vec::new());
    for (i, place) in file.robots.into_iter().enumerate() {
        match place.read(map, &places) {
            Ok(place) => places.push(place),
            Err(why) => faults.push(format!("robots[{i}]: {why}")),
        }
    }
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    ensure!(!places.is_empty(), "there are no robots in the file: list some under `robots`");
    Ok(places)
}

impl PlaceFile {
    fn read(self, map: &Warehouse, before: &[RobotPlace]) -> Result<RobotPlace, String> {
        Address::new("maker", &self.serial).map_err(|e| e.to_string())?;
        if before.iter().any(|b| b.serial == self.serial) {
            return Err(format!("there are two robots with the serial number {:?}", self.serial));
        }
        let named = self.node.as_deref().map(|name| {
            let node = map.nodes.iter().find(|node| node.name == name);
            node.map(|node| node.at).ok_or_else(|| format!("the map has no node {name:?}"))
        });
        let at = match (self.x, self.y, named.transpose()?) {
            (Some(x), Some(y), _) => Point::new(x, y),
            (None, None, Some(at)) => at,
            (None, None, None) => return Err("give `node`, or `x` and `y`".to_owned()),
            _ => return Err("`x` and `y` go together: give both or none".to_owned()),
        };
        if let Some(near) = before.iter().find(|b| (point(&b.position) - at).norm() < SAME_PLACE_M) {
            return Err(format!("{:?} stands there already", near.serial));
        }
        let node = self.node.unwrap_or_default();
        let position = position(at, self.theta, self.map.as_deref().unwrap_or(&map.name));
        Ok(RobotPlace { serial: self.serial, node, position })
    }
}

fn position(at: Point, theta: f64, map: &str) -> Position {
    Position { x: at.x, y: at.y, theta, map: map.to_owned(), localized: true }
}

fn point(position: &Position) -> Point {
    Point::new(position.x, position.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::lab;

    #[test]
    fn robots_of_a_map_stand_at_different_places_where_they_may_stay() {
        let map = lab();
        let all = map.nodes_where(|kind| kind.is_lasting()).len();
        let places = of_map(&map, all, "v").unwrap();
        let nodes: std::collections::BTreeSet<&str> = places.iter().map(|p| p.node.as_str()).collect();
        assert_eq!((nodes.len(), places[0].serial.as_str()), (all, "v-1"));
        assert_eq!(places[0].position.map, map.name);
        assert!(of_map(&map, all + 1, "v").unwrap_err().to_string().contains("too few"));
    }

    #[test]
    fn a_file_names_nodes_or_poses_and_everything_wrong_is_said_at_once() {
        let map = lab();
        let node = &map.nodes.iter().next().unwrap();
        let good = format!(
            r#"{{"robots": [{{"serial": "a", "node": {:?}}},
                {{"serial": "b", "x": 50, "y": 1, "theta": 2, "map": "m"}}]}}"#,
            node.name
        );
        let places = of_file(&good, &map).unwrap();
        assert_eq!((point(&places[0].position), places[1].node.as_str()), (node.at, ""));
        assert_eq!((places[1].position.theta, places[1].position.map.as_str()), (2.0, "m"));
        let bad = format!(
            r#"{{"robots": [{{"serial": "a", "node": {0:?}}}, {{"serial": "a", "x": 9, "y": 9}}, {{"serial": "c"}},
                {{"serial": "d", "node": "nowhere"}}, {{"serial": "e", "x": 1}}, {{"serial": "f/", "x": 1, "y": 1}},
                {{"serial": "g", "node": {0:?}}}]}}"#,
            node.name
        );
        let said = of_file(&bad, &map).unwrap_err().to_string();
        for part in [
            "robots[1]: there are two",
            "robots[2]: give `node`",
            "robots[3]: the map has no node",
            "robots[4]: `x` and `y` go together",
            "robots[5]: the serial number is",
            "robots[6]: \"a\" stands there already",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(of_file(r#"{"robots": []}"#, &map).is_err());
    }
}
