//! The line to an MQTT broker: the one file that knows the client library.
//!
//! Main types: [`MqttLine`], [`LineSetup`], [`LineEvent`]. The line comes back by itself after every fault, with a
//! library client that is made anew: what was queued while it was down is gone, since nobody knows what it is still
//! worth. If the broker says that another client took this one's name over, the line stays down: that is the fence
//! against a second server. Refuses: to know what messages mean, and to keep any that cannot be sent now.

pub mod broker;

use anyhow::Context;
use bytes::Bytes;
use giveway_site::MqttVersion;
use rumqttc::v5::mqttbytes as five;
use rumqttc::v5::mqttbytes::v5::{DisconnectReasonCode, PublishProperties};
use rumqttc::{TlsConfiguration, Transport, mqttbytes as three};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::sync::mpsc::error::TrySendError;

/// The largest message that is taken, bytes; robots' messages are a hundredth of it.
pub const MOST_BYTES: usize = 1 << 20;
/// Messages on their way to the broker.
const QUEUE: usize = 1024;
/// The line is tried again after this, and after twice as long each time, up to the second.
const RESTS: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(5)];
/// The most messages that wait for the broker's confirmation. The client keeps room for all of them: the most that MQTT
/// allows would be 14 MB a line.
const UNCONFIRMED: u16 = 1_000;
/// A broker that says nothing for this long is gone.
const KEEP_ALIVE: Duration = Duration::from_secs(5);
/// What was sent has this long to leave when a line ends.
const FAREWELL: Duration = Duration::from_secs(1);

/// How a line is set up.
#[derive(Clone)]
pub struct LineSetup {
    /// The client's name at the broker. Of two clients of one name the broker keeps the newer.
    pub client: String,
    /// The broker's host and port.
    pub broker: (String, u16),
    /// TLS, if it is wanted.
    pub tls: Option<Arc<rustls::ClientConfig>>,
    /// The user's name and password, if the broker wants them.
    pub login: Option<(String, String)>,
    /// The version of MQTT.
    pub version: MqttVersion,
    /// The topics to listen to.
    pub topics: Vec<String>,
    /// What the broker says for the client when it has lost it.
    pub will: Option<LineMessage>,
}

/// A message to the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineMessage {
    /// The topic.
    pub topic: String,
    /// The text.
    pub payload: Vec<u8>,
    /// Whether the broker has to confirm it.
    pub confirmed: bool,
    /// Whether the broker keeps it.
    pub retained: bool,
    /// After how long it is worth nothing any more; MQTT 3.1.1 cannot say it.
    pub expires: Option<Duration>,
}

/// What happens on a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LineEvent {
    /// The line is up, and listens.
    Up,
    /// A message came.
    Heard {
        /// Its topic.
        topic: String,
        /// Its text.
        payload: Bytes,
    },
    /// The line is down, and is tried again. The reason, in words.
    Down(String),
    /// Another client has taken the name over: the line stays down.
    Displaced,
}

/// A line to a broker.
pub struct MqttLine {
    outgoing: mpsc::Sender<LineMessage>,
    is_up: Arc<AtomicBool>,
}

impl MqttLine {
    /// Begins to connect. Events go to `events`. The line ends when it is dropped: what was sent leaves, and the broker
    /// is told, so that it says no will. If the receiver of the events is dropped, it breaks off as a cable does.
    pub fn begin(setup: LineSetup, events: mpsc::Sender<LineEvent>) -> MqttLine {
        let (outgoing, queue) = mpsc::channel(QUEUE);
        let is_up = Arc::new(AtomicBool::new(false));
        tokio::spawn(run(setup, queue, events, is_up.clone()));
        MqttLine { outgoing, is_up }
    }

    /// Sends a message, if the line is up and takes it now. Gives whether it did.
    pub fn send(&self, message: LineMessage) -> bool {
        self.is_up.load(Ordering::Relaxed) && self.outgoing.try_send(message).is_ok()
    }

    /// Lets the line break off without a farewell, after the receiver of its events was dropped.
    pub fn break_off(self) {
        tokio::spawn(async move { self.outgoing.closed().await });
    }
}

