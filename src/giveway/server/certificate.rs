//! The server's TLS certificate: the operator's, or one that the server makes for itself.
//!
//! Main types: [`Identity`], [`CertificateLocation`]. The server's own key is made once and kept beside the database,
//! readable only by its owner; the certificate is renewed with the same key when the host has a name or an address that
//! the certificate lacks, or before it expires. Refuses: to overwrite files that it did not make, and keys that do not
//! match the certificate.

use anyhow::{Context, anyhow, bail};
use jiff::ToSpan;
use jiff::civil::Date;
use rcgen::{CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, KeyPair, date_time_ymd};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::Write;
use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How long the server's own certificate is valid. Some systems accept none that is valid for longer than 825 days.
const DAYS: i32 = 800;

/// How many days before its expiry the certificate is renewed.
const DAYS_BEFORE: i32 = 30;

/// The lines before the server's own certificate, which describe it.
const NAMES: &str = "Made by Giveway for: ";
const UNTIL: &str = "Until: ";

/// The location of certificate and key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CertificateLocation {
    /// Files of the operator.
    Given {
        /// The certificate and its chain.
        certificate: PathBuf,
        /// The certificate's key.
        key: PathBuf,
    },
    /// Files that the server makes beside the database.
    Own {
        /// The database file.
        database: PathBuf,
        /// Names and addresses that clients use.
        names: BTreeSet<String>,
    },
}

/// A certificate with its key, ready to serve.
#[derive(Clone, Debug)]
pub struct Identity {
    /// The configuration for rustls.
    pub config: Arc<ServerConfig>,
    /// SHA-256 of the certificate, as browsers show it.
    pub fingerprint: String,
    /// The certificate's file.
    pub certificate: PathBuf,
    /// Names and addresses for which the server made the certificate; empty for the operator's certificate.
    pub names: Vec<String>,
}

impl Identity {
    /// Reads the certificate, or makes one.
    ///
    /// # Errors
    /// If a file cannot be read or written, or certificate and key do not match; the text names the file.
    pub fn open(place: &CertificateLocation, today: Date) -> anyhow::Result<Identity> {
        match place {
            CertificateLocation::Given { certificate, key } => Identity::read(certificate, key, Vec::new()),
            CertificateLocation::Own { database, names } => {
                let (certificate, key) = own_files(database);
                let names = make(&certificate, &key, names, today)?;
                Identity::read(&certificate, &key, names)
            }
        }
    }

    fn read(certificate: &Path, key: &Path, names: Vec<String>) -> anyhow::Result<Identity> {
        let chain =
            CertificateDer::pem_file_iter(certificate).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let chain =
            chain.map_err(|e| anyhow!("cannot read the certificate {}: {e}", certificate.display()))?;
        let Some(first) = chain.first() else {
            bail!("{} holds no certificate: it must be PEM, with BEGIN CERTIFICATE", certificate.display());
        };
        let digest: Vec<String> = Sha256::digest(first).iter().map(|b| format!("{b:02X}")).collect();
        let secret = PrivateKeyDer::from_pem_file(key).map_err(|e| {
            anyhow!("cannot read the key {}: {e}; it must be PEM, without a passphrase", key.display())
        })?;
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let mut config = ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()?
            .with_no_client_auth()
            .with_single_cert(chain, secret)
            .with_context(|| {
                let (certificate, key) = (certificate.display(), key.display());
                format!("the certificate {certificate} and the key {key} do not work together")
            })?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        let (config, certificate) = (Arc::new(config), certificate.into());
        Ok(Identity { config, fingerprint: digest.join(":"), certificate, names })
    }
}

/// Certificate and key beside a database: `giveway.cert.pem` and `giveway.key.pem` beside `giveway.sqlite`.
pub fn own_files(database: &Path) -> (PathBuf, PathBuf) {
    (database.with_extension("cert.pem"), database.with_extension("key.pem"))
}

/// Makes what is missing; returns the names in the certificate.
fn make(
    certificate: &Path,
    key: &Path,
    names: &BTreeSet<String>,
    today: Date,
) -> anyhow::Result<Vec<String>> {
    let pair = if key.exists() {
        let text = std::fs::read_to_string(key).with_context(|| format!("cannot read {}", key.display()))?;
        let remedy = "if it is not needed, remove it and start again";
        KeyPair::from_pem(&text).with_context(|| format!("{} holds no key: {remedy}", key.display()))?
    } else {
        let pair = KeyPair::generate().context("cannot make a key")?;
        write(key, &pair.serialize_pem(), 0o600)?;
        pair
    };
    let had = if certificate.exists() { Some(known(certificate)?) } else { None };
    let mut all = names.clone();
    if let Some((had, until)) = had {
        let lasting = today.checked_add(DAYS_BEFORE.days())? < until;
        if lasting && names.is_subset(&had) {
            return Ok(had.into_iter().collect());
        }
        all.extend(had);
    }
    let until = today.checked_add(DAYS.days())?;
    let pem = sign(&all, today.yesterday()?, until, &pair)?;
    let list: Vec<_> = all.into_iter().collect();
    let text = format!("{NAMES}{}\n{UNTIL}{until}\n{pem}", list.join(", "));
    write(certificate, &text, 0o644)?;
    Ok(list)
}

