use super::ProjectorUnit;
use super::aim::{Cones, Targets, overlaps};
use super::emitter::{Emission, EmissionNumbers};
use super::extent::NormalCone;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::atan2;
use crate::math::{Frame, Ray, Transform, Vec2, Vec3};
use crate::sampling::Discrete2d;
use crate::texture::{Pixmap, Textures, Wrap};

/// A pinhole that shows an image in a frustum.
#[derive(Clone, Debug)]
pub(crate) struct Projector {
    pub position: Vec3,
    frame: Frame,
    image: Handle<Pixmap>,
    scale: Rgb,
    unit: ProjectorUnit,
    /// Half the width and height of the image at distance 1.
    half: Vec2,
    /// Density over the image, ∝ mean brightness of the neighbourhood times the solid angle that counts there.
    table: Discrete2d,
    power: Rgb,
}

impl Projector {
    /// `half` is half the width and height of the image at distance 1. The length of local units counts where the image
    /// tells the irradiance in a local plane. `None` if the image holds no light.
    pub fn new(
        textures: &Textures,
        to_world: &Transform,
        image: Handle<Pixmap>,
        scale: Rgb,
        unit: ProjectorUnit,
        half: Vec2,
    ) -> Option<Self> {
        let axis = |v: Vec3| to_world.vector(v).normalize();
        let scale = match unit {
            ProjectorUnit::Intensity => scale,
            ProjectorUnit::Irradiance => scale * to_world.vector(Vec3::Z).length_squared(),
        };
        let pixels = &textures.images[image];
        let (w, h) = (pixels.width, pixels.height);
        // What the image's values count for in W: solid angles, or areas of the plane.
        let sizes = Sizes { unit, half: [f64::from(half.x), f64::from(half.y)], count: [w, h] };
        let mut weights = Vec::with_capacity(w as usize * h as usize);
        let mut power = [0.0; 3];
        for y in 0..h {
            for x in 0..w {
                let mut neighbourhood = 0.0;
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        let value = texel(pixels, i64::from(x) + dx, i64::from(y) + dy);
                        neighbourhood += f64::from((scale * value).mean());
                    }
                }
                let size = sizes.of(x, y);
                weights.push(neighbourhood * size);
                for (sum, v) in power.iter_mut().zip((scale * pixels.pixel(x, y)).to_array()) {
                    *sum += f64::from(v) * size;
                }
            }
        }
        Some(Self {
            position: to_world.point(Vec3::ZERO),
            frame: Frame { s: axis(Vec3::X), t: axis(Vec3::Y), n: axis(Vec3::Z) },
            image,
            scale,
            unit,
            half,
            table: Discrete2d::new(&weights, w as usize, h as usize)?,
            power: Rgb::from(power.map(|sum| sum as f32)),
        })
    }

    /// W/sr in a unit direction away from the light.
    pub fn intensity(&self, textures: &Textures, direction: Vec3) -> Rgb {
        let local = self.frame.to_local(direction);
        if local.z <= 0.0 {
            return Rgb::BLACK;
        }
        let at = Vec2::new(local.x, local.y) / (local.z * self.half);
        if at.abs().max_element() > 1.0 {
            return Rgb::BLACK;
        }
        self.shown(textures, 0.5 - 0.5 * at, local.z)
    }

    /// W/sr at a place of the image, whose direction has this cosine to the axis.
    fn shown(&self, textures: &Textures, uv: Vec2, cos: f32) -> Rgb {
        let value = self.scale * self.read(textures, uv);
        match self.unit {
            ProjectorUnit::Intensity => value,
            ProjectorUnit::Irradiance => value / (cos * cos * cos),
        }
    }

    fn read(&self, textures: &Textures, uv: Vec2) -> Rgb {
        let image = &textures.images[self.image];
        let p = uv * Vec2::new(image.width as f32, image.height as f32) - 0.5;
        let (low, part) = (p.floor(), p - p.floor());
        let (i, j) = (low.x as i64, low.y as i64);
        let row = |j| texel(image, i, j) * (1.0 - part.x) + texel(image, i + 1, j) * part.x;
        row(j) * (1.0 - part.y) + row(j + 1) * part.y
    }

    /// The directions that it shines into, and those between them and a round edge.
    pub fn beam(&self) -> NormalCone {
        NormalCone::of_beam(self.frame.n, atan2(self.half.length(), 1.0))
    }

    /// W: the integral of the intensity, of which what is read between pixels counts for the pixels.
    pub fn power(&self) -> Rgb {
        self.power
    }

    /// By the brightness of the image, or uniform over the solid angles of the targets that it may reach if they are less
    /// than half of its frustum; `whole` is the power of the light.
    pub fn emit(
        &self,
        textures: &Textures,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        whole: Rgb,
    ) -> Emission {
        if let Some(cones) = targets.and_then(|targets| self.cones(targets)) {
            return cones.emit(self.position, u, whole, |direction| self.intensity(textures, direction));
        }
        let (uv, pdf_square) = self.table.sample(u.direction);
        let at = (1.0 - 2.0 * uv) * self.half;
        let direction = at.extend(1.0).normalize();
        let cos = direction.z;
        // A unit of the square is 4 half-widths by half-heights of the plane.
        let pdf = pdf_square / (4.0 * self.half.x * self.half.y * cos * cos * cos);
        if pdf <= 0.0 {
            return Emission::elsewhere(self.position, Rgb::BLACK);
        }
        let power = self.shown(textures, uv, cos) / pdf;
        Emission::whole(Ray::new(self.position, self.frame.to_world(direction)), None, power)
    }

    fn cones(&self, targets: &Targets) -> Option<Cones> {
        let (x, y) = (f64::from(self.half.x), f64::from(self.half.y));
        let limit = 0.5 * 4.0 * solid_angle_to(x, y);
        let reach = self.half.length();
        let cos = 1.0 / (1.0 + reach * reach).sqrt();
        let overlaps = overlaps(&self.frame, reach * cos, cos);
        Cones::seen_from(targets, (self.position, 0.0), None, limit as f32, overlaps)
    }
}

