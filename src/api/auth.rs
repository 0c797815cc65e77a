//! Authorisation: bearer tokens, and on an open loopback server only pages that it served itself.
//!
//! Main type: [`Gate`]. Tokens are kept as SHA-256 and compared in constant time. Without tokens the server
//! listens on the loopback only; there, requests under a foreign host name or from a foreign page are
//! refused, since any web page can make a browser talk to the loopback. Refuses: tokens in addresses, which
//! end up in logs.

use super::error::Problem;
use axum::http::{HeaderMap, StatusCode, header};
use sha2::{Digest, Sha256};
use subtle::{Choice, ConstantTimeEq};

/// The word before a token in `Sec-WebSocket-Protocol`.
const WS_BEARER: &str = "bearer.";

/// Lets requests in or not.
#[derive(Clone, Debug, Default)]
pub struct Gate {
    tokens: Vec<[u8; 32]>,
}

impl Gate {
    /// A gate that opens to these tokens; if there are none, to every client on this machine.
    pub fn new<'a>(tokens: impl IntoIterator<Item = &'a str>) -> Gate {
        Gate { tokens: tokens.into_iter().map(|t| Sha256::digest(t).into()).collect() }
    }

    /// Whether tokens are needed.
    pub fn is_closed(&self) -> bool {
        !self.tokens.is_empty()
    }

    /// Lets a request in.
    ///
    /// # Errors
    /// 401 without a valid token, 403 for foreign hosts and pages.
    pub fn check(&self, headers: &HeaderMap) -> Result<(), Problem> {
        self.check_origin(headers)?;
        if !self.is_closed() || token_of(headers).is_some_and(|t| self.knows(t)) {
            return Ok(());
        }
        let detail = "this server needs a token: send `Authorization: Bearer TOKEN`, or offer the WebSocket \
                      protocols `giveway` and `bearer.TOKEN`";
        Err(Problem::new(StatusCode::UNAUTHORIZED, "unauthorized", "A token is needed", detail))
    }

    fn knows(&self, token: &str) -> bool {
        let digest: [u8; 32] = Sha256::digest(token).into();
        let any = self.tokens.iter().fold(Choice::from(0), |any, known| any | known.ct_eq(&digest));
        any.into()
    }

    /// Pages of other sites may not use a visitor's browser to reach this server.
    fn check_origin(&self, headers: &HeaderMap) -> Result<(), Problem> {
        let text = |name| headers.get(name).map(|v| v.to_str().unwrap_or("?"));
        let host = text(header::HOST).unwrap_or("");
        let forbid =
            |detail: String| Problem::new(StatusCode::FORBIDDEN, "foreign", "Origin not allowed", detail);
        if !self.is_closed() && !is_loopback(host) {
            let detail = format!("without tokens this server answers at localhost only, not at \"{host}\"");
            return Err(forbid(detail));
        }
        let origin = text(header::ORIGIN);
        let is_own = |origin: &str| origin.split_once("://").is_some_and(|(_, site)| site == host);
        // Browsers say where a request comes from; one that sends no origin, such as for a picture, says at least that.
        let site = headers.get("sec-fetch-site").map(|v| v.to_str().unwrap_or("?"));
        let is_same = site.is_none_or(|site| matches!(site, "same-origin" | "none"));
        if origin.is_none_or(is_own) && is_same {
            return Ok(());
        }
        let page = origin.unwrap_or("another site");
        Err(forbid(format!("a page of {page} may not use the server at {host}")))
    }
}

fn token_of(headers: &HeaderMap) -> Option<&str> {
    if let Some(value) = headers.get(header::AUTHORIZATION) {
        let (scheme, token) = value.to_str().ok()?.split_once(' ')?;
        return scheme.eq_ignore_ascii_case("bearer").then(|| token.trim());
    }
    let offered = headers.get(header::SEC_WEBSOCKET_PROTOCOL)?.to_str().ok()?;
    offered.split(',').find_map(|p| p.trim().strip_prefix(WS_BEARER))
}

fn is_loopback(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let name = name.trim_start_matches('[').trim_end_matches(']');
    name.is_empty()
        || name.eq_ignore_ascii_case("localhost")
        || name.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(gate: &Gate, pairs: &[(&'static str, &str)]) -> u16 {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.insert(*name, value.parse().unwrap());
        }
        gate.check(&headers).map_or_else(|p| p.status, |()| 200)
    }

    #[test]
    fn an_open_gate_lets_this_machine_in_and_no_foreign_page() {
        let open = Gate::default();
        assert_eq!(check(&open, &[("host", "127.0.0.1:8080")]), 200);
        assert_eq!(check(&open, &[("host", "[::1]:8080")]), 200);
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "http://localhost:8080")]), 200);
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "http://evil.example")]), 403);
        let local = ("host", "localhost:8080");
        assert_eq!(
            check(&open, &[local, ("origin", "http://localhost:5173")]),
            403,
            "another page of this machine"
        );
        for (site, status) in [("same-origin", 200), ("none", 200), ("same-site", 403), ("cross-site", 403)] {
            assert_eq!(check(&open, &[local, ("sec-fetch-site", site)]), status, "{site}");
        }
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "null")]), 403);
        assert_eq!(check(&open, &[("host", "evil.example")]), 403, "a name that was made to point here");
    }

    #[test]
    fn a_closed_gate_wants_one_of_its_tokens() {
        let gate = Gate::new(["alpha", "beta"]);
        assert_eq!(check(&gate, &[("host", "site:80")]), 401);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Bearer beta")]), 200);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Bearer gamma")]), 401);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Basic beta")]), 401);
        assert_eq!(check(&gate, &[("sec-websocket-protocol", "giveway, bearer.alpha")]), 200);
    }
}
