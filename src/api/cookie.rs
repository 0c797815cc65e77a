//! The cookie that stands for a session: its name, how it is read, set and taken back.
//!
//! Main functions: [`session_secret`], [`session_cookie`], [`no_session_cookie`]. Refuses: to send a cookie to another
//! site, to scripts, and in the clear where the page came over HTTPS.

use axum::http::{HeaderMap, header};

/// How the name of the cookie begins.
const NAME: &str = "giveway_session";

/// The name of the cookie at the address that was asked. Browsers do not tell ports apart, so the name does: two
/// servers on one machine do not sign each other's users out.
fn cookie_name(headers: &HeaderMap) -> String {
    match text(headers, header::HOST).rsplit_once(':') {
        Some((_, port)) if !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => {
            format!("{NAME}_{port}")
        }
        _ => NAME.into(),
    }
}

/// What the cookie of a request says.
pub fn session_secret(headers: &HeaderMap) -> Option<&str> {
    let name = cookie_name(headers);
    let sent = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
    let mut pairs = sent.flat_map(|all| all.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(n, _)| *n == name).map(|(_, secret)| secret)
}

/// The header that gives a browser its cookie. It ends with the browser; the server ends the session after its time.
pub fn session_cookie(headers: &HeaderMap, secret: &str) -> String {
    let secure = if is_plain(headers) { "" } else { "; Secure" };
    format!("{}={secret}; Path=/; HttpOnly; SameSite=Strict{secure}", cookie_name(headers))
}

/// The header that takes the cookie back.
pub fn no_session_cookie(headers: &HeaderMap) -> String {
    format!("{}; Max-Age=0", session_cookie(headers, ""))
}

/// Whether the page came over plain HTTP, and a browser would not keep a `Secure` cookie of it. Browsers say in
/// `Origin` how they got the page, also where a proxy speaks TLS; a client that does not say is trusted on this
/// machine alone.
fn is_plain(headers: &HeaderMap) -> bool {
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
            let cookie = session_cookie(&headers(pairs), "x");
            assert_eq!(cookie.ends_with("; Secure"), secure, "{cookie}");
            assert!(cookie.contains("; Path=/; HttpOnly; SameSite=Strict"), "{cookie}");
        }
    }
}
