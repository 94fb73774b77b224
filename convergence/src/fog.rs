//! Scenes with participating media, and what is measured in them.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{
    DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, Show, VolumeEstimate,
};
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Coefficient, Grid, GridValues, Medium, Phase};
use nephroid::observer::Silent;
use nephroid::photon_map::{Kernel, VolumePhotons};
use nephroid::shape::{Geometry, Shape};
use nephroid::transport::{
    InMedia, Ledger, MapPlan, PhotonPlan, PhotonTargets, VolumeKind, WalkSettings, volume_pass,
};
use nephroid::world::World;
use std::ops::Range;

use crate::{Builder, render};

/// Of the sums of single-precision powers over a path.
const ROUNDING: f64 = 1e-6;

impl Builder {
    /// Stores a medium.
    pub fn medium(&mut self, medium: Medium) -> Handle<Medium> {
        self.scene.media.list.push(medium)
    }

    /// Fog without bounds: the camera and all lights so far stand in it.
    pub fn fill(&mut self, medium: Handle<Medium>) {
        self.scene.camera.medium = Some(medium);
        for light in &mut self.scene.lights {
            light.medium = Some(medium);
        }
    }

    /// A part of space that a medium fills, with vacuum around it.
    pub fn filled(&mut self, geometry: Geometry, to_world: Transform, medium: Handle<Medium>) -> &mut Shape {
        let null = self.scene.materials.push(Material::Null);
        let shape = self.shape(geometry, to_world, null);
        shape.boundary.interior = Some(medium);
        shape
    }

    /// The box between two corners, filled with a medium.
    pub fn box_of(&mut self, low: DVec3, high: DVec3, medium: Handle<Medium>) -> &mut Shape {
        let to_world = Transform::scale(0.5 * (high - low)).then(Transform::translate(0.5 * (low + high)));
        self.filled(Geometry::Cube, to_world, medium)
    }

    /// A coefficient on a grid of `size` cells between two corners.
    pub fn grid(&mut self, low: DVec3, high: DVec3, size: [u32; 3], values: GridValues) -> Coefficient {
        let grid = self.scene.media.grids.push(Grid { name: "grid".into(), size, values });
        let to_world = Transform::scale(high - low).then(Transform::translate(low));
        Coefficient::Grid { grid, to_world, scale: 1.0 }
    }

    /// Parallel light of a given irradiance on a surface that faces it.
    pub fn sunlight(&mut self, direction: Vec3, irradiance: f32) {
        let direction = direction.normalize();
        self.light(LightKind::Directional { direction, irradiance: Rgb::splat(irradiance) });
    }
}

/// A medium that is the same everywhere and in all channels.
pub fn grey_fog(sigma_t: f32, albedo: f32, phase: Phase) -> Medium {
    Medium::homogeneous("fog", Rgb::splat(sigma_t), Rgb::splat(albedo), phase)
}

/// The path tracer that knows of media, with paths of so many segments.
pub fn volpath(max_depth: Option<u32>) -> Method {
    Method::Path(PathConfig { max_depth, media: true, ..PathConfig::default() })
}

/// The photon mapper that shows what media send to the camera, all of it from `count` photons, or a tenth as many
/// beams.
pub fn medium_view(kind: VolumeKind, estimate: VolumeEstimate, count: u64) -> PhotonMapperConfig {
    PhotonMapperConfig {
        volume_photons: Some(if kind == VolumeKind::Beams { count / 10 } else { count }),
        volume_kind: kind,
        volume_estimate: estimate,
        single_scatter: DirectSource::Map,
        final_gather: FinalGather::Off,
        show: Show::Medium,
        ..PhotonMapperConfig::default()
    }
}

/// The ways to show light in media without any of the report's march, named.
pub fn medium_views(count: u64) -> Vec<(String, PhotonMapperConfig)> {
    let rays = PhotonMapperConfig {
        single_scatter: DirectSource::Rays,
        ..medium_view(VolumeKind::Points, VolumeEstimate::Beam, count)
    };
    vec![
        ("rays".into(), rays),
        ("points by beam".into(), medium_view(VolumeKind::Points, VolumeEstimate::Beam, count)),
        ("points by march".into(), medium_view(VolumeKind::Points, VolumeEstimate::March, count)),
        ("beams".into(), medium_view(VolumeKind::Beams, VolumeEstimate::Beam, count)),
    ]
}

/// The kernels that are normalised.
pub const KERNELS: [Kernel; 6] = [
    Kernel::Box,
    Kernel::Cone { k: 1.0 },
    Kernel::Cone { k: 1.5 },
    Kernel::Gaussian,
    Kernel::Epanechnikov,
    Kernel::Biweight,
];

/// The mean of each channel over a picture, for each seed.
pub fn channel_means(
    world: &World,
    method: &Method,
    samples_per_pixel: u32,
    seeds: Range<u64>,
) -> Vec<[f64; 3]> {
    seeds
        .map(|seed| {
            let image = render(world, method.clone(), samples_per_pixel, seed);
            let mut sum = [0.0; 3];
            for pixel in &image.pixels {
                for (sum, value) in sum.iter_mut().zip(pixel.to_array()) {
                    *sum += f64::from(value) / image.pixels.len() as f64;
                }
            }
            sum
        })
        .collect()
}

/// Where the photons of so many paths collide in media, those that come straight from a light included.
///
/// # Panics
/// Never: nothing cancels it.
pub fn collisions(world: &World, settings: &WalkSettings, paths: u64, seed: u64) -> VolumePhotons {
    let plan = PhotonPlan { volume: MapPlan { paths, ..MapPlan::default() }, ..PhotonPlan::default() };
    let targets = PhotonTargets {
        global: 0,
        caustic: 0,
        volume: paths,
        volume_kind: VolumeKind::Points,
        emit: Some(paths),
        emit_max: 1,
        store_direct: true,
        store_single_scatter: true,
    };
    let passes = volume_pass(world, settings, &plan, &targets, seed, 0, &Silent).expect("nothing cancels");
    let [InMedia::Points(points), _] = passes else { unreachable!("points were asked for") };
    points
}

/// That every light's books balance to rounding, and that roulette was fair: to 4 standard errors, which correct code
/// exceeds once in 16 000 books.
///
/// # Panics
/// If they do not.
#[track_caller]
pub fn expect_fair_books(world: &World, ledger: &Ledger) {
    for ((name, _), book) in world.lights().zip(&ledger.lights) {
        assert!(book.emitted.iter().sum::<f64>() > 0.0, "{name} gave off nothing");
        assert!(book.imbalance().abs() < ROUNDING, "{name}: {} of {book:?}", book.imbalance());
        assert!(book.roulette_z().abs() < 4.0, "{name}: roulette {}", book.roulette_z());
    }
}
