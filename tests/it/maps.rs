//! Maps that are being drawn: checked and tried out over HTTP.

use crate::helper::{Folder, get, map, send, start};
use giveway::warehouse::formats;
use serde_json::{Value, json};

const JSON: (&str, &str) = ("content-type", "application/json");

fn drawn() -> Value {
    serde_json::from_str(&formats::json::write(&map())).unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_is_checked_with_its_findings_in_place() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let check =
        async |map: &Value| send(at, "POST", "/v1/maps:check", &[JSON], &map.to_string()).await.unwrap();
    let good = check(&drawn()).await.json();
    assert_eq!((&good["good"], &good["errors"]), (&json!(true), &json!(0)), "{good}");
    assert_eq!(good["findings"][0]["severity"], "warning", "a broken robot can shut others in: {good}");

    let mut bad = drawn();
    bad["nodes"].as_array_mut().unwrap().push(json!({"id": "island", "x": 90, "y": 91.5}));
    bad["stations"] = json!([]);
    let told = check(&bad).await.json();
    assert_eq!(told["good"], false, "{told}");
    let finding = told["findings"].as_array().unwrap().iter().find(|f| f["place"] == "nodes island").unwrap();
    assert_eq!(finding["at"], json!([[90.0, 91.5]]));
    assert_eq!((&finding["severity"], &finding["nodes"]), (&json!("error"), &json!(["island"])));
    let odd = told["findings"].as_array().unwrap().iter().find(|f| f["severity"] == "warning").unwrap();
    assert_eq!(odd["place"], "stations", "{told}");

    let mut misspelt = drawn();
    misspelt["Nodes"] = json!([]);
    let problem = check(&misspelt).await.problem(422);
    assert!(problem["detail"].as_str().unwrap().contains("unknown field `Nodes`"), "{problem}");
    send(at, "POST", "/v1/maps:check", &[JSON], "{").await.unwrap().problem(400);
    let layout = json!({"metaInformation": {"lifVersion": "1.0.0"}, "layouts": []});
    for path in ["/v1/maps:check", "/v1/map:check"] {
        let refused = send(at, "POST", path, &[JSON], &layout.to_string()).await.unwrap().problem(422);
        assert!(refused["detail"].as_str().unwrap().contains("this is a LIF layout"), "{path}: {refused}");
    }
    send(at, "POST", "/v1/maps:check", &[("content-type", "text/plain")], "{}").await.unwrap().problem(415);
    let long = format!("\"{}\"", "x".repeat(9 * 1024 * 1024));
    if let Ok(answer) = send(at, "POST", "/v1/maps:check", &[JSON], &long).await {
        answer.problem(413);
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_map_of_the_server_comes_as_the_file_it_was_read_from() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let answer = get(server.address(), "/v1/map:file").await;
    assert_eq!(answer.status, 200);
    assert_eq!(answer.json(), drawn());
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_map_is_tried_out_and_what_cannot_be_tried_is_refused_in_words() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let run = async |body: Value| send(at, "POST", "/v1/maps:try", &[JSON], &body.to_string()).await.unwrap();
    let figures = run(json!({"map": drawn(), "robots": 2, "minutes": 3})).await.json();
    assert!(figures["deliveries"].as_u64().unwrap() > 0, "{figures}");
    assert_eq!((&figures["law_violations"], &figures["robots"]), (&json!(0), &json!(2)), "{figures}");
    assert!(figures["mean_job_s"].as_f64().unwrap() > 5.0, "{figures}");

    let words = async |body: Value| run(body).await.problem(422)["detail"].as_str().unwrap().to_owned();
    let many = words(json!({"map": drawn(), "robots": 199, "minutes": 0.5})).await;
    assert!(
        many.contains("robots: map lab: 199 robots, but only") && many.contains("minutes: from 1"),
        "{many}"
    );
    let mut idle = drawn();
    idle["racks"] = json!([]);
    let idle = words(json!({"map": idle, "robots": 1})).await;
    assert!(idle.contains("there must be a station and a rack"), "{idle}");
    let mut bad = drawn();
    bad["lanes"] = json!([]);
    assert!(words(json!({"map": bad, "robots": 1})).await.contains("map: "));
    assert!(words(json!({"map": drawn(), "robots": 0, "jobs_per_hour": 0})).await.contains("jobs_per_hour"));
    server.stop().await.unwrap();
}
