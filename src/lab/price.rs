//! What people on a floor cost the robots there, and what the robots cost the people.
//!
//! Main types: [`PriceFloor`], [`Shares`]. Every number of workers is run three times with each seed: people and
//! robots, the robots alone, the people alone. Refuses: to compare runs of different seeds or durations.

use super::statistics::Interval;
use super::table::{RunRow, TableSetup};
use giveway_floor::warehouse::Warehouse;
use giveway_people::aware::NodeWindows;
use giveway_sim::{Causes, Sensor};
use std::sync::Arc;

/// A floor whose price is measured.
#[derive(Clone, Debug)]
pub struct PriceFloor {
    /// The floor's name in reports.
    pub map: String,
    /// The floor's map.
    pub warehouse: Arc<Warehouse>,
    /// Number of robots.
    pub robots: usize,
    /// Numbers of workers.
    pub workers: Vec<usize>,
}

/// What remains of each side's output beside the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Racks served while workers are on the floor, as a share of those served in the same seconds without them.
    pub robot_share: Interval,
    /// Assignments that workers completed, as a share of those they complete on a floor without robots.
    pub human_share: Interval,
}

impl PriceFloor {
    /// The setup of a run with these numbers of robots and workers.
    pub fn setup(&self, robots: usize, workers: usize, seconds: f64, causes: Causes) -> TableSetup {
        let warehouse = self.warehouse.clone();
        let (sensor, node_windows) = (Sensor::default(), NodeWindows::default());
        TableSetup { warehouse, robots, workers, seconds, sensor, causes, node_windows }
    }
}

impl Shares {
    /// Shares from runs of the same seeds in the same order: of both, of the robots alone, of the people alone. A seed
    /// with no output alone is left out.
    pub fn of(both: &[RunRow], robots: &[RunRow], people: &[RunRow]) -> Shares {
        let share = |of: fn(&RunRow) -> f64, alone: &[RunRow]| {
            let pairs = both.iter().zip(alone).filter(|(_, alone)| of(alone) > 0.0);
            Interval::of(&pairs.map(|(both, alone)| of(both) / of(alone)).collect::<Vec<_>>())
        };
        Shares {
            robot_share: share(|row| row.deliveries_beside_workers, robots),
            human_share: share(|row| row.human_deliveries, people),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot_time::TimeUse;
    use giveway_floor::warehouse::thesis;
    use giveway_people::aware::HumanAwarePolicy;

    #[test]
    fn shares_are_of_what_each_side_does_alone_in_the_same_seconds() {
        let workers = vec![1];
        let floor = PriceFloor { map: "thesis".into(), warehouse: Arc::new(thesis()), robots: 8, workers };
        let run = |robots, workers| {
            vec![floor.setup(robots, workers, 400.0, Causes::None).run(HumanAwarePolicy::Giveway, 3)]
        };
        let (both, robots, people) = (run(8, 1), run(8, 0), run(0, 1));
        assert!(
            robots[0].deliveries_beside_workers < robots[0].robot_deliveries,
            "some came before the workers"
        );
        assert_eq!(people[0].robot_deliveries, 0.0);
        let shares = Shares::of(&both, &robots, &people);
        let expected = both[0].deliveries_beside_workers / robots[0].deliveries_beside_workers;
        assert_eq!(shares.robot_share.mean, Some(expected));
        assert_eq!(shares.human_share.mean, Some(both[0].human_deliveries / people[0].human_deliveries));
        for (rows, beside) in [(&both, true), (&robots, false)] {
            let time = &rows[0].robot_time;
            let share = |of| time.share(of).expect("there are robots");
            assert!((TimeUse::ALL.map(share).iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert_eq!(share(TimeUse::GivesWay) > 0.0, beside, "{time:?}");
            assert!(share(TimeUse::Drives) > 0.2 && time.mean_mps().is_some_and(|v| (0.3..1.5).contains(&v)));
        }
        assert_eq!(people[0].robot_time.share(TimeUse::Drives), None, "there are no robots");
        assert_eq!(
            Shares::of(&both, &people, &robots).robot_share.mean,
            None,
            "nothing was served without robots"
        );
    }
}
