//! Messages of headsets: JSON texts with a `type`.
//!
//! Main types: [`HeadsetMessage`], [`PoseSaid`], [`AnchorSaid`]. Unknown keys are ignored, so that newer headsets can
//! talk to older servers. Refuses: to judge numbers; [`super::intake`] does.

use crate::wire::words::GazeKind;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A message of a headset.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum HeadsetMessage {
    /// The first message.
    Hello(HelloSaid),
    /// The answer to a `ping`.
    Pong {
        /// The number of the ping.
        id: u64,
        /// When the device received the ping, milliseconds of its own clock.
        t1: f64,
        /// When the device answered, milliseconds of its own clock.
        t2: f64,
    },
    /// Marks on the floor whose positions the device knows.
    Anchors {
        /// The marks: one with its direction, or two and more.
        pairs: Vec<AnchorSaid>,
    },
    /// The device's origin jumped: earlier poses have lost their meaning.
    Reset,
    /// The device slept, or its page was hidden: its clock may have stopped meanwhile.
    Resync,
    /// A pose.
    Pose(Box<PoseSaid>),
    /// The wearer is done with an assignment.
    Done {
        /// The assignment's number, as guidance gives it.
        assignment: String,
    },
    /// The wearer takes the device off, or closes its page: no more poses will come.
    Bye,
    /// The guidance of this version is on the screen.
    Ack {
        /// The version of the guidance.
        version: u64,
    },
}

/// The first message.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
pub struct HelloSaid {
    /// Versions of the protocol that the client speaks.
    pub versions: Vec<u32>,
    /// The frame of the client's poses.
    #[serde(default)]
    pub frame: PoseFrame,
}

/// The frame of poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PoseFrame {
    /// The device's own frame, which must be aligned.
    #[default]
    Device,
    /// The map's frame.
    Map,
}

/// A mark on the floor.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
pub struct AnchorSaid {
    /// The mark's position in the device's frame: WebXR axes, metres.
    pub device: [f64; 3],
    /// The mark's direction in the device's frame, as a rotation of "ahead".
    pub quat: Option<[f64; 4]>,
    /// The mark's position on the map, metres; alternatively give `mark`.
    pub map: Option<[f64; 2]>,
    /// The name of a node at the mark; alternatively give `map`.
    pub mark: Option<String>,
    /// The mark's direction on the map, radians.
    pub heading: Option<f64>,
    /// The weight of the mark in the fit; 1 is usual.
    pub weight: Option<f64>,
}

/// A pose.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
pub struct PoseSaid {
    /// The alignment to which the pose belongs.
    pub epoch: u32,
    /// The pose's number, which grows within an epoch.
    pub seq: u64,
    /// When the pose was measured, milliseconds of the device's clock.
    pub t: f64,
    /// Position in WebXR axes, metres.
    pub pos: Option<[f64; 3]>,
    /// Orientation in WebXR axes, as a quaternion.
    pub quat: Option<[f64; 4]>,
    /// Instead of `pos`, x and y in the map's frame, metres.
    pub at: Option<[f64; 2]>,
    /// Instead of `quat`, where the wearer faces on the map, radians.
    pub heading: Option<f64>,
    /// One standard deviation of the position, metres.
    pub accuracy: Option<f64>,
    /// How well the device knows the pose.
    #[serde(default)]
    pub quality: QualitySaid,
    /// Where the wearer looks.
    pub gaze: Option<GazeSaid>,
    /// Joints of the hands.
    pub hands: Option<HandsSaid>,
    /// Charge of the device, 0 to 1.
    pub battery: Option<f64>,
}

/// How well a device knows its pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum QualitySaid {
    /// The pose is measured.
    #[default]
    Tracked,
    /// The pose is guessed.
    Emulated,
    /// The pose is unknown.
    Lost,
}

/// Where the wearer looks, in the device's frame.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, ToSchema)]
pub struct GazeSaid {
    /// Where the ray comes from.
    pub kind: GazeKind,
    /// Where the ray begins, WebXR axes, metres.
    pub origin: [f64; 3],
    /// The ray's direction, WebXR axes.
    pub dir: [f64; 3],
}

/// Joints of both hands: x, y, z in WebXR axes and radius, metres; usually 25 of them.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, ToSchema)]
pub struct HandsSaid {
    /// Joints of the left hand.
    #[schema(value_type = Option<Vec<[f64; 4]>>)]
    pub l: Option<HandSaid>,
    /// Joints of the right hand.
    #[schema(value_type = Option<Vec<[f64; 4]>>)]
    pub r: Option<HandSaid>,
}

/// One hand. A hand that cannot be read spoils neither the other hand nor the pose.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum HandSaid {
    /// The hand's joints.
    Joints(Vec<[f64; 4]>),
    /// Unreadable joints: a number is missing or one too many, or it is null, which browsers write for what is not a
    /// number.
    Unreadable(IgnoredAny),
}

impl HandSaid {
    /// The hand's joints, if all of them can be read.
    pub fn joints(&self) -> Option<&[[f64; 4]]> {
        match self {
            HandSaid::Joints(joints) => Some(joints),
            HandSaid::Unreadable(_) => None,
        }
    }
}

/// Reads a message. Some libraries write `NaN` and `Infinity`, which are not JSON: they are read as `null`, so that one
/// joint does not spoil a pose.
pub fn read(text: &str) -> serde_json::Result<HeadsetMessage> {
    serde_json::from_str(text).or_else(|error| match with_null_for_nan(text) {
        Some(text) => serde_json::from_str(&text),
        None => Err(error),
    })
}

