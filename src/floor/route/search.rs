//! Best-first search over free windows.
//!
//! Main function: [`plan`]. A label is (node, free window, arrival heading, motion, stage) with the earliest arrival
//! and, while rolling, the latest one too: a robot may delay the start of its run, but cannot wait while it rolls.
//! Earlier arrival dominates while standing (heading differences paid by turning); while rolling, the wider interval
//! does. The objective is lexicographic: earliest at the first goal, then earliest at the last. A second leg that must
//! wait thus never sends the search back to the first one. With a weight ([`super::Planner::weigh`]) the objective is
//! the last arrival, within a factor. Then estimates are no longer consistent, and a place may be reached again,
//! sooner, after its label was expanded: no code here takes an expanded label for the best one; the sooner one
//! dominates it and is expanded, too. Refuses: any other objective.

mod constrained;

pub use constrained::COME_OUT;

use super::estimate::{Estimates, Table, may_drive};
use super::label::{Label, Labels, NONE, OWN_HEADING};
use super::motion::{MotionState, Pace};
use super::{NoRoute, Route, RouteQuery, Stage, is_loaded_at, trace};
use crate::geometry::turn_between;
use crate::id::{ArcId, BodyId, LineId, NodeId, ResourceId};
use crate::time::{Span, Time};
use crate::timeline::{FreeWindow, Overlay};
use crate::warehouse::{Warehouse, Way};
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Memory kept between searches.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    labels: Labels,
    open: Open,
    expanded: u32,
}

impl Scratch {
    /// Labels that the last search expanded.
    pub fn expanded(&self) -> u32 {
        self.expanded
    }
}

/// Lower bounds of the arrivals at the first and at the last goal; among equals the label nearest to the goals first:
/// if all must wait for the same window, the search goes straight up to it.
type Open = BinaryHeap<Reverse<(i64, i64, i64, u32)>>;

/// The inputs of one search.
struct Search<'a> {
    warehouse: &'a Warehouse,
    pace: &'a Pace,
    estimates: &'a Estimates,
    timeline: &'a Overlay<'a>,
    ask: &'a RouteQuery<'a>,
    tables: Vec<Arc<Table>>,
    goals: Vec<GoalWindows>,
    /// Windows of the last goal that only a closure ends: their indices, and the latest arrivals.
    brief: constrained::Brief,
    /// Lower bound from each goal to the next.
    between: Vec<i64>,
    /// See [`Pace::start_cost`] and [`Pace::lead`]; without and with a rack.
    start_cost: [i64; 2],
    lead: [i64; 2],
    /// The first timeline for a robot without a rack, and for one with a rack: the others follow by resources.
    lines: [LineId; 2],
    /// For each stage, whether windows are for a robot with a rack, on the way and at its goal.
    room: SmallVec<[[bool; 2]; 4]>,
    /// See [`super::Planner::weigh`].
    weight: f64,
    /// Whether half of the budget is spent.
    anytime: bool,
}

/// By how much the remaining time outweighs the elapsed time once half of the budget is spent.
const ANYTIME: i64 = 4;

/// The times at which a goal can be reached: `[first, last]` arrivals, in order.
struct GoalWindows(Vec<(i64, i64)>);

impl GoalWindows {
    /// The earliest possible arrival at `t` or later.
    fn lift(&self, t: i64) -> Option<i64> {
        let at = self.0.partition_point(|(_, last)| *last < t);
        self.0.get(at).map(|(first, _)| t.max(*first))
    }
}

/// A move from a label to the next node, before windows are looked at.
#[derive(Clone)]
struct Hop {
    arc: ArcId,
    way: Way,
    /// The possible motions at its end, each with the duration in microseconds.
    ends: SmallVec<[(MotionState, i64); 2]>,
    /// Departures that the label allows.
    depart: (i64, i64),
    /// How long before departure the next node must be held.
    lead: i64,
}

