//! What a probed robot has said: its last state, the errors that are new, and whether it stands.
//!
//! Main type: [`RobotSaid`]. Refuses: to take `driving` for movement; positions show it.

use giveway_floor::geometry::Point;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{ActionState, ActionStatus, Position, RobotError, State};
use std::collections::VecDeque;

/// A robot that was not seen to move by more than this, metres …
const STILL_M: f64 = 0.03;
/// … for this long stands.
const STILL: Span = Span::from_millis(1500);
/// Places kept.
const PLACES: usize = 64;

/// What a robot has said.
#[derive(Debug, Default)]
pub(super) struct RobotSaid {
    state: Option<(Time, Box<State>)>,
    /// States since the stage began.
    states: u32,
    /// The errors that stood when the stage began, and those that have stood since: some robots tell one in a single
    /// state.
    before: Vec<RobotError>,
    new_errors: Vec<RobotError>,
    /// Where it was, oldest first.
    places: VecDeque<(Time, Point)>,
}

impl RobotSaid {
    pub fn take_state(&mut self, now: Time, state: Box<State>) {
        self.take_pose(now, state.position.as_ref());
        self.states += 1;
        self.note_errors(&state.errors);
        self.state = Some((now, state));
    }

    pub fn take_pose(&mut self, now: Time, position: Option<&Position>) {
        let Some(position) = position else { return };
        self.places.push_back((now, Point::new(position.x, position.y)));
        if self.places.len() > PLACES {
            self.places.pop_front();
        }
    }

    /// A stage begins: what is said from now on is new.
    pub fn begin(&mut self) {
        self.states = 0;
        self.new_errors.clear();
        self.before = self.state.as_ref().map(|(_, state)| state.errors.clone()).unwrap_or_default();
    }

    /// The last state.
    pub fn state(&self) -> Option<&State> {
        self.state.as_ref().map(|(_, state)| &**state)
    }

    /// The last state, if it came since the stage began.
    pub fn new_state(&self) -> Option<&State> {
        self.state().filter(|_| self.states > 0)
    }

    /// Errors that have been told since the stage began and did not stand then.
    pub fn new_errors(&self) -> &[RobotError] {
        &self.new_errors
    }

    fn note_errors(&mut self, errors: &[RobotError]) {
        let mut old: Vec<&RobotError> = self.before.iter().collect();
        for error in errors {
            match old.iter().position(|other| *other == error) {
                Some(at) => {
                    old.swap_remove(at);
                }
                None if self.new_errors.contains(error) => {}
                None => self.new_errors.push(error.clone()),
            }
        }
    }

    /// What the robot says of an action.
    pub fn action(&self, id: &str) -> Option<&ActionState> {
        let state = self.state()?;
        state.actions.iter().chain(&state.instant_actions).find(|action| action.id == id)
    }

    /// How far an action is, as the robot says.
    pub fn status(&self, id: &str) -> Option<ActionStatus> {
        self.action(id).map(|action| action.status)
    }

    /// Whether the robot says that it has an order.
    pub fn has_order(&self, id: &str) -> bool {
        self.new_state().is_some_and(|state| state.order == id)
    }

    /// Whether the robot has nothing left to drive.
    pub fn is_done(&self) -> bool {
        self.state().is_some_and(|state| state.nodes.is_empty() && state.edges.is_empty())
    }

    /// Where the robot was seen last.
    pub fn place(&self) -> Option<Point> {
        self.places.back().map(|(_, place)| *place)
    }

    /// When it was seen last.
    pub fn placed_at(&self) -> Option<Time> {
        self.places.back().map(|(at, _)| *at)
    }

    /// Whether the robot has stood for a while, and was seen at both ends of it; only what was seen after `since`
    /// counts.
    pub fn stands(&self, since: Time) -> bool {
        let Some((last, here)) = self.places.back() else { return false };
        let seen = self.places.iter().filter(|(at, _)| *at >= since);
        let still = seen.rev().take_while(|(_, place)| (place - here).norm() <= STILL_M);
        still.last().is_some_and(|(first, _)| *last - *first >= STILL)
    }
}
