use super::level::{Candidate, Item, Level, Other, Searcher};
use super::placed::Placed;
use super::{RayHit, Spot};
use crate::bvh::{Lanes, Simd, Work};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{Bounds, Ray, Vec2, Vec3};
use crate::scene::Scene;
use crate::shape::{Intersection, Mesh, Primitive, SurfacePoint, Triangle};

/// All surfaces of a scene, ready for rays.
#[derive(Clone, Debug)]
pub(super) struct Scenery {
    /// Those of the scene, each in the space of the scene or of its group.
    pub meshes: Arena<Mesh>,
    /// The mesh of each shape that is one; the shapes of groups follow those of the scene.
    pub mesh_of: Vec<Option<u32>>,
    /// What is no triangle.
    pub primitives: Vec<Primitive>,
    /// The shape that each of them is a piece of.
    pub owner: Vec<u32>,
    pub top: Level,
    pub groups: Vec<Level>,
    pub instances: Vec<Placed>,
    /// How many triangles and primitives there are, groups counted once.
    pub count: usize,
    pub simd: Simd,
}

impl Scenery {
    /// The nearest hit of those that `accept` lets count.
    #[inline]
    pub fn nearest(&self, ray: &Ray, accept: impl Fn(&RayHit) -> bool) -> Option<RayHit> {
        self.simd.run(Nearest { scenery: self, ray, accept })
    }

    /// Whether there is a hit that `accept` lets count.
    #[inline]
    pub fn any(&self, ray: &Ray, accept: impl Fn(&RayHit) -> bool) -> bool {
        self.simd.run(Any { scenery: self, ray, accept })
    }

    /// The surface at a hit of a ray, without regard to flipped normals.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &RayHit) -> SurfacePoint {
        match hit.instance {
            None => self.local_surface(ray, hit),
            Some(instance) => {
                let placed = &self.instances[instance as usize];
                placed.point(&self.local_surface(&placed.local(ray), hit))
            }
        }
    }

    #[inline]
    fn local_surface(&self, ray: &Ray, hit: &RayHit) -> SurfacePoint {
        let at = Intersection { t: hit.t, u: hit.u, v: hit.v };
        match self.mesh_of[hit.shape as usize] {
            Some(mesh) => {
                let triangle = Triangle::new(&self.meshes.as_slice()[mesh as usize], mesh, hit.primitive);
                triangle.surface(&self.meshes.as_slice()[mesh as usize], &at)
            }
            None => self.primitives[hit.primitive as usize].surface(ray, &at, self.meshes.as_slice()),
        }
    }

    /// The colour that a mesh has at a place on one of its triangles; white where it has none.
    pub fn color(&self, shape: u32, triangle: u32, at: Vec2) -> Rgb {
        self.mesh_of[shape as usize]
            .map_or(Rgb::WHITE, |mesh| self.meshes.as_slice()[mesh as usize].color(triangle, at.x, at.y))
    }

    /// How the position changes with the texture coordinates `uv` at a place of a shape.
    pub fn tangents(&self, shape: u32, spot: &Spot, uv: Vec2) -> [Vec3; 2] {
        let local = match self.mesh_of[shape as usize] {
            Some(mesh) => {
                let own = &self.meshes.as_slice()[mesh as usize];
                Triangle::new(own, mesh, spot.primitive).tangents(own)
            }
            None => {
                let primitive = &self.primitives[spot.primitive as usize];
                primitive.tangents((spot.u, spot.v), uv, self.meshes.as_slice())
            }
        };
        match spot.instance {
            None => local,
            Some(instance) => local.map(|v| self.instances[instance as usize].vector(v)),
        }
    }

    /// Some point of a shape, in the space of the scene or of its group, without regard to flipped normals.
    pub fn point_on(&self, shape: usize, u_piece: f32, u: Vec2) -> SurfacePoint {
        let pick = |n: usize| ((u_piece * n as f32) as usize).min(n - 1);
        if let Some(number) = self.mesh_of[shape] {
            let mesh = &self.meshes.as_slice()[number as usize];
            let index = pick(mesh.triangles.len()) as u32;
            return Triangle::new(mesh, number, index).sample(mesh, u);
        }
        let pieces = self.pieces(shape);
        pieces[pick(pieces.len())].sample(u, self.meshes.as_slice())
    }

    /// The primitives of a shape that is no mesh.
    pub fn pieces(&self, shape: usize) -> &[Primitive] {
        let first = self.owner.partition_point(|&owner| (owner as usize) < shape);
        let own = self.owner[first..].iter().take_while(|&&owner| owner as usize == shape).count();
        &self.primitives[first..first + own]
    }

    /// Bounds of a shape in the world, at all places where it is; `None` if it is infinite.
    pub fn bounds_of(&self, shape: usize, scene: &Scene) -> Option<Bounds> {
        let local = match self.mesh_of[shape] {
            Some(mesh) => Bounds::of(self.meshes.as_slice()[mesh as usize].positions.iter().copied()),
            None => self.pieces(shape).iter().try_fold(Bounds::EMPTY, |bounds, piece| {
                let own = piece.bounds();
                (!own.is_empty()).then(|| bounds.union(own))
            })?,
        };
        let Some(mut number) = shape.checked_sub(scene.shapes.len()) else { return Some(local) };
        let group = scene.groups.iter().position(|group| {
            let own = number < group.shapes.len();
            number -= if own { 0 } else { group.shapes.len() };
            own
        })?;
        let places = self.instances.iter().filter(|placed| placed.group as usize == group);
        Some(places.fold(Bounds::EMPTY, |bounds, placed| bounds.union(placed.bounds(local))))
    }

    /// Bounds of what is finite; empty if nothing is.
    pub fn bounds(&self) -> Bounds {
        self.top.bounds
    }

    /// Bytes of the trees and their leaves.
    pub fn bytes(&self) -> usize {
        self.top.bytes() + self.groups.iter().map(Level::bytes).sum::<usize>()
    }
}

