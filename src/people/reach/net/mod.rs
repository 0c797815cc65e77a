//! Nets, forward only: layers and the functions in their nodes.
//!
//! Main types: [`Lstm`], [`Elman`], [`Affine`]. Single precision, no allocation, equal bits on every machine. Refuses:
//! to learn; experiments do that.

mod layers;
pub mod squash;

pub use layers::add_product;
pub use layers::{Affine, Elman, Lstm};
