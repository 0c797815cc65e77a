//! Robots that speak VDA 5050: the link to their broker, what is set for their kinds, and which robots there are.
//!
//! Main types: [`MqttLink`], [`RobotLinkSettings`], [`ListedRobot`]. Refuses: unknown keys and words, two robots of one
//! name or address, and a password in a file.

use crate::check::{SiteError, check};
use crate::frame::MapFrame;
use crate::open_kind::OpenKind;
use giveway_floor::geometry::Vector;
use giveway_floor::text::name_fault;
use giveway_vda5050::{Address, BlockingType, Parameter, Version};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The name of the link to robots that speak VDA 5050.
pub const MQTT_LINK: &str = "mqtt";

/// The link to a broker and the robots behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct MqttLink {
    /// The broker: `mqtt://HOST:PORT`, or `mqtts://HOST:PORT` with TLS.
    pub url: String,
    /// The file with the authority that signed the broker's certificate; the system's authorities if absent.
    pub ca: Option<String>,
    /// The files with our own certificate and its key, if the broker wants one.
    pub identity: Option<[String; 2]>,
    /// The user's name at the broker. The password comes from the environment.
    pub user: Option<String>,
    /// The first level or levels of all topics.
    pub interface: String,
    /// The version of MQTT.
    pub mqtt: MqttVersion,
    /// The quality of service of orders and instant actions: 0 or 1.
    pub qos: u8,
    /// What is set for the robots of each kind, by the kind's name.
    pub kinds: BTreeMap<String, RobotLinkSettings>,
    /// The kinds that are known only once a robot of them is heard.
    pub open: Vec<OpenKind>,
    /// The robots.
    pub robots: Vec<ListedRobot>,
}

/// A version of MQTT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MqttVersion {
    /// 3.1.1: messages do not expire.
    V3,
    /// 5.
    V5,
}

/// A robot that is to drive on this floor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedRobot {
    /// Its name on the floor.
    pub name: String,
    /// Its manufacturer and serial number.
    pub address: Address,
    /// The name of its kind.
    pub kind: String,
    /// The version that is spoken with it; the one that it says if absent.
    pub version: Option<Version>,
}

/// What is set for the robots of a kind at their link.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLinkSettings {
    /// The robots' maps that are this floor, with their frames.
    pub maps: Vec<MapFrame>,
    /// How many nodes are announced beyond the base.
    pub horizon_nodes: usize,
    /// The longest base, metres: it bounds how far a robot drives on that hears no pause.
    pub longest_base_m: f64,
    /// How a rack is lifted.
    pub lift: ActionForm,
    /// How a rack is set down.
    pub set: ActionForm,
    /// Which key instant actions have.
    pub instant_key: InstantKey,
    /// How the allowed deviation from a node is spelt.
    pub deviation_key: SpeltDeviation,
    /// Whether an order may be sent again that the robot has not taken.
    pub repeat: RepeatRule,
    /// How far from a node an order may begin, metres.
    pub deviation_m: f64,
    /// Whether a robot that says that it does not know where it is is believed. Some say so always.
    pub needs_localized: bool,
    /// Whether the robots may leave the line of a lane within the corridor that the map gives to the lane.
    pub free_navigation: bool,
}

/// An action in the words of a kind of robot.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionForm {
    /// The action's type.
    pub kind: String,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// What may happen beside it.
    pub blocking: BlockingType,
}

/// The key under which a robot reads instant actions: the published 2.0 has another one than its later corrections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstantKey {
    /// `actions`, as all later texts have it.
    Actions,
    /// `instantActions`, as 2.0 was published.
    InstantActions,
    /// Both: each robot that was measured is content with it.
    Both,
}

/// How the allowed deviation from a node is spelt: the published 2.0 spells it otherwise than its later corrections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum SpeltDeviation {
    /// `allowedDeviationXY` and `allowedDeviationTheta`, as all later texts have it.
    #[serde(rename = "allowedDeviationXY")]
    Later,
    /// `allowedDeviationXy`, as 2.0 was published.
    #[serde(rename = "allowedDeviationXy")]
    Published,
}

/// Whether an order may be sent again that the robot has not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepeatRule {
    /// At most three times, each after a state that shows that the order was not taken.
    Safe,
    /// Never: the order counts as lost, and another one takes its place.
    Never,
}

