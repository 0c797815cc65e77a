//! Robots, racks, stations and jobs on the wire: names instead of numbers, words instead of variants, rounded to 1 mm.
//!
//! Main types: [`RobotDto`], [`RackDto`], [`StationDto`], [`JobDto`], [`Page`], and [`Names`], which makes
//! them. Ids on the wire are the names of the map; jobs are "j17". Refuses: to add knowledge of its own.

use super::cell::{LineDto, lines_dto};
use super::replans::ReplannedDto;
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{job_name, round3, time_text, worker_name};
use crate::wire::words::{ActivityDto, DoingDto, FaultDto, JobKindDto, JobStateDto, RobotStateDto};
use giveway_fleet::{
    Counts, Job, JobParts, JobRow, JobState, RackAt, RobotChoice, RobotView, View, Visiting,
};
use giveway_floor::id::{Dense, NodeId, RobotId, StationId};
use giveway_floor::text::Sentence;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// One page of a list.
#[derive(Debug, Serialize, ToSchema)]
pub struct Page<T> {
    /// The items.
    pub items: Vec<T>,
    /// The `cursor` for the next page; null on the last page.
    pub next: Option<String>,
}

// `N` refers to a node: by name, or by index in the live feed.
/// One robot.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RobotDto<N = String> {
    /// The robot's name.
    #[schema(example = "robot-1")]
    pub id: String,
    /// Position x, metres.
    pub x: f64,
    /// Position y, metres.
    pub y: f64,
    /// Heading in radians, counter-clockwise from the x axis.
    pub heading: f64,
    /// Speed in metres per second.
    pub speed: f64,
    /// What the robot is doing now; `gone` in the live feed only, where robots are listed by number.
    #[schema(value_type = ActivityDto)]
    pub activity: &'static str,
    /// Since when the robot has had this activity, RFC 3339.
    #[schema(value_type = String, example = "2027-01-31T12:00:00Z")]
    #[serde(serialize_with = "as_text")]
    pub since: Time,
    /// Whether the robot is working on its task; `gone` in the live feed only.
    #[schema(value_type = RobotStateDto)]
    pub state: &'static str,
    /// The step of the robot's task, whether the robot makes progress or not.
    #[schema(value_type = DoingDto)]
    pub doing: &'static str,
    /// The name of the robot's kind.
    #[schema(example = "robot")]
    pub kind: String,
    /// Whether the robot is in maintenance, or will be when it has finished what it has begun.
    pub maintenance: bool,
    /// Whether the robot is to leave the floor and has not left yet.
    pub leaving: bool,
    /// The fault that the robot reports; null if none.
    #[schema(value_type = Option<FaultDto>)]
    pub fault: Option<&'static str>,
    /// The rack that the robot carries.
    pub rack: Option<String>,
    /// The job on which the robot works.
    #[schema(example = "j17")]
    pub job: Option<String>,
    /// Battery charge, 0 to 1.
    pub battery: f64,
    /// The nodes granted to the robot, in order: it may drive to them now.
    #[schema(value_type = Vec<String>)]
    pub granted: Vec<N>,
    /// The nodes reserved for the robot beyond the granted ones, in order.
    #[schema(value_type = Vec<String>)]
    pub held: Vec<N>,
    /// Why the robot does not go on; null if nothing holds it up.
    #[schema(value_type = Option<SentenceSchema>)]
    pub why: Option<Sentence>,
    /// The worker whom the robot passes beside the line, within the lane's corridor; null if it keeps to the line.
    pub passes: Option<String>,
    /// Cause and time of the robot's last replanning; null if there has been none since the server started.
    pub replanned: Option<ReplannedDto>,
}

/// One rack.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RackDto<N = String> {
    /// The rack's name.
    pub id: String,
    /// The node on which the rack stands.
    #[schema(value_type = Option<String>)]
    pub node: Option<N>,
    /// The robot that carries the rack.
    pub robot: Option<String>,
}

