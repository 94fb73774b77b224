//! Rays per pixel.

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::compare::{outlines, rel_mse_where};
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.9.
pub const SECTION: Section = Section {
    id: "fig-2-9",
    report: "Fig 2.9",
    title: "rays per pixel",
    weight: Weight { full: 25.0, quick: 2.0 },
    run,
};

const SAMPLES: [u32; 6] = [1, 2, 4, 8, 16, 32];

/// A step in luminance between neighbours that counts as an outline, as a part of the brighter one.
const STEP: f32 = 0.25;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.side() / lab.pick(2, 1);
    let recipe = lab.recipe("report-2-9").side(side);
    let samples = lab.pick(1024, 512);
    let reference = lab.render(&recipe.clone().flag("--integrator", "path").samples(samples))?;
    let of = |&samples: &u32| lab.render(&recipe.clone().samples(samples));
    let renders: Vec<Render> = SAMPLES.iter().map(of).collect::<Result<_, _>>()?;
    // Outlines of what rays see alone, without noise and without blur.
    let clean = lab.render(&recipe.clone().flag("--show", "direct").samples(64))?;
    let edges = outlines(&clean.image, STEP);
    let smooth: Vec<bool> = edges.iter().map(|edge| !edge).collect();
    let errors = |counts: &[bool]| -> Vec<f64> {
        renders.iter().map(|r| rel_mse_where(&r.image, &reference.image, counts)).collect()
    };
    let (at_edges, elsewhere) = (errors(&edges), errors(&smooth));

    let level = |&i: &usize| at_edges[i..].iter().all(|e| (e / at_edges[5] - 1.0).abs() <= 0.05);
    let enough = SAMPLES[(0..SAMPLES.len()).find(level).unwrap_or(SAMPLES.len() - 1)];

    let mut body = Body::new();
    body.say(
        "Rays through random points of a pixel smooth outlines and the rims of shadows. Everywhere else all rays ask the same \
         photons, and the blotches stay as they are, however many rays there are. The report says so of outlines; it also says that more rays can make mistakes \
         bigger, as they compute what is wrong many times.",
    );
    body.say(
        &format!(
            "The curves show it: from {enough} rays on the error along outlines stays within 5 % of that at 32. Of all other pixels, the \
             error at 1 ray is {} times that at 32: no mistake has become bigger here. The report settles on 8 rays.",
            format::number(elsewhere[0] / elsewhere[5]),
        ),
    );
    let look = Look::exposed(0.0);
    let alt = "A box with a red and a green wall and two white spheres";
    let strip = renders.iter().zip(SAMPLES).map(|(render, samples)| {
        let seen = if samples < 4 { "with jagged outlines" } else { "with smooth outlines" };
        let rays = if samples == 1 { "1 ray a pixel".to_owned() } else { format!("{samples} rays a pixel") };
        Picture::of(render, &look, &format!("{alt}, {seen} and the same blotches."), &rays)
    });
    let caption = format!("Reference: path tracing, {samples} samples a pixel");
    let last = Picture::of(&reference, &look, &format!("{alt}: the reference, without blotches."), &caption);
    body.strip(strip.chain([last]).collect::<Result<_, _>>()?);
    let points = |errors: &[f64]| SAMPLES.iter().zip(errors).map(|(n, e)| (f64::from(*n), *e)).collect();
    let chart = Chart::new("rays per pixel", "relMSE against the reference").logarithmic();
    let chart = chart.points("along outlines", points(&at_edges));
    body.plot(chart.points("all other pixels", points(&elsewhere)).draw(
        "The error along outlines falls at first and then levels off; that of all other pixels is nearly flat.",
        "10 000 photons, k = 160. Outlines are pixels beside one that differs by a quarter.",
    )?);
    let row =
        |i: usize| vec![SAMPLES[i].to_string(), format::number(at_edges[i]), format::number(elsewhere[i])];
    let head = ["Rays per pixel", "relMSE along outlines", "relMSE elsewhere"];
    body.table("Errors against the reference", &head, (0..SAMPLES.len()).map(row).collect());
    let part = edges.iter().filter(|edge| **edge).count() as f64 / edges.len() as f64;
    body.numbers(vec![
        Number::within(
            "Pixels along outlines",
            100.0 * part,
            "%",
            [1.0, 50.0],
            "Lines in a picture: some pixels of each row, in a small picture more of them.",
        ),
        Number::within(
            "Error along outlines, 1 ray by 32",
            at_edges[0] / at_edges[5],
            "",
            [1.15, 32.0],
            "Aliasing falls at least as 1/n, to the photons' own error.",
        ),
        Number::within(
            "Error elsewhere, 1 ray by 32",
            elsewhere[0] / elsewhere[5],
            "",
            [0.95, 2.0],
            "All rays of a pixel ask the same photons. What little there is to gain is texture of the estimate below a pixel.",
        ),
        Number::within(
            "Error along outlines, 8 rays by 32",
            at_edges[3] / at_edges[5],
            "",
            [0.8, 2.0],
            "After 8 rays an eighth of the aliasing is left.",
        ),
    ]);
    body.finding(
        "Fig 2.9",
        "More rays help against aliasing; 8 are enough.",
        &format!(
            "That more rays can make mistakes bigger was not seen: away from outlines the error at 32 rays is {} of that at 1.",
            format::number(elsewhere[5] / elsewhere[0])
        ),
        "A photon map is made once, and each ray reads the same photons.",
    );
    Ok(body)
}
