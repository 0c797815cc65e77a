//! stub
use super::{Draft, Warehouse};
/// One.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Where in the map.
    pub place: String,
    /// What is wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}
/// All.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Findings(pub Vec<Finding>);
pub(super) fn names_and_numbers(_d: &Draft) -> Result<(), Findings> {
    Ok(())
}
pub(super) fn well_formed(_w: &Warehouse) -> Result<(), Findings> {
    Ok(())
}
