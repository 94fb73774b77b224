//! Photon mapping: a renderer for caustics, light through glass and water, and light in fog.

mod bvh;
pub mod camera;
pub mod color;
pub mod film;
pub mod handle;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod observer;
pub mod photon_map;
pub mod sampling;
pub mod scene;
pub mod session;
pub mod shape;
pub mod texture;
pub mod transport;
pub mod world;
