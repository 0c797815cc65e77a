//! All interleavings of two to four robots, and of a worker who stands, obeys or walks anywhere, on tiny floors.
//!
//! The real fleet is stepped with robots and a worker that move in steps (`actors.rs`). In each state some of the
//! robots that can move do so, and the others are late: every subset is tried, with every step of the worker. In all
//! states the holds are sound, no two robots were granted the same floor, and no robot touches another. From each state
//! in which no robot can move, and from one in so many of the others, the floor goes on with all robots on time: then
//! all jobs end; or, beside a worker who stands, each robot that has something to do waits only for the worker, who is
//! told something. A worker who walked anywhere then stands, obeys, or leaves: each is tried.
//!
//! This is a bounded check and no proof. Robots drive half a lane in a second, or a part of that before a person. They
//! are late by two seconds or a multiple of that, never break down, and no message is lost. States count as the same if
//! they differ in nothing but times: ages of what the fleet remembers are in six classes, windows count by their order
//! on each node, and forecasts do not count at all. Refuses: faults, restarts, more than one worker.

mod actors;
mod explore;
mod floors;
mod known;
mod world;

use explore::{Exploration, StateBounds, Verdict, replay};
use floors::{FLOORS, Hired, Manner, TinyFloor};
use known::{KNOWN, KnownFailure};

/// The bounds of each run of the tests.
const FEW: StateBounds = StateBounds { states: 120, depth: 40, sample: 12, leaves: false };
const FEW_ALONE: StateBounds = StateBounds { states: 700, depth: 60, sample: 12, leaves: false };
/// The bounds for the table in `docs/robustness.md`.
const MANY: StateBounds = StateBounds { states: 300, depth: 80, sample: 60, leaves: false };
const MANY_ALONE: StateBounds = StateBounds { states: 20_000, depth: 120, sample: 40, leaves: false };

/// All floors, each without a worker or with one of its workers, and whether a failure is known there.
fn all_floors() -> impl Iterator<Item = (TinyFloor, bool)> {
    FLOORS.iter().flat_map(|f| {
        let with = |h: &Hired| (TinyFloor { worker: Some(*h), ..*f }, KNOWN.iter().any(|k| k.is_of(f, h)));
        std::iter::once((*f, false)).chain(f.workers.iter().map(with))
    })
}

fn explored(floor: &TinyFloor, bounds: StateBounds) {
    let found = Exploration::of(floor, bounds);
    assert_eq!(found.failures, Vec::<String>::new(), "{} with {:?}", floor.name, floor.worker);
    assert!(found.states > 2 && found.followed > 0, "{}: {found:?}", floor.name);
}

fn explore_beside(manner: Manner) {
    let is_it = |f: &TinyFloor| f.worker.is_some_and(|h| h.manner == manner);
    let floors = all_floors().filter(|(f, is_known)| is_it(f) && !is_known);
    floors.for_each(|(floor, _)| explored(&floor, FEW));
}

#[test]
fn robots_alone_end_their_jobs_whichever_of_them_are_late() {
    FLOORS.iter().for_each(|floor| explored(floor, FEW_ALONE));
}

#[test]
fn beside_a_worker_who_stands_robots_end_their_jobs_or_wait_for_the_worker_alone() {
    explore_beside(Manner::Stands);
}

#[test]
fn beside_a_worker_who_obeys_now_or_later_robots_end_their_jobs_where_no_failure_is_known() {
    explore_beside(Manner::Obeys);
}

#[test]
fn when_a_worker_who_obeyed_or_walked_anywhere_leaves_robots_end_their_jobs() {
    let moves = |f: &TinyFloor| f.worker.is_some_and(|h| h.manner != Manner::Stands);
    let floors = all_floors().filter(|(f, _)| moves(f));
    floors.for_each(|(floor, _)| explored(&floor, StateBounds { leaves: true, ..FEW }));
}

#[test]
fn where_the_fleet_is_known_not_to_get_on_it_still_does_not() {
    let is_mended = |known: &&KnownFailure| {
        let floor = FLOORS.iter().find(|f| f.name == known.floor).expect("it is a floor");
        let hired = floor.workers.iter().find(|h| known.is_of(floor, h)).expect("somebody is hired there");
        let verdict = replay(&TinyFloor { worker: Some(*hired), ..*floor }, known.way, known.obeys);
        !matches!(verdict, Verdict::Stands(_))
    };
    let mended: Vec<String> = KNOWN
        .iter()
        .filter(is_mended)
        .map(|k| format!("{} {:?} {}: {}", k.floor, k.worker, k.way, k.what))
        .collect();
    assert!(mended.is_empty(), "mended: {mended:#?}");
}

#[test]
#[ignore = "explores far more states, for minutes, and prints a table"]
fn states_explored_on_tiny_floors() {
    println!(
        "| floor | robots | worker | states | moves | deepest | all | still | followed | waits | longest, s | fails |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut failures = Vec::new();
    for (floor, is_known) in all_floors() {
        let found = Exploration::of(&floor, if floor.worker.is_some() { MANY } else { MANY_ALONE });
        let whole = if found.is_whole { "yes" } else { "no" };
        println!(
            "| {} | {} | {} | {} | {} | {} | {whole} | {} | {} | {} | {:.0} | {} |",
            floor.name,
            floor.starts.len(),
            floor.worker.map_or("none".to_owned(), |h| h.words()),
            found.states,
            found.moves,
            found.deepest,
            found.still,
            found.followed,
            found.waits,
            found.longest.as_secs_f64(),
            found.failed,
        );
        found.failures.iter().for_each(|f| eprintln!("{} {:?} {f}", floor.name, floor.worker));
        if !is_known {
            failures.extend(found.failures);
        }
    }
    assert_eq!(failures, Vec::<String>::new());
}
