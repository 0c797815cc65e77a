//! Sixth phase: how far may each robot drive now? Grants follow the order on each resource, not the clock.
//!
//! Refuses: to grant past a stop that is not done, past a robot that was promised a resource first, or to robots that
//! are silent or halted; and to grant more than a robot needs to keep its speed, since a grant can be revoked only
//! from a robot that stands and confirms it.

use crate::state::fact::{Moved, RouteFact};
use crate::state::floor::Floor;
use crate::state::io::{Command, Telemetry, Waypoint};
use crate::state::kind::ObeyedLimits;
use crate::state::writer::Writer;
use crate::state::yielding::YieldingState;
use crate::traffic::state::{Direction, Traffic, Withheld};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::timeline::Visit;
use giveway_people::aware::SLOW_MPS;

/// A visit may be granted this long before its planned entry; a robot that can enter even earlier is retimed first.
const EARLY: Span = Span::from_secs(4);
/// How far ahead a robot that could go on early looks for people, closed areas and displaced robots.
const PLANNED: Span = Span::from_secs(60);
/// What is granted beyond the distance needed, metres: about one node.
const NODE_M: f64 = 1.0;
/// A robot that is granted one node at a time gets the next if it can drive less than this on its grant, metres.
const LEAST_M: f64 = 1e-3;
/// Orders are repeated at this interval until the robot confirms that it knows them.
const REPEAT: Span = Span::from_millis(600);
/// A robot at a stop is reminded of its action there at this interval.
const REMIND: Span = Span::from_secs(3);

impl Traffic {
    /// Grants to each robot what it needs to keep its speed. A robot that is `interrupted` gets no more than it has.
    pub(crate) fn grant(
        &mut self,
        writer: &mut Writer,
        yielding: &YieldingState,
        interrupted: impl Fn(RobotId) -> bool,
        now: Time,
    ) {
        if self.waits_for_first_reports(&writer.scene, now) {
            return;
        }
        while self.withheld.len() < writer.ledger().robots.len() {
            self.withheld.push(None);
        }
        for robot in writer.ledger().present() {
            writer.at_hand.note(robot);
            if writer.ledger().robots[robot].failed || writer.scene.fit(robot, now).is_none() {
                continue;
            }
            let before = writer.ledger().chain(robot).granted();
            let direction = self.direction(robot);
            let stays = direction != Some(Direction::Forward) && writer.floor().is_halfway(robot);
            let goes_back = direction == Some(Direction::Back);
            let is_held_back = writer.floor().would_not_stop(yielding, robot);
            let is_kept =
                self.settling || writer.floor().is_halted(robot) || interrupted(robot) || is_held_back;
            let gets_no_more = is_kept || stays || goes_back;
            self.withheld[robot] = match gets_no_more {
                true => writer.floor().withholds(yielding, robot, before, now),
                false => extend_grant(writer, yielding, robot, now),
            };
            let granted = writer.ledger().chain(robot).granted() > before;
            let is_passing = writer.floor().must_hear_of_passing(yielding, robot, now);
            let is_due =
                granted || is_passing || (goes_back || !stays) && writer.floor().must_repeat(robot, now);
            if is_due && !is_held_back {
                send(writer, yielding, robot, goes_back, now);
            }
        }
    }
}

/// Grants as many further visits as the robot needs to keep its speed. Returns why there are no more, if it needs more.
fn extend_grant(
    writer: &mut Writer,
    yielding: &YieldingState,
    robot: RobotId,
    now: Time,
) -> Option<Withheld> {
    let first = writer.ledger().chain(robot).granted();
    let withheld = grant_ahead(writer, yielding, robot, now);
    let early = withheld == Some(Withheld::Early) && writer.ledger().chain(robot).granted() == first;
    if early && go_on_early(writer, robot, now) {
        grant_ahead(writer, yielding, robot, now)
    } else {
        withheld
    }
}

/// Grants further visits up to the first that is withheld, and no more than the robot needs.
fn grant_ahead(writer: &mut Writer, yielding: &YieldingState, robot: RobotId, now: Time) -> Option<Withheld> {
    let floor = writer.floor();
    let first = floor.ledger.chain(robot).granted();
    let mut serial = first;
    let mut ahead = floor.granted_ahead_m(robot);
    let by_nodes = floor.goes_by_nodes(yielding, robot, now);
    let enough = if by_nodes { LEAST_M } else { floor.needed_ahead_m(robot, yielding.of(robot).limit_mps()) };
    let mut withheld = None;
    let passes = |serial| yielding.of(robot).passes(serial).is_some();
    // A robot that passes a person is granted the whole way past that person at once.
    let most = floor.holds_visits_before(robot);
    while serial < most && (ahead < enough || passes(serial)) {
        withheld = floor.withholds(yielding, robot, serial, now);
        if withheld.is_some() {
            break;
        }
        ahead += floor.step_m(robot, serial);
        serial += 1;
    }
    if serial > first {
        debug_assert!(writer.ledger().timeline().waits_for(robot, first).is_none());
        assert!(!writer.floor().is_halted(robot), "{robot:?} is to stand and is granted more");
        writer.record(RouteFact::Granted { robot, serial: serial - 1, at: now });
    }
    withheld
}

