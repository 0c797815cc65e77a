fn main() {
    use giveway::sim::*;
    use std::sync::Arc;
    let a: Vec<String> = std::env::args().collect();
    let mut s = Scenario::parse(&std::fs::read_to_string(&a[1]).unwrap()).unwrap();
    if let Some(d) = a.get(2) {
        s.duration = giveway::time::Span::from_secs(d.parse().unwrap());
    }
    let seed = a.get(3).map_or(s.seed, |x| x.parse().unwrap());
    let map = Arc::new(
        giveway::warehouse::formats::json::parse(
            &std::fs::read_to_string(std::path::Path::new("scenarios").join(&s.map)).unwrap(),
        )
        .unwrap(),
    );
    let t = std::time::Instant::now();
    let mut sim = Simulation::new(map, &s, &[], seed, false, || 0);
    while !sim.is_over() {
        sim.step();
    }
    for (r, t) in sim.world.truth() {
        let near = sim.world.walkers().any(|(_, k)| (k.pose(sim.now()).at - t.pose.at).norm() < 3.0);
        if near {
            println!(
                "{r:?} at {:.2} {:.2} heading {:.1} v {:.2} rack {:?} ahead {:?} why {:?}",
                t.pose.at.x,
                t.pose.at.y,
                t.pose.heading,
                t.speed_mps,
                t.rack,
                sim.fleet.view(sim.now()).robots[r.0 as usize]
                    .granted
                    .iter()
                    .take(3)
                    .map(|n| sim.fleet.warehouse().nodes[*n].name.clone())
                    .collect::<Vec<_>>(),
                sim.fleet.why(r, sim.now())
            );
        }
    }
    let f = sim.world.figures().clone();
    println!(
        "encounters {} contacts {} worker_min {:.1} completed {}",
        f.meetings.len(),
        f.contacts,
        f.worker_time.as_secs_f64() / 60.,
        sim.world.completed()
    );
    for (w, k) in sim.world.walkers() {
        println!("{}", format!("{k:?}").split("impulses").next().unwrap());
        if a.len() > 4 {
        } else {
        }
        println!("{}", format!("{k:?}").split("news:").nth(1).unwrap().rsplit("followed:").next().unwrap());
        println!("{w:?} walked {:.0} m, at {:?}", k.walked_m(), k.pose(sim.now()).at);
        let mut m = std::collections::BTreeMap::new();
        for s in k.log().segments() {
            let e = m.entry(s.cause).or_insert((0, 0.0));
            e.0 += 1;
            e.1 += (s.to.min(sim.now()) - s.from).as_secs_f64();
        }
        println!("{m:?}");
    }
    let o = sim.outcome();
    println!(
        "{:?} violations {} {:?} hash {:x} {:?}",
        o.counts,
        o.law_violations,
        o.broken.iter().take(5).collect::<Vec<_>>(),
        o.trace_hash,
        t.elapsed()
    );
}
