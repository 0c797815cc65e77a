//! Requests on their way into a step, and requests that are kept while no step is made.
//!
//! Main types: [`KeptRequests`], [`Asked`]. Refuses: requests while the journal takes no facts; but stops and releases
//! by hand are kept in their order, whatever else waits, and so are reports of links.

use giveway_fleet::{Input, LinkState, Request, Token};
use giveway_floor::id::RobotId;
use std::collections::BTreeMap;

/// Number of requests that are kept while no step is made. Further ones wait where they came in.
pub const MOST_REQUESTS: usize = 10_000;

/// Requests that no step has had yet.
#[derive(Debug, Default)]
pub struct KeptRequests {
    kept: Vec<Input>,
    /// Last report of each robot's link, which reports a state only once.
    links: BTreeMap<RobotId, LinkState>,
}

impl KeptRequests {
    /// Number of further requests that can be kept.
    pub fn room(&self) -> usize {
        MOST_REQUESTS.saturating_sub(self.kept.len())
    }

    /// Takes requests of clients; gives the tokens of the refused ones.
    pub fn take(&mut self, requests: Vec<(Token, Request)>, refusing: bool) -> Vec<Token> {
        let mut refused = Vec::new();
        for (token, request) in requests {
            // Requests by hand are neither refused nor overtaken: a release that was refused while the stop before it
            // waits would leave the floor standing.
            if refusing && !request.is_by_hand() {
                refused.push(token);
            } else {
                self.kept.push(Input::ask(token, request));
            }
        }
        refused
    }

    /// The inputs of a step: the kept ones, then these.
    pub fn with(&mut self, inputs: Vec<Input>) -> Vec<Input> {
        let links =
            std::mem::take(&mut self.links).into_iter().map(|(robot, state)| Input::Link(robot, state));
        links.chain(self.kept.drain(..)).chain(inputs).collect()
    }

    /// Keeps what a later step must not miss: stops and releases, in their order, and reports of links. Observations
    /// will be made again. Other requests come from inside the process and are refused: who made them asks again.
    /// Gives the tokens of the refused ones.
    pub fn keep(&mut self, inputs: Vec<Input>) -> Vec<Token> {
        let mut refused = Vec::new();
        for input in inputs {
            match input {
                Input::Link(robot, state) => _ = self.links.insert(robot, state),
                Input::Ask { ref request, .. } if request.is_by_hand() && self.room() > 0 => {
                    self.kept.push(input);
                }
                Input::Ask { token, .. } => refused.push(token),
                _ => {}
            }
        }
        refused
    }

    /// Drops everything; gives the tokens of the requests that come to nothing.
    pub fn give_up(&mut self) -> Vec<Token> {
        self.links.clear();
        self.kept.drain(..).filter_map(|input| token_of(&input)).collect()
    }
}

/// Requests and links' reports in a step: if the step panicked, none of them took effect.
pub struct Asked {
    /// Tokens of all requests except stops and releases.
    pub tokens: Vec<Token>,
    /// Stops and releases, and reports of links: the next step gets them again.
    pub again: Vec<Input>,
}

impl Asked {
    /// Collects them from the inputs of a step.
    pub fn of(inputs: &[Input]) -> Asked {
        let mut asked = Asked { tokens: Vec::new(), again: Vec::new() };
        for input in inputs {
            match input {
                Input::Link(..) => asked.again.push(input.clone()),
                Input::Ask { request, .. } if request.is_by_hand() => asked.again.push(input.clone()),
                _ => asked.tokens.extend(token_of(input)),
            }
        }
        asked
    }
}

/// The token of a request.
fn token_of(input: &Input) -> Option<Token> {
    match input {
        Input::Ask { token, .. } => Some(*token),
        Input::Telemetry(_)
        | Input::Link(..)
        | Input::Sighted(_)
        | Input::Hands(_)
        | Input::Arm(_)
        | Input::VisitEnds { .. } => None,
    }
}
