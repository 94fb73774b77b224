//! Rooms with media in them, and what differs between two ways to render them.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::Method;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Boundary, Coefficient, Grid, GridValues, Medium, Phase};
use nephroid::shape::{Geometry, Shape};
use nephroid::world::World;
use std::ops::Range;

use crate::{Builder, session};

/// A medium on either side of a surface.
pub fn between(interior: Option<Handle<Medium>>, exterior: Option<Handle<Medium>>) -> Boundary {
    Boundary { interior, exterior, ..Boundary::default() }
}

/// A rectangle of half sides `half` around `center`, its normal turned from +z by `degrees` about `axis`.
pub fn facing(center: DVec3, half: f64, axis: DVec3, degrees: f64) -> Transform {
    Transform::scale(DVec3::splat(half))
        .then(Transform::rotate(axis, degrees))
        .then(Transform::translate(center))
}

/// The cube [-1, 1]³ scaled by `half` and moved to `center`.
pub fn boxed(center: DVec3, half: DVec3) -> Transform {
    Transform::scale(half).then(Transform::translate(center))
}

impl Builder {
    /// What light passes as if it were not there.
    pub fn null(&mut self) -> Handle<Material> {
        self.scene.materials.push(Material::Null)
    }

    /// A medium that is the same everywhere: extinction in 1/m.
    pub fn fog(&mut self, sigma_t: Rgb, albedo: Rgb, phase: Phase) -> Handle<Medium> {
        let name = format!("fog {}", self.scene.media.list.len());
        self.scene.media.list.push(Medium::homogeneous(name, sigma_t, albedo, phase))
    }

    /// A medium of extinction `values` on a grid of `n`³ cells, times `scale` in 1/m, placed by `to_world`
    /// from [0, 1]³.
    pub fn cloud(
        &mut self,
        n: u32,
        values: GridValues,
        scale: f32,
        albedo: Rgb,
        to_world: Transform,
    ) -> Handle<Medium> {
        let name = format!("cloud {}", self.scene.media.list.len());
        let grid = self.scene.media.grids.push(Grid { name: name.clone(), size: [n; 3], values });
        let medium = Medium {
            sigma_t: Coefficient::Grid { grid, to_world, scale },
            ..Medium::homogeneous(name, Rgb::BLACK, albedo, Phase::Isotropic)
        };
        self.scene.media.list.push(medium)
    }

    /// A surface that light passes, between two media.
    pub fn border(&mut self, geometry: Geometry, to_world: Transform, boundary: Boundary) -> &mut Shape {
        let null = self.null();
        let shape = self.shape(geometry, to_world, null);
        shape.boundary = boundary;
        shape
    }

    /// Five walls of [-1, 1]³, open towards +z.
    pub fn niche(&mut self, albedo: f32) {
        let wall = self.diffuse(albedo);
        for (center, axis, degrees) in [
            (DVec3::NEG_Y, DVec3::X, -90.0),
            (DVec3::Y, DVec3::X, 90.0),
            (DVec3::NEG_X, DVec3::Y, 90.0),
            (DVec3::X, DVec3::Y, -90.0),
            (DVec3::NEG_Z, DVec3::X, 0.0),
        ] {
            self.shape(Geometry::Rectangle, facing(center, 1.0, axis, degrees), wall);
        }
    }

    /// A lamp under the ceiling of a niche that shines down, of half side `half`.
    pub fn ceiling_lamp(&mut self, half: f64, radiance: f32) -> &mut Shape {
        let (black, glow) = (self.diffuse(0.0), self.constant(radiance));
        let to_world = facing(DVec3::new(0.0, 0.98, 0.0), half, DVec3::X, 90.0);
        let lamp = self.shape(Geometry::Rectangle, to_world, black);
        lamp.emission = Some(glow);
        lamp
    }

    /// Another unit of length: all of the scene `scale` times as large, and its media as much thinner.
    pub fn scaled(mut self, scale: f64) -> Self {
        let whole = Transform::scale(DVec3::splat(scale));
        for shape in &mut self.scene.shapes {
            shape.to_world = shape.to_world.then(whole);
        }
        self.scene.camera.to_world.0.translation *= scale;
        self.with_media(|medium| match &mut medium.sigma_t {
            Coefficient::Constant(sigma_t) => *sigma_t = *sigma_t / scale as f32,
            Coefficient::Grid { to_world, scale: factor, .. } => {
                *to_world = to_world.then(whole);
                *factor /= scale as f32;
            }
        })
    }

    /// With its media changed.
    pub fn with_media(mut self, change: impl Fn(&mut Medium)) -> Self {
        let media = std::mem::take(&mut self.scene.media.list);
        for medium in media.iter() {
            let mut medium = medium.clone();
            change(&mut medium);
            // In the same order, so that handles stay what they are.
            self.scene.media.list.push(medium);
        }
        self
    }

    /// A niche full of a medium behind a border in front, with a lamp in it and seen from outside.
    pub fn filled_niche(side: u32, lamp: f64, fill: impl FnOnce(&mut Self) -> Handle<Medium>) -> Self {
        let mut b = Self::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, side);
        b.niche(0.6);
        let medium = fill(&mut b);
        let front = facing(DVec3::Z, 1.0, DVec3::X, 0.0);
        b.border(Geometry::Rectangle, front, between(Some(medium), None));
        b.ceiling_lamp(lamp, (1.0 / (lamp * lamp)) as f32);
        b
    }
}

/// The means of square blocks of a picture and of the whole, channel by channel, one sample from each seed.
pub fn blocks(
    world: &World,
    method: &Method,
    samples_per_pixel: u32,
    seeds: Range<u64>,
    side: usize,
) -> Vec<Vec<f64>> {
    let width = world.scene().film.window().width as usize;
    let columns = width / side;
    let mut all = vec![Vec::new(); 3 * (columns * columns + 1)];
    for seed in seeds {
        let picture = session(world, method.clone(), samples_per_pixel, seed).film().develop();
        let mut sums = vec![0.0; all.len()];
        for (i, pixel) in picture.pixels.iter().enumerate() {
            let block = i / width / side * columns + i % width / side;
            for (channel, value) in pixel.to_array().into_iter().enumerate() {
                let value = f64::from(value);
                sums[3 * block + channel] += value / (side * side) as f64;
                sums[3 * columns * columns + channel] += value / (width * width) as f64;
            }
        }
        all.iter_mut().zip(sums).for_each(|(samples, sum)| samples.push(sum));
    }
    all
}
