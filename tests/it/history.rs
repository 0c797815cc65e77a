//! Figures over time and maps of heat over HTTP, over a restart, too.

use crate::helper::{Folder, delivery, eventually, get, map, post, start};
use giveway::history::{Bucket, HeatBucket};
use giveway::id::NodeId;
use giveway::store::Store;
use giveway::time::{Span, Time};
use serde_json::{Value, json};
use std::net::SocketAddr;

/// Racks served, as all buckets of the last hour have it.
async fn delivered(at: SocketAddr, step: u32) -> u64 {
    let history = get(at, &format!("/v1/history?step={step}")).await.json();
    let buckets = history["buckets"].as_array().unwrap();
    buckets.iter().map(|b| b["robot_deliveries"].as_u64().unwrap()).sum()
}

async fn until(at: SocketAddr, racks: u64) {
    let are_served = async || (delivered(at, 10).await == racks).then_some(());
    eventually(&format!("the history has {racks} deliveries"), are_served).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_happened_is_in_buckets_and_there_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut job = delivery(0);
    job["pick_s"] = json!(0.2);
    assert_eq!(post(at, None, &job).await.unwrap().status, 201);
    until(at, 1).await;
    let history = get(at, "/v1/history?step=10").await.json();
    assert_eq!((history["step_s"].clone(), history["arm"].clone()), (json!(10), json!("giveway")));
    let last = history["buckets"].as_array().unwrap().last().unwrap().clone();
    assert!(last["covered_s"].as_f64().unwrap() <= 10.0, "{last}");
    let sum = |key: &str| -> f64 {
        history["buckets"].as_array().unwrap().iter().filter_map(|b| b[key].as_f64()).sum()
    };
    assert!(sum("plans") >= 1.0 && sum("plan_us_max") > 0.0 && sum("worker_s") == 0.0, "{history}");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let again = get(at, "/v1/history?step=10").await.json();
    assert_ne!(again["started"], history["started"], "another run");
    let before = |h: &Value| h["buckets"][0]["at"].as_str().unwrap().to_owned();
    assert_eq!(before(&again), before(&history));
    for step in [10, 30, 60, 600] {
        assert_eq!(delivered(at, step).await, 1, "by {step} s");
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn heat_says_where_and_wrong_questions_say_what_is_right() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let waiting = get(at, "/v1/heat?kind=waiting").await.json();
    assert_eq!((waiting["unit"].clone(), waiting["cells"].clone()), (json!("seconds"), json!([])));
    let met = get(at, "/v1/heat?kind=encounters").await.json();
    assert_eq!((met["unit"].clone(), met["size"].clone()), (json!("encounters"), json!(1.0)));
    for (bad, field) in [
        ("history?step=15", "step"),
        ("history?step=0", "step"),
        ("history?step=10&from=2020-01-01T00:00:00Z", "step"),
        ("history?from=yesterday", "from"),
        ("history?from=2027-01-02T00:00:00Z&to=2027-01-01T00:00:00Z", "from"),
        ("heat?kind=waiting&to=soon", "to"),
    ] {
        let problem = get(at, &format!("/v1/{bad}")).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    assert!(get(at, "/v1/heat").await.status >= 400);
    assert!(get(at, "/v1/heat?kind=love").await.status >= 400);
    server.stop().await.unwrap();
}

#[tokio::test]
async fn buckets_are_written_again_while_they_are_not_over_and_deleted_when_they_are_old() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let start = Time(20_000 * 86_400 * 1_000_000);
    let ten = Span::from_secs(10);
    let mut bucket = Bucket { start, covered: Span::from_secs(4), robot_deliveries: 2, ..Bucket::default() };
    [50, 70_000].iter().for_each(|us| bucket.searches.note(*us));
    let waited = |s: i64| [(NodeId(3), Span::from_secs(s)), (NodeId(7), Span(1))].into();
    let heat = |s: i64| vec![HeatBucket { start, waited: waited(s) }];
    store.keep_history(start, &[(ten, bucket.clone())], &heat(5)).await.unwrap();
    (bucket.covered, bucket.waiting_time) = (ten, Span::from_secs(33));
    (bucket.lines, bucket.wrong_reaches, bucket.idle_time) = (5, 1, Span::from_secs(7));
    store.keep_history(start, &[(ten, bucket.clone())], &heat(9)).await.unwrap();
    assert_eq!(store.load_history().await.unwrap(), (vec![(ten, bucket.clone())], heat(9)));
    let later = start + Span::from_secs(2 * 86_400);
    let fresh = HeatBucket { start: later, waited: waited(1) };
    store.keep_history(later, &[], std::slice::from_ref(&fresh)).await.unwrap();
    assert_eq!(store.load_history().await.unwrap(), (vec![], vec![fresh]), "an hour and a day are over");
    store.close().await;
}
