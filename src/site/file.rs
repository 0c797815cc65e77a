//! The site file: `{"giveway_site": 1, …}`.
//!
//! Main function: [`parse`]. Refuses: unknown keys, and numbers out of range.

use crate::check::{SiteError, check};
use crate::kinds::{KindFigures, NamedKind, read_links, read_site_kinds};
use crate::vda5050::{ListedRobot, ListedRobotFile, MqttLink, MqttLinkFile, RobotLinkSettings, read_robots};
use crate::{SimLink, Site, SiteLinks, words};
use giveway_cell::Flow;
use giveway_cell::arm::ArmMode;
use giveway_fleet::FloorLimits;
use giveway_floor::time::Span;
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_people::human::Method;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SiteFile {
    giveway_site: u32,
    name: String,
    map: String,
    #[serde(default)]
    fleet: Option<KindFigures>,
    #[serde(default)]
    kinds: Vec<NamedKind>,
    #[serde(default, deserialize_with = "words::policy")]
    policy: Option<HumanAwarePolicy>,
    #[serde(default, deserialize_with = "words::method")]
    method: Option<Method>,
    #[serde(default, deserialize_with = "words::node_windows")]
    node_windows: Option<NodeWindows>,
    #[serde(default)]
    worker_price: Option<f64>,
    #[serde(default)]
    period_ms: Option<i64>,
    #[serde(default, deserialize_with = "words::flow")]
    flow: Option<Flow>,
    #[serde(default, deserialize_with = "words::arm_mode")]
    arm_mode: Option<ArmMode>,
    #[serde(default)]
    limits: LimitsFile,
    #[serde(default)]
    links: LinksFile,
    #[serde(default)]
    robots: Vec<ListedRobotFile>,
    #[serde(default)]
    model: Option<String>,
}

