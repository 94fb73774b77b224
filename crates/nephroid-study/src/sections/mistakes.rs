//! The mistakes of the report's section 2.4 in direct light and power, as pictures beside the right ones.

use nephroid::color::Rgb;
use nephroid::math::{Vec2, Vec3, warp};
use nephroid::photon_map::{Photon, PhotonMap, Photons};
use nephroid::texture::Image;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::lab::{Lab, Render};
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::tracer::{self, Pinhole};
use crate::wrong;

/// Figure 2.10.
pub const POWER: Section = Section {
    id: "fig-2-10",
    report: "Fig 2.10",
    title: "photons without their 4π",
    weight: Weight { full: 30.0, quick: 2.0 },
    run: power,
};

/// Figure 2.11.
pub const COSINE: Section = Section {
    id: "fig-2-11",
    report: "Fig 2.11",
    title: "direct light without the cosine",
    weight: Weight { full: 15.0, quick: 1.0 },
    run: cosine,
};

/// Figure 2.12.
pub const SAMPLING: Section = Section {
    id: "fig-2-12",
    report: "Fig 2.12",
    title: "photons that leave on one side",
    weight: Weight { full: 15.0, quick: 1.5 },
    run: sampling,
};

/// A picture and a part of another.
fn sum(a: &Image, b: &Image, part: f32) -> Image {
    let pixels = a.pixels.iter().zip(&b.pixels).map(|(a, b)| *a + *b * part).collect();
    Image { width: a.width, height: a.height, pixels }
}

fn mean(image: &Image) -> f64 {
    f64::from(image.mean().mean())
}

fn power(lab: &Lab) -> Result<Body, Stop> {
    let recipe = lab.recipe("report-2-10");
    let right = lab.render(&recipe)?;
    let part = |show: &str| lab.render(&recipe.clone().flag("--show", show));
    let (direct, indirect) = (part("direct")?, part("indirect")?);
    let wrong = sum(&direct.image, &indirect.image, wrong::WITHOUT_SPHERE);

    let mut body = Body::new();
    body.say(
        "A point light of 5 W/sr gives off 4π · 5 W. If photons are not given the 4π, direct light, which comes by rays, is right \
         and all that photons bring is a twelfth of what it should be: no colour bleeds, and what the lamp does not see is \
         nearly black. The report calls it too much direct light; with an exposure that follows the picture it looks so.",
    );
    let look = Look::exposed(-0.5);
    let alt = "A box with a red and a green wall and two white spheres";
    body.pair(
        Picture::new(
            &wrong,
            &look,
            &format!("{alt}; shadows are nearly black."),
            "Wrong: the direct part of the right picture and a 4π-th of its indirect part",
        )?,
        Picture::of(
            &right,
            &look,
            &format!("{alt}; shadows are filled with red and green light."),
            "Right: 100 000 photons, k = 500",
        )?,
    );
    let (d, i) = (direct.mean(), indirect.mean());
    let rows = [("Right", i), ("Wrong", i * f64::from(wrong::WITHOUT_SPHERE))];
    let row = |(name, i): (&str, f64)| {
        [vec![name.to_owned()], [d, i, d / i].map(crate::format::number).to_vec()].concat()
    };
    let head = ["Picture", "Direct, W/(m²·sr)", "Indirect, W/(m²·sr)", "Direct by indirect"];
    body.table("Mean radiance", &head, rows.map(row).to_vec());
    let emitted = emitted(&right);
    let expected = 4.0 * std::f64::consts::PI * 5.0;
    body.numbers(vec![
        Number::within(
            "Power of all photons that were sent out",
            emitted,
            "W",
            [0.9999 * expected, 1.0001 * expected],
            "4π sr · 5 W/sr; without the 4π it is 5 W.",
        ),
        Number::within(
            "Direct and indirect part, by the whole picture",
            (d + i) / right.mean(),
            "",
            lab.pick([0.99, 1.01], [0.97, 1.03]),
            "The parts are rendered for themselves: jagged edges may differ, no more.",
        ),
        Number::within(
            "Direct by indirect light, wrong",
            d / (i * f64::from(wrong::WITHOUT_SPHERE)),
            "",
            [8.0, f64::MAX],
            "In a box of mean reflectance ρ, open or not, no less than (1 − ρ)/ρ: with ρ < 0.6 more than 0.66, and 4π times \
             that.",
        ),
    ]);
    body.finding(
        "Fig 2.10",
        "Without 4π global illumination cannot be seen; with it walls colour one another.",
        "Probably direct light was not too strong, but the photons too weak. (The text calls the figure 3.6.)",
        "An intensity in W/sr is a power only when multiplied by the 4π sr of the sphere.",
    );
    Ok(body)
}

