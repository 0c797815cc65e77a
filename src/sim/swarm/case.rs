//! One case of the swarm: a seed, and what is cut down of what the seed draws.
//!
//! Main types: [`SwarmCase`], [`SwarmPart`], [`SwarmMap`]. A case is the flags of one command, so that a reader of
//! a failure can repeat it. Refuses: to draw anything.

use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// Parts of a case, each with its name on the command line, in the order in which shrinking tries to switch them off.
macro_rules! swarm_parts {
    ($($(#[$doc:meta])+ $part:ident = $word:literal,)+) => {
        /// A part of a case that can be switched off.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum SwarmPart {
            $($(#[$doc])+ $part,)+
        }

        impl SwarmPart {
            /// All parts.
            pub const ALL: &[SwarmPart] = &[$(SwarmPart::$part,)+];

            /// The part's name on the command line.
            pub fn word(self) -> &'static str {
                match self {
                    $(SwarmPart::$part => $word,)+
                }
            }
        }
    };
}

swarm_parts! {
    /// The Giveway process is killed at any point, and restarts.
    Restarts = "restart",
    /// A step, a view or a query panics at some robot.
    Panics = "panic",
    /// The journal writes nothing for a while.
    JournalRefuses = "journal_refuses",
    /// The journal is slow for a while.
    JournalSlow = "journal_slow",
    /// Steps that the journal did not confirm may be on the disk all the same.
    JournalTorn = "journal_torn",
    /// Clocks of robots are set.
    ClockSteps = "clock_steps",
    /// Links of robots are down, take no orders, or hold few visits.
    Links = "links",
    /// Robots are taken off the floor and brought back.
    Departures = "departures",
    /// People push robots elsewhere.
    Pushes = "pushes",
    /// People drive robots by hand.
    Manual = "manual",
    /// Areas are closed for a time.
    Closures = "closures",
    /// Clocks of robots are wrong.
    Skew = "skew",
    /// Some messages take long, and overtake others.
    Jitter = "jitter",
    /// All messages take long.
    Delay = "delay",
    /// Messages get lost.
    Loss = "loss",
    /// Robots break down.
    Failures = "failures",
    /// People press the emergency stops of robots.
    Estops = "estops",
    /// Things stand in the way of robots.
    Obstacles = "obstacles",
    /// Robots get no current.
    Unplugged = "unplugged",
    /// Chargers are out of order.
    Chargers = "chargers",
    /// Stations stop.
    Stations = "stations",
    /// Operators pause robots and stations.
    Holds = "holds",
    /// Customers cancel jobs.
    Cancels = "cancels",
    /// Picks take long, or goods are missing.
    Picks = "picks",
    /// Racks are wanted at several stations.
    Stops = "stops",
    /// Operators give jobs to other robots.
    Reassigned = "reassigned",
    /// Robots are sent to places where others rest, and to one another's places.
    Trades = "trades",
    /// Jobs have priorities, deadlines and predecessors, and are submitted twice.
    Wishes = "wishes",
    /// Customers want racks put back.
    Returns = "returns",
    /// Customers want racks put onto given nodes.
    Relocations = "relocations",
    /// Customers send robots to chargers.
    Charges = "charges",
    /// Customers send robots to parking places.
    Parks = "parks",
    /// Customers send robots to nodes.
    Goes = "goes",
    /// Devices of people are wrong, silent or late.
    Sensors = "sensors",
    /// People do something other than what they were told.
    Causes = "causes",
    /// Robots differ from the usual kind.
    Fleet = "fleet",
    /// Robots of some kind lack abilities that others have.
    Abilities = "abilities",
    /// People drive vehicles.
    Vehicles = "vehicles",
}

impl SwarmPart {
    /// The part with this name.
    pub fn of_word(word: &str) -> Option<SwarmPart> {
        SwarmPart::ALL.iter().copied().find(|part| part.word() == word)
    }
}

/// The map of a case.
#[derive(Clone, Debug)]
pub enum SwarmMap {
    /// The seed draws among the maps that ship and random ones.
    Any,
    /// A random map.
    Random,
    /// The map of a file, with the file's name as on the command line.
    Given(String, Arc<Warehouse>),
}

/// A case to run.
#[derive(Clone, Debug)]
pub struct SwarmCase {
    /// The seed that draws everything.
    pub seed: u64,
    /// How long faults last, minutes.
    pub minutes: u32,
    /// The map of the case.
    pub map: SwarmMap,
    /// Number of robots, fewer if the map has no room for them; drawn by the seed where absent.
    pub robots: Option<usize>,
    /// Number of workers; drawn by the seed where absent.
    pub workers: Option<usize>,
    /// Parts that are switched off.
    pub without: BTreeSet<SwarmPart>,
}

impl SwarmCase {
    /// The case with everything that a seed draws.
    pub fn whole(seed: u64, minutes: u32) -> SwarmCase {
        SwarmCase { seed, minutes, map: SwarmMap::Any, robots: None, workers: None, without: BTreeSet::new() }
    }

    /// Whether a part is switched on.
    pub(super) fn has(&self, part: SwarmPart) -> bool {
        !self.without.contains(&part)
    }
}

/// Reads what [`SwarmCase`] displays, except maps of files.
impl FromStr for SwarmCase {
    type Err = String;

    fn from_str(command: &str) -> Result<SwarmCase, String> {
        let words = command.strip_prefix("giveway swarm ").ok_or("it is no `giveway swarm`")?;
        let words: Vec<&str> = words.split_whitespace().collect();
        let mut case = SwarmCase::whole(0, 10);
        for pair in words.chunks(2) {
            let &[flag, value] = pair else { return Err(format!("{} has no value", pair[0])) };
            let number = || value.parse::<u64>().map_err(|e| format!("{flag} {value}: {e}"));
            match flag {
                "--seeds" => case.seed = number()?,
                "--minutes" => case.minutes = u32::try_from(number()?).map_err(|e| e.to_string())?,
                "--robots" => case.robots = Some(number()? as usize),
                "--workers" => case.workers = Some(number()? as usize),
                "--map" if value == "random" => case.map = SwarmMap::Random,
                "--without" => {
                    let part = |word| SwarmPart::of_word(word).ok_or(format!("there is no part {word}"));
                    case.without = value.split(',').map(part).collect::<Result<_, _>>()?;
                }
                _ => return Err(format!("{flag} {value} cannot be read here")),
            }
        }
        Ok(case)
    }
}

/// The command that runs the case.
impl fmt::Display for SwarmCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "giveway swarm --seeds {} --minutes {}", self.seed, self.minutes)?;
        match &self.map {
            SwarmMap::Any => {}
            SwarmMap::Random => write!(f, " --map random")?,
            SwarmMap::Given(path, _) => write!(f, " --map '{}'", path.replace('\'', r"'\''"))?,
        }
        if let Some(robots) = self.robots {
            write!(f, " --robots {robots}")?;
        }
        if let Some(workers) = self.workers {
            write!(f, " --workers {workers}")?;
        }
        let words: Vec<&str> = self.without.iter().map(|part| part.word()).collect();
        if words.is_empty() { Ok(()) } else { write!(f, " --without {}", words.join(",")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_one_command_with_all_that_was_cut_down() {
        let mut case = SwarmCase::whole(17, 10);
        assert_eq!(case.to_string(), "giveway swarm --seeds 17 --minutes 10");
        (case.minutes, case.robots, case.workers) = (7, Some(8), Some(0));
        case.without.extend([SwarmPart::Pushes, SwarmPart::Loss]);
        assert_eq!(
            case.to_string(),
            "giveway swarm --seeds 17 --minutes 7 --robots 8 --workers 0 --without pushes,loss"
        );
        assert_eq!(case.to_string().parse::<SwarmCase>().map(|c| c.to_string()), Ok(case.to_string()));
        case.map = SwarmMap::Given("my map.json".into(), Arc::new(giveway_floor::warehouse::lab()));
        assert!(case.to_string().contains(" --map 'my map.json' "), "{case}");
    }

    #[test]
    fn every_part_is_found_by_its_word() {
        for &part in SwarmPart::ALL {
            assert_eq!(SwarmPart::of_word(part.word()), Some(part));
        }
        assert_eq!(SwarmPart::of_word("weather"), None);
    }
}
