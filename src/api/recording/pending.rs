//! Waiting jobs in recordings.
//!
//! Main function: [`line()`]. Refuses: to count waiting jobs; the frame does.

use crate::live::Frame;
use crate::wire::text::{job_name, round3};
use giveway_fleet::{JobKind, JobParts, Pending};
use giveway_floor::id::Dense;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use serde::Serialize;
use serde_json::json;

/// A job that no robot has yet.
#[derive(Serialize)]
struct PendingDto {
    id: String,
    kind: &'static str,
    /// Names of the rack or robot, and of the station or node to which it is to go.
    what: Vec<String>,
    priority: u8,
    submitted_s: f64,
    /// A job that must be over first.
    #[serde(skip_serializing_if = "Option::is_none")]
    after: Option<String>,
}

/// The line that lists a frame's waiting jobs. Its time is the time of the list.
pub fn line(frame: &Frame, map: &Warehouse) -> String {
    let seconds = |at: Time| round3((at - frame.beside.zero).as_secs_f64());
    let backlog = &frame.beside.backlog;
    let job = |p: &Pending| PendingDto {
        id: job_name(p.job),
        kind: p.kind.word(),
        what: what(p.kind, frame, map),
        priority: p.priority,
        submitted_s: seconds(p.accepted),
        after: p.after.map(job_name),
    };
    let jobs: Vec<PendingDto> = backlog.jobs.iter().map(job).collect();
    format!("{{\"at\":{},\"waiting\":{}}}\n", seconds(backlog.at), json!(jobs))
}

fn what(kind: JobKind, frame: &Frame, map: &Warehouse) -> Vec<String> {
    let JobParts { robot, rack, station, node, .. } = kind.parts();
    let robot = robot.and_then(|r| Some(frame.robots.get(r.ix())?.id.clone()));
    let rack = rack.and_then(|r| Some(map.racks.get(r)?.name.clone()));
    let station = station.and_then(|s| Some(map.stations.get(s)?.name.clone()));
    let node = node.and_then(|n| Some(map.nodes.get(n)?.name.clone()));
    let goal = station.or(node);
    [robot, rack, goal].into_iter().flatten().collect()
}
