//! One look at the fleet: everything that is wrong, causes only.
//!
//! Main types: [`FloorWatch`]; [`operator_conditions`] is what people asked for. Refuses: to look by itself; the driver
//! of the fleet calls it about once a second.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind, some_of};
use super::flow::FlowWatch;
use super::groups::Gathering;
use super::jobs::JobWatch;
use super::kind::AlarmKind;
use super::robots::{RobotWatch, left_obstacles};
use super::roots::Roots;
use super::server::LoopHealth;
use super::standing::{IdleFloor, is_about, is_stopped, standstills, whole_floor};
use super::{arms, people, server};
use crate::{Fleet, Party, View, Why};
use giveway_floor::text::sentence::alarms;

/// What has to be remembered from look to look.
#[derive(Clone, Debug, Default)]
pub struct FloorWatch {
    robots: RobotWatch,
    jobs: JobWatch,
    idle: IdleFloor,
    flow: FlowWatch,
    gathering: Gathering,
}

impl FloorWatch {
    /// All that is wrong now. `view` is a view of this fleet.
    pub fn look(&mut self, fleet: &Fleet, view: &View, health: &LoopHealth) -> Vec<AlarmCondition> {
        self.robots.note(fleet, view.now);
        let roots = Roots::of(fleet);
        let mut robots = self.robots.conditions(fleet, view, &roots);
        let mut found = people::conditions(fleet, view, &roots, &robots);
        let is_lost = found.iter().any(|c| c.kind == AlarmKind::WorkerLost);
        if is_lost {
            // Much of the floor is closed round a lost worker: that is why robots find no route and stand.
            robots.retain(|_, c| c.kind != AlarmKind::RobotBlocked);
        }
        let jobs = self.jobs.conditions(fleet, view);
        if is_stopped(view) || is_lost {
            self.flow = FlowWatch::default();
        }
        if is_stopped(view) {
            // Nothing moves because a person wanted it so: what follows from that is no news.
            found.extend(jobs.into_iter().filter(|c| c.kind == AlarmKind::DeadlineMissed));
        } else {
            if !is_lost {
                found.extend(standstills(fleet, view, &robots));
                let stands = whole_floor(fleet, view, (&self.robots, &roots), (&mut robots, &mut found));
                found.extend(stands.or_else(|| self.idle.look(fleet, view)));
                let has_cause = |party: Party| {
                    let by_robot = matches!(party, Party::Robot(r) if robots.contains_key(&r));
                    by_robot || found.iter().any(|c| is_about(fleet, c, party))
                };
                let flow = self.flow.look(fleet, view, &roots, has_cause);
                found.extend(flow);
            }
            found.extend(jobs);
        }
        found.extend(server::conditions(fleet, view, health, &robots));
        found.extend(arms::conditions(fleet, view));
        found.extend(left_obstacles(fleet, &robots));
        found.extend(robots.into_values());
        self.gathering.gather(found, fleet.ledger().present().count())
    }
}

/// What people asked for and should not forget.
pub fn operator_conditions(view: &View) -> Vec<AlarmCondition> {
    let mut found = Vec::new();
    if let Some(since) = view.stopped {
        let said = alarms::all_stopped();
        let one = AlarmCondition::new(AlarmKind::Stopped, AlarmSubject::floor(), said);
        found.push(AlarmCondition { since: Some(since), ..one });
    }
    if let Some(since) = view.evacuation {
        let said = alarms::evacuation();
        let one = AlarmCondition::new(AlarmKind::Evacuation, AlarmSubject::floor(), said);
        found.push(AlarmCondition { since: Some(since), ..one });
    }
    let paused: Vec<_> = view.robots.iter().filter(|r| r.why == Some(Why::Paused)).collect();
    if let Some(first) = paused.first() {
        let names: Vec<String> = paused.iter().map(|r| r.name.clone()).collect();
        let subject = AlarmSubject::new(SubjectKind::Robot, first.name.clone());
        let said = alarms::robots_paused(some_of(&names));
        found.push(AlarmCondition::new(AlarmKind::Paused, subject, said).at(first.pose.at));
    }
    found
}