/// Moves forward what a robot holds after its last granted visit, if nothing that it was to wait for is left. Returns
/// whether anything moved.
fn go_on_early(writer: &mut Writer, robot: RobotId, now: Time) -> bool {
    if writer.floor().waits_as_planned(robot, now) {
        return false;
    }
    let chain = writer.ledger().chain(robot);
    let last = chain.granted() - 1;
    let here = chain.get(last).expect("what is granted is held");
    let is_there = chain.first() == last;
    let depart = if is_there { now } else { now.max(here.arrive + here.stay) };
    let shifts = writer.ledger().timeline().advance(robot, depart);
    let moves = !shifts.is_empty();
    if moves {
        writer.record(RouteFact::Retimed { moved: vec![Moved { robot, shifts }] });
    }
    moves
}

/// Sends everything granted from where the robot is; if it is to drive back to that node, nothing beyond.
fn send(writer: &mut Writer, yielding: &YieldingState, robot: RobotId, goes_back: bool, now: Time) {
    let grant = writer.ledger().timeline().granted(robot).expect("every robot stands somewhere");
    let grant = if goes_back { grant.first_alone() } else { grant };
    let chain = writer.ledger().chain(robot);
    let stops = &writer.ledger().robots[robot].stops;
    // The robot may leave the line only if its way back onto the line is granted.
    let may_leave = yielding.of(robot).passing.is_some_and(|p| p.what.to < chain.granted());
    let waypoints = (grant.serials())
        .map(|serial| Waypoint {
            serial,
            node: chain.get(serial).expect("granted visits are held").node,
            act: stops.iter().find(|s| s.serial == serial).map(|s| s.act),
            passes: may_leave.then(|| yielding.of(robot).passes(serial)).flatten(),
        })
        .collect();
    let recalls = writer.ledger().robots[robot].recalls;
    assert!(
        grant.serials().all(|serial| serial < chain.granted()),
        "orders end where the grant of {robot:?} does"
    );
    debug_assert_eq!(grant.serials().next(), Some(chain.first()), "orders begin where {robot:?} is");
    let after = writer.floor().kind(robot).capabilities.horizon_nodes as u64;
    let horizon = (chain.granted()..(chain.granted() + after).min(chain.end())).filter(|_| !goes_back);
    let horizon = horizon.map(|serial| chain.get(serial).expect("what is planned is held").node).collect();
    writer.send(robot, Command::Drive { grant, waypoints, recalls, horizon });
    writer.scene.robot_mut(robot).told = Some(now);
}

impl Traffic {
    /// The worker who is the only reason why a robot is granted no more, and how far the robot can drive already,
    /// metres. Nothing if there is another reason, or if another robot waits for what this one leaves. Linear in
    /// robots.
    pub(crate) fn kept_by_a_worker(&self, floor: Floor<'_>, robot: RobotId) -> Option<(WorkerId, f64)> {
        let Some(Withheld::Condition(Cause::Worker(worker), _)) = self.withheld(robot) else { return None };
        let turn_after = |w: &Option<Withheld>| matches!(w, Some(Withheld::Turn(_, r)) if *r == robot);
        let is_waited_for = self.withheld.iter().any(turn_after);
        (!is_waited_for).then(|| (worker, floor.granted_ahead_m(robot)))
    }
}

