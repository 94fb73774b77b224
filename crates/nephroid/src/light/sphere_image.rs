use std::f32::consts::PI;

use super::EnvironmentMapping;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::{atan2, sin_cos};
use crate::math::{Vec2, Vec3, warp};
use crate::sampling::Discrete2d;
use crate::texture::{Pixmap, Textures, Wrap};

/// An image of all directions, read between its pixels and sampled by its brightness. Directions are local.
#[derive(Clone, Debug)]
pub(super) struct SphereImage {
    image: Handle<Pixmap>,
    mapping: EnvironmentMapping,
    /// Density over the image, ∝ mean brightness of the neighbourhood, and where rows differ in solid angle that of the
    /// row: positive wherever interpolation gives light.
    table: Discrete2d,
    /// Over the sphere.
    mean: Rgb,
    /// How wide a lobe of its peak would be that holds the same: (∫L)² / ∫L², in sr.
    lobe: f32,
}

/// A direction of a [`SphereImage`], drawn by its brightness.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphereSample {
    pub direction: Vec3,
    pub value: Rgb,
    /// Per unit solid angle.
    pub pdf: f32,
}

impl SphereImage {
    /// `None` if the image holds no light. A square one is needed for the equal-area mapping.
    pub fn new(textures: &Textures, image: Handle<Pixmap>, mapping: EnvironmentMapping) -> Option<Self> {
        let pixels = &textures.images[image];
        let (w, h) = (pixels.width, pixels.height);
        let mut weights = Vec::with_capacity(w as usize * h as usize);
        let (mut sum, mut squares, mut solid_angle) = ([0.0f64; 3], 0.0, 0.0);
        for y in 0..h {
            let (density, share) = match mapping {
                EnvironmentMapping::Equirectangular => {
                    (f64::from(sin_cos(PI * (y as f32 + 0.5) / h as f32).0), share_of_row(y, h))
                }
                EnvironmentMapping::EqualArea => (1.0, 1.0),
            };
            for x in 0..w {
                let mut neighbourhood = 0.0;
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        let value = texel(pixels, mapping, i64::from(x) + dx, i64::from(y) + dy);
                        neighbourhood += f64::from(value.mean());
                    }
                }
                weights.push(neighbourhood * density);
                let value = pixels.pixel(x, y);
                for (s, v) in sum.iter_mut().zip(value.to_array()) {
                    *s += f64::from(v) * share;
                }
                squares += f64::from(value.mean()).powi(2) * share;
                solid_angle += share;
            }
        }
        let table = Discrete2d::new(&weights, w as usize, h as usize)?;
        let mean = Rgb::from(sum.map(|s| (s / solid_angle) as f32));
        let lobe = 4.0 * f64::from(PI) * f64::from(mean.mean()).powi(2) * solid_angle / squares;
        Some(Self { image, mapping, table, mean, lobe: lobe as f32 })
    }

    /// The mean over the sphere, exact for what is read between pixels.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// (∫L)² / ∫L² of the brightness L, in sr.
    pub fn lobe(&self) -> f32 {
        self.lobe
    }

    /// The largest value of any channel.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        textures.images[self.image].brightest()
    }

    /// The value in a unit direction.
    pub fn value(&self, textures: &Textures, direction: Vec3) -> Rgb {
        self.read(textures, self.to_square(direction).0)
    }

    fn read(&self, textures: &Textures, uv: Vec2) -> Rgb {
        let image = &textures.images[self.image];
        let y = match self.mapping {
            EnvironmentMapping::Equirectangular => uv.y * (image.height - 1) as f32,
            EnvironmentMapping::EqualArea => uv.y * image.height as f32 - 0.5,
        };
        let x = uv.x * image.width as f32 - 0.5;
        let (i, j) = (x.floor(), y.floor());
        let (a, b) = (x - i, y - j);
        let (i, j) = (i as i64, j as i64);
        let at = |i, j| texel(image, self.mapping, i, j);
        let row = |j| at(i, j) * (1.0 - a) + at(i + 1, j) * a;
        row(j) * (1.0 - b) + row(j + 1) * b
    }

    /// The place of a direction in the image, and the solid angle of a unit of area there. Next to the poles only the
    /// direction tells it.
    fn to_square(&self, d: Vec3) -> (Vec2, f32) {
        match self.mapping {
            EnvironmentMapping::Equirectangular => {
                let u = atan2(d.x, -d.z) / (2.0 * PI);
                let sin_theta = (d.x * d.x + d.z * d.z).sqrt();
                (Vec2::new(u - u.floor(), atan2(sin_theta, d.y) / PI), 2.0 * PI * PI * sin_theta)
            }
            EnvironmentMapping::EqualArea => (warp::equal_area_sphere_to_square(d), 4.0 * PI),
        }
    }

    fn to_direction(&self, uv: Vec2) -> (Vec3, f32) {
        match self.mapping {
            EnvironmentMapping::Equirectangular => {
                let (sin_theta, cos_theta) = sin_cos(PI * uv.y);
                let (sin_phi, cos_phi) = sin_cos(2.0 * PI * uv.x);
                let direction = Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi);
                (direction, 2.0 * PI * PI * sin_theta)
            }
            EnvironmentMapping::EqualArea => (warp::square_to_equal_area_sphere(uv), 4.0 * PI),
        }
    }

    /// Density of [`Self::sample`] in a unit direction, per unit solid angle.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let (uv, solid_angle) = self.to_square(direction);
        if solid_angle > 0.0 { self.table.pdf(uv) / solid_angle } else { 0.0 }
    }

    /// A direction by brightness; `None` where its density has no end.
    pub fn sample(&self, textures: &Textures, u: Vec2) -> Option<SphereSample> {
        let (uv, pdf_square) = self.table.sample(u);
        let (direction, solid_angle) = self.to_direction(uv);
        let pdf = pdf_square / solid_angle;
        (solid_angle > 0.0 && pdf > 0.0).then(|| SphereSample {
            direction,
            value: self.read(textures, uv),
            pdf,
        })
    }
}

