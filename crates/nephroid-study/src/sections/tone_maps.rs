//! Every tone mapping of the report, of one picture.

use nephroid::color::Rgb;
use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.14.
pub const SECTION: Section = Section {
    id: "fig-2-14",
    report: "Fig 2.14",
    title: "tone mapping",
    weight: Weight { full: 8.0, quick: 1.0 },
    run,
};

/// Names on the command line, and what each is.
const OPERATORS: [(&str, &str); 9] = [
    ("equalize", "Equalise (a), by the maximum"),
    ("equalize-report", "Equalise as printed, by the maximum less the minimum"),
    ("gamma:2.2", "Gamma 2.2 (b)"),
    ("reinhard:0.18,1.5", "Reinhard, white at 1.5 (c)"),
    ("reinhard", "Reinhard, white at the maximum (d)"),
    ("clamp:1", "Clamp at 1"),
    ("equalize-clamp:4", "Equalise and clamp at 4"),
    ("clamp-gamma:4,2.2", "Clamp at 4 and gamma 2.2"),
    ("srgb", "No tone mapping: the display's curve"),
];

/// Those whose curves are drawn in each chart: eight can be told apart, and the first is in both.
const CURVES: [&[usize]; 2] = [&[0, 2, 3, 4, 5, 6, 7, 8], &[0, 1]];

/// Of a picture with so low a median on the display little but lights is to be seen.
const DARK: f64 = 0.1;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let render = lab.render(&lab.recipe("report-2-14"))?;
    let image = &render.image;
    let looks = OPERATORS.map(|(name, _)| Look::named(name));
    let looks: Vec<Look> = looks.into_iter().collect::<Result<_, _>>()?;

    let mut body = Body::new();
    body.say(
        "One render, shown in nine ways. The lamp is in the picture and hundreds of times as bright as the walls, so to divide by \
         the maximum leaves the room dark, with a gamma as without. Reinhard's operator brings the room's mean to middle \
         grey and bends what is brighter: it fits, as the report says.",
    );
    body.say(
        "Two of the report's formulas cannot be taken as they are printed. L/(max − min) exceeds 1 wherever nothing is black. And its mean \
         luminance has 1/N before the exponential and not in it, a misprint that comes from the paper it cites: taken at \
         its word, the mean has nothing to do with the picture, as a number below shows.",
    );
    let alt = "A box with a mirror ball, two glass balls and a visible lamp";
    let median = |i: usize| {
        let mut greens: Vec<f32> = looks[i].apply(image).pixels.iter().map(|p| p.g).collect();
        greens.sort_by(f32::total_cmp);
        f64::from(greens[greens.len() / 2])
    };
    let pictures = looks.iter().zip(OPERATORS).enumerate().map(|(i, (look, (_, what)))| {
        let seen = if median(i) < DARK { "dark but for its lights" } else { "with its walls to be seen" };
        Picture::of(&render, look, &format!("{alt}, {seen}."), what)
    });
    body.strip(pictures.collect::<Result<_, _>>()?);

    let luminances: Vec<f64> = image.pixels.iter().map(|p| f64::from(p.luminance())).collect();
    let [chart, equalised] = CURVES.map(|curves| {
        let chart = Chart::new("luminance, W/(m²·sr)", "value of the display").logarithmic_x().from(0.0);
        curves.iter().fold(chart, |chart, &i| chart.line(OPERATORS[i].1, curve(&looks[i], image)))
    });
    let [least, low, high] = [0.0, 0.05, 0.95].map(|part| format::number(quantile(&luminances, part)));
    let caption = format!(
        "What each makes of a grey of this picture, after the display's curve. Nine tenths of the pixels lie between {low} and \
         {high} W/(m²·sr), a twentieth below and a twentieth above."
    );
    body.plot(chart.draw(
        "Curves of display value over luminance. Equalising rises only near the maximum, Reinhard's operators bend slowly.",
        &caption,
    )?);
    body.plot(equalised.draw(
        "Two curves of display value over luminance, by the maximum, and by the maximum less the minimum.",
        &format!("Equalising in both forms. They differ by the least luminance, which is {least} W/(m²·sr) in this picture."),
    )?);

    let white = |i: usize| white_part(&looks[i].apply(image));
    let row = |i: usize| {
        let (name, what) = OPERATORS[i];
        let command = format!("--tonemap {name}");
        vec![what.to_owned(), command, format::number(median(i)), format::number(white(i))]
    };
    let head = ["Operator", "Flag", "Median of the display", "White pixels, %"];
    body.table("The pictures in numbers", &head, (0..OPERATORS.len()).map(row).collect());

    let (log_average, log10_as_printed) = log_averages(&luminances);
    body.numbers(vec![
        Number::within(
            "White part of a ramp of greys from 1 to 2, by the maximum",
            white_of_ramp("equalize")?,
            "%",
            [0.0, 1.0],
            "Its brightest grey alone is white.",
        ),
        Number::within(
            "White part of that ramp, by L/(max − min) as printed",
            white_of_ramp("equalize-report")?,
            "%",
            [99.0, 100.0],
            "Greys from 1 to 2, divided by 1, are all clipped: where nothing is black, the formula does not end at 1.",
        ),
        Number::within(
            "Log-average luminance, 1/N in the exponent, by the median",
            log_average / quantile(&luminances, 0.5),
            "",
            [0.5, 2.0],
            "Walls fill most of the picture, so that a mean of logarithms is near its middle.",
        ),
        Number::within(
            "Distance of the printed log-average from that, in powers of ten",
            (log10_as_printed - libm::log10(log_average)).abs(),
            "",
            [2.0, f64::MAX],
            "With 1/N outside, the exponent is a sum over all pixels: hundreds or thousands of powers of ten astray.",
        ),
        Number::within(
            "Median of the display, Reinhard with white at the maximum",
            median(4),
            "",
            [0.2, 0.7],
            "The key of 0.18 is 0.43 on the display after L/(1 + L); half of the picture is brighter, half darker.",
        ),
        Number::within(
            "Median of the display, equalised",
            median(0),
            "",
            [0.0, 0.15],
            "The lamp has hundreds of times the radiance of the walls.",
        ),
    ]);
    body.finding(
        "Fig 2.14",
        "Equalising is too dark, Reinhard's operator fits a scene with its lamp in view.",
        "L/(max − min) exceeds 1, and 1/N belongs into the exponent. White is in scaled units, and the operator acts on luminance.",
        "Printed as it is, the log-average of this picture is powers of ten away from its middle; which code made the report's \
         pictures cannot be read.",
    );
    Ok(body)
}

