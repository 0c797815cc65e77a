//! The API's descriptions: `/openapi.json` is whole, and `/asyncapi.json` says what WebSockets send.
//!
//! That answers are what the first one says is checked in every test that sends a request (`helper.rs`).

use crate::feed::Headset;
use crate::helper::{Folder, get, send, start, start_in_real_time};
use crate::schema::faults;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// All operations of a document, each with its method and path.
fn operations(document: &Value) -> Vec<(String, &Value)> {
    let paths = document["paths"].as_object().unwrap().iter();
    let mut all = Vec::new();
    for (path, item) in paths {
        all.extend(item.as_object().unwrap().iter().map(|(method, op)| (format!("{method} {path}"), op)));
    }
    all
}

/// Calls for every object in a value.
fn each<'a>(value: &'a Value, look: &mut impl FnMut(&'a serde_json::Map<String, Value>)) {
    match value {
        Value::Object(map) => {
            look(map);
            map.values().for_each(|inner| each(inner, look));
        }
        Value::Array(list) => list.iter().for_each(|inner| each(inner, look)),
        _ => {}
    }
}

fn assert_references_resolve(document: &Value) {
    each(document, &mut |map| {
        if let Some(to) = map.get("$ref").and_then(Value::as_str) {
            let target = to.strip_prefix('#').and_then(|pointer| document.pointer(pointer));
            assert!(target.is_some(), "{to} is nowhere");
        }
    });
}

/// How often a text occurs in the sources of the API.
fn count_in_sources(folder: &Path, text: &str) -> usize {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let count = |path: std::path::PathBuf| match path.is_dir() {
        true => count_in_sources(&path, text),
        false => std::fs::read_to_string(&path).unwrap().matches(text).count(),
    };
    entries.map(count).sum()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_openapi_document_is_whole() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let document = get(server.address(), "/openapi.json").await.json();
    server.stop().await.unwrap();
    assert!(document["openapi"].as_str().unwrap().starts_with("3.1."));
    assert!(document["info"]["description"].as_str().unwrap().contains("not a safety function"));
    assert_references_resolve(&document);
    let operations = operations(&document);
    let ids: BTreeSet<&str> = operations.iter().map(|(_, o)| o["operationId"].as_str().unwrap()).collect();
    assert_eq!(ids.len(), operations.len(), "every operation has an id of its own");
    for (name, operation) in &operations {
        assert!(operation["summary"].as_str().is_some_and(|text| !text.is_empty()), "{name} has no summary");
        for (status, response) in operation["responses"].as_object().unwrap() {
            let words = response["description"].as_str().unwrap_or("");
            assert!(!words.is_empty(), "{name} has no words for {status}");
            let is_problem = response["content"].get("application/problem+json").is_some();
            assert_eq!(is_problem, status.as_str() >= "400", "{name}, {status}");
        }
        let mut due = vec!["403", "500"];
        let variables = name.matches('{').count();
        let parameters = operation["parameters"].as_array().map_or(&[][..], Vec::as_slice);
        let in_path = parameters.iter().filter(|p| p["in"] == "path").count();
        assert_eq!(in_path, variables, "the variables of {name}");
        due.extend((!parameters.is_empty()).then_some("400"));
        let is_open = operation["x-roles"].as_array().is_none_or(Vec::is_empty);
        let may_be_open = name.contains("/v1/health")
            || name.contains("/v1/session/oidc")
            || ["post /v1/session", "delete /v1/session"].contains(&&**name);
        assert_eq!(is_open, may_be_open, "{name} says which role it needs");
        due.extend((!is_open).then_some("401"));
        if operation["requestBody"].is_object() {
            due.extend(["400", "413", "415", "422"]);
        }
        if !name.starts_with("get ") {
            due.extend(["409", "503"]);
        }
        let lacks: Vec<_> = due.into_iter().filter(|s| operation["responses"].get(s).is_none()).collect();
        assert!(lacks.is_empty(), "{name} lacks {lacks:?}");
    }
    // Only the descriptions themselves may be routes without a description.
    let api = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/api");
    assert_eq!(count_in_sources(&api, "#[utoipa::path("), operations.len());
    let routes = include_str!("../../src/api/http/mod.rs");
    let undescribed: Vec<_> =
        routes.split(".route(\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(undescribed, ["/openapi.json", "/asyncapi.json"]);
    assert_eq!(routes.matches(".route(").count(), undescribed.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_word_has_one_schema_and_examples_are_what_their_schemas_say() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let document = get(server.address(), "/openapi.json").await.json();
    server.stop().await.unwrap();
    let schemas = document["components"]["schemas"].as_object().unwrap();
    let mut enums = BTreeSet::new();
    for (name, schema) in schemas {
        if let Some(words) = schema["enum"].as_array() {
            assert!(
                enums.insert(schema["enum"].to_string()),
                "{name} has the words of another schema: {words:?}"
            );
        }
        each(schema, &mut |part| {
            if let Some(example) = part.get("example") {
                let rules = Value::Object(part.clone());
                let wrong = faults(&document, &rules, example);
                assert!(wrong.is_empty(), "an example of {name}: {wrong:?}");
            }
        });
        // A field that takes a few words says which.
        for (field, rules) in schema["properties"].as_object().into_iter().flatten() {
            let is_text = rules["type"] == "string" && rules.get("enum").is_none();
            let closed = ["state", "severity", "effect", "presence", "reaction", "binds", "doing", "fault"];
            assert!(!is_text || !closed.contains(&field.as_str()), "{name}.{field} has no list of words");
        }
    }
    assert!(enums.len() > 15, "{}", enums.len());
}

/// The payload of the message of an AsyncAPI document that has this type, as a schema.
fn payload<'a>(document: &'a Value, channel: &str, word: &str) -> &'a Value {
    let messages = document["channels"][channel]["messages"].as_object().unwrap().values();
    let target =
        |r: &Value| document.pointer(r["$ref"].as_str().unwrap().strip_prefix('#').unwrap()).unwrap();
    let is_it = |message: &&Value| {
        let mut found = false;
        each(&message["payload"], &mut |part| {
            found |= part.get("type").is_some_and(|t| t["enum"] == json!([word]));
        });
        found
    };
    let mut fitting = messages.map(target).filter(is_it);
    &fitting.next().unwrap_or_else(|| panic!("{channel} has no message {word}"))["payload"]
}

