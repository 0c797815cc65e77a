//! `web/fixtures` holds messages as the page's tests read them. Here they have the keys that the server writes.

use crate::helper::{Folder, get, post, start};
use crate::live::{connect, next};
use serde_json::{Value, json};
use std::collections::BTreeSet;

fn fixture(text: &str) -> Value {
    serde_json::from_str(text).expect("a fixture is JSON")
}

fn keys(of: &Value) -> BTreeSet<&str> {
    of.as_object().expect("an object").keys().map(String::as_str).collect()
}

/// The keys of two objects are the same.
fn same_keys(what: &str, fixture: &Value, written: &Value) {
    let (read, written) = (keys(fixture), keys(written));
    let missing: Vec<&str> = written.difference(&read).copied().collect();
    let gone: Vec<&str> = read.difference(&written).copied().collect();
    assert!(
        missing.is_empty() && gone.is_empty(),
        "{what}: web/fixtures lack {missing:?} and still have {gone:?}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_fixtures_of_the_page_have_the_keys_that_the_server_writes() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    crate::feed::hire(at, "anna").await;
    let read = fixture(include_str!("../../web/fixtures/snapshot.json"));
    let written = loop {
        let snapshot = next(&mut connect(at, "", "").await.unwrap()).await.unwrap();
        if snapshot["workers"][0].is_object() {
            break snapshot;
        }
    };
    same_keys("snapshot", &read, &written);
    for part in ["jobs", "counters"] {
        same_keys(part, &read[part], &written[part]);
    }
    for row in ["robots", "racks", "stations", "workers"] {
        same_keys(row, &read[row][0], &written[row][0]);
    }
    same_keys("map", &fixture(include_str!("../../web/fixtures/map.json")), &get(at, "/v1/map").await.json());
    let refused = post(at, None, &json!({"kind": "deliver", "rack": "K99", "station": "P1"})).await.unwrap();
    let problem = fixture(include_str!("../../web/fixtures/problem.json"));
    same_keys("problem", &problem, &refused.json());
    same_keys("error of a field", &problem["errors"][0], &refused.json()["errors"][0]);
    let taken = post(at, None, &json!({"kind": "deliver", "rack": "K1", "station": "P"})).await.unwrap();
    assert_eq!(taken.status, 201, "{taken:?}");
    let jobs = fixture(include_str!("../../web/fixtures/jobs.json"));
    let page = get(at, "/v1/jobs").await.json();
    same_keys("page of jobs", &jobs, &page);
    same_keys("job", &jobs["items"][0], &page["items"][0]);
    server.stop().await.unwrap();
}
