//! The file of robots that `giveway serve --robots` adds to a floor: `{"giveway_robots": 1, …}`.
//!
//! Main types: [`RobotsFile`], [`RobotsFileError`], [`BrokerSettings`]. Everything that is wrong with a file is told at
//! once, each fault with its place. Refuses: unknown keys, names that the floor has already, two robots of one address,
//! and kinds that are too large for the floor's map.

use crate::Site;
use crate::check::{SiteError, check};
use crate::kinds::{KindFigures, limited_as_linked};
use crate::open_kind::{KindFigure, OpenKind};
use crate::vda5050::{
    LinkFigures, ListedRobot, ListedRobotFile, MqttLink, MqttLinkFile, RobotLinkSettings, interface_fault,
    read_robot,
};
use giveway_fleet::{RobotKind, fitted};
use giveway_floor::text::name_fault;
use giveway_floor::warehouse::Warehouse;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// The keys of the file.
const KEYS: [&str; 5] = ["giveway_robots", "interface", "map_id", "kinds", "robots"];

/// Robots of others and their kinds.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotsFile {
    /// The first level or levels of all topics, if the file names them.
    pub interface: Option<String>,
    /// The kinds of which the file says all figures, in the order of their names.
    pub kinds: Vec<RobotKind>,
    /// The other kinds.
    pub open: Vec<OpenKind>,
    /// What is set for the robots of each kind, by the kind's name.
    pub settings: BTreeMap<String, RobotLinkSettings>,
    /// The robots.
    pub robots: Vec<ListedRobot>,
}

/// Everything that is wrong with a file of robots: each fault with its place and its remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotsFileError(pub Vec<String>);

/// The broker that flags name, in place of the one in a site's file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BrokerSettings {
    /// The broker: `mqtt://HOST:PORT`, or `mqtts://HOST:PORT` with TLS.
    pub url: String,
    /// The file with the authority that signed the broker's certificate.
    pub ca: Option<String>,
    /// The file with our own certificate.
    pub cert: Option<String>,
    /// The file with its key.
    pub key: Option<String>,
    /// Our name at the broker.
    pub user: Option<String>,
}

impl fmt::Display for RobotsFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

impl std::error::Error for RobotsFileError {}

/// A kind in its file form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkedKindFile {
    #[serde(default)]
    fleet: KindFigures,
    #[serde(default)]
    link: LinkFigures,
}

/// A kind as far as the file says it.
enum KindInFile {
    Whole(Box<RobotKind>),
    Open(Box<OpenKind>),
}

/// A file while it is read.
struct RobotsReader<'f> {
    floor: Option<(&'f Site, &'f Arc<Warehouse>)>,
    map_id: Option<String>,
    file: RobotsFile,
    /// The settings of all kinds that robots may be of: those of the file, also of kinds with a fault, and the floor's.
    known: BTreeMap<String, RobotLinkSettings>,
    faults: Vec<String>,
}

impl RobotsFile {
    /// Reads a file. With a floor and its map, names and sizes are compared with those of the floor.
    ///
    /// # Errors
    /// Everything that is wrong.
    pub fn parse(text: &str, floor: Option<(&Site, &Arc<Warehouse>)>) -> Result<RobotsFile, RobotsFileError> {
        let fields = match serde_json::from_str(text) {
            Ok(Value::Object(fields)) => fields,
            Ok(_) => return Err(one_fault("the file must be an object: {\"giveway_robots\": 1, …}".into())),
            Err(e) => return Err(one_fault(SiteError::syntax(&e).to_string())),
        };
        let mqtt = floor.and_then(|(site, _)| site.links.mqtt.as_ref());
        let mut reader = RobotsReader {
            floor,
            map_id: None,
            file: RobotsFile {
                interface: None,
                kinds: Vec::new(),
                open: Vec::new(),
                settings: BTreeMap::new(),
                robots: Vec::new(),
            },
            known: mqtt.map(|mqtt| mqtt.kinds.clone()).unwrap_or_default(),
            faults: Vec::new(),
        };
        reader.read(fields);
        match reader.faults.is_empty() {
            true => Ok(reader.file),
            false => Err(RobotsFileError(reader.faults)),
        }
    }
}