struct Nearest<'a, A> {
    scenery: &'a Scenery,
    ray: &'a Ray,
    accept: A,
}

impl<A: Fn(&RayHit) -> bool> Work for Nearest<'_, A> {
    type Output = Option<RayHit>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<RayHit> {
        let mut nearest = None;
        let keep = |hit: RayHit| {
            let counts = (self.accept)(&hit);
            if counts {
                nearest = Some(hit);
            }
            counts
        };
        search::<L, false>(self.scenery, self.ray, keep);
        nearest
    }
}

struct Any<'a, A> {
    scenery: &'a Scenery,
    ray: &'a Ray,
    accept: A,
}

impl<A: Fn(&RayHit) -> bool> Work for Any<'_, A> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        search::<L, true>(self.scenery, self.ray, |hit| (self.accept)(&hit))
    }
}

#[inline(always)]
fn search<L: Lanes, const ANY: bool>(
    scenery: &Scenery,
    ray: &Ray,
    offer: impl FnMut(RayHit) -> bool,
) -> bool {
    let mut t_max = ray.t_max;
    let mut outside = Outside { scenery, ray, offer };
    scenery.top.search::<L, ANY>(&scenery.primitives, ray, &mut t_max, &mut outside)
}

impl Scenery {
    #[inline(always)]
    fn hit(&self, candidate: Candidate, instance: Option<u32>) -> RayHit {
        let Candidate { t, u, v, piece } = candidate;
        let (shape, primitive) = match piece {
            Item::Triangle { shape, index } => (shape, index),
            Item::Other(Other::Primitive(p) | Other::Instance(p)) => (self.owner[p as usize], p),
        };
        RayHit { t, u, v, shape, primitive, instance }
    }
}

/// Searches the scene.
struct Outside<'a, O> {
    scenery: &'a Scenery,
    ray: &'a Ray,
    offer: O,
}

impl<O: FnMut(RayHit) -> bool> Searcher for Outside<'_, O> {
    #[inline(always)]
    fn offer(&mut self, candidate: Candidate) -> bool {
        (self.offer)(self.scenery.hit(candidate, None))
    }

    #[inline(always)]
    fn instance<L: Lanes, const ANY: bool>(&mut self, number: u32, t_max: &mut f32) -> bool {
        let scenery = self.scenery;
        let placed = &scenery.instances[number as usize];
        let ray = placed.local(self.ray);
        let mut inside = Inside { scenery, instance: number, offer: &mut self.offer };
        scenery.groups[placed.group as usize].search::<L, ANY>(&scenery.primitives, &ray, t_max, &mut inside)
    }
}

/// Searches a group; there are none in groups.
struct Inside<'a, O> {
    scenery: &'a Scenery,
    instance: u32,
    offer: &'a mut O,
}

impl<O: FnMut(RayHit) -> bool> Searcher for Inside<'_, O> {
    #[inline(always)]
    fn offer(&mut self, candidate: Candidate) -> bool {
        (self.offer)(self.scenery.hit(candidate, Some(self.instance)))
    }

    #[inline(always)]
    fn instance<L: Lanes, const ANY: bool>(&mut self, _: u32, _: &mut f32) -> bool {
        false
    }
}
