//! Drawn floors with corridors: robots leave the line, fail to lift, are halted and closed out, and every job is done
//! once.

use super::*;
use giveway_fleet::FloorAction;
use giveway_floor::warehouse::Corridor;
use giveway_floor::warehouse::formats::json;

/// The simulated warehouse, with corridors in its streets that take what a robot takes on the line.
fn streets() -> Warehouse {
    let mut draft = json::parse_draft(&json::write(&thesis())).expect("it is a map");
    let side_m = draft.footprint_m / 2.0;
    for lane in &mut draft.lanes {
        let is_street = [&lane.from, &lane.to].into_iter().all(|name| name.starts_with('G'));
        lane.corridor = is_street.then_some(Corridor { left_m: side_m, right_m: side_m });
    }
    draft.build().expect("it is a map")
}

/// One drawn floor. Gives how often robots were granted what they asked for, tried again and were dismissed.
fn drawn(seed: u64) -> [usize; 3] {
    let mut chance = Chance { state: seed, ..Chance::default() };
    let mut pick = |n: usize| (chance.unit() * n as f64) as usize;
    let setups = (0..2 + pick(3)).map(|_| standard([Version::V2_1, Version::V3_0, Version::V3_0][pick(3)]));
    let settings = RobotLinkSettings { free_navigation: true, ..settings() };
    let mut floor = LinkFloor::of_kind(streets(), setups.collect(), settings);
    let (lost, doubled, late_ms) = (pick(2) as f64 * 0.05, pick(2) as f64 * 0.1, pick(2) as f64 * 400.0);
    floor.chance = Chance { state: seed + 1, lost, doubled, late_ms };
    floor.all_ready();
    let jobs = floor.submit_deliveries(8);
    // What fails twice needs a person.
    let mut failed = BTreeSet::new();
    for _spell in 0..30 {
        for pair in &mut floor.pairs {
            pair.robot.robot.set_obstructed(pick(4) == 0);
        }
        match pick(8) {
            0 => floor.restart(),
            1 => floor.step(vec![Input::ask(5, FloorAction::Halt(None))]),
            2 => {
                let (x, y) = (3.0 * pick(4) as f64, 7.0 * pick(2) as f64);
                floor.close([x - 0.7, y + 1.6], [x + 0.7, y + 3.4], 60);
            }
            3 => {
                let i = pick(floor.pairs.len());
                let tries_again = floor.pairs[i].session.version() >= Version::V3_0 && failed.insert(i);
                floor.pairs[i].robot.robot.set_handling_fault(tries_again);
                for _period in 0..600 {
                    let state = floor.pairs[i].robot.robot.state();
                    if state.actions.iter().any(|a| a.status == giveway_vda5050::ActionStatus::Retriable) {
                        break;
                    }
                    floor.step(Vec::new());
                }
                floor.pairs[i].robot.robot.set_handling_fault(false);
            }
            _ => {}
        }
        floor.run(1 + pick(15) as i64);
        floor.step(vec![Input::ask(5, FloorAction::Release(None))]);
        // A process that dies before it has lifted its pauses leaves some to a person: robots forget whose they are.
        floor.until(60, "all go on", |f| f.pairs.iter().all(|p| p.robot.robot.state().paused != Some(true)));
    }
    floor.pairs.iter_mut().for_each(|pair| pair.robot.robot.set_obstructed(false));
    floor.until_done(&jobs, 3600);
    for i in 0..floor.pairs.len() {
        let lies: Vec<&Notice> = floor.pairs[i].noticed.iter().filter(|notice| notice.is_lie()).collect();
        // A pose that comes late makes a robot that stands seem to move.
        assert!(lies.is_empty() || late_ms > 0.0, "{lies:?}");
    }
    let told = |is_it: fn(&str) -> bool| {
        floor.pairs.iter().flat_map(|p| p.acts.values()).filter(|a| is_it(a)).count()
    };
    let granted = floor.pairs.iter().flat_map(|pair| &pair.told);
    let granted = granted.filter(|(.., message)| match message {
        Message::Responses(all) => all.iter().any(|r| r.grant == giveway_vda5050::Grant::Granted),
        _ => false,
    });
    [granted.count(), told(|act| act == "retry"), told(|act| act == "trigger")]
}

#[test]
fn robots_that_leave_the_line_fail_and_are_closed_out_do_every_job_once() {
    let seeds = std::env::var("GIVEWAY_LINK_SEEDS").ok().and_then(|text| text.parse().ok()).unwrap_or(6);
    let first = std::env::var("GIVEWAY_LINK_FIRST").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    let mut all = [0; 3];
    for seed in first..=seeds {
        let ran = std::panic::catch_unwind(|| drawn(seed));
        let counts = ran.unwrap_or_else(|_| panic!("seed {seed}"));
        (0..3).for_each(|i| all[i] += counts[i]);
    }
    assert!(all.iter().all(|count| *count > 0), "granted, tried again, dismissed: {all:?}");
}
