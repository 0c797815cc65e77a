//! HTTPS: a client that trusts the certificate which the server made, and clients that should not get in.

use crate::helper::{Folder, config, floor, in_time};
use giveway::server::{Config, Server};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, RootCertStore};
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;

/// One request by a client that trusts this certificate and expects this name.
async fn ask(at: SocketAddr, trusted: &Path, name: &'static str, request: &str) -> std::io::Result<String> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(trusted).unwrap()).unwrap();
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let client = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions().unwrap();
    let connector = TlsConnector::from(Arc::new(client.with_root_certificates(roots).with_no_client_auth()));
    let stream = TcpStream::connect(at).await?;
    let mut stream = connector.connect(ServerName::try_from(name).unwrap(), stream).await?;
    stream.write_all(request.as_bytes()).await?;
    let mut answer = Vec::new();
    let read = stream.read_to_end(&mut answer).await;
    let text = String::from_utf8_lossy(&answer).into_owned();
    // A server may hang up without a farewell once it has answered.
    if text.is_empty() { read.map(|_| text) } else { Ok(text) }
}

const HEALTH: &str = "GET /v1/health HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_trusts_the_made_certificate_is_served_and_others_are_not() {
    let folder = Folder::new();
    let server = Server::start(&Config { tls: true, ..config(&folder) }, floor()).await.unwrap();
    let (at, identity) = (server.address(), server.identity().unwrap().clone());
    assert!(identity.certificate.starts_with(folder.path()));
    let silent = TcpStream::connect(at).await.unwrap();
    let answer = ask(at, &identity.certificate, "localhost", HEALTH).await.unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    drop(silent);
    let foreign = ask(at, &identity.certificate, "floor.example", HEALTH).await.unwrap_err();
    assert!(foreign.to_string().contains("certificate"), "{foreign}");

    let upgrade = "GET /v1/live HTTP/1.1\r\nhost: localhost\r\nconnection: Upgrade\r\nupgrade: websocket\r\n\
        sec-websocket-version: 13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    let live = tokio::spawn({
        let certificate = identity.certificate.clone();
        async move { ask(at, &certificate, "localhost", upgrade).await }
    });
    let mut plain = TcpStream::connect(at).await.unwrap();
    plain.write_all(HEALTH.as_bytes()).await.unwrap();
    let mut answer = [0; 12];
    plain.read_exact(&mut answer).await.unwrap();
    assert_eq!(&answer, b"HTTP/1.1 400", "plain HTTP is told to use https");

    let mut stranger = TcpStream::connect(at).await.unwrap();
    stranger.write_all(&[22, 3, 1, 0, 5, 1, 2, 3, 4, 5]).await.unwrap();
    // How it ends is the server's choice; that it ends, and that others are served below, is not.
    let _ = stranger.read_to_end(&mut Vec::new()).await;

    let metrics = "GET /metrics HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";
    let open = async {
        while !ask(at, &identity.certificate, "localhost", metrics).await?.contains("giveway_live_clients 1")
        {
        }
        std::io::Result::Ok(())
    };
    in_time("the live feed opens", open).await.unwrap();
    server.stop().await.unwrap();
    let feed = live.await.unwrap().unwrap();
    assert!(feed.starts_with("HTTP/1.1 101") && feed.contains("snapshot"), "a WebSocket goes over TLS, too");

    let again = Server::start(&Config { tls: true, ..config(&folder) }, floor()).await.unwrap();
    assert_eq!(again.identity().unwrap().fingerprint, identity.fingerprint, "the certificate stays");
    again.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn certificates_that_cannot_be_used_keep_the_server_from_starting_with_words() {
    let folder = Folder::new();
    let text = folder.path().join("text.pem");
    std::fs::write(&text, "no certificate").unwrap();
    let given = |certificate: &Path| Config {
        tls_cert: Some(certificate.into()),
        tls_key: Some(text.clone()),
        ..config(&folder)
    };
    for (certificate, word) in
        [(text.as_path(), "holds no certificate"), (Path::new("/no/such.pem"), "/no/such.pem")]
    {
        let Err(error) = Server::start(&given(certificate), floor()).await else { panic!("it started") };
        assert!(format!("{error:#}").contains(word), "{error:#}");
    }
}
