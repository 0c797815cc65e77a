//! Metrics for Prometheus.
//!
//! Main type: [`Metrics`]: a value, so that two servers in one test do not share it. Refuses: labels with unlimited
//! values.

use crate::dto::names::JobCountsDto;
use crate::port::linked::LinkTally;
use crate::port::moment::Moment;
use crate::wire::words::RobotStateDto;
use giveway_fleet::alarm::Alarm;
use giveway_fleet::{Activity, FeedCounts, InsertionCounts, Presence, View};
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
    /// The HTTP status.
    pub status: u16,
}

/// The state of a robot, a job or a worker.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct StateLabel {
    /// The state's word.
    pub state: String,
}

/// The activity of a robot.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct ActivityLabel {
    /// The activity's word.
    pub activity: &'static str,
}

/// The horizon of a forecast.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct HorizonLabel {
    /// How far ahead, in seconds.
    pub seconds: String,
}

/// The reason for a refusal.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct ReasonLabel {
    /// The reason's word.
    pub reason: &'static str,
}

/// The direction of a message.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct DirectionLabel {
    /// `in` or `out`.
    pub direction: &'static str,
}

/// The kind and severity of an alarm.
#[derive(Clone, Debug, Hash, PartialEq, Eq, EncodeLabelSet)]
pub struct AlarmLabels {
    /// The word for the kind.
    pub kind: &'static str,
    /// notice, warning or critical.
    pub severity: &'static str,
}

