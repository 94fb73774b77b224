//! Directions from a point light: two right ways, and a wrong one.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig};
use nephroid::laboratory::record_photons;
use nephroid::light::SphereSampling;
use nephroid::math::Vec3;
use nephroid::session::RenderSettings;
use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::scenes::lights_in_sphere;
use crate::section::{Section, Stop, Weight};
use crate::statistics::{ChiSquared, sphere_counts};
use crate::wrong;

/// Light sampling.
pub const SECTION: Section = Section {
    id: "fig-2-1",
    report: "Fig 2.1",
    title: "directions from a point light (Question 1.1)",
    weight: Weight { full: 3.0, quick: 0.6 },
    run,
};

/// Cells of the test: all of one solid angle.
const CELLS: (usize, usize) = (32, 16);

fn run(lab: &Lab) -> Result<Body, Stop> {
    let count = lab.pick(400_000, 50_000);
    let solid_angle = of_photons(lab, SphereSampling::SolidAngle, count)?;
    let rejection = of_photons(lab, SphereSampling::Rejection, count)?;
    let mut numbers = lab.sampler(1);
    let wrong: Vec<Vec3> = (0..count).map(|_| wrong::latitude_from_the_pole(numbers.next_2d())).collect();

    let mut body = Body::new();
    body.say(
        "Photons should leave a point light evenly in all directions. Both of the report's ways do that: a point of the cube \
         that is thrown away until it lies in the ball, and two angles of which the sine of the latitude is even. Each dot \
         is a photon that the renderer stored on a sphere about the lamp.",
    );
    body.say(
        "The report's text lets the latitude run from −π to π, which would cover the sphere twice; its code, the arc sine of a \
         number in [−1, 1], is right. Rejection is right only if the point is moved onto the sphere afterwards. The third \
         way is our guess at what section 2.4 of the report looked for a long time (Fig 2.12), which says no more than that it \
         was in making the ray from the angles: a latitude that is taken for an angle from the pole leaves one half of the \
         room without photons.",
    );
    let kinds = [
        ("Solid angle", &solid_angle, "Dots evenly over two discs, one for each half of the sphere."),
        ("Rejection", &rejection, "Dots evenly over two discs, one for each half of the sphere."),
        (
            "Wrong angles, our guess at Fig 2.12",
            &wrong,
            "All dots are in the left disc, crowded at its centre; the right disc is empty.",
        ),
    ];
    let dots = kinds.map(|(name, directions, alt)| {
        let caption = format!("{name}: {DOTS} directions, seen from above and from below.");
        Picture::new(&hemispheres(directions), &Look::drawn(), alt, &caption)
    });
    body.strip(dots.into_iter().collect::<Result<_, _>>()?);
    let maps = kinds.map(|(name, directions, _)| {
        let alt = format!("A map of the sphere in cells of one solid angle: {name}.");
        let caption = format!(
            "{name}: {} directions in cells of one solid angle, from the pole above to the one below. Middle grey is what \
             even directions have; white is twice as many, or more.",
            directions.len()
        );
        Picture::new(&density(directions), &Look::drawn(), &alt, &caption)
    });
    body.strip(maps.into_iter().collect::<Result<_, _>>()?);

    let tests = kinds.map(|(name, directions, _)| {
        (name, ChiSquared::of_even(&sphere_counts(directions, CELLS.0, CELLS.1)))
    });
    let row = |(name, test): &(&str, ChiSquared)| {
        let cells = [test.statistic, test.freedom, test.p_value].map(format::number);
        [vec![(*name).to_owned()], cells.to_vec()].concat()
    };
    let caption = format!("χ² of {count} directions in {} cells of one solid angle", CELLS.0 * CELLS.1);
    let head = ["Sampling", "χ²", "Degrees of freedom", "p"];
    body.table(&caption, &head, tests.iter().map(row).collect());

    let (accepted, tried) = acceptance(lab, count);
    let share = accepted as f64 / tried as f64;
    let expected = std::f64::consts::PI / 6.0;
    // 4.9 standard deviations: once in a million runs by chance.
    let off = 4.9 * libm::sqrt(expected * (1.0 - expected) / tried as f64);
    let even = "Even directions fall below 10⁻⁴ once in 10 000 seeds.";
    body.numbers(vec![
        Number::within("p of χ², solid angle", tests[0].1.p_value, "", [1e-4, 1.0], even),
        Number::within("p of χ², rejection", tests[1].1.p_value, "", [1e-4, 1.0], even),
        Number::within(
            "p of χ², wrong angles",
            tests[2].1.p_value,
            "",
            [0.0, 1e-12],
            "It must be found out.",
        ),
        Number::within(
            "Accepted by rejection",
            share,
            "",
            [expected - off, expected + off],
            "The ball's part of the cube, π/6, within 4.9 standard deviations.",
        ),
    ]);
    body.finding(
        "Fig 2.1, Question 1.1",
        "Rejection and the arc sine of an even number are both even over the sphere.",
        "Latitudes do not run from −π to π, and cos θ is a density only when divided by 2.",
        "A slip in the text: the integral beside it has the right limits, and the code is right.",
    );
    Ok(body)
}

