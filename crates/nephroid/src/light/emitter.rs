use std::f32::consts::PI;

use super::aim::{Cones, Disks, Targets};
use super::area::AreaEmitter;
use super::environment::{ConstantSky, EnvironmentMap, Sun};
use super::extent::{Extent, NormalCone};
use super::glow::Glow;
use super::goniometric::Goniometric;
use super::projector::Projector;
use super::spot::Spot;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Frame, Ray, Vec2, Vec3, warp};
use crate::medium::Medium;
use crate::shape::{Mesh, SurfacePoint};
use crate::texture::Textures;

/// Light arriving at a point, as sampled from an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Radiance in W/(m²·sr); for a Dirac light irradiance on a surface facing it, in W/m².
    pub radiance: Rgb,
    /// Density of `wi` per unit solid angle; 1 for a Dirac light.
    pub pdf_solid_angle: f32,
    /// Whether only this direction could have been sampled.
    pub dirac: bool,
    /// Where it comes from.
    pub source: Source,
}

/// Where sampled light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Infinitely far away.
    Infinity,
    /// A point without a surface.
    Point(Vec3),
    /// A point of a surface.
    Surface(SurfacePoint),
}

/// The start of a photon path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// From the light.
    pub ray: Ray,
    /// The point of an area light that the path must be moved off.
    pub surface: Option<SurfacePoint>,
    /// Emitted power over the density of the sample, in W: its mean is what the emitter sends where it
    /// was aimed. Black where nothing starts.
    pub power: Rgb,
    /// What the sample stands for of all that the emitter gives off, in W. The mean of what it exceeds
    /// `power` by is what goes elsewhere; where nothing was aimed they are the same.
    pub emitted: Rgb,
}

impl Emission {
    /// One that was not aimed.
    pub(super) fn whole(ray: Ray, surface: Option<SurfacePoint>, power: Rgb) -> Self {
        Self { ray, surface, power, emitted: power }
    }

    /// One that falls to no target, or whose direction has had its turn.
    pub(super) fn elsewhere(origin: Vec3, emitted: Rgb) -> Self {
        Self { ray: Ray::new(origin, Vec3::Z), surface: None, power: Rgb::BLACK, emitted }
    }
}

/// The random numbers of an emission.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmissionNumbers {
    pub position: Vec2,
    pub direction: Vec2,
    /// For the choice among targets.
    pub target: f32,
}

/// What emitters look up: meshes in world space and textures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lookup<'a> {
    pub meshes: &'a [Mesh],
    pub textures: &'a Textures,
}

/// How directions over the whole sphere are sampled (the report's §2.1.1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SphereSampling {
    /// By the inverse of the distribution: two numbers, always accepted.
    #[default]
    SolidAngle,
    /// A point of the cube, rejected until it lies in the ball, and normalised. Slower; the ground
    /// truth that the other was once checked against.
    Rejection,
}

/// A light of the world.
#[derive(Clone, Debug)]
pub(crate) struct Emitter {
    pub name: String,
    pub kind: EmitterKind,
    /// W; what photons carry in the mean.
    pub power: Rgb,
}

#[derive(Clone, Debug)]
pub(crate) enum EmitterKind {
    Area(AreaEmitter),
    Point {
        position: Vec3,
        intensity: Rgb,
    },
    Spot(Spot),
    Goniometric(Box<Goniometric>),
    Projector(Box<Projector>),
    Directional {
        direction: Vec3,
        irradiance: Rgb,
        target: Target,
    },
    Constant(ConstantSky),
    Environment(EnvironmentMap),
    Sun(Sun),
    /// A medium that gives off light: paths and camera rays find it on their way, photons start in it.
    Medium(Box<Glow>),
}

/// The sphere at which light from infinitely far away is aimed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Target {
    pub center: Vec3,
    pub radius: f32,
}

