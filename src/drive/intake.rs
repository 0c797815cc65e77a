//! Requests on their way into a step, and requests that are kept while no step is made.
//!
//! Main types: [`KeptRequests`], [`Asked`]. Refuses: requests while the journal takes no facts; but stops and releases
//! by hand are kept in their order, whatever else waits, and so are reports of links.

use giveway_fleet::{Asker, Input, LinkState, Request, Token};
use giveway_floor::id::RobotId;
use std::collections::BTreeMap;

/// Number of clients' requests that are kept while no step is made. Further ones wait where they came in.
pub const MOST_REQUESTS: usize = 10_000;

/// Number of requests of simulated customers, robots and supervisors that are kept; further ones are dropped.
pub const MOST_SIMULATED: usize = 10_000;

/// Requests that no step has had yet.
#[derive(Debug, Default)]
pub struct KeptRequests {
    kept: Vec<Input>,
    /// Last report of each robot's link, which reports a state only once.
    links: BTreeMap<RobotId, LinkState>,
}

impl KeptRequests {
    /// Number of further requests of clients that can be kept.
    pub fn room(&self) -> usize {
        MOST_REQUESTS.saturating_sub(self.kept.iter().filter(|i| token_of_client(i).is_some()).count())
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

    /// Keeps inputs for a later step, in their order. Observations are not kept: they will be seen again. Simulated
    /// requests beyond a limit are not kept either: the simulation asks again. All requests of clients are kept.
    pub fn keep(&mut self, inputs: Vec<Input>) {
        let mut simulated = self.kept.iter().filter(|i| token_of_client(i).is_none()).count();
        let (before, mut dropped) = (simulated, 0);
        for input in inputs {
            if let Input::Link(robot, state) = input {
                self.links.insert(robot, state);
                continue;
            }
            let Input::Ask { request, .. } = &input else { continue };
            if token_of_client(&input).is_none() {
                // Simulated pickers repeat it until their screen shows that it was heard.
                if matches!(request, Request::Station(..)) {
                    continue;
                }
                if simulated >= MOST_SIMULATED {
                    dropped += 1;
                    continue;
                }
                simulated += 1;
            }
            self.kept.push(input);
        }
        if dropped > 0 && before < MOST_SIMULATED {
            tracing::warn!(dropped, "simulated requests are dropped: no step is made");
        }
    }

    /// Drops everything; gives the tokens of the clients' requests that come to nothing.
    pub fn give_up(&mut self) -> Vec<Token> {
        self.links.clear();
        self.kept.drain(..).filter_map(|input| token_of_client(&input)).collect()
    }
}

/// Clients' requests and links' reports in a step: if the step panicked, none of them took effect.
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
                Input::Ask { request, .. } if request.is_by_hand() && token_of_client(input).is_some() => {
                    asked.again.push(input.clone());
                }
                _ => asked.tokens.extend(token_of_client(input)),
            }
        }
        asked
    }
}

/// The token of a client's request.
fn token_of_client(input: &Input) -> Option<Token> {
    match input {
        Input::Ask { token, .. } => Some(*token).filter(|token| token.asker == Asker::CLIENTS),
        Input::Telemetry(_)
        | Input::Link(..)
        | Input::Sighted(_)
        | Input::Hands(_)
        | Input::Arm(_)
        | Input::VisitEnds { .. } => None,
    }
}
