//! Sign-ons that have begun and whose browsers are at the identity provider.
//!
//! Main types: [`PendingSignOns`], [`PendingSignOn`]. Each is for one browser and one return. They are kept in memory:
//! after a restart of the server, people begin again. Refuses: more than a thousand; the oldest are dropped first.

use crate::access::caller::TokenHash;
use giveway_floor::time::{Span, Time};
use openidconnect::{Nonce, PkceCodeVerifier, RedirectUrl};
use std::collections::BTreeMap;

/// How many sign-ons may be pending at once.
const MOST: usize = 1000;

/// How long a person may take at the provider.
pub const SIGN_ON_LIFE: Span = Span::from_secs(10 * 60);

/// A sign-on that has begun.
#[derive(Debug)]
pub struct PendingSignOn {
    /// The digest of the secret in the browser's cookie.
    pub cookie: TokenHash,
    /// The nonce that the ID token must contain.
    pub nonce: Nonce,
    /// The PKCE verifier, which the provider expects with the code.
    pub verifier: PkceCodeVerifier,
    /// Where the provider sends the browser.
    pub redirect: RedirectUrl,
    /// The page to show after the sign-on.
    pub back: String,
    /// When the sign-on began.
    pub began: Time,
}

/// All pending sign-ons, by the `state` that the provider sends back.
#[derive(Debug, Default)]
pub struct PendingSignOns(BTreeMap<String, PendingSignOn>);

impl PendingSignOns {
    /// Adds a sign-on; if there are too many, drops the oldest.
    pub fn add(&mut self, state: String, sign_on: PendingSignOn) {
        let now = sign_on.began;
        self.0.retain(|_, other| now - other.began < SIGN_ON_LIFE);
        while self.0.len() >= MOST {
            let oldest = self.0.iter().min_by_key(|(_, a)| a.began).map(|(state, _)| state.clone());
            oldest.map(|state| self.0.remove(&state));
        }
        self.0.insert(state, sign_on);
    }

    /// Removes and returns the sign-on of this state, begun in the browser with this cookie; nothing if there is none
    /// or it is too old.
    pub fn take(&mut self, state: &str, cookie: &TokenHash, now: Time) -> Option<PendingSignOn> {
        // A browser with another cookie does not end this sign-on.
        let sign_on = self.0.get(state).filter(|sign_on| sign_on.cookie == *cookie)?;
        let is_late = now - sign_on.began >= SIGN_ON_LIFE;
        self.0.remove(state).filter(|_| !is_late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sign_on(cookie: u8, began: i64) -> PendingSignOn {
        PendingSignOn {
            cookie: [cookie; 32],
            nonce: Nonce::new("n".into()),
            verifier: PkceCodeVerifier::new("v".into()),
            redirect: RedirectUrl::new("https://fleet.example".into()).unwrap(),
            back: "/".into(),
            began: Time(began),
        }
    }

    #[test]
    fn a_sign_on_is_for_one_browser_and_one_return() {
        let mut pending = PendingSignOns::default();
        pending.add("s".into(), sign_on(1, 0));
        assert!(pending.take("other", &[1; 32], Time(1)).is_none());
        assert!(pending.take("s", &[2; 32], Time(1)).is_none(), "another browser");
        assert!(pending.take("s", &[1; 32], Time(1)).is_some());
        assert!(pending.take("s", &[1; 32], Time(1)).is_none(), "a second time");
        pending.add("s".into(), sign_on(1, 0));
        assert!(pending.take("s", &[1; 32], Time::ZERO + SIGN_ON_LIFE).is_none(), "too late");
    }

    #[test]
    fn there_are_never_more_than_a_thousand_and_the_oldest_end() {
        let mut pending = PendingSignOns::default();
        for i in 0..2 * MOST {
            pending.add(i.to_string(), sign_on(1, i64::try_from(i).unwrap()));
        }
        assert_eq!(pending.0.len(), MOST);
        assert!(pending.take("0", &[1; 32], Time(1)).is_none());
        assert!(pending.take(&(2 * MOST - 1).to_string(), &[1; 32], Time(1)).is_some());
    }
}
