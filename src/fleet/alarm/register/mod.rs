//! The life of an alarm: raised when its cause has lasted, acknowledged by a person, cleared when the cause is gone.
//!
//! Main types: [`AlarmRegister`], [`Alarm`]. Refuses: to forget an alarm silently (changes are handed out to be
//! stored), and to keep more than [`MOST_ACTIVE`].

use super::care::{Acknowledgement, AlarmNote, CareRefusal, MOST_NOTES, MOST_SHELVED, Shelving};
use super::condition::{AlarmCondition, AlarmKey, AlarmSubject};
use super::groups::AlarmMember;
use super::kind::{AlarmKind, AlarmScope, AlarmSeverity};
use giveway_floor::geometry::Spot;
use giveway_floor::text::Sentence;
use giveway_floor::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// How many alarms are active at most; causes found beyond that are left out, the least severe first.
pub const MOST_ACTIVE: usize = 500;

/// Something that a person must know, active or past.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    /// The number of the alarm, in the order in which alarms were raised.
    pub id: u64,
    /// The kind of the alarm.
    pub kind: AlarmKind,
    /// How bad the alarm is, or was last.
    pub severity: AlarmSeverity,
    /// The subject with which something is wrong.
    pub subject: AlarmSubject,
    /// The alarm in words.
    pub text: Sentence,
    /// What to do about the alarm.
    pub remedy: Sentence,
    /// Where the cause is, if it is in one place.
    pub at: Option<Spot>,
    /// How many robots wait because of the cause.
    pub waiting: usize,
    /// Since when the cause has been there.
    pub since: Time,
    /// Who has acknowledged the alarm, and when.
    pub acknowledged: Option<Acknowledgement>,
    /// Who has shelved the alarm, and until when, if it is shelved.
    pub shelved: Option<Shelving>,
    /// What people wrote down about the alarm, in order.
    pub notes: Vec<AlarmNote>,
    /// The number of the group of which the alarm is a member, or was when it ended.
    pub group: Option<u64>,
    /// The members of a group, in order of their numbers. Handed out with active alarms, and stored nowhere.
    pub members: Vec<AlarmMember>,
    /// When the alarm ended.
    pub cleared: Option<Time>,
}

/// Which alarms to list, newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AlarmQuery {
    /// Only alarms that were still active at this time.
    pub from: Option<Time>,
    /// Only alarms that began before this time.
    pub to: Option<Time>,
    /// Only members of this group.
    pub group: Option<u64>,
    /// Only alarms with a lower number.
    pub before: Option<u64>,
    /// How many alarms at most.
    pub limit: u32,
}

/// An active alarm.
#[derive(Clone, Debug)]
struct ActiveAlarm {
    alarm: Alarm,
    /// When the alarm's cause was last found.
    found: Time,
    /// The alarm was restored, and its cause may not be found again before this.
    settles: Time,
    /// How many members a group had when it was acknowledged.
    noted: usize,
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
    shelves: BTreeMap<AlarmKey, Shelving>,
    changed: BTreeMap<u64, Alarm>,
}

impl AlarmRegister {
    /// Goes on with the alarms that were active when an earlier run ended. Alarms of the server's parts ended with that
    /// run. Of alarms that are over, it only counts whether they were shelved.
    pub fn restore(&mut self, last: u64, known: Vec<Alarm>, now: Time) {
        self.last = self.last.max(last);
        for alarm in known {
            self.last = self.last.max(alarm.id);
            let key = AlarmKey::of(&alarm);
            if let Some(shelving) = alarm.shelved.clone().filter(|s| s.until > now) {
                self.shelves.insert(key.clone(), shelving);
            }
            if alarm.cleared.is_some() {
                continue;
            }
            if alarm.kind.scope() == AlarmScope::Server || self.active.contains_key(&key) {
                self.change(Alarm { cleared: Some(now), ..alarm });
                continue;
            }
            let settles = now + alarm.kind.settles_after();
            self.active.insert(key, ActiveAlarm { alarm, found: now, settles, noted: 0 });
        }
        for kind in self.groups() {
            let members = self.members(kind).len();
            self.active.values_mut().filter(|a| a.is_group_of(kind)).for_each(|a| a.noted = members);
        }
        self.join();
    }

