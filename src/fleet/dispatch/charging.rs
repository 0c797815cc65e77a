//! When robots charge: which may take a job, which go to a charger, and which leave one for another robot.
//!
//! Settings: [`Charging`](crate::state::kind::Charging) of the robot's kind. A robot below `low` charges before it
//! works if a charger is free, and works on if none is; below `critical` it takes no job, gives back a job that it has
//! not begun, and is next at a charger: the fullest robot at one leaves it. Likewise a robot that rests at a parking
//! place leaves it for a robot that a customer sends there. Refuses: to trust a battery that says nothing is left; that
//! robot has failed.

use crate::state::fact::{Purpose, RobotFact, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::job_kind::JobKind;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, NodeId, RackId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;

/// A robot leaves its charger for a critical one only if it has this much more charge.
const MARGIN: f64 = 0.1;
/// How often an idle robot checks whether it stands in the way of a rack that is wanted.
const LOOKS: Span = Span::from_secs(5);

/// Has robots with too little charge give back jobs that they have not begun.
pub(crate) fn give_back_jobs(writer: &mut Writer, now: Time) {
    for robot in writer.ledger().present() {
        let Task::Fetch { job: Some(job), node, .. } = writer.ledger().robots[robot].task else { continue };
        let fit = writer.scene.fit(robot, now).is_some();
        if fit && writer.floor().is_critical(robot) && !writer.floor().next_stop_is_granted(robot) {
            let stay = writer.floor().free_charger(robot).unwrap_or(node);
            let purpose = if stay == node { Purpose::Park } else { Purpose::Charge };
            let task = Task::rest_at(stay, purpose);
            writer.progress(job, JobState::Waiting, Some((robot, task)), now);
        }
    }
}

/// What idle robots without a job do: charge if they should, lowest first, make room at chargers, and leave places
/// where they are in the way. Returns the robots that have lost a place that they were promised.
pub(crate) fn rest(writer: &mut Writer, mut robots: Vec<RobotId>, now: Time) -> Vec<RobotId> {
    robots.sort_by(|a, b| writer.floor().battery(*a).total_cmp(&writer.floor().battery(*b)).then(a.cmp(b)));
    let (mut without, mut to_park) = (Vec::new(), Vec::new());
    for robot in robots {
        if send_to_charger(writer, robot) {
            continue;
        }
        let low = writer.floor().battery(robot) < writer.floor().charging(robot).low;
        if (low || writer.floor().is_sent_to_charge(robot)) && !writer.floor().at_charger(robot) {
            without.push(robot);
        }
        if writer.floor().is_sent_to_park(robot) {
            to_park.push(robot);
        }
        leave_the_way(writer, robot, now);
    }
    make_room_at_chargers(writer, &without, now);
    make_room_to_park(writer, &to_park, now);
    if without.is_empty() { Vec::new() } else { lapse_promises(writer, now) }
}

/// Takes places at chargers from robots that have no prospect of getting there. Robots that need a charger then get
/// one, the emptiest first, and so do these robots when they can drive again.
fn lapse_promises(writer: &mut Writer, now: Time) -> Vec<RobotId> {
    let floor = writer.floor();
    let lapses = |r: &RobotId| floor.is_sent_to_a_charger(*r) && floor.has_no_prospect(*r, now);
    let lapsed: Vec<RobotId> = floor.ledger.present().filter(lapses).collect();
    for robot in &lapsed {
        tracing::debug!(?robot, "its place at the charger lapses");
        match writer.ledger().robots[*robot].task.job() {
            Some(job) => writer.progress(job, JobState::Waiting, Some((*robot, Task::Idle)), now),
            None => writer.record(RobotFact::Tasked { robot: *robot, task: Task::Idle }),
        }
    }
    lapsed
}

/// Sends an idle robot to a free charger if it should charge.
fn send_to_charger(writer: &mut Writer, robot: RobotId) -> bool {
    let (battery, c) = (writer.floor().battery(robot), *writer.floor().charging(robot));
    let should = battery < c.low || (c.opportunity && battery < c.full);
    if !should || writer.floor().at_charger(robot) {
        return false;
    }
    let Some(stay) = writer.floor().free_charger(robot) else { return false };
    move_to(writer, robot, stay, Purpose::Charge);
    true
}

/// Sends away a robot that stands where it may not stay, or in the way of a rack that is wanted.
fn leave_the_way(writer: &mut Writer, robot: RobotId, now: Time) {
    let node = writer.ledger().node_of(robot);
    let may_stay = writer.warehouse().nodes[node].kind.is_lasting() && !writer.floor().is_closing(node);
    let stay = match may_stay {
        false => writer.floor().any_stay(robot),
        true if writer.floor().is_in_the_way(robot, node, now) => writer.floor().place_without_rack(robot),
        true => None,
    };
    if let Some(stay) = stay {
        move_to(writer, robot, stay, Purpose::Park);
    }
}

/// For each robot without a charger, a robot that has enough charge leaves its charger, the fullest first.
fn make_room_at_chargers(writer: &mut Writer, without: &[RobotId], now: Time) {
    let leaving = writer.ledger().present().filter(|r| writer.floor().leaves_charger(*r)).count();
    for needs in without.iter().skip(leaving) {
        let Some(robot) = writer.floor().fullest_at_a_charger(*needs, now) else { return };
        let stay = writer
            .floor()
            .free_place(robot, NodeKind::Parking)
            .or_else(|| writer.floor().free_place(robot, NodeKind::Storage));
        let Some(stay) = stay else { return };
        move_to(writer, robot, stay, Purpose::Park);
    }
}

/// For each robot that is sent to park and finds no place, a robot that rests at a parking place leaves it for a place
/// beside racks, the fullest first.
fn make_room_to_park(writer: &mut Writer, without: &[RobotId], now: Time) {
    let leaving = writer.ledger().present().filter(|r| writer.floor().leaves_parking(*r)).count();
    for needs in without.iter().skip(leaving) {
        let Some(robot) = writer.floor().fullest_at_parking(*needs, now) else { return };
        let empty = writer.floor().storage_without_rack(robot);
        let Some(stay) = empty.or_else(|| writer.floor().free_place(robot, NodeKind::Storage)) else {
            return;
        };
        move_to(writer, robot, stay, Purpose::Park);
    }
}

fn move_to(writer: &mut Writer, robot: RobotId, stay: NodeId, purpose: Purpose) {
    let task = Task::rest_at(stay, purpose);
    writer.record(RobotFact::Tasked { robot, task });
}

impl Floor<'_> {
    /// Whether a charger is free for a robot that is low and not at one.
    pub(crate) fn a_charger_is_free(&self) -> bool {
        let low = |r: &RobotId| self.battery(*r) < self.charging(*r).low && !self.at_charger(*r);
        self.ledger.present().find(low).is_some_and(|r| self.free_charger(r).is_some())
    }

    fn free_charger(&self, robot: RobotId) -> Option<NodeId> {
        self.free_place(robot, NodeKind::Charger)
    }

    /// Whether a robot has the charge to take jobs. Below `low` it charges first, but works on if no charger is free.
    pub(crate) fn is_charged(&self, robot: RobotId, charger_is_free: bool) -> bool {
        let (battery, c) = (self.battery(robot), self.charging(robot));
        match self.at_charger(robot) {
            true => battery >= c.enough,
            false => battery >= c.low || (battery >= c.critical && !charger_is_free),
        }
    }

    /// The share of a full charge that a robot uses for this many metres.
    pub(crate) fn charge_for(&self, robot: RobotId, way_m: f64) -> f64 {
        way_m / self.kinematics(robot).speed_mps / (self.charging(robot).driving_h * 3600.0)
    }

    /// Whether a robot has the charge for this job, which names it.
    pub(crate) fn may_begin(&self, robot: RobotId, job: JobId) -> bool {
        let kind = &self.ledger.jobs[&job].request.kind;
        matches!(kind, JobKind::Charge { .. }) || !self.is_critical(robot)
    }

    /// Whether a customer wants an idle robot to charge, and no charger was free.
    fn is_sent_to_charge(&self, robot: RobotId) -> bool {
        let job = self.named_job_for(robot).map(|job| self.ledger.jobs[&job].request.kind);
        matches!(job, Some(JobKind::Charge { .. }))
    }

    /// Whether a customer wants an idle robot to park, and no place was free.
    fn is_sent_to_park(&self, robot: RobotId) -> bool {
        let job = self.named_job_for(robot).filter(|job| self.may_begin(robot, *job));
        let kind = job.map(|job| self.ledger.jobs[&job].request.kind);
        matches!(kind, Some(JobKind::Park { .. })) && !self.is_parked(robot)
    }

    fn is_parked(&self, robot: RobotId) -> bool {
        self.warehouse().kind(self.ledger.node_of(robot)) == NodeKind::Parking
    }

    fn leaves_parking(&self, robot: RobotId) -> bool {
        self.is_parked(robot) && self.ledger.robots[robot].task != Task::Idle
    }

    /// The robot with the highest charge among those that rest at a parking place where `needs` may be.
    fn fullest_at_parking(&self, needs: RobotId, now: Time) -> Option<RobotId> {
        let idle = self.idle_robots(now).into_iter().filter(|r| self.is_parked(*r));
        let rests = idle.filter(|r| self.may_be_at(needs, self.ledger.node_of(*r)));
        rests.max_by(|a, b| self.battery(*a).total_cmp(&self.battery(*b)).then(b.cmp(a)))
    }

    /// Whether a robot that takes no job, cannot carry the rack, or is not chosen for it stands beneath a rack that
    /// waiting jobs ask for: no other robot is sent there.
    fn is_in_the_way(&self, robot: RobotId, node: NodeId, now: Time) -> bool {
        let turn = (now.0 / self.settings.period.0) % (LOOKS.0 / self.settings.period.0).max(1);
        let looks = turn == i64::from(robot.0) % (LOOKS.0 / self.settings.period.0).max(1);
        let Some(rack) = self.ledger.index().places.rack_on(node).filter(|_| looks) else { return false };
        let is_low = self.battery(robot) < self.charging(robot).low;
        let is_no_use = is_low || !self.warehouse().can_carry(self.body(robot), rack);
        (is_no_use || self.is_for_another(robot, rack, now)) && self.ledger.index().queue.is_wanted(rack)
    }

    /// Whether a waiting job for a rack is one that a robot may not do because an operator chose another robot.
    fn is_for_another(&self, robot: RobotId, rack: RackId, now: Time) -> bool {
        let chosen = self.ledger.index().chosen.iter().map(|id| &self.ledger.jobs[id]);
        let mut of_rack = chosen.filter(|job| job.request.kind.rack() == Some(rack));
        of_rack.any(|job| !self.is_allowed(robot, job, now))
    }

    fn is_sent_to_a_charger(&self, robot: RobotId) -> bool {
        let record = &self.ledger.robots[robot];
        matches!(record.task, Task::Move { purpose: Purpose::Charge, .. }) && !record.failed
    }

    fn leaves_charger(&self, robot: RobotId) -> bool {
        self.at_charger(robot) && self.ledger.robots[robot].task != Task::Idle
    }

    /// The robot with the highest charge among those that stand idle at a charger and can spare it.
    fn fullest_at_a_charger(&self, needs: RobotId, now: Time) -> Option<RobotId> {
        let spare = |r: &RobotId| {
            let c = self.charging(*r);
            let (has, wants) = (self.battery(*r), self.battery(needs));
            has >= c.enough || (self.is_critical(needs) && has >= c.low && has > wants + MARGIN)
        };
        let stands = self.idle_robots(now).into_iter().filter(|r| self.at_charger(*r)).filter(spare);
        stands.max_by(|a, b| self.battery(*a).total_cmp(&self.battery(*b)).then(b.cmp(a)))
    }
}
