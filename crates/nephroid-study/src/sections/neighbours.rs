//! The number of neighbours.

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::compare::rel_mse;
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.8.
pub const SECTION: Section = Section {
    id: "fig-2-8",
    report: "Fig 2.8",
    title: "the number of neighbours",
    weight: Weight { full: 40.0, quick: 3.0 },
    run,
};

/// The report names none, but advises 50 to 500.
const NEIGHBOURS: [u32; 6] = [5, 20, 50, 100, 200, 500];

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.side() / lab.pick(2, 1);
    let recipe = lab.recipe("report-2-8").side(side);
    let samples = lab.pick(1024, 512);
    let reference = lab.render(&recipe.clone().flag("--integrator", "path").samples(samples))?;
    let of = |photons: u64, k: u32| {
        lab.render(&recipe.clone().set("photons", photons).set("neighbours", k).samples(16))
    };
    let renders: Vec<Render> = NEIGHBOURS.iter().map(|&k| of(10_000, k)).collect::<Result<_, _>>()?;
    let many: Vec<Render> = NEIGHBOURS.iter().map(|&k| of(100_000, k)).collect::<Result<_, _>>()?;
    let errors = |renders: &[Render]| -> Vec<f64> {
        renders.iter().map(|r| rel_mse(&r.image, &reference.image)).collect()
    };
    let (errors, errors_of_many) = (errors(&renders), errors(&many));
    let best = best_of(&errors);
    let (best_k, best_of_many) = (NEIGHBOURS[best], NEIGHBOURS[best_of(&errors_of_many)]);

    let mut body = Body::new();
    body.say(
        "Five neighbours make discs, each a photon's; five hundred make broad soft shadows of no source, dark along every edge. \
         Between them lies a least error, where noise, which falls as 1/k, and blur, which grows with the disc, are alike.",
    );
    body.say(&format!(
        "The report advises 50 to 500. Of the values tried here k = {best_k} has the least error at 10 000 photons and \
         k = {best_of_many} at 100 000: no number of neighbours is good for every number of photons. That few neighbours make \
         indirect light \"exaggerated\" is half a truth: the mean is too bright only where the k-th photon is counted, which is \
         a quarter at k = 5 (see Equation 2.2).",
    ));
    let look = Look::exposed(0.0);
    let alt = "A box with a red and a green wall and two white spheres";
    let strip = renders.iter().zip(NEIGHBOURS).map(|(render, k)| {
        let seen = match k {
            0..20 => "covered with coloured discs",
            20..100 => "with blotches on its walls",
            _ => "smooth, with dark edges",
        };
        Picture::of(render, &look, &format!("{alt}, {seen}."), &format!("k = {k}"))
    });
    let caption = format!("Reference: path tracing, {samples} samples a pixel");
    let last = Picture::of(&reference, &look, &format!("{alt}: the reference, even and sharp."), &caption);
    body.strip(strip.chain([last]).collect::<Result<_, _>>()?);
    let points = |errors: &[f64]| NEIGHBOURS.iter().zip(errors).map(|(k, e)| (f64::from(*k), *e)).collect();
    let chart = Chart::new("neighbours k", "relMSE against the reference").logarithmic();
    let chart = chart.points("10 000 photons", points(&errors));
    body.plot(chart.points("100 000 photons", points(&errors_of_many)).draw(
        "Two curves of error over k. Each falls to a least error and turns; that of more photons lies lower at large k.",
        "Noise at the left, blur at the right.",
    )?);
    let row = |i: usize| {
        vec![NEIGHBOURS[i].to_string(), format::number(errors[i]), format::number(errors_of_many[i])]
    };
    let head = ["k", "relMSE, 10 000 photons", "relMSE, 100 000 photons"];
    body.table("Errors against the reference", &head, (0..NEIGHBOURS.len()).map(row).collect());
    let mean = |i: usize| renders[i].mean() / reference.mean();
    body.numbers(vec![
        Number::within(
            "Stated error of the reference",
            100.0 * reference.error()?,
            "%",
            lab.pick([0.0, 6.0], [0.0, 8.0]),
            "Its square is to be small beside the errors that are measured by it.",
        ),
        Number::within(
            "Error at k = 5 by the least error",
            errors[0] / errors[best],
            "",
            [2.0, f64::MAX],
            "Four photons inside have a relative variance of 1/3, ten times that of 50.",
        ),
        Number::within(
            "k of the least error, 10 000 photons",
            f64::from(best_k),
            "",
            [20.0, 200.0],
            "Where 1/k equals the squared bias of the disc, which k = 500 of 10 000, half a metre wide, exceeds by far.",
        ),
        Number::within(
            "Light at k = 5 by the reference",
            mean(0),
            "",
            [0.93, 1.05],
            "Without the k-th photon few neighbours are right in the mean; with it a quarter of indirect light, a tenth of \
             all, would be too much.",
        ),
        Number::within(
            "Light at k = 500 by the reference",
            mean(5),
            "",
            [0.8, 0.98],
            "Discs reach over edges, where they hold no light.",
        ),
    ]);
    body.finding(
        "Fig 2.8",
        "Small k shows discs, large k blurs, and the right k depends on the scene and on the photons.",
        &format!("The least error is at k = {best_k} of those tried, with 10 000 photons; 500 is too wide for so few."),
        "Noise falls as 1/k, squared blur grows as (k/N)².",
    );
    Ok(body)
}

fn best_of(errors: &[f64]) -> usize {
    (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0)
}