/// The host and port of a URL, and whether TLS is wanted.
///
/// # Errors
/// What is wrong with the URL.
pub fn broker_of(url: &str) -> anyhow::Result<((String, u16), bool)> {
    let (scheme, rest) = url.split_once("://").context("write mqtt://HOST:PORT or mqtts://HOST:PORT")?;
    let (tls, usual) = match scheme {
        "mqtt" => (false, 1883),
        "mqtts" => (true, 8883),
        _ => anyhow::bail!("{scheme}:// is no way to a broker: write mqtt:// or mqtts://"),
    };
    let rest = rest.trim_end_matches('/');
    let (host, port) =
        match rest.rsplit_once(':').filter(|(host, _)| !host.is_empty() && !host.ends_with(':')) {
            Some((host, port)) => (host, port.parse().with_context(|| format!("{port:?} is no port"))?),
            None => (rest, usual),
        };
    anyhow::ensure!(!host.is_empty(), "the host is missing in {url:?}");
    Ok(((host.trim_matches(['[', ']']).to_owned(), port), tls))
}

/// Whether an address is of this machine: elsewhere nobody is trusted without credentials.
pub fn is_loopback(host: &str) -> bool {
    host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

/// The TLS of a line: the authority in a file, and our own certificate if the broker wants one.
///
/// # Errors
/// Which file cannot be read, and why.
pub fn tls_of(ca: Option<&Path>, identity: Option<[&Path; 2]>) -> anyhow::Result<Arc<rustls::ClientConfig>> {
    let mut roots = rustls::RootCertStore::empty();
    let ca = ca.context("TLS needs the file of the broker's authority: `ca` in the site, or --mqtt-ca")?;
    for certificate in certificates(ca)? {
        roots.add(certificate).with_context(|| format!("{} is no authority", ca.display()))?;
    }
    let config = rustls::ClientConfig::builder().with_root_certificates(roots);
    let config = match identity {
        None => config.with_no_client_auth(),
        Some([certificate, key]) => {
            let key = PrivateKeyDer::from_pem_file(key)
                .with_context(|| format!("cannot read the key in {}", key.display()))?;
            let chain = certificates(certificate)?;
            config.with_client_auth_cert(chain, key).context("the certificate and the key do not fit")?
        }
    };
    Ok(Arc::new(config))
}

fn certificates(file: &Path) -> anyhow::Result<Vec<CertificateDer<'static>>> {
    let read = CertificateDer::pem_file_iter(file).and_then(|all| all.collect::<Result<Vec<_>, _>>());
    let all = read.with_context(|| format!("cannot read certificates from {}", file.display()))?;
    anyhow::ensure!(!all.is_empty(), "{} has no certificate", file.display());
    Ok(all)
}

/// How a connection ended.
enum LineEnd {
    Lost(String),
    Displaced,
    /// Nobody listens any more.
    Over,
}

/// Keeps the line up until nobody needs it.
async fn run(
    setup: LineSetup,
    mut queue: mpsc::Receiver<LineMessage>,
    events: mpsc::Sender<LineEvent>,
    is_up: Arc<AtomicBool>,
) {
    let mut rest = RESTS[0];
    loop {
        let end = match setup.version {
            MqttVersion::V5 => connect_five(&setup, &mut queue, &events, &is_up).await,
            MqttVersion::V3 => connect_three(&setup, &mut queue, &events, &is_up).await,
        };
        let was_up = is_up.swap(false, Ordering::Relaxed);
        let event = match end {
            LineEnd::Over => return,
            LineEnd::Displaced => LineEvent::Displaced,
            LineEnd::Lost(why) => LineEvent::Down(why),
        };
        let ends = event == LineEvent::Displaced;
        if events.send(event).await.is_err() || ends {
            return;
        }
        while queue.try_recv().is_ok() {}
        rest = if was_up { RESTS[0] } else { (rest * 2).min(RESTS[1]) };
        tokio::select! {
            () = tokio::time::sleep(rest) => {}
            () = events.closed() => return,
        }
    }
}

