//! The camera pass: samples of every pixel, tile by tile.

use rayon::prelude::*;

use crate::film::FilterSampler;
use crate::math::{Ray, Vec2};
use crate::observer::{Observer, Phase, Work};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::world::World;

/// Side of the square of pixels that is one piece of work.
const TILE: u32 = 16;

/// Which samples to take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraPass {
    pub seed: u64,
    /// The iteration, or that in whose name samples of a series of iterations are numbered through.
    pub iteration: u64,
    /// Number of the first sample of each pixel, among those of that name.
    pub first_sample: u64,
    /// How many samples of each pixel.
    pub samples: u32,
}

/// Names the numbers of samples beside others: more than what tells branches of a path apart.
const BESIDE: u64 = 1 << 32;

/// One sample of a pixel, as an integrator meets it.
#[derive(Clone, Debug)]
pub(crate) struct PixelSample<'f> {
    pub ray: Ray,
    /// Names the pixel and the purpose; derive the keys of further sequences from it.
    pub key: Key,
    /// Number of the sample within the pixel and the iteration, or the series of them.
    pub index: u64,
    pub sampler: Sampler,
    filter: &'f FilterSampler,
    pixel: (u32, u32),
}

impl<'f> PixelSample<'f> {
    /// A sample of the pixel that `key` names, and its weight by the filter.
    pub fn new(
        world: &World,
        filter: &'f FilterSampler,
        key: Key,
        pixel: (u32, u32),
        index: u64,
    ) -> (Self, f32) {
        let mut sampler = Sampler::new(Sequence::Sobol, key, index);
        let offset = filter.sample(sampler.next_2d());
        // Drawn without a lens, too, so that later sets of four stay aligned.
        let u_lens = sampler.next_2d();
        let (x, y) = pixel;
        let position = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset.offset;
        let ray = world.camera().ray(position, u_lens);
        (Self { ray, key, index, sampler, filter, pixel }, offset.weight)
    }

    /// Another of the same pixel, by numbers of its own.
    pub fn beside(&self, world: &World, index: u64) -> Self {
        Self::new(world, self.filter, self.key.with(BESIDE), self.pixel, index).0
    }
}

/// The key of the samples of a pixel of the whole picture.
pub(crate) fn pixel_key(seed: u64, iteration: u64, (x, y): (u32, u32)) -> Key {
    Key::new(seed, iteration, Stream::Camera).with(u64::from(y) << 32 | u64::from(x))
}

/// What a camera pass gathered.
pub(crate) struct Exposure<P, T> {
    /// One for each pixel of the window, row by row.
    pub sums: Vec<P>,
    /// What the estimates added up besides.
    pub total: T,
    /// Whether every pixel has its samples; where the observer cancelled, some tiles have none.
    pub complete: bool,
}

/// Takes samples of every pixel of the window with `estimate`, which adds each with its weight to the sum
/// `P` of its pixel, and to a total `T`. The sums are the same however the work is shared out.
pub(crate) fn camera_pass<P: Clone + Default + Send, T: Default + Send, S>(
    world: &World,
    pass: &CameraPass,
    observer: &dyn Observer,
    scratch: impl Fn() -> S + Sync,
    join: impl Fn(&mut T, &T),
    estimate: impl Fn(PixelSample, f32, &mut S, &mut P, &mut T) + Sync,
) -> Exposure<P, T> {
    let window = world.scene().film.window();
    let filter = FilterSampler::new(world.scene().film.filter);
    let pixels = u64::from(window.width) * u64::from(window.height);
    let work = Work::begin(observer, Phase::Camera, pixels * u64::from(pass.samples));
    let columns = window.width.div_ceil(TILE);
    let tiles: Vec<Option<(Vec<P>, T)>> = (0..columns * window.height.div_ceil(TILE))
        .into_par_iter()
        .map_init(&scratch, |scratch, tile| {
            let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
            let (x1, y1) = ((x0 + TILE).min(window.width), (y0 + TILE).min(window.height));
            if work.cancelled() {
                return None;
            }
            let mut total = T::default();
            let mut sums = Vec::with_capacity(((x1 - x0) * (y1 - y0)) as usize);
            for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                let place = (x + window.x, y + window.y);
                let key = pixel_key(pass.seed, pass.iteration, place);
                let mut sum = P::default();
                for index in pass.first_sample..pass.first_sample + u64::from(pass.samples) {
                    let (sample, weight) = PixelSample::new(world, &filter, key, place, index);
                    estimate(sample, weight, scratch, &mut sum, &mut total);
                }
                sums.push(sum);
            }
            work.advance(sums.len() as u64 * u64::from(pass.samples));
            Some((sums, total))
        })
        .collect();
    let complete = tiles.iter().all(Option::is_some);
    let mut film = vec![P::default(); pixels as usize];
    let mut total = T::default();
    for (tile, done) in (0..).zip(tiles) {
        let Some((sums, part)) = done else { continue };
        join(&mut total, &part);
        let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
        let width = (x0 + TILE).min(window.width) - x0;
        for (row, sums) in (y0..).zip(sums.chunks(width as usize)) {
            let start = row as usize * window.width as usize + x0 as usize;
            film[start..start + sums.len()].clone_from_slice(sums);
        }
    }
    Exposure { sums: film, total, complete }
}
