//! `/asyncapi.json`: the messages of the WebSockets, as AsyncAPI 3.0.
//!
//! Main function: [`messages`]. Rows and messages are described by the types that are sent and read; patches of the
//! live feed are derived from the rows that they change. Refuses: to describe a row twice.

use super::openapi::require_nullable;
use crate::dto::alarms::AlarmRowDto;
use crate::dto::names::{CountersDto, JobCountsDto, RackDto, RobotDto, StationDto};
use crate::dto::people::{ClosureDto, SensesDto, WorkerDto};
use crate::feed::massrobotics::InteropReport;
use crate::feed::message::FeedMessage;
use crate::feed::wire::HeadsetMessage;
use crate::live::ForecastDto;
use crate::wire::error::Problem;
use serde_json::{Map, Value, json};
use utoipa::ToSchema;
use utoipa::openapi::{RefOr, Schema};

/// Schemas and messages by name, as they are collected.
#[derive(Default)]
struct Components {
    schemas: Map<String, Value>,
    messages: Map<String, Value>,
}

/// The document as it is served.
pub fn messages() -> Value {
    let mut parts = Components::default();
    let live = parts.live();
    let told = parts.variants::<FeedMessage>("feed");
    let said = parts.variants::<HeadsetMessage>("headset");
    let report = vec![parts.whole::<InteropReport>("interopReport")];
    let refusal = vec![parts.whole::<Problem>("interopProblem")];
    let both = |a: &[String], b: &[String]| channel_messages(a.iter().chain(b));
    json!({
        "asyncapi": "3.0.0",
        "info": {
            "title": "Giveway: WebSockets", "version": env!("CARGO_PKG_VERSION"),
            "description": "The messages of the live feed, of headsets and of MassRobotics devices. All are JSON \
                            texts. Offer the protocol `giveway`, and `bearer.TOKEN` where a token is needed. \
                            /openapi.json describes the rest of the API.",
        },
        "defaultContentType": "application/json",
        "channels": {
            "live": {
                "address": "/v1/live", "messages": channel_messages(live.iter()),
                "description": "The floor, ten times a second: a snapshot, then patches. If the base of a patch is \
                                not the reader's version, connect again.",
            },
            "workerFeed": {
                "address": "/v1/workers/{id}/feed", "messages": both(&told, &said),
                "parameters": {"id": {"description": "The worker, such as w1"}},
                "description": "One headset, phone or gateway: poses in, guidance out.",
            },
            "massrobotics": {
                "address": "/v1/massrobotics", "messages": both(&report, &refusal),
                "description": "Reports of the MassRobotics standard; only refused ones are answered.",
            },
        },
        "operations": {
            "sendLive": operation("send", "live", &live),
            "sendToWorker": operation("send", "workerFeed", &told),
            "receiveFromWorker": operation("receive", "workerFeed", &said),
            "receiveInteropReport": operation("receive", "massrobotics", &report),
            "sendInteropProblem": operation("send", "massrobotics", &refusal),
        },
        "components": {"schemas": parts.schemas, "messages": parts.messages},
    })
}

fn channel_messages<'a>(names: impl Iterator<Item = &'a String>) -> Value {
    names
        .map(|n| (n.clone(), json!({"$ref": format!("#/components/messages/{n}")})))
        .collect::<Map<_, _>>()
        .into()
}

fn operation(action: &str, channel: &str, names: &[String]) -> Value {
    let at = format!("#/channels/{channel}");
    let messages: Vec<_> = names.iter().map(|n| json!({"$ref": format!("{at}/messages/{n}")})).collect();
    json!({"action": action, "channel": {"$ref": at}, "messages": messages})
}

impl Components {
    /// Adds a type's schema, with all schemas that it refers to, and returns a reference to it.
    fn schema<T: ToSchema>(&mut self, sent: bool) -> Value {
        let mut found: Vec<(String, RefOr<Schema>)> = vec![(T::name().into(), T::schema())];
        T::schemas(&mut found);
        for (name, schema) in found {
            let mut schema = json!(schema);
            if sent {
                require_nullable(&mut schema);
            }
            self.schemas.entry(name).or_insert(schema);
        }
        json!({"$ref": format!("#/components/schemas/{}", T::name())})
    }

    fn message(&mut self, name: String, words: &str, payload: Value) -> String {
        let message = json!({"name": name, "summary": words, "payload": payload});
        self.messages.insert(name.clone(), message);
        name
    }

    /// Adds a message that has one type.
    fn whole<T: ToSchema>(&mut self, name: &str) -> String {
        let payload = self.schema::<T>(false);
        self.message(name.into(), "", payload)
    }

    /// Adds one message for each variant of an enum with a `type` field.
    fn variants<T: ToSchema>(&mut self, of: &str) -> Vec<String> {
        self.schema::<T>(of == "feed");
        let whole = self.schemas.remove(&*T::name()).unwrap_or_default();
        let variants = whole["oneOf"].as_array().cloned().unwrap_or_default();
        let message = |payload: Value| {
            let word = type_of(&payload).expect("every variant has its type").to_owned();
            let words = payload["description"].as_str().unwrap_or("").to_owned();
            let initial = word[..1].to_uppercase();
            self.message(format!("{of}{initial}{}", &word[1..]), &words, payload)
        };
        variants.into_iter().map(message).collect()
    }