impl Target {
    /// Area of its silhouette, m².
    pub fn silhouette(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// A ray along `direction` through a point, from before the sphere.
    pub fn ray_through(&self, point: Vec3, direction: Vec3) -> Ray {
        let back = (point - self.center).dot(direction) + self.radius;
        Ray::new(point - direction * back, direction)
    }

    /// Starts light of an infinitely far emitter along `direction`, with `flux` (W/m²) on a plane facing
    /// it: aimed where targets cover less than the sphere does.
    pub fn emit(
        &self,
        direction: Vec3,
        flux: Rgb,
        u: EmissionNumbers,
        targets: Option<&Targets>,
    ) -> Emission {
        let whole = flux * self.silhouette();
        let Some(disks) = targets.and_then(|targets| Disks::new(targets, self.radius)) else {
            return Emission::whole(self.ray(direction, u.position), None, whole);
        };
        match disks.sample(direction, u.target, u.position) {
            Some(point) => Emission {
                ray: self.ray_through(point, direction),
                surface: None,
                power: flux * disks.area(),
                emitted: whole,
            },
            None => Emission::elsewhere(self.center, whole),
        }
    }

    /// Whether light along `direction` that starts at the disk before the sphere may come by a point.
    fn is_before(&self, point: Vec3, direction: Vec3) -> bool {
        (point - self.center).cross(direction).length_squared() <= self.radius * self.radius
    }

    /// A ray along `direction` from a point of the disk before the sphere, uniformly by area.
    pub fn ray(&self, direction: Vec3, u: Vec2) -> Ray {
        let frame = Frame::from_normal(direction);
        let disk = warp::square_to_disk(u) * self.radius;
        Ray::new(self.center + frame.to_world(Vec3::new(disk.x, disk.y, -self.radius)), direction)
    }
}

impl Emitter {
    /// Samples light arriving at `p`. `None` if none can.
    pub fn sample_incident(&self, lookup: Lookup<'_>, p: Vec3, u: Vec2) -> Option<Incident> {
        match &self.kind {
            EmitterKind::Area(area) => area.sample_incident(lookup, p, u),
            EmitterKind::Point { position, intensity } => from_point(*position, p, |_| *intensity),
            EmitterKind::Spot(spot) => {
                from_point(spot.position, p, |direction| spot.intensity(lookup.textures, direction))
            }
            EmitterKind::Goniometric(lamp) => {
                from_point(lamp.position, p, |direction| lamp.intensity(lookup.textures, direction))
            }
            EmitterKind::Projector(lamp) => {
                from_point(lamp.position, p, |direction| lamp.intensity(lookup.textures, direction))
            }
            EmitterKind::Directional { direction, irradiance, .. } => {
                dirac(-*direction, *irradiance, Source::Infinity)
            }
            EmitterKind::Constant(sky) => Some(sky.sample_incident(u)),
            EmitterKind::Environment(map) => map.sample_incident(lookup.textures, u),
            EmitterKind::Sun(sun) => Some(sun.sample_incident(u)),
            EmitterKind::Medium(_) => None,
        }
    }

    /// Density per unit solid angle with which [`Self::sample_incident`] at `p` gives the direction
    /// to a point of this area light.
    pub fn pdf_of_surface(&self, p: Vec3, point: &SurfacePoint) -> f32 {
        match &self.kind {
            EmitterKind::Area(area) => area.pdf_incident(p, point),
            _ => 0.0,
        }
    }

    /// The same for a direction that meets nothing.
    pub fn pdf_of_sky(&self, direction: Vec3) -> f32 {
        match &self.kind {
            EmitterKind::Constant(_) => warp::SPHERE_PDF,
            EmitterKind::Environment(map) => map.pdf(direction),
            EmitterKind::Sun(sun) => sun.pdf(direction),
            _ => 0.0,
        }
    }

    /// Radiance that a ray along `direction` which meets nothing sees of this light.
    pub fn sky_radiance(&self, textures: &Textures, direction: Vec3) -> Rgb {
        match &self.kind {
            EmitterKind::Constant(sky) => sky.radiance,
            EmitterKind::Environment(map) => map.radiance(textures, direction),
            EmitterKind::Sun(sun) => sun.radiance(direction),
            _ => Rgb::BLACK,
        }
    }

    /// Radiance that a point of its surface gives off on its side, if it is one that has points.
    pub fn surface_radiance(&self, textures: &Textures, point: &SurfacePoint) -> Option<Rgb> {
        if let EmitterKind::Area(area) = &self.kind { Some(area.radiance(textures, point)) } else { None }
    }

