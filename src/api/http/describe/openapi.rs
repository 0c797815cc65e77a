//! `/openapi.json`: the descriptions of the routes, completed with what is true of all of them.
//!
//! Main function: [`described`]. The layers around the routes answer, too (a missing token, a body that is no JSON, a
//! panic); their answers are written here, once, and added to each operation that they concern. Refuses: to describe
//! routes that do not exist; routes and their descriptions are registered together.

use crate::access::roles::{Access, access_of};
use crate::wire::error::Problem;
use crate::wire::extract::BODY_LIMIT;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use utoipa::OpenApi;
use utoipa::openapi::OpenApi as Document;

/// Methods of requests that change something.
const WRITES: [&str; 4] = ["post", "put", "patch", "delete"];

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Giveway",
        description = "A warehouse fleet manager in which robots give way to people. Giveway is an \
        efficiency layer, not a safety function: detection, braking and emergency stop are the robots' own. \
        Ids are the names of the map; jobs are \"j17\", workers \"w1\", \
        assignments \"a3\", closed areas \"c2\". Errors are application/problem+json (RFC 9457) and say \
        what to do. A job is acknowledged only when it is durable: an answer 201 survives loss of power. The live \
        feed is a WebSocket at /v1/live, headsets talk to /v1/workers/{id}/feed; /asyncapi.json describes their \
        messages. /docs shows both descriptions as a page. Each operation says which role it needs."
    ),
    components(schemas(Problem)),
    tags(
        (name = "jobs", description = "What customers want: submit, list, change, cancel."),
        (name = "floor", description = "The map, and what is on it: robots, racks, stations, and why they wait."),
        (name = "people", description = "Workers, what they are to do, closed areas, encounters."),
        (name = "events", description = "What happened, in order, for other systems."),
        (name = "past", description = "What happened: recordings and their figures."),
        (name = "server", description = "Health, alarms, metrics."),
    )
)]
pub struct Description;

/// The document as it is served.
pub fn described(document: &Document) -> Value {
    let mut document = serde_json::to_value(document).expect("the description is plain");
    document["info"]["license"] =
        json!({"name": env!("CARGO_PKG_LICENSE"), "identifier": env!("CARGO_PKG_LICENSE")});
    document["servers"] = json!([{"url": "/", "description": "This server"}]);
    document["components"]["securitySchemes"] = json!({"bearer": {
        "type": "http", "scheme": "bearer",
        "description": "One of the server's tokens. Browsers, which cannot set the header on a WebSocket, offer it as \
                        the protocol `bearer.TOKEN` beside `giveway`. A server without tokens listens on the loopback \
                        only and needs none.",
    }, "session": {
        "type": "apiKey", "in": "cookie", "name": "giveway_session",
        "description": "What a browser gets from `POST /v1/session`; where the address has a port, `_PORT` follows the \
                        name. With it, pages of this server alone may change something.",
    }});
    document["security"] = json!([{"bearer": []}, {"session": []}]);
    for (path, item) in members(&mut document["paths"]) {
        for (method, operation) in members(item) {
            complete(path, method, operation);
        }
    }
    require_what_is_always_sent(&mut document);
    document
}

fn members(value: &mut Value) -> impl Iterator<Item = (&String, &mut Value)> {
    value.as_object_mut().into_iter().flatten()
}

/// Adds the answers of the layers, and descriptions for answers that have none.
fn complete(path: &str, method: &str, operation: &mut Value) {
    let access = access_of(&method.to_uppercase(), path).unwrap_or(Access::Administer);
    let needed = access.words();
    match &needed {
        None => operation["security"] = json!([{}, {"bearer": []}, {"session": []}]),
        Some(words) => tell_roles(access, words, operation),
    }
    let has_parameters = operation["parameters"].as_array().is_some_and(|list| !list.is_empty());
    let has_body = operation.get("requestBody").is_some();
    if has_body {
        operation["requestBody"]["required"] = true.into();
    }
    let writes = WRITES.contains(&method);
    let mut statuses = vec![403, 500];
    statuses.extend(needed.is_some().then_some(401));
    statuses.extend(if has_parameters || has_body { &[400, 422][..] } else { &[] });
    statuses.extend(path.contains('{').then_some(404));
    statuses.extend(if has_body { &[408, 413, 415][..] } else { &[] });
    statuses.extend(writes.then_some(409));
    // Until the journal is loaded, while the database does not answer, and if too many ask.
    statuses.extend(path.starts_with("/v1/").then_some(503));
    let responses = operation["responses"].as_object_mut().expect("every operation has responses");
    if let Some(words) = &needed {
        let words = format!("The role {words} is needed, or the request is from a foreign page or host name");
        responses.insert("403".into(), json!({"description": words}));
    }
    for status in statuses {
        responses.entry(status.to_string()).or_insert_with(|| json!({}));
    }
    for (status, response) in responses {
        finish(status, response);
    }
}

