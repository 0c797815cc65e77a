//! Giveway: a warehouse fleet manager in which robots give way to people.
//!
//! Giveway is an efficiency layer and no safety function: detection, braking and emergency stop are the robots' own.
//! This page is the architecture text, the only one. The README gets a stranger to a running simulation; `docs/`
//! answers one question a page.
//!
//! # The picture
//!
//! ```text
//!   time  id  geometry  →  warehouse  →  timeline  →  route  ┐
//!                                           human            ├→  aware            →  fleet
//!   pure: no clock, no I/O, no chance, no hash order ────────┘                         │
//!  ════════════════════════════════════════════════════════════════════════════════════╪══ the line
//!   pure too:   sim (a floor in memory)  →  experiment (tables that others can repeat) │
//!   outside:    store (journal)    api (HTTP, live feed)    vda5050 (to come)          │
//!               └──────────────────┴──────── server (wiring, the clock) ───────────────┘
//!               cli (arguments, files, tables)
//! ```
//!
//! Arrows read "is known by". A module names only modules before it; `store`, `api` and `vda5050` know the core and
//! neither each other nor `sim`; `human` and `route` meet only in `aware`. `tests/walls.rs` enforces this and the
//! purity, and `cargo test --no-default-features` builds everything pure without one crate of the outside.
//!
//! # The code, in reading order
//!
//! - [`time`], [`id`], [`geometry`]: integer microseconds and half-open windows; one newtype per kind of thing; metres
//!   and radians in the map's frame.
//! - [`warehouse`]: the building. Nodes, lanes, racks, stations; which of them get in each other's way; checks that
//!   refuse a map on which robots could get stuck; formats.
//! - [`timeline`]: who holds which resource when, and in which order. Makes [`timeline::Reserved`], the proof that
//!   something is held.
//! - [`route`]: the one search, over free windows.
//! - [`human`]: people as beliefs. Where they are, whether they keep to their path, which goals are theirs, where they
//!   will be when. Every kind of bad sighting has one answer (`human/track.rs`). Forecasts are mixtures whose figures
//!   were learned from recorded people (`human/outlook.rs`, `human/model.rs`) and are judged while the system runs.
//! - [`aware`]: what people mean for robots: conditions on nodes for the search and the grants, regions for speeds,
//!   encounters. There is no second planner.
//! - [`fleet`]: the state machine. `fleet/mod.rs` shows one step on one screen; each phase is a file.
//! - [`history`]: what happened over time, as figures in buckets of bounded number. Nothing is decided by it.
//! - [`sim`]: robots with inertia, radios that lose, customers; laws; recordings; the driver without a server. Pure.
//! - [`experiment`]: benchmark floors and published tables, driven by the same search; recorded people, and what is
//!   learned from them. Pure.
//! - `store`: the journal of steps, snapshots of the ledger, and the lists of jobs, assignments and encounters, in
//!   SQLite.
//! - `api`: HTTP under `/v1`, the live feed, metrics, OpenAPI; wire types are its own. `api/feed` takes the poses of
//!   headsets: frames, clocks and thinning are pure there, and guidance goes out past all queues.
//! - `vda5050/`: to come. Real robots instead of simulated ones, behind the same [`fleet::Command`] and
//!   [`fleet::Telemetry`].
//! - `server`: settings, the only clock, the loop, what waits for the journal.
//! - `cli`: one file per command of the program. `main.rs` calls it and nothing else.
//!
//! # The life of a step
//!
//! Everything happens in [`fleet::Fleet::step`]`(now, inputs)`. The server, the simulator and the tests are three short
//! drivers of it, which differ only in where `now` and the inputs come from and where the results go.
//!
//! 1. **absorb** (`fleet/absorb.rs`): all inputs are taken in before anything is decided. Telemetry goes to the scene,
//!    the newest by the time it was *seen* wins. Requests become facts or refusals.
//! 2. **judge** (`judge.rs`): people are followed along their paths; who is off the path for long deviates, and is
//!    shown a way back (`lead.rs`); intentions are updated (`mind.rs`). Beliefs become conditions on nodes: *closed*
//!    where a person will almost surely walk within seconds, *still* around a person (nobody comes or goes), *slow*
//!    farther out, *dear* where a person may walk. Limits of speed and stops leave at once (`limit.rs`), and so does
//!    what workers are told (`guide.rs`). On a floor without people and closures this phase does nothing.
//! 3. **settle** (`settle.rs`): what has come true? Visits behind a robot are released, a stop that is done leads to
//!    the next task, a late robot's windows slide and those of all who come after it; a broken one keeps its place. A
//!    robot that stands elsewhere is taken up there, or treated as broken (`displaced.rs`).
//! 4. **assign** (`assign.rs`): waiting jobs and idle robots are matched all together at the least sum of costs. Who is
//!    left charges or leaves the floor.
//! 5. **plan** (`plan.rs`): whoever has a task without a route gets a search each, longest waiting first, until the
//!    step's budget of expansions is spent. A route is committed only when it is complete. Then robots whose way leads
//!    into an announced closure get another one (`closing.rs`). Then robots whose holds a worker's windows meet wait,
//!    or change their route where they would wait for long, or leave the worker's path (`yielding.rs`). Then robots
//!    that are held up look for a better way.
//! 6. **grant** (`grant.rs`): each robot may drive as far as it needs to keep its speed, but not past a stop that is
//!    not done, nor past anybody who was promised a resource first. Grants become commands.
//!
//! Every change of durable state is a [`fleet::Fact`], recorded by one function and taken in by one other,
//! [`fleet::Ledger::evolve`], live and on load alike. Facts carry what came out (new times of visits that a delay
//! moved), never what was to be worked out, so a better algorithm cannot rewrite history. The step returns facts,
//! commands and replies. The server writes the facts of a step as one row, whole or not at all, and lets commands
//! and replies go when it is durable; if the database is gone, robots finish what was granted and stand. The
//! journal's task folds what is durable into a ledger of its own and writes that down now and then; steps behind it
//! are deleted. After a restart the ledger is the last one written down and the fold of the steps behind it, and
//! the scene is empty: to the step that is a floor of silent robots, and nothing special.
//!
//! A step that panics is undone: the fleet is folded from the journal again, and the robot at hand is fenced off
//! (`fleet/fence.rs`), that is, taken for failed whatever it says, until a person releases it.
//!
//! # What is not there
//!
//! - Above the line nothing reads a clock, a file, a socket or the environment, starts a thread or takes a lock.
//! - No decision depends on how long anything took: searches are bounded by counted expansions. A stopwatch is passed
//!   in for figures and decides nothing. Same build, same seed, same bytes.
//! - No random number is drawn outside of `sim/random.rs`; no map with a random order is used above the line.
//! - Nothing reacts to a message. Decisions look at state, so repeated, late and reordered messages do no harm.
//! - No code but `Ledger::evolve` changes what was promised; loading facts never plans.
//! - No robot is commanded without a [`timeline::Reserved`], and nobody but [`timeline::Timeline`] makes one. There is
//!   no [`warehouse::Warehouse`] that was not validated.
//! - Types of the core are not serialised: `api` and `store` have wire types of their own.
//! - The [`fleet::View`] is an input to no decision.
//! - Nothing that only *exists* costs a step anything that grows with it: idle robots, waiting jobs that cannot start,
//!   announced closures and open assignments are looked up in indexes, which change when they do.
//! - No hold is given back because its time is over. Times are plans; only what a robot reports frees anything.
//!
//! # Why nobody is ever stuck
//!
//! A *hold* is a visit of one robot on one node (and on the lane that leads there, where that lane needs a timeline),
//! with a window. Three things are true of every set of holds that the timeline accepts:
//!
//! - (a) A robot's holds go on to a place where it may stay for ever, and the last one has no end. So nothing is ever
//!   ordered behind a robot's last hold, and a robot that has reached it is in nobody's way. A new route that does not
//!   get that far is not committed; the old one stands.
//! - (b) Holds of different robots on one resource, or on two in conflict, do not overlap. So on every resource they
//!   have an order, and grants follow that order, not the clock.
//! - (c) A robot's hold on a node outlasts, by a strictly positive clearance, its arrival at the next node.
//!
//! Now let robot A wait for a hold `v`, that is, `v` is the next in A's route and somebody is before it in the order of
//! its resource: B with hold `u`. Then `u` ends before `v` starts (b). B gives `u` back when it has arrived at its own
//! next hold `u'`, which exists, since `u` has an end (a). And `u'` starts no later than B arrives there, which is
//! before `u` ends (c). Together:
//!
//! ```text
//! start(u')  ≤  arrival at u'  <  end(u)  ≤  start(v)
//! ```
//!
//! The start of each hold is strictly later than the start of the hold that must be granted before it. The same holds
//! within a route, where visits follow one another. So starts are a potential: what waits for what has no cycle, and
//! the ungranted hold with the earliest start waits for nobody; its robot gets it as soon as it is done where it
//! stands. With zero clearance a ring of robots could turn on the spot with all starts equal: that is what (c) forbids.
//!
//! The argument looks at a picture of holds, not at how it came about. So it survives all that keeps the picture:
//!
//! - *Delays* slide windows and keep every order (`timeline/delay.rs`): a follower starts later by what it must.
//! - *Granting early* moves the start of a hold that nobody is before any more, so no inequality is lost.
//! - *A better way* (`plan.rs`, `improve`) is searched in the free windows of what all others hold, so it fits into the
//!   picture, and the order of all stays free of cycles, although the robot may come before others now.
//! - *A broken robot* keeps what it was granted without end. Whoever has to pass it, and whoever would have to pass
//!   those, loses what was not granted yet (`fleet/cut.rs`) and is routed anew.
//! - *A robot that was pushed elsewhere* (`fleet/displaced.rs`) holds one place without end, which nobody was granted;
//!   those who were promised it, and those behind them, lose what was not granted yet, as with a broken one.
//! - *A robot that was called back* (`fleet/recall.rs`) only holds again what it had been granted. It is first in the
//!   order of all that, and nobody can come before a hold that began in the past, so it waits for nobody there.
//!
//! *People* are outside of the argument on purpose. A worker holds nothing in the timeline: a grant that would meet
//! a condition waits, which is a delay like any other, and the order of robots stays as it is. What can be stuck is a
//! robot and a person who wait for one another. A robot on a person's path leaves it; one that stood for a person for
//! long is called back and leaves by another way; a person whose path is blocked is led round, or to a place aside,
//! and is told to stop only where nothing else is left.
//!
//! One thing must be true of the floor for (a) to be possible at all: every place can be reached without crossing a
//! place where somebody may stay for ever. `warehouse/check/floor.rs` refuses maps where that is not so.
//!
//! # Where do I change …
//!
//! | what | where |
//! |---|---|
//! | how fast robots drive, turn, lift | `route/motion.rs`; for one scenario its `fleet` |
//! | a kind of job | `fleet/job.rs`, `fact.rs` (`Task`), `settle.rs`, `plan.rs` (`stages`); `api/http/jobs.rs` |
//! | which robot gets which job | `fleet/assign.rs` |
//! | where racks are put, where robots rest | `fleet/storage.rs` |
//! | what may happen to a job, and what its robot does meanwhile | `fleet/life.rs`; cancelling: `fleet/absorb.rs` |
//! | when robots charge, which one leaves a charger | `fleet/charging.rs` |
//! | when a pick ends, a station that is paused | `fleet/station.rs`; `api/http/stations.rs` |
//! | which waiting job comes first | `fleet/index/queue.rs` (`urgency_ms`); jobs before jobs: `fleet/index/waits.rs` |
//! | what is looked up instead of searched | `fleet/index/`; kept by `Ledger::evolve`, compared by the laws |
//! | how many of anything there may be | `fleet/mod.rs` (`Settings`), `docs/operate.md` |
//! | when a robot is planned, and how often again | `fleet/plan.rs` |
//! | the search, its order, its bounds | `route/search.rs`, `route/label.rs`, `route/estimate.rs` |
//! | how far ahead robots are granted | `fleet/grant.rs` |
//! | what happens when robots are late, or break down | `fleet/settle.rs`, `timeline/delay.rs`; `fleet/cut.rs` |
//! | what happens to robots that people pushed elsewhere | `fleet/displaced.rs`; in words: `api/displaced.rs` |
//! | the map format | `warehouse/formats/json.rs` and `maps/map.schema.json`; `tests/maps.rs` compares them |
//! | which maps are refused | `warehouse/check/` |
//! | where people walk | `warehouse/walkway/` |
//! | which sightings are believed; what a deviation is | `human/track.rs`; `human/deviation.rs` |
//! | radii of regions, speeds near people | `aware/regions.rs`; who must stop or may drive off: `fleet/limit.rs` |
//! | what people mean for the search | `aware/effects.rs`; how it obeys: `route/search/care.rs` |
//! | who waits, goes round, leaves a path | `fleet/yielding.rs`; the published way: `fleet/published.rs` |
//! | when a route is kept, and when changed | `aware/safe_space.rs` |
//! | what an announced closure changes, and when | `fleet/closing.rs`, `fleet/areas.rs`; `route/search/care.rs` |
//! | where workers are led, what they are told | `fleet/lead.rs`, `fleet/guide.rs` |
//! | what simulated people do, and how they are seen | `sim/walker/`, `sim/crew.rs`; `sim/sensor.rs` |
//! | how it is guessed where a person is going | `human/intention/`; stories that test it: `experiment/stories/` |
//! | where people will be, how sure that is | `human/outlook.rs`, `human/motion/`; learned: `experiment/learning/` |
//! | whether forecasts hold | `human/coverage.rs`; who brakes for them: `aware/collision.rs`, `fleet/foresee.rs` |
//! | a key of scenario files | `sim/scenario.rs`, `docs/scenarios.md` |
//! | what every simulation must keep | `sim/laws.rs`, `sim/job_laws.rs`; in the server: `server/watchdog.rs` |
//! | what a recording holds | `sim/recording.rs` |
//! | what simulated robots, radios, customers do | `sim/robot.rs`, `sim/link.rs`, `sim/customers.rs` |
//! | an endpoint, an error, a wire type | `api/http/`, `api/error.rs`, `api/dto.rs`; `web/src/wire.ts` |
//! | what is stored, and how | `store/record.rs` (facts), `store/ledger_record.rs` (snapshots), `migrations/` |
//! | how long what is over is kept | `store/retention.rs`; customers' keys: `fleet/keys.rs` |
//! | what is kept of the past; its bookmarks | `api/reel/`, `server/reels.rs`; `api/reel/mark.rs`; `web/src/reel/` |
//! | a figure over time, how long it is kept | `history/`, `api/http/history.rs`, `migrations/` |
//! | a setting of the server | `server/config.rs`, `docs/operate.md` |
//! | which file is the database; its lock | `store/opening.rs`, `store/identity.rs`; `store/lock.rs` |
//! | what happens where a step panics | `server/rescue.rs`, `fleet/fence.rs` |
//! | a command | `cli/` |
//! | a wall | `tests/walls.rs`, and the picture above |
//!
//! # Where this differs from the first design
//!
//! - *The view is made on demand* ([`fleet::Fleet::view`]), not by every step: the server wants ten a second, a
//!   simulated hour none of its 36 000.
//! - *Most lanes have no timeline.* Whoever drives a lane holds both ends. Where its footprint asks for nothing beyond
//!   them, holding the lane as well would say nothing new and would double the work.
//! - *Queue places are ordinary nodes*, reserved for robots bound for their station, planned like all others. Robots
//!   set off only while the station has a place for them. A FIFO outside of the search would have been a second planner
//!   with a promise of its own, and the argument above would have had to cover both.
//! - *There is a `cli` module beside `main.rs`*, so that commands can use private parts of it and tests can call it.
//! - *The order on a resource is changed by planning those who wait again*, not by swapping entries: the search finds
//!   only ways that fit, so no graph has to be checked for cycles.
//! - *Insertion that moves others* (replanning a small set together, `fleet/insert.rs`) is tried after several failed
//!   searches, and for robots that must leave a worker's path; not for routes that are merely late, where it cost more
//!   than it gained.
//! - *Workers hold nothing in the timelines.* Precedence over robots would mean to take holds back, and with them the
//!   order on which nobody is ever stuck. They enter as conditions, made anew in every step.
//! - *Regions 2 and 3 are measured on foot*, round the racks, since they say how far a person walks meanwhile; region 1
//!   is as the crow flies. They are between centres: the separation distance plus half a person and half a robot.

#[cfg(feature = "edge")]
pub mod api;
pub mod aware;
#[cfg(feature = "edge")]
pub mod cli;
pub mod experiment;
pub mod fleet;
pub mod geometry;
pub mod history;
pub mod human;
pub mod id;
pub mod route;
#[cfg(feature = "edge")]
pub mod server;
pub mod sim;
#[cfg(feature = "edge")]
pub mod store;
pub mod time;
pub mod timeline;
pub mod warehouse;
