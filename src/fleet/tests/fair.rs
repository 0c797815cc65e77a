//! Jobs begin in the order of urgency: a rack in high demand keeps its robot from no job that is more urgent.

use super::*;
use giveway_fleet::state::index::urgency_ms;
use giveway_floor::warehouse::formats;
use std::collections::BTreeSet;

/// The map of `docs/maps.md`: two racks, one station.
fn small(robots: usize) -> TestFloor {
    let map = formats::json::parse(include_str!("../../../docs/small.json")).expect("a map");
    TestFloor::new(map, &scenario(robots))
}

fn quick(rack: u32, priority: u8) -> JobRequest {
    let kind = JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: Some(Span::from_secs(4)) };
    JobRequest { priority, ..request(kind) }
}

/// One robot works on a rack for which a job comes every four seconds, as fast as they are picked; then a job for the
/// other rack comes that only this robot may do, whether or not another robot rests. Returns how many jobs for the
/// first rack begin after this job comes and before it begins, and after how many seconds it is done.
fn passed_by(robots: usize, priority: u8) -> (usize, i64) {
    let mut floor = small(robots);
    floor.submit(quick(1, 0));
    floor.submit(quick(1, 0));
    floor.run(15);
    let busy =
        floor.fleet.ledger().robots.pairs().find(|(_, r)| r.task != Task::Idle).expect("one is at work").0;
    let other = floor.submit(quick(0, priority));
    if robots > 1 {
        floor.step(vec![Input::ask(9, JobAction::Reassign(other, Some(busy)))]);
    }
    let (since, before) = (floor.now, floor.facts.len());
    while floor.is(other, "waiting") {
        assert!(floor.now - since < Span::from_secs(600), "it never begins");
        floor.submit(quick(1, 0));
        floor.run(4);
    }
    let begun = |facts: &[Fact]| -> BTreeSet<JobId> {
        let begins = |fact: &Fact| match fact {
            Fact::Job(JobFact::Progressed {
                job,
                state: JobState::Assigned { .. } | JobState::Carrying { .. },
                ..
            }) => Some(*job),
            _ => None,
        };
        facts.iter().filter_map(begins).filter(|job| *job != other).collect()
    };
    let begun = begun(&floor.facts).difference(&begun(&floor.facts[..before])).count();
    floor.until(120, "it is done", |f| f.state(other).is_none());
    (begun, (floor.now - since).0 / 1_000_000)
}

#[test]
fn an_urgent_job_begins_after_the_pick_that_goes_on_however_much_another_rack_is_wanted() {
    let (begun, done_s) = passed_by(1, 9);
    assert!(begun <= 1, "{begun} jobs of priority 0 began before it");
    assert!(done_s < 120, "done after {done_s} s");
}

#[test]
fn an_urgent_job_is_not_passed_by_because_a_robot_rests_that_may_not_do_it() {
    let (begun, done_s) = passed_by(2, 9);
    assert!(begun <= 1, "{begun} jobs of priority 0 began before it");
    assert!(done_s < 120, "done after {done_s} s");
}

#[test]
fn of_two_racks_in_demand_with_jobs_of_one_priority_none_is_kept_from_the_station_for_long() {
    let (begun, done_s) = passed_by(1, 0);
    assert!(begun > 3, "the rack that is at the station stays there for a while: {begun}");
    assert!(done_s < 360, "done after {done_s} s, while {begun} younger ones began");
}

#[test]
fn eight_minutes_of_waiting_are_worth_a_priority() {
    let at = |s: i64| Time::ZERO + Span::from_secs(s);
    let urgency = |priority, accepted_s| urgency_ms(priority, at(accepted_s), None, at(6000), at(0));
    for priority in 0..9 {
        assert_eq!(urgency(priority, 480), urgency(priority + 1, 960));
    }
    assert_eq!(urgency(0, 0), urgency(9, 9 * 480), "so that even the least comes to be the first");
}

#[test]
fn jobs_that_name_a_robot_age_too() {
    let mut floor = TestFloor::lab(1);
    let robot = RobotId(0);
    let old = floor.submit(request(JobKind::Park { robot }));
    floor.until(60, "it is done", |f| f.state(old).is_none());
    floor.step(vec![Input::ask(4, FloorAction::Halt(Some(robot)))]);
    let old = floor.submit(request(JobKind::Park { robot }));
    floor.run(485);
    let young = floor.submit(JobRequest { priority: 1, ..request(JobKind::Park { robot }) });
    assert_eq!(
        floor.fleet.internals().writer.floor().named_job_for(robot),
        Some(old),
        "{young:?} has a priority more"
    );
    let urgent = floor.submit(JobRequest { priority: 2, ..request(JobKind::Park { robot }) });
    assert_eq!(floor.fleet.internals().writer.floor().named_job_for(robot), Some(urgent));
}

#[test]
fn a_job_in_line_says_how_many_are_before_it() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(60, "the robot has it", |f| f.is(first, "assigned"));
    let plain = |rack| request(deliver(rack));
    let [old, own] = [4, 5].map(|rack| floor.submit(plain(rack)));
    let urgent: Vec<JobId> =
        [6, 7].into_iter().map(|rack| floor.submit(JobRequest { priority: 5, ..plain(rack) })).collect();
    let why = |f: &TestFloor, job| {
        f.fleet.view(f.now).why_job(f.fleet.warehouse(), job, &f.fleet.ledger().jobs[&job])
    };
    assert_eq!(why(&floor, urgent[0]), Some(JobWhy::NoRobot), "it is the first in line");
    let ahead = |higher, others| Some(JobWhy::Outranked(JobsAhead { higher, others, more: false }));
    assert_eq!(why(&floor, urgent[1]), ahead(0, 1));
    assert_eq!((why(&floor, old), why(&floor, own)), (ahead(2, 0), ahead(2, 1)));
    let chain = floor.fleet.job_waits(own, floor.now);
    assert_eq!((chain.len(), chain[0].ahead), (1, 3), "{chain:?}");
}
