//! The box with each kernel, and how noisy each is.

use nephroid::film::{ImageError, difference_picture};
use nephroid::laboratory::record_photons;
use nephroid::math::Vec3;
use nephroid::photon_map::{Bandwidth, Kernel, NearestList, PhotonMap, Photons, Query, gather};

use crate::body::{Body, Number};
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 3.12.
pub const SECTION: Section = Section {
    id: "fig-3-12",
    report: "Fig 3.12",
    title: "a box with each kernel",
    weight: Weight { full: 100.0, quick: 5.0 },
    run,
};

/// Each with its name on the page and on the command line; those with a right norm come first.
pub const KERNELS: [(&str, &str); 6] = [
    ("Box", "box"),
    ("Gaussian", "gaussian"),
    ("Epanechnikov", "epanechnikov"),
    ("Cone", "cone"),
    ("Biweight", "biweight"),
    ("Gaussian of the report", "jensen-1996"),
];

/// Of which the norm is right.
pub const RIGHT: usize = 5;

/// A difference in luminance that is full colour, in W/(m²·sr).
const FULL_SCALE: f32 = 0.4;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.pick(192, 48);
    let samples = lab.pick(1024, 256);
    let recipe = lab.recipe("report-3-12").side(side);
    let reference = lab.render(&recipe.clone().flag("--integrator", "path").samples(samples))?;
    let of = |kernel: &str, equal: bool| {
        let recipe = recipe.clone().set("kernel", kernel).samples(16);
        lab.render(&if equal { recipe.set("equal_bandwidth", "true") } else { recipe })
    };
    let all =
        |equal: bool| KERNELS.iter().map(|(_, kernel)| of(kernel, equal)).collect::<Result<Vec<_>, _>>();
    let (same_k, same_blur) = (all(false)?, all(true)?);
    let error = |render: &Render| {
        ImageError::between(&render.image, &reference.image, ImageError::EPSILON).map_err(Stop::because)
    };
    let noise = noise(lab)?;
    let spread = |errors: &[f64]| {
        let right = &errors[..RIGHT];
        right.iter().fold(0.0f64, |a, b| a.max(*b)) / right.iter().fold(f64::INFINITY, |a, b| a.min(*b))
    };
    let all_errors = |renders: &[Render]| {
        renders.iter().map(|render| Ok(error(render)?.rel_mse)).collect::<Result<Vec<f64>, Stop>>()
    };
    let (errors, blurred) = (all_errors(&same_k)?, all_errors(&same_blur)?);
    let mut order: Vec<usize> = (0..RIGHT).collect();
    order.sort_by(|&a, &b| errors[a].total_cmp(&errors[b]));
    let by_error = order.iter().map(|&i| KERNELS[i].0).collect::<Vec<_>>().join(", ");
    // The kernels stand in the order of their noise.
    let reversed = order.iter().rev().copied().eq(0..RIGHT);
    let by_error = format!("{by_error}{}", if reversed { ": that of noise reversed" } else { "" });

    let mut body = Body::new();
    body.say(
        "10 000 photons and 300 neighbours, as in the report, with each kernel. The radius is the same for all, as it reaches to \
         the 300th photon. But a kernel that falls off counts fewer of the photons within it: it blurs less and is \
         noisier, the biweight most. That order is what the report saw as smooth or spotty; it is one of widths.",
    );
    body.say(
        &format!(
            "By error at k = 300, the least first, the order is {by_error}. The eye judged noise; the error is noise and blur. The report \
             liked its Gaussian best. That kernel is hardly narrower than the box, so it is smooth; but as the report wrote it \
             down, it also loses 47 % of all indirect light, and its error is {} times the box's. With the norm put right it is {} \
             times.",
            format::number(errors[RIGHT] / errors[0]),
            format::number(errors[1] / errors[0]),
        ),
    );
    let look = Look::exposed(0.0);
    let alt = "A box with a red and a green wall and two white spheres";
    let strip = KERNELS.iter().zip(&same_k).map(|((name, _), render)| {
        Picture::of(render, &look, &format!("{alt}: {name} kernel."), &format!("{name}, k = 300"))
    });
    body.strip(strip.collect::<Result<_, _>>()?);
    body.strip(maps(&same_k, &reference, "k = 300")?);
    body.say(
        &format!(
            "At equal blur, with k multiplied for each kernel, they can be compared. Of those with right norms the largest error is now {} \
             times the least, and was {} times at one k: the shape of a kernel matters little, its width more.",
            format::number(spread(&blurred)),
            format::number(spread(&errors)),
        ),
    );
    body.strip(maps(&same_blur, &reference, "equal blur")?);
    let caption = format!("Reference: path tracing, {samples} samples a pixel");
    body.picture(Picture::of(&reference, &look, &format!("{alt}: the reference."), &caption)?);

    let mut rows = Vec::new();
    for (i, (name, _)) in KERNELS.iter().enumerate() {
        let (a, b) = (error(&same_k[i])?, error(&same_blur[i])?);
        let cells = [a.rel_mse, a.mean_ratio, b.rel_mse, b.mean_ratio].map(format::number);
        let variance = noise.get(i).map_or("–".to_owned(), |v| format::number(*v));
        rows.push([vec![(*name).to_owned()], cells.to_vec(), vec![variance]].concat());
    }
    let head = [
        "Kernel",
        "relMSE, k = 300",
        "Light by the reference's",
        "relMSE, equal blur",
        "Light by the reference's",
        "Variance by the box's, equal radius",
    ];
    body.table("Errors against the reference, and measured noise", &head, rows);

    let mut numbers = Vec::new();
    for (i, expected) in [(1, 1.13), (2, 4.0 / 3.0), (3, 1.5), (4, 1.8)] {
        let name = format!("Variance at an equal radius by the box's: {}", KERNELS[i].0);
        let part = lab.pick(0.08, 0.12);
        let band = [expected * (1.0 - part), expected * (1.0 + part)];
        let why = "π r² ∫ w², the variance of photons that fall independently. The band is some five standard \
                   deviations of the measured one.";
        numbers.push(Number::within(&name, noise[i], "", band, why));
    }
    let indirect = |kernel: &str| lab.render(&recipe.clone().set("kernel", kernel).flag("--show", "global"));
    let dark = indirect("jensen-1996")?.mean() / indirect("gaussian")?.mean();
    numbers.push(Number::within(
        "Indirect light of the report's Gaussian, by the right one's",
        dark,
        "",
        [0.5306, 0.5317],
        "From the same photons at the same places: 0.918 / 1.72831, up to rounding.",
    ));
    numbers.push(Number::within(
        "Error of the report's Gaussian, by the largest of the others",
        errors[RIGHT] / errors[..RIGHT].iter().fold(0.0f64, |a, b| a.max(*b)),
        "",
        [1.5, f64::MAX],
        "A loss of 47 % of the indirect light is more than any noise or blur of the others.",
    ));
    numbers.push(Number::within(
        "Largest error by the least at equal blur, right norms",
        spread(&blurred),
        "",
        [1.0, 1.3],
        "Theory: 1.08 at the best width of each, where blur is smooth; edges add to it.",
    ));
    numbers.push(Number::within(
        "Stated error of the reference",
        100.0 * reference.error()?,
        "%",
        lab.pick([0.0, 4.0], [0.0, 15.0]),
        "Its square is to be small beside the errors that are measured by it.",
    ));
    body.numbers(numbers);
    body.finding(
        "Fig 3.12",
        "At an equal number of neighbours Gaussian and Epanechnikov kernels are smoother than cone and biweight; differences are \
         small.",
        &format!(
            "By error at k = 300, the least first: {by_error}. The eye judged noise. Are they any better than the box? With right norms the \
             errors at k = 300 are {} of its, at equal blur {}; the report's Gaussian, with 47 % of indirect light lost, errs {} \
             times as much as the box.",
            by_box(&errors),
            by_box(&blurred),
            format::number(errors[RIGHT] / errors[0]),
        ),
        "The variance at an equal radius is 1.13, 1.33, 1.5 and 1.8 times the box's: a narrower kernel is noisier.",
    );
    Ok(body)
}

