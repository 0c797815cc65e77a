//! Robots that say what is wrong with them: over HTTP each fault has its name and its reason, and ends.

use crate::helper::{Folder, config, eventually, floor, get};
use giveway::server::Server;
use giveway::sim::{Demand, Faults};
use serde_json::Value;

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
        let robots = async || get(at, "/v1/robots").await.json()["items"].as_array().unwrap().clone();
        let says = async || robots().await.into_iter().find(has);
        let whose = eventually(&format!("a robot says {fault}"), says).await["id"].clone();
        let is_over = |r: &Value| r["id"] == whose && r["fault"].is_null();
        let ends = async || robots().await.iter().any(is_over).then_some(());
        eventually(&format!("{fault} of {whose} ends"), ends).await;
        server.stop().await.unwrap();
    }
}
