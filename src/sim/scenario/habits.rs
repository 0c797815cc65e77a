//! The part of a scenario about customers: what they want besides deliveries, how they change their minds, and what
//! operators do by hand.
//!
//! Main type: [`Habits`]. Refuses: impossible shares and rates.

use giveway_site::{SiteError, check};
use serde::Deserialize;

/// What customers and operators do, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Habits {
    /// How often deliveries are wanted, relative to the other kinds.
    pub deliver: f64,
    /// How often a rack is ordered back onto the best storage node.
    #[serde(rename = "return")]
    pub put_back: f64,
    /// How often a rack is ordered onto a given storage node.
    pub relocate: f64,
    /// How often a robot is sent to a charger.
    pub charge: f64,
    /// How often a robot is sent to a parking place.
    pub park: f64,
    /// How often a robot is sent to a node.
    pub go: f64,
    /// Share of jobs with a priority above 0.
    pub priority: f64,
    /// Share of jobs that are due within the hour.
    pub deadline: f64,
    /// Share of jobs that wait for one or two others.
    pub after: f64,
    /// Share of jobs with a key that are submitted twice.
    pub twice: f64,
    /// Share of jobs that are cancelled.
    pub cancel: f64,
    /// Mean time until a job is cancelled, seconds.
    pub cancel_after_s: f64,
    /// Share of deliveries whose rack is wanted at one or two more stations.
    pub more_stops: f64,
    /// Share of jobs that an operator gives to another robot, as long after acceptance as others are cancelled.
    pub reassign: f64,
    /// Share of `go` jobs that name a place where robots may stay, so that some robot is likely to be there.
    pub go_to_places: f64,
    /// How often several robots, or all, are sent to one another's places, per hour.
    pub trades_per_hour: f64,
    /// Share of deliveries with a slow pick.
    pub slow_pick: f64,
    /// Duration of a slow pick, seconds.
    pub slow_pick_s: f64,
    /// Share of picks with missing goods.
    pub short: f64,
    /// How often an operator pauses a robot, per hour.
    pub robot_pauses_per_hour: f64,
    /// How often a station is paused, per hour.
    pub station_pauses_per_hour: f64,
    /// Duration of either pause, seconds.
    pub pause_s: f64,
    /// How often a robot leaves the floor, per hour.
    pub departures_per_hour: f64,
    /// Time until a robot is brought back, seconds.
    pub away_s: f64,
}

impl Default for Habits {
    fn default() -> Habits {
        Habits {
            deliver: 1.0,
            put_back: 0.0,
            relocate: 0.0,
            charge: 0.0,
            park: 0.0,
            go: 0.0,
            priority: 0.0,
            deadline: 0.0,
            after: 0.0,
            twice: 0.0,
            cancel: 0.0,
            cancel_after_s: 60.0,
            more_stops: 0.0,
            reassign: 0.0,
            go_to_places: 0.0,
            trades_per_hour: 0.0,
            slow_pick: 0.0,
            slow_pick_s: 120.0,
            short: 0.0,
            departures_per_hour: 0.0,
            away_s: 300.0,
            robot_pauses_per_hour: 0.0,
            station_pauses_per_hour: 0.0,
            pause_s: 60.0,
        }
    }
}

impl Habits {
    pub(super) fn check(&self) -> Result<(), SiteError> {
        let kinds = [self.deliver, self.put_back, self.relocate, self.charge, self.park, self.go];
        let sum: f64 = kinds.iter().sum();
        check("customers (sum of kinds)", sum, 1e-9..=1e9, "above 0, for some kind of job")?;
        for (key, share) in [
            ("customers.priority", self.priority),
            ("customers.deadline", self.deadline),
            ("customers.after", self.after),
            ("customers.twice", self.twice),
            ("customers.cancel", self.cancel),
            ("customers.more_stops", self.more_stops),
            ("customers.reassign", self.reassign),
            ("customers.go_to_places", self.go_to_places),
            ("customers.slow_pick", self.slow_pick),
            ("customers.short", self.short),
        ] {
            check(key, share, 0.0..=1.0, "from 0 to 1")?;
        }
        for (key, number) in [
            ("customers.cancel_after_s", self.cancel_after_s),
            ("customers.slow_pick_s", self.slow_pick_s),
            ("customers.pause_s", self.pause_s),
        ] {
            check(key, number, 0.1..=1e6, "from 0.1 to 1000000")?;
        }
        check("customers.trades_per_hour", self.trades_per_hour, 0.0..=1e4, "from 0 to 10000")?;
        check("customers.departures_per_hour", self.departures_per_hour, 0.0..=1e4, "from 0 to 10000")?;
        check("customers.away_s", self.away_s, 1.0..=1e6, "from 1 to 1000000")?;
        check("customers.robot_pauses_per_hour", self.robot_pauses_per_hour, 0.0..=1e4, "from 0 to 10000")?;
        check(
            "customers.station_pauses_per_hour",
            self.station_pauses_per_hour,
            0.0..=1e4,
            "from 0 to 10000",
        )?;
        kinds.iter().try_for_each(|k| check("customers (a kind)", *k, 0.0..=1e9, "0 or more"))
    }
}
