//! Names of people: who sees them, where they are not, and what is left of a person who was erased.

use crate::helper::{Folder, eventually, get, map, start};
use crate::tokens::{ADMIN, start_closed, with};
use futures_util::StreamExt;
use giveway::fleet::{
    AssignmentFact, AssignmentQuery, AssignmentRequest, AssignmentState, Encounter, EncounterFact,
    EncounterQuery, EventQuery, Fact, Reaction, WorkerFact,
};
use giveway::geometry::Spot;
use giveway::id::{AssignmentId, NodeId, RobotId, WorkerId};
use giveway::store::{StepEntry, Store};
use giveway::time::{Span, Time};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::Path;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

const NAME: &str = "Annabella Bergstroem";

async fn register(at: SocketAddr) -> Value {
    let made = with(at, ADMIN, "POST", "/v1/workers", &json!({ "name": NAME }).to_string()).await;
    assert_eq!(made.status, 201, "{made:?}");
    made.json()
}

/// The token of a role, or of the worker's device once the worker is in the picture.
async fn token(at: SocketAddr, role: &str) -> String {
    let subject = (role == "device").then_some("w1");
    let body = json!({"name": role, "role": role, "subject": subject}).to_string();
    let is_made = async || {
        let made = with(at, ADMIN, "POST", "/v1/tokens", &body).await;
        (made.status == 201).then(|| made.json()["token"].as_str().unwrap().to_owned())
    };
    eventually(&format!("there is a token for {role}"), is_made).await
}

async fn name_seen_by(at: SocketAddr, token: &str) -> String {
    let listed = with(at, token, "GET", "/v1/workers", "").await.json();
    let one = with(at, token, "GET", "/v1/workers/w1", "").await.json();
    assert_eq!(listed["items"][0]["name"], one["name"]);
    one["name"].as_str().unwrap().to_owned()
}

/// The first snapshot of the live feed that has the worker.
async fn snapshot(at: SocketAddr) -> String {
    eventually("the live feed has the worker", async || {
        let mut request = format!("ws://{at}/v1/live").into_client_request().unwrap();
        let offer = format!("giveway, bearer.{ADMIN}");
        request.headers_mut().insert("sec-websocket-protocol", offer.parse().unwrap());
        let (mut feed, _) = tokio_tungstenite::connect_async(request).await.unwrap();
        match feed.next().await {
            Some(Ok(Message::Text(text))) if text.contains("\"w1\"") => Some(text.to_string()),
            _ => None,
        }
    })
    .await
}

/// Files below a folder that have these bytes.
fn files_with(folder: &Path, bytes: &str) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_with(&path, bytes));
        } else if std::fs::read(&path).unwrap().windows(bytes.len()).any(|w| w == bytes.as_bytes()) {
            found.push(path.file_name().unwrap().to_string_lossy().into_owned());
        }
    }
    found
}

