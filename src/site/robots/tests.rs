//! Tests of the file of robots, on the laboratory's map.

use super::*;
use giveway_floor::warehouse::lab;
use giveway_vda5050::Version;

const GOOD: &str = r#"{"giveway_robots": 1, "interface": "hall/uagv", "map_id": "lab",
    "kinds": {"tug": {"fleet": {"speed_mps": 1.2}, "link": {"longest_base_m": 3}}, "cart": {}},
    "robots": [{"name": "t1", "manufacturer": "maker", "serial": "1", "kind": "tug", "version": "2.1.0"},
               {"name": "c1", "manufacturer": "maker", "serial": "2", "kind": "cart"}]}"#;

fn broker() -> Option<BrokerSettings> {
    Some(BrokerSettings { url: "mqtt://localhost:1883".into(), ..BrokerSettings::default() })
}

fn faults(text: &str) -> Vec<String> {
    let (site, map) = (Site::default(), Arc::new(lab()));
    RobotsFile::parse(text, Some((&site, &map))).expect_err("a fault").0
}

#[test]
fn one_map_id_is_short_for_the_maps_of_all_kinds_and_a_kind_may_say_nothing_else() {
    let file = RobotsFile::parse(GOOD, None).expect("a file");
    let frame = crate::MapFrame::same("lab");
    for kind in ["tug", "cart"] {
        assert_eq!(file.settings[kind].maps, std::slice::from_ref(&frame), "{kind}");
    }
    assert_eq!((file.settings["tug"].longest_base_m, file.settings["cart"].longest_base_m), (3.0, 4.0));
    let limits = |kind: &OpenKind| kind.filled(None).expect("a kind").capabilities.limits;
    assert!(
        file.open.len() == 2 && file.open.iter().all(|k| limits(k) == giveway_fleet::ObeyedLimits::Stops)
    );
    let [first, second] = &file.robots[..] else { panic!("two robots: {:?}", file.robots) };
    assert_eq!((first.version, second.version), (Some(Version::V2_1), None));
    assert_eq!(file.interface.as_deref(), Some("hall/uagv"));
}

#[test]
fn robots_of_a_file_drive_beside_those_of_the_floor() {
    let mut site = Site::default();
    let file = RobotsFile::parse(GOOD, Some((&site, &Arc::new(lab())))).expect("a file");
    site.add_robots(broker(), Some(file)).expect("robots");
    let mqtt = site.links.mqtt.as_ref().expect("a link");
    assert_eq!((mqtt.interface.as_str(), mqtt.robots.len(), mqtt.kinds.len()), ("hall/uagv", 2, 2));
    let kinds: Vec<&str> = site.kinds.iter().map(|kind| kind.name.as_str()).collect();
    assert_eq!(kinds, ["robot"], "the others wait for what their robots say of themselves");
    assert_eq!(mqtt.open.iter().map(|kind| kind.name.as_str()).collect::<Vec<_>>(), ["cart", "tug"]);
    let whole = r#"{"giveway_robots": 1, "kinds": {"cart": {"fleet": {"speed_mps": 1, "accel_unloaded_mps2": 1,
        "turn_radps": 1, "footprint": {"circle_m": 0.3}, "payload_kg": 50},
        "link": {"maps": {"lab": {}}}}}, "robots": []}"#;
    let file = RobotsFile::parse(whole, None).expect("a file");
    assert_eq!((file.kinds[0].name.as_str(), file.open.len()), ("cart", 0));
}

