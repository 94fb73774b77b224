//! Direct light by rays and from photons.

use nephroid::color::Rgb;
use nephroid::film::difference_picture;

use crate::body::{Body, Number};
use crate::compare::{WALLS, mean_where, seen, to_edge};
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.4, and what its bias does.
pub const SECTION: Section = Section {
    id: "fig-2-4",
    report: "Fig 2.4",
    title: "direct light by rays and from photons (Question 2.3, Question 2.4)",
    weight: Weight { full: 40.0, quick: 3.0 },
    run,
};

/// Bins of the distance to the nearest edge, in m.
const BINS: [(f32, f32); 5] = [(0.0, 0.05), (0.05, 0.1), (0.1, 0.2), (0.2, 0.4), (0.4, 2.0)];

fn run(lab: &Lab) -> Result<Body, Stop> {
    let (rays, map) = (lab.render(&lab.recipe("report-2-4a"))?, lab.render(&lab.recipe("report-2-4b"))?);
    // Without glass both are the same light, and all that differs is an error.
    let direct = |source: &str, photons: u64| {
        let recipe = lab.recipe("report-2-6").set("photons", photons).set("neighbours", 200).samples(8);
        lab.render(&recipe.flag("--direct", source).flag("--show", "direct"))
    };
    let photons = lab.pick(100_000, 20_000);
    let (exact, blurred) = (direct("rays", photons)?, direct("map", photons)?);
    let (world, _) = lab.world(&lab.recipe("report-2-6"))?;
    let walls: Vec<Option<f32>> = seen(&world, lab.side())
        .into_iter()
        .map(|hit| hit.filter(|(shape, _)| *shape < WALLS).map(|(_, point)| to_edge(point.position)))
        .collect();
    let between = |low: f32, high: f32| -> Vec<bool> {
        walls.iter().map(|d| d.is_some_and(|d| (low..high).contains(&d))).collect()
    };
    let kept = |low, high| {
        let counts = between(low, high);
        mean_where(&blurred.image, &counts) / mean_where(&exact.image, &counts)
    };

    let mut body = Body::new();
    body.say(
        "By rays shadows are hard and the glass ball's shadow is black. From photons shadows are blurred by as much as an \
         estimate is wide, and there is a caustic under the glass. The report asks which is more accurate: rays, of what \
         they can see; and photons alone have the caustic.",
    );
    body.say(
        "The map below is a box without glass, where both should be the same: red is too bright, blue too dark. Blotches are noise. The blur shows \
         along shadows and outlines. Where walls meet, half of an estimate's disc lies in the wall, so that light is missing \
         there, up to one half at the very edge.",
    );
    body.say(
        "The report's lines along walls have a wrong colour, because its sphere takes in photons of the other wall. Here \
         photons of another surface are refused, so these lines are not coloured, but dark.",
    );
    let look = Look::exposed(1.0);
    let alt = "A box with a red and a green wall, a white sphere and a glass sphere, by direct light";
    body.pair(
        Picture::of(
            &rays,
            &look,
            &format!("{alt}: hard shadows, black behind the glass."),
            "Direct light by rays",
        )?,
        Picture::of(
            &map,
            &look,
            &format!("{alt}: soft shadows, and a caustic below the glass."),
            "Direct light from photons",
        )?,
    );
    let alt = "A box with two white spheres by direct light";
    let errors = difference_picture(&blurred.image, &exact.image, Some(0.2)).map_err(Stop::because)?;
    body.strip(vec![
        Picture::of(&exact, &look, &format!("{alt} with hard shadows."), "By rays")?,
        Picture::of(
            &blurred,
            &look,
            &format!("{alt} with soft shadows; walls are darker where they meet."),
            "From photons",
        )?,
        Picture::new(
            &errors,
            &Look::drawn(),
            "Red and blue lines along the outlines of spheres and shadows, blue lines where walls meet, and faint blotches elsewhere.",
            "Difference of the two: 0.2 W/(m²·sr) too bright is full red, too dark full blue",
        )?,
    ]);
    let row = |&(low, high): &(f32, f32)| {
        let name = format!("{} to {}", format::number(f64::from(low)), format::number(f64::from(high)));
        let pixels = between(low, high).iter().filter(|counts| **counts).count();
        vec![name, pixels.to_string(), format::number(kept(low, high))]
    };
    let head = ["Distance from the edge, m", "Pixels", "From photons by rays"];
    body.table("Direct light on walls without glass", &head, BINS.iter().map(row).collect());

    let is_dark = |(pixel, wall): (&Rgb, &Option<f32>)| wall.is_some() && pixel.is_black();
    let dark: Vec<bool> = exact.image.pixels.iter().zip(&walls).map(is_dark).collect();
    let leaked = mean_where(&blurred.image, &dark) / mean_where(&exact.image, &between(0.0, f32::INFINITY));
    let caustic = |render: &Render| {
        let sums = &render.statistics.picture;
        let total = |v: [f64; 3]| v.iter().sum::<f64>();
        100.0 * total(sums.caustic) / (total(sums.caustic) + total(sums.direct))
    };
    // About a fifth of the radius that 200 photons have on the floor.
    let strip = lab.pick(0.03, 0.08);
    body.numbers(vec![
        Number::within("Caustic's share of the light, by rays", caustic(&rays), "%", [0.0, 0.0], "No ray finds a point light."),
        Number::within(
            "Caustic's share of the light, from photons",
            caustic(&map),
            "%",
            [0.5, 5.0],
            "The glass ball takes (1 − cos α)/2 = 1.8 % of the lamp's light, sin α being 0.5 m by 1.9 m.",
        ),
        Number::within(
            "From photons by rays, far from edges",
            kept(0.4, 2.0),
            "",
            [0.96, 1.04],
            "Blur moves light and keeps it. There are thousands of photons, 1 or 2 % of noise.",
        ),
        Number::within(
            &format!("From photons by rays, up to {strip} m from an edge"),
            kept(0.0, strip),
            "",
            [0.45, 0.75],
            "Half of the disc is without surface at the edge, 0.37 of it at a fifth of the radius; in the corners of three \
             walls it is more. Photons of the other wall would make up for it, in its colour.",
        ),
        Number::within(
            "Light from photons where rays find none, of the mean on walls",
            100.0 * leaked,
            "%",
            [0.2, 25.0],
            "Shadows are soft: photons beside them are within reach of their rims. And there are shadows: most of each is \
             farther inside than an estimate is wide.",
        ),
    ]);
    body.finding(
        "Fig 2.4, Question 2.3",
        "Hard shadows by rays, soft ones from photons, and a caustic that only photons find.",
        "Nothing.",
        "An estimate from photons is as wide as its neighbours reach.",
    );
    body.finding(
        "Question 2.4",
        "Bias is a blur of finite width, worst along edges.",
        &format!(
            "The report's edges have wrong colours. Ours are too dark: {} of the light, up to {strip} m from them.",
            format::number(kept(0.0, strip))
        ),
        "Photons of the other wall are refused here, but the part of the disc that has no surface still counts.",
    );
    Ok(body)
}
