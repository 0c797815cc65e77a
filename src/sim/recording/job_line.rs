//! Jobs as recordings have them.
//!
//! Main types: [`JobLine`], [`ChangeLine`]. Fields that came later are left out where they say nothing, so that older
//! recordings are read. Refuses: versions; [`super`] has them.

use crate::cell::{OrderLine, PickedBy};
use crate::fleet::{ClientKey, JobChange, JobKind, JobRequest, Visiting};
use crate::id::{CustomerId, JobId, NodeId, RackId, RobotId, StationId};
use crate::time::{Span, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A job as it was submitted.
#[derive(Serialize, Deserialize)]
pub struct JobLine {
    /// Of the request.
    pub token: u64,
    kind: LineKind,
    priority: u8,
    deadline: Option<i64>,
    after: Vec<u64>,
    key: Option<String>,
    /// Whose key it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    owner: Option<u64>,
    /// Stations that the rack goes on to, and how long the picks take.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    then: Vec<(u32, Option<i64>)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    labels: BTreeMap<String, String>,
    /// What is picked at each station: slot, pieces, tote, item, by whom.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lines: Vec<Vec<OrderRow>>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LineKind {
    Deliver(u32, u32, Option<i64>),
    Return(u32),
    Relocate(u32, u32),
    Charge(u32),
    Park(u32),
    Go(u32, u32),
}

/// What was changed about a job.
#[derive(Serialize, Deserialize)]
pub struct ChangeLine {
    priority: Option<u8>,
    /// A list of none or one, where it was given.
    deadline: Option<Vec<i64>>,
    station: Option<u32>,
    robot: Option<u32>,
}

impl JobLine {
    /// A line for a request.
    pub fn new(token: u64, request: &JobRequest) -> JobLine {
        let kind = match request.kind {
            JobKind::Deliver { rack, station, pick } => {
                LineKind::Deliver(rack.0, station.0, pick.map(|p| p.0))
            }
            JobKind::Return { rack } => LineKind::Return(rack.0),
            JobKind::Relocate { rack, node } => LineKind::Relocate(rack.0, node.0),
            JobKind::Charge { robot } => LineKind::Charge(robot.0),
            JobKind::Park { robot } => LineKind::Park(robot.0),
            JobKind::Go { robot, node } => LineKind::Go(robot.0, node.0),
        };
        JobLine {
            token,
            kind,
            priority: request.priority,
            deadline: request.deadline.map(|d| d.0),
            after: request.after.iter().map(|j| j.0).collect(),
            key: request.key.as_ref().map(|key| key.text.clone()),
            owner: request.key.as_ref().and_then(|key| key.owner).map(|owner| owner.0),
            then: request.then.iter().map(|v| (v.station.0, v.pick.map(|p| p.0))).collect(),
            reference: request.reference.clone(),
            labels: request.labels.clone(),
            lines: request.lines.iter().map(|visit| visit.iter().map(order_row).collect()).collect(),
        }
    }
}

type OrderRow = (String, u32, String, Option<String>, String);

fn order_row(line: &OrderLine) -> OrderRow {
    let OrderLine { slot, quantity, tote, item, by } = line;
    (slot.to_string(), *quantity, tote.clone(), item.clone(), by.word().to_owned())
}

/// A line as it was written; nothing for one that no program has written.
fn order_line((slot, quantity, tote, item, by): OrderRow) -> Option<OrderLine> {
    Some(OrderLine { slot: slot.parse().ok()?, quantity, tote, item, by: PickedBy::named(&by)? })
}

impl From<JobLine> for JobRequest {
    fn from(line: JobLine) -> JobRequest {
        let kind = match line.kind {
            LineKind::Deliver(rack, station, pick) => {
                JobKind::Deliver { rack: RackId(rack), station: StationId(station), pick: pick.map(Span) }
            }
            LineKind::Return(rack) => JobKind::Return { rack: RackId(rack) },
            LineKind::Relocate(rack, node) => JobKind::Relocate { rack: RackId(rack), node: NodeId(node) },
            LineKind::Charge(robot) => JobKind::Charge { robot: RobotId(robot) },
            LineKind::Park(robot) => JobKind::Park { robot: RobotId(robot) },
            LineKind::Go(robot, node) => JobKind::Go { robot: RobotId(robot), node: NodeId(node) },
        };
        JobRequest {
            kind,
            priority: line.priority,
            deadline: line.deadline.map(Time),
            after: line.after.into_iter().map(JobId).collect(),
            key: line.key.map(|text| ClientKey { owner: line.owner.map(CustomerId), text }),
            then: line.then.into_iter().map(visiting).collect(),
            reference: line.reference,
            labels: line.labels,
            lines: line.lines.into_iter().map(|v| v.into_iter().filter_map(order_line).collect()).collect(),
        }
    }
}

fn visiting((station, pick): (u32, Option<i64>)) -> Visiting {
    Visiting { station: StationId(station), pick: pick.map(Span) }
}

impl From<&JobChange> for ChangeLine {
    fn from(change: &JobChange) -> ChangeLine {
        ChangeLine {
            priority: change.priority,
            deadline: change.deadline.map(|d| d.iter().map(|d| d.0).collect()),
            station: change.station.map(|s| s.0),
            robot: change.robot.map(|r| r.0),
        }
    }
}

impl From<ChangeLine> for JobChange {
    fn from(line: ChangeLine) -> JobChange {
        JobChange {
            priority: line.priority,
            deadline: line.deadline.map(|d| d.first().copied().map(Time)),
            station: line.station.map(StationId),
            robot: line.robot.map(RobotId),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_and_changes_are_read_as_they_were_written_and_older_lines_too() {
        let kind = JobKind::Deliver { rack: RackId(1), station: StationId(2), pick: Some(Span(3)) };
        let (reference, labels) = (Some("order 4711".into()), [("wave".to_owned(), "7".to_owned())].into());
        let line = |slot: &str, item: Option<&str>| OrderLine {
            slot: slot.parse().unwrap(),
            quantity: 2,
            tote: "B".into(),
            item: item.map(str::to_owned),
            by: PickedBy::Hand,
        };
        let lines = vec![vec![line("C3", None), line("A1", Some("screw"))], Vec::new()];
        let request = JobRequest { reference, labels, key: Some("k".into()), lines, ..JobRequest::new(kind) };
        let text = serde_json::to_string(&JobLine::new(9, &request)).unwrap();
        assert_eq!(JobRequest::from(serde_json::from_str::<JobLine>(&text).unwrap()), request);
        let older = r#"{"token":1,"kind":{"park":4},"priority":2,"deadline":null,"after":[],"key":null}"#;
        let read = JobRequest::from(serde_json::from_str::<JobLine>(older).unwrap());
        let park = JobKind::Park { robot: RobotId(4) };
        assert_eq!(read, JobRequest { priority: 2, ..JobRequest::new(park) });
        for deadline in [None, Some(None), Some(Some(Time(5)))] {
            let change = JobChange { deadline, robot: Some(RobotId(1)), ..JobChange::default() };
            let text = serde_json::to_string(&ChangeLine::from(&change)).unwrap();
            assert_eq!(JobChange::from(serde_json::from_str::<ChangeLine>(&text).unwrap()), change, "{text}");
        }
    }
}