    /// Takes in everything of a scope that is wrong now. Returns the new alarms; of a group, the group alone.
    pub fn observe(&mut self, scope: AlarmScope, found: Vec<AlarmCondition>, now: Time) -> Vec<Alarm> {
        self.end_shelving(now);
        let mut found = found;
        // If there are too many conditions, the worst have room.
        found.sort_by_key(|c| std::cmp::Reverse(c.severity));
        let keys: BTreeSet<AlarmKey> = found.iter().map(AlarmCondition::key).collect();
        let mut new = BTreeSet::new();
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
                new.insert(self.begin(key, condition, since, now).id);
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
        self.join();
        let is_told = |a: &&ActiveAlarm| new.contains(&a.alarm.id) && a.alarm.group.is_none();
        self.active.values().filter(is_told).map(|a| a.alarm.clone()).collect()
    }

    /// Raises an alarm of a part of the server at once, or gives an active one its new text. Returns the alarm if it is
    /// new.
    pub fn raise(&mut self, condition: AlarmCondition, now: Time) -> Option<Alarm> {
        let key = condition.key();
        if self.active.contains_key(&key) {
            self.find_again(&key, condition, now);
            return None;
        }
        let since = condition.since.unwrap_or(now);
        Some(self.begin(key, condition, since, now))
    }

    /// Ends all alarms of a kind. Returns whether there was one.
    pub fn clear(&mut self, kind: AlarmKind, now: Time) -> bool {
        let of_kind: Vec<AlarmKey> = self.active.keys().filter(|k| k.kind == kind).cloned().collect();
        of_kind.iter().for_each(|key| self.end(key, now));
        !of_kind.is_empty()
    }

    /// Acknowledges an active alarm; the first acknowledgement counts. Acknowledging a group acknowledges all its
    /// members; acknowledging all members acknowledges their group. Nothing if no alarm of this number is active.
    pub fn acknowledge(&mut self, id: u64, by: &str, now: Time) -> Option<Alarm> {
        let noted = Acknowledgement { by: by.to_owned(), at: now };
        let key = self.key_of(id)?;
        self.note(&key, &noted);
        if key.is_group() {
            let members = self.members(key.kind);
            members.iter().for_each(|member| self.note(member, &noted));
            self.active.get_mut(&key)?.noted = members.len();
        } else {
            self.join();
        }
        self.find(id)
    }

    /// Shelves an active alarm.
    ///
    /// # Errors
    /// If the alarm is not active, must always call, or too many alarms are shelved.
    pub fn shelve(&mut self, id: u64, shelving: Shelving) -> Result<Alarm, CareRefusal> {
        let key = self.key_of(id).ok_or(CareRefusal::NotActive)?;
        if key.kind.ends_readiness() || key.kind == AlarmKind::Evacuation {
            return Err(CareRefusal::AlwaysCalls);
        }
        if self.shelves.len() >= MOST_SHELVED && !self.shelves.contains_key(&key) {
            return Err(CareRefusal::TooManyShelved);
        }
        self.shelves.insert(key.clone(), shelving.clone());
        self.alter(&key, |alarm| alarm.shelved = Some(shelving));
        self.find(id).ok_or(CareRefusal::NotActive)
    }

    /// Ends the shelving of an active alarm. Nothing if no alarm of this number is active.
    pub fn unshelve(&mut self, id: u64) -> Option<Alarm> {
        let key = self.key_of(id)?;
        self.unshelve_key(&key);
        self.find(id)
    }

    /// Adds a note to an active alarm.
    ///
    /// # Errors
    /// If the alarm is not active, or has too many notes.
    pub fn write_note(&mut self, id: u64, note: AlarmNote) -> Result<Alarm, CareRefusal> {
        let key = self.key_of(id).ok_or(CareRefusal::NotActive)?;
        if self.active[&key].alarm.notes.len() >= MOST_NOTES {
            return Err(CareRefusal::TooManyNotes);
        }
        self.alter(&key, |alarm| alarm.notes.push(note));
        self.find(id).ok_or(CareRefusal::NotActive)
    }

