//! From the last label of a search back to a route with times.
//!
//! Main function: [`route`]. Rolling labels carry intervals; the actual instant in each is known only from the end: a
//! run starts as late as its last window demands. Refuses: to search.

use super::label::{Label, Labels, NONE, OWN_HEADING};
use super::motion::{MotionState, Pace};
use super::{Route, RouteQuery, is_loaded_at};
use crate::id::ArcId;
use crate::time::{Span, Time};
use crate::timeline::Visit;
use crate::warehouse::Warehouse;

/// A label with its actual time.
struct TracedLabel {
    label: Label,
    arrive: Time,
}

pub(super) fn route(
    labels: &Labels,
    goal: u32,
    ask: &RouteQuery<'_>,
    pace: &Pace,
    warehouse: &Warehouse,
    expansions: u32,
) -> Route {
    let moments = moments(labels, goal);
    let stay = (ask.ready - ask.from.arrive).max(Span::ZERO);
    let loaded = ask.from.loaded || is_loaded_at(ask.stages, ask.from.node, 0);
    let kept = Visit { depart: Time::MAX, leave: Time::MAX, stay, loaded, ..ask.from.clone() };
    let mut visits = vec![kept];
    let mut stops = Vec::new();
    for pair in moments.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let loaded = ask.stages[usize::from(from.label.stage)].loaded;
        match to.label.arc {
            None => {
                stops.push(visits.len() - 1);
                let here = visits.last_mut().expect("starts with the kept visit");
                here.stay += to.arrive - from.arrive;
            }
            Some(arc) => {
                let with_rack = is_loaded_at(ask.stages, to.label.node, usize::from(to.label.stage));
                drive(&mut visits, (from, to), arc, [loaded, with_rack], (ask.heading, pace), warehouse);
            }
        }
    }
    stops.push(visits.len() - 1);
    let arrival = moments.last().expect("at least the start").arrive;
    let kept = visits.remove(0);
    Route { kept, visits, stops, arrival, expansions }
}

/// The labels from start to goal with their actual times.
fn moments(labels: &Labels, goal: u32) -> Vec<TracedLabel> {
    let last = *labels.get(goal);
    let mut moments = vec![TracedLabel { label: last, arrive: Time(last.lo) }];
    let mut index = last.parent;
    while index != NONE {
        let (parent, child) = (*labels.get(index), moments.last().expect("starts with the goal"));
        let arrive = match (parent.motion, child.label.arc) {
            (MotionState::Rolling, Some(_)) => child.arrive - Span(child.label.span),
            _ => Time(parent.lo),
        };
        moments.push(TracedLabel { label: parent, arrive });
        index = parent.parent;
    }
    moments.reverse();
    moments
}

/// Ends the last visit and appends the next one: driven with or without a rack, and held for a robot with or without
/// one.
fn drive(
    visits: &mut Vec<Visit>,
    (from, to): (&TracedLabel, &TracedLabel),
    arc: ArcId,
    [loaded, with_rack]: [bool; 2],
    (own_heading, pace): (f64, &Pace),
    warehouse: &Warehouse,
) {
    let here = visits.last_mut().expect("starts with the kept visit");
    let depart = to.arrive - Span(to.label.span);
    if from.label.motion == MotionState::Standing {
        let turn = match from.label.slot {
            OWN_HEADING => pace.turn_between(own_heading, warehouse.arcs[arc].heading),
            slot => pace.turn(arc, slot),
        };
        here.stay += turn;
    }
    here.depart = depart;
    let enter = if !pace.holds_while_driving() {
        here.leave = to.arrive;
        to.arrive
    } else {
        here.leave = to.arrive + pace.clearance();
        let lead = if from.label.motion == MotionState::Rolling { pace.lead(loaded) } else { Span::ZERO };
        (depart - lead).max(here.enter)
    };
    let lane = warehouse.arcs[arc].lane;
    let lane = (!warehouse.lane_is_free_of_conflicts(lane)).then(|| warehouse.lane_resource(lane));
    visits.push(Visit {
        node: to.label.node,
        lane,
        loaded: with_rack,
        enter,
        arrive: to.arrive,
        depart: Time::MAX,
        leave: Time::MAX,
        stay: Span::ZERO,
    });
}
