//! Messages that are repeated, late, out of order or lost: nothing but state decides.

use super::*;

#[test]
fn repeated_late_and_shuffled_telemetry_changes_nothing() {
    let mut floor = TestFloor::thesis(5);
    let mut noisy =
        Fleet::restore(floor.fleet.warehouse().clone(), floor.fleet.settings().clone(), floor.facts.clone());
    let (mut dice, mut old, mut extra) = (TestDice(1), Vec::<Input>::new(), 0);
    let mut wanted: Vec<JobKind> = (0..15).map(|i| deliver(i * 4)).collect();
    while floor.now < Time::from_secs_f64(300.0) {
        let mut inputs = floor.world.advance(floor.now, floor.fleet.ledger());
        let (news, picks): (Vec<Input>, Vec<Input>) =
            inputs.iter().cloned().partition(|i| matches!(i, Input::Telemetry(_)));
        let mut heard = news.clone();
        for _ in 0..4 {
            if !old.is_empty() {
                heard.push(old[dice.below(old.len())].clone());
                extra += 1;
            }
        }
        heard.extend(news.iter().cloned());
        heard.extend(picks);
        dice.shuffle(&mut heard);
        old.extend(news);
        if old.len() > 400 {
            old.drain(..100);
        }
        if let Some(kind) = wanted.pop() {
            let submit = Input::ask(1, JobAction::Submit(request(kind)));
            inputs.push(submit.clone());
            heard.push(submit);
        }
        let (clean, loud) = (floor.fleet.step(floor.now, inputs), noisy.step(floor.now, heard));
        assert_eq!(clean, loud, "at {}", floor.now);
        floor.world.take(floor.now, &clean);
        floor.now += floor.fleet.settings().period;
    }
    assert!(floor.done() >= 5 && extra > 1000, "{} jobs done, {extra} old messages", floor.done());
}

#[track_caller]
fn check_batch(faults: Faults, seconds: i64) {
    let mut floor = TestFloor::new(thesis(), &Scenario { faults, ..scenario(5) });
    let jobs = floor.submit_batch(20);
    floor.until_over(seconds);
    floor.assert_done_once(&jobs);
    for job in jobs {
        assert_eq!(floor.story(job), ["assigned", "carrying", "picking", "done"]);
    }
}

#[test]
fn a_batch_is_done_although_a_third_of_all_messages_is_lost() {
    check_batch(Faults { message_loss: 0.3, ..Faults::default() }, 2000);
}

#[test]
fn a_batch_is_done_although_nearly_all_messages_are_lost() {
    check_batch(Faults { message_loss: 0.9, ..Faults::default() }, 7200);
}

#[test]
fn a_batch_is_done_although_messages_take_two_seconds() {
    check_batch(Faults { message_delay_ms: 2000, ..Faults::default() }, 3600);
}