#[tokio::test(flavor = "multi_thread")]
async fn operators_and_administrators_see_names_and_all_others_a_pseudonym() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    assert_eq!(register(at).await["name"], NAME);
    let again = with(at, ADMIN, "POST", "/v1/workers", &json!({ "name": NAME }).to_string()).await;
    assert_eq!((again.status, &again.json()["id"]), (200, &json!("w1")), "the same name is the same worker");

    for role in ["operator", "device"] {
        assert_eq!(name_seen_by(at, &token(at, role).await).await, NAME, "{role}");
    }
    let viewer = token(at, "viewer").await;
    let pseudonym = name_seen_by(at, &viewer).await;
    assert!(pseudonym.starts_with("worker-") && pseudonym.len() == 11, "{pseudonym}");
    assert_eq!(name_seen_by(at, &token(at, "integrator").await).await, pseudonym);
    with(at, &viewer, "GET", "/v1/people", "").await.problem(403);
    let people = with(at, ADMIN, "GET", "/v1/people", "").await.json();
    let known = &people["items"][0];
    assert_eq!(
        (&known["id"], &known["pseudonym"], &known["name"]),
        (&json!("w1"), &json!(pseudonym), &json!(NAME))
    );

    let floor = snapshot(at).await;
    assert!(
        floor.contains(&pseudonym) && !floor.contains(NAME),
        "the live feed has the pseudonym, for everybody"
    );
    for path in ["/v1/events", "/v1/audit", "/metrics", "/v1/past"] {
        assert!(!with(at, ADMIN, "GET", path, "").await.text.contains(NAME), "{path}");
    }
    server.stop().await.unwrap();

    let server = start_closed(&folder).await;
    assert_eq!(name_seen_by(server.address(), ADMIN).await, NAME, "after a restart");
    assert_eq!(name_seen_by(server.address(), &viewer).await, pseudonym);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_is_left_of_a_person_who_was_erased() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    register(at).await;
    let device = token(at, "device").await;
    let pseudonym = name_seen_by(at, &token(at, "viewer").await).await;
    assert!(!files_with(folder.path(), NAME).is_empty(), "this test can find the name");

    let place = {
        let map = map();
        map.nodes[map.stations.iter().next().unwrap().node].name.clone()
    };
    let task = json!({"place": place, "what": "count", "stay_s": 1}).to_string();
    let task = with(at, ADMIN, "POST", "/v1/workers/w1/assignments", &task).await.json();
    let erase = ("DELETE", "/v1/people/w1");
    let refused = with(at, ADMIN, erase.0, erase.1, "").await.problem(409);
    assert!(refused["detail"].as_str().unwrap().contains("cancel it first"), "{refused}");
    let cancelled =
        with(at, ADMIN, "DELETE", &format!("/v1/assignments/{}", task["id"].as_str().unwrap()), "").await;
    assert!(cancelled.status < 300, "{cancelled:?}");
    let operator = token(at, "operator").await;
    with(at, &operator, erase.0, erase.1, "").await.problem(403);
    with(at, ADMIN, "DELETE", "/v1/people/w9", "").await.problem(404);

    assert_eq!(with(at, ADMIN, erase.0, erase.1, "").await.status, 204);
    with(at, ADMIN, erase.0, erase.1, "").await.problem(404);
    assert_eq!(files_with(folder.path(), NAME), Vec::<String>::new(), "while the server runs");
    with(at, ADMIN, "GET", "/v1/workers/w1", "").await.problem(404);
    assert_eq!(
        with(at, ADMIN, "GET", "/v1/workers", "").await.json()["items"],
        json!([]),
        "the place is free"
    );
    assert_eq!(with(at, ADMIN, "GET", "/v1/people", "").await.json()["items"], json!([]));
    let events = with(at, ADMIN, "GET", "/v1/events", "").await.json();
    assert!(events["items"].as_array().unwrap().iter().all(|e| e["worker"] != "w1"), "{events}");
    let tasks = with(at, ADMIN, "GET", "/v1/assignments", "").await.json();
    assert_eq!(tasks["items"][0]["worker"], Value::Null);
    let audit = with(at, ADMIN, "GET", "/v1/audit", "").await.text;
    assert!(audit.contains("DELETE /v1/people/{id}") && !audit.contains(NAME), "{audit}");
    let ask = async || Some(with(at, &device, "GET", "/v1/workers", "").await).filter(|a| a.status == 401);
    eventually("the token of the device holds no longer", ask).await.problem(401);
    let again = register(at).await;
    assert_eq!(again["id"], "w2", "the same person is another worker from now on");
    server.stop().await.unwrap();
    assert_eq!(files_with(folder.path(), &pseudonym).len(), 1, "the journal has the pseudonym");
}

