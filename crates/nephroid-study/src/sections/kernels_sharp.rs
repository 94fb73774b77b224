//! Kernels where radiance changes within little space.

use nephroid::film::ImageError;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

use super::kernels_compared::{KERNELS, RIGHT};

/// What section 3.2 of the report wishes for.
pub const SECTION: Section = Section {
    id: "section-3-2",
    report: "Section 3.2",
    title: "kernels on a sharp caustic",
    weight: Weight { full: 60.0, quick: 4.0 },
    run,
};

fn run(lab: &Lab) -> Result<Body, Stop> {
    let recipe = lab.recipe("nephroid").side(lab.pick(192, 64));
    let samples = lab.pick(512, 128);
    let reference = lab.render(&recipe.clone().flag("--integrator", "ppm").flag("--spp", samples))?;
    let ks: &[u32] = lab.pick(&[10, 20, 40, 80, 160, 320, 640], &[10, 40, 160, 640]);
    let of = |kernel: &str, k: u32| {
        let recipe = recipe.clone().set("caustic_photons", 30_000).set("photons", 10_000);
        let recipe = recipe.set("neighbours", k).set("final_gather", "off").samples(16);
        lab.render(&recipe.flag("--kernel", kernel))
    };
    let error = |image: &nephroid::texture::Image| {
        let error =
            ImageError::between(image, &reference.image, ImageError::EPSILON).map_err(Stop::because)?;
        Ok::<_, Stop>(error.rel_mse)
    };

    let shown = lab.pick(80, 40);
    let look = Look::exposed(-0.5);
    let mut pictures = Vec::new();
    let mut curves = Vec::new();
    for (name, kernel) in &KERNELS[..RIGHT] {
        let mut curve = Vec::new();
        for &k in ks {
            let render = of(kernel, k)?;
            curve.push((f64::from(k), error(&render.image)?));
            if k == shown {
                let alt =
                    format!("A bright curve with a cusp on a floor within a brass ring: {name} kernel.");
                pictures.push(Picture::of(&render, &look, &alt, &format!("{name}, k = {k}"))?);
            }
        }
        curves.push((*name, curve));
    }
    let alt = "The curve within the ring, sharp: the reference.";
    let caption = format!("Reference: progressive photon mapping, {samples} samples a pixel");
    pictures.push(Picture::of(&reference, &look, alt, &caption)?);

    let mut body = Body::new();
    body.say(
        "The report asks for scenes in which bright and dark lie close together. Here light is turned back by a polished ring and draws \
         the curve that has given this renderer its name. All kernels see the same 30 000 caustic photons.",
    );
    body.strip(pictures);
    let chart = curves.iter().fold(
        Chart::new("neighbours k", "relMSE against the reference").logarithmic(),
        |chart, (name, curve)| chart.points(name, curve.clone()),
    );
    let best = |i: usize| curves[i].1.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let last = |i: usize| curves[i].1.last().map_or(f64::NAN, |p| p.1);
    let first = |i: usize| curves[i].1.first().map_or(f64::NAN, |p| p.1);
    let falling = (1..RIGHT).map(best);
    let (low, high) = falling.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    let unlike = format::rounded(100.0 * (high / low - 1.0), 2);
    let box_more = format::rounded(100.0 * (best(0) / low - 1.0), 2);
    let open: Vec<&str> = (0..RIGHT).filter(|&i| first(i) <= best(i)).map(|i| curves[i].0).collect();
    let open = if open.is_empty() {
        "The least error of each lies between the k that were tried.".to_owned()
    } else {
        format!(
            "Fewer than {} neighbours were not tried, and the error is least there for: {}.",
            ks[0],
            open.join(", ")
        )
    };
    body.plot(chart.draw(
        "Five curves of error over the number of neighbours; all of them rise towards the right.",
        &format!(
            "Few neighbours are noisy, many blur the curve. At the best k tried, kernels that fall off err within {unlike} % of one another. \
             {open}"
        ),
    )?);
    body.say(&format!(
        "At many neighbours, where blur is the larger error, the narrow kernels, cone and biweight, are better. At the best k \
         that was tried for each, the kernels that fall off err within {unlike} % of one another, and the box {box_more} % more than the \
         best of them. {open} The number of neighbours matters more than the kernel, here too: from the best k tried to the \
         most, the biweight's error grows to {} times.",
        format::number(last(RIGHT - 1) / best(RIGHT - 1)),
    ));
    let row = |i: usize| {
        let cells = [first(i), best(i), last(i)].map(format::number);
        [vec![curves[i].0.to_owned()], cells.to_vec()].concat()
    };
    let caption = format!("relMSE at k = {}, at the best k shown, and at k = {}", ks[0], ks[ks.len() - 1]);
    body.table(&caption, &["Kernel", "Fewest", "Best", "Most"], (0..RIGHT).map(row).collect());
    let biweight = RIGHT - 1;
    body.numbers(vec![
        Number::within(
            "Biweight by box, fewest neighbours",
            first(biweight) / first(0),
            "",
            [1.0, 2.2],
            "Noise rules: the variance of a biweight is 1.8 times the box's at one radius, and edges and blur are in both.",
        ),
        Number::within(
            "Biweight by box, most neighbours",
            last(biweight) / last(0),
            "",
            [0.2, 0.95],
            "Blur rules: the biweight's width is half of the box's by its second moment, so its bias is less.",
        ),
        Number::within(
            "Largest by least of the best errors, kernels that fall off",
            high / low,
            "",
            lab.pick([1.0, 1.25], [1.0, 1.4]),
            "For smooth densities theory says within a part in a hundred at the best width of each; at a caustic's edge it does \
             not hold. And the numbers of neighbours are a factor of two or four apart, so the best is missed.",
        ),
        Number::within(
            "Stated error of the reference",
            100.0 * reference.error()?,
            "%",
            lab.pick([0.0, 6.0], [0.0, 15.0]),
            "Its square is to be small beside the errors that are measured by it.",
        ),
    ]);
    body.finding(
        "Section 3.2.5: kernels in scenes with sharp changes",
        "Differences between kernels are larger here, and kernels that fall off are better than the box.",
        &format!("Which of them is best depends on k; at the best k tried for each they err within {unlike} % of one another. {open}"),
        "A kernel's width trades noise for blur; its shape matters less.",
    );
    Ok(body)
}
