//! The alarms of a running server, which its parts raise and the API shows.
//!
//! Main type: [`Alarms`]. Every alarm that is new is logged here, once. Refuses: to find out what is wrong, and to
//! write anything down: it hands out what changed.

use giveway_fleet::View;
use giveway_fleet::alarm::{
    Alarm, AlarmCondition, AlarmKind, AlarmNote, AlarmRegister, AlarmScope, AlarmSeverity, AlarmSubject,
    CareRefusal, Shelving, operator_conditions,
};
use giveway_floor::text::Sentence;
use giveway_floor::time::Time;
use std::sync::{Mutex, MutexGuard};
use tokio::sync::Notify;

/// The alarms of a server.
#[derive(Debug, Default)]
pub struct Alarms {
    register: Mutex<AlarmRegister>,
    changed: Notify,
}

impl Alarms {
    /// Goes on with what was active when an earlier run ended.
    pub fn restore(&self, last: u64, active: Vec<Alarm>, now: Time) {
        self.register().restore(last, active, now);
        self.changed.notify_one();
    }

    /// Raises an alarm of a part of the server, or gives an active one a new text. Whether it is new.
    pub fn raise(&self, kind: AlarmKind, text: Sentence, now: Time) -> bool {
        let new = self.register().raise(AlarmCondition::of_server(kind, text), now);
        self.tell(new.as_slice());
        new.is_some()
    }

    /// Ends the alarms of a kind. Whether there was one.
    pub fn clear(&self, kind: AlarmKind, now: Time) -> bool {
        let ended = self.register().clear(kind, now);
        if ended {
            self.changed.notify_one();
        }
        ended
    }

    /// Takes in everything that the watch over fleet and loop finds wrong now.
    pub fn observe(&self, found: Vec<AlarmCondition>, now: Time) {
        let new = self.register().observe(AlarmScope::Watch, found, now);
        self.tell(&new);
    }

    /// Takes in what a person stopped, by a view.
    pub fn note(&self, view: &View) {
        let new = self.register().observe(AlarmScope::Operator, operator_conditions(view), view.now);
        self.tell(&new);
    }

    /// Somebody takes note of an active alarm. Nothing where none of this number is active.
    pub fn acknowledge(&self, id: u64, by: &str, now: Time) -> Option<Alarm> {
        let alarm = self.register().acknowledge(id, by, now);
        self.changed.notify_one();
        alarm
    }

    /// Somebody puts an active alarm aside.
    ///
    /// # Errors
    /// Where it is not active, must always call, or too many are put aside.
    pub fn shelve(&self, id: u64, shelving: Shelving) -> Result<Alarm, CareRefusal> {
        let alarm = self.register().shelve(id, shelving);
        self.changed.notify_one();
        alarm
    }

    /// Somebody takes an active alarm back up. Nothing where none of this number is active.
    pub fn unshelve(&self, id: u64) -> Option<Alarm> {
        let alarm = self.register().unshelve(id);
        self.changed.notify_one();
        alarm
    }

    /// Somebody writes a note about an active alarm.
    ///
    /// # Errors
    /// Where it is not active, or has too many.
    pub fn write_note(&self, id: u64, note: AlarmNote) -> Result<Alarm, CareRefusal> {
        let alarm = self.register().write_note(id, note);
        self.changed.notify_one();
        alarm
    }

    /// The active alarm of this number, also where it is a member of a group.
    pub fn find(&self, id: u64) -> Option<Alarm> {
        self.register().find(id)
    }

    /// All that are active, the worst first. Members are in their groups.
    pub fn list(&self) -> Vec<Alarm> {
        self.register().active()
    }

    /// Active alarms about this, also where they are members of a group.
    pub fn about(&self, subject: &AlarmSubject) -> Vec<Alarm> {
        self.register().about(subject)
    }

    /// The active alarm of a kind, if there is one.
    pub fn of_kind(&self, kind: AlarmKind) -> Option<Alarm> {
        self.list().into_iter().find(|alarm| alarm.kind == kind)
    }

    /// Waits until something may have changed.
    pub async fn changed(&self) {
        self.changed.notified().await;
    }

    /// What has changed, to be written down.
    pub fn take_changes(&self) -> Vec<Alarm> {
        self.register().take_changes()
    }

    /// What could not be written down.
    pub fn put_back(&self, alarms: Vec<Alarm>) {
        self.register().put_back(alarms);
    }

    fn register(&self) -> MutexGuard<'_, AlarmRegister> {
        self.register.lock().expect("nobody panics with this lock")
    }

    fn tell(&self, new: &[Alarm]) {
        for alarm in new {
            let (kind, subject) = (alarm.kind.word(), alarm.subject.id.as_str());
            match alarm.severity {
                AlarmSeverity::Notice => tracing::info!(kind, subject, "{}", alarm.text),
                AlarmSeverity::Warning => tracing::warn!(kind, subject, "{}", alarm.text),
                AlarmSeverity::Critical => tracing::error!(kind, subject, "{}", alarm.text),
            }
        }
        // Also where none is new: some may have ended.
        self.changed.notify_one();
    }
}