/// The text with `null` in place of each `NaN` and `Infinity` outside of strings; nothing if it contains neither.
fn with_null_for_nan(text: &str) -> Option<String> {
    let (mut rest, mut out, mut found) = (text, String::with_capacity(text.len()), false);
    while let Some(at) = rest.find(['"', 'N', 'I', '-']) {
        let (before, here) = rest.split_at(at);
        out.push_str(before);
        let not_a_number =
            ["NaN", "Infinity", "-Infinity", "-NaN"].into_iter().find(|word| here.starts_with(word));
        let taken = match not_a_number {
            Some(word) => {
                found = true;
                out.push_str("null");
                word.len()
            }
            None => {
                let taken = if here.starts_with('"') { string_length(here) } else { 1 };
                out.push_str(&here[..taken]);
                taken
            }
        };
        rest = &here[taken..];
    }
    out.push_str(rest);
    found.then_some(out)
}

/// The length in bytes of the string with which a text begins, including its quotes; all of the text if it does not
/// end.
fn string_length(text: &str) -> usize {
    let (mut escaped, bytes) = (false, text.as_bytes());
    for (i, byte) in bytes.iter().enumerate().skip(1) {
        match byte {
            b'"' if !escaped => return i + 1,
            b'\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_and_infinity_are_read_as_null_outside_of_strings_and_spoil_nothing_else() {
        assert_eq!(
            with_null_for_nan(r#"[NaN, -Infinity, Infinity,-1.5]"#).unwrap(),
            r#"[null, null, null,-1.5]"#
        );
        assert_eq!(with_null_for_nan(r#"{"a":"NaN","b\"NaN":-1}"#), None);
        assert_eq!(with_null_for_nan(r#"{"é\\":NaN}"#).unwrap(), r#"{"é\\":null}"#);
        assert_eq!(with_null_for_nan(r#"{"open"#), None);
        let text = r#"{"type": "pose", "epoch": 1, "seq": 2, "t": 3, "pos": [1, 2, 3],
            "hands": {"l": [[NaN, 1, 1, 0.01]], "r": [[1, 1, 1, 0.01]]}}"#;
        let HeadsetMessage::Pose(pose) = read(text).unwrap() else { panic!("{text}") };
        let hands = pose.hands.expect("hands");
        assert_eq!([hands.l, hands.r].map(|hand| hand.unwrap().joints().is_some()), [false, true]);
        assert!(read("{NaN").is_err() && read("").is_err());
    }

    #[test]
    fn messages_are_read_as_docs_show_them_and_with_keys_of_tomorrow() {
        let text = r#"{"type":"pose","epoch":1,"seq":2,"t":3.5,"pos":[1,2,3],"colour":"red"}"#;
        let HeadsetMessage::Pose(pose) = serde_json::from_str(text).unwrap() else { panic!("{text}") };
        assert_eq!((pose.quality, pose.quat, pose.pos), (QualitySaid::Tracked, None, Some([1.0, 2.0, 3.0])));
        assert_eq!(
            serde_json::from_str::<HeadsetMessage>(r#"{"type":"reset"}"#).unwrap(),
            HeadsetMessage::Reset
        );
        let texts = include_str!("../../../docs/headset.md").split("```json").skip(1);
        let texts = texts.filter_map(|rest| rest.split("```").next());
        let shown: Vec<serde_json::Value> = texts
            .flat_map(|text| serde_json::Deserializer::from_str(text).into_iter())
            .map(|value| value.expect("docs/headset.md shows JSON"))
            .collect();
        let ours = ["hello", "pong", "anchors", "pose", "done"];
        let said = shown.iter().filter(|m| ours.iter().any(|t| m["type"] == *t));
        let read: Vec<HeadsetMessage> =
            said.map(|m| serde_json::from_value(m.clone()).expect("as shown")).collect();
        assert_eq!(read.len(), 5, "docs/headset.md shows each");
        for bad in [r#"{"type":"jump"}"#, "{}", r#"{"type":"pose","epoch":-1}"#] {
            assert!(serde_json::from_str::<HeadsetMessage>(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_hand_with_a_joint_that_is_no_four_numbers_is_unreadable_and_nothing_else_is() {
        let joint = "[1.0, 1.2, -4.2, 0.012]";
        let long = format!("[{joint}, [1, 1, 1, 0.01, 0]]");
        for bad in
            ["[[null, 1, 1, 0.01]]", "[[1, 1, 1]]", &long, r#"[["1", 1, 1, 0.01]]"#, "[null]", "7", "{}"]
        {
            for (l, r) in [(bad, format!("[{joint}]")), (&format!("[{joint}]"), bad.to_owned())] {
                let hands = format!(r#"{{"l": {l}, "r": {r}}}"#);
                let text = format!(r#"{{"type": "pose", "epoch": 1, "seq": 2, "t": 3, "hands": {hands}}}"#);
                let HeadsetMessage::Pose(pose) = serde_json::from_str(&text).expect("the pose can be read")
                else {
                    panic!("{text}")
                };
                let said = pose.hands.expect("hands");
                let joints =
                    [said.l.as_ref(), said.r.as_ref()].map(|hand| hand.expect("it is there").joints());
                let good: &[[f64; 4]] = &[[1.0, 1.2, -4.2, 0.012]];
                assert_eq!(joints, if l == bad { [None, Some(good)] } else { [Some(good), None] }, "{text}");
            }
        }
        let none = serde_json::from_str::<HandsSaid>(r#"{"l": null}"#).unwrap();
        assert_eq!(none, HandsSaid::default(), "a hand that is null is not there");
    }
}
