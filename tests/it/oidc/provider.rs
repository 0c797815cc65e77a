//! An identity provider for tests: it describes itself, gives codes to whoever asks, and ID tokens for codes, signed
//! with a key of its own.
//!
//! Main types: [`Provider`], [`Trick`]. Refuses: a code twice, a code without its verifier, and clients that it does
//! not know.

use crate::authority::serve_tls;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::routing::{get, post};
use axum::{Json, Router};
use base64::Engine;
use base64::engine::general_purpose::{STANDARD, URL_SAFE_NO_PAD};
use openidconnect::url::{Url, form_urlencoded};
use rsa::pkcs1v15::SigningKey;
use rsa::rand_core::OsRng;
use rsa::signature::{SignatureEncoding, Signer};
use rsa::traits::PublicKeyParts;
use rsa::{RsaPrivateKey, RsaPublicKey};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::net::TcpListener;
use tokio::task::AbortHandle;

/// What the provider knows the server as.
pub const CLIENT: &str = "giveway";
/// The secret that goes with it.
pub const SECRET: &str = "a secret: with a colon";

/// What an ID token has that it should not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trick {
    None,
    Nonce,
    Key,
    Unsigned,
    Secret,
    Expired,
    Audience,
    Issuer,
}

/// What a code stands for.
struct Asked {
    nonce: String,
    challenge: String,
    redirect: String,
}

struct Books {
    claims: Value,
    trick: Trick,
    codes: BTreeMap<String, Asked>,
}

pub struct Provider {
    pub issuer: String,
    books: Arc<Mutex<Books>>,
    task: AbortHandle,
}

/// Two keys of 2048 bits: that of the provider and that of somebody else.
fn keys() -> &'static [RsaPrivateKey; 2] {
    static KEYS: OnceLock<[RsaPrivateKey; 2]> = OnceLock::new();
    KEYS.get_or_init(|| [(); 2].map(|()| RsaPrivateKey::new(&mut OsRng, 2048).unwrap()))
}

fn base64(bytes: impl AsRef<[u8]>) -> String {
    URL_SAFE_NO_PAD.encode(bytes)
}

impl Provider {
    /// One on a port of its own, at which everybody has these claims.
    pub async fn start(claims: Value) -> Provider {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let issuer = format!("http://{}", listener.local_addr().unwrap());
        let (books, router) = books(&issuer, claims);
        let task = tokio::spawn(async move { axum::serve(listener, router).await.unwrap() }).abort_handle();
        Provider { issuer, books, task }
    }

    /// The same over TLS, with a certificate for `localhost`.
    pub async fn start_tls(claims: Value, config: Arc<rustls::ServerConfig>) -> Provider {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let issuer = format!("https://localhost:{}", listener.local_addr().unwrap().port());
        let (books, router) = books(&issuer, claims);
        let task = tokio::spawn(serve_tls(listener, config, router)).abort_handle();
        Provider { issuer, books, task }
    }

    pub fn give(&self, claims: Value, trick: Trick) {
        let mut books = self.books.lock().unwrap();
        (books.claims, books.trick) = (claims, trick);
    }

    /// What a browser does with the address to which it is sent: its user signs in, and it is sent back. Gives the path
    /// to which it is sent.
    pub fn visit(&self, address: &str) -> String {
        let url = Url::parse(address).unwrap();
        assert!(address.starts_with(&format!("{}/authorize?", self.issuer)), "{address}");
        let asked: BTreeMap<String, String> = url.query_pairs().into_owned().collect();
        assert_eq!((asked["client_id"].as_str(), asked["response_type"].as_str()), (CLIENT, "code"));
        assert_eq!(asked["code_challenge_method"], "S256", "PKCE");
        assert!(asked["scope"].split(' ').any(|scope| scope == "openid"), "{}", asked["scope"]);
        let (nonce, challenge) = (asked["nonce"].clone(), asked["code_challenge"].clone());
        let redirect = asked["redirect_uri"].clone();
        let code = format!("code {}", asked["state"]);
        let query = form_urlencoded::Serializer::new(String::new())
            .append_pair("state", &asked["state"])
            .append_pair("session_state", "what only this provider says")
            .append_pair("iss", &self.issuer)
            .append_pair("code", &code)
            .finish();
        let path = Url::parse(&redirect).unwrap().path().to_owned();
        self.books.lock().unwrap().codes.insert(code, Asked { nonce, challenge, redirect });
        format!("{path}?{query}")
    }
}

impl Drop for Provider {
    fn drop(&mut self) {
        self.task.abort();
    }
}

