use std::f64::consts::PI;

use super::World;

/// Units are between 2^−`LIMIT` and 2^`LIMIT`: what single precision has room for, with some to spare.
const LIMIT: i32 = 100;

/// How many powers of two the brightest lamp may be above the unit.
///
/// A film has room for 2^32 units from an iteration and for sums of squares up to 2^56: at 2^23 units, 512 samples of
/// an iteration and 1024 in all fit. Where the lamp is 2^40 times as bright as the rest, that is around 2^−17 units, and
/// its squares, of 2^−34, are still well above the smallest of 2^−40.
const ABOVE: i32 = 22;

impl World {
    /// Exponent of a power of two near the radiances of the scene, in W/(m²·sr), for
    /// [`Film::with_unit`](crate::film::Film::with_unit); 0 where nothing shines.
    ///
    /// ⌊log₂(Φ / (π · 4πR²))⌋: what a white sphere of the scene's radius R sends back of the power Φ of all
    /// lights that falls on it from within; of a sky alone, the sky's radiance. But at least ⌊log₂ L⌋ − 22 with the
    /// largest radiance L of surfaces and skies that shine: a lamp of radius r has L ≈ (R/r)² such units, and where it is
    /// tiny and seen, it must fit into a film all the same. Nothing is traced: it only has to be right to some
    /// thousandfold.
    pub fn radiance_unit(&self) -> i32 {
        let channels = self.emitters().iter().flat_map(|e| e.power.to_array());
        let power = channels.map(f64::from).sum::<f64>() / 3.0;
        let radius = f64::from(self.radius());
        let typical = exponent(power / (PI * 4.0 * PI * radius * radius));
        let textures = &self.scene().textures;
        let brightest = self.emitters().iter().fold(0.0, |all: f32, e| e.brightest(textures).max(all));
        if brightest > 0.0 { typical.max(exponent(f64::from(brightest)) - ABOVE) } else { typical }
    }
}

/// ⌊log₂ x⌋ within the limits; 0 for what is not positive and finite.
fn exponent(x: f64) -> i32 {
    if !(x > 0.0 && x.is_finite()) {
        return 0;
    }
    // Numbers below the normal ones have the exponent of the smallest, and end at the limit as well.
    let biased = (x.to_bits() >> 52) as i32;
    (biased - 1023).clamp(-LIMIT, LIMIT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::color::Rgb;
    use crate::film::{Film, FilmSettings, Filter, PixelSum};
    use crate::handle::Arena;
    use crate::light::{Light, LightKind};
    use crate::material::Material;
    use crate::math::{Transform, Vec3};
    use crate::medium::Media;
    use crate::scene::Scene;
    use crate::shape::{Geometry, Shape};
    use crate::texture::Textures;

    /// A sphere with the camera in its middle.
    fn room(size: f32, light: LightKind) -> World {
        let mut textures = Textures::default();
        let mut materials = Arena::default();
        let grey = materials.push(Material::Diffuse { reflectance: textures.constant(Rgb::splat(0.5)) });
        World::new(Scene {
            camera: Camera {
                to_world: Transform::IDENTITY,
                projection: Projection::Orthographic,
                medium: None,
            },
            film: FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box },
            textures,
            materials,
            meshes: Arena::default(),
            shapes: vec![Shape::new("", Geometry::Sphere { center: Vec3::ZERO, radius: size }, grey)],
            groups: Arena::default(),
            instances: Vec::new(),
            lights: vec![Light { name: String::new(), kind: light, medium: None }],
            media: Media::default(),
        })
        .unwrap()
    }

    #[test]
    fn exponents_are_floors_of_logarithms() {
        for (x, expected) in [(1.0, 0), (1.999, 0), (2.0, 1), (0.75, -1), (1e-300, -LIMIT), (f64::MAX, LIMIT)]
        {
            assert_eq!(exponent(x), expected, "{x}");
        }
        for x in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE / 2.0] {
            assert!([0, -LIMIT].contains(&exponent(x)), "{x}");
        }
    }

    /// A lamp of radius 1 and radiance 2^20 in the middle of a room.
    #[test]
    fn a_tiny_lamp_that_is_seen_fits_into_the_film() {
        let unit = |size: f32| {
            let mut scene = room(size, LightKind::Constant { radiance: Rgb::splat(1e-20) }).scene().clone();
            let radiance = scene.textures.constant(Rgb::splat(1_048_576.0));
            let sphere = Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 };
            let lamp = Shape::new("lamp", sphere, scene.shapes[0].material);
            scene.shapes.push(Shape { emission: Some(radiance), ..lamp });
            World::new(scene).unwrap().radiance_unit()
        };
        // 2^20 · 4π² / (4π² · 3 R²), as long as the lamp is no more than 2^22 times as bright.
        assert_eq!(unit(8.0), 12);
        assert_eq!(unit(512.0), 0);
        assert_eq!(unit(2048.0), -2);
        assert_eq!(unit(131_072.0), -2);
        // 512 samples of an iteration fit at any size.
        let mut film = Film::with_unit(1, 1, unit(131_072.0));
        let mut sum = PixelSum::default();
        (0..512).for_each(|_| sum.add(Rgb::splat(1_048_576.0), 1.0));
        film.add_iteration(&[sum]);
        assert_eq!(film.counts().saturated, 0);
        assert!(film.variance()[0].is_finite());
    }

    #[test]
    fn it_follows_power_and_size() {
        let lamp = |size: f32, intensity: f32| {
            room(size, LightKind::Point { position: Vec3::ZERO, intensity: Rgb::splat(intensity) })
                .radiance_unit()
        };
        let unit = lamp(1.0, 1.0);
        // The ball of a unit cube's corners has a radius of √3: 4π / (4π² · 3), and the bounds' slack.
        assert_eq!(unit, -4);
        assert_eq!(lamp(1.0, 1024.0), unit + 10);
        assert_eq!(lamp(1024.0, 1.0), unit - 20);
        assert_eq!(lamp(1.0, 0.0), 0);
        let sky = room(7.0, LightKind::Constant { radiance: Rgb::splat(1e-9) }).radiance_unit();
        // log₂ 1e-9 = −29.9, whatever the size.
        assert_eq!(sky, -30);
    }
}
