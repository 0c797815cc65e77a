//! What a seed draws: map, robots, people, jobs, closures and faults, as the text of a scenario file.
//!
//! Main type: [`SwarmSetup`]. Each part has a stream of its own, and is drawn whether or not it is switched off, so
//! that cutting one down leaves everything else as it was. The text goes through the checks of every scenario file.
//! Refuses: to run anything.

use super::case::{SwarmCase, SwarmMap, SwarmPart};
use super::maps::draw_map;
use crate::random::Stream;
use crate::scenario::Scenario;
use giveway_floor::id::{Dense, NodeId};
use giveway_floor::time::Span;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// How long every job may take to end, and every rack to come to storage, after the faults have ended. In that time
/// people leave, flat batteries are exchanged (a quarter of an hour), and jobs may wait for one popular rack, or for a
/// station with more work than it does in an hour; a robot that stands still breaks a law long before.
pub const HEALS_WITHIN: Span = Span::from_secs(7200);

/// The largest number of robots that a seed draws.
const MOST_ROBOTS: usize = 30;
/// Largest share of the places where a robot may stay that robots take.
const CROWDED: f64 = 0.7;
/// Purposes of the streams of random numbers.
const MAP: u64 = 100;
const ROBOTS: u64 = 101;
const KINDS: u64 = 102;
const PEOPLE: u64 = 103;
const SENSORS: u64 = 104;
const JOBS: u64 = 105;
const CUSTOMERS: u64 = 106;
const CLOSURES: u64 = 107;
const FAULTS: u64 = 108;
const STOPS: u64 = 109;
const HOST: u64 = 110;
const LINKS: u64 = 111;
const ABILITIES: u64 = 112;
const VEHICLES: u64 = 113;

/// The setup that a case runs.
#[derive(Clone, Debug)]
pub struct SwarmSetup {
    /// The text of the scenario file, except that its map may have no file.
    pub text: String,
    /// The scenario of that text.
    pub scenario: Scenario,
    /// The map.
    pub warehouse: Arc<Warehouse>,
}

impl SwarmSetup {
    /// Draws the setup of a case.
    ///
    /// # Errors
    /// Why the given map, or the number of robots, is impossible.
    pub fn draw(case: &SwarmCase) -> Result<SwarmSetup, String> {
        let warehouse = match &case.map {
            SwarmMap::Given(_, warehouse) => warehouse.clone(),
            map => {
                let random_only = matches!(map, SwarmMap::Random);
                Arc::new(draw_map(random_only, &mut Stream::new(case.seed, MAP, 0)))
            }
        };
        let places = warehouse.nodes_where(NodeKind::is_lasting).len();
        let drawn = robots(places, &mut Stream::new(case.seed, ROBOTS, 0));
        let mut file = file(case, &warehouse, (drawn, places));
        let mut setup = SwarmSetup::read(&file, &warehouse);
        if setup.is_err() {
            // The map is too narrow for the drawn kinds.
            ["fleet", "kinds"].iter().for_each(|key| _ = file.remove(*key));
            setup = SwarmSetup::read(&file, &warehouse);
        }
        setup
    }

    fn read(file: &Map<String, Value>, warehouse: &Arc<Warehouse>) -> Result<SwarmSetup, String> {
        let text = Value::Object(file.clone()).to_string();
        let scenario = Scenario::parse(&text).map_err(|e| e.to_string())?;
        giveway_floor::warehouse::room_for(warehouse, scenario.robots).map_err(|e| e.to_string())?;
        scenario.site.fit(warehouse).map_err(|e| e.to_string())?;
        Ok(SwarmSetup { text, scenario, warehouse: warehouse.clone() })
    }
}

/// Draws a number of robots; few are as likely as many.
fn robots(places: usize, random: &mut Stream) -> usize {
    let most = ((places as f64 * CROWDED) as usize).clamp(1, MOST_ROBOTS);
    1 + (random.unit() * random.between(0.2, 1.0) * most as f64) as usize
}