pub(super) fn plan(
    estimates: &mut Estimates,
    scratch: &mut Scratch,
    ask: &RouteQuery<'_>,
    timeline: &Overlay<'_>,
    weight: f64,
) -> Result<Route, NoRoute> {
    scratch.expanded = 0;
    assert!(!ask.stages.is_empty() && ask.stages.len() < 16, "a route has one to fifteen stages");
    let tables: Vec<_> = ask.stages.iter().map(|s| estimates.table(s.goal, s.loaded)).collect();
    let between = bounds_between(estimates, ask.stages, &tables)?;
    let warehouse = estimates.warehouse().clone();
    let pace = estimates.pace().clone();
    let room = room(&warehouse, estimates.body(), ask.stages);
    let last = ask.stages.len() - 1;
    let goal_line = |i: usize| {
        let goal = warehouse.node_resource(ask.stages[i].goal);
        warehouse.line(estimates.body(), room[i][1], goal)
    };
    let brief = constrained::brief_stays(&warehouse, &pace, timeline, ask, goal_line(last));
    let goals = goal_windows(&warehouse, &pace, timeline, ask, (&brief, goal_line))?;
    let start_cost = [false, true].map(|loaded| pace.start_cost(loaded).0);
    let lead = [false, true].map(|loaded| pace.lead(loaded).0);
    let mut search = Search {
        warehouse: &warehouse,
        pace: &pace,
        estimates,
        timeline,
        ask,
        tables,
        goals,
        brief,
        between,
        start_cost,
        lead,
        lines: [false, true].map(|loaded| warehouse.line(estimates.body(), loaded, ResourceId(0))),
        room,
        weight,
        anytime: false,
    };
    let Scratch { labels, open, expanded } = scratch;
    labels.clear();
    open.clear();
    search.start(labels, open)?;
    let goal = search.run(labels, open, expanded)?;
    Ok(trace::route(labels, goal, ask, &pace, &warehouse, *expanded))
}

fn bounds_between(
    estimates: &Estimates,
    stages: &[Stage],
    tables: &[Arc<Table>],
) -> Result<Vec<i64>, NoRoute> {
    let pairs = stages.iter().zip(&stages[1..]).zip(&tables[1..]);
    pairs
        .map(|((here, next), table)| {
            if here.goal == next.goal {
                return Ok(0);
            }
            estimates.bound_from(table, here.goal).map(|s| s.0).ok_or(NoRoute::Unreachable)
        })
        .collect()
}

/// For each stage, whether windows are for a robot with a rack, on the way and at its goal. If the kind of robots takes
/// as much floor without a rack, this never matters.
fn room(warehouse: &Warehouse, body: BodyId, stages: &[Stage]) -> SmallVec<[[bool; 2]; 4]> {
    let differ = warehouse.footprint(body, false) != warehouse.footprint(body, true);
    let at =
        |i: usize| [stages[i].loaded, is_loaded_at(stages, stages[i].goal, i)].map(|loaded| differ && loaded);
    (0..stages.len()).map(at).collect()
}

/// The arrivals at each goal that its free windows allow. If robots hold the next node while they drive, no robot
/// arrives sooner after a hold ends than the last lane takes, and none leaves faster than the first lane takes. Without
/// this, every search to a busy station would try all ways of arriving in those seconds.
fn goal_windows(
    warehouse: &Warehouse,
    pace: &Pace,
    timeline: &Overlay<'_>,
    ask: &RouteQuery<'_>,
    (brief, goal_line): (&constrained::Brief, impl Fn(usize) -> LineId),
) -> Result<Vec<GoalWindows>, NoRoute> {
    let last = ask.stages.len() - 1;
    let windows = |(i, stage): (usize, &Stage)| {
        let before = if i == 0 { ask.from.node } else { ask.stages[i - 1].goal };
        let loaded_after = ask.stages.get(i + 1).map_or(stage.loaded, |s| s.loaded);
        let (way_in, way_out) = (
            if before == stage.goal { Span::ZERO } else { pace.fastest_in(stage.goal, stage.loaded) },
            pace.fastest_out(stage.goal, loaded_after) + pace.clearance(),
        );
        let windows =
            constrained::open_windows(warehouse, timeline, ask, (stage.goal, goal_line(i)), ask.ready);
        let fits = windows.into_iter().filter_map(|g| match (i == last, g.end.is_forever()) {
            (true, false) => {
                let latest = brief.iter().find(|(part, _)| *part == g.index).map(|(_, latest)| *latest);
                latest.map(|l| ((g.start + way_in).0, l))
            }
            (_, true) => Some(((g.start + way_in).0, i64::MAX)),
            _ => Some(((g.start + way_in).0, (g.end - stage.stay - way_out).0)),
        });
        let fits: Vec<_> = fits.filter(|(first, latest)| first <= latest).collect();
        if fits.is_empty() { Err(NoRoute::Blocked) } else { Ok(GoalWindows(fits)) }
    };
    ask.stages.iter().enumerate().map(windows).collect()
}

