//! Spheres that shine more and more.

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PathConfig, PhotonMapperConfig, Show};
use nephroid::laboratory::record_photons;
use nephroid::material::Material;
use nephroid::math::Vec3;
use nephroid::photon_map::{Bandwidth, Kernel, NearestList, PhotonMap, Photons, Query, gather};
use nephroid::session::RenderSettings;
use nephroid::shape::{Geometry, Shape, SurfacePoint};
use nephroid::texture::Image;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::chart::Chart;
use crate::compare::{WALLS, mean_where, rays, rel_mse_where, seen};
use crate::format;
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};

/// Materials.
pub const SECTION: Section = Section {
    id: "question-2-6",
    report: "Question 2.6",
    title: "Phong spheres of rising exponent",
    weight: Weight { full: 60.0, quick: 5.0 },
    run,
};

const EXPONENTS: [f32; 5] = [1.0, 10.0, 100.0, 1_000.0, 10_000.0];

/// Albedos of the sphere's two parts.
const DIFFUSE: f32 = 0.1;
const SPECULAR: f32 = 0.85;

const PHOTONS: u64 = 30_000;
const NEIGHBOURS: u32 = 100;

/// The sphere comes after the walls.
const SPHERE: u32 = WALLS;

/// One of the pictures of an exponent.
type Pick = fn(&Ways) -> &Image;

/// One exponent, by three ways.
struct Ways {
    from_map: Image,
    sampled: Image,
    /// The mean of two.
    reference: Image,
    /// One of them.
    half: Image,
}

impl Ways {
    /// The relative squared error of the reference: the mean of two is as far from the truth as from either, in the mean.
    fn noise(&self, sphere: &[bool]) -> f64 {
        rel_mse_where(&self.half, &self.reference, sphere)
    }

    fn errors(&self, sphere: &[bool]) -> [f64; 2] {
        [&self.from_map, &self.sampled].map(|image| rel_mse_where(image, &self.reference, sphere))
    }
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let side = lab.pick(144, 48);
    let samples = lab.pick(192, 256);
    let all: Vec<Ways> =
        EXPONENTS.iter().map(|&exponent| ways(lab, exponent, side, samples)).collect::<Result<_, _>>()?;
    let sphere: Vec<bool> = seen(&scene(lab, 1.0, side)?.0, side)
        .iter()
        .map(|hit| hit.is_some_and(|(shape, _)| shape == SPHERE))
        .collect();
    let errors: Vec<[f64; 2]> = all.iter().map(|ways| ways.errors(&sphere)).collect();
    let light =
        |image: &Image, ways: &Ways| mean_where(image, &sphere) / mean_where(&ways.reference, &sphere);

