//! Orders and answers that wait until the facts behind them are durable.
//!
//! Main type: [`Outbox`]. Refuses: to let anything overtake, and to grow while nothing new is decided.

use super::Released;
use giveway_fleet::{Command, Reply};
use giveway_floor::id::RobotId;
use std::collections::{BTreeSet, VecDeque};

/// The output of one step.
#[derive(Debug, Default)]
struct Parcel {
    after: u64,
    what: Released,
}

/// The waiting orders and answers.
#[derive(Debug, Default)]
pub struct Outbox {
    parcels: VecDeque<Parcel>,
}

impl Outbox {
    /// Adds orders and answers that may leave once `after` steps are durable.
    pub fn put(&mut self, after: u64, orders: Vec<(RobotId, Command)>, replies: Vec<Reply>) {
        match self.parcels.back_mut() {
            // No fact was recorded since: an order to the same robot replaces the waiting one.
            Some(last) if last.after == after => {
                last.what.orders.retain(|(robot, _)| !orders.iter().any(|(again, _)| again == robot));
                last.what.orders.extend(orders);
                last.what.replies.extend(replies);
            }
            _ if orders.is_empty() && replies.is_empty() => {}
            _ => self.parcels.push_back(Parcel { after, what: Released { orders, replies } }),
        }
    }

    /// Drops the orders to a robot that is no longer trusted.
    pub fn forget_orders(&mut self, robot: RobotId) {
        for parcel in &mut self.parcels {
            parcel.what.orders.retain(|(to, _)| *to != robot);
        }
    }

    /// Takes everything that may leave now that this many steps are durable. Of several orders to a robot only the
    /// newest leaves: it is complete, and the earlier ones describe a floor of perhaps many seconds ago.
    pub fn take(&mut self, durable: u64) -> Released {
        let ready = self.parcels.partition_point(|p| p.after <= durable);
        let mut all = Released::default();
        let mut newer = BTreeSet::new();
        for parcel in self.parcels.range_mut(..ready).rev() {
            parcel.what.orders.retain(|(robot, _)| !newer.contains(robot));
            newer.extend(parcel.what.orders.iter().map(|(robot, _)| *robot));
        }
        for parcel in self.parcels.drain(..ready) {
            all.orders.extend(parcel.what.orders);
            all.replies.extend(parcel.what.replies);
        }
        all
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
        assert_eq!(outbox.take(2).replies, vec![]);
        assert_eq!(outbox.take(3).replies, vec![reply(1), reply(2)]);
        assert_eq!(outbox.take(6).replies, vec![]);
        assert_eq!(outbox.take(9).replies, vec![reply(3)]);
    }

    #[test]
    fn of_orders_that_have_waited_the_newest_for_each_robot_leaves() {
        let mut outbox = Outbox::default();
        let order = |robot, limit| (RobotId(robot), Command::Limit(Some(limit)));
        outbox.put(1, vec![order(0, 1.0), order(1, 1.0)], vec![]);
        outbox.put(2, vec![order(0, 2.0)], vec![]);
        outbox.put(3, vec![order(1, 3.0)], vec![]);
        assert_eq!(outbox.take(2).orders, [order(1, 1.0), order(0, 2.0)]);
        assert_eq!(outbox.take(3).orders, [order(1, 3.0)]);
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
