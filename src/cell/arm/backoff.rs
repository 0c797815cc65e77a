//! An arm that its own stop holds again and again lets the person go first.
//!
//! Main type: [`StopBackoff`]. A person does not reach past an arm that moves, and an arm that leaves and comes back
//! moves all the time: both would wait for ever. Refuses: to shorten what the arm's own stop asks for.

/// After so many stops of one stage it still goes on at once.
const AT_ONCE: u32 = 2;
/// Then it stands for so many cycles, twice as many after each further stop …
const FIRST: u32 = 10;
/// … up to `FIRST` shifted by this: 8 s.
const DOUBLINGS: u32 = 3;

/// How long an arm stands after its own stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct StopBackoff {
    is_held: bool,
    /// Stops since the stage began.
    stops: u32,
    /// For how many cycles it is to stand.
    waits: u32,
}

impl StopBackoff {
    /// Takes in whether the arm's own stop holds it.
    pub fn note(&mut self, is_held: bool) {
        if is_held && !self.is_held {
            self.stops += 1;
            if let Some(more) = self.stops.checked_sub(AT_ONCE + 1) {
                self.waits = FIRST << more.min(DOUBLINGS);
            }
        }
        self.is_held = is_held;
    }

    /// Whether it is to stand in this cycle, which nothing else holds.
    pub fn waits(&mut self) -> bool {
        let is_to_stand = self.waits > 0;
        self.waits = self.waits.saturating_sub(1);
        is_to_stand
    }

    /// The arm has got on.
    pub fn got_on(&mut self) {
        (self.stops, self.waits) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_stands_twice_as_long_after_each_further_stop_until_it_has_got_on() {
        let mut backoff = StopBackoff::default();
        let stand = |backoff: &mut StopBackoff| {
            (0..3).for_each(|_| backoff.note(true));
            backoff.note(false);
            (0..).take_while(|_| backoff.waits()).count()
        };
        let stood: Vec<usize> = (0..8).map(|_| stand(&mut backoff)).collect();
        assert_eq!(stood, [0, 0, 10, 20, 40, 80, 80, 80]);
        backoff.got_on();
        assert_eq!(stand(&mut backoff), 0);
    }
}
