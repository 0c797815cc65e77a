//! Jobs that come after others: what becomes of them when those end badly, over restarts too.

use super::*;
use giveway_fleet::internals::ORPHANS_PER_STEP;

fn after(jobs: &[JobId]) -> JobRequest {
    JobRequest { after: jobs.to_vec(), ..request(deliver(5)) }
}

fn submit_all(floor: &mut TestFloor, requests: Vec<JobRequest>) -> Vec<JobId> {
    let submit = |request| Input::ask(7, JobAction::Submit(request));
    let step = floor.step(requests.into_iter().map(submit).collect());
    let job = |reply: &Reply| match reply {
        Reply { answer: Ok(Answer::Job(Made { id: job, new: true })), .. } => *job,
        other => panic!("not accepted: {other:?}"),
    };
    step.replies.iter().map(job).collect()
}

fn failures(facts: &[Fact]) -> usize {
    facts
        .iter()
        .filter(|f| matches!(f, Fact::Job(JobFact::Progressed { state: JobState::Failed(_), .. })))
        .count()
}

fn assert_failed_once(floor: &TestFloor, jobs: &[JobId]) {
    for job in jobs {
        assert_eq!(floor.story(*job), ["failed"], "{job:?}");
    }
}

#[test]
fn dependants_of_a_cancelled_job_fail_a_few_in_each_step_and_none_is_forgotten_over_a_restart() {
    let scenario = scenario(1);
    let mut floor = TestFloor::new(lab(), &scenario);
    let first = floor.submit(request(deliver(3)));
    let direct = submit_all(&mut floor, vec![after(&[first]); 5 * ORPHANS_PER_STEP]);
    let indirect = submit_all(&mut floor, direct.iter().take(40).map(|j| after(&[*j])).collect());
    let step = floor.step(vec![Input::ask(8, JobAction::Cancel(first))]);
    assert_eq!(failures(&step.facts), ORPHANS_PER_STEP, "the journal is not to be flooded");
    floor.restart(&scenario);
    let mut steps = 1;
    while !floor.fleet.ledger().jobs.is_empty() {
        let failed = failures(&floor.step(vec![]).facts);
        assert!(0 < failed && failed <= ORPHANS_PER_STEP, "{failed} fail in step {steps} after the restart");
        steps += 1;
    }
    assert_eq!(steps, (direct.len() + indirect.len()).div_ceil(ORPHANS_PER_STEP));
    assert_failed_once(&floor, &direct);
    assert_failed_once(&floor, &indirect);
    floor.assert_fold();
}

#[test]
fn dependants_of_a_job_that_fails_while_jobs_are_handed_out_fail_too() {
    let mut floor = TestFloor::lab(2);
    let robot = RobotId::at(0);
    floor.step(vec![Input::ask(6, FloorAction::Halt(Some(robot)))]);
    let first = floor.submit(request(JobKind::Park { robot }));
    assert!(floor.is(first, "waiting"), "its robot is halted");
    let second = floor.submit(JobRequest { after: vec![first], ..request(deliver(3)) });
    // As dispatch does when no way leads to the goal of a robot that the customer named.
    let state = JobState::Failed(JobFailure::Unreachable);
    floor.fleet.internals_mut().writer.record(JobFact::Progressed {
        job: first,
        state,
        tasked: None,
        at: floor.now,
    });
    assert!(
        floor.fleet.ledger().index().queue.offers(floor.now, |_| true).next().is_none(),
        "it cannot start"
    );
    floor.step(vec![]);
    assert_eq!(floor.story(second), ["failed"]);
    let why = JobState::Failed(JobFailure::Predecessor(first));
    assert!(floor.progress(second).any(|(s, _)| s == why));
}

#[test]
fn a_job_after_one_that_has_ended_badly_already_fails_and_one_after_a_job_that_is_done_starts() {
    let mut floor = TestFloor::lab(1);
    let done = floor.submit(request(deliver(3)));
    floor.until_over(300);
    let bad = floor.submit(request(deliver(4)));
    floor.cancel(bad).unwrap();
    let [never, now] = [after(&[done, bad]), after(&[done])].map(|r| floor.submit(r));
    floor.until_over(300);
    assert_eq!(floor.story(never), ["failed"]);
    assert_eq!(floor.story(now).last(), Some(&"done"));
}

#[test]
fn a_job_with_several_before_it_starts_when_the_last_of_them_is_done() {
    let mut floor = TestFloor::lab(2);
    let before = [3, 4, 8].map(|rack| floor.submit(request(deliver(rack))));
    let last = floor.submit(after(&[before[0], before[1], before[0], before[2]]));
    assert_eq!(floor.fleet.view(floor.now).blocked[&last], before[0], "the view says what it waits for");
    floor.until_over(600);
    for job in before {
        assert!(floor.when(job, "done") <= floor.when(last, "assigned"), "{job:?} first");
    }
}

#[test]
fn a_bad_end_is_known_for_a_week() {
    let mut ledger = Ledger::new(Arc::new(lab()), &[with_clearance(Span::from_millis(500))], false);
    let accept = |job, after, at| {
        Fact::Job(JobFact::Accepted { job, request: JobRequest { after, ..request(deliver(1)) }, at })
    };
    let day = Span::from_secs(24 * 3600);
    let [bad, soon, late] = [1, 2, 3].map(JobId);
    ledger.evolve(&accept(bad, vec![], Time::ZERO));
    ledger.evolve(&Fact::Job(JobFact::Progressed {
        job: bad,
        state: JobState::Cancelled,
        tasked: None,
        at: Time::ZERO,
    }));
    ledger.evolve(&accept(soon, vec![bad], Time::ZERO + day * 6));
    ledger.evolve(&accept(late, vec![bad], Time::ZERO + day * 7));
    let waits = &ledger.index().waits;
    assert!(waits.is_blocked(soon) && !waits.is_blocked(late));
    assert_eq!(waits.next_doomed(), Some((soon, bad)));
    let state = JobState::Failed(JobFailure::Predecessor(bad));
    ledger.evolve(&Fact::Job(JobFact::Progressed {
        job: soon,
        state,
        tasked: None,
        at: Time::ZERO + day * 8,
    }));
    assert_eq!(ledger.ended_badly.keys().copied().collect::<Vec<_>>(), [soon], "the older one is forgotten");
    ledger.assert_indexed();
}
