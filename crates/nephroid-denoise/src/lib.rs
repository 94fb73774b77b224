//! Denoising by Intel [Open Image Denoise](https://www.openimagedenoise.org), version 2, which is found and loaded at run
//! time: nothing of it is needed to build, and nobody without it misses more than denoising.
//!
//! All `unsafe` that this takes is in `api` and `denoiser`, behind [`Denoiser`]. It reads no environment: where to look is
//! what it is told.

mod api;
mod denoiser;
mod error;
mod search;

pub use denoiser::{Denoiser, Picture};
pub use error::{DenoiseError, LoadError};
pub use search::{Search, python_prefixes};
