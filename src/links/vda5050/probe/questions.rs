//! What to ask a robot's vendor, in words, after a probe.
//!
//! Main function: [`ProbeFindings::questions`]. Refuses: to ask about what is as the standard wants it.

use super::findings::{ActionAnswer, DriveAnswer, FactsheetWorth, IdlePause, ProbeFindings, RepeatAnswer};
use giveway_vda5050::ConnectionState;

impl ProbeFindings {
    /// What to ask the vendor, most important first.
    pub fn questions(&self) -> Vec<String> {
        if !self.is_heard() {
            return self.of_silence();
        }
        let mut all = self.of_control();
        all.extend(self.of_truth());
        all.extend(self.of_words());
        all
    }

    fn of_silence(&self) -> Vec<String> {
        let mut all = vec![format!(
            "Nothing was heard of {}. Is it switched on, are its broker, interface, manufacturer and serial number set \
             to these?",
            self.address
        )];
        all.extend(self.of_versions());
        all
    }

    fn of_versions(&self) -> Option<String> {
        let version = self.other_version.as_ref().filter(|_| self.version.is_none())?;
        Some(format!("It says that it speaks {version:?}. Can it speak 2.0.0, 2.1.0 or 3.0.0?"))
    }

    /// Whether the robot can be stopped.
    fn of_control(&self) -> Vec<String> {
        let mut all = Vec::new();
        let mut ask = |text: &str| all.push(text.to_owned());
        if self.key.is_none() {
            ask("It answered no stateRequest. Which instant actions does it read, under which key?");
            return all;
        }
        match (self.pause_word(), self.idle_pause) {
            ("none", Some(IdlePause::Claimed)) => {
                ask("It says that startPause is FINISHED and that it is not paused. Does it pause?");
            }
            ("none", _) => ask("It does not pause. How can it be stopped for a person?"),
            ("late", _) => ask("It reads no message while it drives. Can it read while it drives?"),
            ("at nodes", _) => ask("It pauses at the next node only. Can it pause on the way?"),
            _ => {}
        }
        if self.stays_paused {
            ask("It says that it is still paused after stopPause. What lets it go on?");
        }
        match self.cancel {
            Some(DriveAnswer::Claims) => {
                ask("It says that cancelOrder is FINISHED, and drives on. Can it cancel?")
            }
            Some(DriveAnswer::None) => ask("It does not cancel an order. How is an order taken back?"),
            Some(DriveAnswer::Late) => {
                ask("It reads a cancel only at the end of its order. Can it read it before?")
            }
            Some(DriveAnswer::AtOnce | DriveAnswer::AtNodes) | None => {}
        }
        if self.drives == Some(false) {
            ask("It took no order to drive, or did not set off. What does it miss?");
        }
        if let Some(words) = &self.refused_order {
            all.push(format!("It refused an order to the place where it stands ({words}). Why?"));
        }
        all
    }

    /// Whether what the robot says is true.
    fn of_truth(&self) -> Vec<String> {
        let mut all = Vec::new();
        let mut ask = |text: &str| all.push(text.to_owned());
        match self.actions {
            Some(ActionAnswer::Claims) => {
                ask(
                    "It says FINISHED for an action that does not exist. How does one see that a load was picked?",
                );
            }
            Some(ActionAnswer::Silent) => {
                ask("It ends an order and says nothing of its action. Does it do actions at all?");
            }
            Some(ActionAnswer::Unfinished) => {
                ask("It neither refuses nor ends an action that does not exist. Why?")
            }
            Some(ActionAnswer::Refused) | None => {}
        }
        match self.repeat {
            Some(RepeatAnswer::Fatal) => {
                ask("It answers an order that comes twice with FATAL. Does it go on after it?")
            }
            Some(RepeatAnswer::Error) => {
                ask("It answers an order that comes twice with an error. Is it harmless?")
            }
            Some(RepeatAnswer::Safe) | None => {}
        }
        if !self.said.errors.is_empty() {
            all.push(format!("These errors still stand: {}. What clears them?", self.said.errors.join(", ")));
        }
        if !self.alive && self.key.is_some() {
            all.push("It answers no more. What has ended it?".to_owned());
        }
        all
    }

    /// Whether the robot says what others need.
    fn of_words(&self) -> Vec<String> {
        let mut all: Vec<String> = self.of_versions().into_iter().collect();
        let mut ask = |text: &str| all.push(text.to_owned());
        match self.sheet.as_ref().map(|(_, worth)| worth) {
            Some(FactsheetWorth::Valid) => {}
            Some(_) => ask("Its factsheet is not as the schema wants it. What are its speed, size and load?"),
            None => ask("It has no factsheet. What are its speed, size and load?"),
        }
        if self.said.states > 0 && self.said.map.is_none() {
            ask("It does not say where it is. How is it localised?");
        } else if self.said.states > 0 && !self.said.localized {
            ask("It says that it does not know where it is, with a position beside it. Which is true?");
        }
        if self.connection != Some(ConnectionState::Online) && self.said.states > 0 {
            ask(
                "It says states, and its retained connection is not ONLINE. Does it say ONLINE after a loss?",
            );
        }
        if self.is_too_near {
            ask("The place to drive to is nearer than 3 m: try again with one that is farther.");
        }
        for level in &self.unreadable {
            all.push(format!("Its messages under `{level}` cannot be read. What writes them?"));
        }
        all
    }
}
