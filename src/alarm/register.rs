//! The life of an alarm: raised when its cause has lasted, acknowledged by somebody, cleared when the cause is gone.
//!
//! Main types: [`AlarmRegister`], [`Alarm`]. Refuses: to forget an alarm silently (what changes is handed out to be
//! written down), and to keep more than [`MOST_ACTIVE`].

use super::condition::{AlarmCondition, AlarmKey, AlarmSubject};
use super::kind::{AlarmKind, AlarmScope, AlarmSeverity};
use crate::geometry::Spot;
use crate::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// So many alarms are active at most; what is found beyond is left out, the least severe first.
pub const MOST_ACTIVE: usize = 500;
/// Who has taken note of an alarm, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Acknowledgement {
    /// Who.
    pub by: String,
    /// When.
    pub at: Time,
}

/// Something that a person must know, active or past.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    /// Its number, in the order in which alarms were raised.
    pub id: u64,
    /// What it is about.
    pub kind: AlarmKind,
    /// How bad it is, or was at last.
    pub severity: AlarmSeverity,
    /// With what something is wrong.
    pub subject: AlarmSubject,
    /// In words.
    pub text: String,
    /// What to do.
    pub remedy: String,
    /// Where.
    pub at: Option<Spot>,
    /// How many robots wait because of it.
    pub waiting: usize,
    /// Since when its cause has been there.
    pub since: Time,
    /// Who has taken note.
    pub acknowledged: Option<Acknowledgement>,
    /// When it ended.
    pub cleared: Option<Time>,
}

/// Which alarms to list, newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AlarmQuery {
    /// Only those that were still active at this time.
    pub from: Option<Time>,
    /// Only those that began before.
    pub to: Option<Time>,
    /// Only those with a lower number.
    pub before: Option<u64>,
    /// How many at most.
    pub limit: u32,
}

/// An active alarm.
#[derive(Clone, Debug)]
struct ActiveAlarm {
    alarm: Alarm,
    /// When its cause was found last.
    found: Time,
    /// It was restored, and may not be found again before this.
    settles: Time,
}

/// A cause that has not lasted for long enough.
#[derive(Clone, Copy, Debug)]
struct PendingCause {
    since: Time,
    found: Time,
}

/// All alarms that are active.
#[derive(Clone, Debug, Default)]
pub struct AlarmRegister {
    last: u64,
    active: BTreeMap<AlarmKey, ActiveAlarm>,
    pending: BTreeMap<AlarmKey, PendingCause>,
    changed: BTreeMap<u64, Alarm>,
}

impl AlarmRegister {
    /// Goes on with what was active when an earlier run ended. Alarms of the server's parts ended with it.
    pub fn restore(&mut self, last: u64, active: Vec<Alarm>, now: Time) {
        self.last = self.last.max(last);
        for alarm in active {
            self.last = self.last.max(alarm.id);
            let key = AlarmKey::of(&alarm);
            if alarm.kind.scope() == AlarmScope::Server || self.active.contains_key(&key) {
                self.change(Alarm { cleared: Some(now), ..alarm });
                continue;
            }
            let settles = now + alarm.kind.settles_after();
            self.active.insert(key, ActiveAlarm { alarm, found: now, settles });
        }
    }

    /// Takes in everything of a scope that is wrong now. Gives the alarms that are new.
    pub fn observe(&mut self, scope: AlarmScope, found: Vec<AlarmCondition>, now: Time) -> Vec<Alarm> {
        let mut found = found;
        // Where there are too many, the worst have room.
        found.sort_by_key(|c| std::cmp::Reverse(c.severity));
        let keys: BTreeSet<AlarmKey> = found.iter().map(AlarmCondition::key).collect();
        let mut new = Vec::new();
        for condition in found {
            debug_assert_eq!(condition.kind.scope(), scope, "{condition:?}");
            let key = condition.key();
            if self.active.contains_key(&key) {
                self.find_again(&key, condition, now);
                continue;
            }
            let pending = self.pending.entry(key.clone()).or_insert(PendingCause { since: now, found: now });
            pending.found = now;
            if now - pending.since >= condition.kind.raised_after() && self.active.len() < MOST_ACTIVE {
                let since = condition.since.unwrap_or(pending.since);
                self.pending.remove(&key);
                new.push(self.begin(key, condition, since, now));
            }
        }
        self.pending.retain(|key, p| {
            key.kind.scope() != scope || keys.contains(key) || now - p.found <= key.kind.cleared_after()
        });
        let is_over = |(key, a): (&AlarmKey, &ActiveAlarm)| {
            let absent = key.kind.scope() == scope && !keys.contains(key);
            absent && now >= a.settles && now - a.found >= key.kind.cleared_after()
        };
        let over: Vec<AlarmKey> =
            self.active.iter().filter(|(k, a)| is_over((k, a))).map(|(k, _)| k.clone()).collect();
        over.iter().for_each(|key| self.end(key, now));
        new
    }