/// Where the renderer's photons flew that came straight from a lamp.
fn of_photons(lab: &Lab, sphere_sampling: SphereSampling, count: u64) -> Result<Vec<Vec3>, Stop> {
    let world = lights_in_sphere(&[(Vec3::ZERO, 1.0)], Rgb::splat(0.5))?;
    let config = PhotonMapperConfig {
        emit: Some(count),
        max_depth: Some(2),
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        aim: false,
        sphere_sampling,
        ..PhotonMapperConfig::default()
    };
    let method = Method::PhotonMapper(config);
    let settings = RenderSettings { method, samples_per_pixel: 1, seed: lab.seed() };
    let photons = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    Ok(photons.photons.iter().filter(|p| p.photon.depth == 1).map(|p| -p.photon.wi).collect())
}

/// How many of so many points of the cube lie in the ball.
fn acceptance(lab: &Lab, count: u64) -> (u64, u64) {
    let mut numbers = lab.sampler(2);
    let mut point = || {
        let a = numbers.next_2d();
        2.0 * Vec3::new(a.x, a.y, numbers.next_1d()) - Vec3::ONE
    };
    let accepted = (0..count).filter(|_| point().length_squared() <= 1.0).count();
    (accepted as u64, count)
}

/// Directions that are drawn.
const DOTS: usize = 2500;

/// The first directions as dots: those upwards in a disc at the left, those downwards in one at the right. The discs are
/// equal-area, so that even directions are even dots.
fn hemispheres(directions: &[Vec3]) -> Image {
    let side = 256;
    let radius = 0.48 * side as f32;
    let mut image = Image::filled(2 * side, side, Rgb::BLACK);
    for y in 0..side {
        for x in 0..side {
            let from_centre = |v: u32| v as f32 + 0.5 - 0.5 * side as f32;
            let inside = from_centre(x) * from_centre(x) + from_centre(y) * from_centre(y) <= radius * radius;
            for column in [x, x + side] {
                let shade = if inside { 0.13 } else { 0.03 };
                image.pixels[(y * 2 * side + column) as usize] = Rgb::splat(shade);
            }
        }
    }
    for w in directions.iter().take(DOTS) {
        // Lambert's azimuthal projection: r² = 1 − |cos|.
        let planar = (w.x * w.x + w.y * w.y).sqrt().max(1e-6);
        let r = (1.0 - w.z.abs()).max(0.0).sqrt() * radius;
        let centre = if w.z >= 0.0 { 0.5 } else { 1.5 } * side as f32;
        let (x, y) = (centre + r * w.x / planar, 0.5 * side as f32 - r * w.y / planar);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (column, row) = ((x as u32 + dx).min(2 * side - 1), (y as u32 + dy).min(side - 1));
            image.pixels[(row * 2 * side + column) as usize] = Rgb::new(1.0, 0.85, 0.4);
        }
    }
    image
}

/// How many directions each cell has; even ones are ½.
fn density(directions: &[Vec3]) -> Image {
    let (columns, rows, scale) = (64, 32, 8);
    let counts = sphere_counts(directions, columns, rows);
    let expected = directions.len() as f32 / counts.len() as f32;
    let (width, height) = (columns * scale, rows * scale);
    let cell = |i: usize| counts[i / width / scale * columns + i % width / scale];
    let shade = |i: usize| Rgb::splat((0.5 * cell(i) as f32 / expected).min(1.0));
    Image { width: width as u32, height: height as u32, pixels: (0..width * height).map(shade).collect() }
}