    /// All active alarms: the worst first, and of equally bad ones the newest first. Members are in their groups.
    pub fn active(&self) -> Vec<Alarm> {
        let top = self.active.iter().filter(|(_, a)| a.alarm.group.is_none());
        let mut all: Vec<Alarm> = top.map(|(key, _)| self.whole(key)).collect();
        all.sort_by_key(|a| std::cmp::Reverse((a.severity, a.id)));
        all
    }

    /// The active alarm of this number, also if it is a member of a group.
    pub fn find(&self, id: u64) -> Option<Alarm> {
        self.key_of(id).map(|key| self.whole(&key))
    }

    /// Active alarms about this subject, also if they are members of a group.
    pub fn about(&self, subject: &AlarmSubject) -> Vec<Alarm> {
        self.active.values().map(|a| &a.alarm).filter(|alarm| alarm.subject == *subject).cloned().collect()
    }

    /// The alarms that have changed since the last call, to be stored.
    pub fn take_changes(&mut self) -> Vec<Alarm> {
        std::mem::take(&mut self.changed).into_values().collect()
    }

    /// Hands out alarms again that could not be stored, unless they have changed since.
    pub fn put_back(&mut self, alarms: Vec<Alarm>) {
        for alarm in alarms {
            self.changed.entry(alarm.id).or_insert(alarm);
        }
        // If the database refuses for long, the oldest changes are given up.
        while self.changed.len() > 2 * MOST_ACTIVE {
            self.changed.pop_first();
        }
    }

    fn find_again(&mut self, key: &AlarmKey, condition: AlarmCondition, now: Time) {
        let one = self.active.get_mut(key).expect("the caller looked");
        (one.found, one.settles) = (now, Time(one.settles.0.min(now.0)));
        let worse = condition.severity > one.alarm.severity;
        let AlarmCondition { severity, subject, text, remedy, at, waiting, .. } = condition;
        // The worst severity stays: an alarm that goes up and down would call people again and again.
        let severity = severity.max(one.alarm.severity);
        one.alarm = Alarm { severity, subject, text, remedy, at, waiting, ..one.alarm.clone() };
        if worse {
            // What a person acknowledged or shelved was less bad.
            self.unshelve_key(key);
            self.alter(key, |alarm| alarm.acknowledged = None);
        }
    }

    fn begin(&mut self, key: AlarmKey, condition: AlarmCondition, since: Time, now: Time) -> Alarm {
        self.last += 1;
        let AlarmCondition { kind, subject, severity, text, remedy, at, waiting, .. } = condition;
        let alarm = Alarm {
            id: self.last,
            kind,
            severity,
            subject,
            text,
            remedy,
            at,
            waiting,
            since,
            acknowledged: None,
            shelved: self.shelves.get(&key).filter(|s| s.until > now).cloned(),
            notes: Vec::new(),
            group: None,
            members: Vec::new(),
            cleared: None,
        };
        let one = ActiveAlarm { alarm: alarm.clone(), found: now, settles: now, noted: 0 };
        self.active.insert(key, one);
        self.change(alarm.clone());
        alarm
    }

    fn end(&mut self, key: &AlarmKey, now: Time) {
        let Some(one) = self.active.remove(key) else { return };
        self.change(Alarm { cleared: Some(now), ..one.alarm });
    }

    /// Has alarms of robots join the group of their kind, or makes them single again if the group is over.
    fn join(&mut self) {
        let groups = self.groups();
        let loose =
            self.active.iter().filter(|(key, a)| a.alarm.group.is_some() && !groups.contains(&key.kind));
        let loose: Vec<AlarmKey> = loose.map(|(key, _)| key.clone()).collect();
        loose.iter().for_each(|key| self.alter(key, |alarm| alarm.group = None));
        for kind in groups {
            self.join_group(kind);
        }
    }

