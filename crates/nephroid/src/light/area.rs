use std::f32::consts::PI;

use super::aim::{Cones, Targets};
use super::emitter::{Emission, EmissionNumbers, Incident, Lookup, Source};
use super::extent::{Extent, NormalCone};
use super::tiles::Tiles;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Bounds, Frame, Ray, Vec2, Vec3, warp};
use crate::sampling::Discrete;
use crate::shape::{Primitive, Sphere, SurfacePoint};
use crate::texture::{Texture, Textures};

/// A surface that emits the same radiance in every direction of the side its normal points to.
#[derive(Clone, Debug)]
pub(crate) struct AreaEmitter {
    pieces: Vec<Primitive>,
    by_area: Discrete,
    area: f32,
    middle: Vec3,
    radiance: Handle<Texture>,
    /// Over the surface.
    mean_radiance: Rgb,
    /// Where a textured rectangle is bright.
    tiles: Option<Tiles>,
    flipped: bool,
    /// Its own index, if none of its light can meet it.
    convex: Option<u32>,
}

impl AreaEmitter {
    /// `None` if the pieces have no area.
    pub fn new(
        pieces: Vec<Primitive>,
        radiance: Handle<Texture>,
        flipped: bool,
        convex: Option<u32>,
        lookup: Lookup<'_>,
    ) -> Option<Self> {
        let by_area = Discrete::new(pieces.iter().map(|p| f64::from(p.area())))?;
        let area = by_area.total() as f32;
        let middle = pieces.iter().fold(Bounds::EMPTY, |all, piece| all.union(piece.bounds())).center();
        let tiles = match &pieces[..] {
            [Primitive::Flat(flat)] if flat.is_rectangle() => Tiles::new(lookup.textures, radiance),
            _ => None,
        };
        let mean_radiance = match (&lookup.textures.list[radiance], &tiles) {
            (Texture::Constant(value), _) => *value,
            (_, Some(tiles)) => tiles.mean,
            _ => mean_over(&pieces, radiance, lookup),
        };
        Some(Self { middle, pieces, by_area, area, radiance, mean_radiance, tiles, flipped, convex })
    }

    /// πAL with the mean radiance L, in W; exact for constant radiance.
    pub fn power(&self) -> Rgb {
        self.mean_radiance * (PI * self.area)
    }

    /// The radiance that a point of it gives off.
    pub fn radiance(&self, textures: &Textures, point: &SurfacePoint) -> Rgb {
        textures.eval(self.radiance, point.uv)
    }

