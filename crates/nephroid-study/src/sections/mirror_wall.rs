//! A box with a mirror as its back wall.

use crate::body::{Body, Number};
use crate::compare::rel_mse;
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.3.
pub const SECTION: Section = Section {
    id: "fig-2-3",
    report: "Fig 2.3",
    title: "a mirror as the back wall",
    weight: Weight { full: 20.0, quick: 5.0 },
    run,
};

fn run(lab: &Lab) -> Result<Body, Stop> {
    let render = lab.render(&lab.recipe("report-2-3"))?;
    let without = lab.render(&lab.recipe("report-2-3").flag("--show", "global"))?;
    let caustic = lab.render(&lab.recipe("report-2-3").flag("--show", "caustic"))?;
    let passes = lab.pick(32, 16);
    let reference =
        lab.render(&lab.recipe("report-2-3").flag("--integrator", "vcm").flag("--passes", passes))?;

    let mut body = Body::new();
    body.say(
        "10 000 global and 20 000 caustic photons, estimates from 400, as in the report. The mirror turns the lamp's light \
         back, so the caustic photons light the box a second time, as if from a lamp behind the wall. The picture of the caustic \
         map's light shows it: the spheres are lit from behind and their fronts are dark. It is a small part of all light.",
    );
    body.say(
        "With so many neighbours an estimate is wide, and walls are darker where they meet than in the reference. Mirror and \
         images in it are followed by rays and are exact. The black part of the mirror is the open front of the box.",
    );
    let look = Look::exposed(-0.5);
    let alt = "A box with a red and a green wall and two white spheres, and all of it again in the mirror at the back";
    body.pair(
        Picture::of(&render, &look, &format!("{alt}."), "Photon map, as in the report")?,
        Picture::of(
            &reference,
            &look,
            &format!("{alt}, with finer shadows."),
            "Reference: vertex connection and merging",
        )?,
    );
    let alt = "The walls, spheres and mirror images of the same box";
    body.strip(vec![
        Picture::of(
            &without,
            &look,
            &format!("{alt}, dim and coloured by each other."),
            "The global map's light",
        )?,
        Picture::of(
            &caustic,
            &look,
            &format!("{alt}, dim, with the fronts of the spheres in the dark."),
            "The caustic map's light: the lamp's, by way of the mirror",
        )?,
    ]);
    let light = render.mean() / reference.mean();
    let share = caustic.mean() / render.mean();
    let error = rel_mse(&render.image, &reference.image);
    let map = render.statistics.caustic;
    let row = |name: &str, text: String| vec![name.to_owned(), text];
    body.table(
        "The caustic map",
        &["What", "Number"],
        vec![
            row("Photons", map.photons.to_string()),
            row("Paths emitted", map.paths.to_string()),
            row("Its share of the picture's light", format!("{} %", format::number(100.0 * share))),
            row("relMSE of the picture", format::number(error)),
        ],
    );
    body.numbers(vec![
        Number::within(
            "Stated error of the reference",
            100.0 * reference.error()?,
            "%",
            [0.0, 12.0],
            "Of a pixel; what is measured by it is the mean of thousands.",
        ),
        Number::within(
            "Light in the picture by the reference",
            light,
            "",
            [0.86, 1.0],
            "Discs that reach over edges lose some per cent of indirect light, the more the wider they are: 400 of 10 000 photons \
             are within 0.4 m.",
        ),
        Number::within(
            "Share of the caustic map",
            100.0 * share,
            "%",
            [1.0, 10.0],
            "From the lamp the mirror fills about a tenth of all directions, and all of the lamp's light that stays bounces on \
             beside it. Much of what the mirror turns back leaves by the open front.",
        ),
        Number::within(
            "Photons in the caustic map",
            map.photons as f64,
            "",
            [16_800.0, 23_200.0],
            "20 000 are wanted. The paths are planned beforehand by trials, which count a thousand caustic photons or more, and not \
             stopped at a full map, which would be biased. So the number spreads by √(1/1024 + 1/20 000) = 3.2 %, most of it the \
             trials'; the band is five times that.",
        ),
    ]);
    body.finding(
        "Fig 2.3",
        "The picture, by the report's numbers: a mirror, its images, and light that it turns back.",
        &format!(
            "Nothing that can be read. The picture's light is {} of the reference's.",
            format::number(light)
        ),
        "What is missing is where discs reach over edges.",
    );
    Ok(body)
}
