//! Settings: flags before environment before file before defaults.
//!
//! Main types: [`Flags`] (what the command line accepts), [`Config`] (the resulting settings). The environment has the
//! same names in capitals after `GIVEWAY_`. Refuses: to listen beyond this machine without a token, and unknown
//! settings.

use super::certificate::{self, CertificateLocation};
use crate::mqtt::broker::BrokerFlags;
use anyhow::{Context, bail, ensure};
use figment::Figment;
use figment::providers::{Format, Serialized, Toml};
use giveway_api::recording::Limits;
use giveway_api::{Gate, Interop, OidcSettings, Role};
use giveway_site::BrokerSettings;
use openidconnect::ClientSecret;
use serde::{Deserialize, Serialize};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// Settings that the environment may give.
const FROM_ENVIRONMENT: [&str; 21] = [
    "site",
    "scenario",
    "method",
    "listen",
    "database",
    "past_hours",
    "past_mb",
    "keep_days",
    "people_keep_days",
    "token",
    "tokens",
    "tls",
    "tls_cert",
    "tls_key",
    "ca_file",
    "mqtt",
    "mqtt_ca",
    "mqtt_cert",
    "mqtt_key",
    "mqtt_user",
    "robots",
];

/// Schemes of other databases, which are distinguished from file names even without `//`.
const OTHERS: [&str; 4] = ["postgres", "postgresql", "mysql", "file"];

/// The shortest token, in characters.
const SHORTEST_TOKEN: usize = 16;

/// Flags of `giveway serve`.
#[derive(Clone, Debug, Default, clap::Args, Serialize)]
pub struct Flags {
    /// Settings file (TOML; the keys are in docs/operate.md) [env: GIVEWAY_CONFIG]
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    pub config: Option<PathBuf>,
    /// The floor to run: map, robot kinds, policy, links (docs/site.md) [env: GIVEWAY_SITE]
    #[arg(long, value_name = "FILE", conflicts_with = "scenario")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub site: Option<PathBuf>,
    /// A simulated floor to run instead: a site with simulated customers, people and faults [default:
    /// scenarios/first.json] [env: GIVEWAY_SCENARIO]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<PathBuf>,
    /// How workers' goals are recognised: detour, chapter3 or chapter3_tiles (docs/intention.md) [default: the
    /// floor's] [env: GIVEWAY_METHOD]
    #[arg(long, value_name = "METHOD")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
    /// Address and port; port 0 takes any [default: 127.0.0.1:8080] [env: GIVEWAY_LISTEN]
    #[arg(long, value_name = "HOST:PORT")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub listen: Option<String>,
    /// The database, as FILE or sqlite:FILE; created if there never was one [default: giveway.sqlite]
    /// [env: GIVEWAY_DATABASE]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub database: Option<PathBuf>,
    /// Start with an empty database even if there are traces of an old one, which are moved aside; an intact database
    /// is never replaced
    #[arg(long)]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub new: bool,
    /// How much of the past can be replayed, from a folder beside the database; 0 keeps none [default: 24]
    /// [env: GIVEWAY_PAST_HOURS]
    #[arg(long, value_name = "HOURS")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub past_hours: Option<u32>,
    /// Most disk space that the recordings of the past may use [default: 1000] [env: GIVEWAY_PAST_MB]
    #[arg(long, value_name = "MEGABYTES")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub past_mb: Option<u32>,
    /// How long jobs, assignments and encounters that are over stay in the lists [default: 400]
    /// [env: GIVEWAY_KEEP_DAYS]
    #[arg(long, value_name = "DAYS")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keep_days: Option<u32>,
    /// How long lists, events and recordings contain people's identities; after that, encounters and assignments are
    /// anonymous [default: 7] [env: GIVEWAY_PEOPLE_KEEP_DAYS]
    #[arg(long, value_name = "DAYS")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people_keep_days: Option<u32>,
    /// File with one token per line; a single token may be in GIVEWAY_TOKEN [env: GIVEWAY_TOKENS]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tokens: Option<PathBuf>,
    /// Speak HTTPS, with a certificate made at the first start and kept beside the database [env: GIVEWAY_TLS]
    #[arg(long)]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub tls: bool,
    /// Speak HTTPS with this certificate (PEM, with its chain) [env: GIVEWAY_TLS_CERT]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tls_cert: Option<PathBuf>,
    /// The key of that certificate (PEM, without a passphrase) [env: GIVEWAY_TLS_KEY]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tls_key: Option<PathBuf>,
    /// Another name or address for the certificate made with --tls; may be given several times
    #[arg(long = "tls-name", value_name = "NAME")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tls_names: Vec<String>,
    /// Certificate authorities (PEM) to trust for webhooks and the identity provider, instead of the public ones
    /// [env: GIVEWAY_CA_FILE]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ca_file: Option<PathBuf>,
    /// An internal network, such as 10.20.0.0/16, to which webhooks may be sent; may be given several times
    #[arg(long, value_name = "NETWORK")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub webhook_inside: Vec<String>,
    /// The broker of robots that speak VDA 5050.
    #[command(flatten)]
    #[serde(flatten)]
    pub broker: BrokerFlags,
    /// Robots behind that broker, and their kinds (docs/robots.md); those of the floor drive beside them
    /// [env: GIVEWAY_ROBOTS]
    #[arg(long, value_name = "FILE")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robots: Option<PathBuf>,
}