fn file(case: &SwarmCase, warehouse: &Warehouse, (robots, places): (usize, usize)) -> Map<String, Value> {
    let stream = |purpose| Stream::new(case.seed, purpose, 0);
    let seconds = f64::from(case.minutes) * 60.0;
    let mut file = Map::new();
    let mut put = |key: &str, value: Value| _ = file.insert(key.into(), value);
    put("giveway_scenario", json!(1));
    put("name", json!(format!("swarm-{}", case.seed)));
    put("map", json!(warehouse.name));
    put("seed", json!(case.seed));
    put("robots", json!(case.robots.map_or(robots, |wanted| wanted.min(places))));
    put("duration_s", json!(seconds));
    put("drain_s", json!(HEALS_WITHIN.as_secs_f64()));
    put("period_ms", json!(if stream(KINDS).happens_of(0.2) { 200 } else { 100 }));
    put("jobs", demand(robots, &mut stream(JOBS)));
    let mut wanted = customers(case, &mut stream(CUSTOMERS));
    more_wanted(case, &mut stream(STOPS), &mut wanted);
    put("customers", wanted);
    let mut wrong = faults(case, seconds, &mut stream(FAULTS));
    host_faults(case, &mut stream(HOST), &mut wrong);
    let outages = at_times(0.3, 2.0, 40.0, &mut stream(LINKS));
    wrong["link_outages_per_hour"] = json!(if case.has(SwarmPart::Links) { outages } else { 0.0 });
    put("faults", wrong);
    put("closures", closures(case, seconds, warehouse, &mut stream(CLOSURES)));
    let mut crew = people(case, seconds, &mut stream(PEOPLE), &mut stream(SENSORS));
    let drivers = case.workers.unwrap_or(usize::MAX);
    crew["vehicles"] =
        if case.has(SwarmPart::Vehicles) { vehicles(drivers, &mut stream(VEHICLES)) } else { json!([]) };
    put("workers", crew);
    if case.has(SwarmPart::Fleet)
        && let Some((key, value)) = kinds(warehouse, case.robots.unwrap_or(robots), &mut stream(KINDS))
    {
        put(key, value);
    }
    if case.has(SwarmPart::Abilities) {
        abilities(&mut file, &mut stream(ABILITIES));
    }
    file
}

/// Figures of the robots: usual ones, others, or two kinds with figures of their own.
fn kinds(warehouse: &Warehouse, robots: usize, random: &mut Stream) -> Option<(&'static str, Value)> {
    let figures = |random: &mut Stream| {
        let driving_h = [8.0, 8.0, 2.0, 0.5][random.below(4)];
        json!({
            "speed_mps": random.between(0.8, 2.2),
            "accel_unloaded_mps2": random.between(0.4, 1.5),
            "accel_loaded_mps2": random.between(0.2, 0.8),
            "lift_s": random.between(1.0, 5.0),
            "drive": if random.happens_of(0.3) { "omnidirectional" } else { "differential" },
            "battery": {
                "driving_h": driving_h,
                "opportunity": random.happens_of(0.7),
            },
        })
    };
    let (mut one, mut two) = (figures(random), figures(random));
    let (share, kind) = (random.unit(), random.below(3));
    if warehouse.name == "mixed" {
        one["footprint"] = json!({"circle_m": 0.22});
        one["footprint_loaded"] = json!({"circle_m": 0.3});
        (one["carries"], one["payload_kg"]) = (json!(["bin"]), json!(60));
        two["footprint_loaded"] = json!({"square_m": 0.9});
    } else if share < 0.3 {
        return None;
    } else if share < 0.7 {
        return Some(("fleet", one));
    } else {
        one["footprint"] =
            [json!({"circle_m": 0.3}), json!({"square_m": 0.6}), json!({"circle_m": 0.4})][kind].clone();
    }
    let share = 1 + kind;
    let (shuttle, mover) =
        (json!({"name": "shuttle", "share": share, "fleet": one}), json!({"name": "mover", "fleet": two}));
    // Kinds are assigned in turn. So few robots would all be shuttles, which cannot carry every rack of the mixed hall.
    Some(("kinds", if robots <= share { json!([mover, shuttle]) } else { json!([shuttle, mover]) }))
}

