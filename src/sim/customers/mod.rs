//! Simulated customers: they keep jobs waiting, or order at random times, or work through a file of order lines.
//!
//! Main type: [`Customers`]. Refuses: to look at anything a customer could not see (it only counts waiting jobs).

mod choices;

use self::choices::Choices;
use crate::askers::CUSTOMERS;
use crate::random::Stream;
use crate::scenario::{Demand, LineDemand, Scenario};
use giveway_cell::{OrderLine, PickedBy};
use giveway_fleet::{Input, JobAction, JobKind, JobState, Ledger, Reply, Request, Token};
use giveway_floor::id::{Dense, RackId, RobotId, StationId};
use giveway_floor::text::{TextTable, TextTableRow};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};

/// The purpose of the stream of random numbers for order lines.
const LINES: u64 = 60;

/// One line of an order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OrderFileLine {
    /// The order that the line belongs to; lines of one order go to one station.
    pub order: String,
    /// Where its goods lie; one rack holds the goods of one location.
    pub location: String,
}

impl OrderFileLine {
    /// Reads a table ([`TextTable`]) with the columns `OrderNumber` and `AlleyCell` (or `Location`, or `SKU`); it
    /// ignores other columns.
    ///
    /// # Errors
    /// The first problem with its line number. A table without lines is an error, too: there would be no orders.
    pub fn parse_csv(text: &str) -> Result<Vec<OrderFileLine>, String> {
        let table = TextTable::read(text).map_err(|fault| fault.to_string())?;
        let named = || {
            let names: Vec<String> =
                table.columns.iter().map(|c| format!("`{}`", c.escape_debug())).collect();
            format!("its columns are {}", names.join(", "))
        };
        let order = table.column("OrderNumber");
        let order = order.ok_or_else(|| format!("the header names no column `OrderNumber`; {}", named()))?;
        let place = ["AlleyCell", "Location", "SKU"].into_iter().find_map(|name| table.column(name));
        let place = place.ok_or_else(|| {
            format!("the header names no column `AlleyCell`, `Location` or `SKU`; {}", named())
        })?;
        let row = |row: &TextTableRow| match (row.surplus, &row.cells[order], &row.cells[place]) {
            (0, order, place) if !order.is_empty() && !place.is_empty() => {
                Ok(OrderFileLine { order: order.clone(), location: place.clone() })
            }
            (0, ..) => Err(format!("line {}: it has no order number or no place", row.line)),
            (n, ..) => {
                let columns = table.columns.len();
                Err(format!("line {}: it has {n} cells, but there are {columns} columns", row.line))
            }
        };
        table.rows.iter().map(row).collect()
    }
}

/// Why customers order nothing on a map although the scenario has some; a text for people.
pub fn nothing_to_order(scenario: &Scenario, warehouse: &Warehouse) -> Option<&'static str> {
    match (&scenario.demand, warehouse.racks.len(), warehouse.stations.len()) {
        (Demand::None, ..) => None,
        (_, 0, _) => Some(
            "simulated customers hand in no jobs: they have racks brought to stations, and the map has no racks",
        ),
        (_, _, 0) => Some(
            "simulated customers hand in no jobs: they have racks brought to stations, and the map has no stations",
        ),
        _ => None,
    }
}

/// All customers of a run.
#[derive(Debug)]
pub(super) struct Customers {
    demand: Demand,
    lines: Vec<(RackId, StationId)>,
    next_line: usize,
    next_order: Option<Time>,
    racks: usize,
    stations: usize,
    random: Stream,
    sent: u64,
    /// Orders without a reply yet.
    unanswered: BTreeSet<u64>,
    choices: Choices,
    /// What customers order of racks at work cells, if they do.
    order_lines: Option<(LineDemand, Stream)>,
    /// Whether customers have stopped ordering.
    stopped: bool,
}

impl Customers {
    pub fn new(scenario: &Scenario, lines: &[OrderFileLine], warehouse: &Warehouse, seed: u64) -> Customers {
        let demand = scenario.demand.clone();
        let (racks, stations) = (warehouse.racks.len(), warehouse.stations.len());
        let is_idle =
            racks == 0 || stations == 0 || matches!(demand, Demand::File { .. }) && lines.is_empty();
        Customers {
            demand: if is_idle { Demand::None } else { demand },
            lines: assign_lines(lines, racks, stations),
            next_line: 0,
            next_order: None,
            racks,
            stations,
            random: Stream::new(seed, 3, 0),
            sent: 0,
            unanswered: BTreeSet::new(),
            choices: Choices::new(scenario.customers, warehouse, seed),
            order_lines: scenario.cells.as_ref().map(|c| (c.lines, Stream::new(seed, LINES, 0))),
            stopped: false,
        }
    }