fn sign(names: &BTreeSet<String>, from: Date, until: Date, pair: &KeyPair) -> anyhow::Result<String> {
    let day = |d: Date| date_time_ymd(d.year().into(), d.month().unsigned_abs(), d.day().unsigned_abs());
    let mut params = CertificateParams::new(names.iter().cloned().collect::<Vec<_>>())
        .context("a name or address cannot be put into a certificate: check --tls-name")?;
    params.distinguished_name = DistinguishedName::new();
    params.distinguished_name.push(DnType::CommonName, "Giveway, signed by itself");
    params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    (params.not_before, params.not_after) = (day(from), day(until));
    Ok(params.self_signed(pair).context("cannot sign the certificate")?.pem())
}

/// The names in the server's own certificate, and its expiry.
fn known(certificate: &Path) -> anyhow::Result<(BTreeSet<String>, Date)> {
    let name = certificate.display();
    let text = std::fs::read_to_string(certificate).with_context(|| format!("cannot read {name}"))?;
    let line = |start: &str| text.lines().find_map(|l| l.strip_prefix(start));
    let (Some(names), Some(until)) = (line(NAMES), line(UNTIL).and_then(|t| t.trim().parse().ok())) else {
        bail!("{name} was not made by Giveway: name it with --tls-cert and --tls-key, or move it away");
    };
    Ok((names.split(", ").map(str::to_owned).collect(), until))
}

/// Writes a file completely or not at all, never readable by more users than `mode` allows.
fn write(path: &Path, text: &str, mode: u32) -> anyhow::Result<()> {
    let fresh = path.with_extension("pem.new");
    let attempt = || -> std::io::Result<()> {
        if fresh.exists() {
            std::fs::remove_file(&fresh)?;
        }
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, mode);
        #[cfg(not(unix))]
        let _ = mode;
        let mut file = options.open(&fresh)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        std::fs::rename(&fresh, path)
    };
    attempt().with_context(|| format!("cannot write {}", path.display()))
}

/// The names and addresses under which this host can be reached when it listens on `at`.
pub fn host_names(at: IpAddr) -> BTreeSet<String> {
    let mut names: BTreeSet<String> = ["localhost", "127.0.0.1", "::1"].map(String::from).into();
    if at.is_loopback() {
        return names;
    }
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let host = host.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    let plain =
        |h: &&str| !h.is_empty() && h.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.".contains(&b));
    if let Some(host) = host.as_deref().map(str::trim).filter(plain) {
        let host = host.to_ascii_lowercase();
        if !host.contains('.') {
            names.insert(format!("{host}.local"));
        }
        names.insert(host);
    }
    if at.is_unspecified() {
        let table = std::fs::read_to_string("/proc/net/fib_trie").unwrap_or_default();
        names.extend(local_addresses(&table).into_iter().chain(outward()).map(|ip| ip.to_string()));
    } else {
        names.insert(at.to_string());
    }
    names
}

/// The addresses of this host in Linux's routing table.
fn local_addresses(table: &str) -> Vec<IpAddr> {
    let lines: Vec<&str> = table.lines().collect();
    let address = |pair: &[&str]| {
        let ip: IpAddr = pair[0].trim_start().strip_prefix("|-- ")?.trim().parse().ok()?;
        (pair[1].trim() == "/32 host LOCAL" && !ip.is_loopback()).then_some(ip)
    };
    lines.windows(2).filter_map(address).collect()
}

