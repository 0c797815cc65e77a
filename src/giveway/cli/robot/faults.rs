//! The file of faults of virtual robots: `{"giveway_faults": 1, "faults": [{"fault": "loss", "probability": 0.02}]}`.
//!
//! Main types: [`FaultsFile`], [`RobotFaults`] (those of one robot, drawn from the seed). Refuses: keys that a fault
//! has no use for, and quirks that no robot has; everything that is wrong is told at once.

use super::transport::TransportFaults;
use anyhow::ensure;
use giveway_sim::random::Stream;
use giveway_vda5050::RobotQuirks;
use serde::Deserialize;
use serde_json::Value;

/// The purpose of the stream that decides which robots have a fault.
const SHARES: u64 = 0x5a;

/// The faults of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultsFile {
    faults: Vec<RobotFault>,
}

/// A fault, of which robots, and when.
#[derive(Clone, Debug, PartialEq)]
struct RobotFault {
    what: FaultKind,
    /// Serial numbers; all robots if empty.
    robots: Vec<String>,
    /// The share of these robots that have the fault.
    share: f64,
    spells: FaultSpells,
}

/// When a fault holds, in microseconds since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FaultSpells {
    at_us: i64,
    /// How long it holds; for ever if absent.
    for_us: Option<i64>,
    /// The time from one beginning to the next; it comes once if absent.
    every_us: Option<i64>,
}

#[derive(Clone, Debug, PartialEq)]
enum FaultKind {
    Loss(f64),
    Doubled(f64),
    Reordered(f64),
    Delay(f64, f64),
    Quirk(String, Value),
    Reboot(Option<String>),
    Condition(RobotCondition),
}

/// A condition of a robot, or of the floor or network round it, that a fault brings about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RobotCondition {
    /// It neither says nor hears anything, though its line is up.
    Silent,
    /// Its line to the broker is broken.
    BrokerLost,
    /// Its emergency stop is pressed.
    EStop,
    /// A person drives it.
    Manual,
    /// It does not know where it is.
    NotLocalized,
    /// Something is in its protective field.
    FieldViolated,
    /// Its `pick` and `drop` fail.
    HandlingFails,
    /// Something is in its way on its line.
    Obstructed,
}

/// The faults of one robot.
#[derive(Clone, Debug, Default)]
pub struct RobotFaults {
    faults: Vec<RobotFault>,
}

