//! What photons carry.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig};
use nephroid::laboratory::record_photons;
use nephroid::math::Vec3;
use nephroid::session::RenderSettings;
use nephroid::transport::LightChoice;

use crate::body::{Body, Number};
use crate::format;
use crate::lab::Lab;
use crate::scenes::lights_in_sphere;
use crate::section::{Section, Stop, Weight};

/// The powers that are stored.
pub const SECTION: Section = Section {
    id: "question-1-3",
    report: "Question 1.3",
    title: "what a photon carries",
    weight: Weight { full: 0.3, quick: 0.2 },
    run,
};

/// Paths, as in the question.
const PATHS: u64 = 1000;

/// Of a photon's channels, in W.
struct Powers {
    photons: usize,
    /// The least and the most of the channel that carries most.
    largest: [f64; 2],
    /// The least and the most of any channel.
    any: [f64; 2],
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let places = [Vec3::new(-0.5, 0.2, 0.0), Vec3::new(0.0, 0.3, 0.4), Vec3::new(0.5, 0.0, -0.2)];
    let three = places.map(|place| (place, 1.0));
    let two = [(places[0], 5.0), (places[2], 15.0)];
    let (grey, red) = (Rgb::splat(0.5), Rgb::new(0.65, 0.2, 0.1));
    let even = powers(lab, &three, grey, LightChoice::Power)?;
    let coloured = powers(lab, &three, red, LightChoice::Power)?;
    let by_power = powers(lab, &two, grey, LightChoice::Power)?;
    let alike = powers(lab, &two, grey, LightChoice::Equal)?;

    let mut body = Body::new();
    body.say(
        "Three lamps of 1 W/sr give off 3 · 4π W. Of 1000 photons each carries a thousandth of that, and where all is grey \
         roulette keeps it so: every stored photon carries the same. The report's answer is right.",
    );
    body.say(
        "On coloured walls the channels drift apart. Roulette survives here by the largest channel, which stays level and never \
         rises. \
         Where lamps differ, choosing them by power keeps photons alike, and taking each in turn does not.",
    );
    let row = |name: &str, powers: &Powers| {
        let [low, high] = powers.largest.map(format::number);
        let [least, most] = powers.any.map(format::number);
        let largest = format!("{low} to {high}");
        vec![name.to_owned(), powers.photons.to_string(), largest, format!("{least} to {most}")]
    };
    let rows = vec![
        row("Three of 1 W/sr, grey wall", &even),
        row("Three of 1 W/sr, red wall", &coloured),
        row("5 and 15 W/sr, chosen by power", &by_power),
        row("5 and 15 W/sr, each in turn", &alike),
    ];
    let head = ["Lamps", "Photons stored", "Largest channel, W", "Any channel, W"];
    body.table("Powers stored by 1000 paths in a closed sphere", &head, rows);

    let close = |value: f64| [value * (1.0 - 1e-5), value * (1.0 + 1e-5)];
    let share = |intensity: f64| intensity * 4.0 * PI / PATHS as f64;
    let thousandth = "3 · 4π W / 1000, to single precision.";
    let both = "(5 + 15) · 4π W / 1000, to single precision.";
    let weak = "Half of the paths share 5 · 4π W.";
    let strong = "Half of the paths share 15 · 4π W.";
    body.numbers(vec![
        Number::within("Least power, three lamps", even.any[0], "W", close(share(3.0)), thousandth),
        Number::within("Most power, three lamps", even.any[1], "W", close(share(3.0)), thousandth),
        Number::within(
            "Most of the largest channel, red wall",
            coloured.largest[1],
            "W",
            close(share(3.0)),
            thousandth,
        ),
        Number::within("Least power, by power", by_power.any[0], "W", close(share(20.0)), both),
        Number::within("Most power, by power", by_power.any[1], "W", close(share(20.0)), both),
        Number::within("Least power, each in turn", alike.any[0], "W", close(share(10.0)), weak),
        Number::within("Most power, each in turn", alike.any[1], "W", close(share(30.0)), strong),
    ]);
    body.finding(
        "Question 1.3",
        &format!("All photons carry 3 · 4π/1000 W = {} W.", format::number(even.any[0])),
        "Nothing: the question is about a grey scene.",
        "In grey, survival by the albedo keeps the power as it is.",
    );
    Ok(body)
}

fn powers(
    lab: &Lab,
    lights: &[(Vec3, f32)],
    reflectance: Rgb,
    light_choice: LightChoice,
) -> Result<Powers, Stop> {
    let world = lights_in_sphere(lights, reflectance)?;
    let config = PhotonMapperConfig {
        emit: Some(PATHS),
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        aim: false,
        light_choice,
        ..PhotonMapperConfig::default()
    };
    let method = Method::PhotonMapper(config);
    let settings = RenderSettings { method, samples_per_pixel: 1, seed: lab.seed() };
    let stored = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    let channels = || stored.photons.iter().map(|p| p.photon.power.to_array().map(f64::from));
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    Ok(Powers {
        photons: stored.photons.len(),
        largest: range(&mut channels().map(|c| c.into_iter().fold(0.0, f64::max))),
        any: range(&mut channels().flatten()),
    })
}
