//! Signing in with an identity provider: the way there and back, and everything that must not sign anybody in.

mod provider;

use crate::authority::Authority;
use crate::helper::{Answer, Folder, config, eventually, floor, send};
use crate::tokens::{ADMIN, with};
use giveway::api::{OidcSettings, Role};
use giveway::server::{Config, Server};
use openidconnect::ClientSecret;
use provider::{CLIENT, Provider, SECRET, Trick};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// A shift leader.
fn anna() -> Value {
    json!({"preferred_username": "anna", "name": "Anna B.", "groups": ["everybody", "shift-leads"]})
}

fn settings(issuer: &str) -> OidcSettings {
    let text = json!({
        "issuer": issuer,
        "client_id": CLIENT,
        "label": "the test's provider",
        "session_hours": 2,
        "roles": {"shift-leads": "operator", "it": "admin"},
    });
    let settings: OidcSettings = serde_json::from_value(text).unwrap();
    OidcSettings { client_secret: Some(ClientSecret::new(SECRET.into())), ..settings }
}

async fn start(folder: &Folder, issuer: &str, ca_file: Option<PathBuf>) -> Server {
    let oidc = Some(settings(issuer));
    let config = Config { token: Some(ADMIN.into()), oidc, ca_file, ..config(folder) };
    Server::start(&config, floor()).await.unwrap()
}

/// A browser, as far as cookies go.
#[derive(Default)]
struct Browser {
    cookies: Vec<(String, String)>,
}

impl Browser {
    fn cookie(&self) -> String {
        self.cookies.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join("; ")
    }

    async fn ask(
        &mut self,
        at: SocketAddr,
        method: &str,
        path: &str,
        more: &[(&str, &str)],
        body: &str,
    ) -> Answer {
        let cookie = self.cookie();
        let mut headers = vec![("cookie", cookie.as_str())];
        headers.extend((!body.is_empty()).then_some(("content-type", "application/json")));
        headers.extend(more);
        let answer = send(at, method, path, &headers, body).await.unwrap();
        for (_, set) in answer.headers.iter().filter(|(name, _)| name == "set-cookie") {
            let (name, value) = set.split(';').next().unwrap().split_once('=').unwrap();
            self.cookies.retain(|(known, _)| known != name);
            if !set.contains("Max-Age=0") {
                self.cookies.push((name.into(), value.into()));
            }
        }
        answer
    }

    /// The page to sign in sends the browser away: where to.
    async fn set_off(&mut self, at: SocketAddr, back: &str) -> String {
        let body = json!({ "back": back }).to_string();
        let own = format!("http://{at}");
        let begun = self.ask(at, "POST", "/v1/session/oidc", &[("origin", &own)], &body).await;
        assert_eq!(begun.status, 200, "{begun:?}");
        begun.json()["address"].as_str().unwrap().to_owned()
    }

    /// The provider sends the browser back, as from another site: to which page it is led on.
    async fn come_back(&mut self, at: SocketAddr, path: &str) -> String {
        let answer = self.ask(at, "GET", path, &[("sec-fetch-site", "cross-site")], "").await;
        assert_eq!(answer.status, 303, "{answer:?}");
        answer.header("location").unwrap().to_owned()
    }

    async fn sign_in(&mut self, at: SocketAddr, provider: &Provider) -> String {
        let address = self.set_off(at, "/?view=1").await;
        self.come_back(at, &provider.visit(&address)).await
    }

    async fn who(&mut self, at: SocketAddr) -> Option<Value> {
        let answer = self.ask(at, "GET", "/v1/session", &[], "").await;
        (answer.status == 200).then(|| answer.json())
    }
}