    let mut body = Body::new();
    body.say(
        "The report answers in words: photon mapping suits diffuse surfaces, and shiny ones want many more photons. Here are its \
         renders. In the upper row the sphere's indirect light is Equation 2.2 with all of Phong's material in it, as the \
         report's program would have it; in the middle the lobe is sampled by a ray a camera sample that reads the map where \
         it lands; below is the reference.",
    );
    body.say(
        &format!(
            "At exponent 1 the map serves: the sampled lobe's error is {} times the map's. As the lobe narrows fewer of the hundred \
             photons lie in it, each counts for more, and the sphere breaks up into spots: the map's error grows with the \
             exponent. At n = 1000 the sampled lobe, with the same photons, errs {} times less. So the report is right about photon \
             maps; how many more photons would do as well as a sampled lobe was not measured.",
            format::number(errors[0][1] / errors[0][0]),
            format::number(errors[3][0] / errors[3][1]),
        ),
    );
    let astray = all[..4].iter().flat_map(|ways| [light(&ways.from_map, ways), light(&ways.sampled, ways)]);
    let astray = 100.0 * astray.map(|light| (light - 1.0).abs()).fold(0.0, f64::max);
    body.say(
        &format!(
            "Energy is not the trouble: with (n + 2)/2π before the cosine's power, both have the light of the reference within {} % for \
             n from 1 to 1000. Beyond that the reference's own mean is uncertain, and nothing is said. The scene is \
             that of Fig 2.6 with one sphere, made in code, so these pictures have no command.",
            format::number(astray),
        ),
    );
    let look = Look::exposed(0.0);
    let rows: [(&str, &str, Pick); 3] = [
        ("All from the photon map", "speckled where it should shine", |ways| &ways.from_map),
        ("Photon map, sampled lobe", "with the room's reflection", |ways| &ways.sampled),
        ("Reference: path tracing", "with the room's reflection", |ways| &ways.reference),
    ];
    for (name, looks, image) in rows {
        let picture = |(ways, exponent): (&Ways, &f32)| {
            let n = format::number(f64::from(*exponent));
            let looks = if *exponent < 10.0 { "dull and even" } else { looks };
            let alt = format!("A sphere of exponent {n} in a box with a red and a green wall, {looks}.");
            Picture::new(image(ways), &look, &alt, &format!("{name}, n = {n}"))
        };
        body.strip(all.iter().zip(&EXPONENTS).map(picture).collect::<Result<_, _>>()?);
    }
    let points = |i: usize| EXPONENTS.iter().zip(&errors).map(|(n, e)| (f64::from(*n), e[i])).collect();
    let chart = Chart::new("Phong exponent n", "relMSE on the sphere").logarithmic();
    let chart = chart.points("all from the photon map", points(0));
    body.plot(chart.points("photon map, sampled lobe", points(1)).draw(
        "The error of the photon map rises with the exponent by powers of ten; that of the sampled lobe hardly changes.",
        "Against path tracing, on the pixels of the sphere. The noise of the reference is in both, and is a good part of the \
         sampled lobe's: see the table.",
    )?);
    let row = |i: usize| {
        let ways = &all[i];
        let lights = [&ways.from_map, &ways.sampled].map(|image| light(image, ways));
        let numbers = [errors[i][0], errors[i][1], ways.noise(&sphere), lights[0], lights[1]];
        let numbers = numbers.map(format::number).to_vec();
        [vec![format::number(f64::from(EXPONENTS[i]))], numbers].concat()
    };
    let head = [
        "n",
        "relMSE, map",
        "relMSE, sampled",
        "The reference's own",
        "Light by the reference, map",
        "Light, sampled",
    ];
    body.table("The sphere against the reference", &head, (0..EXPONENTS.len()).map(row).collect());
    let own = all[3].noise(&sphere) / errors[3][1];
    body.say(&format!(
        "The reference is noisy, too: at n = 1000 its own squared error is {} of what the sampled lobe is found to err by. So the sampled \
         lobe's level curve, and the factor between the two ways, are in part the reference's noise; without it the factor would \
         be larger.",
        format::number(own)
    ));
    body.numbers(vec![
        Number::within(
            "Squared error of the reference on the sphere by that of the sampled lobe, n = 1000",
            own,
            "",
            [0.0, 1.0],
            "The noise of the reference is in the sampled lobe's error, and can be all of it and no more.",
        ),
        Number::within(
            "Squared error of the reference on the sphere by that of the map, n = 1000",
            all[3].noise(&sphere) / errors[3][0],
            "",
            [0.0, 0.2],
            "From two references of half the samples. It is to be small beside the errors that are measured by it.",
        ),
        Number::within(
            "Error from the map, n = 1000 by n = 1",
            errors[3][0] / errors[0][0],
            "",
            [10.0, f64::MAX],
            "Of a hundred photons from all sides the lobe holds one or none: a relative variance of 1 and more, beside a \
             hundredth.",
        ),
        Number::within(
            "Error at n = 1000, from the map by the sampled lobe",
            errors[3][0] / errors[3][1],
            "",
            [3.0, f64::MAX],
            "The sampled lobe reads the walls' estimates, whose relative variance is about a hundredth.",
        ),
        Number::within(
            "Light on the sphere at n = 10, from the map by the reference",
            light(&all[1].from_map, &all[1]),
            "",
            [0.95, 1.05],
            "The lobe carries (n + 2)/2π. With (n + 1)/2π, which Phong's is often given, it would be 8 % less; without the \
             lobe's norm another number by far.",
        ),
        Number::within(
            "Light on the sphere at n = 10, sampled lobe by the reference",
            light(&all[1].sampled, &all[1]),
            "",
            [0.95, 1.05],
            "Both sample one lobe; discs that reach over edges darken what is reflected by some per cent. At higher exponents light \
             that the sphere throws onto walls is rare in the reference, whose mean is less certain.",
        ),
    ]);
    body.finding(
        "Question 2.6",
        "Photon maps suit diffuse surfaces; the shinier, the worse.",
        &format!(
            "With the same photons a sampled lobe errs {} times less at n = 1000; how many more would do as well was not measured.",
            format::number(errors[3][0] / errors[3][1])
        ),
        "A narrow lobe is sampled by rays, and the photons are read where these land. The report rendered none.",
    );
    Ok(body)
}

