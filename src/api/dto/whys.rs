//! Why jobs and robots do not go on, and why jobs failed, in sentences.
//!
//! Adds these sentences to [`Names`]. Each reason has its own sentence in `text/sentence/reasons.rs`. Refuses: to
//! determine why; the fleet does.

use crate::dto::names::Names;
use crate::wire::text::{closure_name, job_name, worker_name};
use giveway_fleet::alarm::displacement_words;
use giveway_fleet::{JobFailure, JobWhy, JobsAhead, LinkReach, RobotView, Why};
use giveway_floor::id::{Dense, RackId, RobotId, StationId};
use giveway_floor::text::sentence::reasons;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::warehouse::NodeKind;

impl Names<'_> {
    /// Why a job does not go on.
    pub fn why_job(&self, why: JobWhy) -> Sentence {
        match why {
            JobWhy::After(job) => reasons::after_job(job_name(job)),
            JobWhy::RackBusy(k, r, job) => self.rack_busy(k, r, job.map(job_name)),
            JobWhy::RobotBusy(r, Some(job)) => reasons::robot_works(self.robot(r), job_name(job)),
            JobWhy::RobotBusy(r, None) => reasons::robot_on_its_way(self.robot(r)),
            JobWhy::NoRobot => reasons::no_robot_free(),
            JobWhy::Outranked(ahead) => outranked(ahead),
            JobWhy::NoKind => reasons::no_robot_of_kind(),
            JobWhy::StationFull(s) => reasons::station_full(self.station_name(s)),
            JobWhy::RacksWait(s, r) => reasons::racks_wait(self.station_name(s), self.robot(r)),
            JobWhy::StationPaused(s) => reasons::station_paused(self.station_name(s)),
            JobWhy::ClosedOff => reasons::place_closed_off(),
            JobWhy::StationBlocked(s, r) => {
                reasons::station_blocked(self.station_name(s), self.with_trouble(r))
            }
            JobWhy::WayBlocked(r) => reasons::way_blocked(self.with_trouble(r)),
            JobWhy::WayClosed(c) => reasons::way_closed(closure_name(c)),
            JobWhy::RackBlocked(k, r) => reasons::rack_blocked(self.rack_name(k), self.with_trouble(r)),
            JobWhy::NodeTaken(n, r) => reasons::node_kept(self.node(n), self.with_trouble(r)),
            JobWhy::NoPlace(NodeKind::Charger) => reasons::no_charger(),
            JobWhy::NoPlace(_) => reasons::no_parking(),
            JobWhy::RobotLow(r) => reasons::robot_charges(self.robot(r)),
            JobWhy::Robot(r, why) => match self.view.robots.get(r.ix()) {
                Some(robot) => reasons::robot_says(&robot.name, self.why_of(robot, why)),
                None => self.why(why),
            },
        }
    }

    /// The rack of a job is on a robot or reserved for one; `job` is the job for which the robot moves it.
    fn rack_busy(&self, rack: RackId, robot: RobotId, job: Option<String>) -> Sentence {
        let name = self.rack_name(rack);
        if self.trouble(robot).is_some() {
            let is_on = self.view.robots.get(robot.ix()).is_some_and(|robot| robot.rack == Some(rack));
            return match is_on {
                true => reasons::rack_on(name, self.with_trouble(robot)),
                false => reasons::rack_to_be_fetched(name, self.with_trouble(robot)),
            };
        }
        match job {
            Some(job) => reasons::rack_moved(name, self.robot(robot), job),
            None => reasons::rack_brought_back(name, self.robot(robot)),
        }
    }

    /// What is wrong with the robot itself, if anything.
    fn trouble(&self, r: RobotId) -> Option<Why> {
        self.view.robots.get(r.ix())?.why.filter(|why| why.is_by_itself())
    }

    /// A robot's name with what is wrong with it.
    fn with_trouble(&self, r: RobotId) -> SentenceArg {
        let robot = self.view.robots.get(r.ix());
        match robot.and_then(|robot| Some(self.why_of(robot, self.trouble(r)?))) {
            Some(trouble) => reasons::robot_in_trouble(self.robot(r), trouble).into(),
            None => self.robot(r).into(),
        }
    }

    /// Why a robot does not go on, and what becomes of its rack.
    pub fn why_of(&self, robot: &RobotView, why: Why) -> Sentence {
        match (why, robot.rack.and_then(|r| self.map.racks.get(r))) {
            (Why::Refused, _) => {
                let words = robot.link_state.as_ref().and_then(|link| link.refuses.clone());
                words.map_or_else(reasons::refused, reasons::refused_because)
            }
            (Why::Silent, _) if robot.link_state.as_ref().is_some_and(|l| l.reach == LinkReach::LineDown) => {
                reasons::line_down()
            }
            (Why::Failed, Some(rack)) => reasons::cannot_drive_with_rack(&rack.name),
            _ => self.why(why),
        }
    }

    /// Why a robot does not go on.
    pub fn why(&self, why: Why) -> Sentence {
        match why {
            Why::WaitsFor(resource, r) => reasons::waits_for(self.map.resource_name(resource), self.robot(r)),
            Why::GivesWay(w) => reasons::gives_way(worker_name(w)),
            Why::Closed(c) => reasons::area_ahead(closure_name(c)),
            Why::QueueFull(s) => reasons::queue_full(self.station_name(s)),
            Why::NotItsTurn(s, r) => reasons::not_its_turn(self.station_name(s), self.robot(r)),
            Why::StationPaused(s) => reasons::station_paused(self.station_name(s)),
            Why::HandInOpening(s) => reasons::hand_in_opening(self.station_name(s)),
            Why::NoRoute => reasons::no_route(),
            Why::Failed => reasons::cannot_drive(),
            Why::EmergencyStop => reasons::emergency_stop(),
            Why::Manual => reasons::driven_by_hand(),
            Why::Obstructed(n) => reasons::obstructed(self.node(n)),
            Why::WayObstructed(n) => reasons::way_obstructed(self.node(n)),
            Why::Unplugged => reasons::unplugged(),
            Why::Displaced(displacement) => displacement_words(self.map, |r| self.robot(r), displacement),
            Why::BlockedBy(r) => reasons::blocked_by(self.robot(r)),
            Why::Silent => reasons::silent(),
            Why::Refused => reasons::refused(),
            Why::Paused => reasons::paused(),
            Why::Maintenance => reasons::in_maintenance(),
            Why::Leaving => reasons::leaves(),
            Why::Gone => reasons::has_left(),
            Why::Stopped => reasons::fleet_stopped(),
            Why::Evacuation => reasons::stands_for_evacuation(),
        }
    }

    /// Why a job failed; `gone` is the former name of a place that the map no longer has.
    pub fn why_failed(&self, why: JobFailure, gone: Option<String>) -> Sentence {
        match why {
            JobFailure::Predecessor(job) => reasons::predecessor_failed(job_name(job)),
            JobFailure::Unreachable => reasons::unreachable(),
            JobFailure::Short => reasons::goods_missing(),
            JobFailure::NoPlaceAside => reasons::no_place_aside(),
            JobFailure::RobotGone => reasons::named_robot_gone(),
            JobFailure::MapChanged => reasons::map_changed(),
            JobFailure::StorageTaken(node) => reasons::put_elsewhere(gone.unwrap_or_else(|| self.node(node))),
        }
    }

    fn rack_name(&self, rack: RackId) -> String {
        self.map.racks.get(rack).map_or_else(|| format!("{rack:?}"), |rack| rack.name.clone())
    }

    fn station_name(&self, station: StationId) -> String {
        self.map.stations.get(station).map_or_else(|| format!("{station:?}"), |s| s.name.clone())
    }
}

/// How many jobs come before a job.
fn outranked(JobsAhead { higher, others, more }: JobsAhead) -> Sentence {
    match (higher, others) {
        _ if more => reasons::many_jobs_ahead(higher + others),
        (_, 0) => reasons::jobs_of_higher_priority(higher),
        (0, _) => reasons::jobs_due_sooner(others),
        _ => reasons::jobs_ahead(higher, others),
    }
}
