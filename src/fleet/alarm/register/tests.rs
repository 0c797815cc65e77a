//! What becomes of alarms: raised, acknowledged, shelved, in groups, over a restart.

use super::*;
use crate::alarm::SubjectKind;
use giveway_floor::text::SentenceArg;
use giveway_floor::text::sentence::alarms;
use giveway_floor::time::Span;

fn at(s: i64) -> Time {
    Time(s * 1_000_000)
}

fn lost(waiting: usize) -> AlarmCondition {
    let subject = AlarmSubject::new(SubjectKind::Worker, "w7");
    let text = alarms::worker_lost_robots_wait("ana", waiting);
    let one = AlarmCondition::new(AlarmKind::WorkerLost, subject, text);
    let severity = if waiting > 0 { AlarmSeverity::Critical } else { AlarmSeverity::Warning };
    AlarmCondition { waiting, severity, ..one }
}

fn silent(robot: &str) -> AlarmCondition {
    let subject = AlarmSubject::new(SubjectKind::Robot, robot);
    AlarmCondition::new(AlarmKind::RobotSilent, subject, alarms::robot_silent(robot, SentenceArg::nothing()))
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
    assert!(worse.text.text().contains("14 robots"), "{}", worse.text);
    assert_eq!(register.acknowledge(id + 1, "ben", at(5)), None, "there is none of this number");
}

#[test]
fn an_alarm_outlasts_a_restart_with_its_number_and_its_acknowledgement_and_ends_if_not_found_again() {
    let mut before = AlarmRegister::default();
    let id = before.observe(AlarmScope::Watch, vec![lost(3)], at(0))[0].id;
    before.acknowledge(id, "ben", at(1));
    before.raise(AlarmCondition::of_server(AlarmKind::Journal, alarms::journal_full()), at(1));
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
    let raised = after
        .raise(AlarmCondition::of_server(AlarmKind::Journal, alarms::journal_slow(3, "a file")), at(140));
    assert_eq!(raised.expect("new").id, 18, "numbers go on");
}

