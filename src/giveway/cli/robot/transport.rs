//! What happens to messages on their way to and from a virtual robot: they are lost, late, doubled or overtaken.
//!
//! Main types: [`MessageQueue`], [`TransportFaults`]. Refuses: faults of the robot itself.

use giveway_sim::random::Stream;

/// A message that is overtaken is late by up to this much, microseconds.
const OVERTAKEN_US: f64 = 1_000_000.0;

/// The faults that hold at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransportFaults {
    /// The share of messages that are lost.
    pub loss: f64,
    /// The share of messages that come twice.
    pub doubled: f64,
    /// The share of messages that later ones overtake.
    pub reordered: f64,
    /// The least and the most delay of a message, microseconds.
    pub delay_us: (f64, f64),
}

/// Messages on their way, each with its time of arrival in microseconds.
#[derive(Clone, Debug)]
pub struct MessageQueue<T> {
    chance: Stream,
    waiting: Vec<(i64, T)>,
    /// The last arrival: without a fault, no message overtakes another one.
    last_us: i64,
}

impl<T: Clone> MessageQueue<T> {
    /// A queue whose faults are drawn from a stream.
    pub fn new(chance: Stream) -> MessageQueue<T> {
        MessageQueue { chance, waiting: Vec::new(), last_us: i64::MIN }
    }

    /// A message sets out.
    pub fn put(&mut self, now_us: i64, message: T, faults: &TransportFaults) {
        if self.chance.happens(faults.loss) {
            return;
        }
        let copies = 1 + usize::from(self.chance.happens(faults.doubled));
        for _ in 0..copies {
            let (least, most) = faults.delay_us;
            let late_us = if most > 0.0 { self.chance.between(least, most) } else { 0.0 };
            let due_us = now_us.saturating_add(late_us as i64).max(self.last_us);
            let due_us = match self.chance.happens(faults.reordered) {
                true => due_us.saturating_add(self.chance.between(0.0, OVERTAKEN_US) as i64),
                false => {
                    self.last_us = due_us;
                    due_us
                }
            };
            self.waiting.push((due_us, message.clone()));
        }
    }

    /// The messages that have arrived, in the order of their arrival.
    pub fn take(&mut self, now_us: i64) -> Vec<T> {
        let (mut here, there): (Vec<_>, Vec<_>) = self.waiting.drain(..).partition(|(due, _)| *due <= now_us);
        self.waiting = there;
        here.sort_by_key(|(due, _)| *due);
        here.into_iter().map(|(_, message)| message).collect()
    }

    /// Forgets what is on its way.
    pub fn clear(&mut self) {
        self.waiting.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrive(faults: TransportFaults, seed: u64) -> Vec<(i64, usize)> {
        let mut queue = MessageQueue::new(Stream::new(seed, 1, 0));
        let mut arrived = Vec::new();
        for tick in 0..1000_i64 {
            if tick < 500 {
                queue.put(tick * 10_000, tick as usize, &faults);
            }
            arrived.extend(queue.take(tick * 10_000).into_iter().map(|message| (tick, message)));
        }
        arrived
    }

    #[test]
    fn without_a_fault_each_message_arrives_at_once_and_in_order() {
        let arrived = arrive(TransportFaults::default(), 1);
        assert!(arrived.iter().enumerate().all(|(i, (tick, message))| (i as i64, i) == (*tick, *message)));
        assert_eq!(arrived.len(), 500);
    }

    #[test]
    fn each_fault_does_what_it_says_and_the_seed_decides_to_which_messages() {
        let none = TransportFaults::default();
        let lost = arrive(TransportFaults { loss: 0.5, ..none }, 2).len();
        assert!((200..300).contains(&lost), "{lost}");
        let doubled = arrive(TransportFaults { doubled: 0.5, ..none }, 2).len();
        assert!((700..800).contains(&doubled), "{doubled}");
        let is_sorted = |all: &[(i64, usize)]| all.windows(2).all(|two| two[0].1 <= two[1].1);
        let late = arrive(TransportFaults { delay_us: (100_000.0, 300_000.0), ..none }, 2);
        assert!(is_sorted(&late) && late.iter().all(|(tick, message)| *tick >= *message as i64 + 10));
        assert_eq!(late.len(), 500);
        let reordered = TransportFaults { reordered: 0.2, ..none };
        assert!(!is_sorted(&arrive(reordered, 2)) && arrive(reordered, 2).len() == 500);
        assert_eq!(arrive(reordered, 2), arrive(reordered, 2));
        assert_ne!(arrive(reordered, 2), arrive(reordered, 3));
    }
}