/// The settings that result.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The floor to run.
    pub site: Option<PathBuf>,
    /// A simulated floor to run instead.
    pub scenario: Option<PathBuf>,
    /// How workers' goals are recognised, instead of the method in the floor's file.
    pub method: Option<String>,
    /// The address and port to listen on.
    pub listen: String,
    /// The database file.
    pub database: PathBuf,
    /// Whether to start with an empty database even if there are traces of an old one.
    #[serde(default)]
    pub new: bool,
    /// How many hours of recordings are kept.
    pub past_hours: u32,
    /// How many megabytes of recordings are kept.
    pub past_mb: u32,
    /// How many days things that are over stay in the lists.
    pub keep_days: u32,
    /// How many days people's identities are kept.
    pub people_keep_days: u32,
    /// Roles that may see names of people; only in the settings file.
    pub people_names_for: Vec<Role>,
    /// A token.
    pub token: Option<String>,
    /// A file with tokens.
    pub tokens: Option<PathBuf>,
    /// Whether to speak HTTPS with a certificate that the server makes.
    pub tls: bool,
    /// A certificate with which to speak HTTPS.
    pub tls_cert: Option<PathBuf>,
    /// The key of that certificate.
    pub tls_key: Option<PathBuf>,
    /// Additional names for the certificate that the server makes.
    #[serde(default)]
    pub tls_names: Vec<String>,
    /// Certificate authorities to trust for outgoing requests, instead of the public ones.
    pub ca_file: Option<PathBuf>,
    /// An identity provider with which people sign in; only in the settings file.
    #[serde(default)]
    pub oidc: Option<OidcSettings>,
    /// How many seconds a webhook may accept nothing before an alarm is raised; only in the settings file.
    pub webhook_alarm_s: u32,
    /// Internal networks to which webhooks may be sent, such as `10.20.0.0/16`. There are none by default: otherwise, a
    /// caller who adds a webhook could make this server connect to what only the server can reach.
    #[serde(default)]
    pub webhook_inside: Vec<String>,
    /// Origins of other sites whose pages may use the API with a token, such as `https://wms.example`; only in the
    /// settings file.
    #[serde(default)]
    pub allowed_origins: Vec<String>,
    /// Frames and workers of MassRobotics reports; only in the settings file.
    #[serde(default)]
    pub massrobotics: Interop,
    /// The broker of robots that speak VDA 5050.
    pub mqtt: Option<String>,
    /// The authority of the broker's certificate.
    pub mqtt_ca: Option<PathBuf>,
    /// Our own certificate for the broker.
    pub mqtt_cert: Option<PathBuf>,
    /// The key of that certificate.
    pub mqtt_key: Option<PathBuf>,
    /// Our name at the broker.
    pub mqtt_user: Option<String>,
    /// A file with robots behind the broker.
    pub robots: Option<PathBuf>,
}

/// The scenario that runs if no floor is named.
const FIRST_SCENARIO: &str = "scenarios/first.json";

/// The file that describes the server's floor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FloorFile {
    /// A site.
    Site(PathBuf),
    /// A scenario: a site with toys.
    Scenario(PathBuf),
}