#[tokio::test(flavor = "multi_thread")]
async fn lists_forget_after_some_days_who_it_was() {
    const DAY: i64 = 24 * 3600 * 1_000_000;
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap().keep_people_days(7);
    let begin = 1_800_000_000_000_000;
    let met = Fact::Encounter(EncounterFact::Met(Encounter {
        worker: WorkerId(0),
        robot: RobotId(0),
        began: Time(begin),
        ended: Time(begin + 1_000_000),
        at: Spot { x_mm: 1250, y_mm: -500 },
        radius_mm: 1400,
        closest_mm: 900,
        robot_mmps: 500,
        worker_mmps: 1200,
        reaction: Reaction::Stopped,
        delay: Span::ZERO,
    }));
    let (id, worker, at) = (AssignmentId(1), WorkerId(0), Time(begin));
    let request = AssignmentRequest { place: NodeId(0), stay: Span::ZERO, what: "count".into(), key: None };
    let done =
        Fact::Assignment(AssignmentFact::Advanced { assignment: id, state: AssignmentState::Done, at });
    let facts = vec![
        Fact::Worker(WorkerFact::Registered { worker, name: "worker-3f2a".into(), at }),
        Fact::Assignment(AssignmentFact::Assigned { assignment: id, worker: Some(worker), request, at }),
        done,
        met,
    ];
    store.append(1, &[StepEntry { at, facts, causes: Vec::new() }]).await.unwrap();
    let who = async || {
        let encounters =
            store.encounters(&EncounterQuery { limit: 9, ..Default::default() }).await.unwrap().rows;
        let tasks =
            store.assignments(&AssignmentQuery { limit: 9, ..Default::default() }).await.unwrap().rows;
        let events = store.events(&EventQuery { after: 0, kinds: Vec::new(), limit: 99 }).await.unwrap();
        (encounters[0].worker(), tasks[0].assignment.worker, events.iter().any(|e| e.worker.is_some()))
    };
    assert_eq!(who().await, (Some(worker), Some(worker), true));
    let later = Time(begin + 6 * DAY);
    store.append(2, &[StepEntry { at: later, facts: Vec::new(), causes: Vec::new() }]).await.unwrap();
    assert_eq!(who().await, (Some(worker), Some(worker), true), "within seven days it is known");
    let later = Time(begin + 7 * DAY + 2_000_000);
    store.append(3, &[StepEntry { at: later, facts: Vec::new(), causes: Vec::new() }]).await.unwrap();
    assert_eq!(who().await, (None, None, false));
    let of_worker = EncounterQuery { worker: Some(worker), limit: 9, ..Default::default() };
    assert_eq!(store.encounters(&of_worker).await.unwrap().rows, [], "nor can it be filtered by");
    store.close().await;
}

