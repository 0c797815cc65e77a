//! The table `oidc` of the settings file: the provider, and the roles of its groups.
//!
//! Main type: [`OidcSettings`]. Refuses: providers that are reached unencrypted, except on this machine, and secrets in
//! the settings file, which others may read.

use crate::access::caller::Role;
use crate::access::cookie::is_loopback;
use crate::access::roles::OIDC_CALLBACK;
use axum::http::Uri;
use openidconnect::ClientSecret;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The longest session that settings may allow, in hours: a week.
const MOST_HOURS: u32 = 7 * 24;

/// An identity provider that speaks OpenID Connect.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OidcSettings {
    /// The provider's address, as it names itself; its metadata is at `/.well-known/openid-configuration` below it.
    pub issuer: String,
    /// The client id of this server at the provider.
    pub client_id: String,
    /// A file with the client secret. The environment variable `GIVEWAY_OIDC_CLIENT_SECRET` comes first.
    #[serde(default)]
    pub client_secret_file: Option<PathBuf>,
    /// The client secret.
    #[serde(skip)]
    pub client_secret: Option<ClientSecret>,
    /// Where the provider sends browsers back to; if absent, the address under which the browser knows this server.
    #[serde(default)]
    pub redirect: Option<String>,
    /// What the button says after "Sign in with"; if absent, the provider's host.
    #[serde(default)]
    pub label: Option<String>,
    /// The claim with a person's groups. A dot leads into a part of a claim.
    #[serde(default = "groups")]
    pub groups_claim: String,
    /// The claim with a person's name; if absent, the first of `preferred_username`, `email` and `sub`.
    #[serde(default)]
    pub name_claim: Option<String>,
    /// The scopes to ask for besides `openid`.
    #[serde(default = "profile")]
    pub scopes: Vec<String>,
    /// How long a session lasts at most, in hours.
    #[serde(default = "a_shift")]
    pub session_hours: u32,
    /// The role of each group.
    pub roles: BTreeMap<String, Role>,
}

fn groups() -> String {
    "groups".into()
}

fn profile() -> Vec<String> {
    vec!["profile".into(), "email".into()]
}

fn a_shift() -> u32 {
    12
}

impl OidcSettings {
    /// These settings with the client secret, from the environment or the file.
    ///
    /// # Errors
    /// If a setting is wrong; the text names it.
    pub fn complete(self) -> Result<OidcSettings, String> {
        if !is_private(&self.issuer) {
            return Err(format!(
                "oidc.issuer: \"{}\" is no address such as https://login.example/realms/warehouse",
                self.issuer
            ));
        }
        if let Some(redirect) = &self.redirect
            && !(is_address(redirect) && redirect.ends_with(OIDC_CALLBACK))
        {
            return Err(format!(
                "oidc.redirect: \"{redirect}\" is no address such as https://fleet.example{OIDC_CALLBACK}"
            ));
        }
        if self.client_id.trim().is_empty() {
            return Err("oidc.client_id: name the client that the provider knows this server as".into());
        }
        if self.roles.is_empty() || self.roles.values().any(|role| *role == Role::Device) {
            return Err("oidc.roles: give each group one of viewer, operator, integrator and admin".into());
        }
        if !(1..=MOST_HOURS).contains(&self.session_hours) {
            return Err(format!(
                "oidc.session_hours: {} is not between 1 and {MOST_HOURS}",
                self.session_hours
            ));
        }
        let secret = match (&self.client_secret, &self.client_secret_file) {
            (None, Some(path)) => {
                let text = std::fs::read_to_string(path);
                let text = text
                    .map_err(|e| format!("oidc.client_secret_file: cannot read {}: {e}", path.display()))?;
                Some(ClientSecret::new(text.trim().into()))
            }
            (secret, _) => secret.clone(),
        };
        if secret.as_ref().is_some_and(|secret| secret.secret().is_empty()) {
            return Err("oidc: the secret of the client is empty: leave it out if the client has none".into());
        }
        Ok(OidcSettings { client_secret: secret, ..self })
    }

    /// The provider's display name.
    pub fn name(&self) -> String {
        let host = || self.issuer.parse::<Uri>().ok().and_then(|uri| uri.host().map(str::to_owned));
        self.label.clone().or_else(host).unwrap_or_default()
    }
}

fn is_address(text: &str) -> bool {
    let uri = text.parse::<Uri>().ok();
    uri.is_some_and(|uri| {
        matches!(uri.scheme_str(), Some("http" | "https")) && uri.host().is_some_and(|host| !host.is_empty())
    })
}

/// Whether an address uses HTTPS or is on this machine.
fn is_private(text: &str) -> bool {
    let host = || text.parse::<Uri>().ok().and_then(|uri| uri.host().map(str::to_owned));
    is_address(text) && (text.starts_with("https://") || host().is_some_and(|host| is_loopback(&host)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn usual() -> OidcSettings {
        let (issuer, roles) = ("https://login.example/realms/w", json!({"leads": "admin"}));
        serde_json::from_value(json!({"issuer": issuer, "client_id": "giveway", "roles": roles})).unwrap()
    }

    #[test]
    fn what_is_not_said_has_a_usual_value() {
        let settings = usual().complete().unwrap();
        assert_eq!((settings.name().as_str(), settings.groups_claim.as_str()), ("login.example", "groups"));
        assert_eq!((settings.session_hours, settings.client_secret.is_none()), (12, true));
    }

    #[test]
    fn wrong_settings_are_named() {
        let wrong = |settings: OidcSettings| settings.complete().unwrap_err();
        for issuer in ["", "login.example", "http://login.example", "ftp://login.example"] {
            let said = wrong(OidcSettings { issuer: issuer.into(), ..usual() });
            assert!(said.starts_with("oidc.issuer"), "{issuer}: {said}");
        }
        let local = OidcSettings { issuer: "http://127.0.0.1:8180".into(), ..usual() };
        assert!(local.complete().is_ok(), "on this machine nobody listens in");
        let redirect = Some("https://fleet.example/".into());
        assert!(wrong(OidcSettings { redirect, ..usual() }).starts_with("oidc.redirect"));
        let device = BTreeMap::from([("headsets".to_owned(), Role::Device)]);
        assert!(wrong(OidcSettings { roles: device, ..usual() }).starts_with("oidc.roles"));
        assert!(wrong(OidcSettings { roles: BTreeMap::new(), ..usual() }).starts_with("oidc.roles"));
        assert!(wrong(OidcSettings { session_hours: 0, ..usual() }).starts_with("oidc.session_hours"));
        let missing = Some(PathBuf::from("/no/such/secret"));
        let said = wrong(OidcSettings { client_secret_file: missing, ..usual() });
        assert!(said.contains("/no/such/secret"), "{said}");
    }
}
