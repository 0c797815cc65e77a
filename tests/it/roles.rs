//! What each role may, over HTTP and WebSocket.

use crate::helper::{Folder, delivery, eventually};
use crate::tokens::{ADMIN, make, start_closed, until_robots, with};
use serde_json::json;
use tokio_tungstenite::tungstenite::Error;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

#[tokio::test(flavor = "multi_thread")]
async fn each_role_does_what_it_may_and_is_told_which_other_one_is_needed() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    until_robots(at, ADMIN).await;
    let mut tokens = Vec::new();
    for role in ["viewer", "operator", "integrator"] {
        tokens.push(make(at, role, role, None).await["token"].as_str().unwrap().to_owned());
    }
    let [viewer, operator, integrator] = &tokens[..] else { panic!("three tokens") };
    let job = delivery(0).to_string();
    for (method, path, body, allowed) in [
        ("GET", "/v1/robots", "", [200, 200, 200]),
        ("GET", "/metrics", "", [200, 200, 200]),
        ("POST", "/v1/fleet/stop", "", [403, 204, 403]),
        ("POST", "/v1/fleet/resume", "", [403, 204, 403]),
        ("POST", "/v1/robots/robot-1/pause", "", [403, 204, 403]),
        ("POST", "/v1/jobs", job.as_str(), [403, 201, 201]),
        ("DELETE", "/v1/jobs/j99", "", [403, 404, 404]),
        ("POST", "/v1/workers", r#"{"name": "anna"}"#, [403, 403, 403]),
        ("GET", "/v1/tokens", "", [403, 403, 403]),
    ] {
        for (token, status) in [viewer, operator, integrator].into_iter().zip(allowed) {
            let answer = with(at, token, method, path, body).await;
            assert_eq!(answer.status, status, "{method} {path}: {answer:?}");
        }
    }
    for (token, may, may_not) in [
        (viewer, "sign_out", "stop_fleet"),
        (operator, "submit_job", "publish_map"),
        (operator, "evacuate", "make_token"),
        (integrator, "submit_jobs", "evacuate"),
    ] {
        let said = with(at, token, "GET", "/v1/session", "").await.json();
        let acts = said["may"].as_array().unwrap();
        assert!(acts.contains(&json!(may)) && !acts.contains(&json!(may_not)), "{said}");
    }
    let refused = with(at, viewer, "POST", "/v1/fleet/stop", "").await.problem(403);
    assert!(refused["detail"].as_str().unwrap().contains("needs the role operator or admin"), "{refused}");
    assert_eq!(refused["type"], "/problems/role");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_device_speaks_for_its_own_worker_alone() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    for name in ["anna", "ben"] {
        let body = json!({"name": name}).to_string();
        assert_eq!(with(at, ADMIN, "POST", "/v1/workers", &body).await.status, 201);
    }
    // The next picture has them.
    let body = json!({"name": "headset 1", "role": "device", "subject": "w1"}).to_string();
    let is_made = async || {
        let made = with(at, ADMIN, "POST", "/v1/tokens", &body).await;
        (made.status == 201).then(|| made.json()["token"].as_str().unwrap().to_owned())
    };
    let token = eventually("there is a token for the device", is_made).await;
    let open = async |worker: &str| {
        let mut request = format!("ws://{at}/v1/workers/{worker}/feed").into_client_request().unwrap();
        request
            .headers_mut()
            .insert("sec-websocket-protocol", format!("giveway, bearer.{token}").parse().unwrap());
        tokio_tungstenite::connect_async(request).await
    };
    assert!(open("w1").await.is_ok());
    let Err(Error::Http(refused)) = open("w2").await else { panic!("the other worker's feed") };
    assert_eq!(refused.status(), 403);
    let sign_in = async |name: &str| {
        with(at, &token, "POST", "/v1/workers", &json!({ "name": name }).to_string()).await
    };
    let signed_in = sign_in("anna").await;
    assert_eq!(
        (signed_in.status, &signed_in.json()["id"]),
        (200, &json!("w1")),
        "as the headset's page does"
    );
    let leave = async |worker: &str| {
        with(at, &token, "POST", &format!("/v1/workers/{worker}/clear"), r#"{"by": "anna"}"#).await
    };
    assert_ne!(leave("w1").await.status, 403, "the wearer says that nobody is there any more");
    leave("w2").await.problem(403);
    sign_in("ben").await.problem(403);
    sign_in("carl").await.problem(403);
    assert_eq!(with(at, &token, "GET", "/v1/workers/w1", "").await.status, 200);
    with(at, &token, "GET", "/v1/workers/w2", "").await.problem(403);
    let listed = with(at, &token, "GET", "/v1/workers", "").await.json();
    assert_eq!((listed["items"].as_array().unwrap().len(), &listed["items"][0]["id"]), (1, &json!("w1")));
    assert_eq!(with(at, &token, "GET", "/v1/map", "").await.status, 200);
    for path in ["/v1/robots", "/v1/jobs", "/v1/encounters", "/metrics"] {
        assert_eq!(with(at, &token, "GET", path, "").await.status, 403, "{path}");
    }
    server.stop().await.unwrap();
}