/// One station.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct StationDto {
    /// The station's name.
    pub id: String,
    /// The robot at the picking place.
    pub robot: Option<String>,
    /// Robots in the station's queue, first in line first.
    pub queue: Vec<String>,
    /// How many racks the station has served so far.
    pub served: u64,
    /// Whether a rack stands there to be picked from. If so, `POST /v1/stations/{id}/done` ends the pick.
    pub picking: bool,
    /// Since when picking has been paused by hand, RFC 3339; null if it is not paused.
    pub paused: Option<String>,
}

/// How many jobs are in each state.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct JobCountsDto {
    /// Jobs that have no robot yet.
    pub waiting: u64,
    /// Jobs on which a robot works.
    pub active: u64,
    /// Jobs that are done.
    pub done: u64,
    /// Jobs that were cancelled.
    pub cancelled: u64,
    /// Jobs that failed.
    pub failed: u64,
}

/// Totals since the database was created, and timings of the loop over the last minutes.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CountersDto {
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// Racks served per hour, over the last ten minutes.
    pub deliveries_per_hour: f64,
    /// How often a robot came into region 1 of a worker.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
    /// Routes planned anew because of workers and closures.
    pub replans: u64,
    /// Duration of a route search, median, microseconds.
    pub plan_us_p50: u64,
    /// Duration of a route search, 99th percentile, microseconds.
    pub plan_us_p99: u64,
    /// Duration of a step, 99th percentile, microseconds.
    pub step_us_p99: u64,
}

/// A station of a delivery that visits several.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct StopDto {
    /// The station.
    #[schema(example = "S1")]
    pub station: String,
    /// How long the pick takes, seconds; null if the job does not say.
    pub pick_s: Option<f64>,
    /// When the pick there ended, RFC 3339; null until then.
    pub served: Option<String>,
    /// The order lines that are picked there.
    pub lines: Vec<LineDto>,
}

/// One job.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct JobDto {
    /// The job's number.
    #[schema(example = "j17")]
    pub id: String,
    /// The kind of job.
    pub kind: JobKindDto,
    /// The rack to move.
    pub rack: Option<String>,
    /// The station to bring the rack to. If the job visits several: the next one, or the last one when the job is over.
    pub station: Option<String>,
    /// The stations of a delivery that visits several, in order; empty if there is only one.
    pub stops: Vec<StopDto>,
    /// The order lines of the job's station; if the job visits several stations, see `stops`.
    pub lines: Vec<LineDto>,
    /// The node to which the rack or the robot is to go.
    pub node: Option<String>,
    /// The robot that works on the job, the last one that did, or the one that the job names.
    pub robot: Option<String>,
    /// The robot that an operator chose for the job; null once a robot has the job.
    pub only: Option<String>,
    /// How long the pick takes, seconds; null if the job does not say.
    pub pick_s: Option<f64>,
    /// Priority from 0 to 9; 9 goes first.
    pub priority: u8,
    /// When the job should be done, RFC 3339.
    pub deadline: Option<String>,
    /// Jobs that must be over before this one starts.
    pub after: Vec<String>,
    /// How far the job has come.
    pub state: JobStateDto,
    /// Why the job failed, or what it waits for.
    #[schema(value_type = Option<SentenceSchema>)]
    pub why: Option<Sentence>,
    /// The customer's own reference.
    #[schema(example = "order 4711")]
    pub reference: Option<String>,
    /// The customer's own labels.
    #[schema(example = json!({"wave": "7"}))]
    pub labels: BTreeMap<String, String>,
    /// When the job was accepted, RFC 3339.
    pub created: String,
    /// When the job, or its state, changed last, RFC 3339.
    pub updated: String,
    /// When the job reached each state.
    pub times: JobTimesDto,
}

/// When a job reached each state, RFC 3339; null for states that it has not reached. If a robot gives the job back, it
/// waits again, and the times of that attempt become null.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct JobTimesDto {
    /// When the job was accepted.
    pub accepted: String,
    /// When a robot got the job (state `assigned`).
    pub assigned: Option<String>,
    /// When the robot had lifted the rack (`carrying`).
    pub lifted: Option<String>,
    /// When the rack stood at the station (`picking`).
    pub at_station: Option<String>,
    /// When the job was over (`done`, `cancelled` or `failed`).
    pub ended: Option<String>,
}