/// The range of the errors of right kernels that fall off, by the box's.
fn by_box(errors: &[f64]) -> String {
    let (low, high) = errors[1..RIGHT]
        .iter()
        .map(|error| error / errors[0])
        .fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    format!("{} to {}", format::rounded(low, 3), format::rounded(high, 3))
}

/// Where each is too bright and too dark.
fn maps(renders: &[Render], reference: &Render, how: &str) -> Result<Vec<Picture>, Stop> {
    let map = |((name, _), render): (&(&str, &str), &Render)| {
        let picture =
            difference_picture(&render.image, &reference.image, Some(FULL_SCALE)).map_err(Stop::because)?;
        let alt =
            format!("A map of errors, {name}, {how}: red where it is too bright, blue where it is too dark.");
        let caption =
            format!("{name}, {how}: too bright is red, too dark blue; full colour is {FULL_SCALE} W/(m²·sr)");
        Picture::new(&picture, &Look::drawn(), &alt, &caption)
    };
    KERNELS.iter().zip(renders).map(map).collect()
}

/// The radius of the estimates whose noise is measured, in m: 30 photons or so.
const RADIUS: f32 = 0.25;

/// The variance of estimates with each right kernel, by the box's, from many photon maps. The estimates are of the same
/// photons and at places more than a diameter apart, where walls are even.
fn noise(lab: &Lab) -> Result<Vec<f64>, Stop> {
    let (world, settings) = lab.world(&lab.recipe("report-3-12"))?;
    let kernels =
        [Kernel::Box, Kernel::Gaussian, Kernel::Epanechnikov, Kernel::Cone { k: 1.0 }, Kernel::Biweight];
    let ceiling = (0..5).flat_map(|i| {
        (0..5).map(move |j| {
            (Vec3::new(-1.1 + 0.55 * i as f32, 2.8, -1.2 + 0.55 * j as f32), Vec3::new(0.0, -1.0, 0.0))
        })
    });
    let back = (0..5).flat_map(|i| {
        (0..2).map(move |j| (Vec3::new(-1.1 + 0.55 * i as f32, 1.7 + 0.55 * j as f32, -1.6), Vec3::Z))
    });
    let places: Vec<(Vec3, Vec3)> = ceiling.chain(back).collect();
    let maps = lab.pick(240, 60);
    let mut sums = vec![[[0.0f64; 2]; RIGHT]; places.len()];
    let mut scratch = NearestList::new();
    for iteration in 0..maps {
        lab.check()?;
        let pass = record_photons(&world, &settings, iteration, lab.observer()).ok_or(Stop::Cancelled)?;
        let map: PhotonMap =
            PhotonMap::build(Photons::new(1, pass.photons.iter().map(|p| p.photon).collect()));
        for (sums, &(position, normal)) in sums.iter_mut().zip(&places) {
            let query = Query { position, normal, max_photon_depth: None };
            for (sum, kernel) in sums.iter_mut().zip(kernels) {
                let mut irradiance = 0.0;
                gather(
                    &map,
                    &query,
                    kernel,
                    Bandwidth::Fixed { radius: RADIUS },
                    &mut scratch,
                    |photon, weight| {
                        irradiance += f64::from(photon.power.mean()) * f64::from(weight);
                    },
                );
                sum[0] += irradiance;
                sum[1] += irradiance * irradiance;
            }
        }
    }
    let n = maps as f64;
    let variance = |i: usize| sums.iter().map(|s| s[i][1] / n - (s[i][0] / n) * (s[i][0] / n)).sum::<f64>();
    Ok((0..RIGHT).map(|i| variance(i) / variance(0)).collect())
}
