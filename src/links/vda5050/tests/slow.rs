//! Robots that are to drive slowly: by edges that were not sent yet, and by a SPEED_LIMIT zone where they know such.

use super::corridors::way;
use super::*;
use giveway_fleet::Command;
use giveway_vda5050::{ZoneKind, ZoneSet};

const SLOW_MPS: f64 = 0.3;

/// A robot that drives along the way, and was told so far to drive slowly.
fn slowed(setup: RobotSetup) -> LinkFloor {
    let mut floor = LinkFloor::new(way(), vec![setup]);
    floor.all_ready();
    floor.go("end");
    floor.until(60, "it drives", |f| f.pairs[0].speed_mps() > 1.0 && f.pairs[0].place().0 > 1.0);
    floor.limit(Some(SLOW_MPS));
    floor
}

impl LinkFloor {
    fn limit(&mut self, limit: Option<f64>) {
        let out = self.pairs[0].session.command(self.now, &Command::Limit(limit));
        self.take(0, out, &mut Vec::new());
    }

    /// The speeds of the edges of each order since a time, in their order.
    fn edge_speeds(&self, since: Time) -> Vec<Vec<Option<f64>>> {
        let told = self.pairs[0].told.iter().filter(|(at, ..)| *at > since);
        told.filter_map(|(.., message)| match message {
            Message::Order(order) => Some(order.edges.iter().map(|edge| edge.max_speed_mps).collect()),
            _ => None,
        })
        .collect()
    }

    fn sets(&self) -> Vec<ZoneSet> {
        let told = self.pairs[0].told.iter();
        told.filter_map(
            |(.., message)| if let Message::ZoneSet(set) = message { Some(set.clone()) } else { None },
        )
        .collect()
    }
}

#[test]
fn edges_that_were_not_sent_yet_have_the_limit_and_those_after_its_end_have_none() {
    for version in [Version::V2_0, Version::V2_1, Version::V3_0] {
        let mut floor = slowed(standard(version));
        let since = floor.now;
        let is_slow = |f: &LinkFloor| f.pairs[0].speed_mps() < SLOW_MPS + 0.01;
        floor.until(60, "it is slow", |f| is_slow(f) && !f.edge_speeds(since).is_empty());
        let speeds = floor.edge_speeds(since);
        assert!(
            !speeds.is_empty() && speeds.iter().flatten().all(|mps| *mps == Some(SLOW_MPS)),
            "{speeds:?}"
        );
        floor.limit(None);
        let since = floor.now;
        floor.until(120, "it drives as fast as it can again", |f| f.pairs[0].speed_mps() > 1.0);
        let speeds = floor.edge_speeds(since);
        assert!(!speeds.is_empty() && speeds.iter().flatten().all(Option::is_none), "{speeds:?}");
        assert_eq!(floor.notices(0), [""; 0]);
    }
}

#[test]
fn a_robot_that_knows_speed_limit_zones_is_slow_at_once_and_needs_one_zone_for_its_way() {
    let mut floor = slowed(standard(Version::V3_0));
    // It is on a released edge of four metres that has no limit.
    floor.until(3, "it is slow", |f| f.pairs[0].speed_mps() < SLOW_MPS + 0.01);
    let zone = floor.sets()[0].zones[0].clone();
    assert_eq!((zone.kind, zone.corners.len()), (ZoneKind::SpeedLimit(SLOW_MPS), 4));
    while floor.pairs[0].place().0 < 10.0 {
        floor.step(Vec::new());
        floor.limit(Some(SLOW_MPS));
        assert!(floor.pairs[0].speed_mps() < SLOW_MPS + 0.01, "{:?}", floor.pairs[0].place());
    }
    assert!(floor.sets().len() <= 5, "{} sets for eight metres", floor.sets().len());
    floor.limit(None);
    floor.until(20, "its zone has ended", |f| f.sets().last().is_some_and(|set| set.zones.is_empty()));
    floor.until(20, "it drives as fast as it can again", |f| f.pairs[0].speed_mps() > 1.0);
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn a_slower_limit_is_sent_at_once_and_a_faster_one_when_it_has_settled() {
    let mut floor = slowed(standard(Version::V3_0));
    let speeds = |f: &LinkFloor| -> Vec<ZoneKind> {
        f.sets().iter().flat_map(|set| &set.zones).map(|z| z.kind).collect()
    };
    floor.until(2, "it has a zone", |f| f.stored_in_force());
    floor.limit(Some(0.2));
    floor.until(2, "it has a slower one", |f| speeds(f).last() == Some(&ZoneKind::SpeedLimit(0.2)));
    floor.until(2, "that is in force", |f| f.stored_in_force());
    let slower = floor.now;
    floor.limit(Some(0.4));
    floor.until(10, "it has a faster one", |f| speeds(f).last() == Some(&ZoneKind::SpeedLimit(0.4)));
    assert!(floor.now - slower > Span::from_secs(3), "several a second would wear the robot out");
}

impl LinkFloor {
    fn stored_in_force(&self) -> bool {
        let last = self.sets().last().map(|set| set.id.clone());
        self.pairs[0]
            .robot
            .robot
            .state()
            .zone_sets
            .iter()
            .any(|set| set.enabled && Some(&set.id) == last.as_ref())
    }
}
