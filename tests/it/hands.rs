//! Hands of a headset at a picking station, over its WebSocket: they confirm a line without a button, and a wrong slot
//! is warned of.

use crate::feed::{Headset, hire};
use crate::helper::{Folder, get, post};
use crate::lines::{rack, scenario, until};
use crate::recovery::Program;
use giveway::cell::{FacePlace, PickFace};
use giveway::id::StationId;
use giveway::warehouse::Warehouse;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;

/// A wearer in the workplace of a station whose right hand moves.
pub struct Wearer {
    pub headset: Headset,
    pub face: PickFace,
    at: FacePlace,
    /// Where the wearer stands on the map.
    stands: [f64; 2],
}

impl Wearer {
    /// In front of a station of the map `stations`.
    pub async fn at(at: SocketAddr, station: StationId) -> Wearer {
        Wearer::before(at, &giveway::warehouse::stations(), station).await
    }

    /// In front of a station of a map.
    pub async fn before(at: SocketAddr, w: &Warehouse, station: StationId) -> Wearer {
        let (place, rack) = (&w.stations[station], w.rack_types.iter().next().unwrap());
        let cell = place.cell.as_ref().unwrap();
        let face = PickFace::new(cell, w.nodes[place.node].at, rack);
        let n = cell.workplace.len() as f64;
        let middle = cell.workplace.iter().fold([0.0, 0.0], |[x, y], p| [x + p.x / n, y + p.y / n]);
        let worker = hire(at, &format!("picker-{}", place.name)).await;
        let headset = Headset::connect(at, &worker, "map").await;
        Wearer { headset, face, at: FacePlace::new(0.2, 0.95, 0.95), stands: middle }
    }

    /// Moves the hand in so many seconds, seen about fifty times a second.
    pub async fn moves(&mut self, to: FacePlace, seconds: f64) {
        let (from, steps) = (self.at, (seconds / 0.02) as u32);
        for i in 1..=steps {
            let t = f64::from(i) / f64::from(steps);
            self.at = from + (to - from) * (t * t * (3.0 - 2.0 * t));
            self.shows().await;
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    async fn shows(&mut self) {
        let joint = |back: f64| {
            let p = self.face.on_map(self.at + FacePlace::new(0.0, back, 0.0));
            json!([p.x, p.z, -p.y, 0.01])
        };
        // The wrist, joints of the palm, and tips: numbers 0, 10, 4 and 9.
        let joints: Vec<Value> = (0..25)
            .map(|i| match i {
                0 => joint(0.17),
                4 | 9 => joint(0.0),
                _ => joint(0.09),
            })
            .collect();
        self.headset.seq += 1;
        let (epoch, seq, t) = (self.headset.epoch, self.headset.seq, self.headset.clock_ms());
        let pose = json!({
            "type": "pose", "epoch": epoch, "seq": seq, "t": t, "at": self.stands, "heading": 0.0,
            "hands": {"l": null, "r": joints},
        });
        self.headset.say(pose).await;
    }

    async fn picks(&mut self, slot: &str, tote: usize) {
        self.grasps(slot).await;
        self.puts(tote).await;
    }

    async fn grasps(&mut self, slot: &str) {
        let front = self.face.slot(slot.parse().unwrap());
        let ahead = front + FacePlace::new(0.0, 0.35, 0.0);
        let inside = front - FacePlace::new(0.0, 0.12, 0.0);
        self.moves(ahead, 0.6).await;
        self.moves(inside, 0.5).await;
        self.moves(inside, 0.5).await;
        self.moves(ahead, 0.5).await;
    }

    async fn puts(&mut self, tote: usize) {
        let rim = self.face.tote(tote).unwrap();
        self.moves(rim, 0.8).await;
        self.moves(rim, 0.3).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn hands_of_a_headset_confirm_a_line_without_a_button_and_a_wrong_slot_is_warned_of() {
    let folder = Folder::new();
    let program = Program::with(&folder, &scenario(&folder));
    let at = program.address;
    let lines = json!([
        {"slot": "C3", "quantity": 1, "tote": "B"},
        {"slot": "A2", "quantity": 2, "tote": "A"},
    ]);
    let wanted = json!({"kind": "deliver", "rack": rack(), "station": "S1", "pick_s": 900, "lines": lines});
    let made = post(at, None, &wanted).await.unwrap().json();
    until(at, "the rack is there", "/v1/stations/S1", |s| !s["visit"].is_null()).await;
    let mut wearer = Wearer::at(at, StationId(0)).await;

    wearer.moves(FacePlace::new(0.21, 0.95, 0.95), 0.5).await;
    let lights = wearer.headset.next("cell").await;
    assert_eq!((&lights["station"], &lights["hands"]), (&json!("S1"), &json!(true)), "{lights}");
    assert_eq!((&lights["slot"]["id"], &lights["tote"]["id"]), (&json!("C3"), &json!("B")), "{lights}");
    let lit = wearer.face.on_map(wearer.face.slot("C3".parse().unwrap()));
    let lies = lights["slot"]["at"].as_array().unwrap().iter().filter_map(Value::as_f64);
    let off = lies.zip(lit.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6, "the slot is where it is lit: {lights}");

    wearer.picks("C3", 1).await;
    let confirmed = |s: &Value| s["visit"]["lines"][0]["state"] == "done";
    until(at, "the first line is confirmed", "/v1/stations/S1", confirmed).await;
    let front = wearer.face.slot("C2".parse().unwrap());
    wearer.moves(front + FacePlace::new(0.0, 0.35, 0.0), 0.6).await;
    wearer.moves(front - FacePlace::new(0.0, 0.08, 0.0), 0.5).await;
    let seen = get(at, "/v1/stations/S1").await.json();
    assert_eq!(seen["warnings"], json!([{"kind": "wrong_slot", "slot": "C2", "tote": null}]), "{seen}");
    assert_eq!(seen["hands_seen"], true, "{seen}");
    let warning = loop {
        let told = wearer.headset.next("cell").await;
        if !told["warning"].is_null() {
            break told["warning"].clone();
        }
    };
    assert_eq!(
        warning,
        json!({"kind": "wrong_slot", "slot": "C2", "tote": null}),
        "the headset is told, too"
    );
    wearer.moves(front + FacePlace::new(0.0, 0.35, 0.0), 0.5).await;
    wearer.picks("A2", 0).await;
    let seen = get(at, "/v1/stations/S1").await.json();
    assert_eq!(seen["visit"]["lines"][1]["done"], 1, "{seen}");
    wearer.grasps("A2").await;
    let asked = |s: &Value| !s["unconfirmed"].is_null();
    let asked = until(at, "the rack leaves at the last grasp", "/v1/stations/S1", asked).await;
    assert_eq!(
        (&asked["unconfirmed"]["job"], &asked["unconfirmed"]["line"]["slot"]),
        (&made["id"], &json!("A2"))
    );
    wearer.puts(0).await;
    let job = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    let over = until(at, "the job is over", &job, |j| j["state"] == "done").await;
    assert_eq!(over["lines"][1]["done"], 2, "the last piece is confirmed in its tote: {over}");
    let seen = get(at, "/v1/stations/S1").await.json();
    assert!(seen["unconfirmed"].is_null(), "{seen}");
    program.kill();
}