impl FloorFile {
    /// The file's path.
    pub fn path(&self) -> &Path {
        match self {
            FloorFile::Site(path) | FloorFile::Scenario(path) => path,
        }
    }
}

impl Default for Config {
    fn default() -> Config {
        Config {
            site: None,
            scenario: None,
            method: None,
            listen: "127.0.0.1:8080".into(),
            database: "giveway.sqlite".into(),
            new: false,
            past_hours: 24,
            past_mb: 1000,
            keep_days: giveway_store::KEEP_DAYS,
            people_keep_days: giveway_store::PEOPLE_KEEP_DAYS,
            people_names_for: vec![Role::Operator, Role::Admin],
            token: None,
            tokens: None,
            tls: false,
            tls_cert: None,
            tls_key: None,
            tls_names: Vec::new(),
            ca_file: None,
            oidc: None,
            webhook_alarm_s: 60,
            webhook_inside: Vec::new(),
            allowed_origins: Vec::new(),
            massrobotics: Interop::default(),
            mqtt: None,
            mqtt_ca: None,
            mqtt_cert: None,
            mqtt_key: None,
            mqtt_user: None,
            robots: None,
        }
    }
}

impl Config {
    /// Settings from flags, environment, file and defaults.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is unknown; the text names it.
    pub fn read(flags: &Flags) -> anyhow::Result<Config> {
        Config::merge(flags, |name| std::env::var(name).ok().filter(|v| !v.is_empty()))
    }

    fn merge(flags: &Flags, environment: impl Fn(&str) -> Option<String>) -> anyhow::Result<Config> {
        let mut figment = Figment::from(Serialized::defaults(Config::default()));
        let file = flags.config.clone().or_else(|| environment("GIVEWAY_CONFIG").map(PathBuf::from));
        if let Some(file) = file {
            ensure!(file.exists(), "cannot read the settings file {}: it does not exist", file.display());
            figment = figment.merge(Toml::file_exact(file));
        }
        for key in FROM_ENVIRONMENT {
            // Read by hand, since every value is a text, even one that looks like a number.
            if let Some(value) = environment(&format!("GIVEWAY_{}", key.to_uppercase())) {
                figment = match (key, value.as_str()) {
                    ("tls", "true" | "1") => figment.merge(Serialized::default(key, true)),
                    ("tls", "false" | "0") => figment.merge(Serialized::default(key, false)),
                    ("tls", other) => bail!("GIVEWAY_TLS takes true or false, not \"{other}\""),
                    ("past_hours" | "past_mb" | "keep_days" | "people_keep_days", number) => {
                        let wrong =
                            format!("GIVEWAY_{} takes a number, not \"{number}\"", key.to_uppercase());
                        let number = number.parse::<u32>().context(wrong)?;
                        figment.merge(Serialized::default(key, number))
                    }
                    _ => figment.merge(Serialized::default(key, value)),
                };
            }
        }
        let merged = figment.merge(Serialized::defaults(flags)).extract();
        let mut config: Config = merged.map_err(|e| anyhow::anyhow!("settings: {e}"))?;
        if let Some(oidc) = &mut config.oidc {
            oidc.client_secret = environment("GIVEWAY_OIDC_CLIENT_SECRET").map(ClientSecret::new);
        }
        if let (Some(site), Some(scenario)) = (&config.site, &config.scenario) {
            let (site, scenario) = (site.display(), scenario.display());
            bail!("both a site ({site}) and a scenario ({scenario}) are named: leave one of them out");
        }
        Ok(Config { database: database_file(&config.database)?, ..config })
    }

    /// The file of the floor to run.
    pub fn floor(&self) -> FloorFile {
        match &self.site {
            Some(site) => FloorFile::Site(site.clone()),
            None => FloorFile::Scenario(self.scenario.clone().unwrap_or_else(|| FIRST_SCENARIO.into())),
        }
    }

    /// The broker of robots, if one is named.
    ///
    /// # Errors
    /// If something of a broker is named, but not its address.
    pub fn broker(&self) -> anyhow::Result<Option<BrokerSettings>> {
        let Config { mqtt, mqtt_ca, mqtt_cert, mqtt_key, mqtt_user, .. } = self.clone();
        BrokerFlags { mqtt, mqtt_ca, mqtt_cert, mqtt_key, mqtt_user }.settings()
    }