/// The log-average as it should be, and the decimal logarithm of the report's, which is beyond what a number holds.
fn log_averages(luminances: &[f64]) -> (f64, f64) {
    let n = luminances.len().max(1) as f64;
    // Black pixels would drive it.
    let delta = 1e-6 * luminances.iter().copied().fold(0.0, f64::max);
    let sum: f64 = luminances.iter().map(|l| libm::log(delta + l)).sum();
    (libm::exp(sum / n), sum / std::f64::consts::LN_10 - libm::log10(n))
}

/// The value that so great a part is below.
fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((part * sorted.len() as f64) as usize).min(sorted.len() - 1)]
}

/// Of greys from 1 to 2 in even steps, the part that is shown as white, in per cent.
fn white_of_ramp(operator: &str) -> Result<f64, Stop> {
    let pixels = (0..=200).map(|i| Rgb::splat(1.0 + i as f32 / 200.0)).collect();
    Ok(white_part(&Look::named(operator)?.apply(&Image { width: 201, height: 1, pixels })))
}

/// Of a picture on a display, in per cent.
fn white_part(shown: &Image) -> f64 {
    let white = shown.pixels.iter().filter(|p| p.min_channel() >= 1.0).count();
    100.0 * white as f64 / shown.pixels.len() as f64
}

/// Display values of greys that have the luminances of this picture.
fn curve(look: &Look, image: &Image) -> Vec<(f64, f64)> {
    let mut greys: Vec<f32> = image.pixels.iter().map(|p| p.luminance()).collect();
    greys.sort_by(f32::total_cmp);
    let pixels = greys.iter().map(|&l| Rgb::splat(l)).collect();
    let shown = look.apply(&Image { width: greys.len() as u32, height: 1, pixels });
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (l, shown) in greys.iter().zip(&shown.pixels) {
        let far = points.last().is_none_or(|last| f64::from(*l) > 1.15 * last.0);
        if *l > 1e-3 && far {
            points.push((f64::from(*l), f64::from(shown.g)));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::film::{ToneMap, White};

    #[test]
    fn the_operators_are_those_of_the_program() {
        for (name, _) in OPERATORS {
            assert!(ToneMap::parse(name).is_ok(), "{name}");
        }
        assert_eq!(
            ToneMap::parse("reinhard").ok(),
            Some(ToneMap::Reinhard { key: 0.18, white: White::Automatic })
        );
    }
}