impl Default for RobotLinkSettings {
    fn default() -> RobotLinkSettings {
        let form = |kind: &str| ActionForm {
            kind: kind.to_owned(),
            parameters: Vec::new(),
            blocking: BlockingType::Hard,
        };
        RobotLinkSettings {
            maps: Vec::new(),
            horizon_nodes: 0,
            longest_base_m: 4.0,
            lift: form("pick"),
            set: form("drop"),
            instant_key: InstantKey::Both,
            deviation_key: SpeltDeviation::Later,
            repeat: RepeatRule::Safe,
            deviation_m: 0.5,
            needs_localized: true,
            free_navigation: false,
        }
    }
}

/// The link in its file form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MqttLinkFile {
    url: String,
    ca: Option<String>,
    cert: Option<String>,
    key: Option<String>,
    user: Option<String>,
    #[serde(default = "usual_interface")]
    interface: String,
    #[serde(default = "newest")]
    version: u8,
    #[serde(default)]
    qos: u8,
    prefix: Option<String>,
}

/// The settings of a kind in their file form.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkFigures {
    maps: BTreeMap<String, MapFigures>,
    horizon_nodes: Option<usize>,
    longest_base_m: Option<f64>,
    deviation_m: Option<f64>,
    free_navigation: bool,
    actions: ActionsFile,
    quirks: QuirksFile,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFigures {
    #[serde(default)]
    dx: f64,
    #[serde(default)]
    dy: f64,
    #[serde(default)]
    turn: f64,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct ActionsFile {
    lift: Option<ActionFile>,
    set: Option<ActionFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ActionFile {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    parameters: serde_json::Map<String, Value>,
    #[serde(default)]
    blocking: BlockingWord,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum BlockingWord {
    None,
    Soft,
    Single,
    #[default]
    Hard,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct QuirksFile {
    instant_actions_key: Option<InstantKeyWord>,
    deviation_key: Option<SpeltDeviation>,
    repeat: Option<RepeatWord>,
    localized: Option<LocalizedWord>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LocalizedWord {
    Required,
    Ignored,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "camelCase")]
enum InstantKeyWord {
    Actions,
    InstantActions,
    Both,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RepeatWord {
    Safe,
    Never,
}

/// A robot in its file form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListedRobotFile {
    name: String,
    manufacturer: String,
    serial: String,
    kind: String,
    version: Option<String>,
}

fn usual_interface() -> String {
    "uagv".to_owned()
}

fn newest() -> u8 {
    5
}

/// What is wrong with the first levels of topics, if anything is.
pub(crate) fn interface_fault(interface: &str) -> Option<&'static str> {
    let is_wrong = interface.is_empty() || interface.contains(['+', '#', '$', ' ']);
    is_wrong.then_some("the first levels of a topic, which have no + # $ and blanks")
}

impl MqttLinkFile {
    /// A broker with the usual settings; `files` are those of its authority, of our certificate and of its key.
    pub(crate) fn named(
        url: String,
        [ca, cert, key]: [Option<String>; 3],
        user: Option<String>,
    ) -> MqttLinkFile {
        let (interface, version) = (usual_interface(), newest());
        MqttLinkFile { url, ca, cert, key, user, interface, version, qos: 0, prefix: None }
    }

    pub(crate) fn read(
        self,
        kinds: BTreeMap<String, RobotLinkSettings>,
        robots: Vec<ListedRobot>,
    ) -> Result<MqttLink, SiteError> {
        let wrong = |message: &str| SiteError::Wrong { key: "links.mqtt", message: message.to_owned() };
        let is_url = ["mqtt://", "mqtts://"].iter().any(|scheme| self.url.starts_with(scheme));
        if !is_url {
            return Err(wrong("`url` must be mqtt://HOST:PORT, or mqtts://HOST:PORT with TLS"));
        }
        if self.url.contains('@') {
            return Err(wrong("leave the password out of `url`: set GIVEWAY_MQTT_PASSWORD, and `user`"));
        }
        let identity = match (self.cert, self.key) {
            (Some(cert), Some(key)) => Some([cert, key]),
            (None, None) => None,
            _ => return Err(wrong("`cert` and `key` go together: give both or none")),
        };
        let mqtt = match self.version {
            5 => MqttVersion::V5,
            3 => MqttVersion::V3,
            _ => return Err(wrong("`version` must be 5, or 3 for MQTT 3.1.1")),
        };
        check("links.mqtt.qos", f64::from(self.qos), 0.0..=1.0, "0 or 1")?;
        let interface = match self.prefix {
            Some(prefix) => format!("{}/{}", prefix.trim_matches('/'), self.interface),
            None => self.interface,
        };
        if interface_fault(&interface).is_some() {
            return Err(wrong("`interface` and `prefix` are levels of a topic, without + # $ and blanks"));
        }
        let MqttLinkFile { url, ca, user, qos, .. } = self;
        let open = Vec::new();
        Ok(MqttLink { url, ca, identity, user, interface, mqtt, qos, kinds, open, robots })
    }
}

impl LinkFigures {
    /// The settings. `of` is their place in the file; `map_id` the robots' name of the floor's map, if the file has one
    /// for all kinds.
    pub(crate) fn read(mut self, of: &str, map_id: Option<&str>) -> Result<RobotLinkSettings, SiteError> {
        let usual = RobotLinkSettings::default();
        let horizon_nodes = self.horizon_nodes.unwrap_or(usual.horizon_nodes);
        let longest_base_m = self.longest_base_m.unwrap_or(usual.longest_base_m);
        let deviation_m = self.deviation_m.unwrap_or(usual.deviation_m);
        check(&format!("{of}.horizon_nodes"), horizon_nodes as f64, 0.0..=100.0, "from 0 to 100")?;
        check(&format!("{of}.longest_base_m"), longest_base_m, 0.1..=1000.0, "from 0.1 to 1000 metres")?;
        check(&format!("{of}.deviation_m"), deviation_m, 0.0..=5.0, "from 0 to 5 metres")?;
        if let Some(map_id) = map_id.filter(|_| self.maps.is_empty()) {
            self.maps.insert(map_id.to_owned(), MapFigures::default());
        }
        if self.maps.is_empty() {
            let message = format!("`{of}.maps` must name the robots' map, or maps: {{\"their id\": {{}}}}");
            return Err(SiteError::Wrong { key: "link", message });
        }
        let frame = |(name, map): (String, MapFigures)| MapFrame {
            name,
            moved: Vector::new(map.dx, map.dy),
            turn: map.turn,
        };
        let key = self.quirks.instant_actions_key.map(|word| match word {
            InstantKeyWord::Actions => InstantKey::Actions,
            InstantKeyWord::InstantActions => InstantKey::InstantActions,
            InstantKeyWord::Both => InstantKey::Both,
        });
        let repeat = self.quirks.repeat.map(|word| match word {
            RepeatWord::Safe => RepeatRule::Safe,
            RepeatWord::Never => RepeatRule::Never,
        });
        Ok(RobotLinkSettings {
            maps: self.maps.into_iter().map(frame).collect(),
            horizon_nodes,
            longest_base_m,
            lift: self.actions.lift.map_or(usual.lift, ActionFile::form),
            set: self.actions.set.map_or(usual.set, ActionFile::form),
            instant_key: key.unwrap_or(usual.instant_key),
            deviation_key: self.quirks.deviation_key.unwrap_or(usual.deviation_key),
            repeat: repeat.unwrap_or(usual.repeat),
            needs_localized: self.quirks.localized != Some(LocalizedWord::Ignored),
            free_navigation: self.free_navigation,
            deviation_m,
        })
    }
}

impl ActionFile {
    fn form(self) -> ActionForm {
        let parameters = self.parameters.into_iter().map(|(key, value)| Parameter { key, value }).collect();
        let blocking = match self.blocking {
            BlockingWord::None => BlockingType::None,
            BlockingWord::Soft => BlockingType::Soft,
            BlockingWord::Single => BlockingType::Single,
            BlockingWord::Hard => BlockingType::Hard,
        };
        ActionForm { kind: self.kind, parameters, blocking }
    }
}

/// The robots of a file, all of whose kinds have a link. Everything that is wrong is said at once.
pub(crate) fn read_robots(
    robots: Vec<ListedRobotFile>,
    kinds: &BTreeMap<String, RobotLinkSettings>,
) -> Result<Vec<ListedRobot>, SiteError> {
    let (mut read, mut wrong) = (Vec::<ListedRobot>::new(), Vec::new());
    for (i, robot) in robots.into_iter().enumerate() {
        match read_robot(robot, kinds, &read) {
            Ok(robot) => read.push(robot),
            Err(why) => wrong.push(format!("robots[{i}]: {why}")),
        }
    }
    match wrong.is_empty() {
        true => Ok(read),
        false => Err(SiteError::Wrong { key: "robots", message: wrong.join("; ") }),
    }
}

pub(crate) fn read_robot(
    robot: ListedRobotFile,
    kinds: &BTreeMap<String, RobotLinkSettings>,
    before: &[ListedRobot],
) -> Result<ListedRobot, String> {
    if let Some(fault) = name_fault(&robot.name, 50) {
        return Err(format!("the name {:?}: {fault}", robot.name));
    }
    let address = Address::new(&robot.manufacturer, &robot.serial).map_err(|e| e.to_string())?;
    if !kinds.contains_key(&robot.kind) {
        return Err(format!("kind {:?} is none of the kinds that have a `link`", robot.kind));
    }
    if before.iter().any(|b| b.name == robot.name) {
        return Err(format!("there are two robots named {:?}", robot.name));
    }
    if let Some(same) = before.iter().find(|b| b.address == address) {
        return Err(format!("{address} is {:?} already", same.name));
    }
    let version = match &robot.version {
        None => None,
        Some(text) => Some(
            Version::of_text(text)
                .ok_or_else(|| format!("version {text:?} is not spoken here: 2.0.0, 2.1.0 and 3.0.0 are"))?,
        ),
    };
    Ok(ListedRobot { name: robot.name, address, kind: robot.kind, version })
}

#[cfg(test)]
mod tests {
    use crate::Site;
    use giveway_vda5050::Version;

    const KINDS: &str = r#""kinds": [{"name": "coaty", "fleet": {"speed_mps": 1.5}, "link": {
        "maps": {"lab": {"dx": 2, "turn": 1.5}}, "horizon_nodes": 2, "longest_base_m": 3, "free_navigation": true,
        "actions": {"lift": {"type": "pick", "parameters": {"stationType": "floor"}, "blocking": "SOFT"}},
        "quirks": {"instant_actions_key": "instantActions", "repeat": "never"}}}]"#;
    const BROKER: &str = r#""links": {"mqtt": {"url": "mqtt://localhost:1883", "prefix": "hall-3/"}}"#;

    fn site(robots: &str) -> Result<Site, String> {
        with(&format!("{KINDS}, {BROKER}, \"robots\": [{robots}]"))
    }

    fn with(more: &str) -> Result<Site, String> {
        let text = format!(r#"{{"giveway_site": 1, "name": "hall 3", "map": "hall.json", {more}}}"#);
        Site::parse(&text).map_err(|e| e.to_string())
    }

    #[test]
    fn a_site_names_its_broker_and_its_robots_and_how_each_kind_is_spoken_to() {
        let robot =
            r#"{"name": "a1", "manufacturer": "coaty", "serial": "1", "kind": "coaty", "version": "2.0.0"}"#;
        let site = site(robot).expect("a site");
        let mqtt = site.links.mqtt.as_ref().expect("a link");
        assert_eq!(
            (mqtt.interface.as_str(), mqtt.qos, mqtt.mqtt),
            ("hall-3/uagv", 0, crate::MqttVersion::V5)
        );
        assert_eq!(mqtt.robots[0].address.to_string(), "coaty/1");
        assert_eq!(mqtt.robots[0].version, Some(Version::V2_0));
        let form = &mqtt.kinds["coaty"];
        assert_eq!(
            (form.horizon_nodes, form.longest_base_m, form.repeat),
            (2, 3.0, crate::RepeatRule::Never)
        );
        assert_eq!(form.lift.parameters[0].key, "stationType");
        let kind = mqtt.open[0].filled(None).expect("a kind");
        assert!(form.free_navigation && kind.free_navigation, "beside the line it is where it may be");
        let can = kind.capabilities;
        assert_eq!((can.revocation, can.drives_back, can.horizon_nodes), (true, false, 2));
        assert_eq!(can.limits, giveway_fleet::ObeyedLimits::Stops);
        assert_eq!(site.links.names(), ["mqtt"]);
    }

    #[test]
    fn a_kind_of_a_site_that_leaves_figures_out_is_known_once_a_robot_of_it_is_heard() {
        let kinds = |fleet: &str| {
            let site = with(&format!(
                r#""kinds": [{{"name": "tug", "fleet": {{{fleet}}}, "link": {{"maps": {{"m": {{}}}}}}}}], {BROKER}"#
            ))?;
            let link = site.links.mqtt.expect("a link");
            let names = |all: &mut dyn Iterator<Item = String>| all.collect::<Vec<_>>().join(",");
            let known = site.kinds.iter().map(|kind| kind.name.to_string());
            Ok::<_, String>((
                names(&mut { known }),
                names(&mut link.open.iter().map(|kind| kind.name.clone())),
            ))
        };
        let whole =
            r#""speed_mps": 1, "accel_unloaded_mps2": 1, "payload_kg": 500, "footprint": {"square_m": 0.8}"#;
        let turns = format!(r#"{whole}, "turn_radps": 1.5"#);
        let omni = format!(r#"{whole}, "drive": "omnidirectional""#);
        assert_eq!(kinds(r#""speed_mps": 1"#).expect("a site"), ("robot".into(), "tug".into()));
        assert_eq!(kinds(whole).expect("a site"), ("robot".into(), "tug".into()));
        for whole in [&turns, &omni] {
            assert_eq!(kinds(whole).expect("a site"), ("tug".into(), String::new()));
        }
        let wrong = kinds(&format!(r#"{omni}, "turn_radps": 1.5"#)).expect_err("it does not turn");
        assert!(wrong.contains("turn_radps"), "{wrong}");
        let wrong = kinds(r#""speed_mps": -1"#).expect_err("no robot drives so");
        assert!(wrong.contains("kinds[0].fleet.speed_mps"), "{wrong}");
    }

    #[test]
    fn everything_that_is_wrong_with_robots_is_said_at_once_with_its_place() {
        let robots = r#"{"name": "a", "manufacturer": "x", "serial": "1", "kind": "coaty"},
            {"name": "a", "manufacturer": "x", "serial": "2", "kind": "coaty"},
            {"name": "b", "manufacturer": "x", "serial": "1", "kind": "coaty"},
            {"name": "c", "manufacturer": "x/y", "serial": "1", "kind": "coaty"},
            {"name": "d", "manufacturer": "x", "serial": "4", "kind": "other"},
            {"name": "e", "manufacturer": "x", "serial": "5", "kind": "coaty", "version": "1.1"}"#;
        let said = site(robots).expect_err("five are wrong");
        for part in [
            "robots[1]: there are two robots named \"a\"",
            "robots[2]: x/1 is \"a\" already",
            "robots[3]: the manufacturer is \"x/y\"",
            "robots[4]: kind \"other\" is none of the kinds that have a `link`",
            "robots[5]: version \"1.1\" is not spoken here",
        ] {
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn a_broker_that_cannot_be_one_is_refused_with_what_to_write() {
        for (broker, part) in [
            (r#"{"url": "http://localhost"}"#, "mqtt://HOST:PORT"),
            (r#"{"url": "mqtt://me:secret@localhost"}"#, "GIVEWAY_MQTT_PASSWORD"),
            (r#"{"url": "mqtts://localhost", "cert": "a.pem"}"#, "`cert` and `key` go together"),
            (r#"{"url": "mqtt://localhost", "version": 4}"#, "`version` must be 5"),
            (r#"{"url": "mqtt://localhost", "qos": 2}"#, "0 or 1"),
            (r#"{"url": "mqtt://localhost", "interface": "a/#"}"#, "without + # $"),
            (r#"{"url": "mqtt://localhost", "retain": true}"#, "retain"),
        ] {
            let said = with(&format!("{KINDS}, \"links\": {{\"mqtt\": {broker}}}")).expect_err(broker);
            assert!(said.contains(part), "{broker}: {said}");
        }
        assert!(with(KINDS).expect_err("no broker").contains("need a broker"));
    }
}
