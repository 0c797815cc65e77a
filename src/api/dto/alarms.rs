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

/// The thing that an alarm is about.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmSubjectDto {
    /// The sort of thing.
    pub kind: SubjectKindDto,
    /// The thing's id; `floor` and `server` for these two.
    #[schema(example = "robot-3")]
    pub id: String,
}

/// An acknowledgement of an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AcknowledgementDto {
    /// The person who acknowledged the alarm.
    #[schema(example = "Ben")]
    pub by: String,
    /// When the alarm was acknowledged, RFC 3339.
    pub at: String,
}

/// The shelving of an alarm: somebody put it aside for a while.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ShelvingDto {
    /// The person who shelved the alarm.
    #[schema(example = "Ben")]
    pub by: String,
    /// When the alarm was shelved, RFC 3339.
    pub at: String,
    /// When the shelving ends and the alarm calls for attention again, RFC 3339.
    pub until: String,
    /// Why the alarm was shelved.
    #[schema(example = "the radio is being mended")]
    pub reason: String,
}

/// A note that a person wrote about an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmNoteDto {
    /// The author of the note.
    #[schema(example = "Ben")]
    pub by: String,
    /// When the note was written, RFC 3339.
    pub at: String,
    /// The text of the note.
    #[schema(example = "the access point has no power; electrician at 15:00")]
    pub text: String,
}

/// An alarm that is a member of a group.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmMemberDto {
    /// The alarm's number.
    #[schema(example = "al12")]
    pub id: String,
    /// The thing that the alarm is about.
    pub subject: AlarmSubjectDto,
    /// The alarm in words, in English.
    pub text: String,
    /// The code of the sentence in `text`; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// The alarm's place on the map, x in metres; null if it has no single place.
    pub x: Option<f64>,
    /// The alarm's place on the map, y in metres; null if it has no single place.
    pub y: Option<f64>,
    /// Since when the cause has been present, RFC 3339.
    pub since: String,
    /// The person who acknowledged the alarm; null if nobody has.
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

/// A condition that a person must know of, active or past.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmDto {
    /// The alarm's number; numbers continue after a restart.
    #[schema(example = "al17")]
    pub id: String,
    /// The kind of alarm.
    pub kind: AlarmKindDto,
    /// How severe the alarm is.
    pub severity: AlarmSeverityDto,
    /// Whether the cause of the alarm is still present.
    pub state: AlarmStateDto,
    /// The thing that the alarm is about.
    pub subject: AlarmSubjectDto,
    /// The alarm in words, in English.
    #[schema(example = "robot-3 sends no reports; 2 robots wait for it.")]
    pub text: String,
    /// The code of the sentence in `text`; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// What a person should do about the alarm.
    #[schema(value_type = SentenceSchema)]
    pub remedy: Sentence,
    /// The alarm's place on the map, x in metres; null if it has no single place.
    pub x: Option<f64>,
    /// The alarm's place on the map, y in metres; null if it has no single place.
    pub y: Option<f64>,
    /// How many robots wait because of the alarm's cause.
    pub waiting: usize,
    /// Since when the cause has been present, RFC 3339.
    pub since: String,
    /// The acknowledgement of the alarm; null if nobody has acknowledged it.
    pub acknowledged: Option<AcknowledgementDto>,
    /// The shelving of the alarm; null if it is not shelved.
    pub shelved: Option<ShelvingDto>,
    /// Notes that people wrote about the alarm, in order.
    pub notes: Vec<AlarmNoteDto>,
    /// Requests that can remedy the alarm, the likeliest first.
    pub acts: Vec<AuditAct>,
    /// The group that has this alarm as a member, or had when the alarm ended; null if there is none.
    #[schema(example = "al18")]
    pub group: Option<String>,
    /// For an active group: its members. For a group that is over, list `?group=` its id.
    pub members: Vec<AlarmMemberDto>,
    /// When the alarm ended, RFC 3339; null if it is active.
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
    /// The alarm's number.
    #[schema(example = "al12")]
    pub id: String,
    /// The robot that the alarm is about.
    #[schema(example = "robot-3")]
    pub subject: String,
    /// The person who acknowledged the alarm; null if nobody has.
    pub acknowledged_by: Option<String>,
}

/// An active alarm in the live feed; its times count from the feed's zero.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmRowDto {
    /// The alarm's number.
    #[schema(example = "al17")]
    pub id: String,
    /// The kind of alarm.
    pub kind: AlarmKindDto,
    /// How severe the alarm is.
    pub severity: AlarmSeverityDto,
    /// The sort of thing that the alarm is about.
    pub subject_kind: SubjectKindDto,
    /// The id of the thing that the alarm is about; null for the floor and the server.
    #[schema(example = "robot-3")]
    pub subject: Option<String>,
    /// The alarm in words, in English.
    pub text: String,
    /// The code of the sentence in `text`; null for alarms of versions that had no codes.
    #[schema(value_type = Option<String>, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence.
    #[schema(value_type = SentenceArgsSchema)]
    pub args: SentenceArgs,
    /// What a person should do about the alarm.
    #[schema(value_type = SentenceSchema)]
    pub remedy: Sentence,
    /// The alarm's place on the map, x in metres; null if it has no single place.
    pub x: Option<f64>,
    /// The alarm's place on the map, y in metres; null if it has no single place.
    pub y: Option<f64>,
    /// How many robots wait because of the alarm's cause.
    pub waiting: usize,
    /// Since when the cause has been present, seconds from the feed's zero.
    pub since_s: f64,
    /// The person who acknowledged the alarm; null if nobody has.
    pub acknowledged_by: Option<String>,
    /// When the shelving ends, RFC 3339; null if the alarm is not shelved.
    pub shelved_until: Option<String>,
    /// Requests that can remedy the alarm, the likeliest first.
    pub acts: Vec<AuditAct>,
    /// For a group: its members.
    pub members: Vec<AlarmMemberRowDto>,
}

/// An active alarm as a row of the live feed; its times count from `started_s`.
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
