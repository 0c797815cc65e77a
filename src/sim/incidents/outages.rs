//! Stations that stop, and chargers that give no current.
//!
//! Main type: [`Outages`]. The fleet is told of a station's stop and its end as operators would tell it. It hears of a
//! charger only from the robot on it. Refuses: to draw a number if a scenario has no such faults.

use crate::askers::OUTAGES;
use crate::random::Stream;
use crate::scenario::Faults;
use giveway_fleet::{Input, Request, StationOrder, Token};
use giveway_floor::id::{NodeId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{NodeKind, Warehouse};

/// The token of requests about stations that stop.
const TOKEN: Token = Token { asker: OUTAGES, number: 0 };
/// Purposes of the streams of random numbers.
const CHARGERS: u64 = 10;
const STATIONS: u64 = 11;

/// A station or charger that is out of order now and then.
#[derive(Debug)]
struct Outage<T> {
    of: T,
    until: Option<Time>,
    luck: Stream,
}

/// All stations and chargers, and which of them are out of order.
#[derive(Debug)]
pub(crate) struct Outages {
    chargers: Vec<Outage<NodeId>>,
    stations: Vec<Outage<StationId>>,
    charger_outages_per_hour: f64,
    station_stops_per_hour: f64,
    lasts: Span,
    /// How often chargers, and stations, were out of order.
    pub counts: [u64; 2],
}

impl Outages {
    /// All stations and chargers, in order at first.
    pub fn new(faults: &Faults, warehouse: &Warehouse, seed: u64) -> Outages {
        let stream = |purpose, i: usize| Stream::new(seed, purpose, i as u64);
        let works = |(i, of)| Outage { of, until: None, luck: stream(CHARGERS, i) };
        let serves = |(i, of)| Outage { of, until: None, luck: stream(STATIONS, i) };
        let chargers = warehouse.nodes_where(|k| k == NodeKind::Charger);
        Outages {
            chargers: chargers.into_iter().enumerate().map(works).collect(),
            stations: warehouse.stations.ids().enumerate().map(serves).collect(),
            charger_outages_per_hour: faults.charger_outages_per_hour,
            station_stops_per_hour: faults.station_stops_per_hour,
            lasts: Span::from_secs_f64(faults.repair_s),
            counts: [0; 2],
        }
    }

    /// Begins and ends outages between `from` and `to`; gives what the fleet is told.
    pub fn say(&mut self, from: Time, to: Time) -> Vec<Input> {
        let hours = (to - from).as_secs_f64() / 3600.0;
        let (chargers, stations) =
            (self.charger_outages_per_hour * hours, self.station_stops_per_hour * hours);
        for charger in &mut self.chargers {
            self.counts[0] += u64::from(charger.look(to, chargers, self.lasts) == Some(true));
        }
        let mut said = Vec::new();
        for stopped in &mut self.stations {
            let station = stopped.of;
            let begins = stopped.look(to, stations, self.lasts);
            self.counts[1] += u64::from(begins == Some(true));
            let order = |begins| if begins { StationOrder::Pause } else { StationOrder::Resume };
            said.extend(begins.map(|b| Input::ask(TOKEN, Request::Station(station, order(b)))));
        }
        said
    }

    /// Until when a charger gives no current; nothing if it works or the node is no charger.
    pub fn at(&self, node: NodeId) -> Option<Time> {
        self.chargers.iter().find(|c| c.of == node)?.until
    }

    /// Ends all outages; stations report it with the next [`Outages::say`].
    pub fn end(&mut self, now: Time) {
        (self.charger_outages_per_hour, self.station_stops_per_hour) = (0.0, 0.0);
        self.chargers.iter_mut().for_each(|c| c.until = None);
        self.stations.iter_mut().for_each(|s| s.until = s.until.map(|_| now));
    }
}

impl<T> Outage<T> {
    /// Whether an outage begins (true) or ends (false) now; nothing if neither.
    fn look(&mut self, now: Time, probability: f64, lasts: Span) -> Option<bool> {
        match self.until {
            Some(until) if now >= until => {
                self.until = None;
                Some(false)
            }
            None if self.luck.happens(probability) => {
                self.until = Some(now + lasts);
                Some(true)
            }
            _ => None,
        }
    }
}
