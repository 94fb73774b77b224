//! Direct light and indirect light.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig};
use nephroid::photon_map::Kernel;
use nephroid::session::RenderSettings;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::scenes::furnace;
use crate::section::{Section, Stop, Weight};

/// The energy of both.
pub const SECTION: Section = Section {
    id: "question-2-2",
    report: "Question 2.2",
    title: "the energy of direct and of indirect light",
    weight: Weight { full: 18.0, quick: 3.0 },
    run,
};

/// Of the wall; at the second the report's ratio would be found.
const REFLECTANCES: [f32; 6] = [0.3, 0.444, 0.5, 0.7, 0.8, 0.9];

/// Less than the part of the furnace's wall that its camera sees: of all directions from the centre its window takes a sixth, and the wall before it is the farther one.
const SEEN: f64 = 0.15;

/// What the report found.
const REPORT: f64 = 1.25;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let paths: u64 = lab.pick(400_000, 100_000);
    let of_furnace = |&rho: &f32| Ok((f64::from(rho), ratio(&in_furnace(lab, rho, paths)?)?));
    let ratios: Vec<(f64, f64)> = REFLECTANCES.iter().map(of_furnace).collect::<Result<_, Stop>>()?;

    let recipe = lab.recipe("report-2-6").set("photons", lab.pick(100_000, 20_000));
    let shown = |part: &str| lab.render(&recipe.clone().flag("--show", part));
    let (direct, all) = (shown("direct")?, shown("all")?);
    let samples = lab.pick(128, 128);
    let reference = lab.render(&lab.recipe("report-2-6").flag("--integrator", "path").samples(samples))?;
    let (in_box, in_reference) = (direct.mean() / (all.mean() - direct.mean()), ratio(&reference)?);
    let reflectance = box_reflectance();
    let closed_box = (1.0 - reflectance) / reflectance;

    let mut body = Body::new();
    body.say(
        "Left the box by direct light alone, right with all light. The sum of all pixels has a little more direct than \
         indirect light, as the report found with its 1.25. The report thinks that \"the rate should be bigger\"; there is no \
         reason for that.",
    );
    body.say(&format!(
        "In a closed grey room each bounce keeps the part ρ of the light, so direct to indirect is (1 − ρ)/ρ, in a sphere at \
         every point: 1.25 belongs to ρ = 0.44. Our box, its open front counted as black, has a mean reflectance of {}, to \
         which {} would belong; its ratio in the picture, {}, depends on what the camera sees.",
        format::number(reflectance),
        format::number(closed_box),
        format::number(in_reference),
    ));
    let look = Look::exposed(0.0);
    let alt = "A box with a red and a green wall and two white spheres";
    body.pair(
        Picture::of(&direct, &look, &format!("{alt}, with black shadows."), "Direct light alone")?,
        Picture::of(&all, &look, &format!("{alt}, with shadows that coloured light fills."), "All light")?,
    );
    let curve = (0..=70).map(|i| 0.25 + f64::from(i) / 100.0).map(|rho| (rho, (1.0 - rho) / rho)).collect();
    let chart = Chart::new("reflectance ρ of the wall", "direct : indirect").from(0.0);
    let chart = chart.line("(1 − ρ)/ρ", curve).points("rendered in a closed sphere", ratios.clone());
    body.plot(chart.line("the report's box, 1.25", vec![(0.25, REPORT), (0.95, REPORT)]).draw(
        "A falling curve from 3 at a reflectance of a quarter to nearly 0 at 0.95, with six measured points on it.",
        "Direct over indirect light in pictures of the inside of a sphere with a lamp at its centre.",
    )?);
    let row = |&(rho, found): &(f64, f64)| {
        vec![
            format!("Sphere, ρ = {}", format::number(rho)),
            format::number(found),
            format::number((1.0 - rho) / rho),
        ]
    };
    let boxes = [
        ("Box, photon map", in_box, Some(closed_box)),
        ("Box, path tracing", in_reference, Some(closed_box)),
        ("Box, in the report", REPORT, None),
    ];
    let boxes = boxes.map(|(name, a, b)| {
        vec![name.to_owned(), format::number(a), b.map_or("–".to_owned(), format::number)]
    });
    let rows = ratios.iter().map(row).chain(boxes).collect();
    body.table("Direct over indirect light", &["Scene", "Sum of pixels", "(1 − ρ)/ρ"], rows);

    let furnace_number = |&(rho, found): &(f64, f64)| {
        let stored = paths as f64 * rho / (1.0 - rho);
        let room = 6.0 * (libm::sqrt(1.0 / (rho * paths as f64)) + libm::sqrt(1.0 / (SEEN * stored)));
        let expected = (1.0 - rho) / rho;
        Number::within(
            &format!("Direct : indirect in the sphere, ρ = {}", format::number(rho)),
            found,
            "",
            [expected * (1.0 - room), expected * (1.0 + room)],
            "(1 − ρ)/ρ and six standard deviations: of the power that the paths keep, and of how many photons land on the \
             tenth and more of the wall that is seen.",
        )
    };
    let mut numbers: Vec<Number> = ratios.iter().map(furnace_number).collect();
    numbers.push(Number::within(
        "Direct : indirect in the box, photon map by path tracing",
        in_box / in_reference,
        "",
        lab.pick([0.95, 1.1], [0.95, 1.15]),
        "Both are the same light. Discs that reach over edges darken corners by some per cent; without 4π, or with a cosine \
         missing, it would be another number by far.",
    ));
    numbers.push(Number::within(
        "Direct : indirect in the box, path tracing",
        in_reference,
        "",
        [0.7 * closed_box, 1.6 * closed_box],
        "Within a factor of about 1.5 of the closed form with the mean reflectance, the open front as black: a box is no \
         sphere, and the camera does not see it all.",
    ));
    body.numbers(numbers);
    body.finding(
        "Question 2.2",
        &format!(
            "A little more direct light than indirect: {} in our box by path tracing, {} by photons; about 1.25 in theirs.",
            format::number(in_reference),
            format::number(in_box)
        ),
        "It need not be more. And, by algebra and not by a run, roulette by a mean albedo keeps the mean energy in coloured scenes.",
        "In a closed room the ratio is (1 − ρ)/ρ; 1.25 is a mean reflectance of 0.44. Power is multiplied by albedo over the chance to survive.",
    );
    Ok(body)
}

