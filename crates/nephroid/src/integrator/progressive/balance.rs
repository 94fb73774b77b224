//! From what trials found to what each iteration does: work goes where it takes most of the error away.

use super::trial::{PARTS, PixelTrial, SAMPLES, SETS};
use crate::integrator::Effort;
use crate::integrator::photon_mapper::CameraPlan;
use crate::transport::{MapPlan, PhotonPlan};

/// What a ray and what is done at its end cost, in rays of a path tracer, in a picture of 2^14 pixels. Maps grow with the
/// picture, and with them the time that look-ups wait for memory: as its cube root, up to four times, as measured.
const RAY: f64 = 1.5;

/// Estimates of later iterations blur less, and what photons make them vary by grows. This is for the sixteenth.
pub(super) const LATER: f64 = 2.5;

/// Gather rays of a sample at most.
const MOST_GATHER_RAYS: f64 = 16.0;

/// Camera samples of a pixel in an iteration at most.
pub(super) const MOST_SAMPLES: u32 = 16;

/// Photons in all maps together, at least and at most.
const PHOTONS: [f64; 2] = [20_000.0, 4_000_000.0];

/// The cost of photons is at least this part of that of camera samples. Variance does not tell that more photons also
/// blur less.
const LEAST_FOR_PHOTONS: f64 = 0.25;

/// And at most so many times that, however much photons vary or how few of them are found.
const MOST_FOR_PHOTONS: f64 = 8.0;

/// The share of pixels whose variance is left out, where it is largest: one lucky sample must not decide.
const LEFT_OUT: f64 = 0.01;

/// Relative variances, means over the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Variances {
    /// Of one sample among those with the same maps, by part.
    pub of_sample: [f64; PARTS],
    /// Of the mean over all samples with the same maps among sets of maps, by part.
    pub of_maps: [f64; PARTS],
}

impl Variances {
    /// One-way analysis of variance for each pixel and part, relative to the pixel's light.
    pub fn of(pixels: &[PixelTrial]) -> Self {
        Self::over(pixels, trimmed_mean)
    }

    /// The same of all pixels, however large their variance is.
    pub fn of_all(pixels: &[PixelTrial]) -> Self {
        Self::over(pixels, |values| values.iter().sum::<f64>() / values.len().max(1) as f64)
    }

    fn over(pixels: &[PixelTrial], mean_of: impl Fn(Vec<f64>) -> f64) -> Self {
        let light = |pixel: &PixelTrial| {
            let all = pixel.iter().flatten().flatten().sum::<f64>();
            all.max(0.0) / (SETS * SAMPLES) as f64
        };
        let mean = pixels.iter().map(light).sum::<f64>() / pixels.len().max(1) as f64;
        let over = |by: &dyn Fn(&PixelTrial, usize) -> f64| {
            [0, 1, 2, 3].map(|part| {
                let relative = |p: &PixelTrial| by(p, part) / (light(p) + 0.1 * mean).powi(2);
                mean_of(pixels.iter().map(relative).collect())
            })
        };
        if mean <= 0.0 {
            return Self::default();
        }
        Self { of_sample: over(&|p, part| within(p, part)), of_maps: over(&|p, part| between(p, part)) }
    }
}

/// The mean variance of samples with the same maps.
fn within(pixel: &PixelTrial, part: usize) -> f64 {
    pixel.iter().map(|set| variance(&set.map(|sample| sample[part]))).sum::<f64>() / SETS as f64
}

/// The variance that maps add to the mean of infinitely many samples; below zero by chance.
fn between(pixel: &PixelTrial, part: usize) -> f64 {
    let means = pixel.map(|set| set.iter().map(|sample| sample[part]).sum::<f64>() / SAMPLES as f64);
    variance(&means) - within(pixel, part) / SAMPLES as f64
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
}

fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = values.len() - (values.len() as f64 * LEFT_OUT) as usize;
    values[..kept].iter().sum::<f64>() / kept.max(1) as f64
}

/// Whether gather rays are sent, and how many by each sample that reads the maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GatherRays {
    /// None: all maps are read on the spot.
    None,
    /// As many as are worth it.
    Planned,
    /// So many.
    Asked(u32),
}

