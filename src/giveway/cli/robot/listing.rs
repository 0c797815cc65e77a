//! The file of robots for `giveway serve --robots` that fits the virtual robots of a process.
//!
//! Main function: [`robots_file`]. Refuses: figures that the robots do not have.

use giveway_vda5050::robot::{
    EqualUpdate, HandlingParameters, LocalizedFlag, OrderActionHabit, PauseHabit, RobotAbilities,
};
use giveway_vda5050::{Address, RobotSetup};
use serde_json::{Map, Value, json};

/// The file: one kind, and all robots of it. `map` is the robots' name of the floor's map.
pub fn robots_file(kind: &str, interface: &str, robots: &[(Address, RobotSetup)]) -> Value {
    let Some((_, setup)) = robots.first() else { return Value::Null };
    let mut maps = Map::new();
    for (_, setup) in robots {
        maps.insert(setup.position.map.clone(), json!({}));
    }
    let one = (maps.len() == 1).then(|| setup.position.map.clone());
    let mut link = link_of(setup);
    if one.is_none() {
        link.insert("maps".to_owned(), Value::Object(maps));
    }
    let listed = robots.iter().map(|(address, setup)| {
        json!({
            "name": address.serial(),
            "manufacturer": address.manufacturer(),
            "serial": address.serial(),
            "kind": kind,
            "version": setup.version.text(),
        })
    });
    let mut file = json!({
        "giveway_robots": 1,
        "interface": interface,
        "kinds": {kind: {"fleet": fleet_of(setup), "link": link}},
        "robots": listed.collect::<Vec<_>>(),
    });
    if let (Some(fields), Some(map)) = (file.as_object_mut(), one) {
        fields.insert("map_id".to_owned(), Value::String(map));
    }
    file
}

/// The figures of the robots' kind.
fn fleet_of(setup: &RobotSetup) -> Value {
    let RobotAbilities { handling_prepare_us, lift_us, .. } = setup.abilities;
    // A file of robots takes accelerations up to 5 m/s².
    let accel_mps2 = setup.body.accel_mps2.min(setup.body.brake_mps2).min(5.0);
    json!({
        "speed_mps": setup.body.speed_mps,
        "accel_unloaded_mps2": accel_mps2,
        "accel_loaded_mps2": accel_mps2,
        "turn_radps": setup.body.turn_radps,
        "lift_s": (handling_prepare_us + lift_us) as f64 * 1e-6,
    })
}

/// How the robots are spoken to, where it is not as usual.
fn link_of(setup: &RobotSetup) -> Map<String, Value> {
    let quirks = setup.quirks;
    let (mut link, mut special) = (Map::new(), Map::new());
    if quirks.handling_parameters == HandlingParameters::FloorAndEpal {
        let parameters = json!({"stationType": "floor", "loadType": "EPAL"});
        let form = |kind: &str| json!({"type": kind, "parameters": parameters.clone()});
        link.insert("actions".to_owned(), json!({"lift": form("pick"), "set": form("drop")}));
    }
    if quirks.equal_update == EqualUpdate::Error {
        special.insert("repeat".to_owned(), json!("never"));
    }
    if quirks.localized_flag == LocalizedFlag::AlwaysFalse {
        special.insert("localized".to_owned(), json!("ignored"));
    }
    if !special.is_empty() {
        link.insert("quirks".to_owned(), Value::Object(special));
    }
    link
}

/// What of a kind of robots a fleet manager cannot work with, in words.
pub fn cannot(setup: &RobotSetup) -> Vec<&'static str> {
    let quirks = setup.quirks;
    let pause = (quirks.pause == PauseHabit::FailsAndDrivesOn)
        .then_some("they do not pause: Giveway gives them no orders");
    let actions =
        matches!(quirks.order_actions, OrderActionHabit::SkippedInSilence | OrderActionHabit::ClaimedNotDone)
            .then_some("they lift nothing, whatever they say: their jobs go to others");
    pause.into_iter().chain(actions).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_site::{RepeatRule, RobotsFile};
    use giveway_vda5050::Version;

    fn listed(kind: &str, setup: RobotSetup, maps: &[&str]) -> RobotsFile {
        let robot = |(i, map): (usize, &&str)| {
            let mut setup = setup.clone();
            setup.position.map = (*map).to_owned();
            (Address::new("maker", &format!("v-{i}")).unwrap(), setup)
        };
        let robots: Vec<_> = maps.iter().enumerate().map(robot).collect();
        RobotsFile::parse(&robots_file(kind, "uagv", &robots).to_string(), None).expect("a file of robots")
    }

    #[test]
    fn what_is_written_is_read_by_the_server_for_each_preset() {
        let standard = RobotSetup::new(Version::V3_0, "maker", "v", "lab", "n0");
        let file = listed("virtual", standard, &["lab", "lab"]);
        assert_eq!((file.robots.len(), file.robots[1].version), (2, Some(Version::V3_0)));
        assert_eq!(file.settings["virtual"].maps.len(), 1);
        let a = listed("like-a", RobotSetup::like_a(), &["lab", "hall"]);
        assert_eq!(a.settings["like-a"].lift.parameters.len(), 2);
        assert_eq!(a.settings["like-a"].maps.len(), 2);
        assert_eq!(listed("like-b", RobotSetup::like_b(), &["lab"]).robots[0].version, Some(Version::V2_1));
        let c = listed("like-c", RobotSetup::like_c(), &["lab"]);
        assert_eq!(c.settings["like-c"].repeat, RepeatRule::Never);
        assert!(!c.settings["like-c"].needs_localized);
        assert_eq!(cannot(&RobotSetup::like_c()).len(), 2);
        assert!(cannot(&RobotSetup::like_b()).is_empty());
    }
}
