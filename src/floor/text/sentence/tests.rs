//! The list of sentences against its translations, and round trips of sentences.

use super::*;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

fn translations() -> [(&'static str, BTreeMap<String, String>); 3] {
    let read = |text| serde_json::from_str(text).expect("an object of texts by code");
    [
        ("de", read(include_str!("../../../../web/src/language/said/de.json"))),
        ("es", read(include_str!("../../../../web/src/language/said/es.json"))),
        ("zh", read(include_str!("../../../../web/src/language/said/zh.json"))),
    ]
}

fn all() -> impl Iterator<Item = &'static SentenceEntry> {
    SENTENCES.into_iter().flatten()
}

/// The places of a text, each once.
fn places(text: &str) -> BTreeSet<&str> {
    text.split('{').skip(1).filter_map(|rest| Some(rest.split_once('}')?.0)).collect()
}

#[test]
fn every_sentence_is_said_in_every_language_with_the_same_places_and_nothing_else_is() {
    let mut wrong = Vec::new();
    for (language, said) in translations() {
        for entry in all() {
            match said.get(entry.code) {
                None => wrong.push(format!("{language}: {} is missing", entry.code)),
                Some(text) if places(text) != places(entry.english) => {
                    wrong.push(format!("{language}: {} has other places: {text}", entry.code));
                }
                Some(_) => {}
            }
        }
        let strays = said.keys().filter(|code| all().all(|entry| entry.code != **code));
        wrong.extend(strays.map(|code| format!("{language}: nothing is called {code}")));
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn every_code_is_there_once_and_its_english_text_has_all_of_its_places() {
    let codes: BTreeSet<&str> = all().map(|entry| entry.code).collect();
    assert_eq!(codes.len(), all().count());
    for entry in all() {
        assert_eq!(places(entry.english), entry.places.iter().copied().collect(), "{}", entry.code);
    }
}

#[test]
fn a_sentence_travels_with_code_arguments_and_text_and_is_read_again() {
    let rack = reasons::robot_in_trouble("robot-2", reasons::silent());
    let waits = reasons::rack_on("K1", rack);
    assert_eq!(waits.text(), "waits for rack K1, which is on robot-2 (sends no telemetry)");
    let silent = json!({"code": "silent", "args": {}, "text": "sends no telemetry"});
    let trouble = json!({
        "code": "robot_in_trouble", "args": {"robot": "robot-2", "reason": silent},
        "text": "robot-2 (sends no telemetry)",
    });
    let told = json!({"code": "rack_on", "args": {"rack": "K1", "robot": trouble}, "text": waits.text()});
    assert_eq!(serde_json::to_value(&waits).unwrap(), told);
    let near = reasons::off_node(
        SentenceArg::rounded(4.1, 1),
        SentenceArg::rounded(8.0, 1),
        SentenceArg::rounded(0.62, 1),
        "A1",
    );
    assert!(near.text().starts_with("stands at (4.1, 8.0), 0.6 m from the nearest node A1"), "{near}");
    let names: SentenceArg = vec!["robot-1", "robot-2"].into();
    let many = alarms::robots_silent(2, 9, names, SentenceArg::nothing());
    assert_eq!(many.text(), "2 of 9 robots send no reports: robot-1, robot-2.");
    for sentence in [waits, near, many] {
        let again = Sentence::read(&sentence.kept());
        assert_eq!((again.text(), again.code()), (sentence.text(), sentence.code()));
        let args = |s: &Sentence| serde_json::to_value(s).unwrap()["args"].clone();
        assert_eq!(args(&again), args(&sentence));
    }
}

#[test]
fn a_text_of_an_earlier_version_is_a_sentence_without_a_code() {
    let old = "waiting for A12, held by robot-7";
    for sentence in [Sentence::read(old), serde_json::from_value(json!(old)).unwrap()] {
        assert_eq!((sentence.code(), sentence.text(), sentence.kept().as_str()), (None, old, old));
        let told = serde_json::to_value(&sentence).unwrap();
        assert_eq!(told, json!({"code": null, "args": {}, "text": old}));
    }
    assert_eq!(Sentence::read("{odd").text(), "{odd");
    let none: Result<Sentence, _> = serde_json::from_value(Value::Null);
    assert!(none.is_err());
}
