//! A diffuse sphere inside a glass sphere.

use nephroid::laboratory::record_photons;
use nephroid::math::Vec3;
use nephroid::texture::Image;

use crate::body::{Body, Number};
use crate::compare::{mean_where, rays};
use crate::format;
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::statistics::integral;

/// Figure 2.5.
pub const SECTION: Section = Section {
    id: "fig-2-5",
    report: "Fig 2.5",
    title: "a sphere in glass (Question 2.5)",
    weight: Weight { full: 60.0, quick: 2.0 },
    run,
};

/// Of `report-2-5a` and `report-2-5b`: the spheres' centre, their radii in m, the glass's index, the lamp and its W/sr.
const CENTRE: Vec3 = Vec3::new(0.0, 1.0, -0.1);
const SHELL: f64 = 0.8;
const INNER: f64 = 0.45;
const INDEX: f64 = 1.5;
const LAMP: Vec3 = Vec3::new(0.0, 2.3, 0.2);
const INTENSITY: f64 = 5.0;

fn run(lab: &Lab) -> Result<Body, Stop> {
    let (by_rays, by_map) =
        (lab.render(&lab.recipe("report-2-5a"))?, lab.render(&lab.recipe("report-2-5b"))?);
    let passes = lab.pick(10, 32);
    let progressive = lab.recipe("report-2-5b").flag("--integrator", "ppm").flag("--passes", passes);
    let reference = lab.render(&progressive)?;
    let (arrived, photons) = arrived(lab)?;
    let expected = flux_through_glass();
    // Rays that pass the centre so closely are bent onto the inner sphere, with some room for pixels.
    let bent = (INNER * INDEX - 0.08) as f32;
    let inner: Vec<bool> =
        rays(lab.side()).map(|ray| (CENTRE - ray.origin).cross(ray.direction).length() < bent).collect();
    let on = |image: &Image| mean_where(image, &inner);

    let mut body = Body::new();
    body.say(
        "Glass stands between the inner sphere and the lamp wherever one looks, so a ray to the lamp is always blocked, and the \
         sphere is black but for what the glass reflects. Photons pass the glass, and light it. The report says just that.",
    );
    body.say(
        "How much light that is can be told: what a ray's distance from the centre is outside, is n times that inside, so \
         all rays that pass within n times the inner radius arrive. The photons found on the sphere carry that power.",
    );
    let look = Look::exposed(0.5);
    let alt = "A glass ball with a smaller ball in it, in a box with a red and a green wall";
    body.pair(
        Picture::of(&by_rays, &look, &format!("{alt}: the inner ball is black."), "Direct light by rays")?,
        Picture::of(
            &by_map,
            &look,
            &format!("{alt}: the inner ball is lit from above."),
            "Direct light from photons",
        )?,
    );
    let caption = format!("Reference: the same light by progressive photon mapping, {passes} iterations");
    body.picture(Picture::of(
        &reference,
        &look,
        &format!("{alt}: the inner ball is lit, its caustic sharp."),
        &caption,
    )?);
    let names = ["By rays", "From photons", "Reference"];
    let row = |(name, render): (&str, &Render)| vec![name.to_owned(), format::number(on(&render.image))];
    let rows = names.into_iter().zip([&by_rays, &by_map, &reference]).map(row).collect();
    body.table("The inner sphere in the picture", &["Direct light", "Mean luminance, W/(m²·sr)"], rows);

    let spread = 6.0 / (photons as f64).sqrt();
    body.numbers(vec![
        Number::within(
            "Power of the photons that pass the glass onto the inner sphere",
            arrived,
            "W",
            [expected * (1.0 - spread), expected * (1.0 + spread)],
            "2π I ∫ (1 − F) sin α dα up to sin α = n r/D, Fresnel's F at the shell, and six standard deviations of the number \
             of photons.",
        ),
        Number::within(
            "Inner sphere from photons by the reference",
            on(&by_map.image) / on(&reference.image),
            "",
            lab.pick([0.9, 1.06], [0.82, 1.12]),
            "The same light. Estimates lose some at the shadow's edge on the sphere and near its outline.",
        ),
        Number::within(
            "Inner sphere by rays by the reference",
            on(&by_rays.image) / on(&reference.image),
            "",
            [0.01, 0.5],
            "Black is the sphere itself; the glass before it reflects the lit walls, 4 % of them and more at a slant.",
        ),
    ]);
    body.finding(
        "Fig 2.5, Question 2.5",
        "By rays the inner sphere is black, by photons it is lit.",
        "Nothing.",
        &format!(
            "Photons are followed through glass, rays to a point light are blocked by it: {} W arrive, {} W by the closed form.",
            format::number(arrived),
            format::number(expected)
        ),
    );
    Ok(body)
}

/// Power on the inner sphere by way of the glass alone, in W, and how many photons carry it.
fn arrived(lab: &Lab) -> Result<(f64, usize), Stop> {
    let (world, settings) = lab.world(&lab.recipe("report-2-5b"))?;
    let stored = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    let on_inner = stored.photons.iter().filter(|p| {
        let distance = f64::from((p.photon.position - CENTRE).length());
        (distance - INNER).abs() < 1e-3 && p.bounces.to_string() == "LSD"
    });
    let powers: Vec<f64> = on_inner.map(|p| f64::from(p.photon.power.g)).collect();
    Ok((powers.iter().sum(), powers.len()))
}

/// The same in closed form. The lamp sees the shell's centre at a distance D; a ray at an angle α from it passes the
/// centre at D sin α, and at D sin α/n once it is in the glass.
fn flux_through_glass() -> f64 {
    let distance = f64::from((LAMP - CENTRE).length());
    let most = libm::asin(INNER * INDEX / distance);
    let density = |t: f64| {
        let sine = libm::sin(t * most);
        (1.0 - fresnel(distance * sine / SHELL)) * sine
    };
    2.0 * std::f64::consts::PI * INTENSITY * most * integral(density)
}

/// Reflectance of unpolarised light at the sine of its angle, from outside of the glass.
fn fresnel(sine: f64) -> f64 {
    let (outside, inside) = (libm::sqrt(1.0 - sine * sine), libm::sqrt(1.0 - sine * sine / (INDEX * INDEX)));
    let across = (outside - INDEX * inside) / (outside + INDEX * inside);
    let along = (INDEX * outside - inside) / (INDEX * outside + inside);
    0.5 * (across * across + along * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_reflects_a_twenty_fifth_at_right_angles() {
        assert!((fresnel(0.0) - 0.04).abs() < 1e-12);
        assert!((fresnel(1.0) - 1.0).abs() < 1e-12);
    }
}
