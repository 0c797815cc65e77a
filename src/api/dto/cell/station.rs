//! What happens at one station, on the wire.
//!
//! Main type: [`StationDetailDto`]. Refuses: to keep anything from one moment to the next.

use super::{LineDto, lines_dto};
use crate::dto::names::{Names, StationDto};
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{job_name, round3, time_text};
use giveway_cell::arm::{ArmActivity, ArmTrouble};
use giveway_cell::{Lines, ReachPlace, Remaining, SeenReach};
use giveway_fleet::{ArmView, EndsHeld, StationView, WrongReach};
use giveway_floor::id::{Dense, JobId, RackId, RobotId, StationId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::reasons;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{ArmMount, Cell, Tote};
use serde::Serialize;
use utoipa::ToSchema;

/// The current state of a station.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct StationDetailDto {
    /// The time of this state, RFC 3339.
    pub now: String,
    /// The station, as in the list of stations.
    #[serde(flatten)]
    pub station: StationDto,
    /// Whether the station has a work cell, where order lines are picked.
    pub has_cell: bool,
    /// The totes, into which picked pieces are put.
    pub totes: Vec<ToteDto>,
    /// The robot arm beside the picker.
    pub arm: Option<ArmDto>,
    /// The visit of the rack that is being picked from; null if no rack is.
    pub visit: Option<VisitDto>,
    /// How accurate the expected ends of visits have been.
    pub ends: EndsHeldDto,
    /// The line whose last piece was not confirmed before its rack left; null if there is none.
    pub unconfirmed: Option<UnconfirmedDto>,
    /// Warnings of a moment ago to the person at the station.
    pub warnings: Vec<CellWarningDto>,
    /// Whether the hands of exactly one person were seen there within the last 10 s. If not, only buttons and scanners
    /// confirm lines.
    pub hands_seen: bool,
    /// The probable targets of hands that are reaching; targets with a probability below 0.05 are left out.
    pub reach: Vec<SeenReachDto>,
    /// The rack that comes next; null if none is on its way.
    pub next: Option<NextRackDto>,
}

/// A line whose rack left while a piece was on its way to the tote.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct UnconfirmedDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The unconfirmed line. Report with `POST /v1/stations/{id}/last` what became of it.
    pub line: LineDto,
}

/// The mistake of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrongReachDto {
    /// The hand goes to a slot that is not lit.
    WrongSlot,
    /// The hand put a piece into a tote that is not lit.
    WrongTote,
}

/// A hand has made a mistake, or is about to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct CellWarningDto {
    /// The kind of mistake.
    pub kind: WrongReachDto,
    /// The slot to which the hand goes, if that slot is wrong.
    #[schema(example = "C3")]
    pub slot: Option<String>,
    /// The tote into which the hand put a piece, if that tote is wrong.
    #[schema(example = "B")]
    pub tote: Option<String>,
}

/// A person's hand.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PickHandDto {
    /// The left hand.
    Left,
    /// The right hand.
    Right,
}

/// A possible target of a hand.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SeenReachDto {
    /// The hand that reaches.
    pub hand: PickHandDto,
    /// The target slot; null if the target is no slot.
    #[schema(example = "C3")]
    pub slot: Option<String>,
    /// The target tote; null if the target is no tote.
    #[schema(example = "B")]
    pub tote: Option<String>,
    /// The probability that the hand goes to this target.
    #[schema(example = 0.8)]
    pub probability: f64,
}

/// A tote of the station, placed as seen by a picker facing the rack.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ToteDto {
    /// The tote's name.
    #[schema(example = "B")]
    pub id: String,
    /// How far the tote is to the right of the rack's place, metres.
    pub right_m: f64,
    /// How far the tote is from the rack's place, towards the picker, metres.
    pub out_m: f64,
}

/// A robot arm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ArmDto {
    /// The model of the arm.
    #[schema(example = "ur10")]
    pub kind: String,
    /// What the arm does.
    pub state: ArmStateDto,
    /// Why the arm gets no trajectory, in words; null if nothing is wrong.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// The line that the arm picks; null if it picks none.
    pub line: Option<ArmLineDto>,
}

/// What a robot arm does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArmStateDto {
    /// The arm sends no reports, or its kind is unknown: hands pick all lines.
    Off,
    /// The arm rests.
    Idle,
    /// The arm moves or grips.
    Moving,
    /// The arm's own protective stop holds it.
    Stopped,
    /// The arm has not moved in the opening for a minute: no rack arrives or leaves.
    Stuck,
    /// The arm gets no trajectory, and hands pick its lines.
    Trouble,
}

