//! The broker among the arguments of a command: of the server, of virtual robots and of the probe.
//!
//! Main type: [`BrokerFlags`]. Refuses: a password among the arguments, which every user of the machine can read.

use super::{LineMessage, LineSetup, broker_of, is_loopback, tls_of};
use anyhow::{Context, ensure};
use giveway_site::{BrokerSettings, MqttVersion};
use serde::Serialize;
use std::path::PathBuf;

/// The variable of the environment with the password for the broker.
pub const PASSWORD: &str = "GIVEWAY_MQTT_PASSWORD";

/// Arguments that name a broker.
#[derive(Clone, Debug, Default, clap::Args, Serialize)]
pub struct BrokerFlags {
    /// The broker of robots that speak VDA 5050: mqtt://HOST:PORT, or mqtts:// with TLS (docs/robots.md)
    /// [env: GIVEWAY_MQTT]
    #[arg(long, value_name = "URL")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt: Option<String>,
    /// The authority that signed the broker's certificate (PEM) [env: GIVEWAY_MQTT_CA]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt_ca: Option<PathBuf>,
    /// Our own certificate for the broker (PEM) [env: GIVEWAY_MQTT_CERT]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt_cert: Option<PathBuf>,
    /// The key of that certificate (PEM, without a passphrase) [env: GIVEWAY_MQTT_KEY]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt_key: Option<PathBuf>,
    /// Our name at the broker; the password is read from GIVEWAY_MQTT_PASSWORD [env: GIVEWAY_MQTT_USER]
    #[arg(long, value_name = "NAME")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt_user: Option<String>,
}

/// What a client is at a broker.
pub struct BrokerClient {
    /// Its name.
    pub name: String,
    /// The topics that it listens to.
    pub topics: Vec<String>,
    /// What the broker says for it when it is lost.
    pub will: Option<LineMessage>,
}

impl BrokerFlags {
    /// The flags with what the environment says where they say nothing.
    pub fn or_environment(self) -> BrokerFlags {
        let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let file = |name: &str| variable(name).map(PathBuf::from);
        BrokerFlags {
            mqtt: self.mqtt.or_else(|| variable("GIVEWAY_MQTT")),
            mqtt_ca: self.mqtt_ca.or_else(|| file("GIVEWAY_MQTT_CA")),
            mqtt_cert: self.mqtt_cert.or_else(|| file("GIVEWAY_MQTT_CERT")),
            mqtt_key: self.mqtt_key.or_else(|| file("GIVEWAY_MQTT_KEY")),
            mqtt_user: self.mqtt_user.or_else(|| variable("GIVEWAY_MQTT_USER")),
        }
    }

    /// The broker for a site, if one is named.
    ///
    /// # Errors
    /// If something of a broker is named, but not its address.
    pub fn settings(&self) -> anyhow::Result<Option<BrokerSettings>> {
        let text = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let (ca, cert, key) = (text(&self.mqtt_ca), text(&self.mqtt_cert), text(&self.mqtt_key));
        let user = self.mqtt_user.clone();
        let Some(url) = self.mqtt.clone() else {
            let is_empty = [&ca, &cert, &key, &user].into_iter().all(Option::is_none);
            ensure!(
                is_empty,
                "a certificate or a user for a broker, but no broker: add --mqtt mqtt://HOST:PORT"
            );
            return Ok(None);
        };
        Ok(Some(BrokerSettings { url, ca, cert, key, user }))
    }

    /// How clients of the broker are set up; each has its own [`BrokerClient`].
    ///
    /// # Errors
    /// What is missing or cannot be read.
    pub fn line(&self) -> anyhow::Result<impl Fn(BrokerClient) -> LineSetup + use<>> {
        let url = self.mqtt.as_deref().context("no broker is named: add --mqtt mqtt://HOST:PORT")?;
        ensure!(!url.contains('@'), "leave user and password out of --mqtt: --mqtt-user, and {PASSWORD}");
        let (broker, with_tls) = broker_of(url).context("--mqtt is refused")?;
        let identity = match (&self.mqtt_cert, &self.mqtt_key) {
            (Some(certificate), Some(key)) => Some([certificate.as_path(), key.as_path()]),
            (None, None) => None,
            _ => anyhow::bail!("--mqtt-cert and --mqtt-key go together: give both or none"),
        };
        let tls = match with_tls {
            true => Some(tls_of(self.mqtt_ca.as_deref(), identity)?),
            false => None,
        };
        let login = self.mqtt_user.clone();
        ensure!(
            is_loopback(&broker.0) || login.is_some() || identity.is_some(),
            "the broker at {} is not on this machine: name --mqtt-user (with {PASSWORD}), or --mqtt-cert and \
             --mqtt-key",
            broker.0
        );
        let login = login.map(|user| (user, std::env::var(PASSWORD).unwrap_or_default()));
        Ok(move |client: BrokerClient| LineSetup {
            client: client.name,
            broker: broker.clone(),
            tls: tls.clone(),
            login: login.clone(),
            version: MqttVersion::V5,
            topics: client.topics,
            will: client.will,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(flags: &BrokerFlags) -> String {
        flags.line().err().map(|e| format!("{e:#}")).unwrap_or_default()
    }

    #[test]
    fn a_broker_elsewhere_needs_credentials_and_no_password_is_an_argument() {
        let at = |url: &str| BrokerFlags { mqtt: Some(url.into()), ..BrokerFlags::default() };
        assert_eq!(refused(&at("mqtt://127.0.0.1:1")), "");
        assert!(refused(&at("mqtt://hall.example")).contains("--mqtt-user"));
        assert!(refused(&at("mqtt://me:secret@localhost")).contains(PASSWORD));
        assert!(refused(&at("mqtts://localhost")).contains("--mqtt-ca"));
        assert!(refused(&BrokerFlags::default()).contains("--mqtt mqtt://HOST:PORT"));
        let half = BrokerFlags { mqtt_key: Some("k.pem".into()), ..at("mqtt://localhost") };
        assert!(refused(&half).contains("go together"));
        let user = BrokerFlags { mqtt_user: Some("me".into()), ..at("mqtt://hall.example") };
        assert_eq!(refused(&user), "");
    }

    #[test]
    fn a_user_without_a_broker_is_refused_and_no_flag_is_no_broker() {
        let user = BrokerFlags { mqtt_user: Some("me".into()), ..BrokerFlags::default() };
        assert!(user.settings().unwrap_err().to_string().contains("add --mqtt"));
        assert_eq!(BrokerFlags::default().settings().unwrap(), None);
    }
}
