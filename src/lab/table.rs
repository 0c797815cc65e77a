//! Robots and people together, under four policies: Table 4.1 of Petković 2021 with our own arm beside it.
//!
//! Main types: [`TableSetup`], [`RunRow`], [`Column`]. Every arm meets the same seeds, and people's impulses do not
//! depend on the arm. Refuses: threads and files; the caller runs [`TableSetup::run`] as often, and on as many cores,
//! as it likes.

use super::robot_time::RobotTime;
use super::statistics::{Interval, Summary};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_sim::measure::detection::Score;
use giveway_sim::{
    CalmFigures, Causes, Demand, Deviations, EncounterFigures, Outcome, Scenario, Sensor, Simulation, Workers,
};
use giveway_site::{Site, SiteLinks};
use std::sync::Arc;

/// When workers enter, seconds (Petković 2021, figure 4.8).
pub const ENTER_S: f64 = 250.0;
/// When workers deviate, seconds (Petković 2021, figure 4.8).
const DEVIATE_S: [f64; 6] = [300.0, 320.0, 420.0, 450.0, 500.0, 625.0];
/// Interval between two looks at what robots do.
const LOOK_EVERY: Span = Span::from_secs(1);

/// One experiment, to be run with many seeds.
#[derive(Clone, Debug)]
pub struct TableSetup {
    /// The hall.
    pub warehouse: Arc<Warehouse>,
    /// Number of robots.
    pub robots: usize,
    /// Number of people.
    pub workers: usize,
    /// Duration of a run, seconds.
    pub seconds: f64,
    /// How devices see people.
    pub sensor: Sensor,
    /// Why people leave their paths besides the six departures of the published experiment.
    pub causes: Causes,
    /// How the fleet predicts when people occupy a node.
    pub node_windows: NodeWindows,
}

/// Figures of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRow {
    /// Racks served at stations.
    pub robot_deliveries: f64,
    /// How robots spent their time after the workers entered.
    pub robot_time: RobotTime,
    /// Racks that were served after the workers entered.
    pub deliveries_beside_workers: f64,
    /// Assignments that workers truly completed.
    pub human_deliveries: f64,
    /// Encounters of moving robots with workers, per minute of workers on the floor.
    pub encounters_per_worker_minute: f64,
    /// Robots that had to stop or to go elsewhere because of a worker, per true deviation.
    pub interruptions_per_deviation: f64,
    /// Routes planned anew because of workers.
    pub replans: f64,
    /// Share of the workers' time spent kept in one spot, counting only standstills of a minute or more.
    pub standstill_share: f64,
    /// Encounters with robots as a curve.
    pub met: EncounterFigures,
    /// Number of minutes that workers were kept in one spot, counting only standstills of a minute or more.
    pub standstills: u64,
    /// How calm guidance was, and the number of minutes that workers were on the floor.
    pub calm: (CalmFigures, f64),
    /// Scores of detected deviations and goals.
    pub score: Score,
    /// Broken laws, in words.
    pub broken: Vec<String>,
    /// Number of broken laws.
    pub law_violations: u64,
}

/// A figure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Racks served.
    RobotDeliveries,
    /// Assignments completed.
    HumanDeliveries,
    /// Racks served and assignments completed.
    TotalDeliveries,
    /// Encounters per minute of workers on the floor.
    EncountersPerWorkerMinute,
    /// Interrupted robots per deviation.
    InterruptionsPerDeviation,
    /// Routes planned anew because of workers.
    Replans,
    /// Share of the workers' time in which robots kept them in one spot for a minute.
    StandstillShare,
}

impl Column {
    /// All columns, in the order of the table.
    pub const ALL: [Column; 7] = [
        Column::RobotDeliveries,
        Column::HumanDeliveries,
        Column::TotalDeliveries,
        Column::EncountersPerWorkerMinute,
        Column::InterruptionsPerDeviation,
        Column::Replans,
        Column::StandstillShare,
    ];

    /// The column's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            Column::RobotDeliveries => "robot_deliveries",
            Column::HumanDeliveries => "human_deliveries",
            Column::TotalDeliveries => "total_deliveries",
            Column::EncountersPerWorkerMinute => "encounters_per_worker_minute",
            Column::InterruptionsPerDeviation => "interruptions_per_deviation",
            Column::Replans => "replans",
            Column::StandstillShare => "standstill_share",
        }
    }

    /// The column's value for a run.
    pub fn of(self, row: &RunRow) -> f64 {
        match self {
            Column::RobotDeliveries => row.robot_deliveries,
            Column::HumanDeliveries => row.human_deliveries,
            Column::TotalDeliveries => row.robot_deliveries + row.human_deliveries,
            Column::EncountersPerWorkerMinute => row.encounters_per_worker_minute,
            Column::InterruptionsPerDeviation => row.interruptions_per_deviation,
            Column::Replans => row.replans,
            Column::StandstillShare => row.standstill_share,
        }
    }

    /// The column's summary over many runs.
    pub fn summary(self, rows: &[RunRow]) -> Summary {
        Summary::of(&rows.iter().map(|r| self.of(r)).collect::<Vec<_>>())
    }

    /// Differences of this column between two arms, seed by seed.
    pub fn paired(self, ours: &[RunRow], theirs: &[RunRow]) -> Interval {
        let all = |rows: &[RunRow]| rows.iter().map(|r| self.of(r)).collect::<Vec<_>>();
        Interval::of_pairs(&all(ours), &all(theirs))
    }
}

