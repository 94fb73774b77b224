//! One lamp and two.

use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Figure 2.2.
pub const SECTION: Section = Section {
    id: "fig-2-2",
    report: "Fig 2.2",
    title: "one light of 5 W/sr, and another of 15 W/sr",
    weight: Weight { full: 6.0, quick: 0.6 },
    run,
};

/// An exposure at which two lamps leave little white, and one lamp is to be seen.
const STOPS: f32 = -1.5;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let one = lab.render(&lab.recipe("report-2-2a"))?;
    let two = lab.render(&lab.recipe("report-2-2b"))?;
    let (fixed, by_maximum) = (Look::exposed(STOPS), Look::named("reinhard")?);

    let mut body = Body::new();
    body.say(
        "The second light stands at the right and is three times as strong as the first. Shadows of each are lit by the other. \
         The report's tone mapping hides that there is four times as much light: it scales a picture by its own mean and \
         its own maximum. At one exposure for both it is plain.",
    );
    let alt_one = "A box with a red wall at the left and a green one at the right, a white and a glass sphere, lit from the \
                   top left: one hard shadow of each sphere, and a caustic.";
    let alt_two = "The same box lit from both top corners: two shadows of each sphere, each of them softened by the other lamp.";
    let pair = |look: &Look, how: &str| -> Result<(Picture, Picture), Stop> {
        Ok((
            Picture::of(&one, look, alt_one, &format!("One light, {how}"))?,
            Picture::of(&two, look, alt_two, &format!("Two lights, {how}"))?,
        ))
    };
    let (left, right) = pair(&by_maximum, "by the maximum, as in the report")?;
    body.pair(left, right);
    let (left, right) = pair(&fixed, "at one exposure")?;
    body.pair(left, right);

    let ratio = two.mean() / one.mean();
    let shown = |look: &Look| display_mean(&look.apply(&two.image)) / display_mean(&look.apply(&one.image));
    let (hidden, plain) = (shown(&by_maximum), shown(&fixed));
    let energy = |image: &Image| image.pixels.iter().map(|p| f64::from(p.mean())).sum::<f64>();
    let row = |name: &str, image: &Image, mean: f64| {
        vec![name.to_owned(), format::number(mean), format::number(energy(image))]
    };
    let rows = vec![row("One light", &one.image, one.mean()), row("Two lights", &two.image, two.mean())];
    let head = ["Picture", "Mean radiance, W/(m²·sr)", "Sum over pixels, W/(m²·sr)"];
    body.table("Light in the pictures", &head, rows);
    body.numbers(vec![
        Number::within(
            "Light in both pictures, two to one",
            ratio,
            "",
            [3.2, 4.8],
            "The lamps give off four times as much and stand alike; walls and spheres differ, by less than a fifth.",
        ),
        Number::within(
            "As displayed, by the maximum",
            hidden,
            "",
            [0.6, 1.7],
            "The report's remark: the tone mapping hides the fourfold light.",
        ),
        Number::within(
            "As displayed, at one exposure",
            plain,
            "",
            [1.5, 3.0],
            "It is seen. The display's curve is about light to the power of 1/2.2, of which fourfold light makes 1.9.",
        ),
    ]);
    body.finding(
        "Fig 2.2",
        "Two lights soften one another's shadows, and a tone mapping by the maximum hides that there is more light.",
        "Nothing. The remedy is named here: one exposure for pictures that are compared.",
        "A tone mapping that follows the picture is not for comparisons.",
    );
    Ok(body)
}

/// Mean of what a display gets.
fn display_mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).sum();
    sum / (3 * image.pixels.len()).max(1) as f64
}
