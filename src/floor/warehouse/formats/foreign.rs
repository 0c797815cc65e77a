//! Layouts of other systems, which cannot be read yet: they are named, so that users need not search them for mistakes.
//!
//! Main function: [`foreign_layout`]. Refuses: to read any part of them.

use serde_json::Value;

/// The format of a layout of another system, if the text is one.
pub(super) fn foreign_layout(text: &str) -> Option<&'static str> {
    let text = text.trim_start();
    match text.chars().next()? {
        '{' => of_json(&serde_json::from_str(text).ok()?),
        '<' => of_xml(text),
        _ if text.starts_with("ISO-10303-21") => Some("an IFC model"),
        _ => of_yaml(text),
    }
}

fn of_json(value: &Value) -> Option<&'static str> {
    const GEOMETRIES: [&str; 9] = [
        "FeatureCollection",
        "Feature",
        "GeometryCollection",
        "Point",
        "MultiPoint",
        "LineString",
        "MultiLineString",
        "Polygon",
        "MultiPolygon",
    ];
    let has = |key: &str| value.get(key).is_some();
    let is_geometry = value["type"].as_str().is_some_and(|kind| GEOMETRIES.contains(&kind));
    if has("metaInformation") || has("layouts") {
        Some("a LIF layout (VDMA)")
    } else if is_geometry && (has("features") || has("geometry") || has("geometries") || has("coordinates")) {
        Some("a GeoJSON graph")
    } else {
        None
    }
}

fn of_xml(text: &str) -> Option<&'static str> {
    // Declarations and comments come before the first element.
    let elements = text.split('<').map(str::trim_start).filter(|e| !e.is_empty());
    let first = elements.into_iter().find(|e| !e.starts_with(['?', '!']) && !e.starts_with("--"))?;
    let has = |part: &str| text.contains(part);
    let is_model = first.starts_with("model") && (has("opentcs") || has("<point") || has("<path"));
    is_model.then_some("an openTCS plant model")
}

fn of_yaml(text: &str) -> Option<&'static str> {
    let keys: Vec<&str> = text
        .lines()
        .filter(|line| !line.starts_with([' ', '\t', '#', '-']))
        .filter_map(|line| Some(line.split_once(':')?.0.trim()))
        .collect();
    let has = |key: &str| keys.contains(&key);
    if has("levels") && has("building_name") {
        Some("an Open-RMF navigation graph")
    } else if has("levels") {
        Some("an Open-RMF building")
    } else if has("image") && has("resolution") && has("origin") {
        Some("a ROS occupancy map")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Options, import};

    #[test]
    fn layouts_of_other_systems_are_named() {
        let lif =
            r#"{"metaInformation": {"projectIdentification": "hall", "lifVersion": "1.0.0"}, "layouts": []}"#;
        let geo = r#"{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"id": 0},
            "geometry": {"type": "Point", "coordinates": [0, 1]}}]}"#;
        let tcs = "\u{feff}<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a hall -->\n<model version=\"6.0.0\" \
                   name=\"Demo\" xmlns=\"http://opentcs.org/schema/plantmodel/v6.0.0\"><point name=\"1\"/></model>";
        let building =
            "coordinate_system: reference_image\nlevels:\n  L1:\n    vertices:\n      - [1, 2, 0, \"\"]\n";
        let graph = "building_name: hall\nlevels:\n  L1:\n    lanes:\n      - [0, 1, {}]\n";
        let ros = "image: hall.pgm\r\nresolution: 0.05\r\norigin: [0.0, 0.0, 0.0]\r\nnegate: 0\r\n";
        for (text, name) in [
            (lif, "a LIF layout (VDMA)"),
            (geo, "a GeoJSON graph"),
            (tcs, "an openTCS plant model"),
            (building, "an Open-RMF building"),
            (graph, "an Open-RMF navigation graph"),
            (ros, "a ROS occupancy map"),
            ("ISO-10303-21;\nHEADER;\n", "an IFC model"),
        ] {
            let error = import(text, &Options::default()).expect_err(name).to_string();
            assert!(error.contains(&format!("this is {name}, which cannot be read yet")), "{error}");
            assert!(!error.contains("expected one of"), "{error}");
        }
    }

    #[test]
    fn a_map_with_a_misspelt_key_is_no_layout_of_another_system() {
        let text = r#"{"giveway_map": 1, "name": "x", "footprint_m": 0.9, "nodes": [], "lane": []}"#;
        let error = import(text, &Options::default()).expect_err("no lanes").to_string();
        assert!(error.contains("unknown field `lane`"), "{error}");
        for text in ["<xml/>", "a: 1\n", "{\"type\": \"x\"}", "<svg><path/></svg>"] {
            let error = import(text, &Options::default()).expect_err(text).to_string();
            assert!(!error.contains("cannot be read yet"), "{error}");
        }
    }
}
