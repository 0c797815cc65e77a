//! The process that runs the driver, and its journal, as far as they can fail.
//!
//! Main type: [`Host`]. Refuses: to go on after a panic that nobody planted.

use giveway_drive::{Drive, Heard, JournalReport, JournalState, PLANTED, Released, Sent};
use giveway_fleet::Input;
use giveway_floor::time::Time;

/// A process with a journal that takes everything at once.
pub struct Host {
    /// The driver.
    pub drive: Drive,
    /// How many steps with facts are durable.
    durable: u64,
}

impl Host {
    /// A process that has just begun.
    pub fn new(drive: Drive) -> Host {
        Host { drive, durable: 0 }
    }

    /// One turn, and what may leave after it.
    ///
    /// # Panics
    /// If the fleet does, and nobody planted that.
    pub fn turn(&mut self, now: Time, inputs: Vec<Input>) -> (Sent, Released) {
        let heard = Heard { journal: self.journal(), requests: Vec::new(), inputs };
        let sent = self.drive.turn(now, heard);
        if let Some(said) = self.drive.take_panic().filter(|said| !said.contains(PLANTED)) {
            panic!("{said}");
        }
        self.durable += u64::from(sent.written.is_some());
        let released = self.drive.release(self.journal());
        (sent, released)
    }

    fn journal(&self) -> JournalReport {
        JournalReport { durable: self.durable, state: JournalState::Writes }
    }
}
