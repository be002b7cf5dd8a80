//! Models, costs and steps in time.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

mod four_bar;
mod landing;
mod models;
mod step;
