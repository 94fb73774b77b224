//! Whether the photon that sets the radius counts in the estimate.

use nephroid::color::Rgb;
use nephroid::math::Vec3;
use nephroid::photon_map::{Bandwidth, Kernel, NearestList, Photon, PhotonMap, Photons, Query, gather};
use nephroid::sampling::Sampler;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::section::{Section, Stop, Weight};
use crate::wrong;

/// Equation 2.2.
pub const SECTION: Section = Section {
    id: "equation-2-2",
    report: "Equation 2.2",
    title: "beyond the report, what k − 1 changes (Question 2.1)",
    weight: Weight { full: 8.0, quick: 2.5 },
    run,
};

/// Neighbours of the estimates.
const NEIGHBOURS: [u32; 3] = [5, 10, 50];

/// Photons of an experiment, as a multiple of the neighbours: the disc of the nearest never reaches the edge.
const PHOTONS_EACH: u32 = 20;

/// Means over many patterns of photons, by the true irradiance.
struct Means {
    neighbours: u32,
    patterns: u32,
    inner: f64,
    all: f64,
}

impl Means {
    /// Bounds the standard deviation of the mean of the inner photons' estimate.
    ///
    /// The part of the area within the k-th of n even points has the Beta density of k and n + 1 − k, from which the
    /// relative variance of (k − 1)/(πr²) is less than 1/(k − 2).
    fn deviation(&self) -> f64 {
        1.0 / (f64::from(self.neighbours - 2) * f64::from(self.patterns)).sqrt()
    }

    fn excess(&self) -> f64 {
        f64::from(self.neighbours) / f64::from(self.neighbours - 1)
    }
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let mut sampler = lab.sampler(22);
    let patterns = |k: u32| lab.pick(1_000_000, 300_000) / k;
    let means: Vec<Means> = NEIGHBOURS
        .iter()
        .map(|&k| lab.check().map(|()| of_patterns(&mut sampler, k, patterns(k))))
        .collect::<Result<_, _>>()?;

    let mut body = Body::new();
    body.say(
        "Equation 2.2 sums all k photons and divides by the disc that ends at the last of them. That photon is there by \
         construction, not by chance, so the estimate is too bright, by k/(k − 1) on a plane that is lit evenly: a quarter \
         at k = 5, 2 % at k = 50.",
    );
    body.say(
        "Here the photon that sets the radius is not counted, and the mean is right at every k. The report advises 50 \
         neighbours and more, where this hides below its noise.",
    );
    let row = |means: &Means| {
        let numbers = [means.all, means.excess(), means.inner].map(format::number);
        [vec![means.neighbours.to_string(), means.patterns.to_string()], numbers.to_vec()].concat()
    };
    let head = ["k", "Patterns of photons", "All k, measured", "k/(k − 1)", "Inner k − 1, measured"];
    body.table(
        "Mean estimate of an even irradiance of 1 W/m², in W/m²",
        &head,
        means.iter().map(row).collect(),
    );
    let curve = (0..=96).map(|i| 4.0 + 0.5 * f64::from(i)).map(|k| (k, k / (k - 1.0))).collect();
    let measured =
        |value: fn(&Means) -> f64| means.iter().map(|m| (f64::from(m.neighbours), value(m))).collect();
    let chart = Chart::new("neighbours k", "mean estimate, W/m²");
    let chart = chart.line("k/(k − 1)", curve);
    let chart = chart.points("all k photons, as in the report", measured(|m| m.all));
    let chart = chart.points("the inner k − 1", measured(|m| m.inner));
    body.plot(chart.draw(
        "The estimates of all k fall from 1.25 at 5 neighbours to 1.02 at 50, along k/(k − 1); those of k − 1 stay at 1.",
        "Means over many independent patterns of even photons. The true irradiance is 1 W/m².",
    )?);
    let numbers = means.iter().flat_map(|m| {
        let k = m.neighbours;
        let within = |mean: f64| [mean * (1.0 - 6.0 * m.deviation()), mean * (1.0 + 6.0 * m.deviation())];
        let why = "Six standard deviations of the mean, from the Beta density of the disc: wrongly outside of it less than \
                   once in a million runs.";
        [
            Number::within(&format!("Mean of the inner photons, k = {k}"), m.inner, "W/m²", within(1.0), why),
            Number::within(&format!("Mean of all photons, k = {k}"), m.all, "W/m²", within(m.excess()), why),
        ]
    });
    body.numbers(numbers.collect());
    body.finding(
        "Question 2.1, Equation 2.2",
        "Flux over the area of the disc stands for incoming radiance; in media it is a volume, and a phase function in place \
         of the material.",
        &format!(
            "All k photons are counted: the mean is {} times the truth at k = 5, {} times at k = 50.",
            format::number(means[0].all),
            format::number(means[2].all)
        ),
        "The k-th photon sets the radius. The k − 1 within are those that come by chance.",
    );
    Ok(body)
}

/// Lights the square [−1, 1]² evenly with 1 W/m², and estimates it at its centre.
fn of_patterns(sampler: &mut Sampler, k: u32, patterns: u32) -> Means {
    let photons = PHOTONS_EACH * k;
    let power = Rgb::splat(4.0 / photons as f32);
    let query = Query { position: Vec3::ZERO, normal: Vec3::Z, max_photon_depth: None };
    let bandwidth = Bandwidth::Nearest { k, max_radius: 1.0 };
    let mut scratch = NearestList::new();
    let (mut inner, mut all) = (0.0, 0.0);
    for _ in 0..patterns {
        let photon = |_| {
            let u = sampler.next_2d();
            let position = Vec3::new(2.0 * u.x - 1.0, 2.0 * u.y - 1.0, 0.0);
            Photon { position, power, wi: Vec3::Z, normal: Vec3::Z, depth: 1, light: 0 }
        };
        let list: Vec<Photon> = (0..photons).map(photon).collect();
        let distances_sq = list.iter().map(|p| f64::from(p.position.length_squared())).collect();
        all += wrong::density_of_all(distances_sq, k as usize) * f64::from(power.r);
        let map: PhotonMap = PhotonMap::build(Photons::new(1, list));
        let mut irradiance = 0.0;
        gather(&map, &query, Kernel::Box, bandwidth, &mut scratch, |photon, weight| {
            irradiance += f64::from(photon.power.r) * f64::from(weight);
        });
        inner += irradiance;
    }
    let n = f64::from(patterns);
    Means { neighbours: k, patterns, inner: inner / n, all: all / n }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::wrong;

    #[test]
    fn the_wrong_form_counts_the_last() {
        let density = wrong::density_of_all(vec![4.0, 1.0, 0.25], 2);
        assert!((density - 2.0 / PI).abs() < 1e-12, "{density}");
    }
}