/// Names the roles that may call an operation: in words for people, and as `x-roles` for programs; `x-own` is whether a
/// device may call it for its own worker or robot.
fn tell_roles(access: Access, words: &str, operation: &mut Value) {
    let before = operation["description"].as_str().map_or(String::new(), |text| format!("{text}\n\n"));
    operation["description"] = format!("{before}Needs the role {words}.").into();
    operation["x-roles"] = json!(access.roles());
    operation["x-own"] = access.is_for_own().into();
}

/// Completes a response: description, content and headers. The content of an error is a problem (RFC 9457) unless the
/// handler describes another one.
fn finish(status: &str, response: &mut Value) {
    if response["description"].as_str().is_none_or(str::is_empty) {
        response["description"] = usual_words(status).into();
    }
    if status >= "400" && response.get("content").is_none() {
        response["content"] =
            json!({"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}});
    }
    for (media, content) in response.get_mut("content").into_iter().flat_map(members) {
        if !media.contains("json") && !media.starts_with("text/") && !media.contains("text;") {
            content["schema"] = json!({"type": "string", "format": "binary"});
        }
    }
    let (name, words, schema) = match status {
        "429" | "503" => {
            ("Retry-After", "Seconds after which a retry makes sense", json!({"type": "integer"}))
        }
        "401" => ("WWW-Authenticate", "`Bearer`", json!({"type": "string"})),
        _ => return,
    };
    let headers = response.as_object_mut().expect("responses are objects").entry("headers");
    headers.or_insert_with(|| json!({}))[name] = json!({"description": words, "schema": schema});
}

/// The description of an answer with this status, where the handler gives none.
fn usual_words(status: &str) -> String {
    match status {
        "200" => "What was asked for".into(),
        "400" => {
            "The request cannot be read: its body is no JSON, or a parameter is not what it should be".into()
        }
        "401" => "A token is needed".into(),
        "403" => "Requests of foreign pages, or under a foreign host name, are refused".into(),
        "404" => "There is no such thing".into(),
        "408" => "The body did not come in time".into(),
        "409" => "Not in this state, or a recording is shown; `detail` says what to do".into(),
        "413" => format!("The body is longer than {BODY_LIMIT} bytes"),
        "415" => "The body is not sent as `application/json`".into(),
        "422" => "Some fields are wrong; `errors` names them".into(),
        "429" => "A limit is reached; see Retry-After".into(),
        "500" => "An internal error, which was logged; nothing that was acknowledged is lost".into(),
        "503" => "Temporarily unavailable; see Retry-After".into(),
        _ => "An error; `detail` says what to do".into(),
    }
}

/// Marks nullable fields as required, except in request bodies: answers contain such a field even when it is null.
/// Fields that answers may leave out are neither required nor nullable.
fn require_what_is_always_sent(document: &mut Value) {
    let mut asked = BTreeSet::new();
    for (_, item) in document["paths"].as_object().into_iter().flatten() {
        for (_, operation) in item.as_object().into_iter().flatten() {
            reach(document, &operation["requestBody"], &mut asked);
        }
    }
    for (name, schema) in members(&mut document["components"]["schemas"]) {
        if !asked.contains(name) {
            require_nullable(schema);
        }
    }
}

/// Adds the names of all schemas that a part of the document refers to.
fn reach(document: &Value, part: &Value, found: &mut BTreeSet<String>) {
    match part {
        Value::Object(map) => {
            let target = map.get("$ref").and_then(Value::as_str);
            if let Some(name) = target.and_then(|r| r.strip_prefix("#/components/schemas/"))
                && found.insert(name.into())
            {
                reach(document, &document["components"]["schemas"][name], found);
            }
            map.values().for_each(|value| reach(document, value, found));
        }
        Value::Array(list) => list.iter().for_each(|value| reach(document, value, found)),
        _ => {}
    }
}

/// Makes every nullable property required.
pub fn require_nullable(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            require_here(map);
            map.values_mut().for_each(require_nullable);
        }
        Value::Array(list) => list.iter_mut().for_each(require_nullable),
        _ => {}
    }
}

fn require_here(map: &mut Map<String, Value>) {
    let Some(properties) = map.get("properties").and_then(Value::as_object) else { return };
    let nullable = properties.iter().filter(|(_, schema)| may_be_null(schema)).map(|(name, _)| name.clone());
    let had = map.get("required").and_then(Value::as_array).into_iter().flatten();
    let names: BTreeSet<String> =
        had.filter_map(|name| Some(name.as_str()?.to_owned())).chain(nullable).collect();
    if !names.is_empty() {
        map.insert("required".into(), json!(names));
    }
}

fn may_be_null(schema: &Value) -> bool {
    let is_null = |value: &Value| value == "null";
    schema["type"].as_array().is_some_and(|types| types.iter().any(is_null))
        || schema["oneOf"].as_array().is_some_and(|any| any.iter().any(|s| is_null(&s["type"])))
}