/// The address from which this host reaches others. Nothing is sent: connecting a datagram socket only looks up the
/// route.
fn outward() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind("0.0.0.0:0").ok()?;
    socket.connect("192.0.2.1:9").ok()?;
    socket.local_addr().ok().map(|a| a.ip()).filter(|ip| !ip.is_unspecified() && !ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;
    use jiff::civil::date;

    struct CertificateFolder(PathBuf);

    impl CertificateFolder {
        fn new(name: &str) -> CertificateFolder {
            let path = std::env::temp_dir().join(format!("giveway-tls-{name}-{}", std::process::id()));
            std::fs::create_dir_all(&path).unwrap();
            CertificateFolder(path)
        }

        fn own(&self, names: &[&str]) -> CertificateLocation {
            let names = names.iter().map(|n| (*n).to_owned()).collect();
            CertificateLocation::Own { database: self.0.join("floor.sqlite"), names }
        }
    }

    impl Drop for CertificateFolder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn an_own_certificate_is_made_once_and_kept_with_a_key_that_only_its_owner_reads() {
        let folder = CertificateFolder::new("once");
        let place = folder.own(&["localhost", "10.0.0.7"]);
        let first = Identity::open(&place, date(2026, 1, 1)).unwrap();
        let again = Identity::open(&place, date(2027, 1, 1)).unwrap();
        assert_eq!(first.fingerprint, again.fingerprint);
        assert_eq!(first.fingerprint.len(), 32 * 3 - 1);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let (_, key) = own_files(&folder.0.join("floor.sqlite"));
            assert_eq!(std::fs::metadata(key).unwrap().permissions().mode() & 0o777, 0o600);
        }
    }

    #[test]
    fn a_new_address_or_a_near_end_makes_a_new_certificate_with_the_same_key() {
        let folder = CertificateFolder::new("anew");
        let (_, key) = own_files(&folder.0.join("floor.sqlite"));
        let first = Identity::open(&folder.own(&["localhost"]), date(2026, 1, 1)).unwrap();
        let secret = std::fs::read(&key).unwrap();
        let moved = Identity::open(&folder.own(&["10.0.0.8"]), date(2026, 1, 2)).unwrap();
        assert_ne!(first.fingerprint, moved.fingerprint);
        assert_eq!(moved.names, ["10.0.0.8", "localhost"], "old names stay");
        let later = Identity::open(&folder.own(&["localhost"]), date(2028, 3, 1)).unwrap();
        assert_ne!(moved.fingerprint, later.fingerprint, "it would have ended in March 2028");
        assert_eq!(std::fs::read(&key).unwrap(), secret);
    }

    #[test]
    fn what_is_wrong_with_files_is_said_with_their_names() {
        let folder = CertificateFolder::new("wrong");
        let at = |name: &str| folder.0.join(name);
        let (one, two) = (folder.own(&["localhost"]), CertificateFolder::new("wrong-2"));
        Identity::open(&one, date(2026, 1, 1)).unwrap();
        Identity::open(&two.own(&["localhost"]), date(2026, 1, 1)).unwrap();
        std::fs::write(at("text.pem"), "this is no certificate\n").unwrap();
        let says = |certificate: PathBuf, key: PathBuf| {
            let place = CertificateLocation::Given { certificate, key };
            format!("{:#}", Identity::open(&place, date(2026, 1, 1)).unwrap_err())
        };
        let (good, key) = own_files(&at("floor.sqlite"));
        let (_, strange) = own_files(&two.0.join("floor.sqlite"));
        for (certificate, key, word) in [
            (at("none.pem"), key.clone(), "none.pem"),
            (at("text.pem"), key.clone(), "text.pem holds no certificate"),
            (good.clone(), at("none.pem"), "cannot read the key"),
            (good.clone(), at("text.pem"), "without a passphrase"),
            (good.clone(), strange, "do not work together"),
        ] {
            let text = says(certificate, key);
            assert!(text.contains(word), "{word}: {text}");
        }
        std::fs::write(&good, "not ours\n").unwrap();
        let text = format!("{:#}", Identity::open(&one, date(2026, 1, 1)).unwrap_err());
        assert!(text.contains("--tls-cert"), "{text}");
        assert_eq!(std::fs::read_to_string(&good).unwrap(), "not ours\n");
    }

    #[test]
    fn the_addresses_of_this_host_are_read_from_the_table_of_routes() {
        let table = "Main:\n  +-- 0.0.0.0/0 3 0 5\n     |-- 0.0.0.0\n        /0 universe UNICAST\n\
                     \u{20}    |-- 127.0.0.1\n        /32 host LOCAL\n     |-- 192.168.7.20\n        /32 host LOCAL\n\
                     \u{20}    |-- 192.168.7.255\n        /32 link BROADCAST\n";
        assert_eq!(local_addresses(table), ["192.168.7.20".parse::<IpAddr>().unwrap()]);
    }

    #[test]
    fn a_server_of_this_machine_only_has_the_names_of_this_machine_only() {
        let names = host_names("127.0.0.1".parse().unwrap());
        assert_eq!(names.into_iter().collect::<Vec<_>>(), ["127.0.0.1", "::1", "localhost"]);
        assert!(host_names("10.1.2.3".parse().unwrap()).contains("10.1.2.3"));
    }
}
