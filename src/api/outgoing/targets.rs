//! Where webhooks may be sent: to public addresses, and to internal networks that the settings name.
//!
//! Main types: [`Targets`], [`Network`], [`GuardedResolver`]; main function: [`masked`]. A caller who may add a webhook
//! chooses an address to which this machine then connects, perhaps one that only this machine can reach. So the
//! addresses to which a name resolves are checked when a webhook is added, and again for each message. Refuses: to
//! resolve a name to an internal address that no setting allows.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::str::FromStr;
use std::sync::Arc;
use std::{fmt, io};
use ureq::config::Config;
use ureq::http::Uri;
use ureq::unversioned::resolver::{DefaultResolver, ResolvedSocketAddrs, Resolver};
use ureq::unversioned::transport::NextTimeout;

/// A range of addresses, as `10.20.0.0/16`, or one address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Network {
    first: IpAddr,
    /// The number of leading bits that all addresses of the network share.
    bits: u32,
}

impl FromStr for Network {
    type Err = String;

    fn from_str(text: &str) -> Result<Network, String> {
        let wrong =
            || format!("\"{text}\" is no network such as 10.20.0.0/16, and no address such as 127.0.0.1");
        let (first, bits) = text.split_once('/').map_or((text, None), |(first, bits)| (first, Some(bits)));
        let first: IpAddr = first.parse().map_err(|_| wrong())?;
        let most = if first.is_ipv4() { 32 } else { 128 };
        let bits = bits.map_or(Ok(most), |bits| bits.parse().map_err(|_| wrong()))?;
        if bits > most { Err(wrong()) } else { Ok(Network { first, bits }) }
    }
}

impl Network {
    fn contains(self, ip: IpAddr) -> bool {
        let same = |a: u128, b: u128, width: u32| {
            let rest = width - self.bits;
            rest >= 128 || a >> rest == b >> rest
        };
        match (self.first, ip) {
            (IpAddr::V4(a), IpAddr::V4(b)) => same(a.to_bits().into(), b.to_bits().into(), 32),
            (IpAddr::V6(a), IpAddr::V6(b)) => same(a.to_bits(), b.to_bits(), 128),
            _ => false,
        }
    }
}

/// The addresses to which webhooks may be sent. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Targets {
    /// Internal networks that the settings name.
    allowed: Arc<[Network]>,
}

impl Targets {
    /// All public addresses, and these networks.
    pub fn allowing(allowed: impl IntoIterator<Item = Network>) -> Targets {
        Targets { allowed: allowed.into_iter().collect() }
    }

    /// Whether messages may go to this address.
    pub fn admits(&self, ip: IpAddr) -> bool {
        let ip = reached(ip);
        !is_inside(ip) || self.allowed.iter().any(|network| network.contains(ip))
    }

    /// Checks whether messages may go to a host, as far as that is known now.
    ///
    /// # Errors
    /// If the host has addresses and none of them is allowed; the text says what to do. A host that is not found may be
    /// found later: each message checks again.
    pub async fn check(&self, host: &str, port: u16) -> Result<(), String> {
        let Ok(found) = tokio::net::lookup_host((host.trim_matches(['[', ']']), port)).await else {
            return Ok(());
        };
        let found: Vec<SocketAddr> = found.collect();
        match found.first() {
            Some(first) if found.iter().all(|at| !self.admits(at.ip())) => Err(refusal(first.ip())),
            _ => Ok(()),
        }
    }
}

/// Why an address is refused, and what to do.
fn refusal(ip: IpAddr) -> String {
    format!(
        "{ip} is an address inside, to which webhooks are sent only if the setting `webhook_inside` names its network"
    )
}

/// The address that packets to this one reach in the end: an IPv4 address embedded in, or translated to, IPv6.
fn reached(ip: IpAddr) -> IpAddr {
    let IpAddr::V6(v6) = ip.to_canonical() else { return ip.to_canonical() };
    let low = |v6: Ipv6Addr| IpAddr::V4(Ipv4Addr::from_bits(v6.segments()[6..].iter().fold(0, joined)));
    match v6.segments() {
        [0x64, 0xff9b, 0, 0, 0, 0, _, _] => low(v6),
        [0, 0, 0, 0, 0, 0, a, b] if a != 0 || b > 1 => low(v6),
        [0x2002, a, b, ..] => IpAddr::V4(Ipv4Addr::from_bits([a, b].iter().fold(0, joined))),
        _ => ip,
    }
}

fn joined(before: u32, next: &u16) -> u32 {
    before << 16 | u32::from(*next)
}

/// Whether an address is this machine's or of a network that is not public.
fn is_inside(ip: IpAddr) -> bool {
    match ip {
        IpAddr::V4(v4) => {
            let [a, b, c, _] = v4.octets();
            let is_special = matches!((a, b, c), (0 | 240.., _, _) | (192, 0, 0) | (198, 18 | 19, _));
            let is_shared = a == 100 && (64..128).contains(&b);
            v4.is_loopback()
                || v4.is_private()
                || v4.is_link_local()
                || v4.is_multicast()
                || is_special
                || is_shared
        }
        IpAddr::V6(v6) => {
            let is_site_local = v6.segments()[0] & 0xffc0 == 0xfec0;
            let is_local = v6.is_unique_local() || v6.is_unicast_link_local() || is_site_local;
            v6.is_loopback() || v6.is_unspecified() || v6.is_multicast() || is_local
        }
    }
}

/// Resolves the hosts of webhooks, to allowed addresses only.
#[derive(Debug)]
pub struct GuardedResolver {
    targets: Targets,
    names: DefaultResolver,
}

