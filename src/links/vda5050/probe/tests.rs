//! The probe against virtual robots that behave as three real ones were measured to, and against one that follows the
//! standard. Messages travel as bytes, a tenth of a second each way.

use super::*;
use giveway_vda5050::robot::{
    CancelHabit, InstantBatch, InstantHabit, PauseHabit, ReadMessage, WireMessage, WireRobot,
};
use giveway_vda5050::{ConnectionState, RobotQuirks, RobotSetup};

const TICK_US: i64 = 50_000;
/// Messages travel for this many steps.
const STEPS: i64 = 2;

/// What is on its way.
struct ProbeBench {
    robot: WireRobot,
    probe: RobotProbe,
    to_robot: Vec<(i64, TopicKind, Vec<u8>)>,
    to_probe: Vec<(i64, WireMessage)>,
    /// All that the probe sent.
    sent: Vec<ProbeMessage>,
    /// The farthest that the robot was from where it began, metres.
    farthest_m: f64,
}

impl ProbeBench {
    fn new(setup: RobotSetup, goal: Option<Point>) -> ProbeBench {
        let address = Address::new(&setup.manufacturer, &setup.serial).expect("an address");
        ProbeBench {
            robot: WireRobot::new(setup),
            probe: RobotProbe::new(address, goal, "t"),
            to_robot: Vec::new(),
            to_probe: Vec::new(),
            sent: Vec::new(),
            farthest_m: 0.0,
        }
    }

    /// Runs the probe to its end. The robot has been online for a while.
    fn run(mut self) -> ProbeBench {
        for tick in 0..20_000 {
            let (now_us, level) = (tick * TICK_US, self.robot.setup().version.topic_level());
            let read: Vec<ReadMessage> = (self.to_robot.extract_if(.., |(due, ..)| *due <= tick))
                .map(|(_, kind, payload)| self.robot.read(kind, &payload))
                .collect();
            let said = self.robot.step(now_us, "2026-01-01T00:00:00.000Z", read);
            self.to_probe.extend(said.into_iter().map(|said| (tick + STEPS, said)));
            let now = Time(now_us);
            for (_, said) in self.to_probe.extract_if(.., |(due, _)| *due <= tick) {
                self.probe.hear(now, level, said.kind, &said.payload);
            }
            for told in self.probe.tick(now, "2026-01-01T00:00:00.000Z") {
                if told.version.topic_level() == level {
                    self.to_robot.push((tick + STEPS, told.kind, told.payload.clone()));
                }
                self.sent.push(told);
            }
            let body = self.robot.body.body().report(Vec::new());
            self.farthest_m = self.farthest_m.max(body.x.hypot(body.y));
            if self.probe.is_over() {
                return self;
            }
        }
        panic!("the probe {} for ever", self.probe.stage())
    }

    fn json(&self) -> Value {
        self.probe.findings().to_json()
    }
}

fn driven(setup: RobotSetup) -> Value {
    ProbeBench::new(setup, Some(Point::new(8.0, 0.0))).run().json()
}

/// Compares some findings.
fn check(found: &Value, expected: Value) {
    for (key, value) in expected.as_object().expect("an object") {
        assert_eq!(&found[key], value, "{key}: {found:#}");
    }
}

#[test]
fn a_robot_that_follows_the_standard_is_found_to_do_so_in_each_version() {
    for version in Version::ALL {
        let setup = RobotSetup::new(version, "maker", "r1", "hall", "n0");
        let found = driven(setup);
        check(
            &found,
            serde_json::json!({
                "version": version.text(), "factsheet": "valid", "pause": "at once", "cancel": "at once",
                "actions": "refused", "repeat": "safe", "alive": true, "robot": "maker/r1",
            }),
        );
        check(
            &found["quirks"],
            serde_json::json!({"instant_actions_key": "actions", "deviation_key": "allowedDeviationXY",
                "idle_pause": "obeyed", "idle_cancel": "failed", "localized": null, "driving": null,
                "errors_stand": null}),
        );
        assert_eq!(found["kind"]["link"]["maps"], serde_json::json!({"hall": {}}));
        assert_eq!(found["kind"]["fleet"]["speed_mps"], 1.5);
        assert_eq!(found["kind"]["link"]["longest_base_m"], Value::Null);
        assert_eq!(found["ask"], serde_json::json!([]), "there is nothing to ask");
    }
}

#[test]
fn a_robot_like_a_has_its_own_keys_and_an_empty_factsheet_and_survives() {
    let found = driven(RobotSetup::like_a());
    check(
        &found,
        serde_json::json!({
            "version": "2.0.0", "factsheet": "empty", "pause": "at once", "cancel": "at once", "actions": "refused",
            "repeat": "safe", "alive": true,
        }),
    );
    check(
        &found["quirks"],
        serde_json::json!({"instant_actions_key": "instantActions", "deviation_key": "allowedDeviationXy",
            "idle_cancel": "error only"}),
    );
    let spelt = &found["kind"]["link"]["quirks"];
    assert_eq!(spelt["instant_actions_key"], "instantActions");
    assert_eq!(spelt["deviation_key"], "allowedDeviationXy");
}