impl Search<'_> {
    fn start(&self, labels: &mut Labels, open: &mut Open) -> Result<(), NoRoute> {
        let node = self.ask.from.node;
        // The window in which it came here must last until it can leave: a late robot may stand where another one will
        // pass before that, and must not be treated as if it had made way meanwhile.
        let (came, ready) = (self.ask.from.arrive.min(self.ask.ready), self.ask.ready);
        let differ = self.room.iter().flatten().any(|room| *room);
        let loaded = differ && (self.ask.from.loaded || is_loaded_at(self.ask.stages, node, 0));
        let line = self.line(loaded, self.warehouse.node_resource(node));
        let own = self.timeline.free_windows(line, came).next();
        let free = own.filter(|g| g.start <= came && g.end > ready).ok_or(NoRoute::Blocked)?;
        let known = self.warehouse.headings(node).iter();
        let slot = known.clone().position(|h| turn_between(*h, self.ask.heading) < 0.02);
        let slot = slot.map_or(OWN_HEADING, |s| s as u8);
        let ready = self.ask.ready.0;
        let label = Label::new((ready, free.end.0), node, free, slot, MotionState::Standing, 0, NONE, None);
        self.push(labels, open, label.with_room(loaded));
        Ok(())
    }

    /// The timeline of a resource for a robot with a rack, or for one without.
    fn line(&self, loaded: bool, r: ResourceId) -> LineId {
        LineId(self.lines[usize::from(loaded)].0 + r.0)
    }

    /// Whether a node is entered on a stage in a window for a robot with a rack.
    fn needs_room(&self, node: NodeId, stage: u8) -> bool {
        let stage = usize::from(stage);
        self.room[stage][usize::from(node == self.ask.stages[stage].goal)]
    }

    /// Expands labels in order of their bounds until one stays at the last goal for ever.
    fn run(&mut self, labels: &mut Labels, open: &mut Open, expanded: &mut u32) -> Result<u32, NoRoute> {
        while let Some(Reverse((_, _, _, index))) = open.pop() {
            let label = *labels.get(index);
            if label.dominated {
                continue;
            }
            let stage = &self.ask.stages[usize::from(label.stage)];
            if label.motion == MotionState::Standing && label.node == stage.goal {
                if usize::from(label.stage) + 1 < self.ask.stages.len() {
                    self.finish_stage(labels, open, index, label, stage.stay);
                } else if label.free.end.is_forever() || self.is_brief_stay(&label) {
                    return Ok(index);
                }
            }
            *expanded += 1;
            if *expanded > self.ask.budget {
                return Err(NoRoute::BudgetSpent);
            }
            if *expanded == self.ask.budget / 2 {
                self.search_anytime(labels, open);
            }
            self.expand(labels, open, index, label);
        }
        Err(NoRoute::Blocked)
    }

    /// Switches to the labels nearest to the goals, since half of the budget is spent. A route found now may not be the
    /// earliest one, but a robot that drives is better than one that asks again.
    fn search_anytime(&mut self, labels: &Labels, open: &mut Open) {
        self.anytime = true;
        let labels = open
            .drain()
            .map(|Reverse((_, _, left, i))| (labels.get(i).lo + labels.get(i).price, left, i))
            .collect::<Vec<_>>();
        open.extend(labels.into_iter().map(|(lo, left, i)| Reverse((lo + ANYTIME * left, 0, left, i))));
    }

    fn finish_stage(&self, labels: &mut Labels, open: &mut Open, index: u32, label: Label, stay: Span) {
        let ready = (Time(label.lo) + stay).0;
        if ready < label.free.end.0 {
            let times = (ready, label.free.end.0);
            let stage = label.stage + 1;
            let first = if label.stage == 0 { label.lo } else { label.first };
            let next = Label::new(
                times,
                label.node,
                label.free,
                label.slot,
                MotionState::Standing,
                stage,
                index,
                None,
            );
            let next = next.with_first(first).with_way(0, label.price);
            self.push(labels, open, next.with_room(label.loaded));
        }
    }

    fn expand(&self, labels: &mut Labels, open: &mut Open, index: u32, label: Label) {
        let stage = self.ask.stages[usize::from(label.stage)];
        let (conditions, body) = (self.ask.conditions, self.estimates.body());
        for (arc, way) in self.warehouse.ways(label.node) {
            if !may_drive((self.warehouse, body), label.node, &way, stage.loaded, stage.goal) {
                continue;
            }
            let Some(depart) = self.departures(&label, arc) else { continue };
            let lead =
                if label.motion == MotionState::Rolling { self.lead[usize::from(stage.loaded)] } else { 0 };
            let ends = [MotionState::Standing, MotionState::Rolling].into_iter();
            let ends = ends.filter(|&to| to == MotionState::Standing || self.pace.rolls_on(arc));
            let ends = ends.map(|to| (to, self.pace.drive(arc, stage.loaded, label.motion, to).0));
            let hop = Hop { arc, way, ends: ends.collect(), depart, lead };
            if conditions.is_touched(label.node) || conditions.is_touched(way.to) {
                self.enter_constrained(labels, open, index, &label, &hop);
            } else {
                self.enter_gaps(labels, open, index, &label, &hop);
            }
        }
    }

    /// The departures along `arc` that the robot's own motion and heading allow.
    fn departures(&self, label: &Label, arc: ArcId) -> Option<(i64, i64)> {
        if label.motion == MotionState::Rolling {
            return self.pace.is_straight(arc, label.slot).then_some((label.lo, label.hi));
        }
        let turn = if label.slot == OWN_HEADING {
            self.pace.turn_between(self.ask.heading, self.warehouse.arcs[arc].heading)
        } else {
            self.pace.turn(arc, label.slot)
        };
        Some((label.lo + turn.0, i64::MAX))
    }

    /// Tries every reachable free window of the next node, and of the lane where it needs holding.
    fn enter_gaps(&self, labels: &mut Labels, open: &mut Open, index: u32, label: &Label, hop: &Hop) {
        let node = hop.way.to;
        let latest = hop.depart.1.min(label.free.end.0);
        let loaded = self.needs_room(node, label.stage);
        let line = self.line(loaded, self.warehouse.node_resource(node));
        for free in self.timeline.free_windows(line, Time(hop.depart.0 - hop.lead)) {
            if free.start.0 > latest {
                break;
            }
            if hop.way.lane_is_free {
                self.enter(labels, open, index, label, hop, node, free, FREE);
                continue;
            }
            let lane = self.line(loaded, self.warehouse.lane_resource(hop.way.lane));
            for lane_free in self.timeline.free_windows(lane, Time(hop.depart.0 - hop.lead)) {
                if lane_free.start.0 > latest {
                    break;
                }
                self.enter(labels, open, index, label, hop, node, free, lane_free);
            }
        }
    }

    #[allow(clippy::too_many_arguments, reason = "the innermost step: everything it needs, nothing packed")]
    fn enter(
        &self,
        labels: &mut Labels,
        open: &mut Open,
        index: u32,
        label: &Label,
        hop: &Hop,
        node: NodeId,
        free: FreeWindow,
        lane_free: FreeWindow,
    ) {
        for &(to, span) in &hop.ends {
            let times = if self.pace.holds_while_driving() {
                self.arrivals_overlapping(label, hop, span, free, lane_free)
            } else {
                self.arrivals_instant(label, hop, span, node, free)
            };
            let Some((lo, hi)) = times else { continue };
            let hi = if to == MotionState::Standing { free.end.0 } else { hi };
            let slot = hop.way.slot;
            let next = Label::new((lo, hi), node, free, slot, to, label.stage, index, Some(hop.arc));
            let next = next.with_first(label.first).with_way(span, label.price);
            self.push(labels, open, next.with_room(self.needs_room(node, label.stage)));
        }
    }

    /// The arrivals if both nodes are held while driving between them.
    fn arrivals_overlapping(
        &self,
        label: &Label,
        hop: &Hop,
        span: i64,
        free: FreeWindow,
        lane_free: FreeWindow,
    ) -> Option<(i64, i64)> {
        let clear = self.pace.clearance();
        let latest_arrival = (label.free.end - clear).min(lane_free.end - clear).min(free.end - Span(1)).0;
        let begin = free.start.max(lane_free.start).0;
        let lo = hop.depart.0.max(begin + hop.lead) + span;
        let hi = hop.depart.1.saturating_add(span).min(latest_arrival);
        (lo <= hi).then_some((lo, hi))
    }

    /// The arrivals if nodes change hands in an instant; two robots must not change places.
    fn arrivals_instant(
        &self,
        label: &Label,
        hop: &Hop,
        span: i64,
        node: NodeId,
        free: FreeWindow,
    ) -> Option<(i64, i64)> {
        let lo = (hop.depart.0 + span).max(free.start.0);
        let hi = label.free.end.min(free.end - Span(1)).0;
        if lo > hi {
            return None;
        }
        if lo == free.start.0 && lo == label.free.end.0 {
            let there = self.line(self.needs_room(node, label.stage), self.warehouse.node_resource(node));
            let here = self.line(label.loaded, self.warehouse.node_resource(label.node));
            let (before, _) = self.timeline.neighbours(there, free);
            let (_, after) = self.timeline.neighbours(here, label.free);
            if before == after {
                return None;
            }
        }
        Some((lo, hi))
    }

    /// Adds a label with its bound, unless it cannot lead anywhere or another one is as good.
    fn push(&self, labels: &mut Labels, open: &mut Open, label: Label) {
        let Some((first, last, left)) = self.bound(&label) else { return };
        if let Some(index) = labels.add(label, |a, b| self.dominates(a, b)) {
            let (first, last) = (first + label.price, last + label.price);
            let key = match (self.anytime, self.weight > 0.0) {
                (true, _) => (label.lo + label.price + ANYTIME * left, 0),
                (false, true) => (self.weighted(&label, last), last),
                (false, false) => (first, last),
            };
            open.push(Reverse((key.0, key.1, left, index)));
        }
    }

    /// The bound of a label with a weighted remaining time: `g + h + k·h²/(g + h)`.
    fn weighted(&self, label: &Label, last: i64) -> i64 {
        let whole = last - self.ask.ready.0;
        let ahead = (last - label.price - label.lo) as f64;
        last + (self.weight * ahead * (ahead / whole.max(1) as f64)) as i64
    }

    /// The earliest possible arrivals at the first and at the last goal from a label, and the duration of the rest
    /// without any waiting.
    fn bound(&self, label: &Label) -> Option<(i64, i64, i64)> {
        let stage = usize::from(label.stage);
        let there = label.node == self.ask.stages[stage].goal && label.motion == MotionState::Standing;
        let ahead = if label.slot == OWN_HEADING || there {
            0
        } else {
            self.estimates.bound(&self.tables[stage], label.node, label.slot, label.motion)?.0
        };
        let mut arrival = label.lo + ahead;
        let mut left = ahead;
        let mut first = label.first;
        for k in stage..self.goals.len() {
            arrival = self.goals[k].lift(arrival)?;
            if k == 0 {
                first = arrival;
            }
            if k + 1 < self.goals.len() {
                let leg = self.ask.stages[k].stay.0 + self.between[k];
                arrival += leg;
                left += leg;
            }
        }
        Some((first, arrival, left))
    }

    fn dominates(&self, a: &Label, b: &Label) -> bool {
        if a.lo > b.lo || a.first > b.first || a.price > b.price {
            return false;
        }
        if a.motion != b.motion {
            // A robot that stands there early enough can start so that it is nowhere later than a rolling one.
            let loaded = usize::from(self.ask.stages[usize::from(a.stage)].loaded);
            return a.motion == MotionState::Standing
                && a.slot == b.slot
                && a.lo + self.start_cost[loaded] <= b.lo;
        }
        if a.slot == b.slot {
            return a.motion == MotionState::Standing || a.hi >= b.hi;
        }
        if a.motion == MotionState::Rolling || a.slot == OWN_HEADING || b.slot == OWN_HEADING {
            return false;
        }
        let headings = self.warehouse.headings(a.node);
        let turn = self.pace.turn_between(headings[usize::from(a.slot)], headings[usize::from(b.slot)]);
        a.lo + turn.0 <= b.lo
    }
}

/// The window of a lane that needs no hold.
const FREE: FreeWindow = FreeWindow { start: Time(i64::MIN / 2), end: Time::MAX, index: 0 };