/// All metrics.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    /// Duration of steps, seconds.
    pub step_seconds: Histogram,
    /// Facts written per transaction.
    pub journal_batch: Histogram,
    /// Seconds from a step to its facts being durable.
    pub journal_lag: Histogram,
    /// Facts that are not durable yet.
    pub journal_pending: Gauge,
    /// How often the database refused to write.
    pub journal_errors: Counter,
    /// Open live feeds.
    pub live_clients: Gauge,
    /// Open streams of events.
    pub event_streams: Gauge,
    /// Open feeds of headsets.
    pub feeds: Gauge,
    /// Poses that arrived over feeds, as far as they were read.
    pub poses_received: Counter,
    /// Poses left out because they came faster than sixty a second.
    pub poses_thinned: Counter,
    poses_refused: Family<ReasonLabel, Counter>,
    /// Hands that were left out of poses because they are impossible.
    pub hands_refused: Counter,
    /// Seconds from the arrival of a pose to the stop that is sent to a worker because of it.
    pub pose_to_stop: Histogram,
    /// Seconds from the arrival of a pose to the stop that is sent to a robot in the step that took the pose.
    pub pose_to_robot_stop: Histogram,
    /// Seconds from the sighting of a hand going wrong to the warning that is sent to its wearer.
    pub hand_to_warning: Histogram,
    /// Messages from and to robots of other vendors.
    link_messages: Family<DirectionLabel, Counter>,
    link_malformed: Counter,
    order_to_state: Histogram,
    link_robots: Family<StateLabel, Gauge>,
    /// HTTP requests.
    pub http: Family<HttpLabels, Counter>,
    alarms: Family<AlarmLabels, Gauge>,
    jobs: Family<StateLabel, Gauge>,
    robots: Family<StateLabel, Gauge>,
    activities: Family<ActivityLabel, Gauge>,
    longest: Family<ActivityLabel, Gauge<f64, AtomicU64>>,
    robot_deliveries: Gauge,
    human_deliveries: Gauge,
    encounters: Gauge,
    deviations: Gauge,
    interruptions: Gauge,
    replans: Gauge,
    poses: Family<StateLabel, Gauge>,
    workers: Family<StateLabel, Gauge>,
    plans: Gauge,
    plan_failures: Gauge,
    insertions_tried: Gauge,
    insertions: Gauge,
    insertions_only_way: Gauge,
    insertion_gain: Gauge<f64, AtomicU64>,
    deliveries_per_hour: Gauge<f64, AtomicU64>,
    /// Forecasts of people, by horizon: their number, the share covered, the factor of the regions, and whether they
    /// are trusted.
    forecasts: Family<HorizonLabel, Gauge>,
    forecast_covered: Family<HorizonLabel, Gauge<f64, AtomicU64>>,
    forecast_scale: Family<HorizonLabel, Gauge<f64, AtomicU64>>,
    forecast_trusted: Family<HorizonLabel, Gauge>,
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
            event_streams: Gauge::default(),
            feeds: Gauge::default(),
            poses_received: Counter::default(),
            poses_thinned: Counter::default(),
            poses_refused: Family::default(),
            hands_refused: Counter::default(),
            pose_to_stop: Histogram::new(seconds),
            pose_to_robot_stop: Histogram::new(seconds),
            hand_to_warning: Histogram::new(seconds),
            link_messages: Family::default(),
            link_malformed: Counter::default(),
            order_to_state: Histogram::new(seconds),
            link_robots: Family::default(),
            http: Family::default(),
            alarms: Family::default(),
            jobs: Family::default(),
            robots: Family::default(),
            activities: Family::default(),
            longest: Family::default(),
            robot_deliveries: Gauge::default(),
            human_deliveries: Gauge::default(),
            encounters: Gauge::default(),
            deviations: Gauge::default(),
            interruptions: Gauge::default(),
            replans: Gauge::default(),
            poses: Family::default(),
            workers: Family::default(),
            plans: Gauge::default(),
            plan_failures: Gauge::default(),
            insertions_tried: Gauge::default(),
            insertions: Gauge::default(),
            insertions_only_way: Gauge::default(),
            insertion_gain: Gauge::default(),
            deliveries_per_hour: Gauge::default(),
            forecasts: Family::default(),
            forecast_covered: Family::default(),
            forecast_scale: Family::default(),
            forecast_trusted: Family::default(),
        };
        m.register();
        m.register_insertions();
        m.register_people();
        m.register_forecasts();
        m.register_link();
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
        r.register("journal_errors", "Times the database refused a write", self.journal_errors.clone());
        r.register("live_clients", "Open live feeds", self.live_clients.clone());
        r.register("event_streams", "Open streams of events", self.event_streams.clone());
        r.register("http_requests", "HTTP requests by route and status", self.http.clone());
        r.register("alarms", "Active alarms by kind and severity", self.alarms.clone());
        r.register("jobs", "Jobs by state", self.jobs.clone());
        r.register("robots", "Robots by whether their task goes on", self.robots.clone());
        r.register("robot_activities", "Robots by what they are at", self.activities.clone());
        let longest = "For how long one robot has been at it, of those the longest";
        r.register_with_unit("robot_activity_longest", longest, Unit::Seconds, self.longest.clone());
        r.register("robot_deliveries", "Racks served at stations", self.robot_deliveries.clone());
        r.register("human_deliveries", "Assignments completed by workers", self.human_deliveries.clone());
        r.register("plans", "Routes planned", self.plans.clone());
        r.register("plan_failures", "Searches that found no route", self.plan_failures.clone());
        r.register("deliveries_per_hour", "Racks served per hour, lately", self.deliveries_per_hour.clone());
    }

    fn register_insertions(&mut self) {
        let r = &mut self.registry;
        let tried = "Times that a robot without a route looked for one that moves others";
        r.register("insertions_tried", tried, self.insertions_tried.clone());
        r.register("insertions", "Routes that were inserted by moving others", self.insertions.clone());
        let only = "Of these, routes of robots that would have had none behind the others";
        r.register("insertions_only_way", only, self.insertions_only_way.clone());
        let gain =
            "By how much all robots together arrive earlier than with the inserted robot behind the others";
        r.register_with_unit("insertion_gain", gain, Unit::Seconds, self.insertion_gain.clone());
    }

    fn register_people(&mut self) {
        let r = &mut self.registry;
        r.register("encounters", "Encounters of robots and workers", self.encounters.clone());
        r.register("deviations", "How often a worker left the path", self.deviations.clone());
        let stopped = "Robots that had to stop or change their route because of a worker";
        r.register("interruptions", stopped, self.interruptions.clone());
        r.register("replans", "Routes planned anew because of workers", self.replans.clone());
        r.register("feed_clients", "Open headset feeds", self.feeds.clone());
        r.register("workers", "Workers by presence", self.workers.clone());
        r.register("poses", "Poses by outcome", self.poses.clone());
        r.register("poses_received", "Poses received over feeds", self.poses_received.clone());
        let thinned = "Poses dropped because they came faster than 60 a second";
        r.register("poses_thinned", thinned, self.poses_thinned.clone());
        r.register("poses_refused", "Poses refused before the fleet saw them", self.poses_refused.clone());
        let no_hand = "Hands left out of poses because they cannot be";
        r.register("hands_refused", no_hand, self.hands_refused.clone());
        let to_worker = "From receiving the newest pose considered to sending the stop to the worker";
        r.register_with_unit("pose_to_stop", to_worker, Unit::Seconds, self.pose_to_stop.clone());
        let to_robot = "From receiving the first pose that makes a robot stop to sending the stop to it";
        r.register_with_unit("pose_to_robot_stop", to_robot, Unit::Seconds, self.pose_to_robot_stop.clone());
        let warning = "From seeing a hand that goes wrong to sending the warning to its wearer";
        r.register_with_unit("hand_to_warning", warning, Unit::Seconds, self.hand_to_warning.clone());
    }

    fn register_forecasts(&mut self) {
        let r = &mut self.registry;
        r.register("forecasts", "Forecasts of workers that have come due", self.forecasts.clone());
        let covered = "Share of workers who were within the stated 95 % region, lately";
        r.register("forecast_covered", covered, self.forecast_covered.clone());
        let scale = "Factor of standard deviations by which regions have grown";
        r.register("forecast_scale", scale, self.forecast_scale.clone());
        let trusted = "1 if forecasts hold, 0 if robots keep out of all that workers can reach instead";
        r.register("forecast_trusted", trusted, self.forecast_trusted.clone());
    }

    fn register_link(&mut self) {
        let r = &mut self.registry;
        r.register("link_messages", "Messages of VDA 5050, by direction", self.link_messages.clone());
        r.register(
            "link_malformed",
            "Messages of VDA 5050 that could not be read",
            self.link_malformed.clone(),
        );
        let taken = "From sending an order until a state shows that the robot has it";
        r.register_with_unit("order_to_state", taken, Unit::Seconds, self.order_to_state.clone());
        r.register("link_robots", "Robots that speak VDA 5050, by readiness", self.link_robots.clone());
    }

    /// Adds what the link to robots of other vendors counted.
    pub fn note_link(&self, counts: &LinkTally) {
        for (direction, messages) in [("in", counts.heard), ("out", counts.sent)] {
            self.link_messages.get_or_create(&DirectionLabel { direction }).inc_by(messages);
        }
        self.link_malformed.inc_by(counts.unreadable);
        counts.taken.iter().for_each(|took| self.order_to_state.observe(took.as_secs_f64()));
        for (state, robots) in [("ready", counts.ready), ("not_ready", counts.not_ready)] {
            self.link_robots.get_or_create(&StateLabel { state: state.into() }).set(robots as i64);
        }
    }

    fn look_at_forecasts(&self, moment: &Moment) {
        for f in &moment.view.forecast_coverage {
            let label = HorizonLabel { seconds: format!("{:.1}", f.horizon_s) };
            self.forecasts.get_or_create(&label).set(f.forecasts.cast_signed());
            self.forecast_covered.get_or_create(&label).set(f.covered);
            self.forecast_scale.get_or_create(&label).set(f.scale);
            self.forecast_trusted.get_or_create(&label).set(i64::from(f.trusted));
        }
    }

    /// Updates the counts of active alarms.
    pub fn note_alarms(&self, active: &[Alarm]) {
        self.alarms.clear();
        for alarm in active {
            let labels = AlarmLabels { kind: alarm.kind.word(), severity: alarm.severity.word() };
            self.alarms.get_or_create(&labels).inc();
        }
    }

    /// Counts a pose that is refused before the fleet sees it.
    pub fn refused(&self, reason: &'static str) {
        self.poses_refused.get_or_create(&ReasonLabel { reason }).inc();
    }

    fn look_at_activities(&self, view: &View) {
        for activity in Activity::ALL {
            let label = ActivityLabel { activity: activity.word() };
            let at_it = || view.robots.iter().filter(|r| r.activity == activity);
            let longest = at_it().map(|r| (view.now - r.since).as_secs_f64()).fold(0.0, f64::max);
            self.activities.get_or_create(&label).set(at_it().count() as i64);
            self.longest.get_or_create(&label).set(longest);
        }
    }

    fn look_at_insertions(&self, counts: InsertionCounts) {
        self.insertions_tried.set(counts.tried.cast_signed());
        self.insertions.set(counts.succeeded.cast_signed());
        self.insertions_only_way.set(counts.only_way.cast_signed());
        self.insertion_gain.set(counts.gain.as_secs_f64());
    }

    fn look_at_people(&self, moment: &Moment) {
        let counts = moment.view.counts;
        let workers = &moment.view.workers;
        let label = |state: &str| StateLabel { state: state.into() };
        self.encounters.set(counts.encounters.cast_signed());
        self.deviations.set(counts.deviations.cast_signed());
        self.interruptions.set(counts.interruptions.cast_signed());
        self.replans.set(counts.replans.cast_signed());
        for presence in [Presence::Absent, Presence::Tracked, Presence::Stale, Presence::Lost] {
            let n = workers.iter().filter(|w| w.presence == presence && !w.name.is_empty()).count();
            self.workers.get_or_create(&label(presence.word())).set(n as i64);
        }
        let sum = |of: fn(FeedCounts) -> u64| workers.iter().map(|w| of(w.feed)).sum::<u64>().cast_signed();
        self.poses.get_or_create(&label("taken")).set(sum(|f| f.taken));
        self.poses.get_or_create(&label("late")).set(sum(|f| f.late));
        self.poses.get_or_create(&label("jumps")).set(sum(|f| f.jumps));
        self.poses.get_or_create(&label("absurd")).set(sum(|f| f.absurd));
    }

    /// All metrics as text, those of the fleet as of `moment`.
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
        for state in ["idle", "busy", "free", "interrupted", "failed", "gone"] {
            let n =
                moment.view.robots.iter().filter(|r| RobotStateDto::from(r.state).word() == state).count();
            self.robots.get_or_create(&label(state)).set(n as i64);
        }
        self.look_at_activities(&moment.view);
        self.robot_deliveries.set(counts.robot_deliveries.cast_signed());
        self.human_deliveries.set(counts.human_deliveries.cast_signed());
        self.look_at_people(moment);
        self.look_at_forecasts(moment);
        self.look_at_insertions(counts.insertions);
        self.plans.set(counts.plans.cast_signed());
        self.plan_failures.set(counts.plan_failures.cast_signed());
        self.deliveries_per_hour.set(moment.measured.deliveries_per_hour);
        let mut text = String::new();
        encode(&mut text, &self.registry).expect("writing into a string does not fail");
        text
    }
}