/// On some floors, draws which abilities the robots of one kind lack.
fn abilities(file: &mut Map<String, Value>, random: &mut Stream) {
    let lacks_any = random.happens_of(0.3);
    let limits = ["speed", "stop", "none"];
    let can = json!({
        "revocation": random.happens_of(0.5),
        "limits": limits[random.below(limits.len())],
        "drives_back": random.happens_of(0.5),
        "horizon_nodes": random.below(4),
    });
    if !lacks_any {
        return;
    }
    match file.get_mut("kinds") {
        Some(kinds) => kinds[0]["fleet"]["can"] = can,
        None => file.entry("fleet").or_insert_with(|| json!({}))["can"] = can,
    }
}

fn demand(robots: usize, random: &mut Stream) -> Value {
    if random.happens_of(0.6) {
        json!({"backlog": 1 + random.below(2 * robots)})
    } else {
        json!({"per_hour": robots as f64 * random.between(5.0, 60.0)})
    }
}

/// A number between `low` and `high` with this probability, else 0. Always takes two numbers off the stream.
fn at_times(probability: f64, low: f64, high: f64, random: &mut Stream) -> f64 {
    let (is_there, number) = (random.happens_of(probability), random.between(low, high));
    if is_there { number } else { 0.0 }
}

fn customers(case: &SwarmCase, random: &mut Stream) -> Value {
    let mut group = Map::new();
    for (part, key, probability, (low, high)) in [
        (SwarmPart::Returns, "return", 0.5, (0.1, 1.0)),
        (SwarmPart::Relocations, "relocate", 0.5, (0.1, 1.0)),
        (SwarmPart::Charges, "charge", 0.4, (0.05, 0.5)),
        (SwarmPart::Parks, "park", 0.4, (0.05, 0.5)),
        (SwarmPart::Goes, "go", 0.5, (0.1, 1.0)),
        (SwarmPart::Wishes, "priority", 0.5, (0.1, 0.5)),
        (SwarmPart::Wishes, "deadline", 0.5, (0.1, 0.5)),
        (SwarmPart::Wishes, "after", 0.4, (0.05, 0.4)),
        (SwarmPart::Wishes, "twice", 0.4, (0.05, 0.3)),
        (SwarmPart::Cancels, "cancel", 0.5, (0.05, 0.4)),
        (SwarmPart::Picks, "slow_pick", 0.4, (0.01, 0.2)),
        (SwarmPart::Picks, "short", 0.4, (0.01, 0.2)),
        (SwarmPart::Holds, "robot_pauses_per_hour", 0.4, (2.0, 60.0)),
        (SwarmPart::Holds, "station_pauses_per_hour", 0.4, (2.0, 20.0)),
        (SwarmPart::Departures, "departures_per_hour", 0.3, (2.0, 30.0)),
    ] {
        let number = at_times(probability, low, high, random);
        group.insert(key.into(), json!(if case.has(part) { number } else { 0.0 }));
    }
    for (key, low, high) in [
        ("cancel_after_s", 1.0, 200.0),
        ("slow_pick_s", 30.0, 180.0),
        ("pause_s", 5.0, 120.0),
        ("away_s", 20.0, 200.0),
    ] {
        group.insert(key.into(), json!(random.between(low, high)));
    }
    Value::Object(group)
}

/// Habits of customers and operators that were added with deliveries to several stations.
fn more_wanted(case: &SwarmCase, random: &mut Stream, wanted: &mut Value) {
    for (part, key, probability, (low, high)) in [
        (SwarmPart::Stops, "more_stops", 0.4, (0.05, 0.5)),
        (SwarmPart::Reassigned, "reassign", 0.4, (0.05, 0.4)),
        (SwarmPart::Trades, "go_to_places", 0.5, (0.2, 1.0)),
        (SwarmPart::Trades, "trades_per_hour", 0.4, (4.0, 60.0)),
    ] {
        let number = at_times(probability, low, high, random);
        wanted[key] = json!(if case.has(part) { number } else { 0.0 });
    }
}

