//! Media for tests, and the optical depth along a ray by quadrature in double precision, from the
//! definition of a grid and not from its code.

use nephroid_testkit::{Pcg32, Tolerance, integrate};

use super::{Coefficient, Grid, GridValues, Matter, Media, Medium, Phase};
use crate::color::Rgb;
use crate::math::{DVec3, Ray, Transform, Vec3};
use crate::sampling::{Key, Sampler, Sequence, Stream};

pub fn sampler(index: u64) -> Sampler {
    Sampler::new(Sequence::Independent, Key::new(7, 0, Stream::Camera), index)
}

/// What is between nothing and more than enough, where `share` of the cells are not empty.
pub fn patchy(seed: u64, size: [u32; 3], share: f32) -> Grid {
    let mut rng = Pcg32::new(seed);
    let mut value = || rng.next_f32() * 3.0;
    let mut cell = || {
        let color = Rgb::new(value(), value(), value());
        if value() < 3.0 * share { color } else { Rgb::BLACK }
    };
    let values = (0..size.iter().product()).map(|_| cell()).collect();
    Grid { name: String::new(), size, values: GridValues::Rgb(values) }
}

pub fn grey(size: [u32; 3], values: Vec<f32>) -> Grid {
    Grid { name: String::new(), size, values: GridValues::Grey(values) }
}

/// Stretched, turned, sheared and moved; the second is mirrored as well.
pub fn transforms() -> [Transform; 3] {
    let askew = Transform::scale(DVec3::new(2.0, 0.5, 1.5))
        .then(Transform::rotate(DVec3::new(0.3, 1.0, -0.4), 37.0))
        .then(Transform::scale(DVec3::new(1.0, 1.3, 0.8)))
        .then(Transform::translate(DVec3::new(-0.7, 0.2, 0.4)));
    [Transform::IDENTITY, Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).then(askew), askew]
}

/// A medium whose extinction is on a grid, with what is needed to integrate it.
pub struct Case {
    pub matter: Matter,
    pub grid: Grid,
    pub to_world: Transform,
}

impl Case {
    pub fn new(grid: Grid, to_world: Transform) -> Self {
        let mut media = Media::default();
        let handle = media.grids.push(grid.clone());
        let sigma_t = Coefficient::Grid { grid: handle, to_world, scale: 1.0 };
        let medium =
            Medium { sigma_t, ..Medium::homogeneous("smoke", Rgb::BLACK, Rgb::WHITE, Phase::Isotropic) };
        Self { matter: Matter::new(&medium, &media.grids), grid, to_world }
    }

    /// A ray through a point of the grid, given in [0, 1]³, that has come so far until there.
    pub fn ray(&self, through: Vec3, direction: Vec3, back: f32) -> Ray {
        let direction = direction.normalize();
        Ray::new(self.to_world.point(through) - direction * back, direction)
    }

    /// The extinction after `t` of a ray.
    fn at(&self, ray: &Ray, t: f64) -> [f64; 3] {
        let p = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
        let local = self.to_world.0.inverse().transform_point3(p).to_array();
        if local.iter().any(|x| !(0.0..=1.0).contains(x)) {
            return [0.0; 3];
        }
        let size = self.grid.size;
        let mut sum = [0.0; 3];
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let weight: f64 = [x, y, z]
                        .into_iter()
                        .zip(size)
                        .zip(local)
                        .map(|((cell, cells), p)| {
                            let place = (p * f64::from(cells) - 0.5).clamp(0.0, f64::from(cells - 1));
                            (1.0 - (place - f64::from(cell)).abs()).max(0.0)
                        })
                        .product();
                    let value = self.grid.values.get(((z * size[1] + y) * size[0] + x) as usize);
                    for (sum, value) in sum.iter_mut().zip(value.to_array()) {
                        *sum += weight * f64::from(value);
                    }
                }
            }
        }
        sum
    }

    /// Where the extinction bends or ends along a ray, and the two ends.
    fn bends(&self, ray: &Ray, t_max: f64) -> Vec<f64> {
        let to_local = self.to_world.0.inverse();
        let origin = to_local.transform_point3(ray.origin.as_dvec3());
        let direction = to_local.transform_vector3(ray.direction.as_dvec3());
        let mut bends = vec![0.0, t_max];
        for axis in 0..3 {
            let n = f64::from(self.grid.size[axis]);
            let middles = (0..self.grid.size[axis]).map(|i| (f64::from(i) + 0.5) / n);
            bends.extend(middles.chain([0.0, 1.0]).map(|side| (side - origin[axis]) / direction[axis]));
        }
        bends.retain(|t| (0.0..=t_max).contains(t));
        bends.sort_by(f64::total_cmp);
        bends.dedup_by(|a, b| *a - *b < 1e-12);
        bends
    }

    /// Optical depth up to `t_max`.
    pub fn depth(&self, ray: &Ray, t_max: f64) -> [f64; 3] {
        let bends = self.bends(ray, t_max);
        std::array::from_fn(|channel| {
            // Not at the ends, where rounding decides whether the grid is there.
            let f = |t: f64| self.at(ray, t)[channel];
            let rule = Tolerance { absolute: 1e-9, relative: 1e-9 };
            bends.windows(2).map(|w| integrate(f, w, rule).value).sum()
        })
    }
}
