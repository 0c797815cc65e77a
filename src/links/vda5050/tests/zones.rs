//! Closed areas of the floor as zones of robots of 3.0.

use super::corridors::way;
use super::*;
use giveway_fleet::{Binds, Closure, FloorAction};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::ClosureId;
use giveway_floor::time::Window;
use giveway_vda5050::{Grant, RequestStatus, StoredZoneSet, Zone, ZoneKind, ZoneSet};

impl LinkFloor {
    /// Sessions know what is closed.
    pub(super) fn tell_closed(&mut self) {
        let closed = closed_areas(self.fleet.ledger(), self.now);
        if *self.closed != *closed {
            self.closed = closed.into();
        }
        for pair in &mut self.pairs {
            pair.session.close(&self.closed);
        }
    }

    /// Closes the floor between two corners, for a while.
    pub(super) fn close(&mut self, least: [f64; 2], most: [f64; 2], seconds: i64) -> ClosureId {
        let id = ClosureId(self.fleet.ledger().next_closure);
        // Clockwise: the zone must not be.
        let corners = [(least[0], least[1]), (least[0], most[1]), (most[0], most[1]), (most[0], least[1])];
        let area = Closure {
            outline: corners.map(|(x, y)| Spot::from(Point::new(x, y))).into(),
            nodes: Vec::new(),
            window: Window::new(self.now, self.now + Span::from_secs(seconds)),
            reason: "works".into(),
            binds: Binds::Robots,
            series: None,
        };
        self.step(vec![Input::ask(5, FloorAction::Close(area))]);
        id
    }

    fn zone_sets(&self) -> Vec<&ZoneSet> {
        let told = self.pairs[0].told.iter();
        told.filter_map(|(.., message)| if let Message::ZoneSet(set) = message { Some(set) } else { None })
            .collect()
    }

    fn stored(&self) -> Vec<StoredZoneSet> {
        self.pairs[0].robot.robot.state().zone_sets
    }

    /// The robot has one set, in force, with so many zones.
    fn has_zones(&self, count: usize) -> bool {
        let last = self.zone_sets().last().map_or(0, |set| set.zones.len());
        let [set] = &self.stored()[..] else { return count == 0 && self.stored().is_empty() };
        set.enabled && last == count
    }

    fn is_stuck(&self) -> bool {
        let state = self.pairs[0].robot.robot.state();
        state.errors.iter().any(|error| error.kind == "BLOCKED_ZONE_VIOLATION")
    }
}

fn with_one(setup: RobotSetup) -> LinkFloor {
    let mut floor = LinkFloor::new(way(), vec![setup]);
    floor.all_ready();
    floor
}

