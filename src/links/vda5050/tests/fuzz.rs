//! Anything at all under a robot's topics: its session lives, and keeps what holds for it.

use super::*;

/// What robots of others said and were told, as recorded.
const RECORDED: [&str; 3] = [
    include_str!("../../../vda5050/recorded/coaty-2.0.0.jsonl"),
    include_str!("../../../vda5050/recorded/rosi-2.0.0.jsonl"),
    include_str!("../../../vda5050/recorded/sdk-2.1.0.jsonl"),
];
/// What takes the place of some bytes.
const PIECES: [&str; 14] =
    ["\"", "{", "]", "\\u", "-", "1e999", "null", ",", ":", "NaN", "4294967295", "[]", "true", "gw-1-1-1"];

/// A generator that is quick; nothing else is asked of it.
struct MutationSource(u64);

impl MutationSource {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % sides
    }
}

/// The payloads of robots, each with its topic.
fn payloads() -> Vec<(TopicKind, Vec<u8>)> {
    let lines = RECORDED.iter().flat_map(|text| text.lines());
    let of_robots = lines.filter_map(|line| {
        let line: serde_json::Value = serde_json::from_str(line).expect("a line of JSON");
        let (topic, payload) = (line.get("topic")?.as_str()?, line.get("payload")?);
        let kind = TopicKind::ALL.into_iter().find(|kind| topic.ends_with(kind.level()))?;
        let text = payload.as_str().map_or_else(|| payload.to_string(), str::to_owned);
        Some((kind, text.into_bytes()))
    });
    of_robots.collect()
}

fn mutated(dice: &mut MutationSource, payload: &[u8]) -> Vec<u8> {
    let mut bytes = payload.to_vec();
    if dice.roll(8) == 0 {
        bytes = (0..dice.roll(200)).map(|_| dice.roll(256) as u8).collect();
    }
    for _ in 0..dice.roll(6) {
        let from = dice.roll(bytes.len() + 1);
        let to = (from + dice.roll(4)).min(bytes.len());
        match dice.roll(3) {
            0 => _ = bytes.splice(from..to, [dice.roll(256) as u8]),
            1 => _ = bytes.splice(from..to, PIECES[dice.roll(PIECES.len())].bytes()),
            // Digits become others: what is read is another number.
            _ => bytes[from..to].iter_mut().filter(|b| b.is_ascii_digit()).for_each(|b| *b = b'9'),
        }
    }
    bytes
}

#[test]
fn mutated_messages_under_every_topic_leave_a_session_alive() {
    let count = std::env::var("GIVEWAY_LINK_FUZZ").ok().and_then(|n| n.parse().ok()).unwrap_or(20_000_u64);
    let (mut dice, mut all) = (MutationSource(0x9E37_79B9_7F4A_7C15), payloads());
    assert!(all.len() > 10, "{}", all.len());
    let mut floor = LinkFloor::new(lab(), Version::ALL.map(standard).into());
    floor.all_ready();
    floor.submit_deliveries(3);
    floor.run(10);
    // Most are states about orders of ours.
    for _second in 0..20 {
        floor.run(1);
        for pair in &floor.pairs {
            let state = Message::State(Box::new(pair.robot.robot.state()));
            let text = write(&header(pair.session.version()), &state, pair.session.version()).to_string();
            all.push((TopicKind::State, text.into_bytes()));
        }
    }
    let mut understood = 0;
    for n in 0..count {
        let (kind, payload) = &all[dice.roll(all.len())];
        let kind = if dice.roll(10) == 0 { TopicKind::ALL[dice.roll(TopicKind::ALL.len())] } else { *kind };
        let bytes = mutated(&mut dice, payload);
        let i = dice.roll(floor.pairs.len());
        let now = floor.now + Span::from_millis(n as i64);
        let session = &mut floor.pairs[i].session;
        if let Ok(said) = read(kind, &bytes) {
            let stamp = MessageStamp { id: said.header.id, timestamp: said.header.timestamp };
            if let Some(heard) = heard(said.message, stamp) {
                understood += 1;
                let out = session.hear(now, heard);
                assert!(out.told.len() < 20 && out.reports.len() < 5 && out.noticed.len() < 20, "{out:?}");
            }
        }
        let _ticked = session.tick(now);
    }
    assert!(understood > count / 20, "{understood} of {count} were understood");
}