fn faults(case: &SwarmCase, seconds: f64, random: &mut Stream) -> Value {
    let mut group = Map::new();
    let loss = at_times(0.5, 0.01, 0.3, random);
    // Most floors have quick radios; on some, messages take seconds, on a few many seconds.
    let often = |random: &mut Stream| random.between(0.0, 1.0).powi(4);
    let delay = (at_times(0.5, 0.0, 1.0, random) * often(random) * 8_000.0) as i64;
    let jitter = (at_times(0.5, 0.0, 1.0, random) * often(random) * 10_000.0) as i64;
    let skew = at_times(0.4, 100.0, 60_000.0, random) as i64;
    group.insert("message_loss".into(), json!(if case.has(SwarmPart::Loss) { loss } else { 0.0 }));
    group.insert("message_delay_ms".into(), json!(if case.has(SwarmPart::Delay) { 20 + delay } else { 20 }));
    group.insert("message_jitter_ms".into(), json!(if case.has(SwarmPart::Jitter) { jitter } else { 0 }));
    group.insert("clock_skew_ms".into(), json!(if case.has(SwarmPart::Skew) { skew } else { 0 }));
    for (part, key, low, high) in [
        (SwarmPart::Failures, "failures_per_hour", 0.5, 20.0),
        (SwarmPart::Estops, "emergency_stops_per_hour", 0.5, 20.0),
        (SwarmPart::Obstacles, "obstacles_per_hour", 0.5, 20.0),
        (SwarmPart::Manual, "manual_drives_per_hour", 0.5, 10.0),
        (SwarmPart::Unplugged, "unplugged_per_hour", 1.0, 30.0),
        (SwarmPart::Chargers, "charger_outages_per_hour", 0.5, 6.0),
        (SwarmPart::Stations, "station_stops_per_hour", 0.5, 6.0),
        (SwarmPart::Pushes, "robot_pushes_per_hour", 0.5, 10.0),
    ] {
        let number = at_times(0.4, low, high, random);
        group.insert(key.into(), json!(if case.has(part) { number } else { 0.0 }));
    }
    group.insert("repair_s".into(), json!(random.between(10.0, 240.0)));
    group.insert("until_s".into(), json!(seconds));
    Value::Object(group)
}

/// Faults of Giveway itself, and of robots' clocks.
fn host_faults(case: &SwarmCase, random: &mut Stream, group: &mut Value) {
    for (part, key, low, high) in [
        (SwarmPart::Restarts, "restarts_per_hour", 4.0, 60.0),
        (SwarmPart::JournalSlow, "journal_slow_per_hour", 4.0, 30.0),
        (SwarmPart::JournalRefuses, "journal_refuses_per_hour", 2.0, 15.0),
        (SwarmPart::Panics, "panics_per_hour", 4.0, 40.0),
        (SwarmPart::ClockSteps, "clock_steps_per_hour", 2.0, 30.0),
    ] {
        let number = at_times(0.35, low, high, random);
        group[key] = json!(if case.has(part) { number } else { 0.0 });
    }
    let (delay, torn) = (at_times(0.4, 10.0, 900.0, random) as i64, random.happens_of(0.7));
    let is_torn = case.has(SwarmPart::JournalTorn) && delay > 0;
    group["journal_delay_ms"] = json!(if is_torn { delay } else { 0 });
    group["torn_writes"] = json!(is_torn && torn);
    group["restart_s"] = json!(random.between(0.5, 30.0));
    group["journal_outage_s"] = json!(random.between(2.0, 60.0));
}

/// Single nodes and rectangles, each closed for some minutes.
fn closures(case: &SwarmCase, seconds: f64, warehouse: &Warehouse, random: &mut Stream) -> Value {
    let count = if random.happens_of(0.4) { 1 + random.below(4) } else { 0 };
    let mut all = Vec::new();
    for _ in 0..count {
        let (from, lasts) = (random.between(0.0, 900.0), random.between(10.0, 400.0));
        let node = &warehouse.nodes[NodeId::at(random.below(warehouse.nodes.len()))];
        let (single, w, h) = (random.happens_of(0.5), random.between(0.5, 5.0), random.between(0.5, 5.0));
        let (x, y) = (node.at.x, node.at.y);
        let until = (from + lasts).min(seconds);
        if !case.has(SwarmPart::Closures) || until < from + 1.0 {
            continue;
        }
        let times = json!({"from_s": from, "until_s": until});
        let place = match single {
            true => ("nodes", json!([node.name])),
            false => ("outline", json!([[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]])),
        };
        let mut closure = times;
        closure[place.0] = place.1;
        all.push(closure);
    }
    json!(all)
}

