//! What a verified ID token says about a person: the name, and the role that the groups give.
//!
//! Main functions: [`role_of`], [`name_of`]. Refuses: to verify anything; the caller has done that.

use super::settings::OidcSettings;
use crate::access::caller::{Caller, Role};
use serde_json::{Map, Value};

/// The longest name, in characters.
const LONGEST_NAME: usize = 80;

/// Claims for a person's name, the best first: as a rule, people cannot change these themselves.
const NAMES: [&str; 2] = ["preferred_username", "email"];

/// Roles, the strongest first: a person whose groups have several roles gets the strongest.
const STRONGEST: [Role; 4] = [Role::Admin, Role::Operator, Role::Integrator, Role::Viewer];

/// The claim of this name, which may contain dots; else a part of a claim, where each dot leads one level down.
fn claim<'a>(claims: &'a Map<String, Value>, name: &str) -> Option<&'a Value> {
    claims.get(name).or_else(|| {
        let mut parts = name.split('.');
        let first = claims.get(parts.next()?)?;
        parts.try_fold(first, |inside, part| inside.get(part))
    })
}

/// The groups that a token names.
fn groups_of<'a>(claims: &'a Map<String, Value>, settings: &OidcSettings) -> Vec<&'a str> {
    match claim(claims, &settings.groups_claim) {
        Some(Value::Array(all)) => all.iter().filter_map(Value::as_str).collect(),
        Some(Value::String(one)) => vec![one],
        _ => Vec::new(),
    }
}

/// The role that a person's groups give; nothing if none of them has a role.
pub fn role_of(claims: &Map<String, Value>, settings: &OidcSettings) -> Option<Role> {
    let groups = groups_of(claims, settings);
    let has = |role: &Role| groups.iter().any(|group| settings.roles.get(*group) == Some(role));
    STRONGEST.into_iter().find(has)
}

/// The person's name. A name that is reserved for callers without a person gets the suffix " (person)".
pub fn name_of(claims: &Map<String, Value>, settings: &OidcSettings) -> String {
    let wanted: Vec<&str> = match &settings.name_claim {
        Some(name) => vec![name],
        None => NAMES.into(),
    };
    let text = |name: &str| claim(claims, name).and_then(Value::as_str).map(plain);
    let found = wanted.into_iter().filter_map(text).find(|name| !name.is_empty());
    let name = found.unwrap_or_else(|| text("sub").unwrap_or_default());
    if Caller::RESERVED.contains(&name.as_str()) { format!("{name} (person)") } else { name }
}

/// The text without control characters, cut to the longest name.
fn plain(text: &str) -> String {
    let visible = text.chars().filter(|c| !c.is_control());
    visible.collect::<String>().trim().chars().take(LONGEST_NAME).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn settings(more: &Value) -> OidcSettings {
        let mut all = json!({"issuer": "https://login.example", "client_id": "giveway",
            "roles": {"leads": "operator", "it": "admin", "wms": "integrator", "/all": "viewer"}});
        all.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        serde_json::from_value(all).unwrap()
    }

    fn claims(value: Value) -> Map<String, Value> {
        value.as_object().unwrap().clone()
    }

    #[test]
    fn the_strongest_role_of_all_groups_counts() {
        let role = |groups: Value| role_of(&claims(json!({ "groups": groups })), &settings(&json!({})));
        assert_eq!(role(json!(["/all", "leads"])), Some(Role::Operator));
        assert_eq!(role(json!(["wms", "leads", "it"])), Some(Role::Admin));
        assert_eq!(role(json!("wms")), Some(Role::Integrator));
        for none in [json!(["Leads", "", 7]), json!([]), json!({"leads": true}), Value::Null] {
            assert_eq!(role(none.clone()), None, "{none}");
        }
        assert_eq!(role_of(&Map::new(), &settings(&json!({}))), None, "no claim at all");
    }

    #[test]
    fn groups_may_be_inside_of_a_claim_whose_name_may_have_dots() {
        let nested = settings(&json!({"groups_claim": "realm_access.roles"}));
        assert_eq!(role_of(&claims(json!({"realm_access": {"roles": ["it"]}})), &nested), Some(Role::Admin));
        let dotted = settings(&json!({"groups_claim": "https://example.com/groups"}));
        assert_eq!(
            role_of(&claims(json!({"https://example.com/groups": ["it"]})), &dotted),
            Some(Role::Admin)
        );
    }

    #[test]
    fn a_name_is_what_people_cannot_change_and_never_that_of_nobody() {
        let of = |more: Value| {
            name_of(
                &claims(
                    json!({"sub": "4711", "name": "Ben"})
                        .as_object()
                        .unwrap()
                        .clone()
                        .into_iter()
                        .chain(claims(more))
                        .collect::<Map<_, _>>()
                        .into(),
                ),
                &settings(&json!({})),
            )
        };
        assert_eq!(of(json!({"preferred_username": "anna", "email": "a@b.example"})), "anna");
        assert_eq!(of(json!({"email": "a@b.example"})), "a@b.example");
        assert_eq!(of(json!({"preferred_username": " \n"})), "4711");
        assert_eq!(of(json!({"preferred_username": "configuration"})), "configuration (person)");
        assert_eq!(of(json!({"preferred_username": "a\r\nb"})), "ab");
        assert_eq!(of(json!({"preferred_username": "x".repeat(500)})).len(), LONGEST_NAME);
        let named = settings(&json!({"name_claim": "name"}));
        assert_eq!(name_of(&claims(json!({"sub": "4711", "name": "Ben"})), &named), "Ben");
    }
}
