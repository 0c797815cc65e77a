//! Robots that stand where nothing is held for them: people pushed them while the server was down, or drove them by
//! hand.
//!
//! Main function: `note_place`. A robot that stands on a free node and has forgotten its route is taken up there
//! ([`RouteFact::Placed`]). Any other displaced robot is treated as failed, and the floor where it really stands is
//! closed, until its reports fit again. Refuses: to check robots that drive, except at the first report after a start,
//! and to guess what became of a rack.

use crate::state::closed_areas::storage_behind;
use crate::state::displaced::{Displaced, Displacement, OFF_ROUTE_M};
use crate::state::fact::{Act, KeptRoute, RobotFact, RouteFact, Task};
use crate::state::fault::Fault;
use crate::state::floor::Floor;
use crate::state::io::Telemetry;
use crate::state::job::JobState;
use crate::state::restrictions::ClosedNodes;
use crate::state::scene::{SILENCE, Scene};
use crate::state::writer::Writer;
use crate::traffic::failure::fail;
use crate::traffic::state::Traffic;
use giveway_floor::geometry::{Point, Segment, axis_distance, axis_distance_to_segment, to_mm};
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{Cause, Condition, Effect, Stage};
use giveway_floor::time::{Time, Window};
use giveway_floor::warehouse::NodeKind;

/// Squares that overlap by less than this only touch, metres.
const TOUCH_M: f64 = 1e-3;
/// A displaced robot that moved by less than this still blocks the same nodes, metres.
const SAME_M: f64 = 0.01;

impl Traffic {
    /// Compares a robot's report with the ledger when the robot stands, and at its first report after a start. Returns
    /// whether the robot was taken up somewhere else.
    pub(super) fn note_place(
        &mut self,
        writer: &mut Writer,
        robot: RobotId,
        seen: &Telemetry,
        now: Time,
    ) -> bool {
        let (known, displaced) = (writer.scene.is_placed(robot), writer.scene.displaced(robot).is_some());
        let by_hand = seen.fault == Some(Fault::Manual);
        let stands = seen.stands() && !by_hand;
        if known && !stands && !displaced && !by_hand {
            return false;
        }
        if writer.settings.without_conflicts || writer.floor().is_in_place(seen) {
            fits_again(writer, robot);
            return false;
        }
        // A fenced-off robot is not taken up, but no robot may drive into it either.
        let is_fenced = writer.ledger().robots[robot].fenced.is_some();
        if by_hand {
            displace(writer, seen, Displacement::ByHand, now);
            return false;
        }
        match self.place_for(writer, seen) {
            Ok(node) if stands && !is_fenced => {
                take_up(writer, robot, node, now);
                self.revoked.remove(&robot);
                return true;
            }
            Ok(node) => displace(writer, seen, Displacement::KnowsWaypoints(node), now),
            Err(why) => displace(writer, seen, why, now),
        }
        false
    }

    /// The node on which a robot can be taken up, or why it cannot be.
    fn place_for(&mut self, writer: &mut Writer, seen: &Telemetry) -> Result<NodeId, Displacement> {
        let robot = seen.robot;
        let (node, off_m) = writer.floor().nearest_node(seen.pose.at);
        if !writer.floor().carries_what_is_promised(seen) {
            let expected = writer.ledger().rack_on(robot);
            return Err(Displacement::Load { carries: seen.rack, expected });
        }
        if off_m > OFF_ROUTE_M {
            let off_mm = to_mm(off_m);
            return Err(Displacement::OffNode { at: seen.pose.at.into(), nearest: node, off_mm });
        }
        if seen.known > seen.reached {
            return Err(Displacement::KnowsWaypoints(node));
        }
        if let Some(other) = writer.floor().granted_to_another(robot, node) {
            return Err(Displacement::GrantedTo(node, other));
        }
        let stored = writer.ledger().index().places.rack_on(node);
        if let Some(rack) = stored.filter(|_| seen.rack.is_some()) {
            return Err(Displacement::RackThere(node, rack));
        }
        // Searched for once for each place: the answer stays the same and costs a search.
        let no_way = Displacement::NoWayOut(node);
        let asked = writer.scene.displaced(robot).is_some_and(|d| d.why == no_way);
        if asked || !self.has_way_out(writer.floor(), robot, node) { Err(no_way) } else { Ok(node) }
    }

    /// Whether lanes lead on from a node: to where the robot is to bring its rack or, without a rack, to a place to
    /// stay.
    fn has_way_out(&mut self, floor: Floor<'_>, robot: RobotId, node: NodeId) -> bool {
        let stages = match floor.ledger.robots[robot].task {
            task if task.carried().is_some() => floor.stages(robot),
            _ if floor.warehouse().kind(node).is_lasting() => return true,
            _ => {
                let stays = floor.warehouse().nodes_where(NodeKind::is_lasting);
                stays.first().map(|n| Stage::to_stay(*n)).into_iter().collect()
            }
        };
        let kind = floor.kind(robot);
        self.planners.of_mut(kind).free_flow(node, &stages).is_some()
    }

