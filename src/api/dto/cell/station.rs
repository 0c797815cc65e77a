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

/// What happens at a station, now.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct StationDetailDto {
    /// When this was so, RFC 3339.
    pub now: String,
    /// The station as lists have it.
    #[serde(flatten)]
    pub station: StationDto,
    /// Whether it has a work cell, at which order lines are picked.
    pub has_cell: bool,
    /// Where picked pieces are put.
    pub totes: Vec<ToteDto>,
    /// The robot arm beside the picker.
    pub arm: Option<ArmDto>,
    /// The rack that stands there to be picked from; null if none does.
    pub visit: Option<VisitDto>,
    /// How well the ends of visits were expected.
    pub ends: EndsHeldDto,
    /// The line that was not confirmed when its rack left at the last grasp; null if there is none.
    pub unconfirmed: Option<UnconfirmedDto>,
    /// What the person there was warned of a moment ago.
    pub warnings: Vec<CellWarningDto>,
    /// Whether hands were seen there within the last 10 s, of one person alone. If not, only buttons and scanners
    /// confirm lines.
    pub hands_seen: bool,
    /// Where hands that are on their way go, most likely; places below a probability of 0.05 are left out.
    pub reach: Vec<SeenReachDto>,
    /// The rack that comes next; null if none is on its way.
    pub next: Option<NextRackDto>,
}

/// A line whose rack has left while a piece was on its way to the tote.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct UnconfirmedDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The line. `POST /v1/stations/{id}/last` says what became of it.
    pub line: LineDto,
}

/// How a hand is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrongReachDto {
    /// It goes to a slot that is not lit.
    WrongSlot,
    /// It put a piece into a tote that is not lit.
    WrongTote,
}

/// A hand is wrong, or about to be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct CellWarningDto {
    /// How.
    pub kind: WrongReachDto,
    /// The slot to which it goes, if that is wrong.
    #[schema(example = "C3")]
    pub slot: Option<String>,
    /// The tote into which it put a piece, if that is wrong.
    #[schema(example = "B")]
    pub tote: Option<String>,
}

/// A person's hand.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PickHandDto {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

/// A place to which a hand may be going.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SeenReachDto {
    /// Which hand.
    pub hand: PickHandDto,
    /// The slot, if it is one.
    #[schema(example = "C3")]
    pub slot: Option<String>,
    /// The tote, if it is one.
    #[schema(example = "B")]
    pub tote: Option<String>,
    /// The probability that it goes there.
    #[schema(example = 0.8)]
    pub probability: f64,
}

/// A place for picked pieces, as the picker sees it who looks at the rack.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ToteDto {
    /// Its name.
    #[schema(example = "B")]
    pub id: String,
    /// How far to the right of where the rack stands, metres.
    pub right_m: f64,
    /// How far from where the rack stands, towards the picker, metres.
    pub out_m: f64,
}

/// A robot arm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ArmDto {
    /// What arm it is.
    #[schema(example = "ur10")]
    pub kind: String,
    /// What it does.
    pub state: ArmStateDto,
    /// Why it gets no trajectory, in words; null where nothing is wrong.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// The line that it picks; null if it picks none.
    pub line: Option<ArmLineDto>,
}

/// What a robot arm does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ArmStateDto {
    /// It has not been heard of, or its kind is not known: hands pick all lines.
    Off,
    /// It rests.
    Idle,
    /// It moves or grips.
    Moving,
    /// Its own protective stop holds it.
    Stopped,
    /// It has not moved in the opening for a minute: no rack comes or leaves.
    Stuck,
    /// It gets no trajectory, and hands pick its lines.
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

/// A rack on its way.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NextRackDto {
    /// Which.
    pub rack: Option<String>,
    /// The robot that brings it.
    pub robot: String,
    /// In how many seconds it is planned to be there; null if it waits for something of which nobody knows when it
    /// ends.
    pub in_s: Option<f64>,
}

/// The side of a rack at which it is picked from.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RackFaceDto {
    /// How many columns of slots it has.
    pub columns: u8,
    /// For each row, the lowest first: the middle of its slots above the floor, metres.
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
    /// The robot under it.
    pub robot: String,
    /// When the rack came, RFC 3339; null if that was before the server started.
    pub since: Option<String>,
    /// Where its slots are; null where the map does not say.
    pub face: Option<RackFaceDto>,
    /// What is to be picked, in the order in which it is lit; nothing for a job without lines.
    pub lines: Vec<LineDto>,
    /// Pieces that are still to be picked.
    pub pieces_left: u32,
    /// How long it goes on from now, where the job has lines.
    pub expected_end: Option<ExpectedEndDto>,
    /// How long it takes from now until the last piece is in its tote: longer than the visit if the rack leaves when
    /// the hand is out for the last time.
    pub expected_placed: Option<ExpectedEndDto>,
}

/// How well the ends of visits at a station were expected when they began, since the server started.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct EndsHeldDto {
    /// Visits that were over by then.
    #[schema(example = 40)]
    pub visits: u32,
    /// The share of them that ended between `p10` and `p90`; eight in ten should. Null before the first.
    #[schema(example = 0.8)]
    pub held: Option<f64>,
    /// How far they were off `p50` on average, seconds. Null before the first.
    #[schema(example = 3.1)]
    pub off_s: Option<f64>,
}

impl From<EndsHeld> for EndsHeldDto {
    fn from(EndsHeld { visits, held, off_s }: EndsHeld) -> EndsHeldDto {
        let each = |sum: f64| (visits > 0).then(|| round3(sum / f64::from(visits)));
        EndsHeldDto { visits, held: each(f64::from(held)), off_s: each(off_s) }
    }
}

/// How long a visit goes on from now, by how long lines took before; seconds.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ExpectedEndDto {
    /// One visit in ten ends sooner.
    pub p10: f64,
    /// Half of them do.
    pub p50: f64,
    /// Nine in ten do.
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
    /// What happens at a station.
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
