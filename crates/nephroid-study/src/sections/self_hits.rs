//! Rays that meet the surface they leave.

use std::sync::atomic::{AtomicU64, Ordering};

use nephroid::color::Rgb;
use nephroid::integrator::MapName;
use nephroid::laboratory::record_photons;
use nephroid::material::Transport;
use nephroid::math::{Ray, Vec3, offset_origin};
use nephroid::photon_map::{NearestList, PhotonMap, Photons};
use nephroid::sampling::Sampler;
use nephroid::shape::Geometry;
use nephroid::texture::Image;
use nephroid::world::World;

use crate::body::{Body, Number};
use crate::lab::Lab;
use crate::picture::{Look, Picture};
use crate::section::{Section, Stop, Weight};
use crate::tracer;
use crate::wrong;

/// Figure 2.13.
pub const SECTION: Section = Section {
    id: "fig-2-13",
    report: "Fig 2.13",
    title: "rays that hit what they leave",
    weight: Weight { full: 10.0, quick: 1.0 },
    run,
};

/// Bounces after which the report ends a path.
const MOST_BOUNCES: u32 = 20;

/// The mirror is moved away by this part of its radius where the ray is shifted.
const SHIFT: f32 = 1e-4;

/// The scene, taken apart for a tracer whose rays may hit what they leave.
struct Parts {
    /// All of it.
    world: World,
    /// All but the mirror sphere.
    rest: World,
    center: Vec3,
    radius: f32,
    lamp: (Vec3, Rgb),
    maps: [PhotonMap; 2],
}

/// Samples that met the mirror, and those of them that met it twice in a row, as no ray can that a sphere reflects.
#[derive(Default)]
struct Counts {
    mirror: AtomicU64,
    lost: AtomicU64,
}

impl Counts {
    fn part(&self) -> f64 {
        self.lost.load(Ordering::Relaxed) as f64 / self.mirror.load(Ordering::Relaxed).max(1) as f64
    }
}

fn run(lab: &Lab) -> Result<Body, Stop> {
    let library = lab.render(&lab.recipe("report-2-13"))?;
    let parts = parts(lab)?;
    let (of_wrong, of_right) = (Counts::default(), Counts::default());
    let picture = |samples, shift, counts: &Counts| -> Result<Image, Stop> {
        tracer::expose(lab, &parts.world, samples, |ray, sampler, neighbors| {
            parts.radiance(ray, shift, counts, sampler, neighbors)
        })
    };
    let wrong = picture(1, 0.0, &Counts::default())?;
    // A picture of one sample has few of them to count.
    picture(lab.pick(2, 64), 0.0, &of_wrong)?;
    let right = picture(lab.pick(2, 8), SHIFT, &of_right)?;

    let mut body = Body::new();
    body.say(
        "Where a ray meets a mirror is known to a rounding error only. A reflected ray that starts there may begin just below the \
         surface and meet it at once; it is then turned inwards, and stays inside until the bounces are used up, or leaves where it does not belong. The sphere \
         is strewn with black dots. How many depends on how the intersection is computed; here it is the textbook's, in \
         single precision.",
    );
    body.say(
        "The report shifts rays by a small length. Nephroid moves them off the surface by the error bound of the point itself, so \
         that no length needs to be chosen and scenes of any size do alike.",
    );
    let look = Look::exposed(0.0);
    body.pair(
        Picture::new(
            &wrong,
            &look,
            "A box with a mirror sphere that is strewn with black dots, and a glass sphere.",
            "Wrong: a tracer of the study's own that does not shift rays; one sample a pixel",
        )?,
        Picture::of(
            &library,
            &look,
            "The same box; the mirror sphere is clean and shows the room.",
            "Right: Nephroid",
        )?,
    );
    let mean = |image: &Image| f64::from(image.mean().mean());
    body.numbers(vec![
        Number::within(
            "Samples of the mirror that meet it twice in a row, wrong",
            100.0 * of_wrong.part(),
            "%",
            [5.0, 95.0],
            "Rounding leaves a point inside the sphere or outside of it, so neither never nor always. How often depends on the \
             arithmetic and is not predicted: the band only says that the mistake is there.",
        ),
        Number::within(
            "Samples of the mirror that meet it twice in a row, shifted",
            100.0 * of_right.part(),
            "%",
            [0.0, 0.0],
            "A shift of 10⁻⁴ radii is a thousand times the rounding error.",
        ),
        Number::within(
            "Own tracer's picture with the shift, by Nephroid's",
            mean(&right) / library.mean(),
            "",
            lab.pick([0.98, 1.02], [0.94, 1.06]),
            "The same photons and the same estimate; glass is sampled at random, and pixels are sampled apart.",
        ),
    ]);
    body.finding(
        "Fig 2.13",
        "Rays that are not shifted strew a mirror with black dots, as they end by the most bounces.",
        "A shift by a fixed length, too, is wrong in scenes that are small or far from the origin.",
        "Rounding errors grow with coordinates; the bound of the error at each point is the right shift.",
    );
    Ok(body)
}