/// The names of all properties below a schema, those that it refers to among them.
fn properties(document: &Value, schema: &Value, found: &mut Vec<String>) {
    if let Some(to) = schema["$ref"].as_str() {
        properties(document, document.pointer(&to[1..]).unwrap(), found);
    }
    for (name, of) in schema["properties"].as_object().into_iter().flatten() {
        found.push(name.clone());
        properties(document, of, found);
    }
    for key in ["items", "allOf", "oneOf", "anyOf"] {
        match &schema[key] {
            Value::Array(all) => all.iter().for_each(|one| properties(document, one, found)),
            one => _ = one.is_object().then(|| properties(document, one, found)),
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn no_list_or_table_tells_how_fast_a_person_is_or_where_a_person_is_going() {
    /// Words of pace and of forecasts.
    const TELLING: [&str; 10] =
        ["speed", "pace", "goal", "forecast", "undecided", "elsewhere", "eta", "sequence", "gaze", "idle"];
    /// The speed at an encounter is what a safety engineer needs, and the goal for which robots were replanned what
    /// explains their ways (docs/secure.md): one moment each, of a pseudonym, for days. The speed of a worker's vehicle
    /// is the top speed that it is registered with, not one at which anybody drove.
    const ALLOWED: [&str; 3] =
        ["GET /v1/encounters: worker_speed", "GET /v1/events: goal", "GET /v1/workers: speed_mps"];
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let document = get(at, "/openapi.json").await.json();
    let (mut lists, mut told) = (0, Vec::new());
    for (path, item) in document["paths"].as_object().unwrap() {
        let content = &item["get"]["responses"]["200"]["content"]["application/json"]["schema"];
        let mut names = Vec::new();
        properties(&document, content, &mut names);
        let of_people = names.iter().any(|n| ["worker", "person", "actor"].contains(&n.as_str()))
            || path.starts_with("/v1/workers")
            || path.starts_with("/v1/people");
        if !names.contains(&"items".to_owned()) || !of_people {
            continue;
        }
        lists += 1;
        let telling =
            names.iter().filter(|n| TELLING.iter().any(|t| n.split('_').any(|part| part.starts_with(t))));
        told.extend(telling.filter(|n| *n != "robot_speed").map(|n| format!("GET {path}: {n}")));
    }
    assert!(lists >= 5, "workers, people, assignments, encounters, events: {lists}");
    assert_eq!(told, ALLOWED);
    let table = get(at, "/v1/encounters?format=csv").await.text;
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let telling: Vec<&&str> = header.iter().filter(|c| TELLING.iter().any(|t| c.contains(t))).collect();
    assert_eq!(telling, [&"robot_speed", &"worker_speed"]);
    server.stop().await.unwrap();
}

/// The worker of each assignment in a list, with whether there is a time beside.
fn who_and_when(listed: &Value) -> Vec<(Value, bool)> {
    let items = listed["items"].as_array().unwrap().iter();
    items.map(|a| (a["worker"].clone(), a["created"].is_string() && a["updated"].is_string())).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_but_an_administrator_is_told_of_an_assignment_that_is_over_both_who_had_it_and_when() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    register(at).await;
    let place = {
        let map = map();
        map.nodes[map.stations.iter().next().unwrap().node].name.clone()
    };
    let task = json!({"place": place, "what": "count", "stay_s": 1}).to_string();
    for _ in 0..2 {
        assert_eq!(with(at, ADMIN, "POST", "/v1/workers/w1/assignments", &task).await.status, 201);
    }
    let done = with(at, ADMIN, "POST", "/v1/assignments/a1/done", "").await;
    assert_eq!((done.status, &done.json()["worker"]), (200, &json!("w1")));
    let device = token(at, "device").await;
    for role in ["viewer", "operator", "integrator"] {
        let token = token(at, role).await;
        let all = with(at, &token, "GET", "/v1/assignments", "").await.json();
        assert_eq!(
            who_and_when(&all),
            [(json!("w1"), true), (Value::Null, true)],
            "{role}: a2 is open, a1 is over"
        );
        assert_eq!(
            with(at, &token, "GET", "/v1/assignments/a1", "").await.json()["worker"],
            Value::Null,
            "{role}"
        );
        let of_worker = "/v1/workers/w1/assignments";
        let own = with(at, &token, "GET", of_worker, "").await.json();
        assert_eq!(
            (own["items"].as_array().unwrap().len(), &own["items"][0]["id"]),
            (1, &json!("a2")),
            "{role}"
        );
        for state in ["done", "cancelled", "waiting,done"] {
            let refused =
                with(at, &token, "GET", &format!("{of_worker}?state={state}"), "").await.problem(403);
            assert!(refused["detail"].as_str().unwrap().contains("administrators"), "{role}: {refused}");
        }
        let probe = format!("{of_worker}?updated_since=2020-01-01T00:00:00Z");
        let probed = with(at, &token, "GET", &probe, "").await.json();
        assert_eq!(probed["items"].as_array().unwrap().len(), 1, "{role}: filters find nothing else");
        let events = with(at, &token, "GET", "/v1/events?kind=assignment", "").await.json();
        let events = events["items"].as_array().unwrap();
        assert!(events.len() >= 3 && events.iter().all(|e| e["worker"].is_null()), "{role}: {events:?}");
    }
    let all = with(at, ADMIN, "GET", "/v1/workers/w1/assignments", "").await.json();
    assert_eq!(who_and_when(&all), [(json!("w1"), true), (json!("w1"), true)]);
    let own = with(at, &device, "GET", "/v1/workers/w1/assignments?state=done", "").await.json();
    assert_eq!(who_and_when(&own), [(json!("w1"), true)], "a person's own");
    server.stop().await.unwrap();
}
