//! Photon mapping: a renderer for caustics, light through glass and water, and light in fog.

pub mod camera;
pub mod color;
pub mod film;
pub mod handle;
pub mod light;
pub mod material;
pub mod math;
pub mod photon_map;
pub mod scene;
pub mod shape;
pub mod texture;
