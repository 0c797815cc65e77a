//! The parties of a simulated floor that send requests to the fleet, each with its own asker number.
//!
//! Refuses: to be a client of a server, which has the number 0.

use giveway_fleet::{Asker, Input, Request, StationOrder};

/// Customers, who submit jobs and change their minds, and people at stations without a cell.
pub const CUSTOMERS: Asker = Asker(1);
/// Robots that join, leave and come back.
pub const ROBOTS: Asker = Asker(2);
/// Supervisors who close areas and order evacuations.
pub const SUPERVISORS: Asker = Asker(3);
/// Workers, and the people who give them assignments.
pub const CREW: Asker = Asker(4);
/// Stations that stop working for a while.
pub const OUTAGES: Asker = Asker(5);
/// People who pick at work cells.
pub const PICKERS: Asker = Asker(6);

/// Whether a party repeats this request if it gets no reply or is refused. Pickers repeat what they report of their
/// picks until the screen shows it.
pub fn is_made_again(input: &Input) -> bool {
    match input {
        Input::Ask { request: Request::Station(_, order), .. } => {
            matches!(order, StationOrder::Pause | StationOrder::Resume)
        }
        Input::Ask { .. } => true,
        _ => false,
    }
}