    /// Raises an alarm of a part of the server at once, or gives an active one its new text. The alarm, if it is new.
    pub fn raise(&mut self, condition: AlarmCondition, now: Time) -> Option<Alarm> {
        let key = condition.key();
        if self.active.contains_key(&key) {
            self.find_again(&key, condition, now);
            return None;
        }
        let since = condition.since.unwrap_or(now);
        Some(self.begin(key, condition, since, now))
    }

    /// Ends all alarms of a kind. Whether there was one.
    pub fn clear(&mut self, kind: AlarmKind, now: Time) -> bool {
        let of_kind: Vec<AlarmKey> = self.active.keys().filter(|k| k.kind == kind).cloned().collect();
        of_kind.iter().for_each(|key| self.end(key, now));
        !of_kind.is_empty()
    }

    /// Somebody takes note of an active alarm; who did first, did. Nothing where none of this number is active.
    pub fn acknowledge(&mut self, id: u64, by: &str, now: Time) -> Option<Alarm> {
        let one = self.active.values_mut().find(|a| a.alarm.id == id)?;
        let changed = one.alarm.acknowledged.is_none();
        one.alarm.acknowledged.get_or_insert_with(|| Acknowledgement { by: by.to_owned(), at: now });
        let alarm = one.alarm.clone();
        if changed {
            self.change(alarm.clone());
        }
        Some(alarm)
    }

    /// All that are active: the worst first, of these the newest.
    pub fn active(&self) -> Vec<Alarm> {
        let mut all: Vec<Alarm> = self.active.values().map(|a| a.alarm.clone()).collect();
        all.sort_by_key(|a| std::cmp::Reverse((a.severity, a.id)));
        all
    }

    /// What has changed since this was asked last, to be written down.
    pub fn take_changes(&mut self) -> Vec<Alarm> {
        std::mem::take(&mut self.changed).into_values().collect()
    }

    /// What could not be written down is handed out again, unless it has changed since.
    pub fn put_back(&mut self, alarms: Vec<Alarm>) {
        for alarm in alarms {
            self.changed.entry(alarm.id).or_insert(alarm);
        }
        // While the database refuses for long, the oldest are given up.
        while self.changed.len() > 2 * MOST_ACTIVE {
            self.changed.pop_first();
        }
    }

    fn find_again(&mut self, key: &AlarmKey, condition: AlarmCondition, now: Time) {
        let one = self.active.get_mut(key).expect("the caller looked");
        (one.found, one.settles) = (now, Time(one.settles.0.min(now.0)));
        let worse = condition.severity > one.alarm.severity;
        let AlarmCondition { severity, subject, text, remedy, at, waiting, .. } = condition;
        // The worst that it was stays: an alarm that goes up and down would call people again and again.
        let severity = severity.max(one.alarm.severity);
        one.alarm = Alarm { severity, subject, text, remedy, at, waiting, ..one.alarm.clone() };
        if worse {
            // What somebody took note of was less.
            one.alarm.acknowledged = None;
            let alarm = one.alarm.clone();
            self.change(alarm);
        }
    }

    fn begin(&mut self, key: AlarmKey, condition: AlarmCondition, since: Time, now: Time) -> Alarm {
        self.last += 1;
        let AlarmCondition { kind, subject, severity, text, remedy, at, waiting, .. } = condition;
        let (id, acknowledged, cleared) = (self.last, None, None);
        let alarm =
            Alarm { id, kind, severity, subject, text, remedy, at, waiting, since, acknowledged, cleared };
        self.active.insert(key, ActiveAlarm { alarm: alarm.clone(), found: now, settles: now });
        self.change(alarm.clone());
        alarm
    }

    fn end(&mut self, key: &AlarmKey, now: Time) {
        let Some(one) = self.active.remove(key) else { return };
        self.change(Alarm { cleared: Some(now), ..one.alarm });
    }

    fn change(&mut self, alarm: Alarm) {
        self.changed.insert(alarm.id, alarm);
    }
}

