//! Input that is well-formed and means nothing, or something else: refused with the reason, or taken for what it means,
//! and never half of it. What each request may look like is in `description.rs`; here it is what it says.

use crate::carry;
use crate::helper::{Answer, Folder, eventually, get, map, send, start};
use crate::people::post;
use giveway::geometry::Vector;
use giveway::warehouse::{Warehouse, formats::json};
use serde_json::{Value, json};
use std::process::{Command, Output};

/// What is wrong with the first field of a refused request.
fn detail(answer: &Answer) -> String {
    answer.problem(422)["errors"][0]["detail"].as_str().unwrap().to_owned()
}

/// Runs the program on a file of this text, named last.
fn giveway(folder: &Folder, arguments: &[&str], file: &str, text: &str) -> Output {
    let path = folder.path().join(file);
    std::fs::write(&path, text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_giveway"))
        .args(arguments)
        .arg(path)
        .current_dir(folder.path())
        .output()
        .unwrap()
}

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closure_says_what_it_covers_and_one_that_covers_something_else_is_refused() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let floor = map();
    let (low, high) = floor.bounds();
    let whole = json!([[low.x, low.y], [high.x, low.y], [high.x, high.y], [low.x, high.y]]);
    let close = |body: Value| async move { post(at, "/v1/closures", &body).await };
    let made = close(json!({"outline": whole, "reason": "oil"})).await;
    let covered = made.json()["covered"].clone();
    let size = high - low;
    assert_eq!((made.status, covered["nodes"].as_u64()), (201, Some(floor.nodes.len() as u64)), "{made:?}");
    assert_eq!(covered["stations"].as_array().unwrap().len(), floor.stations.len());
    let storage = floor.nodes_where(|kind| kind == giveway::warehouse::NodeKind::Storage).len();
    assert_eq!(covered["storage"].as_u64(), Some(storage as u64));
    assert!((covered["area_m2"].as_f64().unwrap() - size.x * size.y).abs() < 0.01, "{covered}");
    assert_eq!(made.json()["nodes"].as_array().unwrap().len(), floor.nodes.len(), "the list says the same");
    // The view is as old as the latest step.
    let path = format!("/v1/closures/{}", made.json()["id"].as_str().unwrap());
    let is_there = async || Some(get(at, &path).await).filter(|answer| answer.status == 200);
    let again = eventually("the closure is in the view", is_there).await;
    assert_eq!(again.json()["covered"], covered);
    let named = close(json!({"nodes": ["R30", "R32"], "reason": "posts"})).await.json();
    assert_eq!((&named["covered"]["nodes"], &named["covered"]["area_m2"]), (&json!(2), &Value::Null));
    // Far ahead, so that no hour of today is one of its hours.
    let mopping = json!({"outline": whole, "reason": "mopping", "from": "2031-01-01T00:00:00Z",
        "recurs": {"from": "22:00", "to": "22:30"}});
    let daily = close(mopping).await.json();
    assert_eq!((&daily["covered"], daily["id"].as_str()), (&covered, Some("s1")));

    let (x, y) = (low.x, low.y);
    for (outline, says) in [
        (json!([[x, y], [x + 4.0, y + 4.0], [x + 4.0, y], [x, y + 3.0]]), "crosses itself"),
        (json!([[x, y], [x + 4.0, y], [x + 2.0, y]]), "no area"),
        (json!([[x, y], [x, y], [x, y]]), "enclose no area"),
        (json!([[x, y], [x + 0.05, y], [x, y + 0.05]]), "at least 0.01"),
        (json!([[2000, 4000], [8000, 4000], [8000, 9000], [2000, 9000]]), "millimetres"),
        (json!([[0, 0], [8000, 0], [8000, 9000], [0, 9000]]), "millimetres"),
        (json!([[x - 9.0, y - 9.0], [x - 8.0, y - 9.0], [x - 8.0, y - 8.0]]), "covers nothing"),
    ] {
        for binds in ["both", "people", "robots"] {
            let refused = close(json!({"outline": outline, "reason": "oil", "binds": binds})).await;
            assert!(detail(&refused).contains(says), "{outline}: {}", detail(&refused));
        }
        let recurs = json!({"from": "22:00", "to": "22:30"});
        let refused = close(json!({"outline": outline, "reason": "oil", "recurs": recurs})).await;
        assert!(detail(&refused).contains(says), "{outline} again and again");
    }
    let listed = get(at, "/v1/closures").await.json()["items"].as_array().unwrap().len();
    assert!(listed <= 3, "what was refused closes nothing");
    server.stop().await.unwrap();
}

