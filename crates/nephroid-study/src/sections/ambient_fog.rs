//! Fog that only weakens light, and one grey for all that it scatters.

use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 3.6.
pub const SECTION: Section = Section {
    id: "fig-3-6",
    report: "Fig 3.6",
    title: "ambient fog, and none",
    weight: Weight { full: 25.0, quick: 1.5 },
    run,
};

/// σ_t in 1/m, albedo and the ambient radiance in W/(m²·sr) of each picture.
const FOGS: [(f64, f64, f64); 5] =
    [(0.0, 0.8, 0.4), (0.05, 0.8, 0.4), (0.15, 0.8, 0.4), (0.4, 0.8, 0.4), (0.15, 0.8, 1.5)];

/// From the camera to the middle of the back wall, in m.
const TO_WALL: f64 = 7.6;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let of = |(sigma_t, albedo, ambient): (f64, f64, f64)| {
        lab.recipe("report-3-6").set("sigma_t", sigma_t).set("albedo", albedo).set("ambient", ambient)
    };
    let mut pictures = Vec::new();
    for fog in FOGS {
        let (sigma_t, _, ambient) = fog;
        let render = lab.render(&of(fog))?;
        let alt = match sigma_t {
            0.0 => "A box with a white and a glass sphere in clear air.".to_owned(),
            _ => format!(
                "The same box behind a grey layer that is denser further away; extinction {sigma_t} per metre."
            ),
        };
        let caption = match sigma_t {
            0.0 => "No fog".to_owned(),
            _ => format!("σ_t = {sigma_t}/m, σ_s = 0.8 σ_t, L_i = {ambient} W/(m²·sr)"),
        };
        pictures.push((Picture::of(&render, &Look::exposed(0.0), &alt, &caption)?, render));
    }
    let volume = lab.render(&of(FOGS[2]).set("fog", "volume"))?;

    let mut body = Body::new();
    body.say(
        "Ambient fog takes the light that the fog scatters towards the eye to be the same everywhere. The picture fades with \
         distance and a grey layer grows over it, as the report says; nothing glows, and there is no beam below the \
         glass. The report's formula is right. It names no coefficients: these are ours.",
    );
    body.say(
        "What it does not say is that energy is not conserved: what the fog takes from photons and shadow rays goes nowhere, and \
         the grey comes from nowhere. The last pair is the same fog with light that is truly scattered.",
    );
    let (strip, renders): (Vec<_>, Vec<_>) = pictures.into_iter().unzip();
    let left = strip[2].clone();
    body.strip(strip);
    let right = Picture::of(
        &volume,
        &Look::exposed(0.0),
        "The box in fog that glows round the lamp.",
        "The same fog with scattered light (fog=volume)",
    )?;
    body.pair(left, right);

    // The same photons and camera samples: what differs is the ambient light alone, or the fog alone.
    let dark = lab.render(&of((0.15, 0.8, 0.0)))?;
    let direct = |sigma_t: f64| lab.render(&of((sigma_t, 0.8, 0.0)).flag("--show", "direct"));
    let left_over = middle(&direct(0.15)?.image) / middle(&direct(0.0)?.image);
    let added = middle(&renders[2].image) - middle(&dark.image);
    let expected = 0.8 * 0.4 * -libm::expm1(-0.15 * TO_WALL);
    // The lamp is at (−0.4, 2.3, 0.3), the place on the wall at (0, 1.4, −1.6).
    let to_lamp = libm::sqrt(0.4 * 0.4 + 0.9 * 0.9 + 1.9 * 1.9);
    let passed = libm::exp(-0.15 * (TO_WALL + to_lamp));
    let about = |value: f64, part: f64| [value * (1.0 - part), value * (1.0 + part)];
    body.numbers(vec![
        Number::within(
            "Light that the fog adds before the middle of the back wall, σ_t = 0.15/m",
            added,
            "W/(m²·sr)",
            about(expected, 1e-3),
            "σ_s L_i (1 − e^(−σ_t d)) / σ_t for 7.6 m. The four pixels in the middle are within 3 mm of that.",
        ),
        Number::within(
            "Direct light of that place that comes through",
            left_over,
            "",
            about(passed, 5e-3),
            "e^(−σ_t d) for the way from the lamp and on to the camera. The pixels see places a few centimetres apart.",
        ),
        Number::within(
            "Light in the scattering fog's picture by that in the ambient one's",
            volume.mean() / renders[2].mean(),
            "",
            [0.3, 3.0],
            "The ambient radiance is chosen, not found: it may be right to a factor.",
        ),
    ]);
    body.finding(
        "Fig 3.6",
        "A grey layer that grows with distance; no glow, no beams.",
        "Nothing in the formula. Its energy does not balance.",
        "The ambient radiance is set by hand and does not come from the light that the fog takes.",
    );
    body.finding(
        "Figs 3.1 to 3.5",
        "Diagrams and the equations of transfer: the usual ones.",
        "Nothing: there is nothing to render.",
        "They are theory; the sections on media rest on them.",
    );
    Ok(body)
}

/// Mean of the four pixels in the middle.
fn middle(image: &Image) -> f64 {
    let (x, y) = (image.width / 2, image.height / 2);
    let pixels = [(x - 1, y - 1), (x, y - 1), (x - 1, y), (x, y)];
    pixels.iter().map(|&(x, y)| f64::from(image.pixel(x, y).mean())).sum::<f64>() / 4.0
}
