//! What is wrong at a moment: the cause of an alarm, before it is known how long it lasts.
//!
//! Main types: [`AlarmCondition`], [`AlarmSubject`]. Subjects go by the names that people use, so that an alarm
//! outlasts a restart, and even the robot that it was about. Refuses: to decide whether a condition becomes an alarm.

use super::kind::{AlarmKind, AlarmSeverity};
use giveway_floor::geometry::Spot;
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::Time;

/// What sort of thing an alarm is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SubjectKind {
    /// A robot, by name.
    Robot,
    /// A worker: w1, w2, …
    Worker,
    /// A job: j1, j2, …
    Job,
    /// A station, by name.
    Station,
    /// A closed area: c1, c2, …
    Closure,
    /// The whole floor.
    Floor,
    /// The server.
    Server,
}

impl SubjectKind {
    /// All sorts of subjects.
    pub const ALL: [SubjectKind; 7] = [
        SubjectKind::Robot,
        SubjectKind::Worker,
        SubjectKind::Job,
        SubjectKind::Station,
        SubjectKind::Closure,
        SubjectKind::Floor,
        SubjectKind::Server,
    ];

    /// The word for the sort on the wire.
    pub fn word(self) -> &'static str {
        match self {
            SubjectKind::Robot => "robot",
            SubjectKind::Worker => "worker",
            SubjectKind::Job => "job",
            SubjectKind::Station => "station",
            SubjectKind::Closure => "closure",
            SubjectKind::Floor => "floor",
            SubjectKind::Server => "server",
        }
    }

    /// The sort of this word.
    pub fn of_word(word: &str) -> Option<SubjectKind> {
        SubjectKind::ALL.into_iter().find(|s| s.word() == word)
    }
}

/// What an alarm is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AlarmSubject {
    /// The sort of the subject.
    pub kind: SubjectKind,
    /// The name of the subject; for the floor and the server, the word for the sort.
    pub id: String,
}

impl AlarmSubject {
    /// The subject of this sort and name.
    pub fn new(kind: SubjectKind, id: impl Into<String>) -> AlarmSubject {
        AlarmSubject { kind, id: id.into() }
    }

    /// The whole floor.
    pub fn floor() -> AlarmSubject {
        AlarmSubject::new(SubjectKind::Floor, SubjectKind::Floor.word())
    }

    /// The server.
    pub fn server() -> AlarmSubject {
        AlarmSubject::new(SubjectKind::Server, SubjectKind::Server.word())
    }
}

/// What is wrong at a moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmCondition {
    /// The kind of the condition.
    pub kind: AlarmKind,
    /// The subject with which something is wrong.
    pub subject: AlarmSubject,
    /// How bad the condition is.
    pub severity: AlarmSeverity,
    /// The condition in words; how long it has lasted is not part of them.
    pub text: Sentence,
    /// What to do about the condition.
    pub remedy: Sentence,
    /// Where the condition is, if it is in one place.
    pub at: Option<Spot>,
    /// How many robots wait because of the condition.
    pub waiting: usize,
    /// Since when the condition has held, if that is known better than by when it was found.
    pub since: Option<Time>,
}

impl AlarmCondition {
    /// A condition of this kind, with the severity and the remedy of the kind.
    pub fn new(kind: AlarmKind, subject: AlarmSubject, text: Sentence) -> AlarmCondition {
        let (severity, remedy) = (kind.severity(), kind.remedy());
        AlarmCondition { kind, subject, severity, text, remedy, at: None, waiting: 0, since: None }
    }

    /// A condition about the server.
    pub fn of_server(kind: AlarmKind, text: Sentence) -> AlarmCondition {
        AlarmCondition::new(kind, AlarmSubject::server(), text)
    }

    /// This condition, in a place.
    pub fn at(self, at: impl Into<Spot>) -> AlarmCondition {
        AlarmCondition { at: Some(at.into()), ..self }
    }

    /// This condition, at least this bad.
    pub(super) fn at_least(self, severity: AlarmSeverity) -> AlarmCondition {
        AlarmCondition { severity: self.severity.max(severity), ..self }
    }

    /// The key by which the condition is the same as one that was found before.
    pub(super) fn key(&self) -> AlarmKey {
        let subject = (!self.kind.is_collective()).then(|| self.subject.clone());
        AlarmKey { kind: self.kind, subject }
    }
}

/// What makes two conditions the same: the kind, and the subject if there is an alarm for each subject.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct AlarmKey {
    pub kind: AlarmKind,
    pub subject: Option<AlarmSubject>,
}

impl AlarmKey {
    /// Whether the key is that of a group: the alarms of single robots of its kind are its members.
    pub fn is_group(&self) -> bool {
        let is_floor = self.subject.as_ref().is_some_and(|s| s.kind == SubjectKind::Floor);
        self.kind.is_about_a_robot() && is_floor
    }
}

/// The first three of some names or other things, and how many more there are.
pub(super) fn some_of<T: Clone + Into<SentenceArg>>(names: &[T]) -> SentenceArg {
    let shown = names[..names.len().min(3)].to_vec();
    match names.len().saturating_sub(3) {
        0 => shown.into(),
        more => alarms::and_more(shown, more).into(),
    }
}