    /// The gate that admits the tokens.
    ///
    /// # Errors
    /// If the file with tokens cannot be read, or a token is too short.
    pub fn gate(&self) -> anyhow::Result<Gate> {
        let mut tokens: Vec<String> = self.token.iter().cloned().collect();
        if let Some(path) = &self.tokens {
            let text = std::fs::read_to_string(path)
                .with_context(|| format!("cannot read {}: give the file with --tokens", path.display()))?;
            let lines = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
            let before = tokens.len();
            tokens.extend(lines.map(str::to_owned));
            ensure!(tokens.len() > before, "{} has no tokens: write one on each line", path.display());
        }
        for token in &tokens {
            let plain = token.bytes().all(|b| b.is_ascii_alphanumeric() || b"-._~+/=".contains(&b));
            ensure!(plain, "a token must consist of letters, digits and -._~+/= only");
            ensure!(
                token.len() >= SHORTEST_TOKEN,
                "a token is shorter than {SHORTEST_TOKEN} characters: take a random one, as from \
                 `openssl rand -hex 24`"
            );
        }
        for origin in &self.allowed_origins {
            ensure!(
                is_origin(origin),
                "allowed_origins: \"{origin}\" is no origin such as https://wms.example:8443"
            );
        }
        let gate = Gate::new(tokens.iter().map(String::as_str)).with_origins(self.allowed_origins.clone());
        Ok(gate.with_provider(self.oidc.is_some()))
    }

    /// The address to listen on.
    ///
    /// # Errors
    /// If the address is invalid, or is beyond this machine while the gate needs no token.
    pub async fn address(&self, gate: &Gate) -> anyhow::Result<SocketAddr> {
        let resolved = tokio::net::lookup_host(&self.listen).await;
        let mut all = resolved.with_context(|| {
            format!("cannot listen on \"{}\": --listen takes HOST:PORT, such as 127.0.0.1:8080", self.listen)
        })?;
        let Some(address) = all.next() else { bail!("\"{}\" resolves to no address", self.listen) };
        ensure!(
            address.ip().is_loopback() || gate.is_closed(),
            "{address} can be reached from other machines, but no token protects it: set \
             GIVEWAY_TOKEN or --tokens FILE, or listen on 127.0.0.1 only"
        );
        Ok(address)
    }

    /// The folder of recordings and their limits; nothing if none are to be kept.
    pub fn past(&self) -> Option<(PathBuf, Limits)> {
        // Recordings show where people were, so they are kept no longer than identities.
        let hours = self.past_hours.min(self.people_keep_days.saturating_mul(24));
        let limits = Limits { age_s: f64::from(hours) * 3600.0, bytes: u64::from(self.past_mb) * 1_000_000 };
        let any = self.past_hours > 0 && self.past_mb > 0;
        any.then(|| (self.past_folder(), limits))
    }

    /// The folder of recordings, if any were kept.
    pub fn past_folder(&self) -> PathBuf {
        self.database.with_extension("past")
    }

    /// The location of certificate and key; nothing if the server speaks plain HTTP.
    ///
    /// # Errors
    /// If only one of certificate and key is named.
    pub fn tls(&self, address: SocketAddr) -> anyhow::Result<Option<CertificateLocation>> {
        match (&self.tls_cert, &self.tls_key) {
            (Some(certificate), Some(key)) => {
                Ok(Some(CertificateLocation::Given { certificate: certificate.clone(), key: key.clone() }))
            }
            (Some(_), None) => bail!("the certificate has no key: name its key with --tls-key FILE"),
            (None, Some(_)) => {
                bail!("the key has no certificate: name its certificate with --tls-cert FILE")
            }
            (None, None) if self.tls => {
                let mut names = certificate::host_names(address.ip());
                names.extend(self.tls_names.iter().cloned());
                Ok(Some(CertificateLocation::Own { database: self.database.clone(), names }))
            }
            (None, None) => Ok(None),
        }
    }
}