/// The share of the sphere that counts for row `y` of `h` that lie from pole to pole, to a common factor: the integral of
/// sin θ over the rows beside it, weighted linearly as values between rows are. With rows Δ apart it is
/// 2 sin θ (1 − cos Δ)/Δ, and at the poles 1 − sin(Δ)/Δ.
fn share_of_row(y: u32, h: u32) -> f64 {
    if h == 1 {
        return 1.0;
    }
    let step = std::f64::consts::PI / f64::from(h - 1);
    if y == 0 || y == h - 1 {
        return 1.0 - libm::sin(step) / step;
    }
    4.0 * libm::sin(step * f64::from(y)) * libm::sin(0.5 * step).powi(2) / step
}

/// A pixel, of those beyond the edges the one that shows what lies there: in longitude a rectangle repeats, while a square
/// is folded along the middles of its edges.
fn texel(image: &Pixmap, mapping: EnvironmentMapping, x: i64, y: i64) -> Rgb {
    match mapping {
        EnvironmentMapping::Equirectangular => {
            image.pixel(Wrap::Repeat.index(x, image.width), Wrap::Clamp.index(y, image.height))
        }
        EnvironmentMapping::EqualArea => {
            let n = i64::from(image.width);
            let fold = |across: i64, along: i64| {
                let inside = (0..n).contains(&across);
                if inside {
                    [across, along]
                } else {
                    [Wrap::Mirror.index(across, image.width).into(), n - 1 - along]
                }
            };
            let [x, y] = fold(x, y);
            let [y, x] = fold(y, x);
            image.pixel(x as u32, y as u32)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Image;

    fn of(image: Image, mapping: EnvironmentMapping) -> (Textures, SphereImage) {
        let mut textures = Textures::default();
        let handle = textures.images.push(image.into());
        let sphere = SphereImage::new(&textures, handle, mapping).unwrap();
        (textures, sphere)
    }

    fn uneven(width: u32, height: u32) -> Image {
        let pixels = (0..width * height).map(|i| Rgb::splat((i * 7 % 11) as f32)).collect();
        Image { width, height, pixels }
    }

    #[test]
    fn rows_lie_from_pole_to_pole_and_columns_have_their_middles() {
        // Values 0 … 11: four columns, three rows.
        let pixels = (0..12).map(|i| Rgb::splat(i as f32)).collect();
        let (textures, map) = of(Image { width: 4, height: 3, pixels }, EnvironmentMapping::Equirectangular);
        let value = |direction: Vec3| map.value(&textures, direction.normalize()).g;
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

    #[test]
    fn a_square_has_its_middle_ahead_and_is_read_smoothly_across_its_folds() {
        let (textures, map) = of(uneven(4, 4), EnvironmentMapping::EqualArea);
        let value = |direction: Vec3| map.value(&textures, direction.normalize()).g;
        let near = |a: f32, b: f32, what| assert!((a - b).abs() < 0.02, "{a} instead of {b} {what}");
        // The middle is between the four pixels 5, 6, 9 and 10.
        let pixel = |i: u32| (i * 7 % 11) as f32;
        near(value(Vec3::Z), (pixel(5) + pixel(6) + pixel(9) + pixel(10)) / 4.0, "ahead");
        near(value(-Vec3::Z), (pixel(0) + pixel(3) + pixel(12) + pixel(15)) / 4.0, "behind");
        // The first row lies towards −y: its middle is between the second and the third pixel there, half in front.
        near(value(-Vec3::Y), (pixel(1) + pixel(2)) / 2.0, "below");
        near(value(Vec3::X), (pixel(7) + pixel(11)) / 2.0, "at the side");
        // What is read changes little from one side of a fold to the other.
        for i in 0..2000 {
            let phi = i as f32 * 0.01;
            let (sin, cos) = sin_cos(phi);
            let edge = Vec3::new(cos, sin, 0.0);
            // The back half's folds: where a coordinate across the view is zero.
            let back = Vec3::new(0.0, sin, -cos.abs());
            for (at, by) in [(edge, Vec3::Z), (back, Vec3::X)] {
                near(value(at + 1e-4 * by), value(at - 1e-4 * by), "across a fold");
            }
        }
    }

    /// To the error of quadrature, a part in 10⁴.
    #[test]
    fn the_mean_is_the_integral_of_what_is_read() {
        for (image, mapping) in [
            (uneven(5, 4), EnvironmentMapping::Equirectangular),
            (uneven(3, 1), EnvironmentMapping::Equirectangular),
            (uneven(4, 2), EnvironmentMapping::Equirectangular),
            (uneven(5, 5), EnvironmentMapping::EqualArea),
        ] {
            let (textures, map) = of(image, mapping);
            let n = 400u32;
            let mut sum = 0.0;
            for k in 0..n * n {
                let square = (Vec2::new((k % n) as f32, (k / n) as f32) + 0.5) / n as f32;
                sum += f64::from(map.value(&textures, warp::square_to_sphere(square)).g);
            }
            let mean = sum / f64::from(n * n);
            assert!((mean / f64::from(map.mean().g) - 1.0).abs() < 1e-4, "{mean} {:?}", map.mean());
        }
    }
}