fn parts(lab: &Lab) -> Result<Parts, Stop> {
    let (world, settings) = lab.world(&lab.recipe("report-2-13"))?;
    let mut scene = world.scene().clone();
    let place = scene.shapes.iter().position(|shape| shape.name == "mirror sphere");
    let mirror = place.map(|place| scene.shapes.remove(place));
    let Some(Geometry::Sphere { center, radius }) = mirror.map(|mirror| mirror.geometry) else {
        return Err(Stop::because("the scene has no mirror sphere"));
    };
    let rest = World::new(scene).map_err(|errors| Stop::because(errors.to_string()))?;
    let recorded = record_photons(&world, &settings, 0, lab.observer()).ok_or(Stop::Cancelled)?;
    // Powers are divided by the paths already.
    let maps = [MapName::Global, MapName::Caustic].map(|map| {
        let own = recorded.photons.iter().filter(|p| p.map == map).map(|p| p.photon);
        PhotonMap::build(Photons::new(1, own.collect()))
    });
    let lamp = tracer::lamp(&world)?;
    Ok(Parts { world, rest, center, radius, lamp, maps })
}

impl Parts {
    fn radiance(
        &self,
        ray: &Ray,
        shift: f32,
        counts: &Counts,
        sampler: &mut Sampler,
        neighbors: &mut NearestList,
    ) -> Rgb {
        let (mut ray, mut weight) = (*ray, Rgb::WHITE);
        let (mut met_mirror, mut from_mirror, mut lost) = (false, false, false);
        for _ in 0..MOST_BOUNCES {
            let wall = self.rest.intersect(&ray);
            let before = wall.as_ref().map_or(f32::INFINITY, |hit| hit.t);
            if let Some(t) = wrong::meets_sphere(&ray, self.center, self.radius).filter(|&t| t < before) {
                if !met_mirror {
                    counts.mirror.fetch_add(1, Ordering::Relaxed);
                }
                if from_mirror && !lost {
                    counts.lost.fetch_add(1, Ordering::Relaxed);
                }
                lost |= from_mirror;
                (met_mirror, from_mirror) = (true, true);
                let position = ray.at(t);
                let normal = (position - self.center) / self.radius;
                let direction = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
                ray = Ray::new(position + shift * self.radius * normal, direction.normalize());
                continue;
            }
            let Some(hit) = wall else { return Rgb::BLACK };
            from_mirror = false;
            let wo = -ray.direction;
            let bsdf = self.rest.bsdf(&hit, wo);
            if !bsdf.is_dirac() {
                let direct = tracer::direct(&self.world, self.lamp, &hit, &self.rest, wo, |cosine| cosine);
                let [global, caustic] = &self.maps;
                let surface = (&self.rest, &hit);
                let indirect = tracer::reflected(global, 100, surface, wo, neighbors)
                    + tracer::reflected(caustic, 100, surface, wo, neighbors);
                return weight * (direct + indirect);
            }
            let (u, u_lobe) = (sampler.next_2d(), sampler.next_1d());
            let Some(sample) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { return Rgb::BLACK };
            weight *= sample.weight;
            let point = &hit.point;
            ray = Ray::new(offset_origin(point.position, point.error, point.ng, sample.wi), sample.wi);
        }
        Rgb::BLACK
    }
}