#[test]
fn a_closed_area_is_a_zone_while_it_is_closed_and_old_sets_are_deleted() {
    let mut floor = with_one(standard(Version::V3_0));
    let closure = floor.close([9.0, -2.0], [15.0, 2.0], 60);
    floor.until(10, "it has the zone", |f| f.has_zones(1));
    let sets = floor.zone_sets();
    let zone = Zone {
        id: format!("closure-{}", closure.0),
        kind: ZoneKind::Blocked,
        corners: vec![(15.0, -2.0), (15.0, 2.0), (9.0, 2.0), (9.0, -2.0)],
    };
    assert_eq!((sets.len(), &sets[0].map[..], &sets[0].zones), (1, FLOOR, &vec![zone]));
    floor.run(40);
    assert_eq!(floor.zone_sets().len(), 1, "nothing changes");
    floor.until(40, "it has none any more", |f| f.has_zones(0));
    assert_eq!(floor.stored().len(), 1, "an empty set took its place");
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn an_area_is_no_zone_for_a_robot_that_is_in_it_or_was_promised_a_way_through_it() {
    let mut floor = with_one(standard(Version::V3_0));
    let job = floor.go("end");
    floor.until(60, "it is on its way", |f| f.pairs[0].place().0 > 3.0);
    let (end, _closure) = (floor.now + Span::from_secs(240), floor.close([5.0, -2.0], [13.0, 2.0], 200));
    let mut was_within = false;
    while floor.now < end {
        floor.step(Vec::new());
        let x = floor.pairs[0].place().0;
        was_within |= (5.0..13.0).contains(&x);
        assert!(!floor.is_stuck(), "{x}");
    }
    assert!(was_within, "it was promised that way");
    floor.until_done(&[job], 300);
    assert!(floor.zone_sets().iter().any(|set| set.zones.len() == 1), "once it is out it keeps out");
}

#[test]
fn robots_that_do_not_say_that_they_know_such_zones_get_none() {
    let mut other = standard(Version::V3_0);
    other.factsheet.as_mut().expect("it has one").zones = vec!["SPEED_LIMIT".into()];
    for setup in [other, standard(Version::V2_1)] {
        let mut floor = with_one(setup);
        floor.close([9.0, -2.0], [15.0, 2.0], 600);
        floor.run(20);
        assert!(floor.zone_sets().is_empty());
    }
}

#[test]
fn zones_that_somebody_else_has_put_in_force_stay_so() {
    let mut setup = standard(Version::V3_0);
    let corners = vec![(100.0, 100.0), (101.0, 100.0), (101.0, 101.0)];
    let zone = Zone { id: "z".into(), kind: ZoneKind::Release, corners };
    setup.zone_sets = vec![ZoneSet { id: "theirs".into(), map: FLOOR.into(), zones: vec![zone] }];
    let mut floor = with_one(setup);
    floor.close([9.0, -2.0], [15.0, 2.0], 600);
    floor.run(20);
    assert!(floor.zone_sets().is_empty() && floor.stored()[0].enabled);
}

#[test]
fn a_robot_enters_a_release_zone_of_its_own_by_a_lease_and_keeps_it_where_its_order_ends() {
    let mut setup = standard(Version::V3_0);
    let corners = vec![(18.0, -1.0), (24.0, -1.0), (24.0, 1.0), (18.0, 1.0)];
    let zone = Zone { id: "z".into(), kind: ZoneKind::Release, corners };
    setup.zone_sets = vec![ZoneSet { id: "theirs".into(), map: FLOOR.into(), zones: vec![zone] }];
    let mut floor = with_one(setup);
    let job = floor.go("end");
    floor.until(60, "it is in the zone", |f| f.pairs[0].place().0 > 19.0);
    let is_granted = |f: &LinkFloor| {
        let requests = f.pairs[0].robot.robot.state().requests;
        requests.iter().all(|request| request.status == RequestStatus::Granted)
    };
    while floor.pairs[0].place().0 > 19.0 && floor.now < Time::ZERO + Span::from_secs(300) {
        assert!(is_granted(&floor), "{:?}", floor.pairs[0].robot.robot.state().requests);
        floor.step(Vec::new());
    }
    floor.until_done(&[job], 120);
    let answers = floor.answers(Time::ZERO);
    assert!(answers.iter().all(|answer| answer.grant == Grant::Granted) && answers.len() > 1, "{answers:?}");
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn zones_of_a_process_that_died_end_with_what_is_closed_for_the_next_one() {
    let mut floor = with_one(standard(Version::V3_0));
    floor.close([9.0, -2.0], [15.0, 2.0], 40);
    floor.until(10, "it has the zone", |f| f.has_zones(1));
    floor.restart();
    floor.run(10);
    assert!(floor.has_zones(1), "{:?}", floor.stored());
    // The next process dies as well, and begins after the area is open again.
    floor.restart();
    floor.now += Span::from_secs(40);
    floor.until(30, "it has none any more", |f| f.has_zones(0) && !f.stored().is_empty());
}

#[test]
fn sets_are_put_in_force_although_messages_are_lost_doubled_and_late() {
    for seed in 1..=8 {
        let mut floor = with_one(standard(Version::V3_0));
        floor.chance = Chance { state: seed, lost: 0.15, doubled: 0.1, late_ms: 400.0 };
        floor.close([9.0, -2.0], [15.0, 2.0], 60);
        floor.until(60, "it has the zone", |f| f.stored().iter().any(|set| set.enabled));
        floor.until(120, "it has none any more", |f| f.has_zones(0));
        assert!(floor.zone_sets().len() <= 12, "{}", floor.zone_sets().len());
    }
}

#[test]
fn a_robot_that_never_stores_what_it_is_sent_is_not_sent_it_for_ever() {
    let mut floor = with_one(standard(Version::V3_0));
    floor.close([9.0, -2.0], [15.0, 2.0], 3600);
    for _period in 0..6_000 {
        floor.pairs[0].to_robot.retain(|(_, message)| !matches!(message, Message::ZoneSet(_)));
        floor.step(Vec::new());
    }
    assert_eq!(floor.zone_sets().len(), 5);
    let state = giveway_vda5050::State {
        zone_sets: (0..10_000)
            .map(|i| StoredZoneSet { id: format!("gw-9-{i}-zones"), map: FLOOR.into(), enabled: i % 2 == 0 })
            .collect(),
        ..floor.pairs[0].robot.robot.state()
    };
    let stamp = MessageStamp { id: u32::MAX, timestamp: format!("{:020}", floor.now.0 + 1) };
    let out = floor.pairs[0].session.hear(floor.now, RobotHeard::State(Box::new(state), stamp));
    assert!(out.told.len() <= 3, "{} messages at once", out.told.len());
}