#[test]
fn a_robot_like_b_hears_pauses_and_cancels_when_it_stands_and_does_actions_that_do_not_exist() {
    let found = driven(RobotSetup::like_b());
    check(
        &found,
        serde_json::json!({
            "version": "2.1.0", "factsheet": "none", "pause": "late", "cancel": "late", "actions": "claims",
            "repeat": "safe", "alive": true,
        }),
    );
    assert_eq!(found["kind"]["link"]["longest_base_m"], 1.5);
    assert_eq!(found["quirks"]["instant_actions_key"], "actions");
}

#[test]
fn a_robot_like_c_claims_cancels_skips_actions_and_takes_repetitions_for_fatal() {
    let found = driven(RobotSetup::like_c());
    check(
        &found,
        serde_json::json!({
            "version": "2.0.0", "factsheet": "invalid", "pause": "none", "cancel": "claims", "actions": "silent",
            "repeat": "fatal", "alive": true,
        }),
    );
    check(
        &found["quirks"],
        serde_json::json!({"localized": "never", "driving": "never", "paused": "absent", "loads": "absent",
            "idle_pause": "failed", "idle_cancel": "finished", "deviation_key": "allowedDeviationXY",
            "errors_stand": ["orderUpdateError"]}),
    );
    check(
        &found["kind"]["link"]["quirks"],
        serde_json::json!({"repeat": "never", "localized": "ignored", "instant_actions_key": "actions"}),
    );
    let asked = found["ask"].as_array().expect("questions");
    assert!(asked.iter().any(|text| text.as_str().is_some_and(|t| t.contains("drives on"))), "{found:#}");
}

#[test]
fn without_a_place_to_drive_to_no_robot_moves_and_what_was_not_tried_is_said_so() {
    for setup in [RobotSetup::like_a(), RobotSetup::like_b(), RobotSetup::like_c()] {
        let bench = ProbeBench::new(setup, None).run();
        assert!(bench.farthest_m < 0.01, "{}", bench.farthest_m);
        let found = bench.json();
        assert_eq!((&found["cancel"], &found["alive"]), (&"not tried".into(), &true.into()));
        assert_ne!(found["repeat"], "not tried", "{found:#}");
    }
}

#[test]
fn each_message_has_one_instant_action_and_none_moves_or_handles_anything() {
    let setup = RobotSetup::new(Version::V2_1, "maker", "r1", "hall", "n0");
    let quirks = RobotQuirks { instant_batch: InstantBatch::DiesOfTwo, ..RobotQuirks::default() };
    let bench = ProbeBench::new(RobotSetup { quirks, ..setup }, Some(Point::new(6.0, 0.0))).run();
    let known = ["stateRequest", "factsheetRequest", "startPause", "stopPause", "cancelOrder"];
    let mut seen = 0;
    for told in bench.sent.iter().filter(|told| told.kind == TopicKind::InstantActions) {
        let text: Value = serde_json::from_slice(&told.payload).expect("JSON");
        let actions = text["actions"].as_array().or(text["instantActions"].as_array()).expect("actions");
        let kind = actions[0]["actionType"].as_str().expect("a type");
        assert!(actions.len() == 1 && known.contains(&kind), "{text}");
        seen += 1;
    }
    assert!(seen > 10 && bench.robot.body.robot.is_alive(), "{seen}");
}

#[test]
fn robots_that_stop_at_nodes_or_only_say_that_they_go_on_are_told_from_others() {
    let with = |quirks: RobotQuirks| {
        let setup = RobotSetup::new(Version::V2_1, "maker", "r1", "hall", "n0");
        driven(RobotSetup { quirks, ..setup })
    };
    let at_nodes = with(RobotQuirks {
        pause: PauseHabit::AtNextNode,
        cancel: CancelHabit::AtNextNode,
        ..RobotQuirks::default()
    });
    check(&at_nodes, serde_json::json!({"pause": "at nodes", "cancel": "at nodes"}));
    assert_eq!(at_nodes["kind"]["link"]["longest_base_m"], 1.5);
    let claimed = with(RobotQuirks { instant_actions: InstantHabit::Claimed, ..RobotQuirks::default() });
    let asked = claimed["ask"].to_string();
    assert!(
        asked.contains("still paused after stopPause"),
        "it pauses, and only says that it goes on: {asked}"
    );
}

#[test]
fn a_robot_that_is_not_there_ends_the_probe_in_words() {
    let mut probe = RobotProbe::new(Address::new("maker", "none").expect("an address"), None, "t");
    let mut now = Time::ZERO;
    while !probe.is_over() {
        now += Span::from_millis(100);
        probe.tick(now, "2026-01-01T00:00:00.000Z");
        assert!(now < Time::ZERO + Span::from_secs(120), "{}", probe.stage());
    }
    let found = probe.findings().to_json();
    assert_eq!((&found["version"], &found["alive"]), (&Value::Null, &false.into()));
    assert!(found["ask"][0].as_str().is_some_and(|text| text.contains("switched on")), "{found:#}");
}

#[test]
fn a_robot_that_says_states_without_online_is_noticed() {
    let mut bench = ProbeBench::new(RobotSetup::new(Version::V2_0, "maker", "r1", "hall", "n0"), None).run();
    assert_eq!(bench.json()["reconnect"], "not tried");
    bench.probe.findings.connection = Some(ConnectionState::Broken);
    assert_eq!(bench.json()["reconnect"], "unannounced");
}
