//! What trials find of made-up light, and what follows from made-up trials.

use nephroid_testkit::{ALPHA, sidak, z_test};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

use super::balance::{GatherRays, LATER, Variances, balance};
use super::trial::{PARTS, PixelTrial, SAMPLES, SETS};
use crate::integrator::CameraPlan;
use crate::transport::{MapPlan, PhotonPlan};

struct Numbers(Pcg32);

impl Numbers {
    fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// Of mean 0 and variance 1: the sum of twelve uniform numbers, which is nearly normal.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// From 10^-`decades` to 10^`decades`.
    fn spread(&mut self, decades: f64) -> f64 {
        libm::pow(10.0, decades * (2.0 * self.uniform() - 1.0))
    }
}

/// Pixels of different brightness, whose parts vary from set to set and from sample to sample as given, relative to
/// the pixel's light and a tenth of the mean.
fn pixels(of_maps: [f64; PARTS], of_sample: [f64; PARTS], count: usize) -> Vec<PixelTrial> {
    let mut numbers = Numbers(Pcg32::seed_from_u64(1));
    let brightness = |i: usize| if i.is_multiple_of(2) { 0.5 } else { 1.5 };
    (0..count)
        .map(|i| {
            let relative = brightness(i) + 0.1;
            let mut pixel = PixelTrial::default();
            for set in &mut pixel {
                let together = of_maps.map(|v| v.sqrt() * numbers.normal());
                for sample in set {
                    for part in 0..PARTS {
                        let noise = together[part] + of_sample[part].sqrt() * numbers.normal();
                        sample[part] = 0.25 * brightness(i) + relative * noise;
                    }
                }
            }
            pixel
        })
        .collect()
}

/// Twelve means over 20 000 pixels, which correct code fails in 1 % of all seeds. The hundredth that is left out where it
/// is largest takes with it some of the mean: 2 % of a variance of nine degrees of freedom and 6 % of one of two are
/// forgiven.
#[test]
fn variances_are_told_apart() {
    let (of_maps, of_sample) = ([0.0, 4e-4, 1e-4, 0.0], [9e-4, 1e-4, 0.0, 4e-4]);
    let count = 20_000;
    let found = Variances::of(&pixels(of_maps, of_sample, count));
    for part in 0..PARTS {
        let of_mean = of_maps[part] + of_sample[part] / SAMPLES as f64;
        for (name, found, exact, spread, trimmed) in [
            (
                "samples",
                found.of_sample[part],
                of_sample[part],
                of_sample[part] * (2.0f64 / 9.0).sqrt(),
                0.02,
            ),
            ("maps", found.of_maps[part], of_maps[part], of_mean, 0.06),
        ] {
            let forgiven = trimmed * if name == "maps" { of_mean } else { exact };
            let nearest = found.clamp(exact - forgiven, exact + forgiven);
            let outcome = z_test(found, nearest, (spread / (count as f64).sqrt()).max(1e-12));
            assert!(outcome.passes(sidak(ALPHA, 2 * PARTS)), "{name}, part {part}: {found} of {exact}");
        }
    }
}

#[test]
fn no_light_has_no_variance() {
    let dark = vec![[[[0.0; PARTS]; SAMPLES]; SETS]; 10];
    assert_eq!(Variances::of(&dark), Variances::default());
    assert_eq!(Variances::of(&[]), Variances::default());
}

/// One lucky sample among many pixels decides nothing.
#[test]
fn a_speck_is_left_out() {
    let mut pixels = pixels([0.0, 1e-4, 1e-4, 1e-4], [1e-4; PARTS], 500);
    let before = Variances::of(&pixels);
    pixels[17][1][2][0] += 30.0;
    let after = Variances::of(&pixels);
    // Its light makes the mean brighter and so all others a little less noisy.
    assert!((after.of_sample[0] / before.of_sample[0] - 1.0).abs() < 0.05, "{before:?} {after:?}");
}

fn tried(photons: [u64; 4]) -> PhotonPlan {
    let [global, caustic, volume, volume_caustic] = photons.map(|expected_photons| MapPlan {
        paths: expected_photons / 2 + 1000,
        expected_photons,
        ..MapPlan::default()
    });
    PhotonPlan { global, caustic, volume, volume_caustic }
}

