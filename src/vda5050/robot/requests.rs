//! What a virtual robot of 3.0 asks its master for, and what it does with the answers.
//!
//! Main type: [`RequestList`]; main functions: `ask_for_releases`, `take_responses`. Something in the robot's way makes
//! it go round within the corridor of its edge: at once if it may, or else when it was granted. Source: VDA 5050 3.0,
//! section 6.4.3. Refuses: to drive aside, which its simple body cannot; it takes the line for the way round.

use super::VirtualRobot;
use super::complaints::ErrorEnd;
use super::setup::SECOND_US;
use crate::model::answer::{Grant, Response};
use crate::model::error::ErrorLevel;
use crate::model::state::{Request, RequestStatus, RequestSubject};

/// After a refusal, or the end of a grant, the robot asks again after this long.
const AGAIN_US: i64 = 5 * SECOND_US;

/// What a robot asks for.
#[derive(Clone, Debug, Default)]
pub(super) struct RequestList {
    held: Vec<HeldRequest>,
    /// How many requests there were.
    count: u32,
    rests_until_us: i64,
    /// Whether something is in the robot's way on its line.
    is_obstructed: bool,
}

#[derive(Clone, Debug)]
struct HeldRequest {
    request: Request,
    /// When the grant ends.
    until_us: Option<i64>,
}

impl RequestList {
    pub(super) fn to_states(&self) -> Vec<Request> {
        self.held.iter().map(|held| held.request.clone()).collect()
    }

    /// Whether a request about something has a status.
    pub(super) fn is(&self, subject: &RequestSubject, status: RequestStatus) -> bool {
        self.held.iter().any(|held| held.request.subject == *subject && held.request.status == status)
    }

    fn loses(&mut self, now_us: i64) {
        self.rests_until_us = now_us.saturating_add(AGAIN_US);
    }
}

impl VirtualRobot {
    /// Puts something in the robot's way on its line, or takes it away.
    pub fn set_obstructed(&mut self, is_obstructed: bool) {
        self.requests.is_obstructed = is_obstructed;
    }

    /// Asks for what the robot needs now, and lets grants end.
    pub(super) fn ask_for_releases(&mut self, now_us: i64) {
        let needed = self.needed_releases();
        self.requests.held.retain(|held| needed.contains(&held.request.subject));
        let ends = |held: &&mut HeldRequest| {
            held.request.status == RequestStatus::Granted
                && held.until_us.is_some_and(|until| until <= now_us)
        };
        let mut has_lost = false;
        for held in self.requests.held.iter_mut().filter(ends) {
            held.request.status = RequestStatus::Expired;
            has_lost = true;
        }
        if has_lost {
            self.lose_release(now_us);
        }
        if needed.is_empty() {
            self.forget_errors(&[ErrorEnd::ReleaseGranted]);
        }
        for subject in needed {
            let live = [RequestStatus::Requested, RequestStatus::Granted];
            let has_live = live.into_iter().any(|status| self.requests.is(&subject, status));
            if has_live || now_us < self.requests.rests_until_us {
                continue;
            }
            self.requests.held.retain(|held| held.request.subject != subject);
            self.requests.count = self.requests.count.wrapping_add(1);
            let id = format!("{}-{}", self.setup.serial, self.requests.count);
            let request = Request { id, subject, status: RequestStatus::Requested };
            self.requests.held.push(HeldRequest { request, until_us: None });
        }
    }

    /// Takes the answers of the master.
    pub(super) fn take_responses(&mut self, responses: &[Response]) {
        let now_us = self.now_us();
        for response in responses {
            let is_meant = |held: &&mut HeldRequest| held.request.id == response.request;
            let Some(held) = self.requests.held.iter_mut().find(is_meant) else { continue };
            match response.grant {
                Grant::Granted => {
                    held.request.status = RequestStatus::Granted;
                    held.until_us = response.until_us;
                    self.forget_errors(&[ErrorEnd::ReleaseGranted]);
                }
                Grant::Revoked => {
                    held.request.status = RequestStatus::Revoked;
                    self.lose_release(now_us);
                }
                Grant::Rejected => {
                    self.requests.held.retain(|held| held.request.id != response.request);
                    self.requests.loses(now_us);
                }
                Grant::Queued => {}
            }
        }
        self.reporting.must_say = true;
    }

    /// Whether the robot stands because of what is in its way.
    pub(super) fn waits_for_release(&self) -> bool {
        let Some(way) = self.order.edges.first().filter(|_| self.requests.is_obstructed) else {
            return false;
        };
        match way.edge.corridor {
            None => true,
            Some(corridor) if !corridor.release_required => false,
            Some(_) => !self.requests.is(&self.of_first_edge(), RequestStatus::Granted),
        }
    }

    fn of_first_edge(&self) -> RequestSubject {
        let first = self.order.edges.first();
        let (edge, sequence) = first.map(|way| (way.edge.id.clone(), way.edge.sequence)).unwrap_or_default();
        RequestSubject::Corridor { edge, sequence }
    }

    /// What the robot must be granted before it drives on.
    fn needed_releases(&self) -> Vec<RequestSubject> {
        let first = self.order.edges.first().filter(|way| way.edge.released && self.requests.is_obstructed);
        let is_asked_for = first.and_then(|way| way.edge.corridor).is_some_and(|c| c.release_required);
        if !self.speaks_3_0() {
            return Vec::new();
        }
        let mut all = self.zones_to_enter();
        all.extend(is_asked_for.then(|| self.of_first_edge()));
        all
    }

    /// A grant has ended while it was needed: the robot stops where it is.
    fn lose_release(&mut self, now_us: i64) {
        self.requests.loses(now_us);
        let words = "a release was lost";
        self.complain("RELEASE_LOST", ErrorLevel::Critical, Vec::new(), words, ErrorEnd::ReleaseGranted);
    }
}
