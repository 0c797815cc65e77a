//! The versions of VDA 5050 that are spoken here.
//!
//! Main type: [`Version`]. Refuses: to guess a version from a message's form.

use std::fmt;

/// A version of VDA 5050. Versions are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Version {
    /// 2.0.0, of January 2022.
    V2_0,
    /// 2.1.0, of January 2024.
    V2_1,
    /// 3.0.0, of 2026, with the corrections of 3.0.1.
    V3_0,
}

impl Version {
    /// All versions, oldest first.
    pub const ALL: [Version; 3] = [Version::V2_0, Version::V2_1, Version::V3_0];

    /// The version as headers have it.
    pub fn text(self) -> &'static str {
        match self {
            Version::V2_0 => "2.0.0",
            Version::V2_1 => "2.1.0",
            Version::V3_0 => "3.0.0",
        }
    }

    /// The version of a header: patch versions count as their minor version, and a `v` in front is no matter.
    pub fn of_text(text: &str) -> Option<Version> {
        let mut parts = text.trim().trim_start_matches(['v', 'V']).split('.');
        match (parts.next()?, parts.next().unwrap_or("0")) {
            ("2", "0") => Some(Version::V2_0),
            ("2", "1") => Some(Version::V2_1),
            ("3", "0") => Some(Version::V3_0),
            _ => None,
        }
    }

    /// The level of the topic that names the major version.
    pub fn topic_level(self) -> &'static str {
        match self {
            Version::V2_0 | Version::V2_1 => "v2",
            Version::V3_0 => "v3",
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_is_known_by_its_text_with_any_patch_and_no_other_version_is() {
        for version in Version::ALL {
            assert_eq!(Version::of_text(version.text()), Some(version));
        }
        assert_eq!(Version::of_text("3.0.1"), Some(Version::V3_0));
        assert_eq!(Version::of_text("v2.1"), Some(Version::V2_1));
        for unknown in ["", "1.1.0", "2.2.0", "3.1.0", "4", "two"] {
            assert_eq!(Version::of_text(unknown), None, "{unknown}");
        }
    }
}
