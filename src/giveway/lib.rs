//! Giveway: a warehouse fleet manager in which robots give way to people.
//!
//! Giveway is an efficiency layer, not a safety function: detection, braking and emergency stop are the robots' own.
//! This page is the only architecture text. The README takes a newcomer to a running simulation; each page of `docs/`
//! answers one question.
//!
//! # The picture
//!
//! ```text
//!   floor   time  id  text  geometry  →  warehouse  →  timeline  →  route
//!     ↓
//!   people  human  →  aware (where people and routes meet)    reach    local
//!     ↓
//!   cell    the picking station
//!     ↓
//!   fleet   the state machine    alarm    history
//!     ↓     pure above: no clock, no I/O, no chance, no hash order
//!   site    what one floor is: map, kinds of robots, policy, limits, links; and the file that says so
//!     ↓
//!   drive   the loop around the core: what is heard, written down, sent; pure, too
//!     ↓
//!   sim     a floor in memory; pure, too
//!     ↓
//!   store (journal)    api (HTTP, live feeds)    links (sessions of robots)    vda5050 (its messages)
//!     ↓
//!   giveway  server (wiring, the clock)  cli (arguments, files, tables): the product
//!     ↓
//!   lab     tables that others can repeat, learning, benchmarks: a program of its own
//! ```
//!
//! Each line is a member of the workspace, in a folder of `src/`, and knows the members above it; `store` and `api`
//! know the core, but neither each other nor `sim`. Cargo enforces that. Inside a member, a module names only modules
//! before it, and `human` and `route` meet only in `aware`: `tests/walls/` enforces this and the purity. This crate
//! re-exports all members under one name.
//!
//! # The code, in reading order
//!
//! - [`time`], [`id`], [`text`], [`geometry`]: integer microseconds and half-open windows; one newtype per kind of
//!   thing; names and tables as people write them, and every sentence for people, with a code of its own
//!   (`text/sentence/mod.rs`); metres and radians in the map's frame.
//! - [`warehouse`]: the building. Nodes, lanes, racks, stations; which of them conflict; checks that refuse a map on
//!   which robots could get stuck; formats.
//! - [`timeline`]: which robot holds which resource when, and in which order. Makes [`timeline::Reserved`], the proof
//!   of a reservation. Searches read it through a [`timeline::Overlay`], as if some robots had made way.
//! - [`route`]: the one search, over free windows.
//! - [`human`]: people as beliefs. Where they are, whether they keep to their path, their probable goals, where they
//!   will be when. Every kind of bad sighting has one answer (`human/source.rs`). Forecasts are mixtures whose
//!   parameters were learned from recorded people (`human/forecast.rs`, `human/model.rs`) and are judged while the
//!   system runs.
//! - [`aware`]: the effects of people on robots: conditions on nodes for the search and the grants, regions for speeds,
//!   encounters. There is no second planner.
//! - [`reach`]: a person at arm's length, as beliefs: the target of a hand, where the arm will be, where the eyes look.
//!   Small neural nets, forward only; they are learned in `lab/learning/picks`.
//! - [`cell`]: the picking station as a work cell: order lines, how far each has come, and how hands change them; a
//!   robot arm beside the picker (`cell/arm/mod.rs`). It knows neither routes nor timelines.
//! - [`local`]: how a robot with a corridor passes a person beside its line: the dynamic window. Simulated robots only;
//!   real ones get the corridor and plan for themselves. It knows neither routes nor timelines.
//! - [`fleet`]: the state machine. `fleet/lib.rs` shows one step on one screen; each phase is a file.
//! - [`history`]: what happened over time, as figures in buckets of bounded number. It decides nothing.
//! - [`alarm`]: what is wrong (causes only), and the life of an alarm: raised, acknowledged, cleared. It decides
//!   nothing about robots.
//! - [`site`]: the description of one floor, and the site file. A scenario is a site with toys.
//! - [`sim`]: robots with inertia, radios that lose messages, customers; laws; recordings; the driver without a server.
//!   Pure.
//! - `lab`: benchmark floors and published tables, driven by the same search; recorded people, and what is
//!   learned from them. Pure.
//! - `store`: the journal of steps, snapshots of the ledger, and the lists of jobs, assignments and encounters, in
//!   SQLite.
//! - `api`: HTTP under `/v1`, the live feed, metrics, OpenAPI; wire types are its own. Its folders are rooms in an
//!   order (`api/lib.rs`): values and problems (`wire`), callers (`access`), what travels (`dto`), feeds, the state
//!   that handlers share, handlers. `api/feed` takes the poses of headsets: frames, clocks and thinning are pure
//!   there, and guidance bypasses all queues.
//! - `vda5050`: the messages of VDA 5050, of all versions, behind one model; and a virtual robot that speaks them.
//! - `links`: one session for each robot that speaks VDA 5050: [`fleet::Command`] becomes orders, what the robot says
//!   becomes [`fleet::Telemetry`]. Pure. `server/links/mqtt` joins the sessions to a broker.
//! - `mqtt`: the line to a broker, and the one file that knows the client library.
//! - `server`: settings, the only clock, the loop, what waits for the journal; one running core after another where the
//!   map is changed (`server/running.rs`).
//! - `cli`: one file per command of the program. `main.rs` calls it and nothing else.
//!
//! # Words
//!
//! Each term has one meaning, the field's own where it has one.
//!
//! | term | meaning | known from |
//! |---|---|---|
//! | resource, conflict | a node or a lane, for one robot at a time; resources whose footprints overlap | ter Mors |
//! | free window (safe interval) | a half-open interval in which a resource is free | CARP; SIPP |
//! | reservation, itinerary | a window kept for a robot; all of a robot's in order (`Visit`, `Chain`) | rmf_traffic |
//! | route, leg, action point | resources with windows; its part to one goal; where a robot acts (`Stop`) | VDA 5050 |
//! | grant (base), horizon | how far a robot may drive now, and what is reserved beyond | VDA 5050 |
//! | revoke, truncate | to take back what was granted; to give up what was not | VDA 5050 |
//! | release | a resource is given back | openTCS |
//! | robot kind | what all robots of it have in common: kinematics, charging, footprint, loads | VDA 5050 |
//! | maintenance | a robot finishes what it has begun, rests at a parking place and takes no jobs | |
//! | leaving, gone | as for maintenance, then off the floor for good; its place is free | |
//! | footprint | the floor that a robot takes, with or without a rack | VDA 5050 |
//! | job, dispatch, transport | what a customer wants; choosing robot, rack, station; from place to place | openTCS |
//! | worker, assignment, observation | a person on the floor; that person's task; a pose and when it was seen | |
//! | mover | what a worker moves as: on foot, or in a vehicle with a driver | |
//! | deviation, intent, forecast | off the path; a distribution over goals; where, when, how probably | Petković 2021 |
//! | zones: stop, keep-out, slow | regions 1, 2 and 3 around a person | Petković 2021, ISO 13855 |
//! | yield, soft cost, no entry | a robot waits for or leaves the way of a person; a price; a closed window | |
//! | human-aware policy | how the fleet deals with people: `nhir`, `shir`, `phir`, `giveway` | Petković 2021 |
//! | input, fact, command, reply, view, snapshot | what goes into a step, what happened, what leaves | event sourcing |
//! | deadlock, livelock, standstill | a cycle of waiting; motion without progress; no robot moves | |
//! | throughput bound | deliveries of the same jobs if robots could pass through one another | |
//! | occupancy, heartbeat | which robot holds what when; the regular report of a robot or a headset | |
//! | recording, frame, bookmark | what a replay plays | |
//!
//! # The life of a step
//!
//! One loop drives the fleet: [`drive::Drive::turn`]`(now, heard)` takes in what was heard, steps the fleet, and
//! returns what must be stored and sent (`drive/lib.rs` shows it on one screen). The server adds sockets, a clock and a
//! database (`server/control.rs`), a simulation adds a floor in memory and a journal that may fail (`sim/run/host.rs`).
//! All decisions are made in [`fleet::Fleet::step`]`(now, inputs)`.
//!
//! Robots, and everything that is simulated, are behind links (`server/links/`): their messages become inputs, and
//! output leaves as one [`drive::LinkOutput`]. A simulated floor reads the ledger, as any client of the API can, and
//! never the fleet.
//!
//! Inside `fleet`, each folder is a room. The rooms share `fleet/state/`: the ledger, which only facts change; the
//! scene; the restrictions on robots in this step; and the read-only `Floor` for questions about all of these. The
//! memory of a room is private to it (`HumanState`, `Yielding`, `Traffic`). What it may know of another room is passed
//! to it as an argument: people and dispatch know only `state`, traffic asks dispatch for places in storage, yielding
//! plans with traffic and knows people, `waits` and `read` see these rooms, and none of them calls `waits` or `read`.
//! `tests/walls/rooms.rs` has the table and enforces it, as it does for the rooms of `sim`, of `api` and of its
//! handlers.
//!
//! 1. **Absorb** (`requests/absorb.rs`): all inputs are taken in before anything is decided. Telemetry goes to the
//!    scene, where the report that was *seen* last counts. Requests become facts or refusals.
//! 2. **Evaluate people** (`people/evaluate.rs`): people are followed along their paths. A worker who stays off a path
//!    deviates and is shown a way back (`people/routing.rs`); intents are updated (`people/intent.rs`). Beliefs become
//!    conditions on nodes: *closed* where a person will almost surely walk within seconds, *no entry or exit* around a
//!    person, *slow* farther out, a *soft cost* where a person may walk. Speed limits and stops leave at once
//!    (`yielding/speed_limit.rs`), and so does guidance (`people/guidance.rs`). On a floor without people and closures
//!    this phase does nothing.
//! 3. **Progress** (`traffic/progress.rs`): what has come true? Visits behind a robot are released. A finished stop
//!    leads to the next task. If a robot is late, its windows slide, and with them those of all robots after it. A
//!    broken robot keeps its place. A robot that stands elsewhere continues from there or is treated as broken
//!    (`traffic/displaced.rs`).
//! 4. **Dispatch** (`dispatch/jobs.rs`): waiting jobs and idle robots are matched together, at the least total cost
//!    (`dispatch/assignment.rs`). A robot whose rack was just picked from takes part with that rack
//!    (`dispatch/chains.rs`): the rack's next job is cheaper for it, and a more urgent job still goes first. A robot
//!    that gets no job charges if it should, or makes way for others.
//! 5. **Plan** (`traffic/plan.rs`): each robot that has a task and no route gets a search, the longest waiting first,
//!    until the step's budget of expansions is spent. A route is committed only when it is complete. Then robots whose
//!    route leads into an announced closure get another one (`traffic/closures.rs`). Then robots whose reservations
//!    meet a worker's windows wait, or change their route if they would wait for long, or leave the worker's path
//!    (`yielding/evade.rs`). Then robots that are held up look for a better route.
//! 6. **Grant** (`traffic/grant.rs`): each robot may drive as far as it needs to keep its speed, but not past an
//!    unfinished stop, nor past a robot that holds an earlier reservation. Grants become commands.
//! 7. **Waits** (`waits/`): what each robot and each worker waits for, and where each chain of waiting ends, goes into
//!    the wait-for graph. Everything shown or decided about waiting comes from it (`read/why.rs`, `yielding/evade.rs`).
//!
//! Every change of durable state is a [`fleet::Fact`], recorded by one function and applied by one other,
//! [`fleet::Ledger::evolve`], live and on load alike. Facts carry results (the new times of visits that a delay moved),
//! never how to compute them, so a better algorithm cannot rewrite history. The step returns facts, commands and
//! replies. The server writes the facts of a step as one row, completely or not at all, and sends commands and replies
//! when the row is durable. If the database is gone, robots drive to the end of their grants and stop.
//!
//! The journal's task folds durable facts into a ledger of its own and stores a snapshot of it now and then; steps that
//! the snapshots cover are deleted. After a restart the ledger is the last snapshot with the later steps folded in, and
//! the scene is empty. To the step, that is a floor of silent robots, and nothing special.
//!
//! Publishing a map to the running server is a restart within the process: robots stand on nodes (`drive/settle.rs`),
//! the core is shut down, the database is carried over in one transaction, and another core is made from it behind the
//! same port. So a kill at any instant is a kill before or after the change.
//!
//! A step that panics is undone: the fleet is folded from the journal again, and the robot at hand is fenced
//! (`fleet/traffic/fence.rs`): it is treated as failed, whatever it reports, until a person releases it. After a
//! question that panics (a view, a query, what a pose calls for), the robot at hand is fenced, too (`drive/rescue.rs`).
//!
//! # What is not there
//!
//! - Above the line nothing reads a clock, a file, a socket or the environment, starts a thread or takes a lock.
//! - No decision depends on how long anything took: searches are bounded by counted expansions. A stopwatch is passed
//!   in for figures and decides nothing. Same build, same seed, same bytes.
//! - No random number is drawn outside of `sim/random.rs`; no map with a random order is used above the line.
//! - Nothing reacts to a message. Decisions look at state, so repeated, late and reordered messages do no harm.
//! - Only `Ledger::evolve` changes the promises of the ledger; loading facts never plans.
//! - No robot is told to drive without a [`timeline::Reserved`], and only [`timeline::Timeline`] makes one. There is no
//!   [`warehouse::Warehouse`] that was not validated.
//! - Types of the core are not serialised: `api` and `store` have wire types of their own.
//! - The [`fleet::View`] is an input to no decision.
//! - Things that merely *exist* cost a step nothing that grows with their number: idle robots, waiting jobs that cannot
//!   start, announced closures and open assignments are looked up in indexes, which change when these things do.
//! - No hold is released because its time is over. Times are plans; only a robot's report releases anything.
//!
//! # Why no robot is ever stuck
//!
//! A *hold* is a visit of one robot on one node (and on the lane that leads there, where that lane needs a timeline),
//! with a window. Three things are true of every set of holds that the timeline accepts:
//!
//! - (a) A robot's holds go on to a place where it may stay for ever, and the last one has no end. So no hold is
//!   ever ordered behind a robot's last one, and a robot that has reached its last hold is in no other robot's way. A
//!   new route that does not get that far is not committed; the old one stands.
//! - (b) Holds of different robots on one resource, or on two in conflict, do not overlap. So on every resource they
//!   have an order, and grants follow that order, not the clock.
//! - (c) A robot's hold on a node outlasts, by a strictly positive clearance, its arrival at the next node.
//!
//! Now let robot A wait for a hold `v`: `v` is the next in A's route, and another hold is before it in the order of its
//! resource, hold `u` of robot B. Then `u` ends before `v` starts (b). B gives `u` back when it has arrived at its own
//! next hold `u'`, which exists, since `u` has an end (a). And `u'` starts no later than B arrives there, which is
//! before `u` ends (c). Together:
//!
//! ```text
//! start(u')  ≤  arrival at u'  <  end(u)  ≤  start(v)
//! ```
//!
//! The start of each hold is strictly later than the start of the hold that must be granted before it. The same holds
//! within a route, where visits follow one another. So the starts are a potential: there is no cycle of waiting, and
//! the ungranted hold with the earliest start waits for no other hold. Its robot gets it as soon as it is done where it
//! stands. With zero clearance a ring of robots could rotate with all starts equal: that is what (c) forbids.
//!
//! The argument is about the set of holds, not about how it came about. So it survives every change that keeps (a),
//! (b) and (c) true:
//!
//! - *Delays* slide windows and keep every order (`timeline/delay.rs`): a follower starts as much later as it must.
//! - *Granting early* moves the start of a hold with no earlier hold before it, so no inequality is lost.
//! - *Going on early* (`timeline/advance.rs`) moves the holds of one robot forward, each no farther than to the end of
//!   what others hold there before it: every order stays as it is. So grants follow the order and not the clock.
//! - *A better route* (`traffic/plan.rs`, `improve`) is searched in the windows that all other holds leave free, so it
//!   fits in, and the order of all holds stays free of cycles, although the robot may now come before others.
//! - *A broken robot* keeps what it was granted without end. The robots that have to pass it, and those that would
//!   have to pass these in turn, lose what was not granted yet (`fleet/traffic/truncate.rs`) and are routed anew.
//!   Robots whose jobs lead past it give them back (`fleet/dispatch/blocked.rs`); `warehouse/check/shut_in.rs` says of
//!   a map where robots have no way out past one.
//! - *A robot that was pushed elsewhere* (`fleet/traffic/displaced.rs`) holds one place without end, which was granted
//!   to no other robot. The robots that were promised it, and those behind them, lose what was not granted yet.
//! - *A robot whose grant is revoked* (`fleet/traffic/revoke.rs`) only holds again what it had been granted. It is
//!   first in the order of all these holds, and no robot can come before a hold that began in the past, so it waits for
//!   no other robot there. If it stands between two nodes, both stay granted to it, and both are first steps of the
//!   next search (`fleet/traffic/first_step.rs`): no robot is before it there, and a person who keeps it from the one
//!   need not keep it from the other.
//!
//! The argument is about robots that have routes. A robot whose route was truncated holds the node where it stands
//! without end, and finds no new route while other robots stand on its way for the same reason: after a repair, robots
//! around a station can surround one another. So a robot that finds no route for its whole task takes a route to the
//! nearest place where it may stay (`fleet/traffic/step_out.rs`), and plans its task from there. The outermost robots
//! can always do that, since no place where a robot may stay is in the way of another; then the robots behind them can.
//!
//! Then all robots without routes stand where they may stay, and each of them wants a place. If no robot keeps that
//! place for ever, the search finds a route in the end, since every place can be reached without crossing a lasting
//! one, and since a search that fails doubles its budget (in a crowd a route is farther than one budget reaches). Else
//! the robot waits for the keeper. Follow these edges, one from each robot: they end in a robot that has a route, which
//! leaves; in one that a person has to set free; in an idle one; or in a cycle. An idle robot, or one member of the
//! cycle, leaves for a free place and keeps its task (`fleet/traffic/goal_chain.rs`). The robot behind it then has a
//! free goal, and the others after it, so each such step ends with at least one task done. If there is no free place,
//! the newest of their jobs fails, and says why.
//!
//! *People* are outside of the argument on purpose. A worker holds nothing in the timeline: a grant that would meet
//! a condition waits, which is a delay like any other, and the order of robots stays as it is. But a robot and a person
//! can wait for one another. So a robot on a person's path leaves it. A robot that has yielded to a person for long
//! loses its grant and leaves by another way. A person whose path is blocked is led round, past robots that have
//! yielded for long, or to a place aside, and is told to stop only if nothing else is left.
//!
//! What is left over is found in the *wait-for graph* (`fleet/state/wait_graph.rs`), noted in each step after the
//! grants: each robot and each worker waits for at most one other, for a time, for an operator, or for nothing. A
//! chain that ends in nothing that goes on by itself is a standstill, with its age. There are three kinds:
//!
//! - *A robot and a person wait for one another*, directly or behind other robots. After five seconds the robot
//!   leaves, on no way that comes nearer to the person (`fleet/yielding/evade.rs`): to a place aside and on with its
//!   task, together with the few that stand in its way, or to a place where it may stay, with those that stand on the
//!   way there, the farthest out first. If none of these is possible, the person is led out of the way of all robots
//!   that wait, or else of the one that has waited longest.
//! - *A person stands where robots have work.* After five seconds of waiting the person is led to a place aside; where
//!   there is none, asked to make room.
//! - *A robot finds no route* past robots that wait likewise. They are planned together, or leave one after the other
//!   (the argument above).
//!
//! People who come and go in front of a robot make no standstill, but the robot can still wait without end. So the
//! graph also knows how long people have kept each robot in one place, and after 90 seconds the people in its way stand
//! aside until it has passed, for 30 seconds at most (`fleet/people/lets_pass.rs`). Robots that carry racks to one
//! station have tickets in the order in which they lifted them (`fleet/state/tickets.rs`): no robot overtakes another
//! unless the other lies still, and a place promised to a robot that has no prospect of getting there lapses
//! (`fleet/traffic/turns.rs`), as a place at a charger does. So a robot that cannot go on keeps no other from its turn.
//!
//! In each of these cases the party that has waited longest is first, and no other party is sent where it would wait
//! for that one, so the number of parties that wait for the root of a chain falls. That this always ends is measured
//! (`docs/robustness.md`), not proved: a person may do anything, and a standstill of a minute raises an alarm with
//! names.
//!
//! One thing must be true of the floor for (a) to be possible at all: every place can be reached without crossing a
//! place where a robot may stay for ever. `warehouse/check/floor.rs` refuses maps where that is not so.
//!
//! # Where do I change …
//!
//! | what | where |
//! |---|---|
//! | how fast robots drive, turn, lift | `route/motion.rs`; for one scenario its `fleet` or `kinds` |
//! | robots of others: their file, flags | `site/robots.rs`; `mqtt/broker.rs`; `docs/robots.md` |
//! | virtual robots, their faults; the probe | `cli/robot/`, `vda5050/robot/`; `links/vda5050/probe/` |
//! | a robot kind | `fleet/state/kind.rs`; in files: `site/kinds.rs`; added: `fleet/requests/kinds.rs` |
//! | what one floor is, and its file | `site/lib.rs`, `site/file.rs`; `docs/site.md` |
//! | what robots are behind (links) | `server/links/mod.rs`, `drive/link.rs`; simulated: `server/links/sim.rs` |
//! | a kind of job | `fleet/state/job_kind.rs`, `life.rs`; `fleet/dispatch/jobs.rs`, `fleet/traffic/progress.rs` |
//! | which robot gets which job (dispatch) | `fleet/dispatch/jobs.rs`; with the rack that it has: `chains.rs` |
//! | the order of waiting jobs: priority, age, deadline | `fleet/state/index/queue.rs` (`urgency_ms`) |
//! | cost of an assignment, Hungarian method | `fleet/dispatch/jobs.rs` (`way_ms`), `fleet/dispatch/assignment.rs` |
//! | where racks are put, where robots rest | `fleet/state/stays.rs` |
//! | what may happen to a job, and what its robot does | `fleet/state/life.rs` |
//! | a request to the fleet and its answer | `fleet/state/request.rs`; carried out: `fleet/requests/absorb.rs` |
//! | submit and cancel a job | `fleet/requests/jobs.rs`; `api/http/orders/jobs.rs` |
//! | charging thresholds, which robot leaves a charger | `fleet/dispatch/charging.rs` |
//! | when a pick ends, a station that is paused | `fleet/requests/station.rs`; `api/http/floor/stations.rs` |
//! | which waiting job comes first (queue) | `fleet/state/index/queue.rs`; jobs after jobs: `waits.rs` |
//! | what a fact changes; what is looked up | `fleet/state/ledger/evolve.rs`; `upkeep.rs`, `fleet/state/index/` |
//! | limits on how many of something there may be | `fleet/state/settings.rs`; what users read: `docs/operate.md` |
//! | when a robot is planned, and how often again | `fleet/traffic/plan.rs`; over which legs: `stages.rs` |
//! | the search, its order, its bounds | `route/search.rs`, `route/label.rs`, `route/estimate.rs` |
//! | joint replanning (insertion) | `fleet/traffic/joint.rs`; on what it searches: `timeline/overlay.rs` |
//! | how far ahead robots are granted (base, horizon) | `fleet/traffic/grant.rs` |
//! | whose turn it is at a station; places that lapse | `fleet/state/tickets.rs`; `fleet/traffic/turns.rs` |
//! | a grant is revoked, a route is truncated | `fleet/traffic/revoke.rs`; `fleet/traffic/truncate.rs` |
//! | delays, going on early, breakdowns | `timeline/delay.rs`, `advance.rs`; `fleet/traffic/truncate.rs` |
//! | what broken robots and closures cut off | `fleet/state/cut_off.rs`; `fleet/dispatch/blocked.rs` |
//! | people take a rack off a broken robot | `fleet/requests/racks.rs`; `api/http/fleet/robots.rs` (`take_rack`) |
//! | faults of robots, e-stop; a blocked path | `fleet/state/fault.rs`; `fleet/traffic/obstruction.rs` |
//! | a robot arm beside a picker: its lines, its ways | `fleet/requests/arm.rs`; `cell/arm/task.rs`, `site.rs` |
//! | robots that people pushed elsewhere | `fleet/traffic/displaced.rs`; in words: `alarm/displaced.rs` |
//! | robots that keep one another's goals | `fleet/traffic/goal_chain.rs` |
//! | what closing an area would do | `fleet/read/closing.rs`; `api/http/floor/closing.rs` |
//! | deadlock: why there is none | the argument above; what is stuck: `sim/laws/`, `server/watchdog/` |
//! | what waits for what (wait-for graph) | `fleet/state/wait_graph.rs`; which party waits, and why: `fleet/waits/` |
//! | the map format | `warehouse/formats/json.rs` and `maps/map.schema.json`; `tests/maps.rs` compares them |
//! | which maps are refused; warnings | `warehouse/check/`; `warehouse/check/shut_in.rs`, `improbable.rs` |
//! | maps: drawn, tried | `api/http/floor/maps.rs`; `api/port/trial.rs`, `server/links/trial.rs`; `web/src/editor/` |
//! | a map that is published to the running server | `api/http/floor/publish.rs`, `server/publish.rs`, `settle.rs` |
//! | which map a start takes: the file's, the published one | `server/basis.rs`, `store/published.rs` |
//! | the differences between two maps | `warehouse/differences.rs` |
//! | where people walk | `warehouse/walkway/` |
//! | which observations are believed; what a deviation is | `human/source.rs`; `human/deviation.rs` |
//! | which of several sources is believed, and where else a worker may be | `human/track.rs` |
//! | marks, frames of headsets, axes in another order | `api/feed/intake/align.rs`, `course.rs`; `conventions.rs` |
//! | poses are thinned (rate limit) | `api/feed/thin.rs` |
//! | a headset that is silent, a worker who is lost | `human/source.rs`; `aware/effects.rs` (the region grows) |
//! | how robots pass people beside their line | `local/`; `warehouse/corridor.rs`, `warehouse/check/corridor.rs` |
//! | whether robots pass | `fleet/yielding/passing.rs`, `fleet/state/passing.rs`; simulated: `sim/robot/passing.rs` |
//! | radii of regions | `aware/regions.rs` |
//! | robots go slow or stop near a person | `fleet/yielding/speed_limit.rs` |
//! | what people mean for the search (soft cost, no entry) | `aware/effects.rs`; `route/search/constrained.rs` |
//! | a robot yields: waits, goes round, leaves a path | `fleet/yielding/evade.rs`; noted: `fleet/state/yielding.rs` |
//! | the published policies | `fleet/yielding/petkovic2021.rs` |
//! | when a route is kept, and when changed | `aware/safe_space.rs` |
//! | a closure reroutes robots | `fleet/traffic/closures.rs`; `fleet/state/closed_areas.rs` |
//! | worker registration | `fleet/requests/workers.rs`; `api/http/people/workers.rs` |
//! | worker's assignment | `fleet/requests/workers.rs`; `api/http/orders/assignments.rs` |
//! | people who let a robot pass | `fleet/people/lets_pass.rs` |
//! | where workers are led, what they are told | `fleet/people/routing.rs`, `fleet/people/guidance.rs` |
//! | how long a message to a worker stands, standoffs | `fleet/people/message.rs`; laws: `sim/laws/calm.rs` |
//! | which robots were replanned, because of whom | `fleet/waits/replans.rs`; as events: `fleet/read/events.rs` |
//! | which report of a robot is the newest; its clock | `fleet/state/robot_clock.rs` |
//! | how a person's intent is inferred | `fleet/people/intent.rs`, `human/intention/`; stories: `lab/stories/` |
//! | the method of inference (`method`), goals on tiles | `sim/scenario/workforce.rs`; `human/tiles.rs` |
//! | which object a person fetches | `lab/objects/`; nets: `lab/learning/picks/places.rs` |
//! | where people will be (forecast) | `human/forecast.rs`, `human/motion/`; learned: `lab/learning/` |
//! | whether forecasts hold | `human/coverage.rs`; which robots brake: `fleet/yielding/speed_limit.rs` |
//! | stop of the whole fleet, pause of a robot | `fleet/requests/operator.rs`; `api/http/fleet/halt.rs` |
//! | a robot joins (registration), leaves | `fleet/requests/enrolment.rs`; `fleet/dispatch/leaving.rs` |
//! | maintenance | `fleet/dispatch/maintenance.rs` |
//! | robot kinds, footprints | `warehouse/body.rs`, `footprint.rs`; `fleet/state/kind.rs` |
//! | what changes when a kind is added | `fleet/state/ledger/refit.rs`; `Fleet::refit`; `timeline/refit.rs` |
//! | conflicts where two kinds meet | the rule and its cost: `warehouse/body.rs` |
//! | the view; why a robot or a job waits | `fleet/read/build.rs`, `view.rs`; `fleet/read/why.rs` |
//! | occupancy (timelines) of an area | `fleet/read/occupancy.rs`; `api/http/floor/timelines.rs` |
//! | safety regions in the timelines | `fleet/read/safety_regions.rs`; radii: `aware/regions.rs` |
//! | what simulated people do, and how they are seen | `sim/walker/`, `sim/crew/`; `sim/crew/sensor.rs` |
//! | a key of scenario files | `sim/scenario/`, `docs/scenarios.md` |
//! | alarms: what is one, what it suppresses, its life | `alarm/`; `store/alarms.rs`, `api/state/alarms.rs` |
//! | alarms: groups; what people do about one | `alarm/groups.rs`; `alarm/care.rs`, `alarm/register/mod.rs` |
//! | what an act is called; what a role may do | `api/access/acts.rs`, `roles.rs`; `web/src/words/acts.ts` |
//! | a floor that has worked before a server begins | `sim/run/warm_up.rs`; `server/start.rs` |
//! | what every simulation must keep (laws) | `sim/laws/`; in the server: `server/watchdog/` |
//! | what the swarm draws, how it shrinks, prints | `sim/swarm/draw.rs`, `maps.rs`; `shrink.rs`; `cli/swarm.rs` |
//! | what a recording holds | `sim/recording/` |
//! | what simulated robots, radios, customers do | `sim/robot/`, `sim/link.rs`, `sim/customers/` |
//! | an endpoint, a wire type | `api/http/`, `api/dto/names.rs`; its words: `api/wire/words.rs`; `web/src/` |
//! | what `/openapi.json`, `/asyncapi.json`, `/docs` say | `api/http/describe/`; `web/src/docs/` |
//! | what may be changed about a job; many jobs at once | `fleet/requests/change.rs`; `api/http/orders/batch.rs` |
//! | an error by its status: 400, 404, 409, 429, 503 | `api/wire/error.rs`; the fleet's: `api/dto/refusal.rs` |
//! | idempotency | `fleet/state/keys.rs`; owner of a key: `api/access/caller.rs`; `api/http/once.rs` |
//! | what is stored, and how | `store/record.rs` (facts), `store/ledger_record.rs` (snapshots), `migrations/` |
//! | rows of lists (jobs, assignments, encounters) | `fleet/read/rows.rs`; read by `store/jobs.rs`, `people.rs` |
//! | retention | `store/retention.rs`; idempotency keys: `fleet/state/keys.rs` |
//! | what is kept of the past; its bookmarks | `api/recording/`, `server/recordings.rs`; `api/recording/mark.rs` |
//! | a figure over time, how long it is kept | `history/`, `api/http/past/history.rs`, `migrations/` |
//! | access: tokens, sessions, an identity provider | `api/access/auth.rs`, `api/http/access/`; `api/oidc/` |
//! | what becomes of wrong tokens and cookies | `api/access/secrets.rs`; the alarm: `server/tokens.rs` |
//! | how many connections, bytes that wait for clients | `server/budget.rs`, `metered.rs`, `connections.rs` |
//! | outgoing requests (authorities, redirects) | `api/outgoing/mod.rs` |
//! | webhooks: delivery, retries, where they may be | `server/webhooks.rs`; `api/outgoing/webhooks.rs`, `targets.rs` |
//! | the audit: what is written down of a request | `api/access/audit.rs`; `server/audit_keeper.rs`, `store/audit.rs` |
//! | metrics | `api/state/metrics.rs`; what feeds them: `server/control.rs`, `server/measure.rs` |
//! | TLS, certificates | `server/tls.rs`, `server/certificate.rs` |
//! | privacy: names, pseudonyms | `api/access/pseudonyms.rs`; `server/people.rs`, `store/people.rs` |
//! | backup, restore, check of a database | `cli/database.rs`; `store/check.rs` |
//! | evacuation | `fleet/traffic/evacuation.rs`, `fleet/people/evacuate.rs`; `api/http/floor/evacuation.rs` |
//! | closures that recur | `fleet/state/recurring.rs`, `local_clock.rs`; `api/http/floor/recurring.rs` |
//! | sentences, and their translation | `text/sentence/mod.rs`, `api/wire/sentence.rs`; `web/src/language/` |
//! | the report of a shift | `fleet/read/shift.rs`, `api/dto/shift/`; `web/src/report/` |
//! | the heat map | `history/heat.rs`; `api/http/past/heat.rs` |
//! | MassRobotics reports | `api/feed/massrobotics.rs` |
//! | a setting of the server | `server/config.rs`, `docs/operate.md` |
//! | which file is the database; its lock | `store/opening.rs`, `store/identity.rs`; `store/lock.rs` |
//! | what happens when a call of the fleet panics | `drive/rescue.rs`, `fleet/traffic/fence.rs` |
//! | what becomes of a database whose map was changed | `fleet/carry/`, `store/carry.rs` |
//! | a command | `cli/` |
//! | a wall | `tests/walls/`, and the picture above |
//!
//! # Where this differs from the first design
//!
//! - *The view is made on demand* ([`fleet::Fleet::view`]), not by every step: the server wants ten a second, a
//!   simulated hour none of its 36 000.
//! - *Most lanes have no timeline.* A robot that drives a lane holds both its ends. If its footprint takes nothing
//!   beyond them, holding the lane as well would say nothing new and would double the work.
//! - *Queue places are ordinary nodes*, reserved for robots bound for their station, planned like all others. Robots
//!   set off only while the station has a place for them. A FIFO outside of the search would have been a second planner
//!   that makes promises of its own, and the argument above would have had to cover both.
//! - *There is a `cli` module beside `main.rs`*, so that commands can use private parts of it and tests can call it.
//! - *The order on a resource is changed by planning the waiting robots again*, not by swapping entries: the search
//!   finds only routes that fit, so no graph has to be checked for cycles.
//! - *Insertion that moves others* (replanning a small set together, `fleet/traffic/joint.rs`) is tried after several
//!   failed searches, and for robots that must leave a worker's path; not for routes that are merely late, where it
//!   cost more than it gained.
//! - *Workers hold nothing in the timelines.* If they went before robots there, holds would have to be taken back, and
//!   with them the order that keeps robots from getting stuck. Workers enter as conditions, made anew in every step.
//! - *Regions 2 and 3 are measured on foot*, round the racks, since they say how far a person walks meanwhile; region 1
//!   is as the crow flies. They are between centres: the separation distance plus half a person and half a robot.
//! - *The region of a worker who is not seen does not widen at walking speed for ever* (`human/source.rs`). For three
//!   seconds it does. Then a person is assumed to turn anywhere after each such stretch, so the distance grows with the
//!   square root of time, up to eight metres on foot; after half a minute a supervisor is asked. At walking speed, one
//!   dead headset closed a hall within ten seconds, and robots stood behind racks that the worker could not have walked
//!   round. The wearer is told to stand meanwhile, and robots detect a person who walked farther like any person
//!   without a headset: Giveway is no safety function.
//! - *A worker may be at several places.* Sources that contradict one another, the places before and after a jump, and
//!   both sides of marks that lie on one line all keep robots away ([`human::Track::others`]).
//!   [`human::Whereabouts`] is the most trusted one: forecasts, encounters and guidance know only that.

pub use giveway_api as api;
pub use giveway_cell as cell;
pub use giveway_drive as drive;
pub use giveway_fleet as fleet;
pub use giveway_fleet::{alarm, history};
pub use giveway_floor::{geometry, id, route, text, time, timeline, warehouse};
pub use giveway_people::{aware, human, local, reach};
pub use giveway_sim as sim;
pub use giveway_site as site;
pub use giveway_store as store;

pub mod cli;
mod mqtt;
pub mod server;
