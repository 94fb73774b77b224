//! The kernels themselves.

use std::f64::consts::PI;

use nephroid::photon_map::Kernel;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::section::{Section, Stop, Weight};
use crate::statistics::integral;

/// Figure 3.11.
pub const SECTION: Section = Section {
    id: "fig-3-11",
    report: "Fig 3.11",
    title: "the kernels and their norms",
    weight: Weight { full: 0.1, quick: 0.1 },
    run,
};

/// Each with its name on the page.
const KERNELS: [(&str, Kernel); 6] = [
    ("Box", Kernel::Box),
    ("Cone", Kernel::Cone { k: 1.0 }),
    ("Gaussian", Kernel::Gaussian),
    ("Epanechnikov", Kernel::Epanechnikov),
    ("Biweight", Kernel::Biweight),
    ("Gaussian of the report", Kernel::ReportGaussian),
];

/// A measure of 1, 2 or 3 dimensions: its name, the area of the sphere of radius 1, and a kernel's weight.
type Dimension = (&'static str, i32, f64, fn(Kernel, f32, f32) -> f32);

const DIMENSIONS: [Dimension; 3] = [
    ("one dimension (beams)", 1, 2.0, Kernel::weight_1d),
    ("two dimensions (surfaces)", 2, 2.0 * PI, Kernel::weight_2d),
    ("three dimensions (media)", 3, 4.0 * PI, Kernel::weight_3d),
];

fn run(_: &Lab) -> Result<Body, Stop> {
    let mut body = Body::new();
    body.say(
        "A kernel says how a photon's power is spread over the radius around it; all of it must be spread, so its integral is 1. \
         The report's cone, Epanechnikov and biweight kernels have their integrals right on surfaces. Its Gaussian has not: \
         its factor 0.918 comes from a filter for pixels, and loses almost half of the light. It looks smooth as it is hardly \
         narrower than the box, and dark as its norm is wrong.",
    );
    body.say(
        "The norms for surfaces do not serve in media, where a ball takes the place of the disc: there the report's Epanechnikov \
         kernel would lose a fifth, the biweight a third.",
    );
    for (name, d, sphere, weight) in DIMENSIONS {
        let unit = ["1/m", "1/m²", "1/m³"][d as usize - 1];
        let chart = KERNELS.iter().fold(
            Chart::new("distance over radius", &format!("weight, {unit}, for a radius of 1 m")).from(0.0),
            |chart, &(name, kernel)| chart.line(name, profile(kernel, weight)),
        );
        let alt = format!("Six curves that fall from the centre to the radius, in {name}; the box is level.");
        let caption =
            format!("In {name}. Integrals are over a measure of {} r{}.", measure(sphere, d), power(d));
        body.plot(chart.draw(&alt, &caption)?);
    }

    let norm = |kernel, (_, d, sphere, weight): Dimension| {
        integral(|t| sphere * t.powi(d - 1) * f64::from(weight(kernel, (t * t) as f32, 1.0)))
    };
    let row = |&(name, kernel): &(&str, Kernel)| {
        let norms = DIMENSIONS.map(|dimension| format::number(norm(kernel, dimension)));
        let (noise, mass) = (variance(kernel), norm(kernel, DIMENSIONS[1]));
        let more =
            [noise, noise * mass * mass, f64::from(kernel.equal_bandwidth_factor())].map(format::number);
        [vec![name.to_owned()], norms.to_vec(), more.to_vec()].concat()
    };
    let head = [
        "Kernel",
        "Integral, 1D",
        "Integral, 2D",
        "Integral, 3D",
        "Variance by the box's, integral put to 1",
        "The same as written",
        "k for equal blur",
    ];
    body.table(
        "Integrals by quadrature, and the noise at an equal radius; as written a kernel that loses light loses noise with it",
        &head,
        KERNELS.iter().map(row).collect(),
    );
    body.say(
        "At an equal radius, a kernel that falls off uses fewer photons and is noisier: in this order the report found the \
         kernels spotty. At one k it compared different blurs. At k multiplied by the last column all blur alike.",
    );

    let mut numbers = Vec::new();
    for (name, kernel) in KERNELS.into_iter().filter(|(_, kernel)| *kernel != Kernel::ReportGaussian) {
        for dimension in DIMENSIONS {
            let name = format!("{name}, integral in {}D", dimension.1);
            let value = norm(kernel, dimension);
            numbers.push(Number::within(&name, value, "", [0.9999, 1.0001], "All power is spread."));
        }
    }
    let lost = norm(Kernel::ReportGaussian, DIMENSIONS[1]);
    let garcia = "Garcia et al. (2014): it underestimates radiance by 46.9 per cent.";
    numbers.push(Number::within(
        "Gaussian of the report, integral in 2D",
        lost,
        "",
        [0.5305, 0.5315],
        garcia,
    ));
    for (name, kernel, share) in
        [("Epanechnikov", Kernel::Epanechnikov, 0.8), ("Biweight", Kernel::Biweight, 24.0 / 35.0)]
    {
        let in_ball =
            f64::from(kernel.norm_2d()) * integral(|t| 3.0 * t * t * f64::from(kernel.shape((t * t) as f32)));
        let name = format!("{name}, the report's norm in 3D");
        let why = "2 · 2/5 and 3 · 8/35: a norm for surfaces in a medium.";
        numbers.push(Number::within(&name, in_ball, "", [share - 1e-4, share + 1e-4], why));
    }
    for (name, kernel, ratio) in [
        ("Gaussian", Kernel::Gaussian, 1.13),
        ("Epanechnikov", Kernel::Epanechnikov, 4.0 / 3.0),
        ("Cone", Kernel::Cone { k: 1.0 }, 1.5),
        ("Biweight", Kernel::Biweight, 1.8),
    ] {
        let name = format!("{name}, variance at an equal radius by the box's");
        let why = "π r² ∫ w²: 4/3, 3/2 and 9/5 in closed form, and 1.13 for the Gaussian.";
        numbers.push(Number::within(&name, variance(kernel), "", [ratio - 5e-3, ratio + 5e-3], why));
    }
    body.numbers(numbers);
    body.finding(
        "Fig 3.11",
        "The shapes, and the norms of cone, Epanechnikov and biweight kernels on surfaces.",
        &format!(
            "The Gaussian integrates to {} and not to 1; in media every norm is another.",
            format::number(lost)
        ),
        "Its constants are those of a filter for pixels, which reaches zero at √2 r.",
    );
    Ok(body)
}

/// From the centre to a little beyond the radius.
fn profile(kernel: Kernel, weight: fn(Kernel, f32, f32) -> f32) -> Vec<(f64, f64)> {
    let at = |t: f64| (t, f64::from(weight(kernel, (t * t) as f32, 1.0)));
    let inside = (0..=100).map(|i| at(f64::from(i) / 100.0));
    inside.chain([(1.0, 0.0), (1.1, 0.0)]).collect()
}

/// π r² ∫ w² over the disc, of the kernel with its right norm: how noisy it is beside the box of the same radius.
fn variance(kernel: Kernel) -> f64 {
    let shape = |t: f64| f64::from(kernel.shape((t * t) as f32));
    let mass = integral(|t| 2.0 * t * shape(t));
    integral(|t| 2.0 * t * shape(t) * shape(t)) / (mass * mass)
}

fn measure(sphere: f64, dimension: i32) -> String {
    format::number(sphere / f64::from(dimension))
}

fn power(dimension: i32) -> String {
    if dimension == 1 { String::new() } else { format::superscript(&dimension.to_string()) }
}