/// The line that a robot arm picks.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ArmLineDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The line's number in the visit, from 1.
    pub n: usize,
}

/// The next rack for the station.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NextRackDto {
    /// The rack's name; null if the robot does not carry it yet.
    pub rack: Option<String>,
    /// The robot that brings the rack.
    pub robot: String,
    /// Seconds until its planned arrival; null if the robot waits for something whose end is unknown.
    pub in_s: Option<f64>,
}

/// The face of a rack that is turned to the picker.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RackFaceDto {
    /// How many columns of slots the face has.
    pub columns: u8,
    /// For each row, the lowest first: the height of the middle of its slots above the floor, metres.
    pub heights_m: Vec<f64>,
    /// Width over all columns, metres.
    pub width_m: f64,
}

/// A rack's time at a station.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct VisitDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The rack.
    pub rack: Option<String>,
    /// The robot under the rack.
    pub robot: String,
    /// When the rack arrived, RFC 3339; null if that was before the server started.
    pub since: Option<String>,
    /// The layout of the rack's slots; null if the map does not give it.
    pub face: Option<RackFaceDto>,
    /// The lines to pick, in the order in which they are lit; empty for a job without lines.
    pub lines: Vec<LineDto>,
    /// How many pieces are still to be picked.
    pub pieces_left: u32,
    /// Seconds until the visit is expected to end; null if the job has no lines.
    pub expected_end: Option<ExpectedEndDto>,
    /// Seconds until the last piece is expected in its tote: later than the visit's end if the rack leaves when the
    /// hand has left it for the last time.
    pub expected_placed: Option<ExpectedEndDto>,
}

/// How accurate the ends of visits at a station, as expected when the visits began, have been since the server started.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct EndsHeldDto {
    /// How many such visits have ended.
    #[schema(example = 40)]
    pub visits: u32,
    /// The share of visits that ended between `p10` and `p90`; it should be 0.8. Null before the first visit has ended.
    #[schema(example = 0.8)]
    pub held: Option<f64>,
    /// The mean error of `p50`, in seconds. Null before the first visit has ended.
    #[schema(example = 3.1)]
    pub off_s: Option<f64>,
}

impl From<EndsHeld> for EndsHeldDto {
    fn from(EndsHeld { visits, held, off_s }: EndsHeld) -> EndsHeldDto {
        let each = |sum: f64| (visits > 0).then(|| round3(sum / f64::from(visits)));
        EndsHeldDto { visits, held: each(f64::from(held)), off_s: each(off_s) }
    }
}

/// Seconds that a visit will still take, estimated from how long earlier lines took.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ExpectedEndDto {
    /// One visit in ten ends sooner than this.
    pub p10: f64,
    /// Half of the visits end sooner than this.
    pub p50: f64,
    /// Nine visits in ten end sooner than this.
    pub p90: f64,
}

impl From<Remaining> for ExpectedEndDto {
    fn from(r: Remaining) -> ExpectedEndDto {
        ExpectedEndDto { p10: round3(r.p10_s), p50: round3(r.p50_s), p90: round3(r.p90_s) }
    }
}

fn arm_dto(mount: &ArmMount, arm: Option<ArmView>) -> ArmDto {
    let activity = arm.map_or(ArmActivity::Off, |arm| arm.activity);
    let (state, reason) = match activity {
        ArmActivity::Off => (ArmStateDto::Off, None),
        ArmActivity::Idle => (ArmStateDto::Idle, None),
        ArmActivity::Moving => (ArmStateDto::Moving, None),
        ArmActivity::Trouble(ArmTrouble::Stopped) => (ArmStateDto::Stopped, Some(ArmTrouble::Stopped)),
        ArmActivity::Trouble(why) => (ArmStateDto::Trouble, Some(why)),
    };
    let is_stuck = arm.is_some_and(|arm| arm.is_stuck_inside);
    let state = if is_stuck && state != ArmStateDto::Trouble { ArmStateDto::Stuck } else { state };
    let line = arm.and_then(|arm| arm.line);
    ArmDto {
        kind: mount.kind.clone(),
        state,
        reason: reason.map(trouble),
        line: line.map(|(job, n)| ArmLineDto { job: job_name(job), n: n + 1 }),
    }
}

