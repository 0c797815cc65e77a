//! What a headset in a workplace shows its wearer: the lit slot, its tote, and mistakes.
//!
//! Main types: [`CellTold`] (what to show), [`CellLightsDto`] (its form on the wire). Refuses: to judge hands; the core
//! does.

use crate::dto::cell::station::{CellWarningDto, warning_dto};
use giveway_fleet::{StationView, View, WrongReach};
use giveway_floor::geometry::{Point, inside};
use giveway_floor::id::{Dense, RackTypeId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{Cell, SlotName, Warehouse};
use serde::Serialize;
use utoipa::ToSchema;

/// What a person in the workplace of a station is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct CellTold {
    /// The station.
    pub station: StationId,
    /// Whether the joints of hands are useful.
    pub hears_hands: bool,
    /// The lit line: the slot, the number of pieces, and the tote by its number at the station.
    pub lit: Option<(SlotName, u32, usize)>,
    /// The type of the rack that stands there.
    pub rack: Option<RackTypeId>,
    /// The mistake of which the person's hand was warned a moment ago.
    pub warning: Option<WrongReach>,
    /// When the hand of that warning was seen, if the warning is so new that it has not been sent.
    pub warned_of: Option<Time>,
}

impl CellTold {
    /// What a person at a place is shown; nothing outside of all workplaces.
    pub fn at(view: &View, warehouse: &Warehouse, at: Point) -> Option<CellTold> {
        let is_there = |cell: &Cell| inside(&cell.workplace, at);
        let (station, place) =
            warehouse.stations.pairs().find(|(_, s)| s.cell.as_ref().is_some_and(is_there))?;
        let seen = view.stations.get(station.ix())?;
        let line = seen.lines.as_ref().and_then(|lines| Some(&lines.all()[lines.lit()?]));
        let lit = line.and_then(|line| {
            let tote = place.cell.as_ref()?.totes.iter().position(|t| t.name == line.line.tote)?;
            Some((line.line.slot, line.left(), tote))
        });
        let robot = seen.robot.filter(|_| seen.picking).and_then(|r| view.robots.get(r.ix()));
        let rack = robot.and_then(|r| warehouse.racks[r.rack?].rack_type);
        let StationView { hears_hands, warning, .. } = *seen;
        Some(CellTold { station, hears_hands, lit, rack, warning, warned_of: None })
    }

    /// Whether a wearer would see the same.
    pub fn looks_like(&self, other: &CellTold) -> bool {
        let shown = |c: &CellTold| (c.station, c.lit, c.rack, c.warning);
        shown(self) == shown(other)
    }
}

/// The position of a slot or tote in the room.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CellPlaceDto {
    /// The name of the slot or tote.
    #[schema(example = "C3")]
    pub id: String,
    /// Position: map x, map y, height; metres. For a slot the middle of its front, for a tote the middle of its rim.
    pub at: [f64; 3],
}

/// What is to be picked at the wearer's station.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
pub struct CellLightsDto {
    /// The station in whose workplace the wearer stands; null outside of workplaces.
    #[schema(example = "S1")]
    pub station: Option<String>,
    /// Whether the client should send joints of hands with each pose from now on.
    pub hands: bool,
    /// The lit slot; null if none is lit.
    pub slot: Option<CellPlaceDto>,
    /// How many pieces are still to be taken from the slot.
    pub pieces: u32,
    /// The tote into which the pieces belong.
    pub tote: Option<CellPlaceDto>,
    /// A mistake of a hand that was made or is about to be made.
    pub warning: Option<CellWarningDto>,
}

impl CellLightsDto {
    /// The form on the wire.
    pub fn new(told: Option<&CellTold>, map: &Warehouse) -> CellLightsDto {
        let Some(told) = told else { return CellLightsDto::default() };
        let place = &map.stations[told.station];
        let stands = map.nodes[place.node].at;
        let cell = place.cell.as_ref();
        let slot = told.lit.zip(told.rack).and_then(|((slot, ..), rack)| {
            let at = cell?.place_of(stands, &map.rack_types[rack], slot)?;
            Some(CellPlaceDto { id: slot.to_string(), at: [at.x, at.y, at.z] })
        });
        let tote = told.lit.and_then(|(_, _, tote)| {
            let tote = cell?.totes.get(tote)?;
            Some(CellPlaceDto { id: tote.name.clone(), at: [tote.at.x, tote.at.y, tote.at.z] })
        });
        CellLightsDto {
            station: Some(place.name.clone()),
            hands: told.hears_hands,
            slot,
            pieces: told.lit.map_or(0, |(_, pieces, _)| pieces),
            tote,
            warning: told.warning.map(|wrong| warning_dto(wrong, cell)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::Vector;

    #[test]
    fn hands_are_asked_for_in_a_workplace_that_hears_them_and_nowhere_else() {
        let map = giveway_floor::warehouse::stations();
        let outline = &map.stations[StationId(0)].cell.as_ref().unwrap().workplace;
        let middle = Point::from(outline.iter().map(|p| p.coords).sum::<Vector>() / outline.len() as f64);
        let asked = |hears_hands: bool, at: Point| {
            let station = StationView { hears_hands, ..StationView::default() };
            let view = View { stations: vec![station; map.stations.len()], ..View::default() };
            let lights = CellLightsDto::new(CellTold::at(&view, &map, at).as_ref(), &map);
            (lights.station, lights.hands)
        };
        assert_eq!(asked(true, middle), (Some("S1".to_owned()), true));
        assert_eq!(asked(false, middle), (Some("S1".to_owned()), false), "buttons alone confirm there");
        assert_eq!(asked(true, middle + Vector::new(0.0, 100.0)), (None, false));
    }
}
