//! The differences between versions of the headset protocol.
//!
//! Main function: [`encoded`]. Version 2 has sentences for people as objects with a code; in version 1 they are bare
//! text, and a headset that was written for version 1 is still served. Refuses: versions that the server does not
//! speak; the greeting handles these.

use super::message::FeedMessage;
use serde_json::Value;

/// Versions of the protocol that this server speaks, best first.
pub const VERSIONS: [u32; 2] = [2, 1];

/// The best version that both sides speak.
pub(crate) fn spoken(by_client: &[u32]) -> Option<u32> {
    VERSIONS.into_iter().find(|version| by_client.contains(version))
}

/// A message as it is sent in this version.
pub(crate) fn encoded(message: &FeedMessage, version: u32) -> String {
    const PLAIN: &str = "messages are plain";
    if version > 1 {
        return serde_json::to_string(message).expect(PLAIN);
    }
    let mut value = serde_json::to_value(message).expect(PLAIN);
    say_bare(&mut value);
    value.to_string()
}

/// Replaces each sentence by its text.
fn say_bare(value: &mut Value) {
    match value {
        Value::Object(map) => {
            let is_sentence = map.len() == 3 && map.contains_key("code") && map.contains_key("args");
            match map.get_mut("text").filter(|_| is_sentence) {
                Some(text) => *value = text.take(),
                None => map.values_mut().for_each(say_bare),
            }
        }
        Value::Array(list) => list.iter_mut().for_each(say_bare),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::text::sentence::feed;
    use serde_json::json;

    #[test]
    fn sentences_are_bare_text_for_headsets_of_version_1_and_have_codes_from_version_2_on() {
        let error = FeedMessage::Error { text: feed::server_shutting_down() };
        let of = |version| serde_json::from_str::<Value>(&encoded(&error, version)).unwrap();
        let text = feed::server_shutting_down().text().to_owned();
        assert_eq!(of(1), json!({"type": "error", "text": text}));
        assert_eq!(of(2)["text"]["code"], "server_shutting_down");
        assert_eq!(of(2)["text"]["text"], text);
    }

    #[test]
    fn the_best_version_that_both_speak_is_spoken() {
        assert_eq!(spoken(&[1]), Some(1));
        assert_eq!(spoken(&[1, 2, 3]), Some(2));
        assert_eq!(spoken(&[3]), None);
    }
}
