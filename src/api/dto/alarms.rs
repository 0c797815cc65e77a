//! Alarms on the wire: in lists, and as rows of the live feed.
//!
//! Main types: [`AlarmDto`], [`AlarmRowDto`]. Refuses: to raise or end an alarm.

use crate::access::acts::AuditAct;
use crate::wire::sentence::{SentenceArgsSchema, SentenceSchema};
use crate::wire::text::{alarm_name, round3, time_text};
use crate::wire::words::{AlarmKindDto, AlarmSeverityDto, AlarmStateDto, SubjectKindDto};
use giveway_fleet::alarm::{
    Acknowledgement, Alarm, AlarmMember, AlarmNote, AlarmSubject, Shelving, SubjectKind,
};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::text::{Sentence, SentenceArgs};
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

/// What an alarm is about.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmSubjectDto {
    /// What sort of thing it is.
    pub kind: SubjectKindDto,
    /// Its id; `floor` and `server` for these two.
    #[schema(example = "robot-3")]
    pub id: String,
}

/// Who has taken note of an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AcknowledgementDto {
    /// Who.
    #[schema(example = "Ben")]
    pub by: String,
    /// When, RFC 3339.
    pub at: String,
}

/// An alarm that was put aside.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ShelvingDto {
    /// Who.
    #[schema(example = "Ben")]
    pub by: String,
    /// When, RFC 3339.
    pub at: String,
    /// Until when, RFC 3339: then it calls again.
    pub until: String,
    /// Why.
    #[schema(example = "the radio is being mended")]
    pub reason: String,
}

/// What somebody wrote down about an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmNoteDto {
    /// Who.
    #[schema(example = "Ben")]
    pub by: String,
    /// When, RFC 3339.
    pub at: String,
    /// What.
    #[schema(example = "the access point has no power; electrician at 15:00")]
    pub text: String,
}

/// One of the alarms in a group.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmMemberDto {
    /// Its number.
    #[schema(example = "al12")]
    pub id: String,
    /// With what something is wrong.
    pub subject: AlarmSubjectDto,
    /// In words.
    pub text: String,
    /// Which sentence `text` is; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// What stands in its places.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// Where on the map, metres; null if it is in no one place.
    pub x: Option<f64>,
    /// Metres.
    pub y: Option<f64>,
    /// Since when its cause has been there, RFC 3339.
    pub since: String,
    /// Who has taken note; null if nobody has.
    pub acknowledged_by: Option<String>,
}

impl From<&AlarmMember> for AlarmMemberDto {
    fn from(m: &AlarmMember) -> AlarmMemberDto {
        let (x, y) = place(m.at).unzip();
        let (code, args, text) = m.text.clone().into_parts();
        AlarmMemberDto {
            id: alarm_name(m.id),
            subject: (&m.subject).into(),
            text,
            code,
            args,
            x,
            y,
            since: time_text(m.since),
            acknowledged_by: m.acknowledged_by.clone(),
        }
    }
}

impl From<&AlarmSubject> for AlarmSubjectDto {
    fn from(subject: &AlarmSubject) -> AlarmSubjectDto {
        AlarmSubjectDto { kind: subject.kind.into(), id: subject.id.clone() }
    }
}

/// Something that a person must know, active or past.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmDto {
    /// Its number; numbers go on after a restart.
    #[schema(example = "al17")]
    pub id: String,
    /// What it is about.
    pub kind: AlarmKindDto,
    /// How bad it is.
    pub severity: AlarmSeverityDto,
    /// Whether its cause is still there.
    pub state: AlarmStateDto,
    /// With what something is wrong.
    pub subject: AlarmSubjectDto,
    /// In words.
    #[schema(example = "robot-3 sends no reports; 2 robots wait for it.")]
    pub text: String,
    /// Which sentence `text` is; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// What stands in its places.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// What to do.
    #[schema(value_type = SentenceSchema)]
    pub remedy: Sentence,
    /// Where on the map, metres; null if it is in no one place.
    pub x: Option<f64>,
    /// Metres.
    pub y: Option<f64>,
    /// How many robots wait because of it.
    pub waiting: usize,
    /// Since when its cause has been there, RFC 3339.
    pub since: String,
    /// Who has taken note; null if nobody has.
    pub acknowledged: Option<AcknowledgementDto>,
    /// Whether somebody has put it aside; null if nobody has.
    pub shelved: Option<ShelvingDto>,
    /// What people wrote down about it, in order.
    pub notes: Vec<AlarmNoteDto>,
    /// What can be done about it in one request, the likeliest first.
    pub acts: Vec<AuditAct>,
    /// The group of which it is a member, or was when it ended; null if there is none.
    #[schema(example = "al18")]
    pub group: Option<String>,
    /// Of an active group: its members. Of one that is over, list `?group=` its id.
    pub members: Vec<AlarmMemberDto>,
    /// When it ended, RFC 3339; null if it is active.
    pub cleared: Option<String>,
}

