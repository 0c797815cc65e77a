//! A job as customers submit it, read from JSON.
//!
//! Main type: [`NewJob`]. Refuses: fields that the kind of job does not have and names that the map does not have, and
//! reports all of them at once.

use crate::dto::cell::new_lines::{NewLine, check_lines, read_lines};
use crate::http::shared::named::{robot_named, unknown};
use crate::port::moment::Moment;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::read_end;
use crate::wire::text::parse_job_name;
use crate::wire::words::JobKindDto;
use giveway_cell::OrderLine;
use giveway_fleet::{JobField, JobKind, JobParts, JobRequest, JobWord, Visiting};
use giveway_floor::id::{NodeId, RackId, RobotId, StationId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::{refusals, requests};
use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use serde::Deserialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// The longest reference, in characters.
const LONGEST_REFERENCE: usize = 200;

/// The most labels of a job.
const MOST_LABELS: usize = 16;

/// The longest key of a label, and the longest value, in characters.
const LONGEST_KEY: usize = 40;
const LONGEST_VALUE: usize = 100;

/// The longest pick, in seconds.
const LONGEST_PICK_S: f64 = 3600.0;

/// The most jobs that a job may wait for.
const MOST_PREDECESSORS: usize = 100;

/// The most stations of one delivery.
const MOST_STOPS: usize = 16;

/// A station of a delivery that visits several.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewStop {
    /// Name of a station.
    #[schema(example = "S1")]
    station: String,
    /// How long the pick takes, seconds; the station's usual time if absent.
    #[schema(minimum = 0, maximum = 3600)]
    pick_s: Option<f64>,
    /// The lines to pick there, in this order, at most 200; only for stations with a work cell.
    #[schema(max_items = 200)]
    lines: Option<Vec<NewLine>>,
}

/// A job as a customer submits it. Its fields depend on its kind: `deliver`: rack, and station, pick_s? and lines?, or
/// stops; `return`: rack; `relocate`: rack, node; `charge` and `park`: robot; `go`: robot, node.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewJob {
    kind: JobKindDto,
    /// Name of the rack to move.
    #[schema(example = "K1")]
    rack: Option<String>,
    /// Name of the station.
    #[schema(example = "S1")]
    station: Option<String>,
    /// Stations that the rack visits one after the other, instead of `station` and `pick_s`; 1 to 16.
    #[schema(min_items = 1, max_items = 16)]
    stops: Option<Vec<NewStop>>,
    /// Name of the node to go to.
    node: Option<String>,
    /// Name of the robot.
    robot: Option<String>,
    /// How long the pick takes, seconds; the station's usual time if absent.
    #[schema(minimum = 0, maximum = 3600)]
    pick_s: Option<f64>,
    /// The lines to pick, in this order, at most 200; only for stations with a work cell.
    #[schema(max_items = 200)]
    lines: Option<Vec<NewLine>>,
    /// Priority from 0 to 9; 9 goes first; 0 if absent.
    #[schema(minimum = 0, maximum = 9)]
    priority: Option<i64>,
    /// When the job should be done, RFC 3339, not before now.
    #[schema(example = "2027-01-31T12:00:00Z")]
    deadline: Option<String>,
    /// Jobs that must be over before this one starts, at most 100.
    #[schema(example = json!(["j17"]), max_items = 100)]
    after: Option<Vec<String>>,
    /// Your own reference, up to 200 characters: lists show it and can filter by it.
    #[schema(example = "order 4711", max_length = 200)]
    reference: Option<String>,
    /// Your own labels, up to 16: keys of 1 to 40 letters, digits, `-`, `_` and `.`; values of up to 100 characters.
    /// Lists can filter by one label.
    #[schema(example = json!({"wave": "7", "customer": "northern"}))]
    labels: Option<BTreeMap<String, String>>,
}

/// Reads the fields and collects errors.
struct Reader<'a> {
    map: &'a Warehouse,
    moment: &'a Moment,
    kind: JobWord,
    errors: Vec<FieldError>,
    /// Errors in order lines.
    line_errors: Vec<FieldError>,
}

