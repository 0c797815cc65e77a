//! The page: its files, which are built into the program, how a browser gets them, and the page in one file.
//!
//! Main functions: [`served::page`], [`single_file::page`], [`assets::file`]. Refuses: to know what the page shows.

pub mod assets;
pub mod served;
pub mod single_file;