impl GuardedResolver {
    /// A resolver for these targets.
    pub fn new(targets: Targets) -> GuardedResolver {
        GuardedResolver { targets, names: DefaultResolver::default() }
    }
}

impl Resolver for GuardedResolver {
    fn resolve(
        &self,
        uri: &Uri,
        config: &Config,
        timeout: NextTimeout,
    ) -> Result<ResolvedSocketAddrs, ureq::Error> {
        let found = self.names.resolve(uri, config, timeout)?;
        // The server's environment names its proxy; what the proxy then reaches is the proxy's decision.
        if config.proxy().is_some_and(|proxy| Some(proxy.host()) == uri.host()) {
            return Ok(found);
        }
        let mut admitted = self.empty();
        found.iter().filter(|at| self.targets.admits(at.ip())).for_each(|at| admitted.push(*at));
        match (admitted.is_empty(), found.first()) {
            (true, Some(first)) => {
                Err(io::Error::new(io::ErrorKind::PermissionDenied, refusal(first.ip())).into())
            }
            _ => Ok(admitted),
        }
    }
}

/// An address as people see it: without its user and password.
#[derive(Clone, Copy, Debug)]
pub struct Masked<'a>(&'a str);

/// An address as people see it: without its user and password.
pub fn masked(url: &str) -> Masked<'_> {
    Masked(url)
}

/// User and password of an address, with the `@` after them; nothing if it has none.
fn credentials(url: &str) -> Option<&str> {
    let (_, rest) = url.split_once("://")?;
    let authority = rest.split(['/', '?', '#']).next()?;
    authority.rfind('@').map(|end| &authority[..=end])
}

impl Masked<'_> {
    /// A text that may quote the address, without user and password.
    pub fn text(self, text: &str) -> String {
        credentials(self.0).map_or_else(|| text.to_owned(), |known| text.replace(known, "***@"))
    }
}

impl fmt::Display for Masked<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_inside_are_refused_in_every_notation_unless_a_setting_names_their_network() {
        let inside = [
            "127.0.0.1",
            "127.9.9.9",
            "0.0.0.0",
            "10.1.2.3",
            "172.16.0.1",
            "172.31.255.1",
            "192.168.7.7",
            "169.254.169.254",
            "100.64.0.1",
            "192.0.0.8",
            "198.18.0.1",
            "224.0.0.1",
            "255.255.255.255",
            "::1",
            "::",
            "fe80::1",
            "fc00::1",
            "fd12::1",
            "fec0::1",
            "ff02::1",
            "::ffff:127.0.0.1",
            "::ffff:10.0.0.1",
            "64:ff9b::10.0.0.1",
            "2002:a00:1::1",
            "::127.0.0.1",
        ];
        let outside = [
            "8.8.8.8",
            "172.32.0.1",
            "172.15.0.1",
            "100.63.0.1",
            "100.128.0.1",
            "192.0.1.1",
            "2600::1",
            "::ffff:8.8.8.8",
            "64:ff9b::8.8.8.8",
            "2002:808:808::1",
        ];
        let none = Targets::default();
        let some = Targets::allowing(["10.0.0.0/8", "fd12::/16", "::1"].map(|n| n.parse().unwrap()));
        let of = |text: &str| text.parse::<IpAddr>().unwrap();
        for text in inside {
            assert!(!none.admits(of(text)), "{text}");
            let is_named = ["10.", "fd12:", "::ffff:10.", "64:ff9b::10.", "2002:a00:"]
                .iter()
                .any(|n| text.starts_with(n));
            assert_eq!(some.admits(of(text)), is_named || text == "::1", "{text}");
        }
        for text in outside {
            assert!(none.admits(of(text)), "{text}");
        }
    }

    #[test]
    fn a_network_that_is_none_is_refused() {
        for text in
            ["", "10.0.0.0/33", "::/129", "10.0.0", "10.0.0.0/", "wms.example", "10.0.0.0/8/8", "10.0.0.0/-1"]
        {
            let error = text.parse::<Network>().unwrap_err();
            assert!(error.contains("10.20.0.0/16"), "{text}: {error}");
        }
        let all: Network = "0.0.0.0/0".parse().unwrap();
        assert!(all.contains("9.9.9.9".parse().unwrap()) && !all.contains("::1".parse().unwrap()));
        assert!("::/0".parse::<Network>().unwrap().contains("fe80::1".parse().unwrap()));
    }

    #[tokio::test]
    async fn a_name_that_resolves_inside_is_refused_and_one_that_is_not_found_may_be_found_later() {
        let none = Targets::default();
        for host in ["localhost", "127.0.0.1", "[::1]", "2130706433", "0"] {
            let refused = none.check(host, 80).await.unwrap_err();
            assert!(refused.contains("webhook_inside"), "{host}: {refused}");
        }
        none.check("no-such-host.invalid", 80).await.unwrap();
        let some = Targets::allowing(["127.0.0.0/8", "::1"].map(|n| n.parse().unwrap()));
        some.check("localhost", 80).await.unwrap();
    }

    #[test]
    fn user_and_password_of_an_address_are_not_shown() {
        for (url, shown) in [
            ("https://wms:secret@wms.example/hook?a=b@c", "https://***@wms.example/hook?a=b@c"),
            ("https://token@wms.example:8443", "https://***@wms.example:8443"),
            ("https://a:b@c@wms.example", "https://***@wms.example"),
            ("https://wms.example/@me", "https://wms.example/@me"),
            ("https://wms.example?x=@", "https://wms.example?x=@"),
        ] {
            assert_eq!(masked(url).to_string(), shown);
        }
        let said = masked("http://wms:secret@host/").text("cannot reach http://wms:secret@host/: refused");
        assert_eq!(said, "cannot reach http://***@host/: refused");
    }
}
