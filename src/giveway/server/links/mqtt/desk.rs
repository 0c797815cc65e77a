//! What people ask of the link to robots of other vendors, and its answers.
//!
//! Main function: [`MqttRobots::answer`]. Refuses: to answer for robots that nobody listed.

use super::kinds::{OpenKinds, contradictions};
use super::robot::RobotHere;
use super::{MqttRobots, UNLISTED};
use giveway_api::{
    ActionFate, LinkQuestion, LinkedRobot, NewLinked, NotDone, OperatorAction, RobotTrust, SaidError,
    SaidState, UnlistedRobot,
};
use giveway_fleet::Fleet;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::links;
use giveway_floor::time::Time;
use giveway_links::vda5050::{INIT_POSITION, NotReady};
use giveway_site::ListedRobot;
use giveway_vda5050::{Address, Parameter, State, Version};

/// Questions answered in one turn.
const AT_ONCE: usize = 16;

impl MqttRobots {
    /// Answers what was asked since the last turn; a receiver that is gone is no error.
    pub(super) fn answer(&mut self, now: Time, fleet: &Fleet) {
        for _ in 0..AT_ONCE {
            let Ok(question) = self.questions.try_recv() else { return };
            self.answer_one(now, fleet, question);
        }
    }

    fn answer_one(&mut self, now: Time, fleet: &Fleet, question: LinkQuestion) {
        match question {
            LinkQuestion::Robot(name, reply) => {
                let _ = reply.send(self.named(&name).map(|here| row(here, &self.kinds, now, fleet)));
            }
            LinkQuestion::Waiting(reply) => {
                let waiting = self.robots.values().filter(|here| here.number.is_none());
                let _ = reply.send(waiting.map(|here| row(here, &self.kinds, now, fleet)).collect());
            }
            LinkQuestion::Unlisted(reply) => {
                let _ = reply.send(self.unlisted.values().cloned().collect());
            }
            LinkQuestion::Messages(name, reply) => {
                let _ = reply.send(self.named(&name).map(|here| here.said.iter().cloned().collect()));
            }
            LinkQuestion::Act(name, action, reply) => {
                let _ = reply.send(self.act(now, &name, action));
            }
            LinkQuestion::Fate(name, id, reply) => {
                let _ = reply.send(self.named(&name).and_then(|here| fate(here, &id)));
            }
            LinkQuestion::Consent(name, reply) => {
                let _ = reply.send(self.consent(now, &name));
            }
            LinkQuestion::Settle(name, reply) => {
                let _ = reply.send(self.settle(now, &name, fleet));
            }
            LinkQuestion::List(new, reply) => {
                let _ = reply.send(self.list(new, fleet));
            }
            LinkQuestion::Unlist(name, reply) => {
                let _ = reply.send(self.unlist(&name));
            }
        }
    }

    fn named(&self, name: &str) -> Option<&RobotHere> {
        self.robots.values().find(|here| here.listed.name == name)
    }

    fn address_of(&self, name: &str) -> Result<Address, NotDone> {
        self.named(name).map(|here| here.listed.address.clone()).ok_or(NotDone::Unknown)
    }

    fn act(&mut self, now: Time, name: &str, action: OperatorAction) -> Result<String, NotDone> {
        let address = self.address_of(name)?;
        let here = self.robots.get_mut(&address).ok_or(NotDone::Unknown)?;
        let OperatorAction { kind, parameters, place } = action;
        let given = parameters.into_iter().map(|(key, value)| Parameter { key, value });
        let parameters = match place {
            Some(place) if kind == INIT_POSITION => here.session.init_position(place),
            Some(_) => Err(links::place_goes_with(INIT_POSITION)),
            None => Ok(given.collect()),
        };
        let sent = parameters.and_then(|parameters| here.session.act(now, &kind, parameters));
        let (id, output) = sent.map_err(NotDone::Refused)?;
        self.with(now, &address, |_| output);
        Ok(id)
    }

    fn consent(&mut self, now: Time, name: &str) -> Result<(), NotDone> {
        let address = self.address_of(name)?;
        let why = self.robots.get(&address).and_then(|here| here.session.not_ready(now));
        if !matches!(why, Some(NotReady::NoPause(_))) {
            return Err(NotDone::Refused(links::nothing_to_agree_to()));
        }
        self.with(now, &address, |session| {
            session.consent();
            session.tick(now)
        });
        Ok(())
    }

    fn settle(&mut self, now: Time, name: &str, fleet: &Fleet) -> Result<(), NotDone> {
        let address = self.address_of(name)?;
        let here = self.robots.get(&address).ok_or(NotDone::Unknown)?;
        let refuses = matches!(here.session.not_ready(now), Some(NotReady::Rejects(_)));
        if here.session.failure().is_none() && !refuses {
            return Err(NotDone::Refused(links::nothing_to_settle()));
        }
        let rack = here.number.and_then(|robot| fleet.ledger().rack_on(robot));
        self.with(now, &address, |session| {
            session.settle(rack);
            session.tick(now)
        });
        Ok(())
    }

