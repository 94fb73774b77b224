//! The number of caustic photons.

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::compare::{rel_mse, rel_mse_where};
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.7.
pub const SECTION: Section = Section {
    id: "fig-2-7",
    report: "Fig 2.7",
    title: "the number of caustic photons",
    weight: Weight { full: 70.0, quick: 5.0 },
    run,
};

/// The report's, and one more.
const COUNTS: [u64; 4] = [1_000, 10_000, 100_000, 400_000];

/// The part of the lower half's pixels that are the brightest: the caustic, and what the balls mirror.
const BRIGHT: f64 = 0.01;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.side() / lab.pick(2, 1);
    let recipe = lab.recipe("report-2-7").side(side);
    let passes = lab.pick(128, 16);
    let reference = lab.render(&recipe.clone().flag("--integrator", "vcm").flag("--passes", passes))?;
    let of =
        |&count: &u64| lab.render(&recipe.clone().set("caustic_photons", count).samples(lab.pick(16, 8)));
    let renders: Vec<Render> = COUNTS.iter().map(of).collect::<Result<_, _>>()?;
    let caustic = brightest_below(&reference);
    let whole: Vec<f64> = renders.iter().map(|r| rel_mse(&r.image, &reference.image)).collect();
    let bright: Vec<f64> =
        renders.iter().map(|r| rel_mse_where(&r.image, &reference.image, &caustic)).collect();

    let mut body = Body::new();
    body.say(
        "With 1 000 caustic photons, 500 of them make an estimate: half of the caustic map, and the caustic is a dim disc. \
         With more it becomes what it is, and at 100 000 the bright dot appears on the right wall. All of this is as in the report.",
    );
    let least = (0..COUNTS.len()).fold(0, |least, i| if bright[i] < bright[least] { i } else { least });
    let most = COUNTS.len() - 1;
    let course = if least == most {
        format!("is least at the most that were tried, {}", COUNTS[most])
    } else {
        format!(
            "is least at {} of the numbers tried, and at {} it is {} times that",
            COUNTS[least],
            COUNTS[most],
            format::number(bright[most] / bright[least])
        )
    };
    let range =
        whole.iter().fold(0.0f64, |a, b| a.max(*b)) / whole.iter().fold(f64::INFINITY, |a, b| a.min(*b));
    body.say(&format!(
        "The error in the brightest pixels, the caustic and what the balls mirror, {course}. The largest error of the whole picture is \
         {} times the least: the 10 000 global photons stay as they are. How much of what is left in the brightest pixels is the \
         rims of mirror images at few rays a pixel, and how much the reference's own noise, was not measured.",
        format::number(range)
    ));
    let look = Look::exposed(0.0);
    let alt = "A box with a mirror ball and a glass ball";
    let shapes = [
        "there is hardly a caustic below the glass",
        "a broad caustic lies below the glass",
        "a bright small caustic lies below the glass, and a dot on the right wall",
        "a sharp caustic lies below the glass, and a small dot on the right wall",
    ];
    let strip = renders.iter().zip(COUNTS).zip(shapes).map(|((render, count), shape)| {
        Picture::of(render, &look, &format!("{alt}; {shape}."), &format!("{count} caustic photons"))
    });
    let last = Picture::of(
        &reference,
        &look,
        &format!("{alt}; the caustic is sharp, and there are no blotches."),
        &format!("Reference: vertex connection and merging, {passes} passes"),
    );
    body.strip(strip.chain([last]).collect::<Result<_, _>>()?);
    let points = |errors: &[f64]| COUNTS.iter().zip(errors).map(|(n, e)| (*n as f64, *e)).collect();
    let chart = Chart::new("caustic photons", "relMSE against the reference").logarithmic();
    let chart = chart.points("whole picture", points(&whole)).points("brightest pixels", points(&bright));
    body.plot(chart.draw(
        &format!("Two curves of error. That in the brightest pixels {course}."),
        "At 10 000 global photons and k = 500. The brightest pixels are a hundredth of the picture's lower half.",
    )?);
    let row = |i: usize| {
        let stored = renders[i].statistics.caustic.photons.to_string();
        vec![COUNTS[i].to_string(), stored, format::number(whole[i]), format::number(bright[i])]
    };
    let head = ["Caustic photons wanted", "Stored", "relMSE", "relMSE, brightest pixels"];
    body.table("Errors against the reference", &head, (0..COUNTS.len()).map(row).collect());
    body.numbers(vec![
        Number::within(
            "Stated error of the reference",
            100.0 * reference.error()?,
            "%",
            [0.0, 10.0],
            "Of a pixel; its square is to be small beside the error at 1 000 photons.",
        ),
        Number::within(
            "Error in the brightest pixels, 1 000 photons by 100 000",
            bright[0] / bright[2],
            "",
            lab.pick([1.5, f64::MAX], [1.3, f64::MAX]),
            "At 1 000 photons and k = 500 an estimate covers half of all caustics: most of the caustic's light is elsewhere. At \
             100 000 it covers a hundredth of that. Small pixels show more of it.",
        ),
        Number::within(
            "Error in the brightest pixels, 1 000 photons",
            bright[0],
            "",
            [0.1, 1.0],
            "Smeared over half of the map its peak is nearly lost; all lost would be a little less than 1.",
        ),
        Number::within(
            "Error of the whole picture, 10 000 photons by 400 000",
            whole[1] / whole[3],
            "",
            [0.8, 4.0],
            "Global photons do not change, and most of the picture is theirs.",
        ),
    ]);
    body.finding(
        "Fig 2.7",
        "Few caustic photons make the caustic too smooth; at 100 000 the bright dot on the right wall is there.",
        &format!(
            "Of \"trying to get too many\": the error in the brightest pixels {course}."
        ),
        "At a constant k the radius shrinks with more photons, so blur goes and noise stays. What the last of the error is was not \
         measured.",
    );
    Ok(body)
}

/// The brightest pixels of the lower half, where the floor is.
fn brightest_below(reference: &Render) -> Vec<bool> {
    let pixels = &reference.image.pixels;
    let below = &pixels[pixels.len() / 2..];
    let mut luminances: Vec<f32> = below.iter().map(|p| p.luminance()).collect();
    luminances.sort_by(f32::total_cmp);
    let bound = luminances[((1.0 - BRIGHT) * luminances.len() as f64) as usize];
    pixels.iter().enumerate().map(|(i, p)| i >= pixels.len() / 2 && p.luminance() >= bound).collect()
}
