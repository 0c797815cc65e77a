//! Messages that were overtaken: an older state must not undo a newer one.
//!
//! Main type: [`MessageOrder`]. A message is older if its number and its sender's time both say so: a robot that begins
//! anew counts from the beginning, at a later time. Refuses: to drop many in a row, since a clock may be set back.

/// After this many dropped messages in a row the next one is taken.
const MOST_DROPPED: u32 = 5;

/// The last message of a topic.
#[derive(Clone, Debug, Default)]
pub(super) struct MessageOrder {
    last: Option<(u32, String)>,
    dropped: u32,
}

impl MessageOrder {
    /// Whether a message with this number and time is to be taken.
    pub fn takes(&mut self, id: u32, timestamp: &str) -> bool {
        let is_older =
            self.last.as_ref().is_some_and(|(last, before)| id <= *last && timestamp <= before.as_str());
        if is_older && self.dropped < MOST_DROPPED {
            self.dropped += 1;
            return false;
        }
        (self.last, self.dropped) = (Some((id, timestamp.to_owned())), 0);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_overtaken_or_doubled_message_is_dropped_and_a_robot_that_began_anew_is_heard() {
        let mut order = MessageOrder::default();
        assert!(order.takes(7, "2026-11-30T12:00:07.00Z"));
        assert!(!order.takes(6, "2026-11-30T12:00:06.00Z") && !order.takes(7, "2026-11-30T12:00:07.00Z"));
        assert!(order.takes(0, "2026-11-30T12:00:09.00Z"), "it began anew");
        assert!(order.takes(1, "2026-11-30T12:00:10.00Z"));
        // Its clock was set back.
        let taken: Vec<bool> =
            (0..7).map(|i| order.takes(0, &format!("2026-11-29T12:00:0{i}.00Z"))).collect();
        assert_eq!(taken.iter().filter(|taken| **taken).count(), 2, "{taken:?}");
    }
}
