//! What the pages in `docs/` show is true: their examples are read, run and complete, and their links lead somewhere.

use giveway::sim::{Demand, Scenario, Simulation};
use giveway::site::Site;
use giveway::warehouse::{formats, room_for, to_svg};
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[path = "docs/growth.rs"]
mod growth;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn pages() -> Vec<PathBuf> {
    let docs = std::fs::read_dir(root().join("docs")).expect("docs/ is here").flatten().map(|e| e.path());
    let mut pages: Vec<_> = docs.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    pages.extend([root().join("README.md"), root().join("CHANGELOG.md")]);
    pages
}

#[test]
fn the_small_map_is_shown_whole_and_written_as_this_build_writes_it() {
    let file = read("docs/small.json");
    assert!(read("docs/maps.md").contains(&file), "docs/maps.md does not show docs/small.json as it is");
    let map = formats::json::parse(&file).expect("well-formed");
    assert_eq!(formats::json::write(&map), file);
    let made = "giveway map show docs/small.json --output docs/small.svg";
    assert!(read("docs/small.svg") == to_svg(&map), "docs/small.svg is old: {made}");
}

#[test]
fn the_small_scenario_is_shown_whole_and_delivers() {
    let file = read("docs/small-scenario.json");
    assert!(read("docs/scenarios.md").contains(&file), "docs/scenarios.md does not show the file as it is");
    let scenario = Scenario::parse(&file).expect("well-formed");
    let map = formats::json::parse(&read(Path::new("docs").join(&scenario.site.map))).expect("well-formed");
    room_for(&map, scenario.robots).expect("places to stay");
    let mut sim = Simulation::new(Arc::new(map), &scenario, &[], scenario.seed, false, || 0);
    while !sim.is_over() {
        sim.step();
    }
    let outcome = sim.outcome();
    assert_eq!(outcome.law_violations, 0, "{}", outcome.broken.join("; "));
    assert!(outcome.counts.robot_deliveries > 0);
}

#[test]
fn the_small_site_is_shown_whole_says_each_key_and_delivers_what_is_ordered() {
    let (file, page) = (read("docs/small-site.json"), read("docs/site.md"));
    assert!(page.contains(&file), "docs/site.md does not show the file as it is");
    let example: serde_json::Value = serde_json::from_str(&file).expect("JSON");
    let limits = example["limits"].as_object().expect("it has them");
    for key in example.as_object().expect("an object").keys().chain(limits.keys()) {
        assert!(page.contains(&format!("\n| `{key}` |")), "docs/site.md says nothing of `{key}`");
    }
    let site = Site::parse(&file).expect("well-formed");
    let map = formats::json::parse(&read(Path::new("docs").join(&site.map))).expect("well-formed");
    let map = site.fit(&Arc::new(map)).expect("the map is for these robots");
    let scenario = Scenario { demand: Demand::Backlog(2), ..Scenario::from(site) };
    let mut sim = Simulation::new(map, &scenario, &[], scenario.seed, false, || 0);
    (0..6_000).for_each(|_| _ = sim.step());
    let outcome = sim.outcome();
    assert_eq!(outcome.law_violations, 0, "{}", outcome.broken.join("; "));
    assert!(outcome.counts.robot_deliveries > 0);
}

/// A key that a scenario has instead of another one, so that the example cannot have both.
const OTHERWISE: &str = "kinds";

#[test]
fn every_key_of_maps_and_scenarios_has_its_words() {
    let schema: serde_json::Value = serde_json::from_str(&read("maps/map.schema.json")).expect("JSON");
    let maps = read("docs/maps.md");
    for key in schema["properties"].as_object().expect("an object").keys() {
        assert!(maps.contains(&format!("`{key}`")), "docs/maps.md says nothing of `{key}`");
    }
    let example: serde_json::Value = serde_json::from_str(&read("docs/small-scenario.json")).expect("JSON");
    let scenarios = read("docs/scenarios.md");
    let inner =
        |value: &serde_json::Value| value.as_object().into_iter().flat_map(|o| o.keys()).cloned().collect();
    for (key, value) in example.as_object().expect("an object") {
        let mut keys: Vec<String> = inner(value);
        keys.push(key.clone());
        for place in [
            "/workers/deviations",
            "/workers/sensor",
            "/workers/personas",
            "/workers/deviations/causes/rates",
        ] {
            keys.extend::<Vec<String>>(example.pointer(place).map(inner).expect("the example has it"));
        }
        for key in keys {
            let words = [
                format!("\n| `{key}` |"),
                format!("\n| `{{\"{key}\": "),
                format!("\n| `{key}`, `"),
                format!("`, `{key}` |"),
            ];
            assert!(words.iter().any(|w| scenarios.contains(w)), "docs/scenarios.md says nothing of `{key}`");
        }
    }
    assert!(
        scenarios.contains(&format!("| `{OTHERWISE}` |")),
        "docs/scenarios.md says nothing of `{OTHERWISE}`"
    );
    // A key that does not exist is refused with the list of all that do: the example has them all.
    let within = ["", "/deviations", "/deviations/causes/rates", "/sensor", "/personas"];
    let workers = within.map(|place| format!("/workers{place}"));
    let places = ["", "/fleet", "/faults"].into_iter().chain(workers.iter().map(String::as_str));
    for place in places {
        let mut broken = example.clone();
        let object = broken.pointer_mut(place).expect("the example has it");
        let known: Vec<String> = object.as_object().expect("an object").keys().cloned().collect();
        object["no-such-key"] = 1.into();
        let error = Scenario::parse(&broken.to_string()).expect_err("refused").to_string();
        let list = error.split("expected ").nth(1).unwrap_or_else(|| panic!("{error}"));
        for word in list.split('`').skip(1).step_by(2).filter(|word| *word != OTHERWISE) {
            assert!(known.iter().any(|k| k == word), "docs/small-scenario.json leaves out {place} {word}");
        }
    }
}

#[test]
fn links_between_pages_lead_somewhere() {
    for page in pages() {
        let text = std::fs::read_to_string(&page).expect("a page");
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        // Screenshots need a running server and a browser: `docs/picture.mjs` makes them.
        let links = links.filter(|l| !l.starts_with("http") && !l.starts_with('#') && !l.ends_with(".png"));
        for link in links {
            let file = link.split('#').next().expect("a path");
            let target = page.parent().expect("a folder").join(file);
            assert!(target.exists(), "{} links to {link}, which is not there", page.display());
        }
    }
}