fn ratio(render: &Render) -> Result<f64, Stop> {
    let ratio = render.statistics.picture.direct_to_indirect();
    ratio.ok_or_else(|| Stop::because("there is no indirect light"))
}

fn in_furnace(lab: &Lab, reflectance: f32, paths: u64) -> Result<Render, Stop> {
    let config = PhotonMapperConfig {
        emit: Some(paths),
        neighbours: 100,
        kernel: Kernel::Box,
        direct: DirectSource::Rays,
        final_gather: FinalGather::Off,
        ..PhotonMapperConfig::default()
    };
    let method = Method::PhotonMapper(config);
    let settings = RenderSettings { method, samples_per_pixel: 4, seed: lab.seed() };
    lab.render_world(&furnace(Rgb::splat(reflectance), 32)?, settings, 1)
}

/// Of `report-2-6`, the mean over its areas, its open front as black: channels averaged, as sums of pixels are here.
fn box_reflectance() -> f64 {
    let (white, red, green) = (0.75, (0.65 + 0.1 + 0.08) / 3.0, (0.12 + 0.5 + 0.14) / 3.0);
    let (floor, back, side) = (3.0 * 3.2, 3.0 * 2.8, 3.2 * 2.8);
    let spheres = 4.0 * std::f64::consts::PI * (0.55 * 0.55 + 0.45 * 0.45);
    let lit = white * (2.0 * floor + back + spheres) + side * (red + green);
    lit / (2.0 * floor + 2.0 * back + 2.0 * side + spheres)
}
