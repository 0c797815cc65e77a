//! HTTP: what is answered, to which clients, and what is refused with which words.

use crate::helper::{Folder, all_jobs, config, delivery, eventually, floor, get, map, post, send, start};
use giveway::server::{Config, Server};
use serde_json::{Value, json};

const JSON: (&str, &str) = ("content-type", "application/json");

#[tokio::test(flavor = "multi_thread")]
async fn a_body_may_begin_with_a_byte_order_mark_as_map_files_may() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let body = format!("\u{feff}{}", delivery(0));
    assert_eq!(send(at, "POST", "/v1/jobs", &[JSON], &body).await.unwrap().status, 201);
    let twice = format!("\u{feff}\u{feff}{}", delivery(1));
    send(at, "POST", "/v1/jobs", &[JSON], &twice).await.unwrap().problem(400);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_accepted_listed_and_cancelled() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut job = delivery(0);
    job["priority"] = json!(7);
    job["deadline"] = json!("2031-01-31T13:00:00+01:00");
    job["pick_s"] = json!(600);
    let answer = post(at, None, &job).await.unwrap();
    assert_eq!(answer.status, 201, "{answer:?}");
    let made = answer.json();
    let id = made["id"].as_str().unwrap();
    assert_eq!(answer.header("location"), Some(format!("/v1/jobs/{id}").as_str()));
    assert_eq!(made["rack"], job["rack"]);
    assert_eq!(made["deadline"], "2031-01-31T12:00:00Z");
    assert_eq!((made["priority"].clone(), made["pick_s"].clone()), (json!(7), json!(600.0)));

    let got = get(at, &format!("/v1/jobs/{id}")).await.json();
    assert_eq!(got["created"], made["created"]);
    assert!(all_jobs(at, 50).await.iter().any(|j| j["id"] == id));

    let mut follower = delivery(1);
    follower["after"] = json!([id]);
    let follower = post(at, None, &follower).await.unwrap().json();
    assert_eq!(follower["after"], json!([id]));
    let path = format!("/v1/jobs/{}", follower["id"].as_str().unwrap());
    let why = format!("waits for {id} to be over");
    // Said by the next picture.
    let is_said = async || (get(at, &path).await.json()["why"]["text"] == *why).then_some(());
    eventually(&format!("the job says that it {why}"), is_said).await;
    let gone =
        send(at, "DELETE", &format!("/v1/jobs/{}", follower["id"].as_str().unwrap()), &[], "").await.unwrap();
    assert_eq!(gone.status, 200, "{gone:?}");
    assert_eq!(gone.json()["state"], "cancelled", "nobody had it yet");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn lists_have_pages() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut made = Vec::new();
    for i in 0..7 {
        let answer = post(at, None, &delivery(i)).await.unwrap();
        made.push(answer.json()["id"].as_str().unwrap().to_owned());
    }
    let listed = all_jobs(at, 3).await;
    let numbers: Vec<u64> = listed.iter().map(|j| j["id"].as_str().unwrap()[1..].parse().unwrap()).collect();
    assert!(numbers.is_sorted_by(|a, b| a > b), "newest first, none twice: {numbers:?}");
    assert!(made.iter().all(|id| listed.iter().any(|j| j["id"] == **id)));
    let page = get(at, "/v1/jobs?state=failed").await.json();
    assert_eq!(page, json!({"items": [], "next": null}));

    let first = get(at, "/v1/racks?limit=2").await.json();
    let rest =
        get(at, &format!("/v1/racks?limit=500&cursor={}", first["next"].as_str().unwrap())).await.json();
    assert_eq!(rest["items"].as_array().unwrap().len(), map().racks.len() - 2);
    assert_eq!(rest["next"], Value::Null);
    assert_eq!(get(at, "/v1/stations").await.json()["items"].as_array().unwrap().len(), map().stations.len());
    assert!(get(at, "/v1/robots").await.json()["items"].is_array());
    for bad in
        ["/v1/racks?limit=0", "/v1/racks?cursor=x", "/v1/jobs?limit=501", "/v1/jobs?cursor=9&state=odd"]
    {
        get(at, bad).await.problem(422);
    }
    get(at, "/v1/robots?colour=red").await.problem(400);
    get(at, "/v1/jobs?limit=many").await.problem(400);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_requests_get_problems_that_say_what_to_do_and_change_nothing() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let fields = |problem: &Value| -> Vec<String> {
        let errors = problem["errors"].as_array().cloned().unwrap_or_default();
        errors.iter().map(|e| e["field"].as_str().unwrap().to_owned()).collect()
    };
    let bad = [
        (json!({"kind": "deliver"}), vec!["rack", "station"]),
        (json!({"kind": "deliver", "rack": "nope", "station": "nope"}), vec!["rack", "station"]),
        (json!({"kind": "return", "rack": delivery(0)["rack"], "node": "x"}), vec!["node"]),
        (json!({"kind": "go", "robot": "robot-999", "node": "nowhere"}), vec!["robot", "node"]),
    ];
    for (job, wrong) in bad {
        let problem = post(at, None, &job).await.unwrap().problem(422);
        assert_eq!(fields(&problem), wrong, "{problem}");
    }
    for (key, value) in [
        ("priority", json!(10)),
        ("priority", json!(-1)),
        ("pick_s", json!(-1)),
        ("pick_s", json!(1e300)),
        ("deadline", json!("tomorrow")),
        ("deadline", json!("999999-01-01T00:00:00Z")),
        ("after", json!(["17"])),
        ("after", json!(["j99999999999999999999999"])),
    ] {
        let mut job = delivery(0);
        job[key] = value;
        let problem = post(at, None, &job).await.unwrap().problem(422);
        assert!(fields(&problem)[0].starts_with(key), "{problem}");
    }
    let mut unknown = delivery(0);
    unknown["colour"] = json!("red");
    let problem = post(at, None, &unknown).await.unwrap().problem(422);
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("colour") && detail.contains("priority"), "it lists what there is: {detail}");
    for broken in ["", "{", "[]", "{\"kind\": \"deliver\"", "{\"kind\": 1e999}", "\u{0}"] {
        let answer = send(at, "POST", "/v1/jobs", &[JSON], broken).await.unwrap();
        assert!([400, 422].contains(&answer.status), "{answer:?}");
        answer.problem(answer.status);
    }
    let big = format!("{{\"kind\": \"{}\"}}", "x".repeat(70_000));
    send(at, "POST", "/v1/jobs", &[JSON], &big).await.unwrap().problem(413);
    send(at, "POST", "/v1/jobs", &[("content-type", "text/plain")], "{}").await.unwrap().problem(415);
    let long = "k".repeat(300);
    post(at, Some(&long), &delivery(0)).await.unwrap().problem(400);
    get(at, "/v1/jobs/j999999").await.problem(404);
    get(at, "/v1/jobs/17").await.problem(404);
    get(at, "/v1/jobs/%ff").await.problem(400);
    get(at, "/v1/nothing").await.problem(404);
    get(at, "/nothing.js").await.problem(404);
    get(at, "/v1/live").await.problem(426);
    let wrong = send(at, "PATCH", "/v1/jobs", &[], "").await.unwrap();
    wrong.problem(405);
    assert!(wrong.header("allow").is_some(), "{wrong:?}");
    assert_eq!(get(at, "/v1/health").await.status, 200);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_key_never_makes_a_second_job() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let first = post(at, Some("order-1"), &delivery(0)).await.unwrap();
    let again = post(at, Some("order-1"), &delivery(0)).await.unwrap();
    assert_eq!((first.status, again.status), (201, 200));
    assert_eq!(first.json()["id"], again.json()["id"]);
    let problem = post(at, Some("order-1"), &delivery(1)).await.unwrap().problem(422);
    assert_eq!(problem["type"], "/problems/key-reused");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_map_is_served_once_and_then_by_its_tag() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let answer = get(at, "/v1/map").await;
    let served = answer.json();
    assert_eq!(served["nodes"].as_array().unwrap().len(), map().nodes.len());
    assert_eq!(served["lanes"][0]["for"].as_array().map(|a| a.is_empty()), Some(false));
    let tag = answer.header("etag").unwrap();
    let again = send(at, "GET", "/v1/map", &[("if-none-match", tag)], "").await.unwrap();
    assert_eq!((again.status, again.text.as_str()), (304, ""));
    let page = get(at, "/").await;
    assert!(page.text.contains("<html") && page.header("content-security-policy").is_some(), "{page:?}");
    assert_eq!(page.header("x-content-type-options"), Some("nosniff"));
    let tag = page.header("etag").unwrap();
    assert_eq!(send(at, "GET", "/", &[("if-none-match", tag)], "").await.unwrap().status, 304);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_with_tokens_answers_only_to_them() {
    let folder = Folder::new();
    let file = folder.path().join("tokens");
    std::fs::write(&file, "# robots' customers\nfirst-token-0123456789\n\nsecond-token-0123456789\n")
        .unwrap();
    let config = Config { tokens: Some(file), ..config(&folder) };
    let server = Server::start(&config, floor()).await.unwrap();
    let at = server.address();
    let answer = get(at, "/v1/jobs").await;
    answer.problem(401);
    assert!(answer.header("www-authenticate").is_some());
    let wrong = [("authorization", "Bearer first-token-012345678")];
    send(at, "GET", "/v1/jobs", &wrong, "").await.unwrap().problem(401);
    send(at, "GET", "/metrics", &[], "").await.unwrap().problem(401);
    let right = [("authorization", "Bearer second-token-0123456789")];
    assert_eq!(send(at, "GET", "/v1/jobs", &right, "").await.unwrap().status, 200);
    assert_eq!(get(at, "/v1/health").await.status, 200, "health is for everyone");
    let foreign = [right[0], ("origin", "https://elsewhere.example")];
    send(at, "GET", "/v1/jobs", &foreign, "").await.unwrap().problem(403);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn figures_count_requests_and_facts() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    post(at, None, &delivery(0)).await.unwrap();
    get(at, "/v1/jobs/j999999").await;
    let text = get(at, "/metrics").await.text;
    for line in [
        "giveway_http_requests_total{method=\"POST\",route=\"/v1/jobs\",status=\"201\"} 1",
        "giveway_http_requests_total{method=\"GET\",route=\"/v1/jobs/{id}\",status=\"404\"} 1",
        "giveway_jobs{state=\"waiting\"}",
        "giveway_step_seconds_count",
        "giveway_journal_lag_seconds_count",
        "# EOF",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_start_that_cannot_be_says_why_and_what_to_do() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let failure =
        async |config: Config| format!("{:#}", Server::start(&config, floor()).await.err().unwrap());
    let usual = config(&folder);
    let taken = failure(Config { listen: server.address().to_string(), ..usual.clone() }).await;
    assert!(taken.contains("--listen") && taken.contains(&server.address().to_string()), "{taken}");
    let twice = failure(usual.clone()).await;
    assert!(twice.contains("in use by another Giveway"), "{twice}");
    let nowhere = failure(Config { database: "/nowhere/at/all.sqlite".into(), ..usual.clone() }).await;
    assert!(nowhere.contains("--database"), "{nowhere}");
    let text = folder.path().join("text");
    std::fs::write(&text, "this is no database, but long enough to look like one".repeat(100)).unwrap();
    let text = failure(Config { database: text, ..usual.clone() }).await;
    assert!(text.contains("not a database"), "{text}");
    server.stop().await.unwrap();
}
