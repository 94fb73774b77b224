//! Photons in fog that interact at steps of one length, and at distances of the exponential law.

use nephroid::color::Rgb;
use nephroid::integrator::{MapName, Method, PhotonMapperConfig};
use nephroid::laboratory::record_photons;
use nephroid::math::{Ray, Vec3, warp};
use nephroid::photon_map::{
    Bandwidth, Kernel, NearestList, VolumeMap, VolumePhoton, VolumePhotons, VolumeQuery,
};
use nephroid::sampling::Sampler;
use nephroid::texture::Image;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::statistics::KolmogorovSmirnov;
use crate::tracer::{self, Pinhole};
use crate::wrong;

/// Figure 3.8.
pub const SECTION: Section = Section {
    id: "fig-3-8",
    report: "Fig 3.8",
    title: "rings of photons in fog",
    weight: Weight { full: 40.0, quick: 2.0 },
    run,
};

/// Of the fog, in 1/m, as in the report.
const SIGMA_T: f64 = 0.9;

/// σ_s / σ_t.
const ALBEDO: f64 = 0.4 / 0.9;

/// Photons in the fog, as in the report.
const PHOTONS: usize = 15_000;

/// The length of the steps, in m: the report does not name it.
const STEP: f64 = 0.4;

/// How far a photon flies before it interacts, if it does before `end`.
type Distance = fn(end: f64, numbers: &mut Sampler) -> Option<f64>;

/// Flights of photons straight from the lamp that ended in the fog: how far, and how far they could have flown.
type Flights = Vec<[f64; 2]>;

fn exponential(end: f64, numbers: &mut Sampler) -> Option<f64> {
    let d = -libm::log1p(-f64::from(numbers.next_1d())) / SIGMA_T;
    (d < end).then_some(d)
}