/// The box of figure 2.6 with one shiny sphere, and the settings of its photon map.
fn scene(lab: &Lab, exponent: f32, side: u32) -> Result<(World, RenderSettings, PhotonMapperConfig), Stop> {
    let recipe = lab.recipe("report-2-6").side(side).set("photons", PHOTONS).set("neighbours", NEIGHBOURS);
    let (world, settings) = lab.world(&recipe)?;
    let config = settings.method.mapper().cloned().ok_or_else(|| Stop::because("it has no photon map"))?;
    let mut scene = world.scene().clone();
    scene.shapes.truncate(WALLS as usize);
    let [diffuse_reflectance, specular_reflectance] =
        [DIFFUSE, SPECULAR].map(|albedo| scene.textures.constant(Rgb::splat(albedo)));
    let material =
        scene.materials.push(Material::Phong { diffuse_reflectance, specular_reflectance, exponent });
    let geometry = Geometry::Sphere { center: Vec3::new(0.0, 0.9, -0.1), radius: 0.9 };
    scene.shapes.push(Shape::new("sphere", geometry, material));
    let world = World::new(scene).map_err(|errors| Stop::because(errors.to_string()))?;
    Ok((world, settings, config))
}

fn ways(lab: &Lab, exponent: f32, side: u32, samples: u32) -> Result<Ways, Stop> {
    let (world, settings, config) = scene(lab, exponent, side)?;
    let by = |method: Method, samples_per_pixel: u32, seed: u64| {
        lab.render_world(&world, RenderSettings { method, samples_per_pixel, seed }, 1)
    };
    let seed = lab.seed();
    let with = |show| Method::PhotonMapper(PhotonMapperConfig { show, ..config.clone() });
    let half = |seed| -> Result<Image, Stop> {
        Ok(by(Method::Path(PathConfig::default()), samples / 2, seed)?.image)
    };
    let (half, other) = (half(seed)?, half(!seed)?);
    let mut reference = half.clone();
    for (mean, other) in reference.pixels.iter_mut().zip(&other.pixels) {
        *mean = (*mean + *other) * 0.5;
    }
    let sampled = by(with(Show::All), 32, seed)?.image;
    let direct = by(with(Show::Direct), 32, seed)?.image;

    let stored = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    // Their power is divided already.
    let photons = stored.photons.iter().map(|p| p.photon).collect();
    let map: PhotonMap = PhotonMap::build(Photons::new(1, photons));
    let mut scratch = NearestList::new();
    let mut from_map = sampled.clone();
    for ((hit, ray), (pixel, direct)) in
        seen(&world, side).iter().zip(rays(side)).zip(from_map.pixels.iter_mut().zip(&direct.pixels))
    {
        if let Some((SPHERE, point)) = hit {
            *pixel = *direct + of_photons(&map, point, -ray.direction, exponent, &mut scratch);
        }
    }
    Ok(Ways { from_map, sampled, reference, half })
}

/// Equation 2.2 with Phong's material: Σ f Φ over the disc, in W/(m²·sr).
fn of_photons(
    map: &PhotonMap,
    point: &SurfacePoint,
    wo: Vec3,
    exponent: f32,
    scratch: &mut NearestList,
) -> Rgb {
    let query = Query { position: point.position, normal: point.ng, max_photon_depth: None };
    let bandwidth = Bandwidth::Nearest { k: NEIGHBOURS, max_radius: 1.0 };
    let mirrored = 2.0 * point.ng.dot(wo) * point.ng - wo;
    let mut sum = Rgb::BLACK;
    gather(map, &query, Kernel::Box, bandwidth, scratch, |photon, weight| {
        sum += photon.power * (phong(mirrored.dot(photon.wi), exponent) * weight);
    });
    sum
}

/// Phong's material, in 1/sr, at the cosine between light and the mirrored view.
fn phong(cosine: f32, exponent: f32) -> f32 {
    let (n, cosine) = (f64::from(exponent), f64::from(cosine.clamp(0.0, 1.0)));
    let lobe = (n + 2.0) * 0.5 * libm::pow(cosine, n);
    ((f64::from(DIFFUSE) + f64::from(SPECULAR) * lobe) / std::f64::consts::PI) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::integral;

    #[test]
    fn the_lobe_reflects_its_albedo() {
        // At a right angle: ∫ f cos dω over the half-space, by the cosine.
        for exponent in [1.0, 10.0, 100.0] {
            let lobe = |c: f64| 2.0 * std::f64::consts::PI * c * f64::from(phong(c as f32, exponent));
            let albedo = f64::from(DIFFUSE) + f64::from(SPECULAR);
            assert!((integral(lobe) - albedo).abs() < 1e-4, "{exponent}: {}", integral(lobe));
        }
    }
}