/// The lab, as far from the map's zero as national grids are.
fn far() -> Warehouse {
    carry::changed(|draft| {
        let off = Vector::new(10_330.6, -41_831.2);
        draft.nodes.iter_mut().for_each(|n| n.at += off);
        draft.marks.iter_mut().for_each(|m| m.at += off);
        draft.walkable.iter_mut().chain(&mut draft.obstacles).flatten().for_each(|p| *p += off);
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn where_a_map_may_be_people_and_closures_may_be() {
    let folder = Folder::new();
    let server = carry::start(&folder, far()).await.unwrap();
    let at = server.address();
    let node = far().nodes.iter().find(|n| n.name == "R32").unwrap().at;
    let worker = post(at, "/v1/workers", &json!({"name": "Ada"})).await.json();
    let path = format!("/v1/workers/{}/position", worker["id"].as_str().unwrap());
    let seen = post(at, &path, &json!({"x": node.x, "y": node.y})).await;
    assert!((200..300).contains(&seen.status), "{seen:?}");
    let near = json!([[node.x - 1.0, node.y - 1.0], [node.x + 1.0, node.y - 1.0], [node.x, node.y + 1.0]]);
    let made = post(at, "/v1/closures", &json!({"outline": near, "reason": "oil"})).await;
    assert_eq!(made.status, 201, "{made:?}");
    let strips = format!("/v1/timelines?x0={}&y0={}&x1={}&y1={}", node.x, node.y, node.x + 1.0, node.y + 1.0);
    assert_eq!(get(at, &strips).await.status, 200);
    let is_seen = async || {
        let known = get(at, "/v1/workers").await.json()["items"][0].clone();
        known["x"].as_f64().filter(|x| (x - node.x).abs() < 1.0)
    };
    eventually("the worker is seen there", is_seen).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_never_of_business_systems_is_no_end_and_no_beginning() {
    const NEVER: &str = "9999-12-31T23:59:59Z";
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let closed = post(at, "/v1/closures", &json!({"nodes": ["R30"], "reason": "oil", "until": NEVER})).await;
    assert_eq!((closed.status, &closed.json()["until"]), (201, &Value::Null), "{closed:?}");
    let recurs = json!({"from": "22:00", "to": "22:30"});
    let daily = json!({"nodes": ["R30"], "reason": "oil", "until": NEVER, "recurs": recurs});
    assert_eq!(post(at, "/v1/closures", &daily).await.json()["until"], Value::Null);
    let mut job = crate::helper::delivery(0);
    job["deadline"] = json!(NEVER);
    let made = post(at, "/v1/jobs", &job).await;
    assert_eq!((made.status, &made.json()["deadline"]), (201, &Value::Null), "{made:?}");
    // One that waits for another one can be changed.
    job["after"] = json!([made.json()["id"]]);
    let made = post(at, "/v1/jobs", &job).await;
    let path = format!("/v1/jobs/{}", made.json()["id"].as_str().unwrap());
    let change = |deadline: &str| {
        let body = json!({"deadline": deadline}).to_string();
        let path = path.clone();
        async move { send(at, "PATCH", &path, &[("content-type", "application/json")], &body).await.unwrap() }
    };
    let changed = change("9000-01-01T00:00:00Z").await;
    assert_eq!(changed.json()["deadline"], "9000-01-01T00:00:00Z", "{changed:?}");
    assert_eq!(change(NEVER).await.json()["deadline"], Value::Null, "never is none");
    let batch = json!({"jobs": [{"key": "k", "job": job}]});
    assert_eq!(post(at, "/v1/jobs:batch", &batch).await.json()["accepted"], 1);
    for list in ["jobs", "closures", "alarms", "encounters", "audit", "assignments"] {
        let listed = get(at, &format!("/v1/{list}?to={NEVER}")).await;
        assert_eq!(listed.status, 200, "{list}: {listed:?}");
        let refused = detail(&get(at, &format!("/v1/{list}?from={NEVER}")).await);
        assert!(refused.contains("later than 9999-12-30T22:00:00Z, the latest time"), "{list}: {refused}");
    }
    let later = post(at, "/v1/closures", &json!({"nodes": ["R30"], "reason": "oil", "from": NEVER})).await;
    assert!(detail(&later).contains("the latest time"), "{later:?}");
    let position = json!({"x": 1, "y": 1, "at": NEVER});
    post(at, "/v1/workers", &json!({"name": "Ada"})).await;
    assert!(detail(&post(at, "/v1/workers/w1/position", &position).await).contains("the latest time"));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn names_that_differ_only_in_what_nobody_sees_are_refused_wherever_a_name_is_given() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let node = map().nodes.iter().next().unwrap().name.clone();
    for odd in ["Ada\u{200b}", "A\u{a0}da", "Ada\u{301}", "Ad\u{430}", "A\tda", "Ada  L"] {
        detail(&post(at, "/v1/workers", &json!({"name": odd})).await);
        detail(&post(at, "/v1/robots", &json!({"name": odd, "node": node, "kind": "usual"})).await);
        let refused = post(at, "/v1/tokens", &json!({"name": odd, "role": "viewer"})).await;
        assert!(refused.status >= 400, "{refused:?}");
    }
    let rack = map().racks.iter().next().unwrap().name.clone();
    let station = map().stations.iter().next().unwrap().name.clone();
    for (odd, says) in
        [(format!("{rack} "), "begins or ends with a blank"), (format!("{rack}\u{200b}"), "U+200B")]
    {
        let job = json!({"kind": "deliver", "rack": odd, "station": station});
        let refused = detail(&post(at, "/v1/jobs", &job).await);
        assert!(refused.contains(says), "{refused}");
        let named = post(at, "/v1/closures", &json!({"nodes": [odd], "reason": "x"})).await;
        assert!(detail(&named).contains(says), "{named:?}");
    }
    server.stop().await.unwrap();

    let text = json::write(&map());
    let plain = format!("\"id\":\"{rack}\"");
    let two = |odd: &str| text.replacen(&plain, &format!("\"id\":\"{odd}\""), 1);
    for (odd, shown) in
        [("K1 ", "K1 "), ("K1\u{200b}", "K1\\u{200b}"), ("K\u{a0}1", "K\u{a0}1"), ("\u{41a}a1", "\u{41a}a1")]
    {
        let checked = giveway(&folder, &["map", "check"], "odd.json", &two(odd));
        let said = text_of(&checked.stderr);
        assert_eq!(checked.status.code(), Some(1), "{odd:?}: {said}");
        assert!(said.contains("can be taken for another one") && said.contains(shown), "{odd:?}: {said}");
    }
}

/// The lab for two robots and an order file of this text.
fn orders(folder: &Folder, text: &str) -> Output {
    std::fs::write(folder.path().join("lab.json"), json::write(&map())).unwrap();
    std::fs::write(folder.path().join("orders.csv"), text).unwrap();
    let scenario = json!({"giveway_scenario": 1, "name": "orders", "map": "lab.json", "robots": 2, "period_ms": 100,
        "duration_s": 60, "jobs": {"file": {"path": "orders.csv", "backlog": 2}}});
    giveway(folder, &["sim", "--no-bound", "--json"], "scenario.json", &scenario.to_string())
}

#[test]
fn an_order_file_gives_the_same_run_however_it_was_saved_and_one_without_orders_is_refused() {
    let folder = Folder::new();
    let plain = "OrderNumber,SKU\n1001,A7\n1002,B2\n";
    let hash = |text: &str| {
        let ran = orders(&folder, text);
        assert!(ran.status.success(), "{text:?}: {ran:?}");
        serde_json::from_slice::<Value>(&ran.stdout).unwrap()["trace_hash"].clone()
    };
    let wanted = hash(plain);
    let excel = format!("\u{feff}{}", plain.replace(',', ";").replace('\n', "\r\n"));
    for text in [excel, plain.replace('\n', "\r"), plain.replace(',', "\t")] {
        assert_eq!(hash(&text), wanted, "{text:?}");
    }
    for (text, says) in [
        ("", "the file is empty"),
        ("OrderNumber,SKU\n", "there is no line below the header"),
        ("OrderNumber,SKU\r", "there is no line below the header"),
        ("OrderNumber,SKU,SKU\n1,2,3\n", "two columns `SKU`"),
        ("OrderNumber,SKU\n1,\"2\n", "line 2: a quoted cell begins here"),
    ] {
        let ran = orders(&folder, text);
        assert_eq!((ran.status.code(), ran.stdout.len()), (Some(1), 0), "{text:?}: {ran:?}");
        assert!(text_of(&ran.stderr).contains(says), "{text:?}: {ran:?}");
    }
}

#[test]
fn a_grid_or_a_layout_that_cannot_be_read_whole_is_not_read_by_half() {
    let folder = Folder::new();
    let grid = "type octile\nheight 3\nwidth 9\nmap\n.........\n.........\n.........\n@@@@@@@@.\n.........\n.........\n";
    let out = folder.path().join("m.json");
    let import = ["map", "import", "--output", out.to_str().unwrap()];
    for (text, says) in [
        (grid, "6 rows, the header says 3"),
        (
            r#"{"metaInformation": {}, "layouts": []}"#,
            "this is a LIF layout (VDMA), which cannot be read yet",
        ),
    ] {
        let ran = giveway(&folder, &import, "cut.map", text);
        assert_eq!(ran.status.code(), Some(1), "{ran:?}");
        assert!(text_of(&ran.stderr).contains(says), "{ran:?}");
        assert!(!out.exists(), "nothing is written");
    }
    let ring = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n";
    let ran = giveway(&folder, &import, "ring.map", ring);
    assert!(ran.status.success() && text_of(&ran.stderr).contains("1 of 10 free cells"), "{ran:?}");
}

#[test]
fn no_command_panics_where_nobody_reads_standard_error_and_the_work_is_done() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("ring.map"), "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n").unwrap();
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json");
    let shell = |command: &str, closed: &str| {
        // The reader has left before the program begins.
        let script = format!("(sleep 0.3; exec $GIVEWAY {command}) {closed} | true; echo ${{PIPESTATUS[0]}}");
        let output = Command::new("bash")
            .args(["-c", &script])
            .env("GIVEWAY", env!("CARGO_BIN_EXE_giveway"))
            .output()
            .unwrap();
        text_of(&output.stdout).lines().last().unwrap_or_default().trim().to_owned()
    };
    let import = format!("map import {} --output {}", path("ring.map"), path("out.json"));
    for (command, code) in [
        (import.as_str(), "0"),
        ("map generate --output /dev/null", "0"),
        (&format!("map check {}", path("none.json")), "1"),
        (&format!("map show {}", path("ring.map")), "0"),
        (&format!("map check {lab}"), "0"),
        (&format!("sim {}", path("none.json")), "1"),
        (&format!("replay {}", path("none.jsonl")), "1"),
        (&format!("database check --database {}", path("none.sqlite")), "1"),
        (&format!("token list --database {}", path("none.sqlite")), "1"),
        (&format!("learn {} --out {}", path("none.csv"), path("model.json")), "1"),
        (&format!("serve --scenario {}", path("none.json")), "1"),
        ("no-such-command", "2"),
    ] {
        let alone = shell(command, "2>&1 >/dev/null");
        assert_eq!(alone, code, "{command}");
        let both = shell(command, "2>&1");
        assert!([code, "141"].contains(&both.as_str()), "{command} with both closed: {both}");
    }
    assert!(folder.path().join("out.json").exists(), "the map is written");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closure_follows_the_clocks_of_a_zone_also_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let recurs = |from: &str, to: &str| json!({"from": from, "to": to, "utc_offset": "Europe/Berlin"});
    let close = |from: &str, recurs: Value| {
        let body = json!({"nodes": ["R30"], "reason": "cleaning", "from": from, "recurs": recurs});
        async move { post(at, "/v1/closures", &body).await }
    };
    let made = close("2031-03-29T12:00:00Z", recurs("22:00", "22:30")).await;
    assert_eq!((made.status, &made.json()["zone"]), (201, &json!("Europe/Berlin")), "{made:?}");
    assert_eq!(made.json()["next"], "2031-03-29T21:00:00Z", "in winter");
    let small_hours = close("2031-03-28T12:00:00Z", recurs("02:30", "03:00")).await.json();
    assert_eq!(small_hours["next"], "2031-03-29T01:30:00Z");
    let unknown =
        close("2031-03-29T12:00:00Z", json!({"from": "1:00", "to": "02:00", "utc_offset": "Mars/One"})).await;
    assert_eq!(unknown.problem(422)["errors"].as_array().unwrap().len(), 2, "{unknown:?}");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    // Each that is taken back is followed by the next one.
    let next = |series: &'static str, after: &'static str| async move {
        let first = eventually(&format!("{series} goes on after {after}"), async || {
            let known = get(at, &format!("/v1/closures/{series}")).await.json();
            let open = known["occurrences"].as_array().unwrap().clone();
            open.into_iter().find(|o| o["from"].as_str().unwrap() > after)
        })
        .await;
        let path = format!("/v1/closures/{}", first["id"].as_str().unwrap());
        assert_eq!(send(at, "DELETE", &path, &[], "").await.unwrap().status, 204);
        format!("{} {}", first["from"].as_str().unwrap(), first["until"].as_str().unwrap())
    };
    assert_eq!(next("s1", "2031").await, "2031-03-29T21:00:00Z 2031-03-29T21:30:00Z");
    assert_eq!(next("s1", "2031-03-30").await, "2031-03-30T20:00:00Z 2031-03-30T20:30:00Z", "in summer");
    assert_eq!(next("s2", "2031").await, "2031-03-29T01:30:00Z 2031-03-29T02:00:00Z");
    assert_eq!(
        next("s2", "2031-03-30").await,
        "2031-03-30T01:30:00Z 2031-03-30T02:00:00Z",
        "03:30 by the clock"
    );
    assert_eq!(next("s2", "2031-03-31").await, "2031-03-31T00:30:00Z 2031-03-31T01:00:00Z");
    server.stop().await.unwrap();
}
