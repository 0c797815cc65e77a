//! What robots are reached by: links by name, and the state of each robot at its link.
//!
//! Main types: [`LinkState`], [`LinkReach`]. What goes through a link is data: orders out, reports in, and this state.
//! Refuses: to know how anything travels.

use crate::state::kind::ObeyedLimits;
use giveway_floor::text::Sentence;

/// The name of the link to simulated robots, and to all robots from before links had names.
pub const USUAL_LINK: &str = "sim";

/// Whether messages get through to a robot, as far as its link knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkReach {
    /// The link does not know: a robot that sends no reports is silent.
    #[default]
    ByReports,
    /// The robot answers when it is asked, however rarely it reports by itself.
    Answers,
    /// They do not: the robot is silent at once. It keeps its places, and other robots get its job if it has not
    /// lifted the rack.
    Lost,
    /// The robot has said that it is being switched off; else as if it were lost.
    Off,
    /// They reach no robot of the link. All drive on to where they were granted and keep their jobs.
    LineDown,
}

impl LinkReach {
    /// All values.
    pub const ALL: [LinkReach; 5] =
        [LinkReach::ByReports, LinkReach::Answers, LinkReach::Lost, LinkReach::Off, LinkReach::LineDown];

    /// The word in files and answers.
    pub fn word(self) -> &'static str {
        match self {
            LinkReach::ByReports => "by_reports",
            LinkReach::Answers => "answers",
            LinkReach::Lost => "lost",
            LinkReach::Off => "off",
            LinkReach::LineDown => "line_down",
        }
    }

    /// The value that a word names.
    pub fn of_word(word: &str) -> Option<LinkReach> {
        Self::ALL.into_iter().find(|reach| reach.word() == word)
    }

    /// Whether messages may get through.
    pub fn is_up(self) -> bool {
        matches!(self, LinkReach::ByReports | LinkReach::Answers)
    }
}

/// The state of a robot at its link, as far as the link knows. Unless a link says otherwise, its robots are judged by
/// their reports, hold any number of visits and take orders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkState {
    /// Whether messages get through.
    pub reach: LinkReach,
    /// How many visits the robot can be told beyond the last one that it reached; nothing for any number.
    pub capacity: Option<usize>,
    /// Why the robot takes no orders; nothing if it takes them. It obeys speed limits all the same, and drives on to
    /// where it was granted.
    pub refuses: Option<Sentence>,
    /// The most that the robot was seen to obey of speed limits. What its kind obeys counts if that is less.
    pub limits: ObeyedLimits,
    /// The serial number of a stop at which the robot could not do what it was to do: it stands there until a person
    /// has looked after it. A rack that it did not lift is left to other robots.
    pub failed_stop: Option<u64>,
}

impl Default for LinkState {
    fn default() -> LinkState {
        LinkState {
            reach: LinkReach::ByReports,
            capacity: None,
            refuses: None,
            limits: ObeyedLimits::Speeds,
            failed_stop: None,
        }
    }
}