impl Reader<'_> {
    fn wrong(&mut self, field: &str, detail: Sentence) {
        self.errors.push(FieldError::new(field, detail));
    }

    /// Looks up a name that this kind of job needs.
    fn name<T>(
        &mut self,
        field: &str,
        text: Option<&str>,
        find: impl Fn(&Self, &str) -> Option<T>,
    ) -> Option<T> {
        let Some(text) = text else {
            self.wrong(field, requests::required_for(self.kind.word()));
            return None;
        };
        let found = find(self, text);
        if found.is_none() {
            self.wrong(field, unknown(field, text));
        }
        found
    }

    fn rack(&mut self, new: &NewJob) -> Option<RackId> {
        self.name("rack", new.rack.as_deref(), |r, text| r.map.rack_named(text))
    }

    fn node(&mut self, new: &NewJob) -> Option<NodeId> {
        self.name("node", new.node.as_deref(), |r, text| r.map.node_named(text))
    }

    fn station(&mut self, new: &NewJob) -> Option<StationId> {
        self.name("station", new.station.as_deref(), |r, text| r.map.station_named(text))
    }

    fn robot(&mut self, new: &NewJob) -> Option<RobotId> {
        self.name("robot", new.robot.as_deref(), |r, text| robot_named(r.moment, text))
    }

    /// The first station of the rack.
    fn first_stop(&mut self, new: &NewJob) -> Option<Visiting> {
        if let Some(first) = new.stops.as_deref().and_then(<[NewStop]>::first) {
            return self.stop(0, first);
        }
        let pick = self.pick("pick_s", new.pick_s);
        Some(Visiting { station: self.station(new)?, pick })
    }

    /// The stations after the first; adds an error for an invalid list of stops.
    fn then(&mut self, new: &NewJob) -> Vec<Visiting> {
        let Some(stops) = new.stops.as_deref().filter(|_| self.kind.fields().contains(&JobField::Station))
        else {
            return Vec::new();
        };
        if !(1..=MOST_STOPS).contains(&stops.len()) {
            self.wrong("stops", requests::stops_out_of_range(stops.len(), MOST_STOPS));
            return Vec::new();
        }
        let own = [
            ("station", new.station.is_some()),
            ("pick_s", new.pick_s.is_some()),
            ("lines", new.lines.is_some()),
        ];
        for (field, _) in own.into_iter().filter(|(_, given)| *given) {
            self.wrong(field, requests::stops_have_their_own());
        }
        for (i, pair) in stops.windows(2).enumerate() {
            if pair[0].station == pair[1].station {
                let detail = requests::station_twice(&pair[0].station);
                self.wrong(&format!("stops[{}].station", i + 1), detail);
            }
        }
        (1..).zip(&stops[1..]).filter_map(|(i, stop)| self.stop(i, stop)).collect()
    }

    fn stop(&mut self, i: usize, stop: &NewStop) -> Option<Visiting> {
        let field = format!("stops[{i}].station");
        let pick = self.pick(&format!("stops[{i}].pick_s"), stop.pick_s);
        let station = self.map.station_named(&stop.station);
        if station.is_none() {
            self.wrong(&field, unknown("station", &stop.station));
        }
        Some(Visiting { station: station?, pick })
    }

    /// The lines of each station; empty if no station has any.
    fn lines(&mut self, new: &NewJob, request: &JobRequest) -> Vec<Vec<OrderLine>> {
        let given: Vec<(String, &[NewLine])> = match new.stops.as_deref() {
            Some(stops) => {
                let fields = (0..stops.len()).map(|i| format!("stops[{i}].lines"));
                fields.zip(stops.iter().map(|stop| stop.lines.as_deref().unwrap_or(&[]))).collect()
            }
            None => vec![("lines".into(), new.lines.as_deref().unwrap_or(&[]))],
        };
        if given.iter().all(|(_, lines)| lines.is_empty()) {
            return Vec::new();
        }
        let Some(rack) = request.kind.rack() else { return Vec::new() };
        let mut all = Vec::new();
        for ((field, lines), visit) in given.into_iter().zip(request.stations()) {
            let Some(lines) = read_lines(&field, lines, &mut self.line_errors) else { continue };
            self.line_errors.extend(check_lines(&field, self.map, (rack, visit.station), &lines));
            all.push(lines);
        }
        all
    }

    fn pick(&mut self, field: &str, seconds: Option<f64>) -> Option<Span> {
        let seconds = seconds?;
        if !(0.0..=LONGEST_PICK_S).contains(&seconds) {
            self.wrong(field, requests::seconds_out_of_range(LONGEST_PICK_S as i64));
            return None;
        }
        Some(Span::from_secs_f64(seconds))
    }

    /// Adds an error for fields that this kind of job does not have.
    fn superfluous(&mut self, new: &NewJob) {
        let fields: Vec<&str> =
            self.kind.fields().iter().flat_map(|field| own_fields(*field)).copied().collect();
        let given = [
            ("rack", new.rack.is_some()),
            ("station", new.station.is_some()),
            ("stops", new.stops.is_some()),
            ("node", new.node.is_some()),
            ("robot", new.robot.is_some()),
            ("pick_s", new.pick_s.is_some()),
            ("lines", new.lines.is_some()),
        ];
        for (field, _) in given.into_iter().filter(|(f, given)| *given && !fields.contains(f)) {
            self.wrong(field, requests::no_such_field(self.kind.word(), fields.to_vec()));
        }
    }

    /// Adds an error for a reference or labels that are too long, too many or empty.
    fn names(&mut self, new: &NewJob) {
        let fits = |text: &str, longest: usize| {
            (1..=longest).contains(&text.chars().count()) && !text.chars().any(char::is_control)
        };
        if new.reference.as_deref().is_some_and(|text| !fits(text, LONGEST_REFERENCE)) {
            self.wrong("reference", requests::characters_without_line_breaks(LONGEST_REFERENCE));
        }
        let labels = new.labels.iter().flatten();
        if labels.clone().count() > MOST_LABELS {
            self.wrong("labels", requests::at_most_allowed(MOST_LABELS));
        }
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        for (key, value) in labels.take(MOST_LABELS) {
            if !fits(key, LONGEST_KEY) || !key.chars().all(plain) {
                self.wrong("labels", requests::plain_key(LONGEST_KEY));
            } else if !fits(value, LONGEST_VALUE) {
                let detail = requests::characters_without_line_breaks(LONGEST_VALUE);
                self.wrong(&format!("labels.{key}"), detail);
            }
        }
    }

    /// The kind of job with its parts.
    fn kind(&mut self, new: &NewJob) -> Option<JobKind> {
        let mut parts = JobParts::default();
        for field in self.kind.fields() {
            match field {
                JobField::Rack => parts.rack = self.rack(new),
                JobField::Station => {
                    if let Some(first) = self.first_stop(new) {
                        (parts.station, parts.pick) = (Some(first.station), first.pick);
                    }
                }
                JobField::Node => parts.node = self.node(new),
                JobField::Robot => parts.robot = self.robot(new),
                // The pick belongs to the stop.
                JobField::Pick => {}
            }
        }
        self.kind.with(parts).ok()
    }
}

