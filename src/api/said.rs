//! Whether dashboards can say the server's sentences in other languages: each has a pattern in
//! `web/src/language/said/patterns.json`, beside which the translations are.
//!
//! Tests alone. Refuses: to judge a translation.

use super::dto::Names;
use super::feed::align::Misfit;
use super::waits::active;
use crate::alarm::AlarmKind;
use crate::fleet::{Displacement, Fleet, JobWhy, JobsAhead, Settings, Why};
use crate::geometry::Spot;
use crate::id::{ClosureId, JobId, NodeId, RackId, ResourceId, RobotId, StationId, WorkerId};
use crate::time::Time;
use crate::warehouse::{NodeKind, lab};
use std::sync::Arc;

fn patterns() -> Vec<String> {
    serde_json::from_str(include_str!("../../web/src/language/said/patterns.json"))
        .expect("a list of sentences")
}

/// What stands in the places of a pattern, if a text is of its shape: as few characters in each as can be.
fn places<'a>(text: &'a str, pattern: &str) -> Option<Vec<&'a str>> {
    let Some((before, rest)) = pattern.split_once('{') else {
        return (text == pattern).then(Vec::new);
    };
    let rest = rest.split_once('}').expect("each place is closed").1;
    let text = text.strip_prefix(before)?;
    let ends = text.char_indices().map(|(i, c)| i + c.len_utf8());
    ends.filter_map(|end| {
        let mut found = vec![&text[..end]];
        found.extend(places(&text[end..], rest)?);
        Some(found)
    })
    .next()
}

/// Whether a sentence has a pattern, other than those that only join sentences.
fn is_known(text: &str, patterns: &[String]) -> bool {
    let joins = ["{0} ({1})", "{0}: {1}", "{0}.", "{0}; {1}"];
    patterns.iter().any(|p| !joins.contains(&p.as_str()) && places(text, p).is_some())
}

const ROBOT: RobotId = RobotId(0);
const NODE: NodeId = NodeId(0);
const RACK: RackId = RackId(0);
const STATION: StationId = StationId(0);

/// One of each: a reason that is added has to be listed, or it is not looked at.
fn whys() -> Vec<Why> {
    let at = Spot { x_mm: 4100, y_mm: 7900 };
    let displaced = [
        Displacement::OffNode { at, nearest: NODE, off_mm: 600 },
        Displacement::KnowsWaypoints(NODE),
        Displacement::GrantedTo(NODE, ROBOT),
        Displacement::RackThere(NODE, RACK),
        Displacement::NoWayOut(NODE),
        Displacement::ByHand,
        Displacement::Load { carries: None, expected: Some(RACK) },
        Displacement::Load { carries: Some(RACK), expected: None },
        Displacement::Load { carries: Some(RACK), expected: Some(RackId(1)) },
    ];
    let mut all = vec![
        Why::WaitsFor(ResourceId(0), ROBOT),
        Why::GivesWay(WorkerId(0)),
        Why::Closed(ClosureId(1)),
        Why::QueueFull(STATION),
        Why::NotItsTurn(STATION, ROBOT),
        Why::StationPaused(STATION),
        Why::HandInOpening(STATION),
        Why::NoRoute,
        Why::Failed,
        Why::EmergencyStop,
        Why::Manual,
        Why::Obstructed(NODE),
        Why::Unplugged,
        Why::BlockedBy(ROBOT),
        Why::WayObstructed(NODE),
        Why::Silent,
        Why::Paused,
        Why::Maintenance,
        Why::Leaving,
        Why::Gone,
        Why::Stopped,
        Why::Evacuation,
    ];
    all.extend(displaced.map(Why::Displaced));
    all.iter().copied().for_each(listed);
    all
}

/// Fails to compile where a reason is added; list it above.
fn listed(why: Why) {
    match why {
        Why::WaitsFor(..) | Why::GivesWay(_) | Why::Closed(_) | Why::NoRoute => {}
        Why::QueueFull(_) | Why::NotItsTurn(..) | Why::StationPaused(_) => {}
        Why::HandInOpening(_) => {}
        Why::Failed | Why::EmergencyStop | Why::Manual | Why::Obstructed(_) | Why::Unplugged => {}
        Why::Displaced(_) | Why::BlockedBy(_) | Why::WayObstructed(_) | Why::Silent | Why::Paused => {}
        Why::Maintenance | Why::Leaving | Why::Gone | Why::Stopped | Why::Evacuation => {}
    }
}

