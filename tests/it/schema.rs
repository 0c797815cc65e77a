//! A JSON Schema checker, as much of it as the API's descriptions use; and the check of every answer that any test
//! gets.
//!
//! Main functions: [`faults`], [`check_answer`]. A key that no schema names is a fault, too: descriptions that leave
//! out what is sent are wrong, whatever JSON Schema says. Refuses: keywords that it does not know.

use crate::helper::Answer;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// Keywords that say nothing about values, or that are checked elsewhere.
const WORDS: [&str; 6] = ["description", "example", "examples", "format", "title", "default"];

/// What of a value is not as a schema of this document says, each with where it is.
pub fn faults(document: &Value, schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(document, schema, value, "", &mut found);
    found.extend(unnamed(document, schema, value, ""));
    found
}

fn resolve<'a>(document: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(to) => {
            let pointer = to.strip_prefix('#').expect("references are local");
            resolve(document, document.pointer(pointer).unwrap_or_else(|| panic!("{to} is nowhere")))
        }
        None => schema,
    }
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("type {other} is unknown"),
    }
}

fn fits(document: &Value, schema: &Value, value: &Value) -> bool {
    let mut found = Vec::new();
    check(document, schema, value, "", &mut found);
    found.is_empty()
}

fn check(document: &Value, schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    let schema = resolve(document, schema);
    let Some(keywords) = schema.as_object() else { return };
    let mut fault = |what: String| found.push(format!("{at}: {what}: {}", short(value)));
    for (keyword, rule) in keywords {
        let list = || rule.as_array().expect("a list");
        match keyword.as_str() {
            "type" => {
                let types = rule.as_str().map_or_else(|| list().clone(), |one| vec![one.into()]);
                if !types.iter().any(|t| is_of_type(value, t.as_str().unwrap())) {
                    fault(format!("is not {rule}"));
                }
            }
            "enum" if !list().contains(value) => fault(format!("is none of {rule}")),
            "minimum" if value.as_f64().is_some_and(|v| v < rule.as_f64().unwrap()) => {
                fault("is too small".into())
            }
            "maximum" if value.as_f64().is_some_and(|v| v > rule.as_f64().unwrap()) => {
                fault("is too large".into())
            }
            "minItems" if value.as_array().is_some_and(|v| (v.len() as u64) < rule.as_u64().unwrap()) => {
                fault("is too short".into());
            }
            "maxItems" if value.as_array().is_some_and(|v| v.len() as u64 > rule.as_u64().unwrap()) => {
                fault("is too long".into());
            }
            "maxLength"
                if value.as_str().is_some_and(|v| v.chars().count() as u64 > rule.as_u64().unwrap()) =>
            {
                fault("is too long".into());
            }
            "required" => {
                let lacks = |key: &&Value| value.is_object() && value.get(key.as_str().unwrap()).is_none();
                list().iter().filter(lacks).for_each(|key| fault(format!("lacks {key}")));
            }
            "oneOf" | "anyOf" if !list().iter().any(|s| fits(document, s, value)) => {
                fault(format!("is none of the {} alternatives", list().len()));
            }
            "enum"
            | "minimum"
            | "maximum"
            | "minItems"
            | "maxItems"
            | "minLength"
            | "maxLength"
            | "oneOf"
            | "anyOf"
            | "properties"
            | "items"
            | "allOf"
            | "additionalProperties"
            | "propertyNames"
            | "prefixItems" => {}
            word => assert!(WORDS.contains(&word), "keyword {word} is unknown"),
        }
    }
    parts(document, keywords, value, at, found);
}

/// Checks what is inside a value.
fn parts(document: &Value, schema: &Map<String, Value>, value: &Value, at: &str, found: &mut Vec<String>) {
    for one in schema.get("allOf").and_then(Value::as_array).into_iter().flatten() {
        check(document, one, value, at, found);
    }
    for (key, rule) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        if let Some(inner) = value.get(key) {
            check(document, rule, inner, &format!("{at}/{key}"), found);
        }
    }
    if let (Some(rule), Some(list)) = (schema.get("items").filter(|r| r.is_object()), value.as_array()) {
        for (i, inner) in list.iter().enumerate() {
            check(document, rule, inner, &format!("{at}/{i}"), found);
        }
    }
    if let (Some(rule), Some(map)) =
        (schema.get("additionalProperties").filter(|r| r.is_object()), value.as_object())
    {
        map.iter().for_each(|(key, inner)| check(document, rule, inner, &format!("{at}/{key}"), found));
    }
}