impl AlarmKey {
    fn of(alarm: &Alarm) -> AlarmKey {
        let subject = (!alarm.kind.is_collective()).then(|| alarm.subject.clone());
        AlarmKey { kind: alarm.kind, subject }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alarm::SubjectKind;

    fn at(s: i64) -> Time {
        Time(s * 1_000_000)
    }

    fn lost(waiting: usize) -> AlarmCondition {
        let subject = AlarmSubject::new(SubjectKind::Worker, "w7");
        let one = AlarmCondition::new(
            AlarmKind::WorkerLost,
            subject,
            format!("ana is lost: {waiting} robots wait."),
        );
        let severity = if waiting > 0 { AlarmSeverity::Critical } else { AlarmSeverity::Warning };
        AlarmCondition { waiting, severity, ..one }
    }

    fn silent(robot: &str) -> AlarmCondition {
        let subject = AlarmSubject::new(SubjectKind::Robot, robot);
        AlarmCondition::new(AlarmKind::RobotSilent, subject, format!("{robot} sends no reports."))
    }

    #[test]
    fn a_cause_that_lasts_is_raised_once_and_cleared_when_it_has_been_gone_for_a_while() {
        let mut register = AlarmRegister::default();
        let mut look = |s: i64, there: bool| {
            let found = there.then(|| silent("robot-1")).into_iter().collect();
            register.observe(AlarmScope::Watch, found, at(s));
            register.active().len()
        };
        let raised = AlarmKind::RobotSilent.raised_after().0 / 1_000_000;
        let cleared = AlarmKind::RobotSilent.cleared_after().0 / 1_000_000;
        assert_eq!(look(0, true), 0, "it may be gone in a moment");
        assert_eq!(look(raised - 1, true), 0);
        assert_eq!(look(raised, true), 1);
        assert_eq!(look(raised + 1, false), 1, "it may come back in a moment");
        assert_eq!(look(raised + 2, true), 1);
        assert_eq!(look(raised + 2 + cleared, false), 0);
        let changes = register.take_changes();
        assert!(changes.len() == 1 && changes[0].cleared.is_some(), "one alarm, not two: {changes:?}");
        assert_eq!(changes[0].since, at(0), "it began when it was first found");
    }

    #[test]
    fn an_acknowledgement_is_kept_until_the_alarm_gets_worse() {
        let mut register = AlarmRegister::default();
        let id = register.observe(AlarmScope::Watch, vec![lost(0)], at(0))[0].id;
        let noted = register.acknowledge(id, "ben", at(1)).expect("it is active");
        assert_eq!(noted.acknowledged, Some(Acknowledgement { by: "ben".into(), at: at(1) }));
        let again = register.acknowledge(id, "eve", at(2)).expect("it is active");
        assert_eq!(again.acknowledged.expect("by ben").by, "ben", "who did first, did");
        register.observe(AlarmScope::Watch, vec![lost(0)], at(3));
        assert!(register.active()[0].acknowledged.is_some());
        register.observe(AlarmScope::Watch, vec![lost(14)], at(4));
        let worse = register.active().remove(0);
        assert_eq!((worse.id, worse.severity, worse.acknowledged), (id, AlarmSeverity::Critical, None));
        assert!(worse.text.contains("14 robots"), "{}", worse.text);
        assert_eq!(register.acknowledge(id + 1, "ben", at(5)), None, "there is none of this number");
    }

    #[test]
    fn an_alarm_outlasts_a_restart_with_its_number_and_its_acknowledgement_and_ends_if_not_found_again() {
        let mut before = AlarmRegister::default();
        let id = before.observe(AlarmScope::Watch, vec![lost(3)], at(0))[0].id;
        before.acknowledge(id, "ben", at(1));
        before.raise(AlarmCondition::of_server(AlarmKind::Journal, "the journal is slow."), at(1));
        let active = before.active();
        let mut after = AlarmRegister::default();
        after.restore(17, active, at(100));
        let only = after.active();
        assert_eq!(only.len(), 1, "that of the journal ended with the process: {only:?}");
        assert_eq!((only[0].id, only[0].since), (id, at(0)));
        assert_eq!(only[0].acknowledged.as_ref().expect("kept").by, "ben");
        after.observe(AlarmScope::Watch, vec![], at(110));
        assert_eq!(after.active().len(), 1, "nobody has been looked for yet");
        let new = after.observe(AlarmScope::Watch, vec![lost(3), silent("robot-1")], at(120));
        assert!(new.is_empty() && after.active().len() == 1);
        after.observe(AlarmScope::Watch, vec![], at(130));
        assert!(after.active().is_empty(), "found again and gone");
        let raised = after.raise(AlarmCondition::of_server(AlarmKind::Journal, "slow again."), at(140));
        assert_eq!(raised.expect("new").id, 18, "numbers go on");
    }

    #[test]
    fn one_scope_does_not_end_what_another_one_found() {
        let mut register = AlarmRegister::default();
        register.raise(AlarmCondition::of_server(AlarmKind::Journal, "the journal is slow."), at(0));
        register.observe(AlarmScope::Watch, vec![], at(100));
        register.observe(AlarmScope::Operator, vec![], at(100));
        assert_eq!(register.active().len(), 1);
        assert!(register.clear(AlarmKind::Journal, at(101)) && !register.clear(AlarmKind::Journal, at(102)));
    }

    #[test]
    fn there_are_never_more_than_so_many_and_the_worst_have_room() {
        let mut register = AlarmRegister::default();
        let mut found: Vec<AlarmCondition> =
            (0..2 * MOST_ACTIVE).map(|i| silent(&format!("robot-{i}"))).collect();
        found.push(lost(3));
        register.observe(AlarmScope::Watch, found.clone(), at(0));
        register.observe(AlarmScope::Watch, found, at(60));
        let active = register.active();
        assert_eq!(active.len(), MOST_ACTIVE);
        assert_eq!(active[0].kind, AlarmKind::WorkerLost, "the worst is first");
    }

    #[test]
    fn what_could_not_be_written_is_handed_out_again_unless_it_changed() {
        let mut register = AlarmRegister::default();
        let id = register.observe(AlarmScope::Watch, vec![lost(0)], at(0))[0].id;
        let first = register.take_changes();
        register.acknowledge(id, "ben", at(1));
        register.put_back(first);
        let again = register.take_changes();
        assert!(again.len() == 1 && again[0].acknowledged.is_some(), "{again:?}");
        assert!(register.take_changes().is_empty());
    }
}