fn as_text<S: Serializer>(t: &Time, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&time_text(*t))
}

/// The order lines at one of a job's stations; empty if it has none.
fn visit_lines(job: &Job, visit: usize) -> Vec<LineDto> {
    let is_on = matches!(job.state, JobState::Picking { .. }) && visit == job.served.len();
    job.lines.get(visit).map_or_else(Vec::new, |lines| lines_dto(lines, is_on))
}

/// Looks up names for ids.
#[derive(Clone, Copy)]
pub struct Names<'a> {
    /// The map, for names of nodes, racks and stations.
    pub map: &'a Warehouse,
    /// The view, for names of robots.
    pub view: &'a View,
}

impl Names<'_> {
    /// The robot's name.
    pub fn robot(&self, r: RobotId) -> String {
        self.view.robots.get(r.ix()).map_or_else(|| format!("{r:?}"), |robot| robot.name.clone())
    }

    /// The node's name.
    pub fn node(&self, n: NodeId) -> String {
        self.map.nodes.get(n).map_or_else(|| format!("{n:?}"), |node| node.name.clone())
    }

    /// All robots.
    pub fn robots(&self) -> Vec<RobotDto> {
        self.view.robots.iter().map(|robot| self.one_robot(robot)).collect()
    }

    /// One robot.
    pub fn one_robot(&self, robot: &RobotView) -> RobotDto {
        self.robot_with(robot, |n| self.node(n))
    }

    /// All robots, with indices of nodes instead of names.
    pub fn robot_rows(&self) -> Vec<RobotDto<usize>> {
        self.view.robots.iter().map(|robot| self.robot_with(robot, |n| n.ix())).collect()
    }

    fn robot_with<N>(&self, r: &RobotView, node: impl Fn(NodeId) -> N) -> RobotDto<N> {
        let rack = |r| self.map.racks.get(r).map(|rack| rack.name.clone());
        RobotDto {
            id: r.name.clone(),
            x: round3(r.pose.at.x),
            y: round3(r.pose.at.y),
            heading: round3(r.pose.heading),
            speed: round3(r.speed_mps),
            activity: r.activity.word(),
            since: r.since,
            state: RobotStateDto::from(r.state).word(),
            doing: DoingDto::from(r.doing).word(),
            kind: r.kind.clone(),
            maintenance: r.maintenance,
            leaving: r.leaving,
            fault: r.fault.map(|fault| FaultDto::from(fault).word()),
            rack: r.rack.and_then(rack),
            job: r.job.map(job_name),
            battery: round3(r.battery),
            granted: r.granted.iter().map(|n| node(*n)).collect(),
            held: r.held.iter().map(|n| node(*n)).collect(),
            why: r.why.map(|why| self.why_of(r, why)),
            passes: r.passes.map(worker_name),
            replanned: self.replanned(r),
        }
    }

    /// All racks.
    pub fn racks(&self) -> Vec<RackDto> {
        self.racks_with(|n| self.node(n))
    }

    /// All racks, with indices of nodes instead of names.
    pub fn rack_rows(&self) -> Vec<RackDto<usize>> {
        self.racks_with(|n| n.ix())
    }

    fn racks_with<N>(&self, name: impl Fn(NodeId) -> N) -> Vec<RackDto<N>> {
        let racks = self.map.racks.iter().enumerate();
        let at = |i: usize, home: NodeId| match self.view.racks.get(i) {
            Some(RackAt::On(robot)) => (None, Some(self.robot(*robot))),
            Some(RackAt::Stored(node)) => (Some(name(*node)), None),
            None => (Some(name(home)), None),
        };
        let rack = |(i, rack): (usize, &giveway_floor::warehouse::Rack)| {
            let (node, robot) = at(i, rack.home);
            RackDto { id: rack.name.clone(), node, robot }
        };
        racks.map(rack).collect()
    }

    /// All stations.
    pub fn stations(&self) -> Vec<StationDto> {
        self.map.stations.ids().map(|id| self.station(id)).collect()
    }

    /// One station.
    pub fn station(&self, id: StationId) -> StationDto {
        let nobody = giveway_fleet::StationView::default();
        let seen = self.view.stations.get(id.ix()).unwrap_or(&nobody);
        StationDto {
            id: self.map.stations[id].name.clone(),
            robot: seen.robot.map(|r| self.robot(r)),
            queue: seen.queue.iter().map(|r| self.robot(*r)).collect(),
            served: seen.served,
            picking: seen.picking,
            paused: seen.paused.map(time_text),
        }
    }

    /// A job.
    pub fn job(&self, record: &JobRow) -> JobDto {
        let request = &record.job.request;
        let gone = &record.gone;
        let JobParts { rack, station, node, robot, pick } = request.kind.parts();
        let station = station.and_then(|s| self.map.stations.get(s));
        let node = node.map(|node| gone.node.clone().unwrap_or_else(|| self.node(node)));
        let rack = rack.and_then(|r| self.map.racks.get(r));
        JobDto {
            id: job_name(record.id),
            kind: request.kind.into(),
            rack: gone.rack.clone().or_else(|| rack.map(|r| r.name.clone())),
            station: gone.station.clone().or_else(|| station.map(|s| s.name.clone())),
            node,
            robot: record.robot.or(robot).map(|r| self.robot(r)),
            pick_s: pick.map(|p| p.as_secs_f64()),
            stops: self.stops(record),
            lines: if record.job.lines.len() == 1 { visit_lines(&record.job, 0) } else { Vec::new() },
            only: match record.job.choice {
                RobotChoice::Only(robot, until) if until > self.view.now => Some(self.robot(robot)),
                _ => None,
            },
            priority: request.priority,
            deadline: request.deadline.map(time_text),
            after: request.after.iter().map(|j| job_name(*j)).collect(),
            state: record.job.state.into(),
            why: self.why_of_job(record),
            reference: request.reference.clone(),
            labels: request.labels.clone(),
            created: time_text(record.job.accepted),
            updated: time_text(record.updated),
            times: JobTimesDto {
                accepted: time_text(record.job.accepted),
                assigned: record.times.assigned.map(time_text),
                lifted: record.times.lifted.map(time_text),
                at_station: record.times.arrived.map(time_text),
                ended: record.times.ended.map(time_text),
            },
        }
    }

    /// The stations of a delivery that visits several; empty if there is only one.
    fn stops(&self, record: &JobRow) -> Vec<StopDto> {
        let (job, gone) = (&record.job, &record.gone);
        if job.served.is_empty() && job.request.then.is_empty() {
            return Vec::new();
        }
        let name = |s: StationId| {
            let gone = gone.stops.get(&s).cloned();
            gone.or_else(|| self.map.stations.get(s).map(|s| s.name.clone()))
                .unwrap_or_else(|| format!("{s:?}"))
        };
        let stop = |(i, (v, served)): (usize, (Visiting, Option<Time>))| StopDto {
            station: name(v.station),
            pick_s: v.pick.map(|p| p.as_secs_f64()),
            served: served.map(time_text),
            lines: visit_lines(job, i),
        };
        let last = (job.state == JobState::Done).then_some(record.times.ended).flatten();
        let to_come = job.request.stations().map(|v| (v, last));
        let all = job.served.iter().map(|(v, at)| (*v, Some(*at))).chain(to_come);
        all.enumerate().map(stop).collect()
    }

    fn why_of_job(&self, record: &JobRow) -> Option<Sentence> {
        if let JobState::Failed(why) = record.job.state {
            let gone = record.gone.node.clone();
            return Some(self.why_failed(why, gone));
        }
        Some(self.why_job(self.view.why_job(self.map, record.id, &record.job)?))
    }
}

impl From<Counts> for JobCountsDto {
    fn from(c: Counts) -> JobCountsDto {
        JobCountsDto {
            waiting: c.waiting,
            active: c.active,
            done: c.done,
            cancelled: c.cancelled,
            failed: c.failed,
        }
    }
}