/// Limits that differ from the defaults.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct LimitsFile {
    open_jobs: Option<usize>,
    open_assignments: Option<usize>,
    robots: Option<usize>,
    workers: Option<usize>,
    closures: Option<usize>,
    recurring_closures: Option<usize>,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct LinksFile {
    sim: Option<SimLinkFile>,
    mqtt: Option<MqttLinkFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SimLinkFile {
    robots: usize,
}

pub fn parse(text: &str) -> Result<Site, SiteError> {
    let mut file: SiteFile = serde_json::from_str(text).map_err(|e| SiteError::syntax(&e))?;
    check("giveway_site", f64::from(file.giveway_site), 1.0..=1.0, "1, the only version there is")?;
    let usual = Site::default();
    let period_ms = file.period_ms.unwrap_or(usual.period.0 / 1000);
    check("period_ms", period_ms as f64, 10.0..=1000.0, "from 10 to 1000")?;
    let worker_price = file.worker_price.unwrap_or(usual.worker_price);
    check("worker_price", worker_price, 0.0..=1000.0, "from 0 to 1000")?;
    let sim = file.links.sim.map(|sim| SimLink { robots: sim.robots });
    let robots = sim.map_or(0, |sim| sim.robots);
    check("links.sim.robots", robots as f64, 0.0..=10_000.0, "from 0 to 10000")?;
    let forms = read_links(&mut file.kinds)?;
    let robots = read_robots(file.robots, &forms)?;
    let (kinds, open) = read_site_kinds(file.fleet, file.kinds, &forms)?;
    let mqtt = read_mqtt(file.links.mqtt, forms, robots)?.map(|link| MqttLink { open, ..link });
    Ok(Site {
        name: file.name,
        map: file.map,
        kinds,
        policy: file.policy.unwrap_or(usual.policy),
        method: file.method.unwrap_or(usual.method),
        node_windows: file.node_windows.unwrap_or(usual.node_windows),
        worker_price,
        period: Span::from_millis(period_ms),
        flow: file.flow.unwrap_or(usual.flow),
        arm_mode: file.arm_mode.unwrap_or(usual.arm_mode),
        limits: file.limits.read()?,
        links: SiteLinks { sim, mqtt },
        model: file.model,
        ..usual
    })
}

/// The link to the broker, if there is one; without it no kind and no robot can be behind it.
fn read_mqtt(
    file: Option<MqttLinkFile>,
    forms: BTreeMap<String, RobotLinkSettings>,
    robots: Vec<ListedRobot>,
) -> Result<Option<MqttLink>, SiteError> {
    if let Some(file) = file {
        return file.read(forms, robots).map(Some);
    }
    if forms.is_empty() && robots.is_empty() {
        return Ok(None);
    }
    let message =
        "kinds with a `link`, and `robots`, need a broker: {\"mqtt\": {\"url\": \"mqtt://HOST:PORT\"}}";
    Err(SiteError::Wrong { key: "links", message: message.to_owned() })
}

impl LimitsFile {
    fn read(self) -> Result<FloorLimits, SiteError> {
        let usual = FloorLimits::default();
        let limit = |key: &str, wanted: Option<usize>, most: usize| {
            let found = wanted.unwrap_or(most);
            let told =
                "from 1 to the usual limit, which the floor's memory and the database are measured for";
            check(&format!("limits.{key}"), found as f64, 1.0..=most as f64, told).map(|()| found)
        };
        Ok(FloorLimits {
            open_jobs: limit("open_jobs", self.open_jobs, usual.open_jobs)?,
            open_assignments: limit("open_assignments", self.open_assignments, usual.open_assignments)?,
            robots: limit("robots", self.robots, usual.robots)?,
            workers: limit("workers", self.workers, usual.workers)?,
            closures: limit("closures", self.closures, usual.closures)?,
            recurring_closures: limit(
                "recurring_closures",
                self.recurring_closures,
                usual.recurring_closures,
            )?,
            ..usual
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(more: &str) -> Result<Site, String> {
        let text = format!(r#"{{"giveway_site": 1, "name": "hall 3", "map": "hall.json"{more}}}"#);
        parse(&text).map_err(|e| e.to_string())
    }

    #[test]
    fn a_site_that_names_only_its_map_is_as_the_core_is_unless_told_otherwise() {
        let site = with("").unwrap();
        let (found, usual) = (site.settings(), giveway_fleet::Settings::default());
        assert_eq!(
            (found.site_kinds, found.period, found.limits),
            (usual.site_kinds, usual.period, usual.limits)
        );
        assert_eq!((found.policy, found.method, found.flow), (usual.policy, usual.method, usual.flow));
        assert_eq!(site.links, SiteLinks::default(), "no robots but those that come");
    }

    #[test]
    fn every_key_says_what_it_says() {
        let site = with(
            r#", "kinds": [{"name": "a"}, {"name": "b", "fleet": {"speed_mps": 2}}], "policy": "giveway",
                "method": "chapter3", "node_windows": "mixture", "worker_price": 5, "period_ms": 50, "flow": "hand",
                "arm_mode": "turns", "limits": {"workers": 40}, "links": {"sim": {"robots": 3}}, "model": "m.json""#,
        )
        .unwrap();
        let settings = site.settings();
        assert_eq!(settings.site_kinds.iter().map(|k| k.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!((settings.method, settings.node_windows), (Method::Chapter3, NodeWindows::Mixture));
        assert_eq!((settings.worker_price, settings.period), (5.0, Span::from_millis(50)));
        assert_eq!((settings.flow, settings.arm_mode), (Flow::Hand, ArmMode::Turns));
        assert_eq!((settings.limits.workers, settings.limits.robots), (40, FloorLimits::default().robots));
        assert_eq!((site.links.sim, site.model.as_deref()), (Some(SimLink { robots: 3 }), Some("m.json")));
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_key_and_what_may_be_there() {
        let refused = |more: &str| with(more).unwrap_err();
        assert!(refused(r#", "customers": 4"#).contains("unknown field `customers`"));
        assert!(refused(r#", "robots": 4"#).contains("expected a sequence"));
        let word = refused(r#", "policy": "polite""#);
        assert!(word.contains("unknown word `polite`, expected one of `nhir`, `shir`"), "{word}");
        assert!(
            refused(r#", "limits": {"robots": 100000}"#)
                .starts_with("`limits.robots` is 100000, but must be")
        );
        assert!(refused(r#", "links": {"mqtt": {}}"#).contains("missing field `url`"));
        assert_eq!(refused(r#", "period_ms": 5"#), "`period_ms` is 5, but must be from 10 to 1000");
        let version = parse(r#"{"giveway_site": 2, "name": "", "map": ""}"#).unwrap_err().to_string();
        assert_eq!(version, "`giveway_site` is 2, but must be 1, the only version there is");
    }
}
