//! What the web page may ask for: every choice of its filters is one that the API knows.

use crate::helper::{Folder, get, start};

const JOBS: &str = include_str!("../../web/src/wire/jobs.ts");
const HISTORY: &str = include_str!("../../web/src/wire/history.ts");
const TIMELINES: &str = include_str!("../../web/src/timelines/Timelines.svelte");

/// The entries of a list that the page defines as `const NAME = [..]`.
fn choices(source: &str, name: &str) -> Vec<String> {
    let list = source.split_once(&format!("const {name} = [")).expect("the page defines it").1;
    let list = list.split_once(']').expect("the list ends").0;
    let entries = list.split(',').map(|entry| entry.trim().trim_matches('\'').to_owned());
    entries.filter(|entry| !entry.is_empty()).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_api_accepts_every_choice_of_every_filter_of_the_page() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let filters = [
        ("/v1/jobs?limit=50&state=", choices(JOBS, "JOB_STATES")),
        ("/v1/heat?kind=", choices(HISTORY, "HEAT_KINDS")),
        ("/v1/timelines?x0=0&y0=0&x1=3&y1=3&ahead_s=", choices(TIMELINES, "LENGTHS")),
    ];
    for (query, words) in filters {
        assert!(words.len() >= 2, "{query}: {words:?}");
        for word in words {
            let answer = get(at, &format!("{query}{word}")).await;
            assert_eq!(answer.status, 200, "{query}{word}: {answer:?}");
        }
    }
    server.stop().await.unwrap();
}