/// The file that `--database` names: a path, or a URL that begins with `sqlite:`.
fn database_file(given: &Path) -> anyhow::Result<PathBuf> {
    const REMEDY: &str = "--database takes FILE or sqlite:FILE";
    let Some(text) = given.to_str() else { return Ok(given.into()) };
    if let Some(rest) = text.strip_prefix("sqlite:") {
        let file = rest.strip_prefix("//").unwrap_or(rest);
        ensure!(!file.is_empty(), "\"{text}\" names no file: {REMEDY}");
        ensure!(file != ":memory:", "\"{text}\" would be lost when the server stops: {REMEDY}");
        ensure!(!file.contains('?'), "\"{text}\" has parameters, which are not supported: {REMEDY}");
        return Ok(file.into());
    }
    let scheme = text.split_once("://").map(|(scheme, _)| scheme);
    let scheme = scheme
        .or_else(|| OTHERS.into_iter().find(|s| text.strip_prefix(s).is_some_and(|t| t.starts_with(':'))));
    if let Some(scheme) =
        scheme.filter(|s| s.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b)))
    {
        bail!("databases of the kind \"{scheme}\" are not supported: {REMEDY}");
    }
    Ok(given.into())
}

/// Whether this is what browsers send as `Origin`: scheme and host in lower case, with a port if it is not the usual
/// one, and nothing after that.
fn is_origin(text: &str) -> bool {
    let host = ["https://", "http://"].into_iter().find_map(|scheme| text.strip_prefix(scheme));
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.:[]".contains(c);
    host.is_some_and(|host| !host.is_empty() && host.chars().all(plain))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nothing(_: &str) -> Option<String> {
        None
    }

    #[test]
    fn flags_win_over_environment_and_environment_over_defaults() {
        let flags = Flags { listen: Some("127.0.0.1:1".into()), ..Flags::default() };
        let environment = |name: &str| match name {
            "GIVEWAY_LISTEN" => Some("127.0.0.1:2".into()),
            "GIVEWAY_TOKEN" => Some("0123456789012345678".into()),
            _ => None,
        };
        let config = Config::merge(&flags, environment).unwrap();
        assert_eq!(config.listen, "127.0.0.1:1");
        assert_eq!(config.token.as_deref(), Some("0123456789012345678"), "a text, not a number");
        assert_eq!(config.database, PathBuf::from("giveway.sqlite"));
    }

    #[test]
    fn a_wrong_settings_file_is_named() {
        let file = std::env::temp_dir().join(format!("giveway-{}.toml", std::process::id()));
        std::fs::write(&file, "listn = \"127.0.0.1:1\"\n").unwrap();
        let flags = Flags { config: Some(file.clone()), ..Flags::default() };
        let error = Config::merge(&flags, nothing).unwrap_err().to_string();
        std::fs::remove_file(&file).unwrap();
        assert!(error.contains("listn") && error.contains(".toml"), "{error}");
    }

    #[test]
    fn an_identity_provider_is_a_table_of_the_file_and_its_secret_comes_from_elsewhere() {
        let file = std::env::temp_dir().join(format!("giveway-oidc-{}.toml", std::process::id()));
        let table = "[oidc]\nissuer = \"https://login.example\"\nclient_id = \"giveway\"\n\
                     [oidc.roles]\n\"shift leads\" = \"operator\"\n";
        let read = |text: &str, secret: Option<&str>| {
            std::fs::write(&file, text).unwrap();
            let flags = Flags { config: Some(file.clone()), ..Flags::default() };
            Config::merge(&flags, |name| {
                secret.filter(|_| name == "GIVEWAY_OIDC_CLIENT_SECRET").map(str::to_owned)
            })
        };
        let config = read(table, Some("open sesame")).unwrap();
        assert!(config.gate().unwrap().is_closed(), "who is not signed in is not let in");
        let oidc = config.oidc.unwrap();
        assert_eq!(oidc.roles.get("shift leads"), Some(&Role::Operator));
        assert_eq!(oidc.client_secret.unwrap().secret(), "open sesame");
        assert!(read(table, None).unwrap().oidc.unwrap().client_secret.is_none());
        for (wrong, named) in [("operator", "captain"), ("client_id", "client_name")] {
            let error = read(&table.replace(wrong, named), None).unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
        let inside = table.replace("client_id", "client_secret = \"x\"\nclient_id");
        assert!(read(&inside, None).is_err(), "a secret is not for the settings file");
        std::fs::remove_file(&file).unwrap();
    }

    #[test]
    fn tls_is_switched_on_by_a_flag_by_a_word_or_by_files() {
        let at: SocketAddr = "127.0.0.1:1".parse().unwrap();
        let word = |text: &'static str| move |name: &str| (name == "GIVEWAY_TLS").then(|| text.into());
        let read = |flags: &Flags, text| Config::merge(flags, word(text)).and_then(|c| c.tls(at));
        assert_eq!(read(&Flags::default(), "false").unwrap(), None);
        assert!(matches!(read(&Flags::default(), "true").unwrap(), Some(CertificateLocation::Own { .. })));
        assert!(read(&Flags::default(), "maybe").unwrap_err().to_string().contains("maybe"));
        let named = Flags { tls: true, tls_names: vec!["floor.example".into()], ..Flags::default() };
        let Some(CertificateLocation::Own { names, .. }) = read(&named, "0").unwrap() else {
            panic!("the flag wins")
        };
        assert!(names.contains("floor.example"), "{names:?}");
        let half = Flags { tls_cert: Some("a.pem".into()), ..Flags::default() };
        assert!(read(&half, "0").unwrap_err().to_string().contains("--tls-key"));
        let both = Flags { tls_key: Some("b.pem".into()), ..half };
        assert!(matches!(read(&both, "0").unwrap(), Some(CertificateLocation::Given { .. })));
    }

    #[test]
    fn the_database_is_a_file_or_a_sqlite_url_and_others_are_refused_in_words() {
        let read = |text: &str| {
            let flags = Flags { database: Some(text.into()), ..Flags::default() };
            Config::merge(&flags, nothing).map(|c| c.database)
        };
        for (given, file) in [
            ("a/b.sqlite", "a/b.sqlite"),
            ("sqlite:b.sqlite", "b.sqlite"),
            ("sqlite://b.sqlite", "b.sqlite"),
            ("sqlite:///var/b.sqlite", "/var/b.sqlite"),
            ("sqlite:/var/b.sqlite", "/var/b.sqlite"),
            ("night:shift.sqlite", "night:shift.sqlite"),
        ] {
            assert_eq!(read(given).unwrap(), PathBuf::from(file), "{given}");
        }
        for given in [
            "postgres://host/db",
            "postgresql:db",
            "mysql://host",
            "sqlite:",
            "sqlite::memory:",
            "sqlite:a?mode=ro",
        ] {
            let error = read(given).unwrap_err().to_string();
            assert!(error.contains("--database takes FILE or sqlite:FILE"), "{given}: {error}");
        }
        let variable = |name: &str| (name == "GIVEWAY_DATABASE").then(|| "sqlite:c.sqlite".to_owned());
        assert_eq!(Config::merge(&Flags::default(), variable).unwrap().database, PathBuf::from("c.sqlite"));
    }

    #[tokio::test]
    async fn it_refuses_to_listen_beyond_this_machine_without_a_token() {
        let open = Config { listen: "0.0.0.0:0".into(), ..Config::default() };
        let error = open.address(&open.gate().unwrap()).await.unwrap_err().to_string();
        assert!(error.contains("GIVEWAY_TOKEN"), "{error}");
        let closed = Config { token: Some("a-long-enough-token".into()), ..open };
        closed.address(&closed.gate().unwrap()).await.unwrap();
        let short = Config { token: Some("short".into()), ..closed };
        assert!(short.gate().unwrap_err().to_string().contains("shorter"));
        let absurd = Config { listen: "127.0.0.1:99999".into(), ..Config::default() };
        assert!(absurd.address(&Gate::default()).await.unwrap_err().to_string().contains("--listen"));
    }

    #[test]
    fn origins_are_as_browsers_send_them() {
        for origin in ["https://wms.example", "http://localhost:5173", "https://[::1]:8443"] {
            assert!(is_origin(origin), "{origin}");
        }
        for other in ["*", "wms.example", "https://", "https://wms.example/", "https://WMS.example", "null"] {
            assert!(!is_origin(other), "{other}");
            let config = Config { allowed_origins: vec![other.into()], ..Config::default() };
            assert!(config.gate().is_err(), "{other}");
        }
    }
}
