//! Figures for Prometheus.
//!
//! Main type: [`Metrics`]: a value, so that two servers in one test do not share it. Refuses: labels without
//! a bound.

use super::dto::{JobCountsDto, state_word};
use super::port::Moment;
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};
use std::sync::atomic::AtomicU64;

/// Labels of an HTTP request.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct HttpLabels {
    /// GET, POST, …
    pub method: String,
    /// The route, not the path.
    pub route: String,
    /// The status.
    pub status: u16,
}

/// A state, of a robot or of a job.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct StateLabel {
    /// Its word.
    pub state: String,
}

/// All figures.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    /// Length of steps, seconds.
    pub step_seconds: Histogram,
    /// Facts written per transaction.
    pub journal_batch: Histogram,
    /// Seconds from a step to its facts being durable.
    pub journal_lag: Histogram,
    /// Facts not durable yet.
    pub journal_pending: Gauge,
    /// Times the database refused.
    pub journal_errors: Counter,
    /// Open live feeds.
    pub live_clients: Gauge,
    /// HTTP requests.
    pub http: Family<HttpLabels, Counter>,
    jobs: Family<StateLabel, Gauge>,
    robots: Family<StateLabel, Gauge>,
    robot_deliveries: Gauge,
    human_deliveries: Gauge,
    encounters: Gauge,
    plans: Gauge,
    plan_failures: Gauge,
    deliveries_per_hour: Gauge<f64, AtomicU64>,
}

impl Default for Metrics {
    fn default() -> Metrics {
        let seconds = [0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0, 5.0];
        let facts = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0];
        let mut m = Metrics {
            registry: Registry::with_prefix("giveway"),
            step_seconds: Histogram::new(seconds),
            journal_batch: Histogram::new(facts),
            journal_lag: Histogram::new(seconds),
            journal_pending: Gauge::default(),
            journal_errors: Counter::default(),
            live_clients: Gauge::default(),
            http: Family::default(),
            jobs: Family::default(),
            robots: Family::default(),
            robot_deliveries: Gauge::default(),
            human_deliveries: Gauge::default(),
            encounters: Gauge::default(),
            plans: Gauge::default(),
            plan_failures: Gauge::default(),
            deliveries_per_hour: Gauge::default(),
        };
        m.register();
        m
    }
}

impl Metrics {
    fn register(&mut self) {
        let r = &mut self.registry;
        r.register_with_unit("step", "Length of control steps", Unit::Seconds, self.step_seconds.clone());
        r.register("journal_batch_facts", "Facts written per transaction", self.journal_batch.clone());
        let lag = "From a step to its facts being durable";
        r.register_with_unit("journal_lag", lag, Unit::Seconds, self.journal_lag.clone());
        r.register("journal_pending_facts", "Facts not durable yet", self.journal_pending.clone());
        r.register("journal_errors", "Times the database refused", self.journal_errors.clone());
        r.register("live_clients", "Open live feeds", self.live_clients.clone());
        r.register("http_requests", "HTTP requests by route and status", self.http.clone());
        r.register("jobs", "Jobs by state", self.jobs.clone());
        r.register("robots", "Robots by state", self.robots.clone());
        r.register("robot_deliveries", "Racks served at stations", self.robot_deliveries.clone());
        r.register("human_deliveries", "Assignments completed by workers", self.human_deliveries.clone());
        r.register("encounters", "Encounters of robots and workers", self.encounters.clone());
        r.register("plans", "Routes planned", self.plans.clone());
        r.register("plan_failures", "Searches that found no route", self.plan_failures.clone());
        r.register("deliveries_per_hour", "Racks served per hour, lately", self.deliveries_per_hour.clone());
    }

    /// All figures as text, those of the fleet as of `moment`.
    pub fn text(&self, moment: &Moment) -> String {
        let counts = moment.view.counts;
        let label = |state: &str| StateLabel { state: state.into() };
        let jobs = JobCountsDto::from(counts);
        let by_state = [
            ("waiting", jobs.waiting),
            ("active", jobs.active),
            ("done", jobs.done),
            ("cancelled", jobs.cancelled),
            ("failed", jobs.failed),
        ];
        for (state, n) in by_state {
            self.jobs.get_or_create(&label(state)).set(n.cast_signed());
        }
        for state in ["idle", "busy", "free", "interrupted", "failed"] {
            let n = moment.view.robots.iter().filter(|r| state_word(r.state) == state).count();
            self.robots.get_or_create(&label(state)).set(n as i64);
        }
        self.robot_deliveries.set(counts.robot_deliveries.cast_signed());
        self.human_deliveries.set(counts.human_deliveries.cast_signed());
        self.encounters.set(counts.encounters.cast_signed());
        self.plans.set(counts.plans.cast_signed());
        self.plan_failures.set(counts.plan_failures.cast_signed());
        self.deliveries_per_hour.set(moment.measured.deliveries_per_hour);
        let mut text = String::new();
        encode(&mut text, &self.registry).expect("writing into a string does not fail");
        text
    }
}
