//! Requests on their way into a step, and those that are kept while there is none.
//!
//! Main types: [`KeptRequests`], [`Asked`]. Refuses: requests while the journal takes no facts; but stops and releases
//! by hand are kept in their order, whatever else waits, and so is what links say.

use giveway_fleet::{Asker, Input, LinkState, Request, Token};
use giveway_floor::id::RobotId;
use std::collections::BTreeMap;

/// How many requests of clients are kept while no step is made. Beyond, they wait where they came in.
pub const MOST_REQUESTS: usize = 10_000;

/// How many requests of simulated customers, robots and supervisors are kept; the others come to nothing.
pub const MOST_SIMULATED: usize = 10_000;

/// Requests that no step has had yet.
#[derive(Debug, Default)]
pub struct KeptRequests {
    kept: Vec<Input>,
    /// What the link of a robot said last: it says so once.
    links: BTreeMap<RobotId, LinkState>,
}

impl KeptRequests {
    /// How many requests of clients there is room for.
    pub fn room(&self) -> usize {
        MOST_REQUESTS.saturating_sub(self.kept.iter().filter(|i| token_of_client(i).is_some()).count())
    }

    /// Takes requests of clients in; gives those that are refused.
    pub fn take(&mut self, requests: Vec<(Token, Request)>, refusing: bool) -> Vec<Token> {
        let mut refused = Vec::new();
        for (token, request) in requests {
            // What is done by hand is neither refused nor overtaken: a release that was refused while the stop before
            // it waits would leave the floor standing.
            if refusing && !request.is_by_hand() {
                refused.push(token);
            } else {
                self.kept.push(Input::ask(token, request));
            }
        }
        refused
    }

    /// The inputs of a step: what was kept, then these.
    pub fn with(&mut self, inputs: Vec<Input>) -> Vec<Input> {
        let links =
            std::mem::take(&mut self.links).into_iter().map(|(robot, state)| Input::Link(robot, state));
        links.chain(self.kept.drain(..)).chain(inputs).collect()
    }

    /// Keeps inputs for a later step, in their order. Observations are not kept: they will be seen again. Nor are
    /// simulated requests beyond a limit: those who asked ask again. Requests of clients all are.
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
                // Simulated pickers say it until their screen shows that it was heard.
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

    /// Forgets everything; gives the requests of clients that come to nothing.
    pub fn give_up(&mut self) -> Vec<Token> {
        self.links.clear();
        self.kept.drain(..).filter_map(|input| token_of_client(&input)).collect()
    }
}

/// What clients asked and links said in a step: where it panicked, nothing of it happened.
pub struct Asked {
    /// Tokens of all requests but stops and releases.
    pub tokens: Vec<Token>,
    /// Stops and releases, and what links said: the next step gets them again.
    pub again: Vec<Input>,
}

impl Asked {
    /// Looks through the inputs of a step.
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