/// How a client of MQTT 5 connects.
fn options_five(setup: &LineSetup) -> rumqttc::v5::MqttOptions {
    let (host, port) = &setup.broker;
    let mut options = rumqttc::v5::MqttOptions::new(&setup.client, host, *port);
    options.set_keep_alive(KEEP_ALIVE).set_clean_start(true);
    options.set_max_packet_size(Some(MOST_BYTES as u32));
    options.set_outgoing_inflight_upper_limit(UNCONFIRMED);
    if let Some((user, password)) = &setup.login {
        options.set_credentials(user, password);
    }
    if let Some(tls) = &setup.tls {
        options.set_transport(Transport::Tls(TlsConfiguration::Rustls(tls.clone())));
    }
    if let Some(will) = &setup.will {
        let qos = if will.confirmed { five::QoS::AtLeastOnce } else { five::QoS::AtMostOnce };
        let will = five::v5::LastWill::new(&will.topic, will.payload.clone(), qos, will.retained, None);
        options.set_last_will(will);
    }
    options
}

/// One connection of MQTT 5, until it ends.
async fn connect_five(
    setup: &LineSetup,
    queue: &mut mpsc::Receiver<LineMessage>,
    events: &mpsc::Sender<LineEvent>,
    is_up: &AtomicBool,
) -> LineEnd {
    use rumqttc::v5::{AsyncClient, ConnectionError, Event, Incoming, StateError};
    let (client, mut line) = AsyncClient::new(options_five(setup), QUEUE);
    loop {
        tokio::select! {
            polled = line.poll() => match polled {
                Ok(Event::Incoming(Incoming::ConnAck(_))) => {
                    for topic in &setup.topics {
                        if client.try_subscribe(topic, five::QoS::AtLeastOnce).is_err() {
                            return LineEnd::Lost(format!("cannot listen to {topic}"));
                        }
                    }
                    is_up.store(true, Ordering::Relaxed);
                    if events.send(LineEvent::Up).await.is_err() {
                        return LineEnd::Over;
                    }
                }
                Ok(Event::Incoming(Incoming::Publish(heard))) => {
                    let topic = String::from_utf8_lossy(&heard.topic).into_owned();
                    let heard = LineEvent::Heard { topic, payload: heard.payload };
                    if let Some(end) = pass_on(events, heard).await {
                        return end;
                    }
                }
                Ok(Event::Incoming(Incoming::Disconnect(why))) => return match why.reason_code {
                    DisconnectReasonCode::SessionTakenOver => LineEnd::Displaced,
                    other => LineEnd::Lost(format!("the broker ended the connection: {other:?}")),
                },
                Ok(_) => {}
                Err(ConnectionError::MqttState(StateError::ServerDisconnect {
                    reason_code: DisconnectReasonCode::SessionTakenOver,
                    ..
                })) => return LineEnd::Displaced,
                Err(why) => return LineEnd::Lost(why.to_string()),
            },
            message = queue.recv() => {
                let Some(LineMessage { topic, payload, confirmed, retained, expires }) = message else {
                    if is_up.load(Ordering::Relaxed) && client.try_disconnect().is_ok() {
                        let leaves = async { while line.poll().await.is_ok() {} };
                        let _is_late = tokio::time::timeout(FAREWELL, leaves).await;
                    }
                    return LineEnd::Over;
                };
                let qos = if confirmed { five::QoS::AtLeastOnce } else { five::QoS::AtMostOnce };
                let seconds = expires.map(|expires| expires.as_secs_f64().ceil() as u32);
                let properties = PublishProperties { message_expiry_interval: seconds, ..Default::default() };
                if client.try_publish_with_properties(topic, qos, retained, payload, properties).is_err() {
                    return LineEnd::Lost("the broker takes no more messages".to_owned());
                }
            }
            () = events.closed() => return LineEnd::Over,
        }
    }
}

