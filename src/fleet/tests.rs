//! The core as a whole, step by step.
