//! Signing in with an identity provider: OpenID Connect, by the authorization code flow with PKCE.
//!
//! Main types: [`Oidc`], [`SignedOn`], [`OidcRefusal`]. The provider's metadata is fetched anew for each sign-on,
//! unless it is only seconds old, so changed keys are known at once. Only the ID token signs a person in: its
//! signature, issuer, audience, expiry and nonce are verified. Refuses: to keep any token of the provider.

mod claims;
mod pending;
mod settings;

pub use pending::SIGN_ON_LIFE;
pub use settings::OidcSettings;

use crate::access::auth::{fresh_token, hash_of};
use crate::access::caller::Role;
use crate::outgoing::{Outgoing, failure};
use axum::http::Request;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use chrono::{DateTime, Utc};
use giveway_floor::time::{Span, Time};
use openidconnect::core::{
    CoreAuthenticationFlow, CoreClient, CoreIdToken, CoreJwsSigningAlgorithm, CoreProviderMetadata,
};
use openidconnect::{
    AuthorizationCode, ClientId, CsrfToken, EndpointMaybeSet, EndpointNotSet, EndpointSet, HttpRequest,
    HttpResponse, IssuerUrl, Nonce, PkceCodeChallenge, RedirectUrl, Scope, TokenResponse,
};
use pending::{PendingSignOn, PendingSignOns};
use serde_json::{Map, Value};
use std::error::Error;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use ureq::Agent;

/// How long the server waits for an answer of the provider.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long the provider's metadata is used before it is fetched again.
const FRESH: Span = Span::from_secs(10);

/// How far the clocks of the provider and this server may differ.
const LEEWAY: Span = Span::from_secs(60);

/// The longest answer of the provider, in bytes.
const LONGEST_ANSWER: u64 = 1024 * 1024;

/// Allowed signatures of an ID token: asymmetric ones, made with a private key that only the provider has.
const SIGNED: [CoreJwsSigningAlgorithm; 9] = [
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha256,
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha384,
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha512,
    CoreJwsSigningAlgorithm::RsaSsaPssSha256,
    CoreJwsSigningAlgorithm::RsaSsaPssSha384,
    CoreJwsSigningAlgorithm::RsaSsaPssSha512,
    CoreJwsSigningAlgorithm::EcdsaP256Sha256,
    CoreJwsSigningAlgorithm::EcdsaP384Sha384,
    CoreJwsSigningAlgorithm::EdDsa,
];

/// The provider's client, with the endpoints that its metadata must name.
type ProviderClient = CoreClient<
    EndpointSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointMaybeSet,
    EndpointMaybeSet,
>;

/// An identity provider.
pub struct Oidc {
    settings: OidcSettings,
    issuer: IssuerUrl,
    agent: Agent,
    pending: Mutex<PendingSignOns>,
    /// The provider's metadata and when they were fetched. One task fetches them; the others wait for the result.
    provider: tokio::sync::Mutex<Option<(Time, CoreProviderMetadata)>>,
}

/// Where to send the browser to sign on.
#[derive(Debug)]
pub struct AuthorizationRequest {
    /// The address at the provider.
    pub address: String,
    /// The value of the browser's cookie.
    pub secret: String,
}

/// What a browser brings back from the provider.
#[derive(Debug)]
pub struct AuthorizationResponse {
    /// The `state` of the sign-on to which the response belongs.
    pub state: Option<String>,
    /// The authorization code, which the provider exchanges for an ID token.
    pub code: Option<String>,
    /// The provider's error, if it refused.
    pub error: Option<String>,
    /// The issuer, as the provider names itself.
    pub issuer: Option<String>,
}

/// A person who has signed in.
#[derive(Debug, PartialEq, Eq)]
pub struct SignedOn {
    /// The person's name.
    pub name: String,
    /// The role that the person's groups give.
    pub role: Role,
    /// When the session ends.
    pub expires: Time,
    /// The page to show next.
    pub back: String,
    /// Whether the browser connected over plain HTTP.
    pub plain: bool,
}

/// Why a sign-on failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OidcRefusal {
    /// The sign-on took too long, was already finished, or was begun in another browser or before a server restart.
    Stale,
    /// The provider or the person refused.
    Denied,
    /// The provider does not answer, or its answer is invalid.
    Unreachable,
    /// The ID token is missing or invalid.
    Untrusted,
    /// None of the person's groups has a role.
    NoRole,
}

