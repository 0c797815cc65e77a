//! Jobs as recordings have them.
//!
//! Main types: [`JobLine`], [`ChangeLine`]. Fields that came later are left out where they say nothing, so that older
//! recordings are read. Refuses: versions; [`super`] has them.

use giveway_cell::{OrderLine, PickedBy};
use giveway_fleet::{ClientKey, JobChange, JobKind, JobParts, JobRequest, JobWord, Visiting};
use giveway_floor::id::{CustomerId, JobId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A job as it was submitted.
#[derive(Serialize, Deserialize)]
pub struct JobLine {
    /// The token of the request.
    pub token: u64,
    kind: LineKind,
    priority: u8,
    deadline: Option<i64>,
    after: Vec<u64>,
    key: Option<String>,
    /// The owner of the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    owner: Option<u64>,
    /// Further stations of the rack, and how long the picks take.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    then: Vec<(u32, Option<i64>)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    labels: BTreeMap<String, String>,
    /// Order lines at each station: slot, pieces, tote, item, picker.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lines: Vec<Vec<OrderRow>>,
}

/// The wanted job: an object with one field, named by the word for the kind; its value has the numbers of the parts in
/// the order of the kind's fields.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<String, PartNumbers>", into = "BTreeMap<String, PartNumbers>")]
struct LineKind(JobKind);

/// The numbers of a job's parts; a single one is written without a list.
#[derive(Clone, Serialize, Deserialize)]
#[serde(untagged)]
enum PartNumbers {
    One(i64),
    Several(Vec<Option<i64>>),
}

impl From<LineKind> for BTreeMap<String, PartNumbers> {
    fn from(LineKind(kind): LineKind) -> BTreeMap<String, PartNumbers> {
        let parts = kind.parts();
        let numbers: Vec<Option<i64>> = kind.name().fields().iter().map(|f| parts.number(*f)).collect();
        let numbers = match numbers[..] {
            [Some(only)] => PartNumbers::One(only),
            _ => PartNumbers::Several(numbers),
        };
        [(kind.word().to_owned(), numbers)].into()
    }
}

impl TryFrom<BTreeMap<String, PartNumbers>> for LineKind {
    type Error = String;

    fn try_from(line: BTreeMap<String, PartNumbers>) -> Result<LineKind, String> {
        let (word, numbers) = line.into_iter().next().ok_or("a job without a kind")?;
        let name = JobWord::of_word(&word).ok_or_else(|| format!("no kind of job is called {word:?}"))?;
        let numbers = match numbers {
            PartNumbers::One(only) => vec![Some(only)],
            PartNumbers::Several(numbers) => numbers,
        };
        let mut parts = JobParts::default();
        for (field, number) in name.fields().iter().zip(numbers) {
            if let Some(number) = number {
                parts = parts.with_number(*field, number);
            }
        }
        let kind = name.with(parts);
        kind.map(LineKind).map_err(|missing| format!("a {word} job without its {}", missing.word()))
    }
}

/// A change to a job.
#[derive(Serialize, Deserialize)]
pub struct ChangeLine {
    priority: Option<u8>,
    /// The new deadline: an empty list for none; absent if unchanged.
    deadline: Option<Vec<i64>>,
    station: Option<u32>,
    robot: Option<u32>,
}

impl JobLine {
    /// A line for a request.
    pub fn new(token: u64, request: &JobRequest) -> JobLine {
        JobLine {
            token,
            kind: LineKind(request.kind),
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

/// The order line of a row; nothing for one that no program has written.
fn order_line((slot, quantity, tote, item, by): OrderRow) -> Option<OrderLine> {
    Some(OrderLine { slot: slot.parse().ok()?, quantity, tote, item, by: PickedBy::named(&by)? })
}

impl From<JobLine> for JobRequest {
    fn from(line: JobLine) -> JobRequest {
        JobRequest {
            kind: line.kind.0,
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
    use giveway_floor::id::RackId;

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