type Shared = (String, Arc<Mutex<Books>>);

fn books(issuer: &str, claims: Value) -> (Arc<Mutex<Books>>, Router) {
    let books = Arc::new(Mutex::new(Books { claims, trick: Trick::None, codes: BTreeMap::new() }));
    let router = Router::new()
        .route("/.well-known/openid-configuration", get(describe))
        .route("/keys", get(public_keys))
        .route("/token", post(token))
        .with_state((issuer.to_owned(), books.clone()));
    (books, router)
}

async fn describe(State((issuer, _)): State<Shared>) -> Json<Value> {
    Json(json!({
        "issuer": issuer,
        "authorization_endpoint": format!("{issuer}/authorize"),
        "token_endpoint": format!("{issuer}/token"),
        "jwks_uri": format!("{issuer}/keys"),
        "response_types_supported": ["code"],
        "subject_types_supported": ["public"],
        "id_token_signing_alg_values_supported": ["RS256", "HS256", "none"],
    }))
}

async fn public_keys() -> Json<Value> {
    let key = RsaPublicKey::from(&keys()[0]);
    let (n, e) = (base64(key.n().to_bytes_be()), base64(key.e().to_bytes_be()));
    Json(json!({"keys": [{"kty": "RSA", "use": "sig", "alg": "RS256", "kid": "k1", "n": n, "e": e}]}))
}

async fn token(
    State((issuer, books)): State<Shared>,
    headers: HeaderMap,
    body: String,
) -> Result<Json<Value>, (StatusCode, Json<Value>)> {
    let given: BTreeMap<String, String> = form_urlencoded::parse(body.as_bytes()).into_owned().collect();
    let refuse = |why: &str| Err((StatusCode::BAD_REQUEST, Json(json!({ "error": why }))));
    let encoded = |text: &str| form_urlencoded::byte_serialize(text.as_bytes()).collect::<String>();
    let expected = format!("Basic {}", STANDARD.encode(format!("{}:{}", encoded(CLIENT), encoded(SECRET))));
    if headers.get(header::AUTHORIZATION).and_then(|v| v.to_str().ok()) != Some(&expected) {
        return refuse("invalid_client");
    }
    let mut books = books.lock().unwrap();
    let Some(asked) = books.codes.remove(&given["code"]) else { return refuse("invalid_grant") };
    let challenge = base64(Sha256::digest(&given["code_verifier"]));
    if challenge != asked.challenge || given["redirect_uri"] != asked.redirect {
        return refuse("invalid_grant");
    }
    let id_token = id_token(&issuer, &books, &asked.nonce);
    Ok(Json(
        json!({"access_token": "of no use", "token_type": "Bearer", "expires_in": 60, "id_token": id_token}),
    ))
}

fn id_token(issuer: &str, books: &Books, nonce: &str) -> String {
    let trick = books.trick;
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    let end =
        if trick == Trick::Expired { now - Duration::from_secs(3600) } else { now + Duration::from_secs(60) };
    let mut claims = json!({
        "iss": if trick == Trick::Issuer { "https://evil.example" } else { issuer },
        "aud": if trick == Trick::Audience { "somebody-else" } else { CLIENT },
        "nonce": if trick == Trick::Nonce { "another" } else { nonce },
        "sub": "4711",
        "iat": now.as_secs() - 7200,
        "exp": end.as_secs(),
    });
    claims.as_object_mut().unwrap().extend(books.claims.as_object().unwrap().clone());
    let alg = match trick {
        Trick::Unsigned => "none",
        Trick::Secret => "HS256",
        _ => "RS256",
    };
    let head = json!({"alg": alg, "typ": "JWT", "kid": "k1"}).to_string();
    let signed = format!("{}.{}", base64(head), base64(claims.to_string()));
    let key = SigningKey::<Sha256>::new(keys()[usize::from(trick == Trick::Key)].clone());
    let signature = match trick {
        Trick::Unsigned => String::new(),
        // With the secret of the client, which is not only the provider's.
        Trick::Secret => base64(hmac_of(SECRET.as_bytes(), &signed)),
        _ => base64(key.sign(signed.as_bytes()).to_bytes()),
    };
    format!("{signed}.{signature}")
}

fn hmac_of(secret: &[u8], text: &str) -> Vec<u8> {
    use hmac::{Hmac, Mac};
    let mut mac = Hmac::<Sha256>::new_from_slice(secret).unwrap();
    mac.update(text.as_bytes());
    mac.finalize().into_bytes().to_vec()
}
