//! `giveway experiment safe-space`: the published safe spaces and cases in figures.
//!
//! Main type: [`SafeSpaceArgs`]. Refuses: to compute anything itself.

use crate::safe_space::{Answered, Space, answers, spaces};
use clap::Args;
use giveway_floor::route::Kinematics;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::safe_space::{APART_M, ARM_SPAN_M, Adaptation, Case};
use giveway_people::human::WALK_MPS;
use serde_json::{Value, json};
use std::process::ExitCode;

/// Arguments of `experiment safe-space`.
#[derive(Args)]
pub struct SafeSpaceArgs {
    /// Width of a robot, metres.
    #[arg(long, default_value_t = 0.9)]
    footprint: f64,
    /// Control period, milliseconds.
    #[arg(long, default_value_t = 50)]
    period_ms: i64,
    /// How much later a robot may come before it looks for another route, seconds.
    #[arg(long, default_value_t = 3.0)]
    slack_s: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl SafeSpaceArgs {
    /// Prints both tables.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((0.1..=10.0).contains(&self.footprint), "--footprint must be from 0.1 to 10");
        anyhow::ensure!((1..=1000).contains(&self.period_ms), "--period-ms must be from 1 to 1000");
        anyhow::ensure!((0.0..=60.0).contains(&self.slack_s), "--slack-s must be from 0 to 60");
        let spaces = spaces(Kinematics::default(), self.footprint, self.period_ms as f64 / 1000.0);
        let answers = answers(Span::from_secs_f64(self.slack_s));
        if self.json {
            let report = json!({
                "constants": {"arm_span_m": ARM_SPAN_M, "walking_mps": WALK_MPS, "apart_m": APART_M},
                "spaces": spaces.iter().map(space).collect::<Vec<_>>(),
                "slack_s": self.slack_s,
                "cases": answers.iter().map(answered).collect::<Vec<_>>(),
            });
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            print_spaces(&spaces);
            println!();
            print_answers(&answers);
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn space(s: &Space) -> Value {
    json!({
        "speed_mps": s.speed_mps, "loaded": s.loaded,
        "reaction_s": round(s.times.react_s), "stopping_s": round(s.times.stop_s),
        "eq4_walked_m": round(s.walked_m), "eq7_reacting_m": round(s.reacting_m),
        "eq8_stopping_m": round(s.stopping_m),
        "worker_safe_space_m": round(s.worker_m), "robot_safe_space_m": round(s.robot_m),
        "spaces_touch_m": round(s.worker_m + s.robot_m),
        "ours_stop_m": round(s.stop_m), "ours_separation_m": round(s.separation_m),
    })
}

fn answered(a: &Answered) -> Value {
    let (robot, worker) = (a.zone.robot, a.zone.worker);
    let seconds = |t: Time| t.as_secs_f64();
    json!({
        "robot_s": [seconds(robot.start()), seconds(robot.end())],
        "worker_s": [seconds(worker.start()), seconds(worker.end())],
        "case": number(a.case), "published": word(a.published), "ours": word(a.ours),
    })
}

fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}

/// The case's number in the paper.
fn number(case: Case) -> u8 {
    match case {
        Case::RobotBefore => 1,
        Case::WorkerBefore => 2,
        Case::RobotFirst => 3,
        Case::WorkerFirst => 4,
    }
}

fn word(answer: Adaptation) -> String {
    match answer {
        Adaptation::Keep => "keep".into(),
        Adaptation::Slow(until) => format!("slow, enter at {}", until.as_secs_f64()),
        Adaptation::Change => "change".into(),
    }
}

fn print_spaces(spaces: &[Space]) {
    println!(
        "metres            T_r    T_s   eq. 4  eq. 7  eq. 8    WSS   CRSS  touch | ours: stop  separation"
    );
    for s in spaces {
        let rack = if s.loaded { "rack" } else { "" };
        let speed = format!("{:.1} m/s {rack}", s.speed_mps);
        let touch = s.worker_m + s.robot_m;
        print!("{speed:<14}{:7.2}{:7.2}{:8.2}", s.times.react_s, s.times.stop_s, s.walked_m);
        print!("{:7.2}{:7.2}{:7.2}{:7.2}{touch:7.2}", s.reacting_m, s.stopping_m, s.worker_m, s.robot_m);
        println!(" |{:11.2}{:12.2}", s.stop_m, s.separation_m);
    }
}

fn print_answers(answers: &[Answered]) {
    println!("robot there, s   worker there, s   case   published               ours");
    for a in answers {
        let window = |w: giveway_floor::time::Window| {
            format!("{:.1} to {:.1}", w.start().as_secs_f64(), w.end().as_secs_f64())
        };
        let (robot, worker) = (window(a.zone.robot), window(a.zone.worker));
        println!("{robot:<17}{worker:<18}{:<7}{:<24}{}", number(a.case), word(a.published), word(a.ours));
    }
}