/// W, of all lamps.
fn emitted(render: &Render) -> f64 {
    let lights = &render.statistics.ledger.lights;
    lights.iter().map(|balance| balance.emitted.iter().sum::<f64>() / 3.0).sum()
}

fn cosine(lab: &Lab) -> Result<Body, Stop> {
    let recipe = lab.recipe("report-2-11");
    let right = lab.render(&recipe)?;
    let direct = lab.render(&recipe.clone().flag("--show", "direct"))?;
    let indirect = lab.render(&recipe.clone().flag("--show", "indirect"))?;
    let (world, _) = lab.world(&recipe)?;
    let lamp = tracer::lamp(&world)?;
    let own = |of_cosine: fn(f32) -> f32| {
        tracer::expose(lab, &world, 8, |ray, _, _| match world.intersect(ray) {
            Some(hit) => tracer::direct(&world, lamp, &hit, &world, -ray.direction, of_cosine),
            None => Rgb::BLACK,
        })
    };
    let (with, without) = (own(|cosine| cosine)?, own(wrong::no_cosine)?);

    let mut body = Body::new();
    body.say(
        "Direct light without the cosine between the normal and the way to the lamp. The spheres are flat discs up to a hard edge, \
         and the ceiling, which the light only grazes, is far too bright. With it the spheres are round and the ceiling \
         fades away from the lamp: as in the report.",
    );
    let look = Look::exposed(-0.5);
    let alt = "A box with two white spheres, lit from above at the left";
    body.pair(
        Picture::new(
            &sum(&without, &indirect.image, 1.0),
            &look,
            &format!("{alt}: flat shading with hard edges, and a bright ceiling."),
            "Wrong: direct light by a tracer of the study's own, without the cosine, and the indirect part of the right picture",
        )?,
        Picture::of(
            &right,
            &look,
            &format!("{alt}: soft shading, and a ceiling that fades from the lamp."),
            "Right: 10 000 photons, k = 100",
        )?,
    );
    // A place on the ceiling, as the lamp sees it.
    let place = Vec3::new(0.9, 2.8, 0.4);
    let to_lamp = lamp.0 - place;
    let cosine = f64::from(to_lamp.normalize().y.abs());
    let at = Pinhole::of(&world)?.project(place);
    let around = |image: &Image| window(image, at, lab.pick(4, 1));
    body.numbers(vec![
        Number::within(
            "Own tracer's direct light with the cosine, by Nephroid's",
            mean(&with) / direct.mean(),
            "",
            lab.pick([0.995, 1.005], [0.97, 1.03]),
            "Two programs of one formula; they sample pixels apart, and differ at edges.",
        ),
        Number::within(
            "Without by with the cosine, on the ceiling",
            around(&without) / around(&with),
            "",
            [0.9 / cosine, 1.1 / cosine],
            "One over the cosine at that place, which changes by less than a tenth over the pixels.",
        ),
        Number::within(
            "Direct light without by with the cosine",
            mean(&without) / mean(&with),
            "",
            [1.1, f64::MAX],
            "A mean of cosines is less than 1, on walls that are lit at an angle well below.",
        ),
    ]);
    body.finding(
        "Fig 2.11",
        "Without the cosine edges are hard and the upper walls too bright.",
        "Nothing.",
        "The cosine is part of the rendering equation; photons have it by themselves, as fewer of them meet a slanted surface.",
    );
    Ok(body)
}