/// Why an arm gets no trajectory.
fn trouble(why: ArmTrouble) -> Sentence {
    match why {
        ArmTrouble::Silent => reasons::arm_is_silent(),
        ArmTrouble::Late => reasons::arm_reports_late(),
        ArmTrouble::Joints => reasons::arm_joints_impossible(),
        ArmTrouble::Jump => reasons::arm_joints_jump(),
        ArmTrouble::Stopped => reasons::arm_stopped(),
    }
}

pub(crate) fn warning_dto(wrong: WrongReach, cell: Option<&Cell>) -> CellWarningDto {
    let tote_name = |tote: usize| Some(cell?.totes.get(tote)?.name.clone());
    match wrong {
        WrongReach::Slot(slot) => {
            CellWarningDto { kind: WrongReachDto::WrongSlot, slot: Some(slot.to_string()), tote: None }
        }
        WrongReach::Tote(tote) => {
            CellWarningDto { kind: WrongReachDto::WrongTote, slot: None, tote: tote_name(tote) }
        }
    }
}

fn reach_dto(seen: &SeenReach, cell: Option<&Cell>) -> SeenReachDto {
    let (slot, tote) = match seen.place {
        ReachPlace::Slot(slot) => (Some(slot.to_string()), None),
        ReachPlace::Tote(tote) => (None, cell.and_then(|c| Some(c.totes.get(tote)?.name.clone()))),
    };
    let hand = if seen.is_left { PickHandDto::Left } else { PickHandDto::Right };
    SeenReachDto { hand, slot, tote, probability: round3(seen.probability) }
}

impl Names<'_> {
    /// The current state of a station.
    pub fn station_detail(&self, id: StationId) -> StationDetailDto {
        let empty = StationView::default();
        let seen = self.view.stations.get(id.ix()).unwrap_or(&empty);
        let cell = self.map.stations[id].cell.as_ref();
        let stands = self.map.nodes[self.map.stations[id].node].at;
        let tote = |cell: &Cell, tote: &Tote| {
            let [right_m, out_m] = cell.beside(stands, tote.at).map(round3);
            ToteDto { id: tote.name.clone(), right_m, out_m }
        };
        StationDetailDto {
            now: time_text(self.view.now),
            station: self.station(id),
            has_cell: cell.is_some(),
            totes: cell.map_or_else(Vec::new, |cell| cell.totes.iter().map(|t| tote(cell, t)).collect()),
            arm: cell.and_then(|c| c.arm.as_ref()).map(|mount| arm_dto(mount, seen.arm)),
            visit: seen.robot.zip(seen.job).map(|(robot, job)| self.visit(robot, job, seen)),
            ends: seen.ends.into(),
            unconfirmed: seen.unconfirmed.as_ref().and_then(|left| {
                let line = lines_dto(&left.lines, true).swap_remove(left.lines.lit()?);
                Some(UnconfirmedDto { job: job_name(left.job), line })
            }),
            warnings: seen.warning.iter().map(|wrong| warning_dto(*wrong, cell)).collect(),
            hands_seen: seen.saw_hands,
            reach: seen.reaches.iter().map(|reach| reach_dto(reach, cell)).collect(),
            next: seen.next.map(|(robot, at)| NextRackDto {
                rack: self.rack_on(robot).map(|k| self.map.racks[k].name.clone()),
                robot: self.robot(robot),
                in_s: at.map(|at| round3((at - self.view.now).max(Span::ZERO).as_secs_f64())),
            }),
        }
    }

    fn rack_on(&self, robot: RobotId) -> Option<RackId> {
        self.view.robots.get(robot.ix())?.rack
    }

    fn visit(&self, robot: RobotId, job: JobId, seen: &StationView) -> VisitDto {
        let rack = self.rack_on(robot);
        let rack_type = rack.and_then(|k| self.map.racks[k].rack_type).map(|t| &self.map.rack_types[t]);
        VisitDto {
            job: job_name(job),
            rack: rack.map(|k| self.map.racks[k].name.clone()),
            robot: self.robot(robot),
            since: seen.since.map(time_text),
            face: rack_type.map(|t| RackFaceDto {
                columns: t.columns,
                heights_m: t.heights_m.clone(),
                width_m: t.width_m,
            }),
            lines: seen.lines.as_ref().map_or_else(Vec::new, |lines| lines_dto(lines, true)),
            pieces_left: seen.lines.as_ref().map_or(0, Lines::pieces_left),
            expected_end: seen.left.map(Into::into),
            expected_placed: seen.placed.map(Into::into),
        }
    }
}