impl From<&Alarm> for AlarmDto {
    fn from(a: &Alarm) -> AlarmDto {
        let (x, y) = place(a.at).unzip();
        let (code, args, text) = a.text.clone().into_parts();
        let noted = |n: &Acknowledgement| AcknowledgementDto { by: n.by.clone(), at: time_text(n.at) };
        AlarmDto {
            id: alarm_name(a.id),
            kind: AlarmKindDto(a.kind),
            severity: a.severity.into(),
            state: if a.cleared.is_some() { AlarmStateDto::Cleared } else { AlarmStateDto::Active },
            subject: (&a.subject).into(),
            text,
            code,
            args,
            remedy: a.remedy.clone(),
            x,
            y,
            waiting: a.waiting,
            since: time_text(a.since),
            acknowledged: a.acknowledged.as_ref().map(noted),
            shelved: a.shelved.as_ref().map(shelving),
            notes: a.notes.iter().map(note).collect(),
            acts: AuditAct::remedies(a.kind).to_vec(),
            group: a.group.map(alarm_name),
            members: a.members.iter().map(Into::into).collect(),
            cleared: a.cleared.map(time_text),
        }
    }
}

fn shelving(s: &Shelving) -> ShelvingDto {
    ShelvingDto { by: s.by.clone(), at: time_text(s.at), until: time_text(s.until), reason: s.reason.clone() }
}

fn note(n: &AlarmNote) -> AlarmNoteDto {
    AlarmNoteDto { by: n.by.clone(), at: time_text(n.at), text: n.text.clone() }
}

/// A member of a group in the live feed.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmMemberRowDto {
    /// Its number.
    #[schema(example = "al12")]
    pub id: String,
    /// The robot.
    #[schema(example = "robot-3")]
    pub subject: String,
    /// Who has taken note; null if nobody has.
    pub acknowledged_by: Option<String>,
}

/// An active alarm in the live feed; its times count from the feed's zero.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmRowDto {
    /// Its number.
    #[schema(example = "al17")]
    pub id: String,
    /// What it is about.
    pub kind: AlarmKindDto,
    /// How bad it is.
    pub severity: AlarmSeverityDto,
    /// What sort of thing it is about.
    pub subject_kind: SubjectKindDto,
    /// The id of that; null for the floor and the server.
    #[schema(example = "robot-3")]
    pub subject: Option<String>,
    /// In words.
    pub text: String,
    /// Which sentence `text` is; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// What stands in its places.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// What to do.
    #[schema(value_type = SentenceSchema)]
    pub remedy: Sentence,
    /// Where on the map, metres; null if it is in no one place.
    pub x: Option<f64>,
    /// Metres.
    pub y: Option<f64>,
    /// How many robots wait because of it.
    pub waiting: usize,
    /// Since when its cause has been there, seconds.
    pub since_s: f64,
    /// Who has taken note; null if nobody has.
    pub acknowledged_by: Option<String>,
    /// Until when it is put aside, RFC 3339; null if it is not.
    pub shelved_until: Option<String>,
    /// What can be done about it in one request, the likeliest first.
    pub acts: Vec<AuditAct>,
    /// Of a group: its members.
    pub members: Vec<AlarmMemberRowDto>,
}

/// An active alarm in the live feed; its times count from `started_s`.
pub(crate) fn row(alarm: &Alarm, started_s: f64) -> Value {
    let (x, y) = place(alarm.at).unzip();
    let (code, args, text) = alarm.text.clone().into_parts();
    let is_a_thing = !matches!(alarm.subject.kind, SubjectKind::Floor | SubjectKind::Server);
    json!(AlarmRowDto {
        id: alarm_name(alarm.id),
        kind: AlarmKindDto(alarm.kind),
        severity: alarm.severity.into(),
        subject_kind: alarm.subject.kind.into(),
        subject: is_a_thing.then(|| alarm.subject.id.clone()),
        text,
        code,
        args,
        remedy: alarm.remedy.clone(),
        x,
        y,
        waiting: alarm.waiting,
        since_s: round3(alarm.since.as_secs_f64() - started_s),
        acknowledged_by: alarm.acknowledged.as_ref().map(|n| n.by.clone()),
        shelved_until: alarm.shelved.as_ref().map(|s| time_text(s.until)),
        acts: AuditAct::remedies(alarm.kind).to_vec(),
        members: alarm.members.iter().map(member_row).collect(),
    })
}

fn member_row(member: &AlarmMember) -> AlarmMemberRowDto {
    let AlarmMember { id, subject, acknowledged_by, .. } = member.clone();
    AlarmMemberRowDto { id: alarm_name(id), subject: subject.id, acknowledged_by }
}

fn place(at: Option<Spot>) -> Option<(f64, f64)> {
    at.map(Point::from).map(|p| (round3(p.x), round3(p.y)))
}