impl OidcRefusal {
    /// The word for this refusal in addresses.
    pub fn word(self) -> &'static str {
        match self {
            OidcRefusal::Stale => "stale",
            OidcRefusal::Denied => "denied",
            OidcRefusal::Unreachable => "unreachable",
            OidcRefusal::Untrusted => "untrusted",
            OidcRefusal::NoRole => "no_role",
        }
    }
}

impl Oidc {
    /// An identity provider with these settings.
    ///
    /// # Errors
    /// If a setting is wrong; the text names it.
    pub fn new(settings: OidcSettings, outgoing: &Outgoing) -> Result<Oidc, String> {
        let settings = settings.complete()?;
        let issuer = IssuerUrl::new(settings.issuer.clone()).map_err(|e| format!("oidc.issuer: {e}"))?;
        let (pending, provider) = (Mutex::default(), tokio::sync::Mutex::default());
        Ok(Oidc { settings, issuer, agent: outgoing.agent(PATIENCE), pending, provider })
    }

    /// The provider's display name.
    pub fn name(&self) -> String {
        self.settings.name()
    }

    /// Where the provider is to send browsers back to, if the settings say so.
    pub fn redirect(&self) -> Option<&str> {
        self.settings.redirect.as_deref()
    }

    /// Begins a sign-on: the provider will send the browser to `redirect`, which leads on to the page `back`.
    ///
    /// # Errors
    /// If the provider's metadata cannot be fetched, or `redirect` is no address. The reason is in the log.
    pub async fn begin(
        &self,
        redirect: String,
        back: String,
        now: Time,
    ) -> Result<AuthorizationRequest, OidcRefusal> {
        let provider = self.provider(now).await?;
        let redirect = RedirectUrl::new(redirect).map_err(|e| refuse(OidcRefusal::Stale, &e))?;
        let client = self.client(provider, redirect.clone());
        let (challenge, verifier) = PkceCodeChallenge::new_random_sha256();
        let flow = CoreAuthenticationFlow::AuthorizationCode;
        let scopes = self.settings.scopes.iter().cloned().map(Scope::new);
        let (address, state, nonce) = client
            .authorize_url(flow, CsrfToken::new_random, Nonce::new_random)
            .add_scopes(scopes)
            .set_pkce_challenge(challenge)
            .url();
        let secret = fresh_token();
        let sign_on = PendingSignOn { cookie: hash_of(&secret), nonce, verifier, redirect, back, began: now };
        self.pending().add(state.into_secret(), sign_on);
        Ok(AuthorizationRequest { address: address.into(), secret })
    }

    /// Finishes a sign-on, in a browser that has come back from the provider with this cookie.
    ///
    /// # Errors
    /// Why the sign-on failed, and the page that was to come next, if known. The exact reason is in the log.
    pub async fn finish(
        &self,
        given: AuthorizationResponse,
        cookie: Option<&str>,
        now: Time,
    ) -> Result<SignedOn, (OidcRefusal, Option<String>)> {
        let state = given.state.as_deref().zip(cookie);
        let sign_on = state.and_then(|(state, secret)| self.pending().take(state, &hash_of(secret), now));
        let Some(sign_on) = sign_on else { return Err((OidcRefusal::Stale, None)) };
        let (back, plain) = (sign_on.back.clone(), sign_on.redirect.url().scheme() == "http");
        match self.verified(given, sign_on, now).await {
            Ok((name, role)) => {
                let life = Span::from_secs(i64::from(self.settings.session_hours) * 3600);
                Ok(SignedOn { name, role, expires: now + life, back, plain })
            }
            Err(why) => Err((why, Some(back))),
        }
    }

    /// The name and role of the person who came back, verified with the provider.
    async fn verified(
        &self,
        given: AuthorizationResponse,
        sign_on: PendingSignOn,
        now: Time,
    ) -> Result<(String, Role), OidcRefusal> {
        if let Some(error) = given.error {
            tracing::warn!("the identity provider refused somebody: {error:?}");
            return Err(OidcRefusal::Denied);
        }
        let other = given.issuer.filter(|issuer| *issuer != self.settings.issuer);
        let (Some(code), None) = (given.code, other) else {
            tracing::warn!("somebody came back without a code, or from another identity provider");
            return Err(OidcRefusal::Untrusted);
        };
        let client = self.client(self.provider(now).await?, sign_on.redirect.clone());
        let agent = self.agent.clone();
        let exchange = move || exchange(&client, &agent, code, sign_on, now);
        let claims = tokio::task::spawn_blocking(exchange).await;
        let claims = claims.map_err(|e| refuse(OidcRefusal::Unreachable, &e))??;
        let name = claims::name_of(&claims, &self.settings);
        match claims::role_of(&claims, &self.settings) {
            Some(role) => Ok((name, role)),
            None => {
                let claim = &self.settings.groups_claim;
                tracing::warn!("{name} has no group in {claim:?} to which `oidc.roles` gives a role");
                Err(OidcRefusal::NoRole)
            }
        }
    }