/// The fields of a submitted job that give a part.
fn own_fields(part: JobField) -> &'static [&'static str] {
    match part {
        JobField::Rack => &["rack"],
        JobField::Station => &["station", "stops"],
        JobField::Node => &["node"],
        JobField::Robot => &["robot"],
        JobField::Pick => &["pick_s", "lines"],
    }
}

impl NewJob {
    /// The request to the fleet, without a key.
    pub(super) fn read(&self, map: &Warehouse, moment: &Moment) -> Result<JobRequest, Problem> {
        let mut r = Reader { map, moment, kind: self.kind.0, errors: Vec::new(), line_errors: Vec::new() };
        r.superfluous(self);
        let priority = self.priority.unwrap_or(0);
        if !(0..=9).contains(&priority) {
            r.wrong("priority", refusals::priority_out_of_range(priority));
        }
        let deadline = read_end("deadline", self.deadline.as_deref(), &mut r.errors);
        r.names(self);
        let names = self.after.as_deref().unwrap_or(&[]);
        if names.len() > MOST_PREDECESSORS {
            r.wrong("after", requests::predecessors_out_of_range(names.len(), MOST_PREDECESSORS));
        }
        let mut after = Vec::new();
        for (i, name) in names.iter().take(MOST_PREDECESSORS).enumerate() {
            match parse_job_name(name) {
                Some(id) => after.push(id),
                None => r.wrong(&format!("after[{i}]"), requests::not_a_job_id(name)),
            }
        }
        let then = r.then(self);
        match (r.kind(self), r.errors.is_empty()) {
            (Some(kind), true) => {
                let priority = u8::try_from(priority).unwrap_or(0);
                let (reference, labels) = (self.reference.clone(), self.labels.clone().unwrap_or_default());
                let request = JobRequest::new(kind);
                let request = JobRequest { then, priority, deadline, after, reference, labels, ..request };
                let lines = r.lines(self, &request);
                match r.line_errors.is_empty() {
                    true => Ok(JobRequest { lines, ..request }),
                    false => Err(Problem::bad_lines(r.line_errors)),
                }
            }
            _ => Err(Problem::invalid(r.errors)),
        }
    }
}
