//! A ledger carried over to a changed map: robots stand where they stood, and the jobs that they had wait again.
//!
//! Main types: [`Carried`], [`Report`], [`Matching`]; main function [`carry`]. Nodes, stations and racks are matched by
//! name, all routes are dropped, and everything that the new map has no name for is listed with what to do about it.
//! Refuses: to guess where something is, and to decide whether a loss is acceptable: the operator does.

mod changes;
mod clock;
mod matching;
mod places;
mod report;

pub use clock::set_back;
pub use matching::Matching;
pub use report::{Report, ReportEntry};

use crate::state::worker::{Assignment, Closure};
use crate::{
    Job, JobKind, JobParts, JobRequest, JobState, Ledger, Parts, Promises, RecurringClosure, RobotKind,
    Unconfirmed, Visiting, Wishes,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{AssignmentId, ClosureId, IdVec, JobId, NodeId, RackId, SeriesId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use std::collections::BTreeMap;

/// What becomes of a ledger under a changed map.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// What is in the way, what would be lost, what is new.
    pub report: Report,
    /// The ledger under the new map, without what is lost; nothing if something is in the way.
    pub parts: Option<Parts>,
    /// Jobs that robots had and that wait again.
    pub waiting: Vec<JobId>,
    /// Jobs that fail because the map does not have what they name.
    pub failed: Vec<JobId>,
    /// Assignments that are cancelled because the map does not have their place.
    pub cancelled: Vec<AssignmentId>,
    /// Which ids of the new map the ids of the old map have become.
    pub ids: Matching,
}

/// Both maps, and what is found out about them.
struct Move<'a> {
    ledger: &'a Ledger,
    old: &'a Warehouse,
    new: &'a Warehouse,
    ids: Matching,
    report: Report,
    at: Time,
}

/// Carries a ledger over to a changed map, which is drawn for the kinds of the site. `at` is the time of the ledger's
/// last step: from then on robots stand where they are. Added kinds stay; a map that is not for one of them is refused.
pub fn carry(ledger: &Ledger, new: &Warehouse, at: Time) -> Carried {
    let mut report = Report::default();
    let is_of_site = |kind: &RobotKind| new.bodies().iter().any(|body| body.kind == kind.name);
    let added: Vec<RobotKind> = ledger.kinds().added().iter().filter(|k| !is_of_site(k)).cloned().collect();
    for kind in &added {
        if let Err(found) = new.check_body(&kind.body()) {
            let name = &kind.name;
            let what = format!("the map is not for robots of the kind {name:?}, which was added: {found}");
            let remedy = format!("change the map, or remove the kind first: DELETE /v1/kinds/{name}");
            report.refuse(None, what, &remedy);
        }
    }
    let bodies = new.bodies().iter().cloned().chain(added.iter().map(RobotKind::body)).collect();
    match added.is_empty() {
        true => carry_fitted(ledger, new, (added, report), at),
        false => carry_fitted(ledger, &new.with_bodies(bodies), (added, report), at),
    }
}

/// Carries a ledger over to a map that is for all kinds, including the added ones.
fn carry_fitted(
    ledger: &Ledger,
    new: &Warehouse,
    (added_kinds, report): (Vec<RobotKind>, Report),
    at: Time,
) -> Carried {
    let old = &**ledger.warehouse();
    let ids = Matching::new(old, new);
    let mut m = Move { ledger, old, new, ids, report, at };
    m.report.changes = changes::notes(old, new, &m.ids);
    let placed = m.place();
    let (jobs, waiting, failed) = m.jobs();
    let (assignments, cancelled) = m.assignments();
    let (closures, recurring) = (m.closures(), m.recurring());
    let mut promises = Promises {
        jobs,
        robots: placed.robots,
        racks: placed.racks,
        served: m.served(),
        assignments,
        closures,
        recurring,
        paused_stations: m.paused_stations(),
        unconfirmed: m.unconfirmed(),
        wishes: m.wishes(),
        ..ledger.to_parts().promises
    };
    for id in &failed {
        end_job(&mut promises, ledger, *id, at);
    }
    for id in &cancelled {
        let over = &ledger.assignments[id];
        if let Some(key) = over.request.key.clone() {
            promises.assignment_keys.end(*id, key, over.accepted);
        }
    }
    if !waiting.is_empty() {
        m.report.notes.push(format!("jobs that robots worked on and that wait again: {}", waiting.len()));
    }
    let parts =
        m.report.obstacles.is_empty().then_some(Parts { promises, added_kinds, chains: placed.chains });
    Carried { report: m.report, parts, waiting, failed, cancelled, ids: m.ids }
}

