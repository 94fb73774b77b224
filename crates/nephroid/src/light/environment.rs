use std::f32::consts::PI;

use super::aim::Targets;
use super::emitter::{Emission, EmissionNumbers, Incident, Source, Target};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::{atan2, sin_cos};
use crate::math::{DMat3, Transform, Vec2, Vec3, warp};
use crate::sampling::Discrete2d;
use crate::texture::{Pixmap, Textures, Wrap};

/// The same radiance from everywhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstantSky {
    pub radiance: Rgb,
    pub target: Target,
}

impl ConstantSky {
    pub fn power(&self) -> Rgb {
        self.radiance * (4.0 * PI * self.target.silhouette())
    }

    pub fn sample_incident(&self, u: Vec2) -> Incident {
        incident(warp::square_to_sphere(u), self.radiance, warp::SPHERE_PDF)
    }

    /// Starts in a direction uniform over the sphere.
    pub fn emit(&self, u: EmissionNumbers, targets: Option<&Targets>, direction: Vec3) -> Emission {
        self.target.emit(direction, self.radiance * (4.0 * PI), u, targets)
    }
}

/// Radiance from an equirectangular image, sampled by its brightness.
///
/// Row 0 is local +y, and a local direction has u = atan2(x, −z) / 2π. As Mitsuba has it, the
/// colours of the first and the last row are those at the poles, while columns have theirs at
/// their middles.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentMap {
    image: Handle<Pixmap>,
    scale: f32,
    to_local: DMat3,
    to_world: DMat3,
    /// Density over the image, ∝ mean brightness of the neighbourhood · sin θ: positive wherever
    /// interpolation gives light.
    table: Discrete2d,
    mean_radiance: Rgb,
    pub target: Target,
}

impl EnvironmentMap {
    /// `None` if the image holds no light.
    pub fn new(
        textures: &Textures,
        image: Handle<Pixmap>,
        scale: f32,
        to_world: &Transform,
        target: Target,
    ) -> Option<Self> {
        let pixels = &textures.images[image];
        let (w, h) = (pixels.width, pixels.height);
        let mut weights = Vec::with_capacity(pixels.pixels.len());
        let (mut sum, mut solid_angle) = ([0.0f64; 3], 0.0);
        for y in 0..h {
            let sin_theta = sin_cos(PI * (y as f32 + 0.5) / h as f32).0;
            for x in 0..w {
                let mut neighbourhood = 0.0;
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        neighbourhood +=
                            f64::from(texel(pixels, i64::from(x) + dx, i64::from(y) + dy).mean());
                    }
                }
                weights.push(neighbourhood * f64::from(sin_theta));
                for (s, v) in sum.iter_mut().zip(pixels.pixel(x, y).to_array()) {
                    *s += f64::from(v * sin_theta);
                }
                solid_angle += f64::from(sin_theta);
            }
        }
        let rotation = to_world.0.matrix3;
        Some(Self {
            image,
            scale,
            to_local: rotation.inverse(),
            to_world: rotation,
            table: Discrete2d::new(&weights, w as usize, h as usize)?,
            mean_radiance: Rgb::from(sum.map(|s| (s / solid_angle) as f32)) * scale,
            target,
        })
    }

    /// W that reach the target.
    pub fn power(&self) -> Rgb {
        self.mean_radiance * (4.0 * PI * self.target.silhouette())
    }

    /// The largest radiance that is seen of it, of any channel.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        textures.images[self.image].brightest() * self.scale
    }

    /// Radiance seen in a world direction.
    pub fn radiance(&self, textures: &Textures, direction: Vec3) -> Rgb {
        self.texture(textures, self.to_square(direction).0)
    }

    fn texture(&self, textures: &Textures, uv: Vec2) -> Rgb {
        let image = &textures.images[self.image];
        let (x, y) = (uv.x * image.width as f32 - 0.5, uv.y * (image.height - 1) as f32);
        let (i, j) = (x.floor(), y.floor());
        let (a, b) = (x - i, y - j);
        let (i, j) = (i as i64, j as i64);
        let row = |j| texel(image, i, j) * (1.0 - a) + texel(image, i + 1, j) * a;
        (row(j) * (1.0 - b) + row(j + 1) * b) * self.scale
    }

    /// The place of a direction in the image, and the sine of its angle to the poles, which next to
    /// them only the direction tells.
    fn to_square(&self, direction: Vec3) -> (Vec2, f32) {
        let d = (self.to_local * direction.as_dvec3()).as_vec3().normalize();
        let u = atan2(d.x, -d.z) / (2.0 * PI);
        let sin_theta = (d.x * d.x + d.z * d.z).sqrt();
        (Vec2::new(u - u.floor(), atan2(sin_theta, d.y) / PI), sin_theta)
    }

    fn to_direction(&self, uv: Vec2) -> (Vec3, f32) {
        let (sin_theta, cos_theta) = sin_cos(PI * uv.y);
        let (sin_phi, cos_phi) = sin_cos(2.0 * PI * uv.x);
        let local = Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi);
        ((self.to_world * local.as_dvec3()).as_vec3().normalize(), sin_theta)
    }

    /// Density of a world direction per unit solid angle.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let (uv, sin_theta) = self.to_square(direction);
        if sin_theta > 0.0 { self.table.pdf(uv) / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }

    pub fn sample_incident(&self, textures: &Textures, u: Vec2) -> Option<Incident> {
        let (uv, pdf_square) = self.table.sample(u);
        let (wi, sin_theta) = self.to_direction(uv);
        let pdf = pdf_square / (2.0 * PI * PI * sin_theta);
        (sin_theta > 0.0 && pdf > 0.0).then(|| incident(wi, self.texture(textures, uv), pdf))
    }

    pub fn emit(&self, textures: &Textures, u: EmissionNumbers, targets: Option<&Targets>) -> Emission {
        match self.sample_incident(textures, u.direction) {
            Some(from) => self.target.emit(-from.wi, from.radiance / from.pdf_solid_angle, u, targets),
            None => Emission::elsewhere(self.target.center, Rgb::BLACK),
        }
    }
}

