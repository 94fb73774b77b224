//! Fog inside a glass sphere, and none.

use nephroid::integrator::{MapName, Method, PhotonMapperConfig, Show};
use nephroid::laboratory::{MapPhoton, PhotonColor, PhotonPicture, photon_picture, record_photons};
use nephroid::math::Vec2;
use nephroid::session::RenderSettings;
use nephroid::shape::Geometry;
use nephroid::texture::Image;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::wrong;

/// Figure 3.9.
pub const SECTION: Section = Section {
    id: "fig-3-9",
    report: "Fig 3.9",
    title: "fog inside the glass",
    weight: Weight { full: 20.0, quick: 2.0 },
    run,
};

/// Figure 3.10.
pub const PHOTONS: Section = Section {
    id: "fig-3-10",
    report: "Fig 3.10",
    title: "what the photon maps hold",
    weight: Weight { full: 4.0, quick: 1.0 },
    run: run_photons,
};

/// The scene, with settings.
type Glass = (World, RenderSettings);

/// The sphere is empty, and full of the fog around it.
fn both(lab: &Lab) -> Result<(Glass, Glass), Stop> {
    let (right, settings) = lab.world(&lab.recipe("report-3-9"))?;
    let scene = wrong::fog_in_glass(right.scene());
    let wrong = World::new(scene).map_err(|errors| Stop::because(errors.to_string()))?;
    Ok(((right, settings.clone()), (wrong, settings)))
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let ((right_world, settings), (wrong_world, _)) = both(lab)?;
    let right = lab.render(&lab.recipe("report-3-9"))?;
    let wrong = lab.render_world(&wrong_world, settings.clone(), 1)?;
    let caustic = |world: &World| -> Result<f64, Stop> {
        let photons = record_photons(world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
        Ok(photons.photons.iter().filter(|p| p.map == MapName::Caustic).map(power).sum())
    };
    let (caustic_wrong, caustic_right) = (caustic(&wrong_world)?, caustic(&right_world)?);
    let (diameter, sigma_t) = (2.0 * sphere(&right_world)?.1, 1.0);
    let glow = |world: &World| -> Result<f64, Stop> {
        let config = settings.method.mapper().cloned().unwrap_or_default();
        let method = Method::PhotonMapper(PhotonMapperConfig { show: Show::Medium, ..config });
        let render = lab.render_world(world, RenderSettings { method, ..settings.clone() }, 1)?;
        within_sphere(&right_world, &render.image)
    };
    let in_glass = glow(&wrong_world)? / glow(&right_world)?;

    let mut body = Body::new();
    body.say(&format!(
        "The report took the whole room to be fog, the inside of the glass, too. Photons are then scattered within the sphere and \
         leave it in any direction: {} of the caustic's power is left on surfaces. Its remedy, no medium inside the glass, is \
         right; here a surface names what is on either side of it, so that any glass may hold any medium.",
        format::number(caustic_wrong / caustic_right)
    ));
    body.say(&format!(
        "The report's glass was also bright; it says (3.1.3) that the photons inside of the glass, and the march through it, add \
         in-scattered light. That was not reproduced: in the middle of the sphere's picture the light of the fog is {} times that with \
         clear glass, which shows the lit fog behind it. The sphere turns dull and grey.",
        format::number(in_glass)
    ));
    let look = Look::exposed(0.0);
    body.pair(
        Picture::of(
            &wrong,
            &look,
            "A glass sphere in fog, dull and grey inside; the cone of light and the spot below it are faint.",
            "Wrong: fog inside the glass. The scene with the sphere's inside set to the fog, made in code",
        )?,
        Picture::of(
            &right,
            &look,
            "The same sphere, clearer and with a bright rim; the cone in the fog and the spot on the floor are brighter.",
            "Right: nothing inside the glass",
        )?,
    );

    body.numbers(vec![
        Number::within(
            "Power of caustic photons on surfaces, fog inside by none inside",
            caustic_wrong / caustic_right,
            "",
            [libm::exp(-sigma_t * f64::from(diameter)), 0.85],
            "What is not scattered on a chord through the sphere: e^(−σ_t · 2R) along its axis, more on shorter chords. \
             Without the mistake it is 1.",
        ),
        Number::measured(
            "Light of the fog in the middle of the sphere's picture, fog inside by none inside",
            in_glass,
            "",
            "What the fog inside sends takes the place of what is seen through clear glass: no law says which is more.",
        ),
    ]);
    body.finding(
        "Fig 3.9",
        "Fog inside the glass weakens the caustic; no fog inside is the remedy.",
        &format!(
            "The bright glass was not reproduced: the fog's light in the sphere's picture is {} times that with clear glass.",
            format::number(in_glass)
        ),
        "A photon that is scattered inside is none of the caustic any more. The report blames photons inside and the march there; the \
         fog inside also dims what is behind it.",
    );
    Ok(body)
}

fn run_photons(lab: &Lab) -> Result<Body, Stop> {
    let ((right_world, settings), (wrong_world, _)) = both(lab)?;
    let (center, radius) = sphere(&right_world)?;
    let of = |world: &World| -> Result<Vec<MapPhoton>, Stop> {
        let photons = record_photons(world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
        Ok(photons
            .photons
            .into_iter()
            .filter(|p| matches!(p.map, MapName::VolumeCaustic | MapName::Volume))
            .collect())
    };
    let (right, wrong) = (of(&right_world)?, of(&wrong_world)?);
    let options = PhotonPicture { color: PhotonColor::Map, size: 1, through_walls: true };
    let mut body = Body::new();
    body.say(
        "The photons themselves, projected to the picture: those of the volume map are pale, those of its caustic map red. With fog \
         inside the glass the sphere is full of red photons. Without, it is empty. The cone of the caustic is below both, \
         and has more power where nothing is lost inside: a number below. Drawing the maps is how the report found its mistake; \
         nephroid photons does it for any scene.",
    );
    let picture = |world: &World, photons: &[MapPhoton], alt: &str, caption: &str| {
        Picture::new(&photon_picture(world, photons, &options).0, &Look::drawn(), alt, caption)
    };
    body.pair(
        picture(
            &wrong_world,
            &wrong,
            "Pale dots all over a room; red ones crowd in a sphere and in a cone that narrows below it.",
            "Wrong: fog inside the glass",
        )?,
        picture(
            &right_world,
            &right,
            "Pale and red dots all over a room, few within the outline of a sphere; red ones crowd in a cone below it alone.",
            "Right: nothing inside the glass",
        )?,
    );
    // A column as wide as the sphere, from the sphere's lowest point to the floor.
    let below = |p: &&MapPhoton| {
        let d = p.photon.position - center;
        p.map == MapName::VolumeCaustic && d.y < -radius && Vec2::new(d.x, d.z).length() < radius
    };
    let inside = |p: &&MapPhoton| (p.photon.position - center).length() < 0.999 * radius;
    let sum = |photons: &[MapPhoton]| photons.iter().filter(below).map(power).sum::<f64>();
    let count = |photons: &[MapPhoton]| photons.iter().filter(inside).count() as f64;
    body.numbers(vec![
        Number::within(
            "Photons inside the glass, right",
            count(&right),
            "",
            [0.0, 0.0],
            "There is nothing to scatter them.",
        ),
        Number::within(
            "Photons inside the glass, wrong",
            count(&wrong),
            "",
            [100.0, f64::MAX],
            "The sphere is below the lamp and full of fog: hundreds of 15 000 photons at the least.",
        ),
        Number::within(
            "Power of caustic photons below the sphere, wrong by right",
            sum(&wrong) / sum(&right),
            "",
            [libm::exp(-2.0 * f64::from(radius)), 0.85],
            "What is not scattered on its way through: e^(−σ_t · 2R) along the axis, with σ_t = 1/m. Without the mistake it is 1.",
        ),
    ]);
    body.finding(
        "Fig 3.10",
        "The photons show the mistake: they crowd in the sphere, where there should be none.",
        "The report shows its caustic map beside its volume map; both pictures here are of one map.",
        "So that the two can be compared.",
    );
    Ok(body)
}

fn power(photon: &MapPhoton) -> f64 {
    f64::from(photon.photon.power.mean())
}

/// The glass sphere's centre and radius.
fn sphere(world: &World) -> Result<(nephroid::math::Vec3, f32), Stop> {
    let shape = world.scene().shapes.iter().find(|shape| shape.name == wrong::GLASS);
    match shape.map(|shape| &shape.geometry) {
        Some(Geometry::Sphere { center, radius }) => Ok((*center, *radius)),
        _ => Err(Stop::because("the scene has no glass sphere")),
    }
}

/// Mean over the middle of the sphere's picture: half of its radius.
fn within_sphere(world: &World, image: &Image) -> Result<f64, Stop> {
    let (center, radius) = sphere(world)?;
    let camera = crate::tracer::Pinhole::of(world)?;
    let (middle, edge) = (camera.project(center), camera.project(center + radius * nephroid::math::Vec3::Y));
    let reach = 0.5 * (edge - middle).length();
    let (mut sum, mut count) = (0.0, 0u32);
    for y in 0..image.height {
        for x in 0..image.width {
            if (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - middle).length() < reach {
                sum += f64::from(image.pixel(x, y).mean());
                count += 1;
            }
        }
    }
    Ok(sum / f64::from(count.max(1)))
}
