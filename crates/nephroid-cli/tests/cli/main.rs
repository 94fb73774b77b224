//! The command as its users meet it: what it writes, what it prints and how it ends.

// `clippy.toml` allows it in tests, but not in what tests have in common.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod convert;
mod denoising;
mod errors;
mod fogs;
mod integrators;
mod kills;
mod laboratory;
mod layers;
mod limits;
mod media_flags;
mod media_laboratory;
mod models;
mod outputs;
mod pictures;
mod scenes;
mod sessions;
mod shares;
mod study;
mod support;
mod trouble;
mod watching;
