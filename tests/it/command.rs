//! The program itself, called like from a shell: exit codes, and what it prints where.

use crate::helper::{Folder, map};
use giveway::warehouse::formats;
use std::process::{Command, Output};

/// Runs the program to its end.
fn giveway(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_giveway")).args(arguments).output().unwrap()
}

#[test]
fn map_check_lists_wrong_names_and_a_wrong_floor_at_once() {
    let folder = Folder::new();
    let path = folder.path().join("bad.json");
    let mut bad: serde_json::Value = serde_json::from_str(&formats::json::write(&map())).unwrap();
    let lane = serde_json::json!({"from": bad["nodes"][0]["id"], "to": "nowhere"});
    bad["lanes"].as_array_mut().unwrap().push(lane);
    bad["nodes"].as_array_mut().unwrap().push(serde_json::json!({"id": "island", "x": 90, "y": 90}));
    std::fs::write(&path, bad.to_string()).unwrap();
    let checked = giveway(&["map", "check", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&checked.stderr);
    assert_eq!(checked.status.code(), Some(1), "{said}");
    let findings: Vec<&str> = said.lines().skip(1).collect();
    assert_eq!(findings.len(), 2, "{said}");
    assert!(findings[0].ends_with("there is no node nowhere; add the node or mend the name"), "{said}");
    assert_eq!(findings[1], "nodes island: no lane touches them; add lanes or remove them");
}