/// What to do in each iteration of a picture of so many pixels, after a trial of `tried`.
///
/// An iteration has camera units, each with some plain samples of every pixel, of which one reads the maps and sends
/// gather rays; and photons for each map. If a kind of work has the variance v for each piece of it and the cost c, then
/// shares ∝ √(v/c) have the least error for their cost (Neyman 1934). Photons and samples are not tied to one another by
/// anything else: estimates from twice the photons that blur as much vary half as much.
pub(super) fn balance(
    variances: &Variances,
    costs: [f64; 3],
    tried: &PhotonPlan,
    rays: GatherRays,
    pixels: u64,
) -> ([f64; 4], CameraPlan) {
    let [plain, reading, gathering] = costs;
    let [v_plain, v_gathered, v_caustic, v_medium] = variances.of_sample.map(|v| v.max(1e-9));
    let v_plain = v_plain + v_medium;
    let share = |v: f64, cost: f64| (v / cost.max(1e-3)).sqrt();
    let gathers = rays != GatherRays::None;
    // What is read on the spot.
    let v_read = if gathers { v_caustic } else { v_caustic + v_gathered };
    let (samples, reads) = (share(v_plain, plain), share(v_read, reading));
    let wanted = if gathers { share(v_gathered, gathering) } else { 0.0 };
    // Where rays or look-ups are wanted more than samples, each sample reads and sends some.
    let stride = [4, 2].into_iter().find(|s| samples >= f64::from(*s) * reads.max(wanted)).unwrap_or(1);
    let per_unit = samples / f64::from(stride);
    let gather_rays = match rays {
        GatherRays::None => 0.0,
        GatherRays::Planned => (wanted / per_unit.max(reads)).clamp(1.0, MOST_GATHER_RAYS).round(),
        GatherRays::Asked(asked) => f64::from(asked.max(1)),
    };
    let unit_cost = (f64::from(stride) * plain + reading + gather_rays * gathering) * pixels as f64;
    let unit_variance =
        v_plain / f64::from(stride) + v_read + if gathers { v_gathered / gather_rays } else { 0.0 };
    let [_, of_global, of_caustic, of_media] = variances.of_maps;
    let maps = [
        (tried.global, of_global),
        (tried.caustic, of_caustic),
        (tried.volume, of_media),
        (tried.volume_caustic, of_media),
    ];
    let costs = maps.map(|(map, _)| map.rays());
    // Of each map as a multiple of what was tried, for one unit of the camera.
    let mut factors = [0, 1, 2, 3].map(|i| {
        let v = maps[i].1.max(0.01 * unit_variance) * LATER;
        if costs[i] > 0.0 { (v * unit_cost / (unit_variance * costs[i])).sqrt() } else { 0.0 }
    });
    let sum = |of: &dyn Fn(usize) -> f64| (0..maps.len()).map(of).sum::<f64>();
    let photon_cost = sum(&|i| costs[i] * factors[i]);
    let total = sum(&|i| maps[i].0.expected_photons as f64 * factors[i]);
    let mut units = 1.0;
    if total > 0.0 {
        let most_units = f64::from((MOST_SAMPLES / stride).max(1));
        units = (PHOTONS[0] / total).ceil().clamp(1.0, most_units);
        let least = LEAST_FOR_PHOTONS * unit_cost / photon_cost;
        let most = MOST_FOR_PHOTONS * unit_cost / photon_cost;
        let of_a_unit = (PHOTONS[0] / (units * total)).max(least).max(1.0).min(most);
        let scale = (units * of_a_unit).min(PHOTONS[1] / total);
        factors = factors.map(|factor| factor * scale);
    }
    // A map that trials found empty is tried in each iteration, too.
    let factors = [0, 1, 2, 3].map(|i| if maps[i].0.expected_photons == 0 { 1.0 } else { factors[i] });
    let camera = CameraPlan {
        samples_per_pixel: units as u32 * stride,
        stride,
        gather_rays: gathers.then_some(gather_rays as u32),
        ..CameraPlan::default()
    };
    (factors, camera)
}

fn cost_of_ray(pixels: u64) -> f64 {
    let growth = libm::cbrt(pixels as f64 / 16_384.0);
    RAY * growth.clamp(1.0, 4.0)
}

/// What an iteration of a plan takes, and how much it varies.
pub(super) fn effort(
    variances: &Variances,
    [plain, reading, gathering]: [f64; 3],
    tried: &PhotonPlan,
    (photons, camera): (&PhotonPlan, &CameraPlan),
    pixels: u64,
) -> Effort {
    let [v_plain, v_gathered, v_caustic, v_medium] = variances.of_sample;
    let samples = f64::from(camera.samples_per_pixel);
    let reads = samples / f64::from(camera.stride);
    let gathered = f64::from(camera.gather_rays.unwrap_or(1));
    let of_samples = (v_plain + v_medium) / samples + (v_caustic + v_gathered / gathered) / reads;
    let [_, of_global, of_caustic, of_media] = variances.of_maps;
    let maps = [
        (tried.global, photons.global, of_global),
        (tried.caustic, photons.caustic, of_caustic),
        (tried.volume, photons.volume, of_media),
        (tried.volume_caustic, photons.volume_caustic, of_media),
    ];
    let of_map = |(tried, planned, varies): (MapPlan, MapPlan, f64)| {
        let more = planned.paths as f64 / tried.paths.max(1) as f64;
        if tried.expected_photons > 0 { varies.max(0.0) * LATER / more.max(1e-9) } else { 0.0 }
    };
    let for_photons: f64 = maps.iter().map(|(_, planned, _)| planned.rays()).sum();
    let sent = camera.gather_rays.map_or(0.0, |rays| reads * f64::from(rays) * gathering);
    Effort {
        variance: of_samples + maps.into_iter().map(of_map).sum::<f64>(),
        rays: cost_of_ray(pixels) * (samples * plain + reads * reading + sent + for_photons / pixels as f64),
    }
}
