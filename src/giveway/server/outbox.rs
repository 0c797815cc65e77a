//! Orders and answers that wait until the facts behind them are durable.
//!
//! Main type: [`Outbox`]. Refuses: to let anything overtake, and to grow while nothing new is decided.

use giveway_fleet::{Command, Reply};
use giveway_floor::id::RobotId;
use std::collections::VecDeque;

/// What one step wants to send.
#[derive(Debug, Default)]
struct Parcel {
    after: u64,
    commands: Vec<(RobotId, Command)>,
    replies: Vec<Reply>,
}

/// What waits.
#[derive(Debug, Default)]
pub struct Outbox {
    parcels: VecDeque<Parcel>,
}

impl Outbox {
    /// Takes what may leave once `after` steps are durable.
    pub fn put(&mut self, after: u64, commands: Vec<(RobotId, Command)>, replies: Vec<Reply>) {
        match self.parcels.back_mut() {
            // Nothing was decided since: an order to the same robot repeats the one that waits.
            Some(last) if last.after == after => {
                last.commands.retain(|(robot, _)| !commands.iter().any(|(again, _)| again == robot));
                last.commands.extend(commands);
                last.replies.extend(replies);
            }
            _ if commands.is_empty() && replies.is_empty() => {}
            _ => self.parcels.push_back(Parcel { after, commands, replies }),
        }
    }

    /// Drops the orders to a robot that is not trusted any more.
    pub fn forget_orders(&mut self, robot: RobotId) {
        for parcel in &mut self.parcels {
            parcel.commands.retain(|(to, _)| *to != robot);
        }
    }

    /// Everything that may leave now that so many steps are durable.
    pub fn take(&mut self, durable: u64) -> (Vec<(RobotId, Command)>, Vec<Reply>) {
        let ready = self.parcels.partition_point(|p| p.after <= durable);
        let (mut commands, mut replies) = (Vec::new(), Vec::new());
        for parcel in self.parcels.drain(..ready) {
            commands.extend(parcel.commands);
            replies.extend(parcel.replies);
        }
        (commands, replies)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::Answer;

    fn reply(token: u64) -> Reply {
        Reply { token: token.into(), answer: Ok(Answer::Done) }
    }

    #[test]
    fn nothing_leaves_before_its_facts_are_durable() {
        let mut outbox = Outbox::default();
        outbox.put(3, vec![], vec![reply(1)]);
        outbox.put(3, vec![], vec![reply(2)]);
        outbox.put(7, vec![], vec![reply(3)]);
        assert_eq!(outbox.take(2).1, vec![]);
        assert_eq!(outbox.take(3).1, vec![reply(1), reply(2)]);
        assert_eq!(outbox.take(6).1, vec![]);
        assert_eq!(outbox.take(9).1, vec![reply(3)]);
    }

    #[test]
    fn it_does_not_grow_while_nothing_is_decided() {
        let mut outbox = Outbox::default();
        for _ in 0..1000 {
            outbox.put(3, vec![], vec![]);
        }
        assert!(outbox.parcels.is_empty());
    }
}
