//! The place of a problem: in words for people, and by names and corners for drawings.
//!
//! Main type: [`FindingPlace`]. Refuses: to look anything up; names may be those of nodes that do not exist.

use crate::geometry::Point;

/// The place of a problem.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FindingPlace {
    /// Description in words.
    pub words: String,
    /// Names of the nodes in question.
    pub nodes: Vec<String>,
    /// Corners of the outline in question, metres.
    pub corners: Vec<Point>,
}

impl FindingPlace {
    /// A place that consists of these nodes.
    pub fn of<S: AsRef<str>>(words: impl Into<String>, nodes: impl IntoIterator<Item = S>) -> FindingPlace {
        let nodes = nodes.into_iter().map(|name| name.as_ref().to_owned()).collect();
        FindingPlace { words: words.into(), nodes, corners: Vec::new() }
    }

    /// A place with this outline.
    pub fn outline(words: impl Into<String>, corners: &[Point]) -> FindingPlace {
        FindingPlace { words: words.into(), nodes: Vec::new(), corners: corners.to_vec() }
    }
}

impl From<&str> for FindingPlace {
    fn from(words: &str) -> FindingPlace {
        FindingPlace::of(words, [""; 0])
    }
}

impl From<String> for FindingPlace {
    fn from(words: String) -> FindingPlace {
        FindingPlace::of(words, [""; 0])
    }
}

impl From<&FindingPlace> for FindingPlace {
    fn from(place: &FindingPlace) -> FindingPlace {
        place.clone()
    }
}