    /// A row in a patch: only its id and the changed keys are sent.
    fn change<T: ToSchema>(&mut self) -> Value {
        let name = format!("{}Change", T::name().trim_end_matches("Dto"));
        // The row is described by the snapshot, whose schema comes first.
        let mut row = self.schemas[&*T::name()].clone();
        row["required"] = json!(["id"]);
        row["description"] = "The id, and what changed.".into();
        self.schemas.insert(name.clone(), row);
        json!({"$ref": format!("#/components/schemas/{name}")})
    }

    /// The live feed refers to nodes by their index in the map; lists refer to them by name.
    fn nodes_by_index(&mut self) {
        let index = |schema: &mut Value, types: Value| schema["type"] = types;
        index(
            &mut self.schemas[&*RobotDto::<String>::name()]["properties"]["granted"]["items"],
            json!("integer"),
        );
        index(
            &mut self.schemas[&*RobotDto::<String>::name()]["properties"]["held"]["items"],
            json!("integer"),
        );
        index(
            &mut self.schemas[&*RackDto::<String>::name()]["properties"]["node"],
            json!(["integer", "null"]),
        );
    }

    fn live(&mut self) -> Vec<String> {
        let list = |items: Value| json!({"type": "array", "items": items});
        let whole = json!({"type": "integer"});
        let seconds = json!({"type": "number", "description": "Seconds since the server started"});
        let numbers = list(json!({"type": ["integer", "null"]}));
        let rest = [
            ("closures", list(self.schema::<ClosureDto>(true))),
            ("jobs", self.schema::<JobCountsDto>(true)),
            ("counters", self.schema::<CountersDto>(true)),
            ("alarms", list(self.schema::<AlarmRowDto>(true))),
        ];
        let forecasts = ("forecasts", list(self.schema::<ForecastDto>(true)));
        let mut snapshot = vec![
            ("version", whole.clone()),
            ("time_s", seconds.clone()),
            (
                "simulated",
                json!({"type": "boolean", "description": "Whether all robots and people are simulated"}),
            ),
            (
                "speed",
                json!({"type": "integer", "minimum": 1, "description": "Seconds of the floor in a second"}),
            ),
            ("started", json!({"type": "string", "description": "When second 0 of the feed was, RFC 3339"})),
            ("map", json!({"type": "string", "description": "The version of the map, as in GET /v1/map"})),
            ("robots", list(self.schema::<RobotDto>(true))),
            ("racks", list(self.schema::<RackDto>(true))),
            ("stations", list(self.schema::<StationDto>(true))),
            ("workers", list(self.schema::<WorkerDto>(true))),
            forecasts.clone(),
        ];
        snapshot.extend(rest.clone());
        self.nodes_by_index();
        let head = [("base", whole.clone()), ("version", whole), ("time_s", seconds)];
        let rows = [
            ("robots", list(self.change::<RobotDto>())),
            ("racks", list(self.change::<RackDto>())),
            ("stations", list(self.change::<StationDto>())),
            ("workers", list(self.change::<WorkerDto>())),
        ];
        // docs/api.md explains each number.
        let thin = ["moves", "turns", "speeds", "walks"].map(|key| (key, numbers.clone()));
        let thin = thin.into_iter().chain(["ways", "paths", "ahead"].map(|key| (key, list(numbers.clone()))));
        let all = rest.iter().chain(&rows).chain([&forecasts]).cloned().chain(thin);
        let patch = object("patch", &head, &all.collect::<Vec<_>>());
        let senses = self.schema::<SensesDto>(true);
        let worker = json!({"type": "object", "required": ["id"], "properties": {"id": {"type": "string"}}});
        let senses = ("workers", list(json!({"allOf": [worker, senses]})));
        vec![
            self.message("snapshot".into(), "The whole floor", object("snapshot", &snapshot, &[])),
            self.message("patch".into(), "What changed; thin where `thin=true` was asked for", patch),
            self.message("senses".into(), "Gaze, hands and charge", object("senses", &[senses], &[])),
        ]
    }
}

/// The schema of an object with this `type`.
fn object(word: &str, always: &[(&str, Value)], sometimes: &[(&str, Value)]) -> Value {
    let mut properties = Map::from_iter([("type".to_owned(), json!({"type": "string", "enum": [word]}))]);
    properties
        .extend(always.iter().chain(sometimes).map(|(key, schema)| ((*key).to_owned(), schema.clone())));
    let required: Vec<&str> = std::iter::once("type").chain(always.iter().map(|(key, _)| *key)).collect();
    json!({"type": "object", "properties": properties, "required": required})
}

/// The `type` of a variant.
fn type_of(payload: &Value) -> Option<&str> {
    let here = payload["properties"]["type"]["enum"][0].as_str();
    here.or_else(|| payload["allOf"].as_array()?.iter().find_map(type_of))
}