    /// Acknowledges new members of an acknowledged group with it, until the group has more than twice as many members
    /// as when it was acknowledged. Acknowledges a group whose members are all acknowledged.
    fn join_group(&mut self, kind: AlarmKind) {
        let Some((key, group)) = self.active.iter().find(|(_, a)| a.is_group_of(kind)) else { return };
        let (key, id, noted, then) =
            (key.clone(), group.alarm.id, group.alarm.acknowledged.clone(), group.noted);
        let members = self.members(kind);
        let fresh: Vec<&AlarmKey> =
            members.iter().filter(|member| self.active[*member].alarm.group != Some(id)).collect();
        for member in fresh {
            self.alter(member, |alarm| alarm.group = Some(id));
        }
        match noted {
            Some(_) if members.len() > 2 * then.max(1) => {
                self.alter(&key, |alarm| alarm.acknowledged = None);
            }
            Some(noted) => members.iter().for_each(|member| self.note(member, &noted)),
            None => {
                let of_member = |key: &AlarmKey| self.active[key].alarm.acknowledged.clone();
                let all: Option<Vec<Acknowledgement>> = members.iter().map(of_member).collect();
                let Some(last) = all.and_then(|all| all.into_iter().max_by_key(|noted| noted.at)) else {
                    return;
                };
                self.note(&key, &last);
                self.active.get_mut(&key).expect("it is there").noted = members.len();
            }
        }
    }

    /// Kinds of which there is a group.
    fn groups(&self) -> Vec<AlarmKind> {
        self.active.keys().filter(|key| key.is_group()).map(|key| key.kind).collect()
    }

    /// The alarms of single robots of a kind, in order of their numbers.
    fn members(&self, kind: AlarmKind) -> Vec<AlarmKey> {
        let mut all: Vec<(u64, &AlarmKey)> = (self.active.iter())
            .filter(|(key, _)| key.kind == kind && !key.is_group())
            .map(|(key, a)| (a.alarm.id, key))
            .collect();
        all.sort_unstable();
        all.into_iter().map(|(_, key)| key.clone()).collect()
    }

    /// An active alarm with its members.
    fn whole(&self, key: &AlarmKey) -> Alarm {
        let keys = if key.is_group() { self.members(key.kind) } else { Vec::new() };
        let members = keys.iter().map(|key| self.active[key].member()).collect();
        Alarm { members, ..self.active[key].alarm.clone() }
    }

    fn key_of(&self, id: u64) -> Option<AlarmKey> {
        self.active.iter().find(|(_, a)| a.alarm.id == id).map(|(key, _)| key.clone())
    }

    /// Acknowledges an alarm that is not acknowledged yet.
    fn note(&mut self, key: &AlarmKey, noted: &Acknowledgement) {
        if self.active[key].alarm.acknowledged.is_none() {
            self.alter(key, |alarm| alarm.acknowledged = Some(noted.clone()));
        }
    }

    fn unshelve_key(&mut self, key: &AlarmKey) {
        self.shelves.remove(key);
        if self.active.get(key).is_some_and(|a| a.alarm.shelved.is_some()) {
            self.alter(key, |alarm| alarm.shelved = None);
        }
    }

    fn end_shelving(&mut self, now: Time) {
        let over: Vec<AlarmKey> =
            self.shelves.iter().filter(|(_, s)| s.until <= now).map(|(key, _)| key.clone()).collect();
        over.iter().for_each(|key| self.unshelve_key(key));
    }

    /// Changes an active alarm.
    fn alter(&mut self, key: &AlarmKey, how: impl FnOnce(&mut Alarm)) {
        let Some(one) = self.active.get_mut(key) else { return };
        how(&mut one.alarm);
        let alarm = one.alarm.clone();
        self.change(alarm);
    }

    fn change(&mut self, alarm: Alarm) {
        self.changed.insert(alarm.id, alarm);
    }
}

impl ActiveAlarm {
    fn is_group_of(&self, kind: AlarmKind) -> bool {
        self.alarm.kind == kind && AlarmKey::of(&self.alarm).is_group()
    }

    fn member(&self) -> AlarmMember {
        let Alarm { id, subject, text, at, since, acknowledged, .. } = self.alarm.clone();
        AlarmMember { id, subject, text, at, since, acknowledged_by: acknowledged.map(|noted| noted.by) }
    }
}

impl AlarmKey {
    fn of(alarm: &Alarm) -> AlarmKey {
        let subject = (!alarm.kind.is_collective()).then(|| alarm.subject.clone());
        AlarmKey { kind: alarm.kind, subject }
    }
}

#[cfg(test)]
mod tests;
