//! Radio between server and robots: it delays and loses.
//!
//! Main type: [`Link`]. Refuses: to repeat what was lost; the sender must.

use super::random::Stream;
use crate::time::{Span, Time};
use std::collections::VecDeque;

/// One direction of one robot's radio.
#[derive(Debug)]
pub(super) struct Link<T> {
    delay: Span,
    loss: f64,
    random: Stream,
    under_way: VecDeque<(Time, T)>,
}

impl<T> Link<T> {
    pub fn new(delay: Span, loss: f64, random: Stream) -> Link<T> {
        Link { delay, loss, random, under_way: VecDeque::new() }
    }

    /// Sends; what is lost never arrives.
    pub fn send(&mut self, now: Time, message: T) {
        if !self.random.happens(self.loss) {
            self.under_way.push_back((now + self.delay, message));
        }
    }

    /// The next message that has arrived by `now`.
    pub fn receive(&mut self, now: Time) -> Option<T> {
        self.under_way.pop_front_if(|(due, _)| *due <= now).map(|(_, m)| m)
    }
}