    /// From now on, customers order nothing new.
    pub fn stop(&mut self) {
        self.stopped = true;
    }

    /// Whether customers have stopped ordering.
    pub fn have_stopped(&self) -> bool {
        self.stopped
    }

    /// Takes the fleet's reply.
    pub fn hear(&mut self, reply: &Reply, now: Time) {
        if reply.token.asker == CUSTOMERS {
            self.unanswered.remove(&reply.token.number);
        }
        self.choices.hear(reply, now);
    }

    /// The server process has died: requests without a reply are sent again, or never get one.
    pub fn expect_no_answers(&mut self) {
        self.unanswered.clear();
    }

    /// Orders and other requests due now.
    pub fn order(&mut self, now: Time, period: Span, ledger: &Ledger) -> Vec<Input> {
        let mut inputs = if self.stopped { Vec::new() } else { self.jobs(now, ledger) };
        for said in self.choices.meddle(now, period, self.stopped, ledger) {
            let token = self.token();
            inputs.push(Input::ask(token, said.request()));
        }
        inputs
    }

    /// What the picker reports of a rack at a station once all wanted goods are picked from it.
    pub fn pick(&mut self, station: StationId, robot: RobotId, serial: u64) -> Input {
        let order = self.choices.pick(station, robot, serial);
        Input::ask(self.token(), Request::Station(station, order))
    }

    fn token(&mut self) -> Token {
        self.sent += 1;
        Token { asker: CUSTOMERS, number: self.sent }
    }

    fn jobs(&mut self, now: Time, ledger: &Ledger) -> Vec<Input> {
        let waiting = ledger.jobs.values().filter(|j| j.state == JobState::Waiting).count();
        let count = match &self.demand {
            Demand::None => 0,
            Demand::Backlog(n) | Demand::File { backlog: n, .. } => {
                n.saturating_sub(waiting + self.unanswered.len())
            }
            Demand::PerHour(rate) => return self.at_random(now, *rate, ledger),
        };
        (0..count).map(|_| self.one(now, ledger)).collect()
    }

    fn at_random(&mut self, now: Time, per_hour: f64, ledger: &Ledger) -> Vec<Input> {
        let mut orders = Vec::new();
        let mean_s = 3600.0 / per_hour.max(1e-9);
        let mut next =
            self.next_order.unwrap_or_else(|| now + Span::from_secs_f64(self.random.exponential(mean_s)));
        while next <= now {
            orders.push(self.one(now, ledger));
            next += Span::from_secs_f64(self.random.exponential(mean_s));
        }
        self.next_order = Some(next);
        orders
    }

    fn one(&mut self, now: Time, ledger: &Ledger) -> Input {
        let (rack, station) = match self.lines.get(self.next_line) {
            Some(line) => {
                self.next_line = (self.next_line + 1) % self.lines.len();
                *line
            }
            None => {
                // Popularity falls with the square of the rank: a fifth of the racks gets 45 % of the orders.
                let rank = self.random.unit().powi(2);
                let rack = (rank * self.racks as f64) as usize;
                // Ranks are spread over the floor by a step that shares no divisor with most numbers of racks.
                (RackId::at(rack * 7919 % self.racks), StationId::at(self.random.below(self.stations)))
            }
        };
        let token = self.token();
        self.unanswered.insert(token.number);
        let plain = JobKind::Deliver { rack, station, pick: None };
        let mut request = self.choices.request(plain, token, now, ledger);
        if let Some((demand, random)) = &mut self.order_lines
            && let JobKind::Deliver { rack, .. } = request.kind
            && request.lines.is_empty()
        {
            let visits = request.stations().map(|v| v.station);
            request.lines =
                visits.map(|station| lines_of(ledger.warehouse(), (rack, station), demand, random)).collect();
            if request.lines.iter().all(Vec::is_empty) {
                request.lines.clear();
            }
        }
        Input::ask(token, JobAction::Submit(request))
    }
}

