//! Pages of other sites that the settings allow to use the API.

use crate::helper::{Answer, Folder, config, floor, send};
use giveway::server::{Config, Server};

#[tokio::test]
async fn pages_of_allowed_origins_may_ask_and_others_may_not() {
    let folder = Folder::new();
    let config = Config { allowed_origins: vec!["https://wms.example".into()], ..config(&folder) };
    let server = Server::start(&config, floor()).await.unwrap();
    let at = server.address();
    let ask = async |method: &'static str, origin: &'static str| {
        let headers = [
            ("origin", origin),
            ("sec-fetch-site", "cross-site"),
            ("access-control-request-method", "POST"),
            ("access-control-request-headers", "authorization,content-type,idempotency-key"),
        ];
        send(at, method, "/v1/jobs", &headers, "").await.unwrap()
    };
    let allowed = |answer: &Answer| answer.header("access-control-allow-origin").map(str::to_owned);
    let asked = ask("OPTIONS", "https://wms.example").await;
    assert_eq!(asked.status, 200, "{asked:?}");
    assert_eq!(allowed(&asked).as_deref(), Some("https://wms.example"));
    assert!(asked.header("access-control-allow-headers").is_some_and(|h| h.contains("idempotency-key")));
    assert_eq!(asked.header("access-control-allow-credentials"), None);
    let listed = ask("GET", "https://wms.example").await;
    assert_eq!((listed.status, allowed(&listed).as_deref()), (200, Some("https://wms.example")));
    let other = ask("GET", "https://evil.example").await;
    assert_eq!((other.status, allowed(&other)), (403, None));
    assert_eq!(allowed(&ask("OPTIONS", "https://evil.example").await), None);
    server.stop().await.unwrap();
}
