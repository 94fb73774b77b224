//! Views that turn pictures into measurements: parallel rays onto a plane, and renders with several
//! seeds, each of them an independent sample of every pixel.

use nephroid::camera::Projection;
use nephroid::integrator::{
    DirectSource, FinalGather, LightTracerConfig, Method, PathConfig, PhotonMapperConfig, PpmConfig, Show,
};
use nephroid::laboratory::{MapPhotons, record_photons};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::world::World;

use crate::slopes::{iterate_to, pixels};
use crate::{Builder, iterations};

impl Builder {
    /// A scene seen by parallel rays from `origin` towards `target`, on a film of `width` by `height`
    /// square pixels; the width spans 2 · `half_width`.
    ///
    /// # Panics
    /// If the origin is the target.
    pub fn parallel_view(origin: Vec3, target: Vec3, half_width: f64, width: u32, height: u32) -> Self {
        let mut builder = Self::seen_from(origin, target, 45.0, width);
        let camera = &mut builder.scene.camera;
        camera.to_world = Transform::scale(DVec3::splat(half_width)).then(camera.to_world);
        camera.projection = Projection::Orthographic;
        builder.scene.film.height = height;
        builder
    }
}

/// Where the middle of each pixel's beam starts, row by row, for a [`Builder::parallel_view`].
pub fn pixel_origins(world: &World) -> Vec<DVec3> {
    let film = world.scene().film;
    let (w, h) = (f64::from(film.width), f64::from(film.height));
    let to_world = world.scene().camera.to_world;
    (0..film.height)
        .flat_map(|y| (0..film.width).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)))
        .map(|(x, y)| {
            let local = DVec3::new(1.0 - 2.0 * x / w, (1.0 - 2.0 * y / h) * h / w, 0.0);
            to_world.0.transform_point3(local)
        })
        .collect()
}

/// The means of the channels of each pixel, one picture for each seed.
pub fn renders(
    world: &World,
    method: &Method,
    samples_per_pixel: u32,
    seeds: std::ops::Range<u64>,
) -> Vec<Vec<f64>> {
    iterated_renders(world, method, iterations(method), samples_per_pixel, seeds)
}

/// The same after so many iterations.
pub fn iterated_renders(
    world: &World,
    method: &Method,
    iterations: u64,
    samples_per_pixel: u32,
    seeds: std::ops::Range<u64>,
) -> Vec<Vec<f64>> {
    let render = |seed| {
        let settings = RenderSettings { method: method.clone(), samples_per_pixel, seed };
        let mut session = Session::new(world, settings, &Silent);
        iterate_to(&mut session, iterations);
        pixels(&session)
    };
    seeds.map(render).collect()
}

/// The mean over all pixels, one for each seed.
pub fn mean_radiances(
    world: &World,
    method: &Method,
    samples_per_pixel: u32,
    seeds: std::ops::Range<u64>,
) -> Vec<f64> {
    let mean = |picture: Vec<f64>| picture.iter().sum::<f64>() / picture.len() as f64;
    renders(world, method, samples_per_pixel, seeds).into_iter().map(mean).collect()
}

/// The means of square blocks of pixels of pictures `width` wide: for each block, row by row, one number
/// from each picture. `side` divides both of a picture's sides.
pub fn block_samples(pictures: &[Vec<f64>], width: usize, side: usize) -> Vec<Vec<f64>> {
    let columns = width / side;
    let pixels = pictures.first().map_or(0, Vec::len);
    let mut blocks = vec![vec![0.0; pictures.len()]; pixels / (side * side)];
    for (number, picture) in pictures.iter().enumerate() {
        for (i, value) in picture.iter().enumerate() {
            let block = &mut blocks[i / width / side * columns + i % width / side];
            block[number] += value / (side * side) as f64;
        }
    }
    blocks
}

/// The samples `b` scaled by a factor between 1 − `bias` and 1 + `bias` that brings their mean as near as
/// it can to the mean of `a`: a test that both have the same mean then forgives as much.
pub fn forgiving(a: &[f64], b: &[f64], bias: f64) -> Vec<f64> {
    let mean = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
    let factor = (mean(a) / mean(b)).clamp(1.0 - bias, 1.0 + bias);
    b.iter().map(|v| v * factor).collect()
}

/// The path tracer without limits.
pub fn path() -> Method {
    Method::Path(PathConfig::default())
}

/// The photon mapper with `photons` photons wanted in each map, all else by default.
pub fn photon_mapper(photons: u64) -> PhotonMapperConfig {
    PhotonMapperConfig { photons, caustic_photons: photons, ..PhotonMapperConfig::default() }
}

/// The photon mapper that shows one part of the light as the maps have it on the spot, from `paths`
/// paths for each map.
pub fn map_view(show: Show, paths: u64) -> PhotonMapperConfig {
    PhotonMapperConfig {
        emit: Some(paths),
        direct: if show == Show::Direct { DirectSource::Map } else { DirectSource::Rays },
        final_gather: FinalGather::Off,
        show,
        ..PhotonMapperConfig::default()
    }
}

/// Progressive photon mapping with the photons and the neighbours that are given.
pub fn progressive(mapper: PhotonMapperConfig) -> Method {
    let plan = PpmConfig { plan_photons: false, plan_neighbours: false, ..PpmConfig::default() };
    Method::Ppm(PpmConfig { mapper, ..plan })
}

/// The light tracer, with paths of so many segments.
pub fn light_tracer(max_depth: Option<u32>) -> Method {
    Method::LightTracer(LightTracerConfig { max_depth })
}

/// The photons of an iteration of the photon mapper; `None` is for those who cancel.
pub fn photons_of(
    world: &World,
    config: &PhotonMapperConfig,
    samples_per_pixel: u32,
    seed: u64,
    iteration: u64,
) -> Option<MapPhotons> {
    let method = Method::PhotonMapper(config.clone());
    record_photons(world, &RenderSettings { method, samples_per_pixel, seed }, iteration, &Silent)
}