/// Mean of the pixels so near a place.
fn window(image: &Image, at: Vec2, reach: i32) -> f64 {
    let (x, y) = (at.x as i32, at.y as i32);
    let (mut sum, mut count) = (0.0, 0u32);
    for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
        sum += f64::from(image.pixel((x + dx).max(0) as u32, (y + dy).max(0) as u32).mean());
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// Photons of the direct light alone.
const DIRECT_PHOTONS: u64 = 100_000;

fn sampling(lab: &Lab) -> Result<Body, Stop> {
    let recipe = lab.recipe("report-2-12");
    let library = lab.render(&recipe)?;
    let (world, _) = lab.world(&recipe)?;
    let of = |sample: fn(Vec2) -> Vec3, purpose: u64| -> Result<Image, Stop> {
        let map = PhotonMap::build(first_hits(lab, &world, sample, purpose)?);
        tracer::expose(lab, &world, 4, |ray, _, neighbors| match world.intersect(ray) {
            Some(hit) => tracer::reflected(&map, 200, (&world, &hit), -ray.direction, neighbors),
            None => Rgb::BLACK,
        })
    };
    let (right, wrong) = (of(warp::square_to_sphere, 1)?, of(wrong::latitude_from_the_pole, 2)?);

    let mut body = Body::new();
    body.say(
        "Direct light from photons alone. With wrong directions a part of the room gets none: here the back wall is black, and what \
         is in front of the lamp has too much. The report found its mistake in this way, by looking at photons' direct light \
         only, and by comparing it with rejection sampling.",
    );
    body.say(
        "The report does not say what its mistake was, but that it was made when the ray was created from the angles. The one shown \
         is a guess: the latitude, counted from the equator, is taken for an angle from the pole, which is towards the \
         camera here. Its χ² is in the section of Fig 2.1.",
    );
    let look = Look::exposed(0.5);
    body.pair(
        Picture::new(
            &wrong,
            &look,
            "A box of which the back wall and the rear half of floor and walls are black.",
            "Wrong: photons sent by the study's own tracer with the wrong directions, k = 200",
        )?,
        Picture::of(
            &library,
            &look,
            "The same box, lit on all sides, with blurred shadows behind two spheres.",
            "Right: 100 000 photons, k = 200",
        )?,
    );
    let camera = Pinhole::of(&world)?;
    let at = camera.project(Vec3::new(0.0, 1.9, -1.6));
    let wall = |image: &Image| window(image, at, lab.pick(12, 2));
    body.numbers(vec![
        Number::within(
            "Own tracer's picture with right directions, by Nephroid's",
            mean(&right) / library.mean(),
            "",
            lab.pick([0.97, 1.03], [0.95, 1.05]),
            "The same estimate from other photons: tens of thousands of them land, so a part in a hundred or less by chance, \
             and edges.",
        ),
        Number::within(
            "Light on the back wall, wrong by right",
            wall(&wrong) / wall(&right),
            "",
            [0.0, 0.01],
            "No wrong photon flies backwards. With right directions it is 1.",
        ),
    ]);
    body.finding(
        "Fig 2.12",
        "Wrong directions leave the background dark, and direct light from photons shows it.",
        "Which mistake it was, is not told in the report; ours is a guess.",
        "Photons must leave a point light evenly, and a test of the directions finds at once what pictures hide.",
    );
    Ok(body)
}

/// Photons where they first meet a surface, each with its part of 4π I.
fn first_hits(lab: &Lab, world: &World, sample: fn(Vec2) -> Vec3, purpose: u64) -> Result<Photons, Stop> {
    let (position, intensity) = tracer::lamp(world)?;
    let mut numbers = lab.sampler(0x212 + purpose);
    let (mut photons, mut emitted) = (Vec::new(), 0);
    // As many as the renderer is asked for. The last path is whole, and so many do not feel that it is chosen.
    while (photons.len() as u64) < DIRECT_PHOTONS && emitted < 100 * DIRECT_PHOTONS {
        emitted += 1;
        let direction = sample(numbers.next_2d()).normalize();
        let Some(hit) = world.intersect(&nephroid::math::Ray::new(position, direction)) else { continue };
        photons.push(Photon {
            position: hit.point.position,
            power: intensity * (4.0 * std::f32::consts::PI),
            wi: -direction,
            normal: tracer::facing(hit.point.ng, -direction),
            depth: 1,
            light: 0,
        });
    }
    Ok(Photons::new(emitted, photons))
}