fn job_whys() -> Vec<JobWhy> {
    let job = JobId(1);
    let mut all = vec![
        JobWhy::After(job),
        JobWhy::RackBusy(RACK, ROBOT, Some(job)),
        JobWhy::RackBusy(RACK, ROBOT, None),
        JobWhy::RobotBusy(ROBOT, Some(job)),
        JobWhy::RobotBusy(ROBOT, None),
        JobWhy::NoRobot,
        JobWhy::Outranked(JobsAhead { higher: 2, others: 0, more: false }),
        JobWhy::Outranked(JobsAhead { higher: 0, others: 2, more: false }),
        JobWhy::Outranked(JobsAhead { higher: 2, others: 1, more: false }),
        JobWhy::Outranked(JobsAhead { higher: 60, others: 40, more: true }),
        JobWhy::NoKind,
        JobWhy::StationFull(STATION),
        JobWhy::RacksWait(STATION, ROBOT),
        JobWhy::StationPaused(STATION),
        JobWhy::StationBlocked(STATION, ROBOT),
        JobWhy::ClosedOff,
        JobWhy::RackBlocked(RACK, ROBOT),
        JobWhy::WayBlocked(ROBOT),
        JobWhy::WayClosed(ClosureId(1)),
        JobWhy::NoPlace(NodeKind::Charger),
        JobWhy::NoPlace(NodeKind::Parking),
        JobWhy::RobotLow(ROBOT),
    ];
    all.extend(whys().into_iter().map(|why| JobWhy::Robot(ROBOT, why)));
    all
}

#[test]
fn every_reason_why_something_waits_can_be_said_in_other_languages() {
    let (map, patterns) = (Arc::new(lab()), patterns());
    let fleet = Fleet::new(map.clone(), Settings::default());
    let names = Names { map: &map, view: &fleet.view(Time::ZERO) };
    let reasons = whys().into_iter().map(|why| names.why(why));
    let reasons: Vec<String> = reasons.chain(job_whys().into_iter().map(|why| names.why_job(why))).collect();
    let unknown: Vec<&String> = reasons.iter().filter(|text| !is_known(text, &patterns)).collect();
    assert_eq!(unknown, Vec::<&String>::new());
    // As parts of a chain they are predicates.
    let links: Vec<String> = reasons.iter().map(|text| active(text)).collect();
    let unknown: Vec<&String> = links.iter().filter(|text| !is_known(text, &patterns)).collect();
    assert_eq!(unknown, Vec::<&String>::new());
}

#[test]
fn every_remedy_can_be_said_in_other_languages() {
    let patterns = patterns();
    let remedies = AlarmKind::ALL.into_iter().map(AlarmKind::remedy);
    let unknown: Vec<&str> = remedies.filter(|text| !is_known(text, &patterns)).collect();
    assert_eq!(unknown, [""; 0]);
    let misfits = [
        Misfit::TooFew,
        Misfit::TooMany(40),
        Misfit::Absurd(1),
        Misfit::TooClose(0.3),
        Misfit::Scale(1.2),
        Misfit::Residual { rms_m: 0.4, worst: 2 },
        Misfit::Ambiguous,
    ];
    for misfit in misfits {
        let words = [misfit.to_string(), misfit.remedy().to_owned()];
        assert!(words.iter().all(|text| is_known(text, &patterns)), "{words:?}");
    }
}

#[test]
fn a_text_has_the_shape_of_a_pattern_or_it_has_not() {
    assert_eq!(places("waiting for a, held by b", "waiting for {0}, held by {1}"), Some(vec!["a", "b"]));
    assert_eq!(places("waiting for a", "waiting for {0}, held by {1}"), None);
    assert_eq!(places("stands", "stands"), Some(Vec::new()));
    assert!(!is_known("a thing: another", &patterns()), "joining alone says nothing");
}