impl TableSetup {
    /// The scenario of one run.
    pub fn scenario(&self, arm: HumanAwarePolicy, seed: u64) -> Scenario {
        let deviations = Deviations { at_s: DEVIATE_S.to_vec(), causes: self.causes };
        let workers = Workers {
            count: self.workers,
            enter_s: ENTER_S,
            deviations,
            sensor: self.sensor,
            ..Workers::default()
        };
        let site = Site {
            name: format!("table-4-1 {} {}", arm.word(), self.workers),
            period: Span::from_millis(100),
            node_windows: self.node_windows,
            policy: arm,
            links: SiteLinks::simulated(self.robots),
            ..Site::default()
        };
        Scenario {
            duration: Span::from_secs_f64(self.seconds),
            seed,
            demand: Demand::Backlog(self.robots),
            workers,
            ..Scenario::from(site)
        }
    }

    /// Runs the experiment once.
    pub fn run(&self, arm: HumanAwarePolicy, seed: u64) -> RunRow {
        let scenario = self.scenario(arm, seed);
        let mut sim = Simulation::new(self.warehouse.clone(), &scenario, &[], seed, false, || 0);
        let enter = Time::from_secs_f64(ENTER_S);
        let (mut before, mut robot_time, mut next_look) = (0, RobotTime::default(), enter);
        while !sim.is_over() {
            if sim.now() <= enter {
                before = sim.robot_deliveries();
            }
            sim.step();
            if sim.now() > next_look {
                robot_time.look(sim.fleet(), sim.now());
                next_look = sim.now() + LOOK_EVERY;
            }
        }
        RunRow::of(&sim.outcome(), before, robot_time)
    }
}

impl RunRow {
    /// The row of a run in which `before` racks had been served when the workers entered.
    fn of(outcome: &Outcome, before: u64, robot_time: RobotTime) -> RunRow {
        let Outcome { counts, people, .. } = outcome;
        let minutes = people.figures.worker_time.as_secs_f64() / 60.0;
        let per = |n: u64, of: f64| if of > 0.0 { n as f64 / of } else { 0.0 };
        RunRow {
            robot_deliveries: counts.robot_deliveries as f64,
            robot_time,
            deliveries_beside_workers: (counts.robot_deliveries - before) as f64,
            human_deliveries: people.completed as f64,
            encounters_per_worker_minute: per(people.figures.encounters, minutes),
            interruptions_per_deviation: per(counts.interruptions, people.score.deviations() as f64),
            replans: counts.replans as f64,
            standstill_share: per(people.standstills, minutes),
            met: people.figures.clone(),
            standstills: people.standstills,
            calm: (people.calm, minutes),
            score: people.score.clone(),
            broken: outcome.broken.clone(),
            law_violations: outcome.law_violations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;

    fn setup() -> TableSetup {
        let warehouse = Arc::new(thesis());
        TableSetup {
            warehouse,
            robots: 8,
            workers: 1,
            seconds: 340.0,
            sensor: Sensor::default(),
            causes: Causes::All,
            node_windows: NodeWindows::default(),
        }
    }

    #[test]
    fn a_run_of_one_seed_is_the_same_twice_and_has_people_in_it() {
        let row = setup().run(HumanAwarePolicy::Giveway, 3);
        assert_eq!(row, setup().run(HumanAwarePolicy::Giveway, 3));
        assert!(row.score.hours > 85.0 / 3600.0 && row.score.deviations() > 0, "{:?}", row.score);
        assert_eq!(row.law_violations, 0, "{:?}", row.broken);
    }

    #[test]
    fn what_workers_set_out_for_does_not_depend_on_the_arm() {
        let deviations = |arm| {
            let scenario = setup().scenario(arm, 5);
            let mut sim = Simulation::new(setup().warehouse, &scenario, &[], 5, false, || 0);
            while !sim.is_over() {
                sim.step();
            }
            let logs = sim.world.walkers().map(|(_, w)| w.log().segments().to_vec());
            let scripted = logs.flatten().filter(|s| s.cause == giveway_sim::WalkCause::Scripted);
            scripted.map(|s| s.from).collect::<Vec<_>>()
        };
        assert_eq!(deviations(HumanAwarePolicy::Nhir), deviations(HumanAwarePolicy::Giveway));
        assert_eq!(deviations(HumanAwarePolicy::Nhir).len(), 2);
    }
}
