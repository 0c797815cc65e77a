//! Cookies, of a session and of somebody on the way to an identity provider: how they are read, set and taken back.
//!
//! Main functions: [`session_secret`], [`session_cookie`], [`no_session_cookie`], [`attempt_cookie`]. Refuses: to send
//! a cookie to another site, to scripts, and in the clear where the page came over HTTPS.

use axum::http::{HeaderMap, header};

/// How the name of the cookie of a session begins.
const SESSION: &str = "giveway_session";

/// How the name of the cookie begins that a browser has while its user is at the identity provider.
const ATTEMPT: &str = "giveway_oidc";

/// The name of a cookie at the address that was asked. Browsers do not tell ports apart, so the name does: two
/// servers on one machine do not sign each other's users out.
fn cookie_name(name: &str, headers: &HeaderMap) -> String {
    match text(headers, header::HOST).rsplit_once(':') {
        Some((_, port)) if !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => {
            format!("{name}_{port}")
        }
        _ => name.into(),
    }
}

/// What the cookie of a request's session says.
pub fn session_secret(headers: &HeaderMap) -> Option<&str> {
    secret_of(SESSION, headers)
}

/// What the cookie of somebody says who comes back from the identity provider.
pub fn attempt_secret(headers: &HeaderMap) -> Option<&str> {
    secret_of(ATTEMPT, headers)
}

fn secret_of<'a>(name: &str, headers: &'a HeaderMap) -> Option<&'a str> {
    let name = cookie_name(name, headers);
    let sent = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
    let mut pairs = sent.flat_map(|all| all.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(n, _)| *n == name).map(|(_, secret)| secret)
}

/// The header that gives a browser the cookie of its session. It ends with the browser; the server ends the session
/// after its time. `plain`: the page came over plain HTTP.
pub fn session_cookie(headers: &HeaderMap, secret: &str, plain: bool) -> String {
    let secure = if plain { "" } else { "; Secure" };
    format!("{}={secret}; Path=/; HttpOnly; SameSite=Strict{secure}", cookie_name(SESSION, headers))
}

/// The header that takes that cookie back.
pub fn no_session_cookie(headers: &HeaderMap) -> String {
    format!("{}; Max-Age=0", session_cookie(headers, "", is_plain(headers)))
}

/// The header that gives a browser a cookie for the way to the identity provider and back, of so many seconds at most.
/// It is `Lax`, since the way back begins at another site, which a `Strict` one would not survive.
pub fn attempt_cookie(headers: &HeaderMap, secret: &str, seconds: i64, plain: bool) -> String {
    let (name, secure) = (cookie_name(ATTEMPT, headers), if plain { "" } else { "; Secure" });
    format!("{name}={secret}; Path=/v1/session/oidc; Max-Age={seconds}; HttpOnly; SameSite=Lax{secure}")
}

/// Whether the page came over plain HTTP, and a browser would not keep a `Secure` cookie of it. Browsers say in
/// `Origin` how they got the page, also where a proxy speaks TLS; a client that does not say is trusted on this
/// machine alone.
pub fn is_plain(headers: &HeaderMap) -> bool {
    match text(headers, header::ORIGIN) {
        "" => is_loopback(text(headers, header::HOST)),
        origin => origin.starts_with("http://"),
    }
}

/// Whether this is a name of the machine itself.
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