    /// Revokes the grants of robots that were stopped before they drove into a displaced robot, so that they can go
    /// round it and it can be taken up.
    pub(crate) fn revoke_grants_into_displaced(&mut self, writer: &mut Writer, now: Time) {
        if writer.scene.all_displaced().next().is_none() {
            return;
        }
        for robot in writer.ledger().present() {
            let back = self.drives_back_to(writer.floor(), robot);
            if writer.floor().drives_into(robot, back).is_some() {
                self.revoke_grant(writer, robot, now);
            }
        }
    }

    /// Whether robots in the ledger have not been heard of since a start a short while ago: they may stand anywhere, so
    /// no robot is told to drive until they report or that while has passed.
    pub(crate) fn waits_for_first_reports(&mut self, scene: &Scene, now: Time) -> bool {
        if self.unheard.is_empty() {
            return false;
        }
        self.unheard.retain(|r| scene.robot(*r).is_none());
        let since = *self.started.get_or_insert(now);
        if now - since >= SILENCE {
            self.unheard.clear();
        }
        !self.unheard.is_empty()
    }
}

fn fits_again(writer: &mut Writer, robot: RobotId) {
    if writer.scene.place(robot).is_some() {
        writer.restrictions.conditions.withdraw(Cause::Robot(robot));
    }
}

/// Books a robot on the free node where it stands, and nowhere else. The robot keeps the rack that it carries and the
/// job for that rack, and gives any other job back. Robots that were promised the place lose that route.
pub(super) fn take_up(writer: &mut Writer, robot: RobotId, node: NodeId, now: Time) {
    match writer.ledger().robots[robot].task {
        Task::Fetch { job: Some(job), .. } | Task::Move { job: Some(job), .. } => {
            writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        }
        Task::Fetch { job: None, .. } | Task::Move { job: None, .. } => {
            writer.record(RobotFact::Tasked { robot, task: Task::Idle });
        }
        Task::Deliver { job, .. } if matches!(writer.ledger().jobs[&job].state, JobState::Picking { .. }) => {
            writer.progress(job, JobState::Carrying { robot }, None, now);
        }
        Task::Deliver { .. } | Task::Store { .. } | Task::Idle => {}
    }
    debug_assert!(
        writer.floor().granted_to_another(robot, node).is_none(),
        "{robot:?} stands in another's way"
    );
    let serial = writer.ledger().chain(robot).end();
    let cut = writer.floor().truncated_for_place(robot, node);
    writer.record(RouteFact::Placed { robot, node, serial, cut, at: now });
    fits_again(writer, robot);
}

/// Marks a robot that cannot go on from where it stands as failed, and closes the floor so that no robot drives into
/// it.
fn displace(writer: &mut Writer, seen: &Telemetry, why: Displacement, now: Time) {
    let (robot, at) = (seen.robot, seen.pose.at);
    let before = writer.scene.displaced(robot);
    let is_off = !writer.floor().keeps_to_its_holds(seen);
    let nodes = match before {
        Some(b) if (b.at - at).norm() < SAME_M && b.is_off == is_off => b.nodes.clone(),
        _ if is_off => writer.floor().nodes_blocked_by(robot, at),
        _ => Vec::new(),
    };
    if before.is_none_or(|b| b.why != why) {
        tracing::warn!(robot = writer.ledger().robots[robot].name, ?why, "a robot is not at its reservation");
    }
    let displaced = Displaced { why, at, is_off, nodes };
    let closing = closed_around(writer.floor(), robot, &displaced, now);
    writer.scene.displace(robot, displaced);
    writer.restrictions.close(closing);
    if !writer.ledger().robots[robot].failed {
        fail(writer, robot, now);
    }
    assert!(writer.ledger().robots[robot].failed, "{robot:?} is displaced and counts as failed");
}

/// The floor around robots that are off everything they hold.
pub(crate) fn closed_by_displaced(floor: Floor<'_>, now: Time) -> ClosedNodes {
    let mut all = ClosedNodes::default();
    for (robot, displaced) in floor.scene.all_displaced() {
        let one = closed_around(floor, robot, displaced, now);
        all.conditions.extend(one.conditions);
        all.since.extend(one.since);
    }
    all
}

fn closed_around(floor: Floor<'_>, robot: RobotId, displaced: &Displaced, now: Time) -> ClosedNodes {
    let (cause, window) = (Cause::Robot(robot), Window::new(now, Time::MAX));
    let closed = Condition { window, effect: Effect::Closed, cause };
    let shut = |n: NodeId| displaced.nodes.contains(&n).then_some(now);
    let cut_off = displaced.nodes.iter().flat_map(|n| storage_behind(floor.warehouse(), *n, shut));
    ClosedNodes {
        conditions: displaced.nodes.iter().map(|node| (*node, closed)).collect(),
        since: displaced.nodes.iter().map(|node| (*node, now)).chain(cut_off).collect(),
    }
}