impl RobotsReader<'_> {
    fn read(&mut self, mut fields: Map<String, Value>) {
        for key in fields.keys().filter(|key| !KEYS.contains(&key.as_str())) {
            self.faults.push(format!("`{key}` is no key of this file: it has {}", KEYS.join(", ")));
        }
        match fields.get("giveway_robots").and_then(Value::as_u64) {
            Some(1) => {}
            _ => self.faults.push("`giveway_robots` must be 1, the only version there is".to_owned()),
        }
        self.file.interface = self.take(&mut fields, "interface");
        let fault = self.file.interface.as_deref().and_then(interface_fault);
        self.faults.extend(fault.map(|fault| format!("`interface`: {fault}")));
        self.map_id = self.take(&mut fields, "map_id");
        let kinds: Map<String, Value> = self.take(&mut fields, "kinds").unwrap_or_default();
        for (name, value) in kinds {
            self.known.entry(name.clone()).or_default();
            match self.kind(&name, value) {
                Ok((kind, settings)) => {
                    self.known.insert(name.clone(), settings.clone());
                    self.file.settings.insert(name, settings);
                    match kind {
                        KindInFile::Whole(kind) => self.file.kinds.push(*kind),
                        KindInFile::Open(kind) => self.file.open.push(*kind),
                    }
                }
                Err(faults) => self.faults.extend(faults),
            }
        }
        let robots: Option<Vec<Value>> = self.take(&mut fields, "robots");
        if robots.is_none() && !fields.contains_key("robots") {
            self.faults.push("`robots` is missing: it lists the robots, [] if there are none yet".to_owned());
        }
        let mqtt = self.floor.and_then(|(site, _)| site.links.mqtt.as_ref());
        let mut all = mqtt.map(|mqtt| mqtt.robots.clone()).unwrap_or_default();
        let before = all.len();
        for (i, value) in robots.unwrap_or_default().into_iter().enumerate() {
            let robot = serde_json::from_value::<ListedRobotFile>(value).map_err(|e| e.to_string());
            match robot.and_then(|robot| read_robot(robot, &self.known, &all)) {
                Ok(robot) => all.push(robot),
                Err(why) => self.faults.push(format!("robots[{i}]: {why}")),
            }
        }
        self.file.robots = all.split_off(before);
    }

    /// The value of a key, if it is there and of the right form.
    fn take<T: DeserializeOwned>(&mut self, fields: &mut Map<String, Value>, key: &str) -> Option<T> {
        let value = fields.get(key)?.clone();
        match serde_json::from_value(value) {
            Ok(value) => Some(value),
            Err(e) => {
                self.faults.push(format!("`{key}`: {e}"));
                None
            }
        }
    }

    fn kind(&self, name: &str, value: Value) -> Result<(KindInFile, RobotLinkSettings), Vec<String>> {
        let mut faults = Vec::new();
        if let Some(fault) = name_fault(name, 50) {
            faults.push(format!("kinds: the name {name:?}: {fault}"));
        }
        if self.floor.is_some_and(|(site, _)| site.kinds.iter().any(|kind| kind.name == name)) {
            faults.push(format!("kinds: the floor has a kind {name:?} already: take another name"));
        }
        let LinkedKindFile { mut fleet, link } = match serde_json::from_value(value) {
            Ok(kind) => kind,
            Err(e) => {
                faults.push(format!("kinds.{name}: {e}"));
                return Err(faults);
            }
        };
        let link = link.read(&format!("kinds.{name}.link"), self.map_id.as_deref());
        limited_as_linked(&mut fleet, link.as_ref().unwrap_or(&RobotLinkSettings::default()));
        let is_open = KindFigure::ALL.iter().any(|figure| fleet.leaves_out(*figure));
        let open = OpenKind { name: name.to_owned(), figures: fleet };
        let kind = open.filled(None);
        if let (Ok(kind), Some((_, map))) = (&kind, self.floor)
            && let Err(findings) = fitted(map, std::slice::from_ref(kind))
        {
            faults.push(format!("kinds.{name}: the map is not for these robots:\n{findings}"));
        }
        match (kind, link) {
            (Ok(_), Ok(link)) if faults.is_empty() && is_open => Ok((KindInFile::Open(Box::new(open)), link)),
            (Ok(kind), Ok(link)) if faults.is_empty() => Ok((KindInFile::Whole(Box::new(kind)), link)),
            (kind, link) => {
                faults.extend(kind.err().into_iter().chain(link.err()).map(|e| e.to_string()));
                Err(faults)
            }
        }
    }
}

impl Site {
    /// Adds robots of others to the floor. A broker takes the place of the one in the site's file; what that file says
    /// of the interface, the versions and the robots stays.
    ///
    /// # Errors
    /// What is wrong with the broker, or that there is none; and if the robots would listen to other topics.
    pub fn add_robots(
        &mut self,
        broker: Option<BrokerSettings>,
        file: Option<RobotsFile>,
    ) -> Result<(), SiteError> {
        let named = broker.map(BrokerSettings::link).transpose()?;
        let before = self.links.mqtt.take();
        let mut link = match (named, before) {
            (Some(named), Some(before)) => {
                let MqttLink { url, ca, identity, user, .. } = named;
                MqttLink { url, ca, identity, user, ..before }
            }
            (Some(link), None) | (None, Some(link)) => link,
            (None, None) => {
                let message = "robots need a broker: name it with --mqtt mqtt://HOST:PORT".to_owned();
                return Err(SiteError::Wrong { key: "robots", message });
            }
        };
        if let Some(file) = file {
            if let Some(interface) = file.interface {
                if interface != link.interface && !link.robots.is_empty() {
                    let message = format!(
                        "{interface:?}, but the site's robots are at {:?}: give all robots one interface",
                        link.interface
                    );
                    return Err(SiteError::Wrong { key: "interface", message });
                }
                link.interface = interface;
            }
            link.kinds.extend(file.settings);
            link.open.extend(file.open);
            link.robots.extend(file.robots);
            self.kinds.extend(file.kinds);
        }
        let most = self.limits.robots;
        check("robots", link.robots.len() as f64, 0.0..=most as f64, "no more than `limits.robots`")?;
        self.links.mqtt = Some(link);
        Ok(())
    }
}

impl BrokerSettings {
    fn link(self) -> Result<MqttLink, SiteError> {
        let BrokerSettings { url, ca, cert, key, user } = self;
        MqttLinkFile::named(url, [ca, cert, key], user).read(BTreeMap::new(), Vec::new())
    }
}

fn one_fault(fault: String) -> RobotsFileError {
    RobotsFileError(vec![fault])
}

#[cfg(test)]
mod tests;
