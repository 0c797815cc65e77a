//! The API's description of itself: `/openapi.json` and `/asyncapi.json`.
//!
//! Main type: [`openapi::Description`]; main function: [`asyncapi::messages`]. Refuses: to list routes; the router
//! does.

pub mod asyncapi;
pub mod openapi;
