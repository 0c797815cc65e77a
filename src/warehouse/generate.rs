//! stub
/// x
pub struct Blocks;
/// x
pub fn kiva() {}
/// x
pub fn lab() {}
/// x
pub fn thesis() {}