fn by_steps(end: f64, numbers: &mut Sampler) -> Option<f64> {
    wrong::distance_by_steps(SIGMA_T, STEP, end, || f64::from(numbers.next_1d()))
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let recipe = lab.recipe("report-3-8").side(lab.pick(216, 48));
    let (world, settings) = lab.world(&recipe)?;
    let right = lab.render(&recipe)?;
    let (steps, step_flights) = walk(lab, &world, by_steps, 1)?;
    let (law, law_flights) = walk(lab, &world, exponential, 2)?;
    let slices = [slice(lab, &world, &steps)?, slice(lab, &world, &law)?];
    let (rings, none) = (picture(lab, &world, steps)?, picture(lab, &world, law)?);

    let mut body = Body::new();
    body.say(
        "Photons that may interact only at every so many centimetres of their way lie on spheres around the lamp, and the fog shows \
         them as rings. Distances drawn from the exponential law make none. The pair is of the fog's light alone, from \
         15 000 photons each; what surfaces send back is left out.",
    );
    body.say(
        "The report was right to change the method. Its text then goes too far: after drawing a distance it asks once more whether the \
         photon interacts, see Fig 3.7.",
    );
    let look = Look::exposed(1.0);
    body.pair(
        Picture::new(
            &rings,
            &look,
            "A lamp in fog with bright concentric rings around it.",
            "Wrong: photons by the study's own tracer, in steps of 0.4 m",
        )?,
        Picture::new(
            &none,
            &look,
            "A lamp in fog with an even glow around it.",
            "Right: the same with exponential distances",
        )?,
    );
    let [ring_slice, even_slice] = slices;
    body.pair(
        Picture::new(
            &ring_slice,
            &Look::drawn(),
            "Dots on concentric rings around a lamp, and some between them.",
            "Wrong: the photons within 15 cm of a plane through the lamp",
        )?,
        Picture::new(
            &even_slice,
            &Look::drawn(),
            "Dots around a lamp, denser near it, without rings.",
            "Right: the same slice",
        )?,
    );
    body.picture(Picture::of(
        &right,
        &Look::exposed(0.0),
        "A box with two spheres in fog; the lamp glows without rings.",
        "Nephroid's picture of the scene: light scattered once comes by rays to the lamp",
    )?);

    let library = library_flights(lab, &world, &settings)?;
    let tests = [("Steps", &step_flights), ("Exponential", &law_flights), ("Nephroid's photons", &library)]
        .map(|(name, flights)| (name, flights, KolmogorovSmirnov::of_even(&even(flights))));
    let histogram = |flights: &Flights| -> Vec<(f64, f64)> {
        let width = 0.1;
        let count = |i: usize| flights.iter().filter(|f| (f[0] / width) as usize == i).count();
        (0..16)
            .map(|i| ((i as f64 + 0.5) * width, count(i) as f64 / flights.len().max(1) as f64 / width))
            .collect()
    };
    let chart = tests.iter().fold(
        Chart::new("first flight, m", "share of photons per metre").from(0.0),
        |chart, (name, flights, _)| chart.points(name, histogram(flights)),
    );
    body.plot(chart.draw(
        "Three histograms of distances from the lamp: that of steps has spikes, the others fall smoothly and lie on one another.",
        "How far photons fly from the lamp to their first interaction in the fog.",
    )?);
    let row = |(name, flights, test): &(&str, &Flights, KolmogorovSmirnov)| {
        let cells = [flights.len() as f64, test.distance, test.p_value].map(format::number);
        [vec![(*name).to_owned()], cells.to_vec()].concat()
    };
    let head = ["Distances", "Flights", "Kolmogorov and Smirnov's distance", "p"];
    body.table(
        "First flights against the exponential law, cut off where each meets a surface",
        &head,
        tests.iter().map(row).collect(),
    );
    let jump = -libm::expm1(-SIGMA_T * STEP);
    let once = "The law itself falls below 10⁻⁴ once in 10 000 seeds.";
    body.numbers(vec![
        Number::within(
            "Distance of Kolmogorov and Smirnov, steps",
            tests[0].2.distance,
            "",
            [0.5 * jump, 1.0],
            "Half of the first step's share of all, 1 − e^(−σ_t Δ), at least: all of it lies in one place.",
        ),
        Number::within("p, exponential", tests[1].2.p_value, "", [1e-4, 1.0], once),
        Number::within("p, Nephroid's photons", tests[2].2.p_value, "", [1e-4, 1.0], once),
    ]);
    body.finding(
        "Fig 3.8",
        "Photons that interact at fixed steps make rings; drawn distances do not.",
        "Nothing in the remedy.",
        "Distances of interactions follow e^(−σ_t d), and steps of one length have a few values only.",
    );
    Ok(body)
}

/// What would be even on [0, 1] if distances followed the law.
fn even(flights: &Flights) -> Vec<f64> {
    flights.iter().map(|[d, end]| libm::expm1(-SIGMA_T * d) / libm::expm1(-SIGMA_T * end)).collect()
}

/// Photons where they are scattered, until there are enough, and first flights. Paths end where they meet a surface.
fn walk(
    lab: &Lab,
    world: &World,
    distance: Distance,
    purpose: u64,
) -> Result<(VolumePhotons, Flights), Stop> {
    let (lamp, intensity) = tracer::lamp(world)?;
    let mut numbers = lab.sampler(0x308 + purpose);
    let (mut photons, mut flights, mut emitted) = (Vec::new(), Vec::new(), 0);
    while photons.len() < PHOTONS {
        if emitted % 4096 == 0 {
            lab.check()?;
        }
        emitted += 1;
        let mut ray = Ray::new(lamp, warp::square_to_sphere(numbers.next_2d()));
        for depth in 1.. {
            let Some(hit) = world.intersect(&ray) else { break };
            let end = f64::from(hit.t);
            let Some(d) = distance(end, &mut numbers) else { break };
            if depth == 1 {
                flights.push([d, end]);
            }
            // Absorbed with the rest of the chance, and stored with its whole power where it is not.
            if f64::from(numbers.next_1d()) >= ALBEDO {
                break;
            }
            let position = ray.at(d as f32);
            let power = intensity * (4.0 * std::f32::consts::PI);
            photons.push(VolumePhoton { position, power, wi: -ray.direction, depth, light: 0, medium: 0 });
            ray = Ray::new(position, warp::square_to_sphere(numbers.next_2d()));
        }
    }
    Ok((VolumePhotons::new(emitted, photons), flights))
}

