//! Faults between a robot and Giveway: its link is down, takes no orders for it, or reports that it holds few visits.
//!
//! Main type: [`LinkTrouble`]. The link reports the fault, as real links do. Refuses: radios that lose and delay
//! messages, which report nothing (`link.rs`).

use crate::random::Stream;
use crate::scenario::Faults;
use giveway_fleet::{Command, Input, LinkReach, LinkState};
use giveway_floor::id::RobotId;
use giveway_floor::text::Sentence;
use giveway_floor::time::{Span, Time};

/// Fewest and most visits of a robot that holds few.
const FEW: (usize, usize) = (1, 4);

/// The fault of one robot's link.
#[derive(Debug)]
pub(super) struct LinkTrouble {
    random: Stream,
    /// The state of the link and its end, if it is not the usual one.
    state: Option<(LinkState, Time)>,
    /// Whether Giveway knows the state.
    is_told: bool,
    /// How often the link had a fault.
    pub count: u64,
}

impl LinkTrouble {
    pub fn new(random: Stream) -> LinkTrouble {
        LinkTrouble { random, state: None, is_told: true, count: 0 }
    }

    /// Giveway has restarted, and knows nothing of links.
    pub fn tell_again(&mut self) {
        self.is_told = self.state.is_none();
    }

    /// Whether messages get through.
    pub fn is_connected(&self) -> bool {
        self.state.as_ref().is_none_or(|(state, _)| state.reach.is_up())
    }

    /// Whether orders get through.
    pub fn takes_orders(&self) -> bool {
        self.is_connected() && self.state.as_ref().is_none_or(|(state, _)| state.refuses.is_none())
    }

    /// Whether a command gets through. A limit gets through wherever messages do.
    pub fn passes(&self, command: &Command) -> bool {
        self.takes_orders() || self.is_connected() && matches!(command, Command::Limit(_))
    }

    /// Begins and ends faults.
    fn pass(&mut self, faults: &Faults, may: bool, from: Time, to: Time) {
        // Rates of zero draw no number, so that older scenarios run as they did.
        let rate = faults.link_outages_per_hour;
        match &self.state {
            Some((_, until)) if rate == 0.0 || to >= *until => (self.state, self.is_told) = (None, false),
            Some(_) => {}
            None if rate == 0.0 => {}
            None => {
                let hours = (to - from).as_secs_f64() / 3600.0;
                if self.random.happens(rate * hours) && may {
                    let until = to + Span::from_secs_f64(self.random.between(0.5, faults.repair_s));
                    (self.state, self.is_told) = (Some((self.draw(), until)), false);
                    self.count += 1;
                }
            }
        }
    }

    fn draw(&mut self) -> LinkState {
        let usual = LinkState::default();
        match self.random.below(3) {
            0 => LinkState { reach: LinkReach::Lost, ..usual },
            1 => LinkState { refuses: Some(Sentence::without_code("somebody works on it")), ..usual },
            _ => LinkState { capacity: Some(FEW.0 + self.random.below(FEW.1)), ..usual },
        }
    }

    /// The link's report on its robot, if it has changed. A fault begins only if it `may`.
    pub fn say(
        &mut self,
        robot: RobotId,
        faults: &Faults,
        may: bool,
        (from, to): (Time, Time),
    ) -> Option<Input> {
        self.pass(faults, may, from, to);
        if std::mem::replace(&mut self.is_told, true) {
            return None;
        }
        let state = self.state.as_ref().map_or_else(LinkState::default, |(state, _)| state.clone());
        Some(Input::Link(robot, state))
    }
}