#[test]
fn one_scope_does_not_end_what_another_one_found() {
    let mut register = AlarmRegister::default();
    register.raise(AlarmCondition::of_server(AlarmKind::Journal, alarms::journal_full()), at(0));
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

/// What a look finds if this many robots are silent, with or without their group.
fn silent_ones(robots: usize, gathering: &mut super::super::groups::Gathering) -> Vec<AlarmCondition> {
    gathering.gather((0..robots).map(|i| silent(&format!("robot-{i}"))).collect(), 200)
}

#[test]
fn an_acknowledgement_is_kept_when_its_alarm_joins_a_group_and_when_it_leaves_it() {
    let (mut register, mut gathering) = (AlarmRegister::default(), Default::default());
    let mut look = |register: &mut AlarmRegister, s: i64, robots: usize| {
        register.observe(AlarmScope::Watch, silent_ones(robots, &mut gathering), at(s))
    };
    (0..10).for_each(|s| _ = look(&mut register, s, 4));
    let first = register.active().iter().map(|a| a.id).min().expect("four are active");
    register.acknowledge(first, "ben", at(10));
    let told: Vec<Alarm> = (11..30).flat_map(|s| look(&mut register, s, 120)).collect();
    assert_eq!(told.len(), 1, "the group calls, its members do not: {told:?}");
    let [group] = &register.active()[..] else { panic!("one alarm for all: {:?}", register.active()) };
    assert_eq!(
        (group.members.len(), &group.acknowledged),
        (120, &None),
        "119 have nobody who looks after them"
    );
    let by = |members: &[AlarmMember]| members.iter().filter(|m| m.acknowledged_by.is_some()).count();
    assert_eq!((by(&group.members), group.members[0].acknowledged_by.as_deref()), (1, Some("ben")));
    register.acknowledge(group.id, "eve", at(31));
    let group = register.find(group.id).expect("active");
    assert_eq!(by(&group.members), 120, "whoever takes a group takes its members");
    assert_eq!(group.members[0].acknowledged_by.as_deref(), Some("ben"), "who did first, did");
    (32..50).for_each(|s| _ = look(&mut register, s, 2));
    let left = register.active();
    let names: Vec<_> = left.iter().map(|a| a.acknowledged.as_ref().expect("kept").by.as_str()).collect();
    assert_eq!((left.len(), names), (2, vec!["eve", "ben"]), "numbers and acknowledgements are as they were");
    assert!(left.iter().all(|a| a.group.is_none()) && left[1].id == first);
}

#[test]
fn single_alarms_are_not_raised_anew_when_their_number_crosses_the_limit() {
    let (mut register, mut gathering) = (AlarmRegister::default(), Default::default());
    let mut raised = 0;
    for s in 0..300 {
        let robots = if (s / 20) % 2 == 0 { 6 } else { 5 };
        let found = silent_ones(robots, &mut gathering);
        raised += register.observe(AlarmScope::Watch, found, at(s)).len();
    }
    assert_eq!(raised, 1, "one group, once");
    let changes = register.take_changes();
    let of_first = changes.iter().filter(|a| a.subject.id == "robot-0").count();
    assert_eq!((of_first, register.active().len()), (1, 1));
}

#[test]
fn a_group_of_which_somebody_took_note_asks_again_when_it_has_more_than_doubled() {
    let (mut register, mut gathering) = (AlarmRegister::default(), Default::default());
    let mut look = |register: &mut AlarmRegister, s: i64, robots: usize| {
        register.observe(AlarmScope::Watch, silent_ones(robots, &mut gathering), at(s));
        register.active().first().cloned()
    };
    (0..10).for_each(|s| _ = look(&mut register, s, 6));
    let id = look(&mut register, 10, 6).expect("the group is active").id;
    register.acknowledge(id, "ben", at(11));
    let grown = (12..30).filter_map(|s| look(&mut register, s, 12)).last().expect("looked");
    let noted = grown.members.iter().all(|m| m.acknowledged_by.as_deref() == Some("ben"));
    assert!(grown.acknowledged.is_some() && noted, "who comes to it is looked after, too: {grown:?}");
    let grown = (30..50).filter_map(|s| look(&mut register, s, 13)).last().expect("looked");
    assert_eq!((grown.id, grown.acknowledged), (id, None), "this is more than somebody took note of");
}

#[test]
fn a_group_outlasts_a_restart_with_its_members_and_what_people_did() {
    let (mut before, mut gathering) = (AlarmRegister::default(), Default::default());
    (0..10).for_each(|s| _ = before.observe(AlarmScope::Watch, silent_ones(7, &mut gathering), at(s)));
    let group = before.active()[0].id;
    let member = before.active()[0].members[2].id;
    before.acknowledge(member, "ben", at(11));
    let kept = before.take_changes();
    assert!(kept.len() == 8 && kept.iter().all(|a| a.members.is_empty()), "members are kept once");
    let mut after = AlarmRegister::default();
    after.restore(8, kept, at(20));
    let [whole] = &after.active()[..] else { panic!("{:?}", after.active()) };
    assert_eq!((whole.id, whole.members.len()), (group, 7));
    assert_eq!(whole.members[2].acknowledged_by.as_deref(), Some("ben"));
}

fn aside(until: i64) -> Shelving {
    Shelving { by: "ben".into(), at: at(0), until: at(until), reason: "the radio is being mended".into() }
}

#[test]
fn an_alarm_that_is_put_aside_stays_so_until_its_end_though_it_is_raised_anew_and_over_a_restart() {
    let mut register = AlarmRegister::default();
    let look = |register: &mut AlarmRegister, s: i64, there: bool| {
        let found = there.then(|| silent("robot-1")).into_iter().collect();
        register.observe(AlarmScope::Watch, found, at(s));
    };
    (0..6).for_each(|s| look(&mut register, s, true));
    let id = register.active()[0].id;
    assert_eq!(register.shelve(id, aside(100)).map(|a| a.shelved), Ok(Some(aside(100))));
    (6..20).for_each(|s| look(&mut register, s, false));
    assert!(register.active().is_empty());
    let mut after = AlarmRegister::default();
    after.restore(id, register.take_changes(), at(25));
    (25..40).for_each(|s| look(&mut after, s, true));
    let again = after.active().remove(0);
    assert!(again.id > id && again.shelved == Some(aside(100)), "{again:?}");
    (40..=100).for_each(|s| look(&mut after, s, true));
    assert_eq!(after.active()[0].shelved, None, "it calls again");
}

#[test]
fn an_alarm_that_gets_worse_calls_though_it_was_put_aside_and_some_cannot_be() {
    let mut register = AlarmRegister::default();
    let id = register.observe(AlarmScope::Watch, vec![lost(0)], at(0))[0].id;
    register.shelve(id, aside(1000)).expect("it is active");
    register.observe(AlarmScope::Watch, vec![lost(3)], at(1));
    assert_eq!(register.active()[0].shelved, None);
    assert_eq!(register.shelve(id + 9, aside(1000)), Err(CareRefusal::NotActive));
    let journal = AlarmCondition::of_server(AlarmKind::Journal, alarms::journal_full());
    let journal = register.raise(journal, at(2)).expect("new").id;
    assert_eq!(register.shelve(journal, aside(1000)), Err(CareRefusal::AlwaysCalls));
}

#[test]
fn notes_are_kept_in_order_up_to_a_limit() {
    let mut register = AlarmRegister::default();
    let id = register.observe(AlarmScope::Watch, vec![lost(0)], at(0))[0].id;
    let note = |i: i64| AlarmNote { by: "ben".into(), at: at(i), text: format!("looked {i} times") };
    let most = MOST_NOTES as i64;
    assert!((0..most).all(|i| register.write_note(id, note(i)).is_ok()));
    assert_eq!(register.write_note(id, note(most)), Err(CareRefusal::TooManyNotes));
    register.observe(AlarmScope::Watch, vec![lost(0)], at(1) + Span::from_secs(1));
    let kept: Vec<i64> = register.active()[0].notes.iter().map(|n| n.at.0 / 1_000_000).collect();
    assert_eq!(kept, (0..most).collect::<Vec<_>>());
}
