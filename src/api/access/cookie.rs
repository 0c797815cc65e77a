//! Cookies of sessions and of sign-ons with an identity provider: reading, setting and removing them.
//!
//! Main functions: [`session_secret`], [`session_cookie`], [`no_session_cookie`], [`attempt_cookie`]. Refuses: to send
//! a cookie to another site or to scripts, or unencrypted if the page came over HTTPS.

use axum::http::{HeaderMap, header};

/// The prefix of the name of a session cookie.
const SESSION: &str = "giveway_session";

/// The prefix of the name of the cookie that a browser has while its user is at the identity provider.
const ATTEMPT: &str = "giveway_oidc";

/// The name of a cookie at the requested address. Browsers do not separate cookies by port, so the name contains the
/// port: two servers on one machine do not sign out each other's users.
fn cookie_name(name: &str, headers: &HeaderMap) -> String {
    match text(headers, header::HOST).rsplit_once(':') {
        Some((_, port)) if !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => {
            format!("{name}_{port}")
        }
        _ => name.into(),
    }
}

/// The secret in the request's session cookie.
pub fn session_secret(headers: &HeaderMap) -> Option<&str> {
    secret_of(SESSION, headers)
}

/// The secret in the cookie of a browser that comes back from the identity provider.
pub fn attempt_secret(headers: &HeaderMap) -> Option<&str> {
    secret_of(ATTEMPT, headers)
}

fn secret_of<'a>(name: &str, headers: &'a HeaderMap) -> Option<&'a str> {
    let name = cookie_name(name, headers);
    let sent = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
    let mut pairs = sent.flat_map(|all| all.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(n, _)| *n == name).map(|(_, secret)| secret)
}

/// The header that sets the session cookie. The cookie lasts until the browser is closed; the server ends the session
/// after its time. `plain`: the page came over plain HTTP.
pub fn session_cookie(headers: &HeaderMap, secret: &str, plain: bool) -> String {
    let secure = if plain { "" } else { "; Secure" };
    format!("{}={secret}; Path=/; HttpOnly; SameSite=Strict{secure}", cookie_name(SESSION, headers))
}

/// The header that removes the session cookie.
pub fn no_session_cookie(headers: &HeaderMap) -> String {
    format!("{}; Max-Age=0", session_cookie(headers, "", is_plain(headers)))
}

/// The header that sets a cookie for a sign-on with the identity provider, for `seconds` at most. The cookie is `Lax`,
/// since the browser comes back from another site, where a `Strict` one would not be sent.
pub fn attempt_cookie(headers: &HeaderMap, secret: &str, seconds: i64, plain: bool) -> String {
    let (name, secure) = (cookie_name(ATTEMPT, headers), if plain { "" } else { "; Secure" });
    format!("{name}={secret}; Path=/v1/session/oidc; Max-Age={seconds}; HttpOnly; SameSite=Lax{secure}")
}

/// Whether the page came over plain HTTP, so that a browser would not keep a `Secure` cookie. Browsers say in `Origin`
/// how they got the page, also behind a proxy that speaks TLS; a client without `Origin` is believed only on this
/// machine.
pub fn is_plain(headers: &HeaderMap) -> bool {
    match text(headers, header::ORIGIN) {
        "" => is_loopback(text(headers, header::HOST)),
        origin => origin.starts_with("http://"),
    }
}

/// Whether this host is the machine itself.
pub fn is_loopback(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let name = name.trim_start_matches('[').trim_end_matches(']');
    name.is_empty()
        || name.eq_ignore_ascii_case("localhost")
        || name.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> &str {
    headers.get(name).and_then(|v| v.to_str().ok()).unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, value.parse().unwrap());
        }
        headers
    }

    #[test]
    fn the_cookie_is_that_of_the_port() {
        let all = "giveway_session_8080=a; giveway_session_8081=b; giveway_session=c; other";
        for (host, secret) in [
            ("localhost:8080", Some("a")),
            ("localhost:8081", Some("b")),
            ("[::1]", Some("c")),
            ("x:9", None),
        ] {
            assert_eq!(session_secret(&headers(&[("host", host), ("cookie", all)])), secret, "{host}");
        }
        let two = headers(&[("host", "h"), ("cookie", "a=b"), ("cookie", "giveway_session=c")]);
        assert_eq!(session_secret(&two), Some("c"), "in a second header");
    }

    #[test]
    fn it_is_secure_unless_the_page_came_in_the_clear() {
        for (pairs, secure) in [
            (&[("host", "fleet.example"), ("origin", "https://fleet.example")][..], true),
            (&[("host", "10.0.0.7:8080"), ("origin", "http://10.0.0.7:8080")], false),
            (&[("host", "localhost:8080")], false),
            (&[("host", "fleet.example")], true),
        ] {
            let headers = headers(pairs);
            let cookie = session_cookie(&headers, "x", is_plain(&headers));
            assert_eq!(cookie.ends_with("; Secure"), secure, "{cookie}");
            assert!(cookie.contains("; Path=/; HttpOnly; SameSite=Strict"), "{cookie}");
        }
    }
}
