//! Inside a module imports go one way: what a file builds on never builds on it. Re-exports and tests do not count.
//! Inside the fleet calls of methods count as well, where their names say which file declares them.

use crate::all_sources;
use crate::members::{absolute, place};
use crate::rooms::{calls, declared_once};
use crate::tokens::{Token, paths, tokens, without_tests};
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use std::collections::BTreeMap;

/// Modules inside which imports go one way. In the others a folder's file and those inside it still share types.
const ONE_WAY: [&str; 5] = ["aware", "fleet", "history", "sim", "api"];

/// Leaves out what a folder shows of its inside.
fn without_exports<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut kept: Vec<Token<'a>> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let after = if tokens.get(i + 1).is_some_and(|t| t.text == "(") { i + 5 } else { i + 1 };
        let shown = (after.saturating_sub(1)..=after)
            .any(|j| tokens[i].text == "pub" && tokens.get(j).is_some_and(|t| t.text == "use"));
        if shown {
            i = (i..tokens.len()).find(|j| tokens[*j].text == ";").map_or(tokens.len(), |j| j + 1);
        } else {
            kept.push(tokens[i]);
            i += 1;
        }
    }
    kept
}

/// The circles of imports among files of one top module: those of each circle, sorted.
fn circles(top: &str, files: &[(String, String)]) -> Vec<Vec<String>> {
    let once = if top == "fleet" { declared_once(files, "src/fleet/") } else { BTreeMap::new() };
    let inside = |path: &str| place(path).first() == Some(&top) && !path.contains("/tests");
    let files: Vec<&(String, String)> = files.iter().filter(|(path, _)| inside(path)).collect();
    let modules: BTreeMap<Vec<&str>, usize> =
        files.iter().enumerate().map(|(i, (path, _))| (place(path), i)).collect();
    let mut graph = DiGraph::<usize, ()>::new();
    (0..files.len()).for_each(|i| _ = graph.add_node(i));
    for (i, (path, text)) in files.iter().enumerate() {
        let tokens = tokens(text);
        let code = without_exports(&without_tests(&tokens));
        // `pub(in crate::feed)` names a module and takes nothing from it.
        for (_, segments) in paths(&code).into_iter().filter(|(_, segments)| segments.len() > 1) {
            let at = place(path);
            // A path that begins where the file stands leads below it, one through `super` also to what is above.
            let (to, least) = match segments[0] {
                "self" => ([&at, &segments[1..]].concat(), at.len() + 1),
                "super" => (absolute(path, &segments).expect("it begins in the tree"), 0),
                _ => match absolute(path, &segments) {
                    Some(to) => (to, 1),
                    None => ([&at, &segments[..]].concat(), at.len() + 1),
                },
            };
            // The deepest module that has a file; the rest of the path is what is taken from it.
            let named = (least..=to.len()).rev().find_map(|n| modules.get(&to[..n]));
            let edge = |other: &usize| graph.update_edge(NodeIndex::new(i), NodeIndex::new(*other), ());
            named.filter(|other| **other != i).map(edge);
        }
        for (_, name) in calls(&code) {
            let other = once.get(name).and_then(|path| modules.get(&place(path)));
            if let Some(other) = other.filter(|other| **other != i) {
                graph.update_edge(NodeIndex::new(i), NodeIndex::new(*other), ());
            }
        }
    }
    let name = |i: &NodeIndex| files[i.index()].0.clone();
    let mut found: Vec<Vec<String>> =
        tarjan_scc(&graph).iter().filter(|c| c.len() > 1).map(|c| c.iter().map(name).collect()).collect();
    found.iter_mut().for_each(|circle| circle.sort());
    found.sort();
    found
}

#[test]
fn no_files_of_a_module_import_one_another_in_a_circle() {
    let files = all_sources();
    let found: Vec<Vec<String>> = ONE_WAY.iter().flat_map(|top| circles(top, &files)).collect();
    assert!(found.is_empty(), "{} circles:\n{found:#?}", found.len());
}

#[test]
fn a_circle_of_imports_is_found_wherever_it_is_closed() {
    let file = |path: &str, body: &str| (format!("src/api/{path}.rs"), body.to_owned());
    let circle = [
        file("lib", "pub use a::A;\npub(crate) use c::C;\nmod a;\n"),
        file("a", "use super::b::{self, B};\n"),
        file("b/mod", "mod inner;\nfn f() { crate::c::C.g() }\n"),
        file("b/inner", "use super::super::c::C;\n"),
        file("c", "use crate::{a::A, x::Y};\n"),
    ];
    assert_eq!(circles("api", &circle), [["src/api/a.rs", "src/api/b/mod.rs", "src/api/c.rs"]]);
    let open =
        [&circle[..4], &[file("c", "#[cfg(test)]\nmod tests {\n    use super::super::a::A;\n}\n")]].concat();
    assert_eq!(circles("api", &open), [[""; 0]; 0]);
    let through_the_top = [file("lib", "use a::A;\npub struct Api(A);\n"), file("a", "use super::Api;\n")];
    assert_eq!(circles("api", &through_the_top), [["src/api/a.rs", "src/api/lib.rs"]]);
}

#[test]
fn a_circle_that_methods_close_is_found_inside_the_fleet() {
    let file = |path: &str, body: &str| (format!("src/fleet/{path}.rs"), body.to_owned());
    let files = [
        file("a/one", "use crate::a::two::Two;\nimpl One {\n    fn of_one(self) {}\n}\n"),
        file("a/two", "impl Two {\n    fn f(self, x: X) {\n        x.of_one()\n    }\n}\n"),
    ];
    assert_eq!(circles("fleet", &files), [["src/fleet/a/one.rs", "src/fleet/a/two.rs"]]);
    assert_eq!(circles("fleet", &files[..1]), [[""; 0]; 0]);
}
