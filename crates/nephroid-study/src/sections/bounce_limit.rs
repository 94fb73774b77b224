//! What a limit of twenty bounces takes away.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig};
use nephroid::laboratory::record_photons;
use nephroid::math::Vec3;
use nephroid::session::RenderSettings;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::scenes::lights_in_sphere;
use crate::section::{Section, Stop, Weight};

/// The random walk.
pub const SECTION: Section = Section {
    id: "question-1-2",
    report: "Question 1.2",
    title: "the random walk, and what its limit of 20 bounces loses",
    weight: Weight { full: 4.0, quick: 1.5 },
    run,
};

/// Bounces after which the report's walk ends.
const BOUNCES: u32 = 20;

/// Segments of a path from the lamp to the lens with so many bounces before the photon is stored: one from the lamp, one
/// after each bounce, and the one to the lens.
const MAX_DEPTH: u32 = BOUNCES + 2;

const REFLECTANCES: [f32; 3] = [0.7, 0.9, 0.95];

/// Indirect power that is stored with and without the limit, in W.
struct Power {
    reflectance: f64,
    paths: f64,
    limited: f64,
    whole: f64,
}

impl Power {
    fn lost(&self) -> f64 {
        1.0 - self.limited / self.whole
    }

    /// Of all indirect light, ρ + ρ² + …, what is left out from the 21st bounce on.
    fn closed_form(&self) -> f64 {
        libm::pow(self.reflectance, f64::from(BOUNCES))
    }

    /// Bounds the standard deviation of [`Self::lost`].
    ///
    /// Both runs follow the same paths. Of one path, j further photons have the chance ρ^(20 + j): the second moment of
    /// what it loses is less than ρ²¹(1 + ρ)/(1 − ρ)², beside a mean of ρ/(1 − ρ) in all, which itself has a relative
    /// variance of 1/ρ.
    fn deviation(&self) -> f64 {
        let rho = self.reflectance;
        let lost = libm::sqrt(libm::pow(rho, 19.0) * (1.0 + rho) / self.paths);
        lost + self.closed_form() / libm::sqrt(rho * self.paths)
    }
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let paths = lab.pick(150_000, 50_000);
    let of_sphere = |&rho: &f32| {
        let (limited, whole) =
            (indirect(lab, rho, paths, Some(MAX_DEPTH))?, indirect(lab, rho, paths, None)?);
        Ok(Power { reflectance: f64::from(rho), paths: paths as f64, limited, whole })
    };
    let powers: Vec<Power> = REFLECTANCES.iter().map(of_sphere).collect::<Result<_, Stop>>()?;

    let mut body = Body::new();
    body.say(
        "The report's walk ends when nothing is hit, when roulette absorbs, or after 20 bounces, \"because the contribution \
         of the next bounds is likely to be insignificant\". In a closed grey sphere the n-th bounce brings ρⁿ, so the limit \
         loses ρ²⁰ of all indirect light: nothing to speak of at a reflectance of 0.7, a third of it at 0.95.",
    );
    body.say(
        "Roulette ends every path by itself and without bias, so there is no limit here unless one is asked for. These are \
         the same paths with --max-depth 22, which is 20 bounces, and without.",
    );
    let row = |p: &Power| {
        let percent = |part: f64| format!("{} %", format::number(100.0 * part));
        let reflectance = format::number(p.reflectance);
        vec![
            reflectance,
            format::number(p.whole),
            format::number(p.limited),
            percent(p.lost()),
            percent(p.closed_form()),
        ]
    };
    let head = ["Reflectance ρ", "Indirect, W", "With the limit, W", "Lost", "ρ²⁰"];
    body.table(
        "Indirect light stored on a sphere about a lamp of 4π W",
        &head,
        powers.iter().map(row).collect(),
    );
    let curve = (0..=95).map(|i| 0.5 + f64::from(i) / 200.0).map(|rho| (rho, 100.0 * libm::pow(rho, 20.0)));
    let chart = Chart::new("reflectance", "indirect light lost, %").line("ρ²⁰", curve.collect());
    let chart = chart.points("measured", powers.iter().map(|p| (p.reflectance, 100.0 * p.lost())).collect());
    body.plot(chart.draw(
        "A curve that stays near zero up to a reflectance of 0.8 and then rises steeply to two thirds at 0.98, with three \
         measured points on it.",
        "What a limit of 20 bounces loses of all indirect light.",
    )?);
    let number = |p: &Power| {
        let (expected, room) = (100.0 * p.closed_form(), 600.0 * p.deviation());
        Number::within(
            &format!("Lost of indirect light at ρ = {}", format::number(p.reflectance)),
            100.0 * p.lost(),
            "%",
            [(expected - room).max(0.0), expected + room],
            "ρ²⁰ and six standard deviations of paths that end by roulette: wrongly outside of it less than once in a \
             million runs.",
        )
    };
    let all = |p: &Power| {
        let (rho, flux) = (p.reflectance, 4.0 * std::f64::consts::PI);
        let (expected, room) = (flux * rho / (1.0 - rho), 6.0 / libm::sqrt(rho * p.paths));
        Number::within(
            &format!("Indirect light without a limit at ρ = {}", format::number(rho)),
            p.whole,
            "W",
            [expected * (1.0 - room), expected * (1.0 + room)],
            "4π ρ/(1 − ρ) and six standard deviations: a path stores a geometric number of photons.",
        )
    };
    body.numbers(powers.iter().flat_map(|p| [number(p), all(p)]).collect());
    body.finding(
        "Question 1.2",
        "The walk: specular bounces store nothing, the first hit is left to direct light, roulette decides the rest.",
        &format!(
            "A limit of 20 bounces loses {} % of indirect light at ρ = 0.9. By algebra, and not by a run: roulette by the mean albedo \
             keeps the mean energy in colour, too.",
            format::number(100.0 * powers[1].lost())
        ),
        "What is lost is ρ²⁰. Power times albedo over the chance to survive is right in the mean, channel by channel.",
    );
    Ok(body)
}

fn indirect(lab: &Lab, reflectance: f32, paths: u64, max_depth: Option<u32>) -> Result<f64, Stop> {
    let world = lights_in_sphere(&[(Vec3::ZERO, 1.0)], Rgb::splat(reflectance))?;
    let config = PhotonMapperConfig {
        emit: Some(paths),
        direct: DirectSource::Rays,
        final_gather: FinalGather::Off,
        max_depth,
        ..PhotonMapperConfig::default()
    };
    let settings =
        RenderSettings { method: Method::PhotonMapper(config), samples_per_pixel: 1, seed: lab.seed() };
    let stored = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    Ok(stored.photons.iter().map(|p| f64::from(p.photon.power.g)).sum())
}