/// First flights of the renderer's own photons.
fn library_flights(
    lab: &Lab,
    world: &World,
    settings: &nephroid::session::RenderSettings,
) -> Result<Flights, Stop> {
    let (lamp, _) = tracer::lamp(world)?;
    let config = settings.method.mapper().cloned().unwrap_or_default();
    let config = PhotonMapperConfig {
        single_scatter: nephroid::integrator::DirectSource::Map,
        volume_photons: Some(PHOTONS as u64),
        ..config
    };
    let settings =
        nephroid::session::RenderSettings { method: Method::PhotonMapper(config), ..settings.clone() };
    let recorded = record_photons(world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    let first = recorded.photons.iter().filter(|p| p.map == MapName::Volume && p.photon.depth == 1);
    let flight = |p: &nephroid::laboratory::MapPhoton| {
        let ray = Ray::new(lamp, -p.photon.wi);
        let end = world.intersect(&ray)?.t;
        Some([f64::from((p.photon.position - lamp).length()), f64::from(end)])
    };
    Ok(first.filter_map(flight).collect())
}

/// The photons near the plane through the lamp that faces the camera, as dots.
fn slice(lab: &Lab, world: &World, photons: &VolumePhotons) -> Result<Image, Stop> {
    lab.check()?;
    let (camera, film) = (Pinhole::of(world)?, &world.scene().film);
    let (lamp, _) = tracer::lamp(world)?;
    let mut image = Image::filled(film.width, film.height, Rgb::BLACK);
    for photon in photons.as_slice().iter().filter(|p| (p.position.z - lamp.z).abs() < 0.15) {
        let at = camera.project(photon.position);
        let (x, y) = (at.x as i64, at.y as i64);
        if (0..i64::from(film.width)).contains(&x) && (0..i64::from(film.height)).contains(&y) {
            image.pixels[(y * i64::from(film.width) + x) as usize] = Rgb::new(1.0, 0.85, 0.4);
        }
    }
    Ok(image)
}

/// Photons of an estimate in the fog: few, as many would blur the rings away.
const NEIGHBORS: u32 = 10;

/// The light of the fog: short steps, each from its middle.
fn picture(lab: &Lab, world: &World, photons: VolumePhotons) -> Result<Image, Stop> {
    let map = VolumeMap::build(photons, NEIGHBORS);
    let bandwidth = Bandwidth::Nearest { k: NEIGHBORS, max_radius: map.default_max_radius(NEIGHBORS) };
    let steps = lab.pick(64, 24);
    tracer::expose(lab, world, 1, |ray, _, neighbors: &mut NearestList| {
        // The fog begins at the open front, the first surface, and ends at the next.
        let Some(front) = world.intersect(ray) else { return Rgb::BLACK };
        let inside = Ray::new(ray.at(front.t * 1.0001), ray.direction);
        let Some(back) = world.intersect(&inside) else { return Rgb::BLACK };
        let length = back.t / steps as f32;
        let mut sum = Rgb::BLACK;
        for i in 0..steps {
            let t = (i as f32 + 0.5) * length;
            let position: Vec3 = inside.at(t);
            let query = VolumeQuery { position, medium: 0, max_photon_depth: None };
            let mut source = Rgb::BLACK;
            map.at(&query, Kernel::Box, bandwidth, neighbors, |photon, weight| {
                source += photon.power * (weight * std::f32::consts::FRAC_1_PI / 4.0);
            });
            sum += source * (length * libm::exp(-SIGMA_T * f64::from(t)) as f32);
        }
        sum
    })
}