/// Variance and cost of one unit of the camera: the stride's samples, one look-up, and its gather rays.
fn unit(variances: &Variances, costs: [f64; 3], camera: (u32, Option<u32>)) -> [f64; 2] {
    let [plain, gathered, caustic, medium] = variances.of_sample;
    let (stride, rays) = (f64::from(camera.0), camera.1.map_or(0.0, f64::from));
    let variance = (plain + medium) / stride + caustic + gathered / rays.max(1.0);
    [variance, stride * costs[0] + costs[1] + rays * costs[2]]
}

/// The error that is left after a work of one: variance times cost.
fn left(
    variances: &Variances,
    costs: [f64; 3],
    tried: &PhotonPlan,
    pixels: u64,
    factors: [f64; 4],
    camera: (u32, Option<u32>),
) -> f64 {
    let [mut variance, cost] = unit(variances, costs, camera);
    let mut cost = cost * pixels as f64;
    let of_maps = [variances.of_maps[1], variances.of_maps[2], variances.of_maps[3], variances.of_maps[3]];
    let maps = [tried.global, tried.caustic, tried.volume, tried.volume_caustic];
    for ((map, factor), of_map) in maps.iter().zip(factors).zip(of_maps) {
        if map.expected_photons > 0 {
            variance += LATER * of_map / factor;
            cost += factor * 2.0 * (map.paths + map.expected_photons) as f64;
        }
    }
    variance * cost
}

/// No other shares of photons leave less error for the same work (Neyman 1934).
#[test]
fn photons_are_shared_out_best() {
    let mut numbers = Numbers(Pcg32::seed_from_u64(2));
    let mut judged = 0;
    for _ in 0..200 {
        let variances = Variances {
            of_sample: [0, 1, 2, 3].map(|_| numbers.spread(1.0)),
            of_maps: [0, 1, 2, 3].map(|_| 10.0 * numbers.spread(0.5)),
        };
        let costs = [0, 1, 2].map(|_| 3.0 * numbers.spread(0.5));
        let (tried, pixels) = (tried([30_000, 20_000, 10_000, 0]), 40_000);
        let (factors, camera) = balance(&variances, costs, &tried, GatherRays::Planned, pixels);
        let total: f64 = [30e3, 20e3, 10e3].iter().zip(factors).map(|(n, factor)| n * factor).sum();
        // Where bounds have a say, shares are another matter.
        let unit_cost = unit(&variances, costs, (camera.stride, camera.gather_rays))[1] * pixels as f64;
        let paths = [tried.global, tried.caustic, tried.volume].map(|map| map.paths + map.expected_photons);
        let cost: f64 = paths.iter().zip(factors).map(|(n, factor)| 2.0 * *n as f64 * factor).sum();
        let within = (20_001.0..3_999_999.0).contains(&total) && (0.26..7.9).contains(&(cost / unit_cost));
        if !within || camera.samples_per_pixel != camera.stride {
            continue;
        }
        let unit = (camera.stride, camera.gather_rays);
        let of = |factors| left(&variances, costs, &tried, pixels, factors, unit);
        let best = of(factors);
        for map in 0..3 {
            for change in [0.7, 1.4] {
                let mut other = factors;
                other[map] *= change;
                assert!(of(other) > best, "{variances:?} {costs:?}: map {map} by {change} from {factors:?}");
            }
        }
        judged += 1;
    }
    assert!(judged > 100, "{judged}");
}

/// Strides and gather rays are few whole numbers; what is chosen is not far from the best of them.
#[test]
fn samples_and_rays_are_nearly_the_best() {
    let mut numbers = Numbers(Pcg32::seed_from_u64(3));
    let mut worst: f64 = 1.0;
    for gathers in [false, true].into_iter().cycle().take(400) {
        let of_sample = [0, 1, 2, 3].map(|_| numbers.spread(2.0));
        let variances = Variances { of_sample, ..Variances::default() };
        let costs = [0, 1, 2].map(|_| 3.0 * numbers.spread(0.5));
        let (_, camera) = balance(&variances, costs, &tried([30_000, 0, 0, 0]), rays(gathers), 10_000);
        let product = |camera| unit(&variances, costs, camera).iter().product::<f64>();
        let numbers = if gathers { (1..=16).map(Some).collect() } else { vec![None] };
        let best =
            [1, 2, 4].iter().flat_map(|s| numbers.iter().map(|r| product((*s, *r)))).fold(f64::MAX, f64::min);
        worst = worst.max(product((camera.stride, camera.gather_rays)) / best);
    }
    assert!(worst < 2.0, "{worst} times the error of the best");
}