#[track_caller]
fn assert_described(document: &Value, channel: &str, message: &Value) {
    let schema = payload(document, channel, message["type"].as_str().unwrap());
    let wrong = faults(document, schema, message);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn web_sockets_send_what_the_asyncapi_document_says() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let document = get(at, "/asyncapi.json").await.json();
    assert_eq!(document["asyncapi"], "3.0.0");
    assert_references_resolve(&document);
    let paths = get(at, "/openapi.json").await.json()["paths"].clone();
    for channel in document["channels"].as_object().unwrap().values() {
        let address = channel["address"].as_str().unwrap();
        assert!(paths[address]["get"]["responses"].get("101").is_some(), "{address} is a WebSocket");
    }
    crate::feed::hire(at, "anna").await;
    crate::helper::post(at, None, &crate::helper::delivery(0)).await.unwrap();
    let mut headset = Headset::open(at, "w1").await.unwrap();
    headset.say(json!({"type": "hello", "versions": [1, 2], "frame": "device"})).await;
    headset.next("clock").await;
    let place = |x: f64| json!({"device": [x, 1.0, 0.0], "map": [x, 0.0]});
    headset.say(json!({"type": "anchors", "pairs": [place(0.0)]})).await;
    headset.say(json!({"type": "anchors", "pairs": [place(0.0), place(2.0)]})).await;
    headset.say(json!({"type": "reset"})).await;
    headset.say(json!({"type": "done", "assignment": "a9"})).await;
    headset.say(json!({"type": "jump"})).await;
    let mut heard = BTreeSet::new();
    for _ in 0..40 {
        let message = headset.any().await.unwrap();
        assert_described(&document, "workerFeed", &message);
        heard.insert(message["type"].as_str().unwrap().to_owned());
    }
    for word in ["aligned", "refused", "epoch", "done", "warning", "guidance"] {
        assert!(heard.contains(word), "{word} is not among {heard:?}");
    }
    for query in ["?senses=true", "?thin=true"] {
        let mut live = crate::live::connect(at, query, "").await.unwrap();
        let mut words = BTreeSet::new();
        for _ in 0..30 {
            let message = crate::live::next(&mut live).await.unwrap();
            assert_described(&document, "live", &message);
            words.insert(message["type"].as_str().unwrap().to_owned());
        }
        assert!(words.contains("snapshot") && words.contains("patch"), "{words:?}");
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn answers_of_all_lists_are_as_described() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let document = get(at, "/openapi.json").await.json();
    let json = [("content-type", "application/json")];
    crate::helper::post(at, None, &crate::helper::delivery(0)).await.unwrap();
    crate::feed::hire(at, "anna").await;
    let area = json!({"outline": [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]], "reason": "wet"});
    send(at, "POST", "/v1/closures", &json, &area.to_string()).await.unwrap();
    let known = |path: &str| match path.split('/').nth(2) {
        Some("jobs") => "j1",
        Some("workers") => "w1",
        Some("robots") => "robot-1",
        Some("closures") => "c1",
        _ => "x",
    };
    let mut asked = 0;
    for path in document["paths"].as_object().unwrap().iter().filter(|(_, item)| item["get"].is_object()) {
        let query = match path.0.as_str() {
            "/v1/timelines" => "?x0=0&y0=0&x1=3&y1=3",
            "/v1/heat" => "?kind=waiting",
            _ => "",
        };
        // The helper compares the answer with the description.
        let answer = get(at, &(path.0.replace("{id}", known(path.0)) + query)).await;
        asked += usize::from(answer.status == 200);
    }
    assert!(asked > 25, "{asked} lists and things were answered");
    server.stop().await.unwrap();
}
