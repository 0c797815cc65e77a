//! Last phase, on demand: builds an immutable view of everything.
//!
//! Main function: [`Fleet::view`]. Refuses: to change anything.

use crate::Fleet;
use crate::dispatch::enough::with_enough_racks;
use crate::people::intents::task_place;
use crate::read::view::{Counts, LINE, RobotState, RobotView, StationView, View, ViewBuilding};
use crate::state::activity::Activity;
use crate::state::arms::ArmView;
use crate::state::fact::{Act, Task};
use crate::state::floor::Floor;
use crate::state::index::RackGoal;
use crate::state::job::Job;
use crate::state::ledger::Service;
use crate::state::worker::{ClosureView, Presence, WorkerEpisode, WorkerView};
use giveway_cell::Remaining;
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{BodyId, JobId, NodeId, RobotId, StationId, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::{Belief, IntentState, Whereabouts};
use std::collections::BTreeMap;

/// How many waiting jobs are looked at to find those in line: a view is made ten times a second, however many wait.
const LOOKED: usize = 1000;
/// The area of a lost worker reaches at least this far from the last place, metres.
const LEAST_AREA_M: f64 = 1.0;

impl Fleet {
    /// Everything that may be seen from outside.
    pub fn view(&self, now: Time) -> View {
        let robots: Vec<RobotView> =
            self.writer.ledger().robots.ids().map(|r| self.robot_view(r, now)).collect();
        let stations = self.writer.warehouse().stations.ids().map(|s| self.station_view(s, now)).collect();
        let waiting = self.writer.ledger().index().queue.len() as u64;
        let active = self.writer.ledger().jobs.len() as u64 - waiting;
        let counts = self.counts(waiting, active);
        let racks = self.writer.ledger().racks.iter().copied().collect();
        let (workers, closures) = (self.worker_views(now), self.floor().closure_views());
        let charger_is_free = self.floor().a_charger_is_free();
        let idle = self.floor().idle_robots(now).into_iter();
        let works =
            |r: &RobotId| self.floor().is_charged(*r, charger_is_free) && !self.floor().is_shut_in(*r);
        let free = idle.filter(works);
        let free_at: Vec<(BodyId, NodeId)> =
            free.map(|r| (self.floor().body(r), self.writer.ledger().node_of(r))).collect();
        let mut of_kind: BTreeMap<BodyId, usize> = BTreeMap::new();
        free_at.iter().for_each(|(body, _)| *of_kind.entry(*body).or_default() += 1);
        let kinds = self.writer.ledger().present().map(|r| self.floor().body(r)).collect();
        let forecast_coverage = self.people.coverage.forecast_coverage().to_vec();
        let (blocked, stopped) = (self.floor().blocked(), self.writer.ledger().stopped);
        let full = with_enough_racks(self.floor(), &self.traffic.needs, now);
        let line = self.line(&full, now);
        let paused_stations = self.writer.ledger().paused_stations.clone();
        let cut_off = self.writer.restrictions.cut_off.clone();
        let closing = self.writer.restrictions.closing_nodes();
        View {
            now,
            robots,
            racks,
            stations,
            workers,
            closures,
            recurring: self.writer.ledger().recurring.clone(),
            evacuation: self.writer.ledger().evacuation,
            blocked,
            kept: self.floor().kept_nodes(),
            all_kinds: self.writer.ledger().kinds().clone(),
            building: ViewBuilding(Some(self.writer.warehouse().clone())),
            kinds,
            free: of_kind,
            free_at,
            full,
            line,
            cut_off,
            paused_stations,
            closing,
            stopped,
            counts,
            forecast_coverage,
        }
    }

    /// The first jobs in line for a robot.
    fn line(&self, full: &BTreeMap<StationId, RobotId>, now: Time) -> Vec<(JobId, u8)> {
        let ledger = &self.writer.ledger();
        let is_open = |goal| match goal {
            RackGoal::Station(s) => !full.contains_key(&s) && !ledger.paused_stations.contains_key(&s),
            RackGoal::Storage => true,
        };
        let in_line = ledger.index().queue.in_line(now, LOOKED, is_open);
        in_line.take(LINE).map(|id| (id, ledger.jobs[&id].request.priority)).collect()
    }

    /// Sums of the ledger, and counts of what was tried.
    fn counts(&self, waiting: u64, active: u64) -> Counts {
        let (sums, tally) = (self.writer.ledger().counts, self.traffic.tally);
        let [lines, wrong_reaches] = self.writer.visits.counted();
        Counts {
            robot_deliveries: sums.robot_deliveries,
            human_deliveries: sums.human_deliveries,
            waiting,
            active,
            done: sums.done,
            cancelled: sums.cancelled,
            failed: sums.failed,
            plans: tally.plans,
            plan_failures: tally.failures,
            insertions: tally.insertions,
            lines,
            wrong_reaches,
            encounters: sums.encounters,
            deviations: sums.deviations,
            interruptions: sums.interruptions,
            replans: tally.replans,
            zones: self.yielding.state.answered,
        }
    }

    fn robot_view(&self, r: RobotId, now: Time) -> RobotView {
        let record = &self.writer.ledger().robots[r];
        let seen = self.writer.scene.robot(r);
        let chain = self.writer.ledger().chain(r);
        let nodes = |from: u64, to: u64| -> Vec<NodeId> {
            (from..to).filter_map(|s| chain.get(s)).map(|v| v.node).collect()
        };
        let stands =
            Pose { at: self.writer.warehouse().nodes[self.writer.ledger().node_of(r)].at, heading: 0.0 };
        let (activity, since) = self.activity(r, now);
        RobotView {
            name: record.name.clone(),
            pose: seen.map_or(stands, |t| t.pose),
            seen: seen.map(|t| t.seen),
            heard: self.writer.scene.heard(r),
            speed_mps: seen.map_or(0.0, |t| t.speed_mps),
            kind: record.kind.clone(),
            link: record.link.clone(),
            link_state: self.writer.scene.link(r).cloned(),
            battery: seen.map_or(0.0, |t| t.battery),
            critical: self.floor().charging(r).critical,
            maintenance: matches!(record.service, Service::Maintenance { .. }),
            leaving: matches!(record.service, Service::Leaving { .. }),
            fault: seen.and_then(|t| t.fault),
            state: self.floor().robot_state(r),
            task: record.task,
            rack: self.writer.ledger().rack_on(r),
            doing: self.floor().doing(r),
            activity,
            since,
            driven_m: self.writer.scene.driven_m(r),
            job: record.task.job(),
            granted: nodes(chain.first(), chain.granted()),
            held: nodes(chain.granted(), chain.end()),
            why: self.why(r),
            passes: self.passing(r).map(|p| p.worker),
            replanned: self.replans.last(r),
        }
    }

    /// What a robot is doing, and since when. What a person ordered is durable, so it counts from the order.
    pub fn activity(&self, robot: RobotId, now: Time) -> (Activity, Time) {
        let noted = self.writer.activities.of(robot);
        let (activity, since) = noted.unwrap_or_else(|| (self.floor().activity(robot, self.why(robot)), now));
        let ordered = match activity {
            Activity::Paused => self.writer.ledger().robots[robot].paused,
            Activity::Stopped => self.writer.ledger().stopped.or(self.writer.ledger().evacuation),
            _ => None,
        };
        (activity, ordered.unwrap_or(since))
    }

    fn worker_views(&self, now: Time) -> Vec<WorkerView> {
        self.writer.ledger().workers.pairs().map(|(w, name)| self.worker_view(w, name, now)).collect()
    }

    fn worker_view(&self, worker: WorkerId, name: &str, now: Time) -> WorkerView {
        let place = self.people.whereabouts(worker, now);
        let person = self.people.people.get(worker);
        let mover = self.writer.ledger().mover(worker);
        let regions = &self.writer.regions;
        let belief = self.people.intents.belief(worker).unwrap_or_default();
        let guidance = place.map(|w| self.people.guidance(self.floor(), worker, &w, now)).unwrap_or_default();
        WorkerView {
            name: name.to_owned(),
            presence: place.map_or(Presence::Absent, |w| w.presence),
            pose: place.map(|w| Pose { at: w.at, heading: w.heading.unwrap_or(0.0) }),
            seen: person.and_then(|p| p.track.last_seen()),
            speed_mps: place.map_or(0.0, |w| w.velocity.norm()),
            accuracy_m: place.map_or(0.0, |w| w.sigma_m + w.reach_m),
            area: place.map(|w| self.lost_area(&w)).unwrap_or_default(),
            regions_m: place.map_or_else(|| regions.widest_for_m(mover), |w| regions.widest_m(&w)),
            mover,
            guidance,
            goals: self.goals_view(&belief),
            undecided: belief.undecided,
            elsewhere: belief.elsewhere,
            episodes: self.episodes_view(worker),
            feed: person.map(|p| p.track.counts()).unwrap_or_default(),
        }
    }

    fn lost_area(&self, w: &Whereabouts) -> Vec<NodeId> {
        if w.presence != Presence::Lost {
            return Vec::new();
        }
        let map = self.warehouse();
        let within = self.people.afoot.nodes_within(map, w.at, w.reach_m.max(LEAST_AREA_M));
        within.into_iter().map(|(node, _)| node).collect()
    }

    fn episodes_view(&self, worker: WorkerId) -> Vec<WorkerEpisode> {
        let place = |state| match state {
            // The place of a task that is over is no goal any more, but still where the worker went.
            IntentState::Goal(g) => self.people.intents.distances.place(g).or_else(|| {
                let node = task_place(g)?;
                self.writer.warehouse().nodes.get(node).map(|n| n.at)
            }),
            IntentState::Undecided | IntentState::Elsewhere => None,
        };
        let episodes = self.people.intents.episodes(worker);
        episodes
            .into_iter()
            .map(|e| WorkerEpisode { state: e.state, place: place(e.state), since: e.since })
            .collect()
    }

    fn goals_view(&self, belief: &Belief) -> Vec<(Point, f64)> {
        let place = |g| self.people.intents.distances.place(g);
        let mut goals: Vec<_> = belief.goals.iter().filter_map(|(g, p)| Some((place(*g)?, *p))).collect();
        goals.sort_by(|a, b| b.1.total_cmp(&a.1));
        goals
    }

    fn station_view(&self, s: StationId, now: Time) -> StationView {
        let (ledger, visits) = (&self.writer.ledger(), &self.writer.visits);
        let station = &self.writer.warehouse().stations[s];
        let stands = |n: NodeId| ledger.present().find(|r| ledger.node_of(*r) == n);
        let here = stands(station.node);
        let picked = here.filter(|r| self.is_picked_from(*r));
        let job = picked.and_then(|r| ledger.robots[r].task.job());
        let record = job.and_then(|id| Some((id, ledger.jobs.get(&id)?)));
        StationView {
            robot: here,
            picking: picked.is_some(),
            job,
            since: job.and_then(|id| visits.since(id)),
            lines: record.and_then(|(_, job)| job.lines_now().cloned()),
            left: self.visit_left(s, now),
            placed: self.visit_placed(s, now),
            ends: visits.ends_held(s),
            has_cell: station.cell.is_some(),
            hears_hands: station.cell.is_some() && self.writer.settings.flow.hears_hands(),
            saw_hands: visits.saw_hands(s, now),
            warning: visits.warning(s, now),
            arm: self.arm(s, now),
            reaches: visits.reaches(s, now),
            unconfirmed: ledger.unconfirmed.get(&s).cloned(),
            next: self.next_rack(station.node, picked).map(|(robot, at)| (robot, self.known(robot, at, now))),
            paused: ledger.paused_stations.get(&s).copied(),
            queue: station.queue.iter().filter_map(|q| stands(*q)).collect(),
            served: ledger.served[s],
        }
    }

    /// How long the visit in progress at a station will last from now on; nothing if there is none, or lines are not
    /// counted.
    pub fn visit_left(&self, station: StationId, now: Time) -> Option<Remaining> {
        if !self.writer.settings.flow.counts_lines() {
            return None;
        }
        let (id, job) = self.visit_on(station)?;
        self.writer.visits.remaining(id, job, self.floor().ends_out(job), now)
    }

    /// How long it takes until the last piece of the visit in progress at a station is in its tote: longer than the
    /// visit if the rack leaves at the last grasp.
    fn visit_placed(&self, station: StationId, now: Time) -> Option<Remaining> {
        let (id, job) = self.visit_on(station).filter(|_| self.writer.settings.flow.counts_lines())?;
        self.writer.visits.remaining(id, job, false, now)
    }

    fn visit_on(&self, station: StationId) -> Option<(JobId, &Job)> {
        let robot = self.floor().picked_from(station)?;
        let id = self.writer.ledger().robots[robot].task.job()?;
        Some((id, self.writer.ledger().jobs.get(&id)?))
    }

    /// The robot arm at a station; nothing if there is none, or it is of no known kind.
    pub fn arm(&self, station: StationId, now: Time) -> Option<ArmView> {
        self.writer.arms.view(station, now)
    }

    /// The time at which a robot is planned to be somewhere; nothing if it waits for something whose end is unknown.
    fn known(&self, robot: RobotId, at: Time, now: Time) -> Option<Time> {
        let chain = self.waits(robot, now);
        let waits = chain.first().is_some_and(|link| link.because.is_waiting());
        let has_time = !waits || chain.last().is_some_and(|root| root.until.is_some());
        Some(at).filter(|_| has_time)
    }

    /// The robot that brings the next rack to a station, and when it is planned to be there.
    fn next_rack(&self, station: NodeId, picked: Option<RobotId>) -> Option<(RobotId, Time)> {
        let ledger = &self.writer.ledger();
        let comes = |robot: RobotId| {
            let record = &ledger.robots[robot];
            if !matches!(record.task, Task::Deliver { station: s, .. } if s == station) {
                return None;
            }
            let stop = record.stops.iter().find(|s| matches!(s.act, Act::Pick(_)))?;
            let visit = ledger.chain(robot).get(stop.serial).filter(|v| v.node == station)?;
            Some((robot, visit.arrive))
        };
        let others = ledger.present().filter(|r| Some(*r) != picked);
        others.filter_map(comes).min_by_key(|(robot, at)| (*at, *robot))
    }
}

impl Floor<'_> {
    /// Waiting jobs that come after others, each with the first of those that is not over yet: a job that the customer
    /// wants done before, or the job that the robot named by both does first.
    fn blocked(&self) -> BTreeMap<JobId, JobId> {
        let behind = |robot: RobotId| {
            let first = self.named_job_for(robot);
            let others = self.ledger.index().named_for(robot).filter(move |id| Some(*id) != first);
            others.filter_map(move |id| Some((id, first?)))
        };
        let named = self.ledger.present().flat_map(behind);
        named.chain(self.ledger.index().waits.blocked()).collect()
    }

    fn robot_state(&self, r: RobotId) -> RobotState {
        let record = &self.ledger.robots[r];
        match record.task {
            _ if record.is_gone() => RobotState::Gone,
            _ if record.failed => RobotState::Failed,
            _ if record.interrupted && record.task != Task::Idle => RobotState::Interrupted,
            Task::Idle => RobotState::Idle,
            Task::Move { job: None, .. } => RobotState::Free,
            _ => RobotState::Busy,
        }
    }

    fn closure_views(&self) -> Vec<ClosureView> {
        let closures = self.ledger.closures.iter();
        closures.map(|(id, closure)| ClosureView { id: *id, closure: closure.clone() }).collect()
    }
}
