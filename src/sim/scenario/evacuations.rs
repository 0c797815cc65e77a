//! The part of a scenario that says when the building is evacuated.
//!
//! Main type: [`Evacuation`]. Refuses: impossible times, and an evacuation before the previous one is over.

use giveway_site::{SiteError, check};
use serde::Deserialize;

/// A time in which everybody leaves the building.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evacuation {
    /// Beginning, seconds from the start.
    pub at_s: f64,
    /// End, seconds from the start.
    pub until_s: f64,
}

impl Evacuation {
    pub(super) fn check_all(all: &[Evacuation]) -> Result<(), SiteError> {
        let mut free = 0.0;
        for one in all {
            check("evacuations.at_s", one.at_s, free..=1e7, "after the one before, up to 10000000")?;
            let until = one.at_s + 1.0..=2e7;
            check("evacuations.until_s", one.until_s, until, "at least a second after at_s")?;
            free = one.until_s;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scenario;

    #[test]
    fn evacuations_follow_one_another() {
        let scenario = |of: &str| {
            let file = r#"{"giveway_scenario": 1, "name": "x", "map": "m", "robots": 1, "evacuations": "#;
            Scenario::parse(&format!("{file}{of}}}"))
        };
        let good = scenario(r#"[{"at_s": 60, "until_s": 120}, {"at_s": 120, "until_s": 130}]"#).unwrap();
        assert_eq!(good.evacuations.len(), 2);
        for (of, key) in [
            (r#"[{"at_s": 60, "until_s": 60}]"#, "evacuations.until_s"),
            (r#"[{"at_s": 60, "until_s": 120}, {"at_s": 90, "until_s": 130}]"#, "evacuations.at_s"),
            (r#"[{"at_s": 60}]"#, "until_s"),
        ] {
            let error = scenario(of).expect_err(of).to_string();
            assert!(error.contains(key), "{of}: {error}");
        }
    }
}
