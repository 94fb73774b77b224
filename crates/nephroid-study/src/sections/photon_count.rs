//! The number of photons, at a constant ratio to the neighbours and not.

use nephroid::film::ImageError;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.6.
pub const SECTION: Section = Section {
    id: "fig-2-6",
    report: "Fig 2.6",
    title: "the number of photons",
    weight: Weight { full: 90.0, quick: 2.0 },
    run,
};

/// Added to the squared reference that errors are divided by, in (W/(m²·sr))²: the box is about 1 bright.
const EPSILON: f64 = ImageError::EPSILON;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let counts: &[u64] = lab.pick(&[1_000, 3_000, 10_000, 30_000, 100_000], &[1_000, 10_000, 100_000]);
    let samples = lab.pick(1024, 256);
    let reference = lab.render(&lab.recipe("report-2-6").flag("--integrator", "path").samples(samples))?;
    let look = Look::exposed(0.0);

    let mut in_ratio = Vec::new();
    let mut narrowing = Vec::new();
    for &count in counts {
        in_ratio.push((count, k_in_ratio(count), of(lab, count, k_in_ratio(count))?));
        narrowing.push((count, k_narrowing(count), of(lab, count, k_narrowing(count))?));
    }

    let mut body = Body::new();
    body.say(
        "More photons, and neighbours in proportion: the noise goes, as the report says. What stays is the blur, for a \
         hundredth of all photons always lies within the same radius. The report does not name its numbers; these keep \
         k = N/100.",
    );
    body.say(
        "So the error levels off, and \"the more photons are shot the better the estimation\" holds only if the radius shrinks, \
         too: where k grows as N to the power of 2/3, noise and blur fall together, and the error with them.",
    );
    let alt = "A box with a red and a green wall and two white spheres, lit by one lamp";
    let strip = in_ratio.iter().map(|(count, k, render)| {
        let caption = format!("{count} photons, k = {k}");
        Picture::of(render, &look, &format!("{alt}, from {count} photons."), &caption)
    });
    let caption = format!("Reference: path tracing, {samples} samples a pixel");
    let last = Picture::of(&reference, &look, &format!("{alt}: the reference, without blotches."), &caption);
    body.strip(strip.chain([last]).collect::<Result<_, _>>()?);

    let error = |render: &Render| -> Result<f64, Stop> {
        let error = ImageError::between(&render.image, &reference.image, EPSILON).map_err(Stop::because)?;
        Ok(error.rel_mse)
    };
    let errors = |series: &[(u64, u64, Render)]| -> Result<Vec<(f64, f64)>, Stop> {
        series.iter().map(|(count, _, render)| Ok((*count as f64, error(render)?))).collect()
    };
    let (ratio_errors, narrowing_errors) = (errors(&in_ratio)?, errors(&narrowing)?);
    let chart = Chart::new("photons in the global map", "relMSE against the reference").logarithmic();
    let chart = chart.points("constant ratio, as in the report; here k = N/100", ratio_errors.clone());
    let chart = chart.points("k ∝ N^(2/3), the same at 10 000", narrowing_errors.clone());
    body.plot(chart.draw(
        "Two falling curves of error over the number of photons: that at a constant ratio flattens, the other falls on.",
        "Mean of squared differences over squared reference (and 0.01). At a constant ratio the blur is left over.",
    )?);
    let row = |((count, k, _), error): (&(u64, u64, Render), &(f64, f64))| {
        vec![count.to_string(), k.to_string(), format::number(error.1)]
    };
    let rows = in_ratio.iter().zip(&ratio_errors).chain(narrowing.iter().zip(&narrowing_errors)).map(row);
    body.table("Errors against the reference", &["Photons", "k", "relMSE"], rows.collect());

    let reference_error = reference.error()?;
    let last = |errors: &[(f64, f64)]| errors.last().map_or(f64::NAN, |e| e.1);
    let first = |errors: &[(f64, f64)]| errors.first().map_or(f64::NAN, |e| e.1);
    let gain = first(&ratio_errors) / last(&ratio_errors);
    let times = *counts.last().unwrap_or(&1) as f64 / counts[0] as f64;
    body.numbers(vec![
        Number::within(
            "Stated error of the reference",
            100.0 * reference_error,
            "%",
            lab.pick([0.0, 4.0], [0.0, 15.0]),
            "Its square is to be small beside the errors that are measured by it.",
        ),
        Number::within(
            "Error of the fewest photons over that of the most, in ratio",
            gain,
            "",
            [2.0, 0.9 * times],
            "Noise alone would fall as 1/k, a hundredfold; what is blurred does not fall at all.",
        ),
        Number::within(
            "Error at the most photons, narrowing over in ratio",
            last(&narrowing_errors) / last(&ratio_errors),
            "",
            [0.0, 0.9],
            "A smaller radius blurs less, and there are photons enough.",
        ),
    ]);
    body.finding(
        "Fig 2.6",
        "More photons with k in proportion make a smoother picture.",
        "It does not come nearer to the truth for ever: the blur stays.",
        "At a constant k/N the radius is constant. It must shrink, more slowly than the photons grow.",
    );
    Ok(body)
}

/// As in the report.
fn k_in_ratio(count: u64) -> u64 {
    count / 100
}

/// Where noise, 1/k, and squared bias, (k/N)², fall together.
fn k_narrowing(count: u64) -> u64 {
    let k = 100.0 * libm::pow(count as f64 / 10_000.0, 2.0 / 3.0);
    libm::round(k) as u64
}

fn of(lab: &Lab, count: u64, k: u64) -> Result<Render, Stop> {
    // More than the report's 8 a pixel: jagged edges are an error, too, and not of the photons.
    let samples = lab.pick(32, 16);
    lab.render(&lab.recipe("report-2-6").set("photons", count).set("neighbours", k).samples(samples))
}
