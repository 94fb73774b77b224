//! A small renderer of the study's own, for pictures of mistakes that Nephroid cannot be told to make. It uses what
//! Nephroid's library offers to everybody: rays, materials and photon maps.

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::math::{Ray, Transform, Vec2, Vec3, offset_origin};
use nephroid::photon_map::{Bandwidth, Kernel, NearestList, Photon, PhotonMap, Query, gather};
use nephroid::sampling::{Key, Sampler, Sequence, Stream};
use nephroid::texture::Image;
use nephroid::world::{Hit, World};
use rayon::prelude::*;

use crate::lab::Lab;
use crate::section::Stop;

/// A camera without a lens, of a picture that is as high as wide.
pub struct Pinhole {
    to_world: Transform,
    from_world: Transform,
    /// Half of the picture's height at distance 1.
    half: f32,
    side: u32,
}

impl Pinhole {
    /// The scene's camera.
    pub fn of(world: &World) -> Result<Self, Stop> {
        let (camera, film) = (&world.scene().camera, &world.scene().film);
        let Projection::Perspective { fov_deg, fov_axis: FovAxis::Smaller, .. } = camera.projection else {
            return Err(Stop::because("the study's tracer knows one camera"));
        };
        let half = libm::tan(f64::from(0.5 * fov_deg).to_radians()) as f32;
        let to_world = camera.to_world;
        Ok(Self { to_world, from_world: to_world.inverse(), half, side: film.width.min(film.height) })
    }

    /// Through a place on the picture, in pixels.
    pub fn ray(&self, place: Vec2) -> Ray {
        let q = (Vec2::ONE - 2.0 * place / self.side as f32) * self.half;
        let direction = self.to_world.vector(q.extend(1.0)).normalize();
        Ray::new(self.to_world.point(Vec3::ZERO), direction)
    }

    /// Where a point appears, in pixels.
    pub fn project(&self, point: Vec3) -> Vec2 {
        let local = self.from_world.point(point);
        let q = Vec2::new(local.x, local.y) / local.z;
        (Vec2::ONE - q / self.half) * 0.5 * self.side as f32
    }
}

/// A picture of so many samples a pixel, at even chance within it.
pub fn expose(
    lab: &Lab,
    world: &World,
    samples: u64,
    radiance: impl Fn(&Ray, &mut Sampler, &mut NearestList) -> Rgb + Sync,
) -> Result<Image, Stop> {
    lab.check()?;
    let camera = Pinhole::of(world)?;
    let (side, seed) = (camera.side, lab.seed());
    let pixel = |neighbors: &mut NearestList, i: u32| {
        let sum: Rgb = (0..samples)
            .map(|sample| {
                let key = Key::new(seed, 0, Stream::Camera).with(u64::from(i));
                let mut sampler = Sampler::new(Sequence::Independent, key, sample);
                let corner = Vec2::new((i % side) as f32, (i / side) as f32);
                let ray = camera.ray(corner + sampler.next_2d());
                radiance(&ray, &mut sampler, neighbors)
            })
            .sum();
        sum / samples.max(1) as f32
    };
    let pixels = (0..side * side).into_par_iter().map_init(NearestList::new, pixel).collect();
    Ok(Image { width: side, height: side, pixels })
}

/// The scene's one point light: where, and its intensity in W/sr.
pub fn lamp(world: &World) -> Result<(Vec3, Rgb), Stop> {
    match world.scene().lights.as_slice() {
        [light] => match light.kind {
            LightKind::Point { position, intensity } => Ok((position, intensity)),
            _ => Err(Stop::because("the scene's lamp is no point light")),
        },
        _ => Err(Stop::because("the scene has not one lamp")),
    }
}

/// What a surface reflects of a lamp's light, with what is made of the cosine.
pub fn direct(
    world: &World,
    (position, intensity): (Vec3, Rgb),
    hit: &Hit,
    scatters: &World,
    wo: Vec3,
    of_cosine: fn(f32) -> f32,
) -> Rgb {
    let point = &hit.point;
    let wi = (position - point.position).normalize();
    let origin = offset_origin(point.position, point.error, point.ng, wi);
    // Short of the lamp.
    if world.occluded(&Ray { origin, direction: position - origin, t_max: 0.9999 }) {
        return Rgb::BLACK;
    }
    let bsdf = scatters.bsdf(hit, wo);
    let factor = of_cosine(bsdf.cosine(wi)) / (position - point.position).length_squared();
    bsdf.eval(wo, wi) * intensity * factor
}

/// What a surface reflects of the light that k photons bring.
pub fn reflected(
    map: &PhotonMap,
    k: u32,
    (world, hit): (&World, &Hit),
    wo: Vec3,
    neighbors: &mut NearestList,
) -> Rgb {
    let bsdf = world.bsdf(hit, wo);
    let normal = facing(hit.point.ng, wo);
    let query = Query { position: hit.point.position, normal, max_photon_depth: None };
    let bandwidth = Bandwidth::Nearest { k, max_radius: map.default_max_radius(k) };
    let mut sum = Rgb::BLACK;
    gather(map, &query, Kernel::Box, bandwidth, neighbors, |photon: &Photon, weight| {
        sum += photon.power * bsdf.eval(wo, photon.wi) * weight;
    });
    sum
}

/// A normal on the side of a direction.
pub fn facing(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) < 0.0 { -normal } else { normal }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinhole_sees_points_where_its_rays_go() {
        let to_world = Transform::look_at(
            nephroid::math::DVec3::new(0.0, 1.4, 6.0),
            nephroid::math::DVec3::new(0.0, 1.4, 0.0),
            nephroid::math::DVec3::Y,
        )
        .unwrap();
        let camera = Pinhole { to_world, from_world: to_world.inverse(), half: 0.3, side: 64 };
        for place in [Vec2::new(3.0, 50.0), Vec2::new(32.0, 32.0), Vec2::new(60.5, 1.25)] {
            let seen = camera.project(camera.ray(place).at(5.0));
            assert!((seen - place).length() < 1e-3, "{place} {seen}");
        }
        // What is above is in a row above.
        assert!(camera.project(Vec3::new(0.0, 2.0, 0.0)).y < 32.0);
    }
}
