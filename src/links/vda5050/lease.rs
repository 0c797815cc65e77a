//! Leases: a robot of 3.0 asks before it leaves the line of an edge or enters a RELEASE zone, and is granted that for a
//! while.
//!
//! Main type: [`Leases`]; main function: `mind_leases`. A robot is granted what it asks for if the fleet has neither
//! limited nor paused it: then nobody is near. A grant ends after [`LEASE`] and is renewed before that; when the fleet
//! limits the robot it is revoked in the same turn, and counts until a state shows that the robot has lost it. Refuses:
//! corridors of edges that are not released or have none, other ways through zones, and more than [`MOST`] requests of
//! a robot at once: without an answer nothing is granted.

use super::order::{LegOrder, OrderLife};
use super::pause::PauseState;
use super::session::RobotSession;
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{Grant, Message, Request, RequestStatus, RequestSubject, Response, TopicKind, Version};
use std::collections::BTreeMap;

/// A grant ends after this unless it is renewed.
pub(super) const LEASE: Span = Span::from_secs(30);
/// A grant is renewed this long after it was given.
const RENEWS: Span = Span::from_secs(10);
/// An answer that a state does not show after this is given again.
const AGAIN: Span = Span::from_secs(1);
/// The requests of a robot that are looked at.
const MOST: usize = 32;

/// What the robot was answered, by the ids of its requests.
#[derive(Clone, Debug, Default)]
pub(super) struct Leases {
    answered: BTreeMap<String, LeaseAnswer>,
}

/// The last answer to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LeaseAnswer {
    grant: Grant,
    at: Time,
}

impl Leases {
    /// How many grants count: those that were not revoked, and revoked ones that the robot may still use.
    pub fn held(&self) -> usize {
        let counts = |a: &&LeaseAnswer| matches!(a.grant, Grant::Granted | Grant::Revoked);
        self.answered.values().filter(counts).count()
    }
}

impl RobotSession {
    /// Answers what the robot asks for, renews grants and revokes them.
    pub(super) fn mind_leases(&mut self, now: Time) {
        let Some((heard, state)) = &self.state else { return };
        if self.version < Version::V3_0 || self.unreachable(now).is_some() {
            return;
        }
        let heard = *heard;
        let mut answered = BTreeMap::new();
        let (mut responses, mut is_open) = (Vec::new(), false);
        for request in state.requests.iter().take(MOST) {
            if answered.contains_key(&request.id) {
                continue;
            }
            let before = self.leases.answered.get(&request.id).copied();
            let next = match self.answer_to(request, before, (now, heard)) {
                Some(grant) => {
                    let until = (grant == Grant::Granted).then(|| now + LEASE);
                    let until_us = until.map(|until| until.0);
                    responses.push(Response { request: request.id.clone(), grant, until_us });
                    Some(LeaseAnswer { grant, at: now })
                }
                // What the robot has confirmed counts no more.
                None if matches!(request.status, RequestStatus::Revoked | RequestStatus::Expired) => None,
                None => before,
            };
            let Some(next) = next else { continue };
            is_open |= next.grant == Grant::Revoked;
            is_open |= next.grant == Grant::Granted && request.status == RequestStatus::Requested;
            answered.insert(request.id.clone(), next);
        }
        self.leases.answered = answered;
        debug_assert!(self.leases.held() <= MOST, "a robot has no more leases than requests");
        if !responses.is_empty() {
            self.tell(TopicKind::Responses, Message::Responses(responses));
        }
        if is_open {
            self.look_again(now);
        }
    }

    /// Whether the fleet neither limits the robot nor lets it stand.
    fn is_unlimited(&self) -> bool {
        self.limit_mps.is_none() && !self.pause.wanted && self.pause.stage == PauseState::Drives
    }

    /// Whether the robot drives by an order of ours, so that it may need what it asks for.
    fn is_under_way(&self, now: Time) -> bool {
        matches!(self.order, OrderLife::Has(_)) && self.not_ready(now).is_none()
    }

    /// What is answered to a request now, if anything.
    fn answer_to(
        &self,
        request: &Request,
        before: Option<LeaseAnswer>,
        (now, heard): (Time, Time),
    ) -> Option<Grant> {
        use RequestStatus as S;
        // A robot that stays in a zone at the end of its order keeps its release.
        let allowed = || self.is_unlimited() && self.can_be_granted(&request.subject);
        // A state that was sent after the robot had time to take the answer shows that it has not.
        let is_lost = |before: LeaseAnswer| heard >= before.at + AGAIN;
        match (request.status, before) {
            (S::Revoked | S::Expired, _) => None,
            (S::Requested, None) if self.is_under_way(now) && allowed() => Some(Grant::Granted),
            (S::Requested, None) => Some(Grant::Rejected),
            // What an earlier process granted goes on or is taken back.
            (S::Granted, None) => Some(if allowed() { Grant::Granted } else { Grant::Revoked }),
            (_, Some(answer)) => match answer.grant {
                Grant::Granted if !allowed() => Some(Grant::Revoked),
                Grant::Granted => {
                    let is_due = now - answer.at >= RENEWS;
                    let is_missed = request.status == S::Requested && is_lost(answer);
                    (is_due || is_missed).then_some(Grant::Granted)
                }
                // A robot that still asks does not have what was taken back, and one that has it must lose it.
                Grant::Revoked | Grant::Rejected | Grant::Queued => {
                    let has_it = request.status == S::Granted;
                    is_lost(answer).then_some(if has_it { Grant::Revoked } else { Grant::Rejected })
                }
            },
        }
    }

    fn can_be_granted(&self, subject: &RequestSubject) -> bool {
        match subject {
            RequestSubject::Zone { replanning, .. } => !replanning,
            RequestSubject::Corridor { edge, sequence } => self.is_released_corridor(edge, *sequence),
        }
    }

    /// Whether an edge of the robot's order is released and not passed, and has a corridor.
    fn is_released_corridor(&self, edge: &str, sequence: u32) -> bool {
        let (Some((_, state)), OrderLife::Has(leg), Some(progress)) =
            (&self.state, &self.order, &self.progress)
        else {
            return false;
        };
        let to = leg.serial(sequence).saturating_add(1);
        let is_ahead = sequence % 2 == 1 && (progress.reached + 1..=leg.base).contains(&to);
        state.order == leg.id
            && is_ahead
            && self.ends_of(leg, to, edge).is_some_and(|(from, to)| self.corridor(from, to).is_some())
    }

    /// The nodes that an edge joins, if it has our name for that. Of orders of an earlier process the name is all that
    /// is known.
    fn ends_of(&self, leg: &LegOrder, to: u64, edge: &str) -> Option<(NodeId, NodeId)> {
        let joins = |(from, to): &(NodeId, NodeId)| {
            let rest = edge.strip_prefix(self.map.nodes[*from].name.as_str());
            rest.and_then(|rest| rest.strip_prefix('-')) == Some(self.map.nodes[*to].name.as_str())
        };
        let node =
            |serial: u64| leg.nodes.get(usize::try_from(serial.checked_sub(leg.first)?).ok()?).copied()?;
        if let (Some(from), Some(to)) = (node(to - 1), node(to)) {
            return Some((from, to)).filter(joins);
        }
        let lanes = self.map.lanes.iter().flat_map(|lane| [(lane.a, lane.b), (lane.b, lane.a)]);
        lanes.into_iter().find(joins)
    }
}
