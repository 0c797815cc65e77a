//! stub
/// x
pub fn to_svg() {}
