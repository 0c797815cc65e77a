//! Requests from the server to other systems: webhooks, and the identity provider.
//!
//! Main types: [`Outgoing`], [`targets::Targets`] (where webhooks may be sent), [`webhooks::Webhook`]. Refuses: to
//! follow redirects, and certificates of authorities that the settings do not name.

pub mod targets;
pub mod webhooks;

use crate::outgoing::targets::{GuardedResolver, Targets};
use std::path::Path;
use std::time::Duration;
use ureq::Agent;
use ureq::tls::{Certificate, PemItem, RootCerts, TlsConfig, parse_pem};
use ureq::unversioned::transport::DefaultConnector;

/// What all outgoing requests have in common.
#[derive(Clone, Debug, Default)]
pub struct Outgoing {
    /// Certificate authorities that replace the public ones.
    authorities: Option<RootCerts>,
}

impl Outgoing {
    /// Trusts the certificate authorities in this file, if one is given, instead of the public ones.
    ///
    /// # Errors
    /// If the file cannot be read or contains no certificate; the text names the file.
    pub fn trusting(ca_file: Option<&Path>) -> Result<Outgoing, String> {
        let Some(path) = ca_file else { return Ok(Outgoing::default()) };
        let wrong = |why: String| format!("ca_file: cannot read {}: {why}", path.display());
        let text = std::fs::read(path).map_err(|e| wrong(e.to_string()))?;
        let items: Result<Vec<PemItem<'_>>, ureq::Error> = parse_pem(&text).collect();
        let items = items.map_err(|e| wrong(e.to_string()))?;
        let certificate = |item| match item {
            PemItem::Certificate(certificate) => Some(certificate),
            _ => None,
        };
        let all: Vec<Certificate<'static>> = items.into_iter().filter_map(certificate).collect();
        if all.is_empty() {
            return Err(wrong("it holds no certificate: it must be PEM, with BEGIN CERTIFICATE".into()));
        }
        Ok(Outgoing { authorities: Some(RootCerts::new_with_certs(&all)) })
    }

    /// An agent that sends requests with this timeout. It returns every answer, whatever its status.
    pub fn agent(&self, patience: Duration) -> Agent {
        self.config(patience).into()
    }

    /// An agent for addresses that other people chose: it connects only to these targets.
    pub fn agent_for(&self, targets: Targets, patience: Duration) -> Agent {
        Agent::with_parts(self.config(patience), DefaultConnector::default(), GuardedResolver::new(targets))
    }

    fn config(&self, patience: Duration) -> ureq::config::Config {
        let tls =
            TlsConfig::builder().root_certs(self.authorities.clone().unwrap_or(RootCerts::WebPki)).build();
        Agent::config_builder()
            .tls_config(tls)
            .timeout_global(Some(patience))
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(true)
            .user_agent(concat!("giveway/", env!("CARGO_PKG_VERSION")))
            .build()
    }
}

/// Why a request failed, and what to do if that is known.
pub fn failure(e: &ureq::Error) -> String {
    let said = e.to_string();
    if said.contains("UnknownIssuer") {
        return format!(
            "{said}: no authority that is trusted has signed the certificate; `ca_file` names others"
        );
    }
    said
}