/// How much pixels of an image count for.
struct Sizes {
    unit: ProjectorUnit,
    half: [f64; 2],
    count: [u32; 2],
}

impl Sizes {
    fn of(&self, x: u32, y: u32) -> f64 {
        let edge =
            |i: u32, axis: usize| (2.0 * f64::from(i) / f64::from(self.count[axis]) - 1.0) * self.half[axis];
        let (x, y) = ([edge(x, 0), edge(x + 1, 0)], [edge(y, 1), edge(y + 1, 1)]);
        match self.unit {
            ProjectorUnit::Irradiance => (x[1] - x[0]) * (y[1] - y[0]),
            ProjectorUnit::Intensity => {
                let to = solid_angle_to;
                to(x[1], y[1]) - to(x[0], y[1]) - to(x[1], y[0]) + to(x[0], y[0])
            }
        }
    }
}

/// Solid angle of the rectangle from the axis to (x, y) in the plane at distance 1.
fn solid_angle_to(x: f64, y: f64) -> f64 {
    libm::atan2(x * y, (1.0 + x * x + y * y).sqrt())
}

/// A pixel of an image whose edge goes on.
fn texel(image: &Pixmap, x: i64, y: i64) -> Rgb {
    image.pixel(Wrap::Clamp.index(x, image.width), Wrap::Clamp.index(y, image.height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Image;

    /// A camera at its place would see the image as it is: first row up, first column towards +x, which is left.
    #[test]
    fn the_image_stands_upright_and_a_screen_shows_it_evenly() {
        let mut textures = Textures::default();
        let pixels = (1..=4).map(|i| Rgb::splat(i as f32)).collect();
        let image = textures.images.push(Image { width: 2, height: 2, pixels }.into());
        let half = Vec2::new(0.6, 0.6);
        let twice = Transform::scale(crate::math::DVec3::splat(2.0));
        let of = |unit| Projector::new(&textures, &twice, image, Rgb::WHITE, unit, half).expect("light");
        let seen = |x: f32, y: f32, unit| of(unit).intensity(&textures, Vec3::new(x, y, 1.0).normalize()).g;
        let corners = [(0.55, 0.55), (-0.55, 0.55), (0.55, -0.55), (-0.55, -0.55)];
        for ((x, y), value) in corners.into_iter().zip([1.0, 2.0, 3.0, 4.0]) {
            assert_eq!(seen(x, y, ProjectorUnit::Intensity), value);
            // On a screen two metres away, as long as the local unit: E = I cos³θ / 4.
            let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
            let irradiance = seen(x, y, ProjectorUnit::Irradiance) * cos * cos * cos / 4.0;
            assert!((irradiance / value - 1.0).abs() < 1e-5, "{irradiance} of {value}");
        }
        assert_eq!(seen(0.61, 0.0, ProjectorUnit::Intensity), 0.0);
        assert_eq!(of(ProjectorUnit::Intensity).intensity(&textures, -Vec3::Z).g, 0.0);
    }
}