    /// The largest radiance that is seen of it, of any channel.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        textures.brightest(self.radiance)
    }

    /// The centre of its bounds.
    pub fn middle(&self) -> Vec3 {
        self.middle
    }

    /// Where it is and where to it shines.
    pub fn extent(&self, lookup: Lookup<'_>, power: f32) -> Extent {
        let bounds = self.pieces.iter().fold(Bounds::EMPTY, |all, piece| all.union(piece.bounds()));
        let cone_of = |piece: &Primitive| match piece {
            Primitive::Sphere(_) | Primitive::Cylinder(_) => NormalCone::SPHERE,
            // A triangle's side may turn where its vertices have normals.
            Primitive::Flat(_) | Primitive::Triangle(_) => {
                let corner = |u| {
                    let point = piece.sample(u, lookup.meshes);
                    NormalCone::of_surface(if self.flipped { -point.ng } else { point.ng })
                };
                corner(Vec2::ZERO).union(corner(Vec2::X)).union(corner(Vec2::Y))
            }
        };
        let cones = self.pieces.iter().map(cone_of);
        Extent::new(bounds, cones.reduce(NormalCone::union).unwrap_or(NormalCone::SPHERE), power)
    }

    /// A point and its density over that of one uniform by area: by brightness where a rectangle has a texture.
    fn sample_point(&self, lookup: Lookup<'_>, u: Vec2) -> (SurfacePoint, f32) {
        let (piece, u, density) = match &self.tiles {
            Some(tiles) => {
                let (uv, density) = tiles.sample(u);
                (0, uv, density)
            }
            None => {
                let (piece, _, x) = self.by_area.sample(u.x);
                (piece, Vec2::new(x, u.y), 1.0)
            }
        };
        let point = self.pieces[piece].sample(u, lookup.meshes);
        (if self.flipped { point.flipped() } else { point }, density)
    }

    /// The sphere and 1 − cos of the cone it fills from `p`, if that is how `p` samples it: a sphere
    /// seen from outside that shines outward.
    fn cone(&self, p: Vec3) -> Option<(&Sphere, f32)> {
        match &self.pieces[..] {
            [Primitive::Sphere(sphere)] if !self.flipped => Some((sphere, sphere.cone_one_minus_cos(p)?)),
            _ => None,
        }
    }

    pub fn sample_incident(&self, lookup: Lookup<'_>, p: Vec3, u: Vec2) -> Option<Incident> {
        let ((point, density), cone) = match self.cone(p) {
            Some((sphere, width)) => ((sphere.sample_cone(p, width, u), 1.0), Some(width)),
            None => (self.sample_point(lookup, u), None),
        };
        let to_light = point.position - p;
        let wi = to_light.try_normalize()?;
        let cos = -wi.dot(point.ng);
        if cos <= 0.0 {
            return None;
        }
        let pdf_solid_angle = match cone {
            Some(width) => 1.0 / (2.0 * PI * width),
            None => density * to_light.length_squared() / (cos * self.area),
        };
        Some(Incident {
            wi,
            radiance: lookup.textures.eval(self.radiance, point.uv),
            pdf_solid_angle,
            dirac: false,
            source: Source::Surface(point),
        })
    }

    /// Density of the direction from `p` to a point of the surface, per unit solid angle.
    pub fn pdf_incident(&self, p: Vec3, point: &SurfacePoint) -> f32 {
        if let Some((_, width)) = self.cone(p) {
            return 1.0 / (2.0 * PI * width);
        }
        let to_light = point.position - p;
        let distance_sq = to_light.length_squared();
        let cos = to_light.dot(point.ng).abs() / distance_sq.sqrt();
        let density = self.tiles.as_ref().map_or(1.0, |tiles| tiles.density(point.uv));
        if cos > 0.0 { density * distance_sq / (cos * self.area) } else { 0.0 }
    }

    /// Uniform over the surface, or by its texture's brightness, and cosine-distributed about its normal or, as far as they are less than
    /// half of the hemisphere, uniform over the targets seen from there; `whole` is the power of the light.
    pub fn emit(
        &self,
        lookup: Lookup<'_>,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        whole: Rgb,
    ) -> Emission {
        if let (Some(targets), [Primitive::Sphere(sphere)], false) = (targets, &self.pieces[..], self.flipped)
        {
            let ball = (sphere.center, sphere.radius);
            if let Some(cones) = Cones::seen_from(targets, ball, self.convex, 2.0 * PI, |_, _| true) {
                return self.emit_from_ball(lookup, u, sphere, &cones, whole);
            }
        }
        let (point, density) = self.sample_point(lookup, u.position);
        let exitance = lookup.textures.eval(self.radiance, point.uv) * (PI * self.area / density);
        let above = |axis: Vec3, sin: f32| axis.dot(point.ng) > -sin;
        let cones = targets.and_then(|t| Cones::seen_from(t, (point.position, 0.0), self.convex, PI, above));
        let Some(cones) = cones else {
            let local = warp::square_to_cosine_hemisphere(u.direction);
            let direction = Frame::from_normal(point.ng).to_world(local);
            return Emission::whole(Ray::new(point.position, direction), Some(point), exitance);
        };
        match cones.sample(u.target, u.direction).filter(|direction| direction.dot(point.ng) > 0.0) {
            Some(direction) => Emission {
                ray: Ray::new(point.position, direction),
                surface: Some(point),
                power: exitance * (direction.dot(point.ng) / PI * cones.solid_angle()),
                emitted: exitance,
            },
            None => Emission::elsewhere(point.position, exitance),
        }
    }

    /// The direction first, and then a point of the half that faces it, uniform as seen along it: all
    /// points send the same, which points chosen first do not.
    fn emit_from_ball(
        &self,
        lookup: Lookup<'_>,
        u: EmissionNumbers,
        sphere: &Sphere,
        cones: &Cones,
        whole: Rgb,
    ) -> Emission {
        let Some(direction) = cones.sample(u.target, u.direction) else {
            return Emission::elsewhere(sphere.center, whole);
        };
        let normal = Frame::from_normal(direction).to_world(warp::square_to_cosine_hemisphere(u.position));
        let point = sphere.point(normal.normalize());
        Emission {
            ray: Ray::new(point.position, direction),
            surface: Some(point),
            power: lookup.textures.eval(self.radiance, point.uv) * (0.25 * self.area * cones.solid_angle()),
            emitted: whole,
        }
    }
}

/// The mean of a texture over a surface, by points of a grid on each piece.
fn mean_over(pieces: &[Primitive], texture: Handle<Texture>, lookup: Lookup<'_>) -> Rgb {
    // Some thousands in all, and on each at least four.
    let side = ((4096 / pieces.len()) as f32).sqrt().clamp(2.0, 64.0) as u32;
    let (mut sum, mut area) = ([0.0f64; 3], 0.0);
    for piece in pieces {
        let share = f64::from(piece.area()) / f64::from(side * side);
        for i in 0..side * side {
            let u = (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) / side as f32;
            let value = lookup.textures.eval(texture, piece.sample(u, lookup.meshes).uv).to_array();
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += share * f64::from(v));
            area += share;
        }
    }
    let mean = Rgb::from(sum.map(|s| (s / area) as f32));
    // Light that lies between all points is still light.
    if mean.is_black() { lookup.textures.mean(texture) } else { mean }
}
