//! The seal of a map: ids in the journal are positions in a map, so the journal belongs to that map alone.
//!
//! Main function: [`seal`]. Positions are part of it, since they determine which nodes exclude each other: with a moved
//! node, promised holds may overlap. Refuses: to notice changes that move no id and no meaning, such as a speed limit.

use super::body_record::outlines;
use giveway_floor::id::Dense;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use sha2::{Digest, Sha256};

/// A digest over everything that facts refer to by position, and its coordinates: nodes, lanes, stations and racks.
pub fn seal(w: &Warehouse) -> String {
    let mut hash = Sha256::new();
    let mut line = |text: String| {
        hash.update(text.len().to_le_bytes());
        hash.update(text);
    };
    for n in w.nodes.iter() {
        let mm = |metres: f64| (metres * 1000.0).round() as i64;
        line(format!("node {} {} {} {}", n.name, purpose(n.kind), mm(n.at.x), mm(n.at.y)));
    }
    line(format!("footprint {}", (w.footprint_m * 1000.0).round() as i64));
    // Kinds that take the map's square are left out: they exclude one another as they did before there were kinds.
    for b in w.bodies().iter().filter(|b| b.footprints.iter().any(Option::is_some)) {
        line(format!("kind {} {}", b.kind, outlines(b)));
    }
    for l in w.lanes.iter() {
        line(format!("lane {} {} {}", l.a.ix(), l.b.ix(), l.both));
    }
    for s in w.stations.iter() {
        let queue: Vec<_> = s.queue.iter().map(|n| n.ix()).collect();
        line(format!("station {} {} {queue:?}", s.name, s.node.ix()));
    }
    for r in w.racks.iter() {
        line(format!("rack {} {}", r.name, r.home.ix()));
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

fn purpose(kind: NodeKind) -> String {
    match kind {
        NodeKind::Aisle => "aisle".into(),
        NodeKind::Storage => "storage".into(),
        NodeKind::Station(s) => format!("station {}", s.ix()),
        NodeKind::Queue(s) => format!("queue {}", s.ix()),
        NodeKind::Charger => "charger".into(),
        NodeKind::Parking => "parking".into(),
        NodeKind::Exit => "exit".into(),
    }
}