/// The keys that a schema names for this value; false where it takes any.
fn names(document: &Value, schema: &Value, value: &Value, known: &mut BTreeSet<String>) -> bool {
    let schema = resolve(document, schema);
    let own = schema["properties"].as_object();
    known.extend(own.into_iter().flatten().map(|(key, _)| key.clone()));
    let all = schema["allOf"].as_array().into_iter().flatten();
    let any = ["oneOf", "anyOf"].into_iter().filter_map(|word| schema[word].as_array()).flatten();
    let fitting = any.filter(|one| fits(document, one, value));
    let inner: Vec<bool> = all.chain(fitting).map(|one| names(document, one, value, known)).collect();
    (own.is_some() || !inner.is_empty())
        && schema["additionalProperties"].is_null()
        && inner.iter().all(|closed| *closed)
}

/// Keys that no schema names.
fn unnamed(document: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let schema = resolve(document, schema);
    let mut found = Vec::new();
    if let Some(map) = value.as_object() {
        let mut known = BTreeSet::new();
        if names(document, schema, value, &mut known) {
            let strange = map.keys().filter(|key| !known.contains(*key));
            found.extend(strange.map(|key| format!("{at}: nothing is said about {key}")));
        }
    }
    let groups = ["allOf", "oneOf", "anyOf"].into_iter().filter_map(|word| schema[word].as_array()).flatten();
    for one in groups.filter(|one| fits(document, one, value)) {
        // Its own keys were counted above, together with those of the others.
        found.extend(inside(document, resolve(document, one), value, at));
    }
    found.extend(inside(document, schema, value, at));
    found
}

fn inside(document: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let properties = schema["properties"].as_object().into_iter().flatten();
    let of_keys = properties.filter_map(|(key, rule)| Some((key.clone(), rule, value.get(key)?)));
    let items = value.as_array().filter(|_| schema["items"].is_object()).into_iter().flatten();
    let of_items = items.enumerate().map(|(i, inner)| (i.to_string(), &schema["items"], inner));
    of_keys
        .chain(of_items)
        .flat_map(|(key, rule, v)| unnamed(document, rule, v, &format!("{at}/{key}")))
        .collect()
}

fn short(value: &Value) -> String {
    value.to_string().chars().take(200).collect()
}

/// The server's description, once any test has asked for it.
pub static DOCUMENT: OnceLock<Value> = OnceLock::new();

/// Whether a path is one that a template stands for.
fn stands_for(template: &str, path: &str) -> bool {
    let (a, b): (Vec<_>, Vec<_>) = (template.split('/').collect(), path.split('/').collect());
    a.len() == b.len() && a.iter().zip(&b).all(|(t, p)| t.starts_with('{') || t == p)
}

/// Panics where an answer is not what the description says: its status, or its body.
pub fn check_answer(method: &str, path: &str, answer: &Answer) {
    let Some(document) = DOCUMENT.get() else { return };
    let path = path.split('?').next().unwrap_or("");
    let paths = document["paths"].as_object().expect("paths");
    // A path without variables goes before one with.
    let mut fitting: Vec<_> = paths.iter().filter(|(template, _)| stands_for(template, path)).collect();
    fitting.sort_by_key(|(template, _)| template.matches('{').count());
    let Some((template, operations)) = fitting.first() else { return };
    let Some(operation) = operations.get(method.to_lowercase()) else { return };
    let response = &operation["responses"][answer.status.to_string()];
    assert!(response.is_object(), "{method} {template} says nothing about {}: {answer:?}", answer.status);
    let media = answer.header("content-type").unwrap_or("");
    let Some(schema) = response["content"].get(media).map(|content| &content["schema"]) else {
        assert!(
            answer.text.is_empty() || !media.contains("json"),
            "{method} {template} says nothing about {media}"
        );
        return;
    };
    if media.contains("json") {
        let faults = faults(document, schema, &answer.json());
        assert!(faults.is_empty(), "{method} {template}, {}: {faults:#?}", answer.status);
    }
}