impl Floor<'_> {
    /// Why a visit cannot be granted now, if it cannot. If the robot is due and waits both for its turn and for a
    /// person, the person is named.
    fn withholds(
        &self,
        yielding: &YieldingState,
        robot: RobotId,
        serial: u64,
        now: Time,
    ) -> Option<Withheld> {
        let Some(visit) = self.ledger.chain(robot).get(serial) else { return Some(Withheld::End) };
        if self.ledger.robots[robot].stops.first().is_some_and(|s| s.serial < serial) {
            return Some(Withheld::Stop);
        }
        let turn = self.ledger.timeline().waits_for(robot, serial);
        let turn = turn.map(|(resource, holder)| Withheld::Turn(resource, holder));
        if yielding.of(robot).passes(serial).is_some() {
            let other = || self.holds_back_besides_people(robot, visit, now);
            return turn.or_else(|| other().map(|c| Withheld::Condition(c.cause, Some(c.window.end()))));
        }
        let soon = visit.enter <= now + EARLY;
        let asked = if turn.is_some() { visit.enter <= now } else { soon };
        if !asked {
            return turn.or(Some(Withheld::Early));
        }
        let condition = self.grant_waits_for(yielding, robot, visit, now);
        condition.map(|(cause, until)| Withheld::Condition(cause, until)).or(turn)
    }

    /// Whether a robot waits, or is planned later, because of a person, a closed area or a displaced robot ahead: the
    /// search knew what would restrict the robot before its planned arrival, and waiting here may be better.
    fn waits_as_planned(&self, robot: RobotId, now: Time) -> bool {
        let conditions = self.conditions(robot);
        if conditions.is_empty() {
            return false;
        }
        let chain = self.ledger.chain(robot);
        let ahead = (chain.granted()..chain.end()).filter_map(|s| chain.get(s));
        let mut soon = ahead.take_while(|v| v.enter <= now + PLANNED);
        soon.any(|v| {
            let until = Window::new(now, v.enter.max(now + Span(1)));
            let slow = |c: &Condition| matches!(c.effect, Effect::Slow(_));
            conditions.of(v.node).iter().any(|c| !slow(c) && c.window.overlaps(until))
        })
    }

    /// What keeps a visit from being granted now, and until when, where that is known.
    pub(crate) fn grant_waits_for(
        &self,
        yielding: &YieldingState,
        robot: RobotId,
        visit: &Visit,
        now: Time,
    ) -> Option<(Cause, Option<Time>)> {
        let faced = yielding.faces(*self, robot, visit.node, now).map(|w| (Cause::Worker(w), None));
        faced.or_else(|| self.holds_back(robot, visit, now).map(|c| (c.cause, Some(c.window.end()))))
    }

    /// How far ahead a robot under this speed limit must be granted its way so that it can keep its speed, metres: its
    /// braking distance, what it drives until the next grant arrives, and one more node. Near people the distance is
    /// shorter, so that the robot can still be replanned there.
    pub fn needed_ahead_m(&self, robot: RobotId, limit_mps: Option<f64>) -> f64 {
        let k = *self.kinematics(robot);
        let loaded = self.ledger.rack_on(robot).is_some();
        let speed = k.top_mps(loaded).min(limit_mps.unwrap_or(f64::INFINITY).max(SLOW_MPS));
        let latency = (self.settings.period * 2 + k.reaction).as_secs_f64();
        k.braking_m(speed, loaded) + speed * latency + NODE_M
    }

    /// Whether a robot is granted one node at a time: a robot that obeys no limit, or one that cannot drive slowly and
    /// passes a person for whom it has stood for long.
    fn goes_by_nodes(&self, yielding: &YieldingState, robot: RobotId, now: Time) -> bool {
        match self.obeyed_limits(robot) {
            ObeyedLimits::Speeds => false,
            ObeyedLimits::Stops => yielding.stood_for(robot, now).is_some(),
            ObeyedLimits::Nothing => true,
        }
    }

    /// Whether a robot that obeys no limit would have to stand now. Such a robot gets no more than it has, and is not
    /// told of what it has and does not know.
    fn would_not_stop(&self, yielding: &YieldingState, robot: RobotId) -> bool {
        let obeys = self.obeyed_limits(robot);
        obeys == ObeyedLimits::Nothing && yielding.of(robot).limit_mps() == Some(0.0)
    }

    /// The serial number of the first visit for which the robot's link has no room.
    fn holds_visits_before(&self, robot: RobotId) -> u64 {
        let room = self.scene.link(robot).and_then(|link| link.capacity);
        room.map_or(u64::MAX, |room| self.ledger.chain(robot).first() + 1 + room as u64)
    }

    /// Whether the robot may not know its orders: it has not confirmed them, or it has stood at a stop for a while
    /// without finishing (a robot that was restarted there has forgotten its action).
    fn must_repeat(&self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let (here, granted) = (chain.first(), chain.granted());
        let at_stop = self.ledger.robots[robot].stops.first().is_some_and(|s| s.serial == here);
        let knows = self.scene.robot(robot).is_some_and(|t| t.known + 1 >= granted);
        let pause = if knows { REMIND } else { REPEAT };
        (!knows || at_stop) && self.scene.told(robot).is_none_or(|t| now - t >= pause)
    }

    /// Whether a robot may not know yet that it may leave the line to pass a person: this is new, or the robot still
    /// stands.
    fn must_hear_of_passing(&self, yielding: &YieldingState, robot: RobotId, now: Time) -> bool {
        let granted = self.ledger.chain(robot).granted();
        let passing = yielding.of(robot).passing.filter(|p| p.what.to < granted);
        let is_new = passing.is_some_and(|p| p.what.since == now);
        let stands = || self.scene.robot(robot).is_some_and(Telemetry::stands);
        is_new || passing.is_some() && stands() && self.scene.told(robot).is_none_or(|t| now - t >= REPEAT)
    }

    /// Distance from the previous visit to this one, metres.
    fn step_m(&self, robot: RobotId, serial: u64) -> f64 {
        let chain = self.ledger.chain(robot);
        let at = |s: u64| chain.get(s).map(|v| self.warehouse().nodes[v.node].at);
        match (serial.checked_sub(1).and_then(at), at(serial)) {
            (Some(a), Some(b)) => (b - a).norm(),
            _ => 0.0,
        }
    }

    /// How far the robot can still drive on its grant, metres.
    fn granted_ahead_m(&self, robot: RobotId) -> f64 {
        let chain = self.ledger.chain(robot);
        let whole: f64 = (chain.first() + 1..chain.granted()).map(|s| self.step_m(robot, s)).sum();
        let here = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        let driven = self.scene.robot(robot).map_or(0.0, |t| (t.pose.at - here).norm());
        (whole - driven).max(0.0)
    }
}