fn people(case: &SwarmCase, seconds: f64, random: &mut Stream, sensors: &mut Stream) -> Value {
    let count = if random.happens_of(0.4) { 1 + random.below(4) } else { 0 };
    let mut shares: Vec<f64> = (0..4).map(|_| random.unit().powi(2) + 0.01).collect();
    let sum: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|s| *s /= sum);
    let enter_s = random.between(0.0, 120.0);
    let assignments = match random.happens_of(0.85) {
        true => json!({"random": {"stay_s": random.between(3.0, 40.0)}}),
        false => json!("none"),
    };
    let causes = match random.below(3) {
        0 => json!("none"),
        1 => json!("all"),
        _ => json!({"rates": {
            "pause_per_hour": random.between(0.0, 100.0), "look_per_hour": random.between(0.0, 100.0),
            "mind_per_hour": random.between(0.0, 100.0), "unknown_per_hour": random.between(0.0, 60.0),
            "wander_per_hour": random.between(0.0, 60.0), "help_per_hour": random.between(0.0, 60.0),
            "ignore": random.unit(),
        }}),
    };
    let causes = if case.has(SwarmPart::Causes) { causes } else { json!("none") };
    let sensor = sensor(sensors);
    json!({
        "count": case.workers.unwrap_or(count),
        "enter_s": enter_s,
        "leave_s": seconds,
        "assignments": assignments,
        "deviations": {"causes": causes},
        "sensor": if case.has(SwarmPart::Sensors) { sensor } else { json!({}) },
        "personas": {
            "yields": shares[0], "hurries": shares[1], "freezes": shares[2], "cuts_through": shares[3],
        },
    })
}

/// Vehicles with a driver, on some floors: from pallet stackers to trucks that fit on wide roads only. On a floor where
/// a vehicle gets to no door, it stays outside.
fn vehicles(most: usize, random: &mut Stream) -> Value {
    let count = if random.happens_of(0.25) { 1 + random.below(2) } else { 0 };
    let vehicle = |random: &mut Stream| {
        let length_m = random.between(1.2, 3.0);
        json!({
            "length_m": length_m,
            "width_m": random.between(0.7, 1.2),
            "behind_m": random.between(0.2, 0.8) * length_m,
            "speed_mps": random.between(1.0, 4.0),
            "accel_mps2": random.between(0.5, 1.5),
            "brake_mps2": random.between(1.5, 3.0),
            "tag": {"accuracy_m": random.between(0.02, 0.3), "period_s": random.between(0.1, 0.5)},
        })
    };
    json!((0..count.min(most)).map(|_| vehicle(random)).collect::<Vec<_>>())
}