    /// The provider's metadata with its keys, fetched again if they are too old.
    async fn provider(&self, now: Time) -> Result<CoreProviderMetadata, OidcRefusal> {
        let mut known = self.provider.lock().await;
        if let Some((_, provider)) = known.as_ref().filter(|(at, _)| now - *at < FRESH) {
            return Ok(provider.clone());
        }
        let (issuer, agent) = (self.issuer.clone(), self.agent.clone());
        let discover = move || CoreProviderMetadata::discover(&issuer, &|request| send(&agent, request));
        let found = tokio::task::spawn_blocking(discover).await;
        let found = found.map_err(|e| refuse(OidcRefusal::Unreachable, &e))?;
        let found = found.map_err(|e| refuse(OidcRefusal::Unreachable, &e))?;
        *known = Some((now, found.clone()));
        Ok(found)
    }

    fn client(&self, provider: CoreProviderMetadata, redirect: RedirectUrl) -> ProviderClient {
        let (id, secret) =
            (ClientId::new(self.settings.client_id.clone()), self.settings.client_secret.clone());
        // If the provider names no token endpoint, the exchange fails with a message about it.
        CoreClient::from_provider_metadata(provider, id, secret).set_redirect_uri(redirect)
    }

    fn pending(&self) -> MutexGuard<'_, PendingSignOns> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Exchanges the authorization code for an ID token and verifies the token.
fn exchange(
    client: &ProviderClient,
    agent: &Agent,
    code: String,
    sign_on: PendingSignOn,
    now: Time,
) -> Result<Map<String, Value>, OidcRefusal> {
    let request = client.exchange_code(AuthorizationCode::new(code));
    let request =
        request.map_err(|e| refuse(OidcRefusal::Unreachable, &e))?.set_pkce_verifier(sign_on.verifier);
    let answer = request.request(&|request| send(agent, request));
    let answer = answer.map_err(|e| refuse(OidcRefusal::Unreachable, &e))?;
    let Some(token) = answer.id_token() else {
        tracing::warn!("the identity provider gave no ID token: its client must allow the scope `openid`");
        return Err(OidcRefusal::Untrusted);
    };
    let earlier = move || instant(now + Span(-LEEWAY.0));
    let verifier = client.id_token_verifier().set_allowed_algs(SIGNED).set_time_fn(earlier);
    token.claims(&verifier, &sign_on.nonce).map_err(|e| refuse(OidcRefusal::Untrusted, &e))?;
    payload(token).ok_or(OidcRefusal::Untrusted)
}

/// All claims of a verified token, including those that no specification names.
fn payload(token: &CoreIdToken) -> Option<Map<String, Value>> {
    let text = token.to_string();
    let bytes = URL_SAFE_NO_PAD.decode(text.split('.').nth(1)?).ok()?;
    serde_json::from_slice(&bytes).ok()
}

fn instant(t: Time) -> DateTime<Utc> {
    DateTime::from_timestamp_micros(t.0).unwrap_or_default()
}

/// A request to the provider failed.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct ProviderHttpError(String);

fn send(agent: &Agent, request: HttpRequest) -> Result<HttpResponse, ProviderHttpError> {
    let said = |e: ureq::Error| ProviderHttpError(failure(&e));
    let (parts, body) = request.into_parts();
    let answer = if body.is_empty() {
        agent.run(Request::from_parts(parts, ()))
    } else {
        agent.run(Request::from_parts(parts, body))
    };
    let (parts, mut body) = answer.map_err(said)?.into_parts();
    let body = body.with_config().limit(LONGEST_ANSWER).read_to_vec().map_err(said)?;
    Ok(HttpResponse::from_parts(parts, body))
}

/// Logs the error with all its causes; the person is told only the kind of refusal.
fn refuse(how: OidcRefusal, e: &(dyn Error + 'static)) -> OidcRefusal {
    let (mut said, mut cause) = (e.to_string(), e.source());
    while let Some(e) = cause {
        said += &format!(": {e}");
        cause = e.source();
    }
    tracing::warn!("signing in with the identity provider: {said}");
    how
}
