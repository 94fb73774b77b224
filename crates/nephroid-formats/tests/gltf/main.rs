//! glTF: what good models become, and what is said of bad ones.

#![allow(clippy::float_cmp)]

mod bad;
mod good;
mod looks;
mod model;
mod mutations;