fn rays(gathers: bool) -> GatherRays {
    if gathers { GatherRays::Planned } else { GatherRays::None }
}

/// Where few paths find a map, photons cost no more than some times what the camera does.
#[test]
fn rare_photons_have_their_price() {
    let map = MapPlan { paths: 300_000, expected_photons: 10, ..MapPlan::default() };
    let tried = PhotonPlan { global: map, ..PhotonPlan::default() };
    let variances = Variances { of_sample: [0.1; PARTS], of_maps: [0.0, 10.0, 0.0, 0.0] };
    let (factors, camera) = balance(&variances, [3.0, 1.0, 2.5], &tried, GatherRays::Planned, 4096);
    let unit_cost = unit(&variances, [3.0, 1.0, 2.5], (camera.stride, camera.gather_rays))[1] * 4096.0;
    let units = f64::from(camera.samples_per_pixel / camera.stride);
    assert!(factors[0] * 600_000.0 <= 8.01 * unit_cost * units, "{factors:?} {camera:?}");
}

/// A number that is asked for is sent.
#[test]
fn gather_rays_that_are_asked_for_are_sent() {
    let variances = Variances { of_sample: [1.0, 1e-6, 1.0, 0.0], of_maps: [0.0, 1.0, 1.0, 0.0] };
    let tried = tried([30_000, 30_000, 0, 0]);
    let (_, camera) = balance(&variances, [3.0, 1.0, 2.5], &tried, GatherRays::Asked(40), 4096);
    assert_eq!(camera.gather_rays, Some(40));
}

fn assert_sound(factors: [f64; 4], camera: &CameraPlan, gathers: bool, what: &str) {
    assert!(factors.iter().all(|f| f.is_finite() && *f >= 0.0), "{what}: {factors:?}");
    assert!((1..=16).contains(&camera.samples_per_pixel), "{what}: {camera:?}");
    assert!([1, 2, 4].contains(&camera.stride), "{what}: {camera:?}");
    assert!(camera.samples_per_pixel.is_multiple_of(camera.stride), "{what}: {camera:?}");
    assert_eq!(camera.gather_rays.is_some(), gathers, "{what}");
    assert!(camera.gather_rays.is_none_or(|rays| (1..=16).contains(&rays)), "{what}: {camera:?}");
}

/// Whatever trials found, every iteration has samples, and photons within their bounds.
#[test]
fn extremes_stay_within_bounds() {
    let values = [0.0, 1e-300, 1e-12, 1.0, 1e12, 1e150];
    for v in values {
        for w in values {
            for cost in [0.0, 1e-9, 1.0, 1e9] {
                for photons in [[0; 4], [1, 0, 0, 0], [30_000; 4], [0, 0, 5, 30_000]] {
                    for gathers in [false, true] {
                        let variances = Variances { of_sample: [v, w, v, w], of_maps: [0.0, w - v, v, -w] };
                        let tried = tried(photons);
                        let (factors, camera) =
                            balance(&variances, [1.0, cost, cost], &tried, rays(gathers), 100);
                        let what = format!("{v} {w} {cost} {photons:?} {gathers}");
                        assert_sound(factors, &camera, gathers, &what);
                        let total: f64 = photons.iter().zip(factors).map(|(n, f)| *n as f64 * f).sum();
                        assert!(total <= 1.001 * 4e6, "{what}: {total}");
                        for (map, factor) in photons.iter().zip(factors) {
                            // Maps that trials found empty are tried again by few paths.
                            assert!(factor > 0.0, "{what}: {map} photons by {factor}");
                        }
                    }
                }
            }
        }
    }
}