const FAULTS: [&str; 14] = [
    "loss",
    "doubled",
    "reordered",
    "delay",
    "quirk",
    "reboot",
    "silence",
    "broker_lost",
    "e_stop",
    "manual",
    "not_localized",
    "field_violated",
    "handling_fails",
    "obstructed",
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileForm {
    giveway_faults: u32,
    faults: Vec<Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FaultForm {
    fault: String,
    #[serde(default)]
    robots: Vec<String>,
    share: Option<f64>,
    at_s: Option<f64>,
    for_s: Option<f64>,
    every_s: Option<f64>,
    probability: Option<f64>,
    least_ms: Option<f64>,
    most_ms: Option<f64>,
    node: Option<String>,
    quirk: Option<String>,
    value: Option<Value>,
}

impl FaultsFile {
    /// Reads a file; nodes of reboots must be among `nodes`.
    ///
    /// # Errors
    /// Everything that is wrong.
    pub fn parse(text: &str, is_node: impl Fn(&str) -> bool) -> anyhow::Result<FaultsFile> {
        let form: FileForm = serde_json::from_str(text)?;
        ensure!(form.giveway_faults == 1, "`giveway_faults` must be 1, the only version there is");
        let (mut faults, mut wrong) = (Vec::new(), Vec::new());
        for (i, value) in form.faults.into_iter().enumerate() {
            let read = serde_json::from_value::<FaultForm>(value).map_err(|e| e.to_string());
            match read.and_then(|form| form.read(&is_node)) {
                Ok(fault) => faults.push(fault),
                Err(why) => wrong.push(format!("faults[{i}]: {why}")),
            }
        }
        ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
        Ok(FaultsFile { faults })
    }

    /// The faults of robot number `i`: the seed decides which share of the robots has one.
    pub fn of_robot(&self, seed: u64, i: usize, serial: &str) -> RobotFaults {
        let mut chance = Stream::new(seed, SHARES, i as u64);
        let mut faults = Vec::new();
        for fault in &self.faults {
            // Each fault takes a number off the stream, so that one more disturbs none of the others.
            let is_drawn = chance.happens_of(fault.share);
            if is_drawn && (fault.robots.is_empty() || fault.robots.iter().any(|named| named == serial)) {
                faults.push(fault.clone());
            }
        }
        RobotFaults { faults }
    }

    /// Robots that faults name and that are not among these.
    pub fn unknown_robots<'f>(&'f self, serials: &'f [&str]) -> impl Iterator<Item = &'f str> {
        let named = self.faults.iter().flat_map(|fault| &fault.robots).map(String::as_str);
        named.filter(move |named| !serials.contains(named))
    }
}

impl RobotFaults {
    /// What happens to messages at a time.
    pub fn transport(&self, now_us: i64) -> TransportFaults {
        let mut all = TransportFaults::default();
        for fault in self.faults.iter().filter(|fault| fault.spells.holds(now_us)) {
            match fault.what {
                FaultKind::Loss(share) => all.loss = share,
                FaultKind::Doubled(share) => all.doubled = share,
                FaultKind::Reordered(share) => all.reordered = share,
                FaultKind::Delay(least_ms, most_ms) => all.delay_us = (least_ms * 1e3, most_ms * 1e3),
                FaultKind::Quirk(..) | FaultKind::Reboot(_) | FaultKind::Condition(_) => {}
            }
        }
        all
    }

    /// Whether a condition holds at a time.
    pub fn has(&self, condition: RobotCondition, now_us: i64) -> bool {
        let is_it = |fault: &&RobotFault| fault.what == FaultKind::Condition(condition);
        self.faults.iter().filter(is_it).any(|fault| fault.spells.holds(now_us))
    }

    /// The last reboot that is due after one time and until another: the node where the robot comes back, or nothing if
    /// it comes back where it stands.
    pub fn reboot(&self, after_us: i64, until_us: i64) -> Option<Option<&str>> {
        self.faults.iter().rev().find_map(|fault| match &fault.what {
            FaultKind::Reboot(node) if fault.spells.begins(after_us, until_us) => Some(node.as_deref()),
            _ => None,
        })
    }

    /// A robot's quirks with those that its faults add.
    pub fn quirks(&self, quirks: RobotQuirks) -> RobotQuirks {
        let named = self.faults.iter().filter_map(|fault| match &fault.what {
            FaultKind::Quirk(name, value) => Some((name.as_str(), value)),
            _ => None,
        });
        named.fold(quirks, |quirks, (name, value)| with_quirk(quirks, name, value).unwrap_or(quirks))
    }
}

impl FaultSpells {
    fn holds(&self, now_us: i64) -> bool {
        let since = now_us - self.at_us;
        let since = self.every_us.map_or(since, |every| if since < 0 { since } else { since % every });
        since >= 0 && self.for_us.is_none_or(|length| since < length)
    }

    /// Whether a spell begins after one time and until another.
    fn begins(&self, after_us: i64, until_us: i64) -> bool {
        match self.every_us {
            _ if until_us < self.at_us => false,
            None => after_us < self.at_us,
            Some(every) => {
                let last = until_us - (until_us - self.at_us) % every;
                after_us < last
            }
        }
    }
}

impl FaultForm {
    fn read(self, is_node: &impl Fn(&str) -> bool) -> Result<RobotFault, String> {
        self.check_keys()?;
        let share = in_range("share", self.share.unwrap_or(1.0), 0.0, 1.0)?;
        let spells = self.spells()?;
        let probability =
            || in_range("probability", self.probability.ok_or("`probability` is missing")?, 0.0, 1.0);
        let what = match self.fault.as_str() {
            "loss" => FaultKind::Loss(probability()?),
            "doubled" => FaultKind::Doubled(probability()?),
            "reordered" => FaultKind::Reordered(probability()?),
            "delay" => {
                let most = in_range("most_ms", self.most_ms.ok_or("`most_ms` is missing")?, 0.0, 60_000.0)?;
                FaultKind::Delay(in_range("least_ms", self.least_ms.unwrap_or(0.0), 0.0, most)?, most)
            }
            "quirk" => {
                let name = self.quirk.ok_or("`quirk` is missing: it names one of docs/robots.md")?;
                let value = self.value.ok_or("`value` is missing: what the quirk is")?;
                with_quirk(RobotQuirks::default(), &name, &value)?;
                FaultKind::Quirk(name, value)
            }
            "reboot" => match self.node {
                Some(node) if !is_node(&node) => return Err(format!("the map has no node {node:?}")),
                node => FaultKind::Reboot(node),
            },
            word => FaultKind::Condition(condition(word).ok_or_else(|| unknown(word))?),
        };
        Ok(RobotFault { what, robots: self.robots, share, spells })
    }

    /// Refuses keys that the fault has no use for.
    fn check_keys(&self) -> Result<(), String> {
        let own: &[&str] = match self.fault.as_str() {
            "loss" | "doubled" | "reordered" => &["probability"],
            "delay" => &["least_ms", "most_ms"],
            "quirk" => &["quirk", "value"],
            "reboot" => &["node"],
            word if condition(word).is_some() => &[],
            word => return Err(unknown(word)),
        };
        let given = [
            ("probability", self.probability.is_some()),
            ("least_ms", self.least_ms.is_some()),
            ("most_ms", self.most_ms.is_some()),
            ("node", self.node.is_some()),
            ("quirk", self.quirk.is_some()),
            ("value", self.value.is_some()),
        ];
        let other = given.iter().find(|(key, is_given)| *is_given && !own.contains(key));
        let times = self.at_s.or(self.for_s).or(self.every_s);
        match (other, self.fault.as_str()) {
            (Some((key, _)), word) => Err(format!("`{key}` means nothing for {word}: leave it out")),
            (None, "quirk") if times.is_some() => {
                Err("a quirk holds always: leave `at_s`, `for_s` and `every_s` out".to_owned())
            }
            _ => Ok(()),
        }
    }

    fn spells(&self) -> Result<FaultSpells, String> {
        let us = |seconds: f64| (seconds * 1e6) as i64;
        let at_us = us(in_range("at_s", self.at_s.unwrap_or(0.0), 0.0, 1e6)?);
        let for_us = self.for_s.map(|s| in_range("for_s", s, 0.1, 1e6).map(us)).transpose()?;
        let every_us = self.every_s.map(|s| in_range("every_s", s, 0.1, 1e6).map(us)).transpose()?;
        if self.fault == "reboot" && self.for_s.is_some() {
            return Err("`for_s` means nothing for reboot: leave it out".to_owned());
        }
        if every_us.is_some() && for_us.is_none() && self.fault != "reboot" {
            return Err("`every_s` needs `for_s`: how long the fault holds each time".to_owned());
        }
        Ok(FaultSpells { at_us, for_us, every_us })
    }
}

fn condition(word: &str) -> Option<RobotCondition> {
    Some(match word {
        "silence" => RobotCondition::Silent,
        "broker_lost" => RobotCondition::BrokerLost,
        "e_stop" => RobotCondition::EStop,
        "manual" => RobotCondition::Manual,
        "not_localized" => RobotCondition::NotLocalized,
        "field_violated" => RobotCondition::FieldViolated,
        "handling_fails" => RobotCondition::HandlingFails,
        "obstructed" => RobotCondition::Obstructed,
        _ => return None,
    })
}

fn unknown(word: &str) -> String {
    format!("{word:?} is no fault: there are {}", FAULTS.join(", "))
}

fn in_range(key: &str, found: f64, least: f64, most: f64) -> Result<f64, String> {
    let is_in = (least..=most).contains(&found);
    if is_in { Ok(found) } else { Err(format!("`{key}` is {found}, but must be from {least} to {most}")) }
}

/// Quirks with one of another value.
fn with_quirk(quirks: RobotQuirks, name: &str, value: &Value) -> Result<RobotQuirks, String> {
    let mut all = serde_json::to_value(quirks).map_err(|e| e.to_string())?;
    let fields = all.as_object_mut().ok_or("quirks are an object")?;
    if !fields.contains_key(name) {
        let names: Vec<&str> = fields.keys().map(String::as_str).collect();
        return Err(format!("{name:?} is no quirk: there are {}", names.join(", ")));
    }
    fields.insert(name.to_owned(), value.clone());
    serde_json::from_value(all).map_err(|e| format!("quirk {name}: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_vda5050::robot::{NodeStops, PauseHabit};

    fn file(faults: &str) -> anyhow::Result<FaultsFile> {
        let text = format!(r#"{{"giveway_faults": 1, "faults": [{faults}]}}"#);
        FaultsFile::parse(&text, |node| node == "P1")
    }

    #[test]
    fn a_fault_holds_at_its_times_and_for_the_robots_that_it_names() {
        let file = file(
            r#"{"fault": "loss", "probability": 0.1, "at_s": 10, "for_s": 5, "every_s": 20},
                {"fault": "silence", "robots": ["v-2"], "at_s": 3, "for_s": 1},
                {"fault": "reboot", "at_s": 7, "node": "P1"}"#,
        )
        .unwrap();
        let (one, two) = (file.of_robot(1, 0, "v-1"), file.of_robot(1, 1, "v-2"));
        let s = |seconds: f64| (seconds * 1e6) as i64;
        let losses = [0.0, 9.9, 10.0, 14.9, 15.0, 31.0].map(|at| one.transport(s(at)).loss);
        assert_eq!(losses, [0.0, 0.0, 0.1, 0.1, 0.0, 0.1]);
        let silent = |robot: &RobotFaults| robot.has(RobotCondition::Silent, s(3.5));
        assert_eq!((silent(&one), silent(&two)), (false, true));
        assert_eq!((one.reboot(s(6.9), s(7.0)), one.reboot(s(7.0), s(8.0))), (Some(Some("P1")), None));
        assert_eq!(file.unknown_robots(&["v-1"]).collect::<Vec<_>>(), ["v-2"]);
    }

    #[test]
    fn quirks_are_added_to_those_that_the_robot_has() {
        let file = file(
            r#"{"fault": "quirk", "quirk": "pause", "value": "fails_and_drives_on"},
                {"fault": "quirk", "quirk": "node_stops", "value": {"each_node": {"dwell_us": 5}}}"#,
        )
        .unwrap();
        let like_a = giveway_vda5050::RobotSetup::like_a().quirks;
        let quirks = file.of_robot(1, 0, "v-1").quirks(like_a);
        assert_eq!(quirks.pause, PauseHabit::FailsAndDrivesOn);
        assert_eq!(quirks.node_stops, NodeStops::EachNode { dwell_us: 5 });
        assert_eq!(quirks.charging_orders, like_a.charging_orders);
    }

    #[test]
    fn the_seed_decides_which_share_of_the_robots_has_a_fault() {
        let file = file(r#"{"fault": "manual", "share": 0.5}"#).unwrap();
        let have = |seed: u64| {
            let has = |i: usize| file.of_robot(seed, i, "x").has(RobotCondition::Manual, 0);
            (0..100).map(has).collect::<Vec<bool>>()
        };
        let some = have(1).into_iter().filter(|has| *has).count();
        assert!((30..70).contains(&some), "{some}");
        assert_eq!(have(1), have(1));
        assert_ne!(have(1), have(2));
    }

    #[test]
    fn everything_that_is_wrong_is_said_at_once_with_what_there_is() {
        let said = file(
            r#"{"fault": "lost"}, {"fault": "loss"}, {"fault": "loss", "probability": 2},
                {"fault": "quirk", "quirk": "paws", "value": 1}, {"fault": "quirk", "quirk": "pause", "value": "no"},
                {"fault": "reboot", "node": "P2"}, {"fault": "silence", "every_s": 4},
                {"fault": "manual", "probability": 1}, {"fault": "delay", "least_ms": 5, "most_ms": 3},
                {"fault": "manual", "colour": "red"},
                {"fault": "quirk", "quirk": "pause", "value": "at_once", "at_s": 1}"#,
        )
        .unwrap_err()
        .to_string();
        for part in [
            "faults[0]: \"lost\" is no fault: there are loss, doubled",
            "faults[1]: `probability` is missing",
            "faults[2]: `probability` is 2, but must be from 0 to 1",
            "faults[3]: \"paws\" is no quirk: there are base_request, ",
            "faults[4]: quirk pause: unknown variant `no`, expected one of `at_once`",
            "faults[5]: the map has no node \"P2\"",
            "faults[6]: `every_s` needs `for_s`",
            "faults[7]: `probability` means nothing for manual",
            "faults[8]: `least_ms` is 5, but must be from 0 to 3",
            "faults[9]: unknown field `colour`",
            "faults[10]: a quirk holds always",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }

    #[test]
    fn the_page_about_robots_names_each_fault_and_each_quirk() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/robots.md");
        let page = std::fs::read_to_string(page).unwrap();
        let quirks = serde_json::to_value(RobotQuirks::default()).unwrap();
        let quirks = quirks.as_object().unwrap().iter();
        for (quirk, usual) in quirks {
            let mut rows = page.lines().skip_while(|line| *line != "| quirk | values |");
            let row = rows.find(|line| line.starts_with(&format!("| `{quirk}` |")));
            let row = row.unwrap_or_else(|| panic!("docs/robots.md does not list the quirk {quirk}"));
            assert!(row.contains(&format!("| `{}`", usual.as_str().unwrap())), "{quirk}: {row}");
        }
        for fault in FAULTS {
            let is_named =
                page.lines().any(|line| line.starts_with('|') && line.contains(&format!("`{fault}`")));
            assert!(is_named, "docs/robots.md does not list {fault}");
        }
    }
}