    /// Lists a robot. Gives whether it is new.
    fn list(&mut self, new: NewLinked, fleet: &Fleet) -> Result<bool, NotDone> {
        let refused = |why: Sentence| Err(NotDone::Refused(why));
        let address = Address::new(&new.manufacturer, &new.serial);
        let address = address.map_err(|why| NotDone::Refused(links::no_address(why.to_string())))?;
        let version = match new.version.as_deref().map(|text| (text, Version::of_text(text))) {
            Some((text, None)) => {
                return refused(links::version_not_spoken(text));
            }
            Some((_, version)) => version,
            None => None,
        };
        let most = fleet.settings().limits.robots;
        if self.robots.len() >= most && self.named(&new.name).is_none() {
            return refused(links::all_robots_listed(most));
        }
        if fleet.ledger().kinds().named(&new.kind).is_none() && !self.kinds.has(&new.kind) {
            return refused(links::no_such_kind(new.kind));
        }
        let listed = ListedRobot { name: new.name, address, kind: new.kind, version };
        if let Some(here) = self.robots.get_mut(&listed.address).filter(|here| here.listed == listed) {
            let comes_back = here.has_left(fleet.ledger());
            here.returns = comes_back;
            return Ok(comes_back);
        }
        match (self.robots.get(&listed.address), self.named(&listed.name)) {
            (Some(here), _) => return refused(links::listed_as(&here.listed.name)),
            (None, Some(here)) => {
                return refused(links::is_another_robot(&listed.name, here.listed.address.to_string()));
            }
            (None, None) => {}
        }
        self.unlisted.remove(&listed.address);
        self.add(listed);
        Ok(true)
    }

    /// Lists a robot no more, unless it is on the floor: then it has to leave that first.
    fn unlist(&mut self, name: &str) -> bool {
        let waits = self.named(name).filter(|here| here.number.is_none());
        let address = waits.map(|here| here.listed.address.clone());
        address.is_some_and(|address| self.robots.remove(&address).is_some())
    }

    /// Remembers a robot that nobody listed. What many of them say costs no more than a few.
    pub(super) fn note_unlisted(
        &mut self,
        now: Time,
        address: &Address,
        level: &str,
        connection: Option<String>,
    ) {
        if self.unlisted.len() >= UNLISTED && !self.unlisted.contains_key(address) {
            let oldest = self.unlisted.iter().min_by_key(|(_, row)| row.heard);
            let oldest = oldest.map(|(address, _)| address.clone());
            oldest.map(|address| self.unlisted.remove(&address));
        }
        let row = self.unlisted.entry(address.clone()).or_insert_with(|| UnlistedRobot {
            manufacturer: address.manufacturer().to_owned(),
            serial: address.serial().to_owned(),
            version: level.to_owned(),
            heard: now,
            connection: None,
        });
        (row.heard, row.version) = (now, level.to_owned());
        row.connection = connection.or(row.connection.take());
    }
}

fn fate(here: &RobotHere, id: &str) -> Option<ActionFate> {
    let sent = here.session.sent_action(id)?;
    let status = sent.status.map_or("SENT".to_owned(), |status| format!("{status:?}").to_uppercase());
    Some(ActionFate { kind: sent.kind.clone(), sent: sent.sent, status, result: sent.result.clone() })
}

/// What is known of a robot.
fn row(here: &RobotHere, kinds: &OpenKinds, now: Time, fleet: &Fleet) -> LinkedRobot {
    let RobotHere { listed, session, .. } = here;
    let why = session.not_ready(now);
    let needs_care = session.failure().is_some() || matches!(why, Some(NotReady::Rejects(_)));
    let left = here.has_left(fleet.ledger()).then(links::has_left_floor);
    let kind = fleet.ledger().kinds().named(&listed.kind);
    let differences = |sheet| kind.map(|kind| contradictions(kind, sheet)).unwrap_or_default();
    let waits = if kind.is_none() { kinds.why_not(&listed.kind, why.as_ref()) } else { None };
    LinkedRobot {
        listed: NewLinked {
            name: listed.name.clone(),
            manufacturer: listed.address.manufacturer().to_owned(),
            serial: listed.address.serial().to_owned(),
            kind: listed.kind.clone(),
            version: listed.version.map(|version| version.text().to_owned()),
        },
        version: session.version().text().to_owned(),
        joined: here.number.is_some(),
        needs_consent: matches!(why, Some(NotReady::NoPause(_))),
        not_ready: left.or(waits).or(why.map(|why| why.said())),
        failed: session.failure().map(str::to_owned),
        needs_care,
        order: session.order_text(),
        said: session.state().map(|(at, state)| said(at, state)),
        noticed: here.notices(),
        trust: RobotTrust {
            false_claims: session.false_claims() as usize,
            longest_base_m: session.longest_base_m(),
        },
        figures: kind.map(|kind| kinds.figures(kind)).unwrap_or_default(),
        contradictions: session.factsheet().map(differences).unwrap_or_default(),
    }
}

fn said(at: Time, state: &State) -> SaidState {
    let word = |value: String| value.to_uppercase();
    let load = |load: &giveway_vda5050::Load| load.id.clone().or(load.kind.clone()).unwrap_or("?".to_owned());
    SaidState {
        at,
        mode: word(format!("{:?}", state.mode)),
        e_stop: word(format!("{:?}", state.e_stop)),
        field_violation: state.field_violation,
        paused: state.paused,
        last_node: state.last_node.clone(),
        charge: state.power.charge,
        charging: state.power.charging,
        loads: state.loads.as_ref().map(|loads| loads.iter().map(load).collect()),
        errors: (state.errors.iter())
            .map(|error| SaidError {
                level: word(format!("{:?}", error.level)),
                kind: error.kind.clone(),
                words: error.description.clone().unwrap_or_default(),
            })
            .collect(),
        wants_base: state.wants_base,
    }
}
