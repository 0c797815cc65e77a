//! What fills to its limit, and gets room again: the tables of the database that no fleet bounds.

use crate::helper::{Folder, map};
use giveway::alarm::{Alarm, AlarmKind, AlarmQuery, AlarmSubject, SubjectKind};
use giveway::fleet::{EventKind, EventQuery, Fact};
use giveway::store::{MOST_PAST, SessionRow, StepEntry, Store};
use giveway::time::{Span, Time};

const DAY: Span = Span::from_secs(24 * 3600);
const AT: Time = Time(1_800_000_000_000_000);

async fn store(folder: &Folder) -> Store {
    Store::open(&folder.database(), &map()).await.unwrap()
}

fn halts(at: Time, count: usize) -> StepEntry {
    let facts = vec![Fact::Halted { robot: None, at }; count];
    StepEntry { at, facts, causes: Vec::new() }
}

#[tokio::test]
async fn events_are_forgotten_after_a_week_from_the_first_on() {
    let folder = Folder::new();
    let store = store(&folder).await;
    store.append(1, &[halts(AT, 500)]).await.unwrap();
    store.append(2, &[halts(AT + DAY * 6, 3)]).await.unwrap();
    assert_eq!(store.event_span().await.unwrap().before, 0, "nothing is too old");
    let all = EventQuery { kinds: vec![EventKind::Fleet], after: 0, limit: 1000 };
    let mut left = Vec::new();
    for step in 3..7 {
        store.append(step, &[halts(AT + DAY * 8, 1)]).await.unwrap();
        let span = store.event_span().await.unwrap();
        assert_eq!(store.events(&all).await.unwrap()[0].seq, span.before + 1, "none is missing between");
        left.push(span.last - span.before);
    }
    assert_eq!(left, [304, 105, 6, 7], "a slice with each step, until what is a week old is gone");
    store.close().await;
}

#[tokio::test]
async fn of_alarms_that_are_over_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    let alarm = |id: i64| {
        let since = AT + Span(id);
        Alarm {
            id: id.unsigned_abs(),
            kind: AlarmKind::Journal,
            severity: AlarmKind::Journal.severity(),
            subject: AlarmSubject::new(SubjectKind::Server, String::new()),
            text: "slow".into(),
            remedy: "make room".into(),
            at: None,
            waiting: 0,
            since,
            acknowledged: None,
            shelved: None,
            notes: Vec::new(),
            group: None,
            members: Vec::new(),
            cleared: (id > 1).then_some(since + Span(1)),
        }
    };
    let all: Vec<Alarm> = (1..=MOST_PAST + 50).map(alarm).collect();
    for some in all.chunks(5_000) {
        store.keep_alarms(some).await.unwrap();
    }
    let query = AlarmQuery { from: None, to: None, group: None, before: None, limit: 30_000 };
    let kept = store.alarms(&query).await.unwrap();
    assert_eq!(kept.len() as i64, MOST_PAST + 1, "and the one that is active");
    assert_eq!(kept.last().unwrap().id, 1);
    store.close().await;
}

#[tokio::test]
async fn of_sessions_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    for n in 0..110_i64 {
        for token in [1_u8, 2] {
            let hash = (2 * n + i64::from(token)).to_le_bytes().repeat(4);
            let created = AT + Span(n);
            let row =
                SessionRow { hash, token: vec![token; 32], person: None, created, expires: created + DAY };
            store.add_session(&row).await.unwrap();
        }
    }
    let kept = store.sessions().await.unwrap();
    assert_eq!(kept.len(), 200, "100 of each token");
    assert_eq!(kept.iter().map(|s| s.created).min(), Some(AT + Span(10)), "the oldest end first");
    store.end_session(&kept[0].hash).await.unwrap();
    assert_eq!(store.sessions().await.unwrap().len(), 199);
    store.close().await;
}

#[tokio::test]
async fn of_messages_that_were_given_up_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    let hook = store.add_webhook("http://127.0.0.1:9/", &[], "secret", AT).await.unwrap().id;
    for n in 1..=1_005 {
        store.webhook_missed(hook, n, "nobody there").await.unwrap();
        store.webhook_given_up(hook, (n, n), AT).await.unwrap();
    }
    let kept = store.webhook_failures(hook, None, 2_000).await.unwrap();
    assert_eq!((kept.len(), kept[0].last, kept[999].last), (1_000, 1_005, 6));
    assert!(store.remove_webhook(hook).await.unwrap());
    assert!(store.webhook_failures(hook, None, 10).await.unwrap().is_empty(), "they go with it");
    store.close().await;
}

#[tokio::test]
async fn answers_are_forgotten_after_seven_days() {
    let folder = Folder::new();
    let store = store(&folder).await;
    for n in 0..300 {
        let key = format!("key-{n}");
        assert_eq!(store.begin_keyed(["wms", "POST /v1/closures", &key], "body", AT).await.unwrap(), None);
    }
    let again = ["wms", "POST /v1/closures", "key-7"];
    assert!(store.begin_keyed(again, "body", AT + DAY * 6).await.unwrap().is_some(), "it is known");
    assert_eq!(store.begin_keyed(again, "body", AT + DAY * 8).await.unwrap(), None, "it is not any more");
    store.close().await;
}