    /// The largest radiance that cameras see of its surface or sky, of any channel; 0 if it has neither.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        match &self.kind {
            EmitterKind::Area(area) => area.brightest(textures),
            EmitterKind::Constant(sky) => sky.radiance.max_channel(),
            EmitterKind::Environment(map) => map.brightest(textures),
            EmitterKind::Sun(sun) => sun.brightest(),
            EmitterKind::Point { .. }
            | EmitterKind::Spot(_)
            | EmitterKind::Goniometric(_)
            | EmitterKind::Projector(_)
            | EmitterKind::Directional { .. }
            | EmitterKind::Medium(_) => 0.0,
        }
    }

    /// A point in the midst of it; `None` if it is infinitely far away.
    pub fn middle(&self) -> Option<Vec3> {
        match &self.kind {
            EmitterKind::Area(area) => Some(area.middle()),
            EmitterKind::Point { position, .. } => Some(*position),
            EmitterKind::Spot(spot) => Some(spot.position),
            EmitterKind::Goniometric(lamp) => Some(lamp.position),
            EmitterKind::Projector(lamp) => Some(lamp.position),
            EmitterKind::Medium(glow) => Some(glow.middle()),
            EmitterKind::Directional { .. }
            | EmitterKind::Constant(_)
            | EmitterKind::Environment(_)
            | EmitterKind::Sun(_) => None,
        }
    }

    /// Where it is and where to it shines; `None` if it is infinitely far away, or cannot be asked for light.
    pub fn extent(&self, lookup: Lookup<'_>) -> Option<Extent> {
        let power = self.power.mean();
        let point = |position, cone| Some(Extent::of_point(position, cone, power));
        match &self.kind {
            EmitterKind::Area(area) => Some(area.extent(lookup, power)),
            EmitterKind::Point { position, .. } => point(*position, NormalCone::SPHERE),
            EmitterKind::Spot(spot) => point(spot.position, spot.beam()),
            EmitterKind::Goniometric(lamp) => point(lamp.position, NormalCone::SPHERE),
            EmitterKind::Projector(lamp) => point(lamp.position, lamp.beam()),
            EmitterKind::Directional { .. }
            | EmitterKind::Constant(_)
            | EmitterKind::Environment(_)
            | EmitterKind::Sun(_)
            | EmitterKind::Medium(_) => None,
        }
    }

    /// The medium that it is.
    pub fn medium(&self) -> Option<Handle<Medium>> {
        if let EmitterKind::Medium(glow) = &self.kind { Some(glow.medium()) } else { None }
    }

    /// The part of a ray up to `end` that its light can fall on; `None` if there is none.
    pub fn lit_part(&self, ray: &Ray, end: f32) -> Option<[f32; 2]> {
        match &self.kind {
            EmitterKind::Spot(spot) => spot.lit_part(ray, end),
            _ => Some([0.0, end]),
        }
    }

    /// Whether it has no extent: light from it comes to a point from one direction.
    pub fn is_dirac(&self) -> bool {
        matches!(
            self.kind,
            EmitterKind::Point { .. }
                | EmitterKind::Spot(_)
                | EmitterKind::Goniometric(_)
                | EmitterKind::Projector(_)
                | EmitterKind::Directional { .. }
        )
    }

    /// Whether rays that meet nothing see it.
    pub fn is_sky(&self) -> bool {
        matches!(self.kind, EmitterKind::Constant(_) | EmitterKind::Environment(_) | EmitterKind::Sun(_))
    }

    /// Whether it is a sky of which most directions bring some: where a sun alone shines, rays by chance find nothing that
    /// asking for it does not.
    pub fn is_wide_sky(&self) -> bool {
        self.is_sky() && !matches!(self.kind, EmitterKind::Sun(_))
    }

    /// Whether its light comes from infinitely far away.
    pub fn is_infinite(&self) -> bool {
        self.is_sky() || matches!(self.kind, EmitterKind::Directional { .. })
    }

    /// Whether photons along `direction` may come by a point: those from infinitely far away are sent at what of the scene
    /// is finite, and pass most of an endless plane by.
    pub fn sends_by(&self, point: Vec3, direction: Vec3) -> bool {
        match &self.kind {
            EmitterKind::Directional { target, .. } => target.is_before(point, direction),
            EmitterKind::Constant(sky) => sky.target.is_before(point, direction),
            EmitterKind::Environment(map) => map.target.is_before(point, direction),
            EmitterKind::Sun(sun) => sun.target.is_before(point, direction),
            EmitterKind::Area(_)
            | EmitterKind::Point { .. }
            | EmitterKind::Spot(_)
            | EmitterKind::Goniometric(_)
            | EmitterKind::Projector(_)
            | EmitterKind::Medium(_) => true,
        }
    }

    /// Starts a photon path, at the targets if it is aimed and they fill less than half of what it
    /// shines at. `sphere` gives directions for lights that shine everywhere.
    pub fn emit(
        &self,
        lookup: Lookup<'_>,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        sphere: impl FnOnce(Vec2) -> Vec3,
    ) -> Emission {
        match &self.kind {
            EmitterKind::Area(area) => area.emit(lookup, u, targets, self.power),
            EmitterKind::Point { position, intensity } => {
                let cones =
                    targets.and_then(|t| Cones::seen_from(t, (*position, 0.0), None, 2.0 * PI, |_, _| true));
                let Some(cones) = cones else {
                    return Emission::whole(Ray::new(*position, sphere(u.direction)), None, self.power);
                };
                cones.emit(*position, u, self.power, |_| *intensity)
            }
            EmitterKind::Spot(spot) => spot.emit(lookup.textures, u, targets, self.power),
            EmitterKind::Goniometric(lamp) => lamp.emit(lookup.textures, u, targets, self.power),
            EmitterKind::Projector(lamp) => lamp.emit(lookup.textures, u, targets, self.power),
            EmitterKind::Directional { direction, irradiance, target } => {
                target.emit(*direction, *irradiance, u, targets)
            }
            EmitterKind::Constant(sky) => sky.emit(u, targets, sphere(u.direction)),
            EmitterKind::Environment(map) => map.emit(lookup.textures, u, targets),
            EmitterKind::Sun(sun) => sun.emit(u, targets),
            EmitterKind::Medium(glow) => glow.emit(u, sphere),
        }
    }
}

/// Light at `p` of a point with an intensity in the direction in which it leaves.
fn from_point(position: Vec3, p: Vec3, intensity: impl FnOnce(Vec3) -> Rgb) -> Option<Incident> {
    let to_light = position - p;
    let wi = to_light.try_normalize()?;
    dirac(wi, intensity(-wi) / to_light.length_squared(), Source::Point(position))
}

fn dirac(wi: Vec3, irradiance: Rgb, source: Source) -> Option<Incident> {
    (!irradiance.is_black() && irradiance.is_finite()).then_some(Incident {
        wi,
        radiance: irradiance,
        pdf_solid_angle: 1.0,
        dirac: true,
        source,
    })
}
