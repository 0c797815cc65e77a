//! Robots that say what is wrong with them: over HTTP each fault has its name and its reason, and ends.

use crate::helper::{Folder, config, floor, get};
use giveway::server::Server;
use giveway::sim::{Demand, Faults};
use serde_json::Value;
use std::time::Duration;

/// A floor on which one kind of fault happens all the time, to robots that have something to do.
fn faulty(faults: Faults) -> giveway::server::ServedFloor {
    let mut floor = floor();
    floor.source.scenario.faults = Faults { repair_s: 2.0, ..faults };
    floor.source.scenario.demand = Demand::Backlog(4);
    floor
}

#[tokio::test(flavor = "multi_thread")]
async fn each_fault_has_its_name_and_its_reason_and_ends() {
    let often = 4000.0;
    let none = Faults::default();
    for (faults, fault, reason) in [
        (Faults { emergency_stops_per_hour: often, ..none }, "emergency_stop", "emergency stop is pressed"),
        (Faults { manual_drives_per_hour: often, ..none }, "manual", "driven by hand"),
        (Faults { obstacles_per_hour: often, ..none }, "obstructed", "something stands on its way to"),
    ] {
        let folder = Folder::new();
        let server = Server::start(&config(&folder), faulty(faults)).await.unwrap();
        let at = server.address();
        let has =
            |r: &Value| r["fault"] == fault && r["why"]["text"].as_str().is_some_and(|w| w.contains(reason));
        let mut whose: Option<String> = None;
        let mut is_over = false;
        for _ in 0..2400 {
            let all = get(at, "/v1/robots").await.json();
            let robots = all["items"].as_array().unwrap();
            match &whose {
                None => {
                    let found = robots.iter().find(|r| has(r)).and_then(|r| r["id"].as_str());
                    whose = found.map(str::to_owned);
                }
                Some(id) if robots.iter().any(|r| r["id"] == *id && r["fault"].is_null()) => {
                    is_over = true;
                    break;
                }
                Some(_) => {}
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        assert!(whose.is_some(), "no robot ever said {fault}");
        assert!(is_over, "{whose:?} has it for ever");
        server.stop().await.unwrap();
    }
}