/// Order lines for a rack at a station; none if the station has no cell or the rack has no slots.
fn lines_of(
    w: &Warehouse,
    (rack, station): (RackId, StationId),
    demand: &LineDemand,
    random: &mut Stream,
) -> Vec<OrderLine> {
    let (Some(cell), Some(rack_type)) = (&w.stations[station].cell, w.racks[rack].rack_type) else {
        return Vec::new();
    };
    let mut slots: Vec<_> = w.rack_types[rack_type].slots().collect();
    let mut between = |[low, high]: [u32; 2]| low + random.below((high - low + 1) as usize) as u32;
    let (count, quantity) = (between(demand.per_visit), demand.quantity);
    let quantities: Vec<u32> = (0..count).map(|_| between(quantity)).collect();
    let line = |quantity| {
        let slot = slots.swap_remove(random.below(slots.len()));
        let tote = cell.totes[random.below(cell.totes.len())].name.clone();
        OrderLine { slot, quantity, tote, item: None, by: PickedBy::Either }
    };
    let most = w.rack_types[rack_type].slots().count();
    quantities.into_iter().take(most).map(line).collect()
}

/// Locations become racks in order of first appearance, orders become stations in turn.
fn assign_lines(lines: &[OrderFileLine], racks: usize, stations: usize) -> Vec<(RackId, StationId)> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut orders: BTreeMap<&str, usize> = BTreeMap::new();
    let mut jobs = Vec::new();
    for line in lines.iter().filter(|_| racks > 0 && stations > 0) {
        let next = places.len();
        let place = *places.entry(&line.location).or_insert(next);
        let next = orders.len();
        let order = *orders.entry(&line.order).or_insert(next);
        let job = (RackId::at(place % racks), StationId::at(order % stations));
        // Lines of one order that lie in one rack are picked in one visit.
        if jobs.last() != Some(&job) {
            jobs.push(job);
        }
    }
    jobs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_lines_are_found_by_their_header() {
        let text =
            ",DATE,OrderNumber,SKU,Coord,AlleyCell\n0,1/1,77,5,\"[1, 2]\",A1\n1,1/1,78,6,\"[1, 3]\",A2\n";
        let lines = OrderFileLine::parse_csv(text).unwrap();
        assert_eq!(lines[1], OrderFileLine { order: "78".into(), location: "A2".into() });
    }

    #[test]
    fn order_lines_are_the_same_however_a_program_writes_the_table() {
        let plain = "OrderNumber,SKU\n1001,A7\n1002,B2\n";
        let wanted = OrderFileLine::parse_csv(plain).unwrap();
        assert_eq!(wanted.len(), 2);
        for text in [
            format!("\u{feff}{plain}"),
            plain.replace('\n', "\r\n"),
            plain.replace('\n', "\r"),
            plain.replace(',', ";"),
            plain.replace(',', "\t"),
            format!("\u{feff}{}", plain.replace(',', ";").replace('\n', "\r\n")),
        ] {
            assert_eq!(OrderFileLine::parse_csv(&text).as_ref(), Ok(&wanted), "{text:?}");
        }
    }

    #[test]
    fn a_table_that_is_none_is_refused_with_the_reason() {
        for (text, says) in [
            ("OrderNumber,SKU\n1,2\n3,\n", "line 3"),
            ("OrderNumber,SKU\n1,2,7\n", "line 2: it has 3 cells, but there are 2 columns"),
            ("OrderNumber,SKU\n", "no line below the header"),
            ("OrderNumber,SKU\r", "no line below the header"),
            ("\n\n", "empty"),
            ("OrderNumber,SKU,sku\n1,2,3\n", "two columns `sku`"),
            ("Order,SKU\n1,2\n", "no column `OrderNumber`; its columns are `Order`, `SKU`"),
        ] {
            let error = OrderFileLine::parse_csv(text).unwrap_err();
            assert!(error.contains(says), "{text:?}: {error}");
        }
    }

    #[test]
    fn customers_with_a_file_of_no_lines_order_nothing_rather_than_at_random() {
        let warehouse = giveway_floor::warehouse::lab();
        let text = r#"{"giveway_scenario": 1, "name": "x", "map": "m", "robots": 1, "period_ms": 100,
            "jobs": {"file": {"path": "orders.csv", "backlog": 2}}}"#;
        let customers = Customers::new(&Scenario::parse(text).unwrap(), &[], &warehouse, 1);
        assert_eq!(customers.demand, Demand::None);
    }
}