impl Floor<'_> {
    /// Whether a robot stands where the ledger has it, and carries what the ledger says.
    pub fn is_in_place(&self, seen: &Telemetry) -> bool {
        self.keeps_to_its_holds(seen) && self.carries_what_is_promised(seen)
    }

    /// Why a robot cannot go on from where it stands, if that is so.
    pub fn displacement(&self, robot: RobotId) -> Option<Displacement> {
        self.scene.displaced(robot).map(|d| d.why)
    }

    /// The displaced robot into which a robot would drive on its grant, or on its way back.
    pub(crate) fn drives_into(self, robot: RobotId, back: Option<Point>) -> Option<RobotId> {
        let others = || self.scene.all_displaced().filter(|(r, d)| *r != robot && d.is_off);
        others().next()?;
        let at = self.place_of(robot);
        let way = self.granted_way(robot, at, back);
        let hits = |other: RobotId, p: Point| {
            let reach = self.footprint(robot).half_m() + self.footprint(other).half_m() - TOUCH_M;
            let nearest = way.windows(2).map(|w| axis_distance_to_segment(p, Segment { a: w[0], b: w[1] }));
            // A robot that is too near already may leave.
            nearest.fold(f64::INFINITY, f64::min) < reach.min(axis_distance(p, at) - SAME_M)
        };
        others().find(|(r, d)| hits(*r, d.at)).map(|(r, _)| r)
    }

    /// Whether the pose is on the nodes that the robot was granted or on the straight lanes between them, from the node
    /// that it reached last to the last one that it knows. A robot that knows no more than it reached takes on the next
    /// waypoint if it stands on the way there, so that lane counts, too.
    fn keeps_to_its_holds(&self, seen: &Telemetry) -> bool {
        let chain = self.ledger.chain(seen.robot);
        let last = chain.granted() - 1;
        let from = seen.reached.clamp(chain.first(), last);
        let to = seen.known.max(from + 1).min(last);
        let place =
            |serial| self.warehouse().nodes[chain.get(serial).expect("granted visits are held").node].at;
        (place(from) - seen.pose.at).norm() <= OFF_ROUTE_M
            || (from..to).any(|s| {
                let lane = Segment { a: place(s), b: place(s + 1) };
                lane.distance_to(seen.pose.at) <= OFF_ROUTE_M
            })
            || self.is_within_corridor(seen.robot, from..to, seen.pose.at)
    }

    /// Whether the rack on a robot is the one that was on it before its present action, or will be after it.
    fn carries_what_is_promised(&self, seen: &Telemetry) -> bool {
        let robot = seen.robot;
        let next = self.ledger.robots[robot].stops.first().filter(|_| self.next_stop_is_granted(robot));
        let after = match next.map(|s| s.act) {
            Some(Act::Lift(rack)) => seen.rack == Some(rack),
            Some(Act::Set(_)) => seen.rack.is_none(),
            Some(Act::Pick(_) | Act::Arrive) | None => false,
        };
        after || seen.rack == self.ledger.rack_on(robot)
    }

    fn nearest_node(&self, at: Point) -> (NodeId, f64) {
        let nodes = self.warehouse().nodes.pairs().map(|(id, n)| (id, (n.at - at).norm()));
        nodes.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a robot stands on a floor that has nodes")
    }

    /// Another robot that may be on a node, or on something in conflict with it.
    fn granted_to_another(&self, robot: RobotId, node: NodeId) -> Option<RobotId> {
        let others = self.holders_of(robot, node);
        others.into_iter().find_map(|(r, granted)| granted.then_some(r))
    }

    /// Other robots that hold a node, or something in conflict with it, and whether that was granted to them.
    fn holders_of(&self, robot: RobotId, node: NodeId) -> Vec<(RobotId, bool)> {
        let timeline = self.ledger.timeline();
        let loaded = self.ledger.rack_on(robot).is_some();
        let line = timeline.line(robot, loaded, self.warehouse().node_resource(node));
        let held = timeline.held_by_others(line, robot);
        held.map(|h| (h.holder, h.granted)).collect()
    }

    /// What other robots keep that were promised the node on which a robot now stands, and robots behind them in turn.
    fn truncated_for_place(&self, robot: RobotId, node: NodeId) -> Vec<KeptRoute> {
        let promised = self.holders_of(robot, node).into_iter().map(|(r, _)| r).collect();
        self.kept_by(self.all_behind(promised, Some(robot)))
    }

    /// Nodes on which another robot, of whichever kind, would touch a robot that stands at `at`, and the ends of lanes
    /// on which it would.
    fn nodes_blocked_by(&self, robot: RobotId, at: Point) -> Vec<NodeId> {
        let w = self.warehouse();
        let reach = self.footprint(robot).half_m() + w.widest_half_m() - TOUCH_M;
        let place = |n: NodeId| w.nodes[n].at;
        let touches = |n: NodeId| axis_distance(place(n), at) < reach;
        let mut blocked: Vec<NodeId> = w.nodes.ids().filter(|n| touches(*n)).collect();
        for lane in w.lanes.iter().filter(|l| !touches(l.a) && !touches(l.b)) {
            let way = Segment { a: place(lane.a), b: place(lane.b) };
            if axis_distance_to_segment(at, way) < reach {
                blocked.extend([lane.a, lane.b]);
            }
        }
        blocked.sort_unstable();
        blocked.dedup();
        blocked
    }
}