#[test]
fn a_broker_among_the_flags_takes_the_place_of_the_sites_and_the_sites_robots_stay() {
    let text = r#"{"giveway_site": 1, "name": "h", "map": "h.json", "kinds": [{"name": "own", "link": {"maps":
        {"lab": {}}}}], "links": {"mqtt": {"url": "mqtt://old", "user": "me", "qos": 1, "interface": "x"}},
        "robots": [{"name": "o1", "manufacturer": "m", "serial": "1", "kind": "own"}]}"#;
    let mut site = Site::parse(text).expect("a site");
    let more = r#"{"giveway_robots": 1, "robots": [
        {"name": "o2", "manufacturer": "m", "serial": "2", "kind": "own"}]}"#;
    let file = RobotsFile::parse(more, Some((&site, &Arc::new(lab())))).expect("of the site's kind");
    site.add_robots(broker(), Some(file)).expect("robots");
    let mqtt = site.links.mqtt.as_ref().expect("a link");
    assert_eq!((mqtt.url.as_str(), mqtt.user.as_deref()), ("mqtt://localhost:1883", None));
    assert_eq!((mqtt.qos, mqtt.interface.as_str(), mqtt.robots.len()), (1, "x", 2));
    let other = RobotsFile::parse(&GOOD.replace("hall/uagv", "y"), None).expect("a file");
    let said = site.add_robots(None, Some(other)).expect_err("two interfaces").to_string();
    assert!(said.contains("give all robots one interface"), "{said}");
}

#[test]
fn robots_without_a_broker_and_brokers_that_cannot_be_one_are_refused() {
    let file = RobotsFile::parse(GOOD, None).expect("a file");
    let said = Site::default().add_robots(None, Some(file)).expect_err("no broker").to_string();
    assert!(said.contains("--mqtt mqtt://HOST:PORT"), "{said}");
    let half = BrokerSettings { cert: Some("c.pem".into()), ..broker().expect("one") };
    let said = Site::default().add_robots(Some(half), None).expect_err("no key").to_string();
    assert!(said.contains("go together"), "{said}");
}

#[test]
fn everything_that_is_wrong_with_a_file_is_said_at_once_with_its_place_and_a_remedy() {
    let text = r#"{"giveway_robots": 2, "robbots": [], "interface": "a/#", "map_id": "lab",
        "kinds": {"robot": {}, "big": {"fleet": {"footprint": {"square_m": 9}}}, "odd": {"flet": {}},
                  "fast": {"fleet": {"speed_mps": 99}, "link": {"longest_base_m": 0}}},
        "robots": [{"name": "a", "manufacturer": "m", "serial": "1", "kind": "big"},
                   {"name": "b", "manufacturer": "m", "serial": "1", "kind": "odd"},
                   {"name": "c", "manufacturer": "m", "serial": "2", "kind": "none"},
                   {"name": "d", "manufacturer": "m", "serial": "3", "kind": "fast", "colour": "red"}]}"#;
    let said = faults(text);
    for part in [
        "`robbots` is no key of this file: it has giveway_robots, interface",
        "`giveway_robots` must be 1",
        "`interface`: the first levels of a topic",
        "kinds: the floor has a kind \"robot\" already: take another name",
        "kinds.big: the map is not for these robots:",
        "kinds.odd: unknown field `flet`, expected `fleet` or `link`",
        "`kinds.fast.fleet.speed_mps` is 99, but must be from 0.1 to 5",
        "`kinds.fast.link.longest_base_m` is 0",
        "robots[1]: m/1 is \"a\" already",
        "robots[2]: kind \"none\" is none of the kinds that have a `link`",
        "robots[3]: unknown field `colour`",
    ] {
        assert!(said.iter().any(|fault| fault.starts_with(part)), "{part}: {said:#?}");
    }
    assert_eq!(said.len(), 11, "{said:#?}");
}

#[test]
fn what_is_no_file_of_robots_is_refused_in_words() {
    for (text, part) in [
        ("[", "line 1, column"),
        ("[]", "must be an object"),
        (r#"{"giveway_robots": 1}"#, "`robots` is missing"),
        (r#"{"giveway_robots": 1, "robots": 3}"#, "`robots`: invalid type"),
        (r#"{"giveway_robots": 1, "robots": [], "kinds": {"a": {}}}"#, "`kinds.a.link.maps` must name"),
    ] {
        let said = faults(text);
        assert!(matches!(&said[..], [one] if one.contains(part)), "{text}: {said:?}");
    }
}
