//! Photon mapping: a renderer for caustics, for light through glass and water, in fog and smoke, and for all
//! light that bounces between surfaces.
//!
//! A [`scene::Scene`] is plain data. [`world::World::new`] checks it, names everything that is wrong
//! with it, and prepares it; after that rendering cannot fail. A [`session::Session`] renders a world
//! step by step into a [`film::Film`], which develops into a picture at any time.
//!
//! A room whose answer is known: inside a sphere of radius 2 and albedo ½ with a lamp of 4π W/sr at its
//! centre, the wall shines with a radiance of 1 everywhere.
//!
//! ```
//! use nephroid::{camera::*, color::*, film::*, integrator::*, light::*, material::*, math::*, observer::*};
//! use nephroid::{scene::*, session::*, shape::*, world::*};
//! let film = FilmSettings { width: 16, height: 16, crop: None, filter: Filter::Box };
//! let (to_world, projection) = (Transform::IDENTITY, Projection::Orthographic);
//! let mut scene = Scene::new(Camera { to_world, projection, medium: None }, film);
//! let reflectance = scene.textures.constant(Rgb::splat(0.5));
//! let material = scene.materials.push(Material::Diffuse { reflectance });
//! let geometry = Geometry::Sphere { center: Vec3::ZERO, radius: 2.0 };
//! scene.shapes.push(Shape { flip_normals: true, ..Shape::new("wall", geometry, material) });
//! let kind = LightKind::Point { position: Vec3::ZERO, intensity: Rgb::splat(4.0 * std::f32::consts::PI) };
//! scene.lights.push(Light { name: "lamp".into(), kind, medium: None });
//! let world = World::new(scene).unwrap();
//! let settings = RenderSettings { method: Method::default(), samples_per_pixel: 4, seed: 0 };
//! let mut session = Session::new(&world, settings, &Silent);
//! while !session.iteration_is_complete() { session.step(&Silent); }
//! assert!((session.film().develop().mean().g - 1.0).abs() < 0.02);
//! ```
//!
//! # Where to look
//!
//! | for | see |
//! |---|---|
//! | what a scene consists of | [`scene`], [`shape`], [`material`], [`medium`], [`light`], [`texture`], [`camera`] |
//! | how to render, and how well | [`session`], [`integrator::Method`], [`integrator::PhotonMapperConfig`] |
//! | watching and stopping a render | [`observer::Observer`] |
//! | pictures, filters, tone mapping | [`film`] |
//! | the photons of a render, and what a pixel saw | [`laboratory`] |
//! | photons by themselves | [`photon_map`], [`transport::photon_pass`], [`transport::volume_pass`] |
//! | vectors and transforms | [`math`], which re-exports glam's |
//!
//! Scenes in files, and files of pictures, are read and written by the crate `nephroid-formats`; this
//! one does no I/O.
//!
//! # What it promises
//!
//! - The same scene, settings and seed give the same bits, on any number of threads.
//! - Units are SI: metres (or any other length, used throughout), W, W/m², W/(m²·sr). A name says so where
//!   an angle is in degrees.
//! - Colours are linear RGB with the primaries of sRGB.
//! - No length is built in: a scene scaled by a power of two gives the same picture.
//!
//! Rough metals and glass, spectra and motion blur are not there yet.

mod bvh;
pub mod camera;
pub mod color;
pub mod film;
pub mod handle;
pub mod integrator;
pub mod laboratory;
pub mod light;
pub mod material;
pub mod math;
pub mod medium;
pub mod observer;
pub mod photon_map;
pub mod sampling;
pub mod scene;
pub mod session;
pub mod shape;
pub mod texture;
pub mod transport;
pub mod world;

/// The program in the README is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