/// What [`Ledger::evolve`] does if a job fails. Jobs behind it fail by the usual rule, in the next steps.
fn end_job(promises: &mut Promises, ledger: &Ledger, id: JobId, at: Time) {
    let over = &ledger.jobs[&id];
    if let Some(key) = over.request.key.clone() {
        promises.keys.end(id, key, over.accepted);
    }
    promises.ended_badly.insert(id, at);
    promises.counts.failed += 1;
}

impl Move<'_> {
    /// Jobs that are not over, those that wait again, and those that fail.
    fn jobs(&mut self) -> (BTreeMap<JobId, Job>, Vec<JobId>, Vec<JobId>) {
        let (mut open, mut waiting, mut failed) = (BTreeMap::new(), Vec::new(), Vec::new());
        for (id, job) in &self.ledger.jobs {
            match self.request(&job.request) {
                Ok(request) => {
                    if job.state != JobState::Waiting {
                        waiting.push(*id);
                    }
                    open.insert(*id, self.job(job, request));
                }
                Err(missing) => {
                    let what = format!("job {id:?} ({}) asks for {missing}", job.request.kind.word());
                    let remedy = "with the old map, cancel it or let it end, or accept that it fails, and with it the \
                                  jobs that come after it";
                    self.report.lose(self.place_of(job.request.kind), what, remedy);
                    failed.push(*id);
                }
            }
        }
        (open, waiting, failed)
    }

    /// A job that waits again. Stations that were served and are gone are dropped, with their lines.
    fn job(&self, job: &Job, mut request: JobRequest) -> Job {
        let (mut served, mut lines) = (Vec::new(), job.lines.clone());
        for (visit, at) in &job.served {
            match self.visiting(*visit) {
                Ok(visit) => served.push((visit, *at)),
                Err(_) if lines.is_empty() => {}
                Err(_) => {
                    lines.remove(served.len());
                    request.lines.remove(served.len());
                }
            }
        }
        Job { request, state: JobState::Waiting, served, lines, ..job.clone() }
    }

    /// A job as it was submitted, by the new map's ids; or what the new map does not have.
    fn request(&self, request: &JobRequest) -> Result<JobRequest, String> {
        let then: Result<Vec<Visiting>, String> = request.then.iter().map(|v| self.visiting(*v)).collect();
        let request = JobRequest { kind: self.kind(request.kind)?, then: then?, ..request.clone() };
        self.lines(&request)?;
        Ok(request)
    }

    /// Checks that what is to be picked at the remaining stations is there on the new map.
    fn lines(&self, request: &JobRequest) -> Result<(), String> {
        let Some(rack) = request.kind.rack() else { return Ok(()) };
        let visits: Vec<StationId> = request.stations().map(|v| v.station).collect();
        let served = request.lines.len().saturating_sub(visits.len());
        for (station, lines) in visits.into_iter().zip(request.lines.iter().skip(served)) {
            if let Some((line, _)) = giveway_cell::problem(self.new, rack, station, lines) {
                let (line, name) = (&lines[line.min(lines.len() - 1)], &self.new.stations[station].name);
                return Err(format!(
                    "slot {} of rack {} and tote {} at station {name}, which are no longer there",
                    line.slot, self.new.racks[rack].name, line.tote
                ));
            }
        }
        Ok(())
    }

    fn visiting(&self, visiting: Visiting) -> Result<Visiting, String> {
        Ok(Visiting { station: self.station(visiting.station)?, ..visiting })
    }

    /// What a job wants, by the new map's ids; or what the new map does not have.
    fn kind(&self, kind: JobKind) -> Result<JobKind, String> {
        let JobParts { rack, station, node, robot, pick } = kind.parts();
        let parts = JobParts {
            rack: rack.map(|rack| self.rack(rack)).transpose()?,
            station: station.map(|station| self.station(station)).transpose()?,
            node: node.map(|node| self.node(node)).transpose()?,
            robot,
            pick,
        };
        let new = kind.name().with(parts).expect("a job keeps the parts that it has");
        let stored_at = new.rack().and(parts.node);
        if let Some(node) = stored_at.filter(|node| self.new.nodes[*node].kind != NodeKind::Storage) {
            return Err(format!("{}, which is no longer a storage node", self.new.nodes[node].name));
        }
        match new.place().filter(|place| !self.new.nodes.iter().any(|n| n.kind == *place)) {
            Some(NodeKind::Charger) => Err("a charger; there is none".into()),
            Some(_) => Err("a parking place; there is none".into()),
            None => Ok(new),
        }
    }

    /// Where a node is on the old map.
    fn spot(&self, node: NodeId) -> Option<Spot> {
        Some(self.old.nodes[node].at.into())
    }

    /// Where on the old map a job ends, or is to begin.
    fn place_of(&self, kind: JobKind) -> Option<Spot> {
        let home = || kind.rack().map(|rack| self.old.racks[rack].home);
        self.spot(kind.goal(self.old).or_else(home)?)
    }

    fn rack(&self, rack: RackId) -> Result<RackId, String> {
        self.ids.racks[rack].ok_or_else(|| format!("rack {}, which is gone", self.old.racks[rack].name))
    }

    fn station(&self, station: StationId) -> Result<StationId, String> {
        let gone = || format!("station {}, which is gone", self.old.stations[station].name);
        self.ids.stations[station].ok_or_else(gone)
    }

    fn node(&self, node: NodeId) -> Result<NodeId, String> {
        self.ids.nodes[node].ok_or_else(|| format!("node {}, which is gone", self.old.nodes[node].name))
    }

    /// Assignments that are not over, and those that are cancelled.
    fn assignments(&mut self) -> (BTreeMap<AssignmentId, Assignment>, Vec<AssignmentId>) {
        let (mut open, mut cancelled) = (BTreeMap::new(), Vec::new());
        for (id, assignment) in &self.ledger.assignments {
            match self.node(assignment.request.place) {
                Ok(place) => {
                    let mut carried = assignment.clone();
                    carried.request.place = place;
                    open.insert(*id, carried);
                }
                Err(missing) => {
                    let of = assignment.worker.map(|w| format!(" of worker {}", self.ledger.workers[w]));
                    let what = format!("assignment a{}{} is at {missing}", id.0, of.unwrap_or_default());
                    let remedy = "assign the worker to another place, or accept that it is cancelled";
                    self.report.lose(self.spot(assignment.request.place), what, remedy);
                    cancelled.push(*id);
                }
            }
        }
        (open, cancelled)
    }

    /// Closures by outline stay as they are; closures of nodes lose the nodes that are gone.
    fn closures(&mut self) -> BTreeMap<ClosureId, Closure> {
        let ledger = self.ledger;
        let all = ledger.closures.iter();
        all.filter_map(|(id, area)| Some((*id, self.closure(&format!("closure c{}", id.0), area)?))).collect()
    }

    /// Recurring closures by outline stay as they are; those of nodes lose the nodes that are gone.
    fn recurring(&mut self) -> BTreeMap<SeriesId, RecurringClosure> {
        let ledger = self.ledger;
        let mut kept = BTreeMap::new();
        for (id, recurring) in &ledger.recurring {
            let area = self.closure(&format!("recurring closure s{}", id.0), &recurring.area);
            kept.extend(area.map(|area| (*id, RecurringClosure { area, ..recurring.clone() })));
        }
        kept
    }

    fn closure(&mut self, name: &str, area: &Closure) -> Option<Closure> {
        let nodes: Vec<NodeId> = area.nodes.iter().filter_map(|n| self.ids.nodes[*n]).collect();
        let gone = area.nodes.len() - nodes.len();
        if gone > 0 && nodes.is_empty() {
            let what = format!("{name} (\"{}\") closes only nodes that are gone", area.reason);
            let at = area.nodes.first().and_then(|n| self.spot(*n));
            let remedy = "close the area again on the new map, and accept that this one ends";
            self.report.lose(at, what, remedy);
            return None;
        }
        if gone > 0 {
            self.report.notes.push(format!("{name} loses {gone} nodes that are gone"));
        }
        Some(Closure { nodes, ..area.clone() })
    }

    fn served(&self) -> IdVec<StationId, u64> {
        let mut served = IdVec::filled(0, self.new.stations.len());
        for (old, count) in self.ledger.served.pairs() {
            if let Some(new) = self.ids.stations[old] {
                served[new] = *count;
            }
        }
        served
    }

    fn paused_stations(&self) -> BTreeMap<StationId, Time> {
        let paused = self.ledger.paused_stations.iter();
        paused.filter_map(|(old, since)| Some((self.ids.stations[*old]?, *since))).collect()
    }

    /// Unconfirmed lines go with their station.
    fn unconfirmed(&self) -> BTreeMap<StationId, Unconfirmed> {
        let all = self.ledger.unconfirmed.iter();
        all.filter_map(|(old, lines)| Some((self.ids.stations[*old]?, lines.clone()))).collect()
    }

    fn wishes(&self) -> Wishes {
        let mut counts: IdVec<RackId, u32> = IdVec::filled(0, self.new.racks.len());
        for (old, count) in self.ledger.wishes.counts().pairs() {
            if let Some(new) = self.ids.racks[old] {
                counts[new] = *count;
            }
        }
        Wishes::of(counts.iter().copied().collect())
    }
}