/// One connection of MQTT 3.1.1, until it ends. A broker cannot say here that another client took the name over.
async fn connect_three(
    setup: &LineSetup,
    queue: &mut mpsc::Receiver<LineMessage>,
    events: &mpsc::Sender<LineEvent>,
    is_up: &AtomicBool,
) -> LineEnd {
    use rumqttc::{AsyncClient, Event, Incoming, LastWill, MqttOptions};
    let (host, port) = &setup.broker;
    let mut options = MqttOptions::new(&setup.client, host, *port);
    options.set_keep_alive(KEEP_ALIVE).set_clean_session(true).set_max_packet_size(MOST_BYTES, MOST_BYTES);
    if let Some((user, password)) = &setup.login {
        options.set_credentials(user, password);
    }
    if let Some(tls) = &setup.tls {
        options.set_transport(Transport::Tls(TlsConfiguration::Rustls(tls.clone())));
    }
    let qos = |confirmed: bool| if confirmed { three::QoS::AtLeastOnce } else { three::QoS::AtMostOnce };
    if let Some(will) = &setup.will {
        options.set_last_will(LastWill::new(
            &will.topic,
            will.payload.clone(),
            qos(will.confirmed),
            will.retained,
        ));
    }
    let (client, mut line) = AsyncClient::new(options, QUEUE);
    loop {
        tokio::select! {
            polled = line.poll() => match polled {
                Ok(Event::Incoming(Incoming::ConnAck(_))) => {
                    for topic in &setup.topics {
                        if client.try_subscribe(topic, three::QoS::AtLeastOnce).is_err() {
                            return LineEnd::Lost(format!("cannot listen to {topic}"));
                        }
                    }
                    is_up.store(true, Ordering::Relaxed);
                    if events.send(LineEvent::Up).await.is_err() {
                        return LineEnd::Over;
                    }
                }
                Ok(Event::Incoming(Incoming::Publish(heard))) => {
                    let heard =
                        LineEvent::Heard { topic: heard.topic, payload: heard.payload };
                    if let Some(end) = pass_on(events, heard).await {
                        return end;
                    }
                }
                Ok(_) => {}
                Err(why) => return LineEnd::Lost(why.to_string()),
            },
            message = queue.recv() => {
                let Some(LineMessage { topic, payload, confirmed, retained, .. }) = message else {
                    if is_up.load(Ordering::Relaxed) && client.try_disconnect().is_ok() {
                        let leaves = async { while line.poll().await.is_ok() {} };
                        let _is_late = tokio::time::timeout(FAREWELL, leaves).await;
                    }
                    return LineEnd::Over;
                };
                if client.try_publish(topic, qos(confirmed), retained, payload).is_err() {
                    return LineEnd::Lost("the broker takes no more messages".to_owned());
                }
            }
            () = events.closed() => return LineEnd::Over,
        }
    }
}

/// Passes a message on. One that finds no room is dropped: robots say again what matters, and a flood must not fill the
/// memory.
async fn pass_on(events: &mpsc::Sender<LineEvent>, heard: LineEvent) -> Option<LineEnd> {
    match events.try_send(heard) {
        Ok(()) | Err(TrySendError::Full(_)) => None,
        Err(TrySendError::Closed(_)) => Some(LineEnd::Over),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_names_host_port_and_tls_and_says_what_to_write_otherwise() {
        let broker = |url: &str| broker_of(url).map_err(|e| format!("{e:#}"));
        assert_eq!(broker("mqtt://localhost"), Ok((("localhost".into(), 1883), false)));
        assert_eq!(broker("mqtts://hall.example:9000/"), Ok((("hall.example".into(), 9000), true)));
        assert_eq!(broker("mqtt://[::1]:1884"), Ok((("::1".into(), 1884), false)));
        for (url, part) in
            [("localhost:1883", "mqtt://HOST"), ("http://a", "http://"), ("mqtt://a:b", "no port")]
        {
            assert!(broker(url).is_err_and(|e| e.contains(part)), "{url}");
        }
        assert!(is_loopback("localhost") && is_loopback("127.0.0.1") && is_loopback("::1"));
        assert!(!is_loopback("10.0.0.1") && !is_loopback("broker.example"));
    }
}