/// A device: sometimes a good one, else a bad one; one with large drift or rotation reports wrong places.
fn sensor(random: &mut Stream) -> Value {
    let good = random.happens_of(0.3);
    let tag = random.happens_of(0.25);
    let mut group = Map::new();
    group.insert("source".into(), json!(if tag { "tag" } else { "headset" }));
    for (key, probability, low, high) in [
        ("jitter_ms", 0.5, 20.0, 1500.0),
        ("loss", 0.5, 0.01, 0.5),
        ("repeat", 0.4, 0.01, 0.3),
        ("drift", 0.4, 0.002, 0.06),
        ("anchor_deg", 0.4, 1.0, 30.0),
        ("jumps_per_hour", 0.4, 2.0, 120.0),
        ("resets_per_hour", 0.4, 2.0, 60.0),
        ("silences_per_hour", 0.5, 2.0, 60.0),
        ("yaw_sigma_deg", 0.4, 2.0, 60.0),
    ] {
        let number = at_times(probability, low, high, random);
        if !good {
            group.insert(key.into(), json!(number));
        }
    }
    let (delay, silence) = (random.between(20.0, 600.0), random.between(1.0, 20.0));
    if !good {
        group.insert("delay_ms".into(), json!(delay));
        group.insert("silence_s".into(), json!(silence));
    }
    Value::Object(group)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::time::Span;

    fn drawn(case: &SwarmCase) -> SwarmSetup {
        SwarmSetup::draw(case).unwrap_or_else(|e| panic!("{case}: {e}"))
    }

    #[test]
    fn the_same_seed_draws_the_same_scenario_and_each_is_one_that_a_file_may_have() {
        for seed in 0..60 {
            let case = SwarmCase::whole(seed, 10);
            let (one, two) = (drawn(&case), drawn(&case));
            assert_eq!(one.text, two.text);
            assert_eq!(one.warehouse.nodes.len(), two.warehouse.nodes.len());
        }
        let texts = |seed| drawn(&SwarmCase::whole(seed, 10)).text;
        assert_ne!(texts(1).replace("swarm-1", ""), texts(2).replace("swarm-2", ""));
    }

    #[test]
    fn what_is_cut_down_leaves_everything_else_as_it_was() {
        for seed in 0..30 {
            let whole = drawn(&SwarmCase::whole(seed, 10)).scenario;
            let less = SwarmCase {
                robots: Some(1),
                workers: Some(0),
                without: [SwarmPart::Loss, SwarmPart::Closures].into(),
                ..SwarmCase::whole(seed, 10)
            };
            let less = drawn(&less).scenario;
            assert_eq!((less.robots, less.workers.count, less.faults.message_loss), (1, 0, 0.0));
            assert!(less.closures.is_empty());
            assert_eq!(less.customers, whole.customers);
            assert_eq!(less.demand, whole.demand);
            let same = super::super::super::scenario::Faults { message_loss: 0.0, ..whole.faults };
            assert_eq!(less.faults, same);
        }
    }

    #[test]
    fn without_everything_only_plain_deliveries_are_left() {
        for seed in 0..20 {
            let case = SwarmCase {
                workers: Some(0),
                without: SwarmPart::ALL.iter().copied().collect(),
                ..SwarmCase::whole(seed, 10)
            };
            let plain = drawn(&case).scenario;
            let faults = super::super::super::scenario::Faults {
                repair_s: plain.faults.repair_s,
                restart_s: plain.faults.restart_s,
                journal_outage_s: plain.faults.journal_outage_s,
                until_s: Some(600.0),
                ..Default::default()
            };
            assert_eq!(plain.faults, faults);
            let c = plain.customers;
            let others =
                [c.put_back, c.relocate, c.charge, c.park, c.go, c.cancel, c.short, c.departures_per_hour];
            assert_eq!(others, [0.0; 8]);
            assert_eq!((plain.closures.len(), plain.site.kinds.len()), (0, 1));
        }
    }

    #[test]
    fn over_some_seeds_every_part_is_drawn() {
        let mut never: Vec<SwarmPart> = SwarmPart::ALL.to_vec();
        let text = |case: &SwarmCase| drawn(case).text;
        for seed in 0..40 {
            let whole = SwarmCase::whole(seed, 20);
            let all = text(&whole);
            never.retain(|part| text(&SwarmCase { without: [*part].into(), ..whole.clone() }) == all);
        }
        assert!(never.is_empty(), "{never:?}");
    }

    #[test]
    fn some_robot_of_each_fleet_can_carry_every_rack() {
        for (seed, robots) in (0..120).flat_map(|seed| [(seed, 1), (seed, 3)]) {
            let setup = drawn(&SwarmCase { robots: Some(robots), ..SwarmCase::whole(seed, 5) });
            let mut kinds = (0..setup.scenario.robots).map(|i| setup.scenario.kind_of(i));
            assert!(kinds.any(|k| k.name != "shuttle"), "seed {seed} with {robots} robots");
        }
    }

    #[test]
    fn a_duration_is_cut_without_drawing_anything_else() {
        let [long, short] = [20, 3].map(|minutes| drawn(&SwarmCase::whole(5, minutes)).scenario);
        assert_eq!(short.duration, Span::from_secs(180));
        assert_eq!(short.faults.until_s, Some(180.0));
        assert_eq!((long.customers, long.demand), (short.customers, short.demand));
    }
}