/// Who signed in and out, by the audit, oldest first.
async fn signed(at: SocketAddr, wanted: usize) -> Vec<(String, String, String)> {
    eventually(&format!("the audit has {wanted} entries"), async || {
        let listed = with(at, ADMIN, "GET", "/v1/audit", "").await.json();
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let items = listed["items"].as_array().unwrap().iter().rev();
        let found: Vec<_> = items.map(|e| (text(e, "actor"), text(e, "role"), text(e, "what"))).collect();
        (found.len() >= wanted).then_some(found)
    })
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn who_signs_in_with_the_provider_has_the_role_of_the_group_and_is_named_in_the_audit() {
    let folder = Folder::new();
    let provider = Provider::start(anna()).await;
    let server = start(&folder, &provider.issuer, None).await;
    let at = server.address();
    let mut browser = Browser::default();
    let named = browser.ask(at, "GET", "/v1/session/oidc", &[], "").await.json();
    assert_eq!(named, json!({"name": "the test's provider"}));
    assert_eq!(browser.who(at).await, None);
    assert_eq!(browser.sign_in(at, &provider).await, "/?view=1", "back to where one was");
    assert_eq!(
        browser.cookies.len(),
        1,
        "one for the session; that of the way is over: {:?}",
        browser.cookies
    );
    let me = browser.who(at).await.expect("signed in");
    assert_eq!(
        (&me["name"], &me["role"], &me["by"]),
        (&json!("anna"), &json!("operator"), &json!("session"))
    );
    let end = giveway::api::wire::text::parse_time(me["expires"].as_str().unwrap()).unwrap();
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs_f64();
    let hours = (end.as_secs_f64() - now) / 3600.0;
    assert!((1.9..2.1).contains(&hours), "a session ends after two hours: {hours}");

    let own = format!("http://{at}");
    let stop = browser.ask(at, "POST", "/v1/fleet/stop", &[("origin", &own)], "").await;
    assert_eq!(stop.status, 204, "{stop:?}");
    browser.ask(at, "POST", "/v1/fleet/resume", &[("origin", "http://evil.example")], "").await.problem(403);
    browser.ask(at, "GET", "/v1/tokens", &[], "").await.problem(403);
    server.stop().await.unwrap();

    let listen = at.to_string();
    let again = Config {
        token: Some(ADMIN.into()),
        oidc: Some(settings(&provider.issuer)),
        listen,
        ..config(&folder)
    };
    let server = Server::start(&again, floor()).await.unwrap();
    assert_eq!(browser.who(at).await.expect("over a restart")["name"], "anna");
    let out = browser.ask(at, "DELETE", "/v1/session", &[("origin", &own)], "").await;
    assert_eq!((out.status, browser.who(at).await), (204, None));
    let of = |what: &str| ("anna".to_owned(), "operator".to_owned(), what.to_owned());
    let whole = signed(at, 3).await;
    assert_eq!(
        whole,
        [of("GET /v1/session/oidc/callback"), of("POST /v1/fleet/stop"), of("DELETE /v1/session")]
    );
    server.stop().await.unwrap();

    let without = Config { oidc: None, ..again };
    let mut browser = Browser::default();
    let server = Server::start(&without, floor()).await.unwrap();
    let body = json!({}).to_string();
    browser.ask(at, "POST", "/v1/session/oidc", &[("origin", &own)], &body).await.problem(404);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_id_token_that_is_not_what_it_should_be_signs_nobody_in() {
    let folder = Folder::new();
    let provider = Provider::start(anna()).await;
    let server = start(&folder, &provider.issuer, None).await;
    let at = server.address();
    for trick in [
        Trick::Nonce,
        Trick::Key,
        Trick::Unsigned,
        Trick::Secret,
        Trick::Expired,
        Trick::Audience,
        Trick::Issuer,
    ] {
        provider.give(anna(), trick);
        let mut browser = Browser::default();
        let page = browser.sign_in(at, &provider).await;
        assert_eq!(page, "/sign-in?refused=untrusted&back=/%3Fview%3D1", "{trick:?}");
        assert!(
            browser.cookies.is_empty() && browser.who(at).await.is_none(),
            "{trick:?}: {:?}",
            browser.cookies
        );
    }
    provider.give(anna(), Trick::None);
    let mut browser = Browser::default();
    browser.sign_in(at, &provider).await;
    assert!(browser.who(at).await.is_some(), "without tricks it works");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn who_has_no_group_with_a_role_is_refused_in_words() {
    let folder = Folder::new();
    let provider = Provider::start(json!({"preferred_username": "eve", "groups": ["everybody"]})).await;
    let server = start(&folder, &provider.issuer, None).await;
    let at = server.address();
    let mut browser = Browser::default();
    assert_eq!(browser.sign_in(at, &provider).await, "/sign-in?refused=no_role&back=/%3Fview%3D1");
    assert_eq!(browser.who(at).await, None);
    provider.give(json!({"preferred_username": "eve"}), Trick::None);
    assert!(browser.sign_in(at, &provider).await.contains("no_role"), "no groups at all");
    provider.give(json!({"preferred_username": "eve", "groups": ["it", "shift-leads"]}), Trick::None);
    browser.sign_in(at, &provider).await;
    assert_eq!(browser.who(at).await.unwrap()["role"], "admin", "the strongest of several");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_way_back_is_for_one_browser_and_one_time() {
    let folder = Folder::new();
    let provider = Provider::start(anna()).await;
    let server = start(&folder, &provider.issuer, None).await;
    let at = server.address();
    let mut browser = Browser::default();
    let address = browser.set_off(at, "//evil.example/").await;
    let back = provider.visit(&address);

    let mut other = Browser::default();
    assert_eq!(
        other.come_back(at, &back).await,
        "/sign-in?refused=stale&back=/",
        "a browser without the cookie"
    );
    other.set_off(at, "/").await;
    assert_eq!(other.come_back(at, &back).await, "/sign-in?refused=stale&back=/", "another browser");
    assert_eq!(other.who(at).await, None);

    let kept = browser.cookies.clone();
    assert_eq!(browser.come_back(at, &back).await, "/", "never on to another site");
    assert!(browser.who(at).await.is_some());
    let mut again = Browser { cookies: kept };
    assert_eq!(again.come_back(at, &back).await, "/sign-in?refused=stale&back=/", "a state that was used");
    let invented = "/v1/session/oidc/callback?state=invented&code=x";
    assert_eq!(again.come_back(at, invented).await, "/sign-in?refused=stale&back=/");
    let denied = again.set_off(at, "/").await;
    let state = denied.split("state=").nth(1).unwrap().split('&').next().unwrap();
    let path = format!("/v1/session/oidc/callback?state={state}&error=access_denied");
    assert_eq!(again.come_back(at, &path).await, "/sign-in?refused=denied&back=/");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn while_the_provider_is_down_tokens_sign_in_and_the_error_says_so() {
    let folder = Folder::new();
    let provider = Provider::start(anna()).await;
    let server = start(&folder, &provider.issuer, None).await;
    let at = server.address();
    let mut browser = Browser::default();
    let way_back = provider.visit(&browser.set_off(at, "/").await);
    drop(provider);
    let own = format!("http://{at}");
    assert_eq!(browser.come_back(at, &way_back).await, "/sign-in?refused=unreachable&back=/");
    // What is known of the provider lasts for ten seconds.
    tokio::time::sleep(Duration::from_secs(11)).await;
    let refused = browser.ask(at, "POST", "/v1/session/oidc", &[("origin", &own)], "{}").await.problem(503);
    let detail = refused["detail"].as_str().unwrap();
    assert!(detail.contains("the test's provider") && detail.contains("Sign in with a token"), "{detail}");
    let body = json!({ "token": ADMIN }).to_string();
    let answer = browser.ask(at, "POST", "/v1/session", &[("origin", &own)], &body).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    assert_eq!(browser.who(at).await.unwrap()["name"], "configuration");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_provider_with_a_certificate_of_a_private_authority_needs_the_setting_ca_file() {
    let folder = Folder::new();
    let authority = Authority::new(folder.path());
    let provider = Provider::start_tls(anna(), authority.server_config()).await;
    let server = start(&folder, &provider.issuer, None).await;
    let mut browser = Browser::default();
    let own = format!("http://{}", server.address());
    let begun = browser.ask(server.address(), "POST", "/v1/session/oidc", &[("origin", &own)], "{}").await;
    begun.problem(503);
    server.stop().await.unwrap();
    let server = start(&folder, &provider.issuer, Some(authority.file.clone())).await;
    browser.sign_in(server.address(), &provider).await;
    assert_eq!(browser.who(server.address()).await.expect("signed in")["name"], "anna");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_with_a_provider_is_closed_and_wrong_settings_keep_it_from_starting_with_words() {
    let folder = Folder::new();
    let only = Config { oidc: Some(settings("http://127.0.0.1:9")), ..config(&folder) };
    let server = Server::start(&only, floor()).await.unwrap();
    send(server.address(), "GET", "/v1/robots", &[], "").await.unwrap().problem(401);
    server.stop().await.unwrap();
    let device =
        OidcSettings { roles: [("x".to_owned(), Role::Device)].into(), ..settings("https://login.example") };
    for (wrong, word) in [
        (Config { oidc: Some(settings("http://login.example")), ..config(&folder) }, "oidc.issuer"),
        (Config { oidc: Some(device), ..config(&folder) }, "oidc.roles"),
        (Config { ca_file: Some("/no/such.pem".into()), ..config(&folder) }, "/no/such.pem"),
    ] {
        let Err(error) = Server::start(&wrong, floor()).await else { panic!("{word}: it started") };
        assert!(format!("{error:#}").contains(word), "{error:#}");
    }
}
