//! The alarms of a running server, which its parts raise and the API shows.
//!
//! Main type: [`Alarms`]. Every new alarm is logged here, once. Refuses: to detect what is wrong, and to store
//! anything: it hands out what changed.

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
    /// Continues with the alarms that were active when an earlier run ended.
    pub fn restore(&self, last: u64, active: Vec<Alarm>, now: Time) {
        self.register().restore(last, active, now);
        self.changed.notify_one();
    }

    /// Raises an alarm about a part of the server, or updates the text of an active one. True if the alarm is new.
    pub fn raise(&self, kind: AlarmKind, text: Sentence, now: Time) -> bool {
        let new = self.register().raise(AlarmCondition::of_server(kind, text), now);
        self.tell(new.as_slice());
        new.is_some()
    }

    /// Ends the alarms of a kind. True if there was one.
    pub fn clear(&self, kind: AlarmKind, now: Time) -> bool {
        let ended = self.register().clear(kind, now);
        if ended {
            self.changed.notify_one();
        }
        ended
    }

    /// Updates the alarms that the watch over fleet and loop raises with everything that is wrong now.
    pub fn observe(&self, found: Vec<AlarmCondition>, now: Time) {
        let new = self.register().observe(AlarmScope::Watch, found, now);
        self.tell(&new);
    }

    /// Updates the alarms about what operators have stopped, from a view.
    pub fn note(&self, view: &View) {
        let new = self.register().observe(AlarmScope::Operator, operator_conditions(view), view.now);
        self.tell(&new);
    }

    /// Acknowledges an active alarm in a person's name; nothing if no alarm of this number is active.
    pub fn acknowledge(&self, id: u64, by: &str, now: Time) -> Option<Alarm> {
        let alarm = self.register().acknowledge(id, by, now);
        self.changed.notify_one();
        alarm
    }

    /// Shelves an active alarm in a person's name.
    ///
    /// # Errors
    /// If the alarm is not active, must not be shelved, or too many alarms are shelved.
    pub fn shelve(&self, id: u64, shelving: Shelving) -> Result<Alarm, CareRefusal> {
        let alarm = self.register().shelve(id, shelving);
        self.changed.notify_one();
        alarm
    }

    /// Unshelves an active alarm; nothing if no alarm of this number is active.
    pub fn unshelve(&self, id: u64) -> Option<Alarm> {
        let alarm = self.register().unshelve(id);
        self.changed.notify_one();
        alarm
    }

    /// Adds a person's note to an active alarm.
    ///
    /// # Errors
    /// If the alarm is not active, or has too many notes.
    pub fn write_note(&self, id: u64, note: AlarmNote) -> Result<Alarm, CareRefusal> {
        let alarm = self.register().write_note(id, note);
        self.changed.notify_one();
        alarm
    }

    /// The active alarm of this number, even if it is a member of a group.
    pub fn find(&self, id: u64) -> Option<Alarm> {
        self.register().find(id)
    }

    /// All active alarms, the worst first. Members are in their groups.
    pub fn list(&self) -> Vec<Alarm> {
        self.register().active()
    }

    /// Active alarms about this subject, even if they are members of a group.
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

    /// The alarms that have changed and must be stored.
    pub fn take_changes(&self) -> Vec<Alarm> {
        self.register().take_changes()
    }

    /// Returns changed alarms that could not be stored.
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
        // Even if no alarm is new: some may have ended.
        self.changed.notify_one();
    }
}