/// A pixel of an image that wraps around in longitude.
fn texel(image: &Pixmap, x: i64, y: i64) -> Rgb {
    image.pixel(Wrap::Repeat.index(x, image.width), Wrap::Clamp.index(y, image.height))
}

fn incident(wi: Vec3, radiance: Rgb, pdf_solid_angle: f32) -> Incident {
    Incident { wi, radiance, pdf_solid_angle, dirac: false, source: Source::Infinity }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Image;

    #[test]
    fn rows_lie_from_pole_to_pole_and_columns_have_their_middles() {
        // Values 0 … 11: four columns, three rows.
        let pixels = (0..12).map(|i| Rgb::splat(i as f32)).collect();
        let mut textures = Textures::default();
        let image = textures.images.push(Image { width: 4, height: 3, pixels }.into());
        let target = Target { center: Vec3::ZERO, radius: 1.0 };
        let map = EnvironmentMap::new(&textures, image, 1.0, &Transform::IDENTITY, target).unwrap();
        let value = |direction: Vec3| map.radiance(&textures, direction.normalize()).g;
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-4, "{a} instead of {b}");
        // The middle of column 0 lies 45° from −z towards +x.
        let (s, c) = sin_cos(PI / 4.0);
        let ahead = Vec3::new(s, 0.0, -c);
        near(value(ahead), 4.0);
        near(value(ahead + Vec3::Y), 2.0);
        near(value(ahead - Vec3::Y), 6.0);
        near(value(Vec3::Y + 1e-6 * ahead), 0.0);
        near(value(-Vec3::Y + 1e-6 * ahead), 8.0);
        // Between columns 0 and 1, and between the last and the first.
        near(value(Vec3::X), 4.5);
        near(value(-Vec3::Z), 5.5);
    }
}
