use super::cylinder::Cylinder;
use super::flat::{Flat, Region};
use super::triangle::Triangle;
use super::{Geometry, Intersection, Mesh, Shape, ShearedRay, Sphere, SurfacePoint};
use crate::math::{Bounds, Ray, Vec2, Vec3, offset_origin};

/// A piece of a shape in world space: what rays are tested against.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Primitive {
    Sphere(Sphere),
    Flat(Flat),
    Cylinder(Cylinder),
    Triangle(Triangle),
}

impl Primitive {
    /// The pieces of a shape that is no mesh. `None` if it has no proper size.
    pub fn of_shape(shape: &Shape) -> Option<Vec<Self>> {
        let to_world = &shape.to_world;
        let pieces = match shape.geometry {
            Geometry::Sphere { center, radius } => vec![Self::Sphere(Sphere::new(to_world, center, radius)?)],
            Geometry::Cylinder { p0, p1, radius } => {
                vec![Self::Cylinder(Cylinder::new(to_world, p0, p1, radius)?)]
            }
            Geometry::Rectangle => vec![Self::Flat(Flat::new(to_world, Region::Square)?)],
            Geometry::Disk => vec![Self::Flat(Flat::new(to_world, Region::Disk)?)],
            Geometry::Plane => vec![Self::Flat(Flat::new(to_world, Region::Plane)?)],
            Geometry::Cube => (0..6)
                .map(|face| Flat::cube_face(to_world, face / 2, face % 2 == 1).map(Self::Flat))
                .collect::<Option<_>>()?,
            Geometry::Mesh(_) => return None,
        };
        Some(pieces)
    }

    #[inline]
    pub fn intersect(&self, ray: &Ray, sheared: &ShearedRay) -> Option<Intersection> {
        match self {
            Self::Sphere(s) => s.intersect(ray),
            Self::Flat(f) => f.intersect(ray),
            Self::Cylinder(c) => c.intersect(ray),
            Self::Triangle(t) => t.intersect(ray, sheared),
        }
    }

    /// Where a ray meets a curved primitive again, beyond a hit.
    #[cold]
    pub fn beyond(&self, ray: &Ray, hit: &Intersection, sheared: &ShearedRay) -> Option<Intersection> {
        let point = match self {
            Self::Sphere(s) => s.surface(ray, hit),
            Self::Cylinder(c) => c.surface(ray, hit),
            Self::Flat(_) | Self::Triangle(_) => return None,
        };
        let origin = offset_origin(point.position, point.error, point.ng, ray.direction);
        let onward = Ray { origin, t_max: ray.t_max - hit.t, ..*ray };
        let far = self.intersect(&onward, sheared)?;
        let t = hit.t + far.t;
        (t < ray.t_max).then_some(Intersection { t, ..far })
    }

    /// The surface at a hit.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Intersection, meshes: &[Mesh]) -> SurfacePoint {
        match self {
            Self::Sphere(s) => s.surface(ray, hit),
            Self::Flat(f) => f.surface(hit),
            Self::Cylinder(c) => c.surface(ray, hit),
            Self::Triangle(t) => t.surface(&meshes[t.mesh as usize], hit),
        }
    }

    /// How the position changes with the texture coordinates `uv` of a hit, which has the coordinates `u` and `v`.
    pub fn tangents(&self, (u, v): (f32, f32), uv: Vec2, meshes: &[Mesh]) -> [Vec3; 2] {
        match self {
            Self::Sphere(s) => s.tangents(uv),
            Self::Flat(f) => f.tangents(u, v),
            Self::Cylinder(c) => c.tangents(uv),
            Self::Triangle(t) => t.tangents(&meshes[t.mesh as usize]),
        }
    }

    /// Empty for an infinite plane.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Sphere(s) => s.bounds(),
            Self::Flat(f) => f.bounds(),
            Self::Cylinder(c) => c.bounds(),
            Self::Triangle(t) => t.bounds(),
        }
    }

    /// Area in m²; infinite for a plane.
    pub fn area(&self) -> f32 {
        match self {
            Self::Sphere(s) => s.area(),
            Self::Flat(f) => f.area(),
            Self::Cylinder(c) => c.area(),
            Self::Triangle(t) => t.area(),
        }
    }

    /// A point uniformly by area.
    pub fn sample(&self, u: Vec2, meshes: &[Mesh]) -> SurfacePoint {
        match self {
            Self::Sphere(s) => s.sample(u),
            Self::Flat(f) => f.sample(u),
            Self::Cylinder(c) => c.sample(u),
            Self::Triangle(t) => t.sample(&meshes[t.mesh as usize], u),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::handle::Arena;
    use crate::material::Material;
    use crate::math::{DVec3, Transform, offset_origin, warp};
    use crate::sampling::{Key, Sampler, Sequence, Stream};
    use crate::texture::Textures;

    fn shape(geometry: Geometry, to_world: Transform) -> Shape {
        let mut textures = Textures::default();
        let reflectance = textures.constant(Rgb::WHITE);
        let material = Arena::default().push(Material::Diffuse { reflectance });
        Shape { to_world, ..Shape::new("", geometry, material) }
    }

    fn pieces(shape: &Shape, meshes: &[Mesh]) -> Vec<Primitive> {
        Primitive::of_shape(shape).unwrap_or_else(|| {
            let n = meshes[0].triangles.len() as u32;
            (0..n).map(|i| Primitive::Triangle(Triangle::new(&meshes[0], 0, i))).collect()
        })
    }

    fn octahedron() -> Mesh {
        let positions = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let triangles =
            vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        Mesh { positions, triangles, ..Mesh::default() }
    }

    /// One shape of each kind, at two places and sizes.
    fn all() -> Vec<(Vec<Primitive>, Vec<Mesh>)> {
        let geometries = [
            Geometry::Sphere { center: Vec3::new(0.2, 0.0, 0.1), radius: 0.7 },
            Geometry::Cylinder { p0: Vec3::ZERO, p1: Vec3::new(0.2, 0.9, 0.1), radius: 0.4 },
            Geometry::Rectangle,
            Geometry::Disk,
            Geometry::Cube,
            Geometry::Mesh(Arena::default().push(octahedron())),
        ];
        let places = [
            Transform::IDENTITY,
            Transform::scale(DVec3::splat(300.0))
                .then(Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 33.0))
                .then(Transform::translate(DVec3::new(1000.0, -2000.0, 500.0))),
            Transform::scale(DVec3::splat(1e-3)).then(Transform::translate(DVec3::new(0.5, 0.25, 0.0))),
        ];
        let mut list = Vec::new();
        for geometry in &geometries {
            for place in places {
                let mut mesh = octahedron();
                for p in &mut mesh.positions {
                    *p = place.point(*p);
                }
                let meshes = vec![mesh];
                list.push((pieces(&shape(geometry.clone(), place), &meshes), meshes));
            }
        }
        list
    }

    fn sampler(i: u64) -> Sampler {
        Sampler::new(Sequence::Independent, Key::new(9, 0, Stream::Camera), i)
    }

    #[test]
    fn sampled_points_lie_on_the_surface_within_their_error() {
        for (pieces, meshes) in all() {
            for i in 0..500 {
                let mut s = sampler(i);
                let piece = pieces[i as usize % pieces.len()];
                let point = piece.sample(s.next_2d(), &meshes);
                // A ray towards the point along the normal from outside meets it where it says.
                let size = piece.bounds().extent().max_element();
                let ray = Ray::new(point.position + point.ng * (0.3 * size), -point.ng);
                let hit = piece.intersect(&ray, &ShearedRay::new(ray.direction));
                let Some(hit) = hit else { panic!("{piece:?} missed at {point:?}") };
                let found = piece.surface(&ray, &hit, &meshes);
                let slack = point.error * 4.0 + Vec3::splat(size * 1e-4);
                assert!((found.position - point.position).abs().cmple(slack).all(), "{found:?} {point:?}");
                assert!(found.ng.dot(point.ng) > 0.999);
            }
        }
    }

    /// Item 44 of the report: a ray that leaves a surface must not meet it where it starts.
    #[test]
    fn rays_that_leave_a_surface_never_meet_it_at_their_start() {
        for (pieces, meshes) in all() {
            for i in 0..2000 {
                let mut s = sampler(i);
                let piece = pieces[i as usize % pieces.len()];
                let point = piece.sample(s.next_2d(), &meshes);
                let direction = warp::square_to_sphere(s.next_2d());
                let origin = offset_origin(point.position, point.error, point.ng, direction);
                let ray = Ray::new(origin, direction);
                let size = piece.bounds().extent().max_element();
                if let Some(hit) = piece.intersect(&ray, &ShearedRay::new(direction)) {
                    let cos = direction.dot(point.ng).abs();
                    assert!(hit.t > 1e-3 * size * cos, "{piece:?} met itself at {} of {size}", hit.t);
                }
            }
        }
    }

    #[test]
    fn areas_agree_with_the_chance_of_a_random_line() {
        // Cauchy: a convex body of area A in a ball of radius R is met by a random line with
        // probability A / (4πR²). Only the closed bodies; 5 standard errors.
        for (pieces, _) in all().iter().filter(|(p, _)| p.len() >= 6 || matches!(p[0], Primitive::Sphere(_)))
        {
            let bounds = pieces.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds()));
            let (center, radius) = bounds.bounding_sphere();
            let area: f32 = pieces.iter().map(Primitive::area).sum();
            let n = 40_000;
            let mut hits = 0;
            for i in 0..n {
                let mut s = sampler(i);
                let frame = crate::math::Frame::from_normal(warp::square_to_sphere(s.next_2d()));
                let disk = warp::square_to_disk(s.next_2d()) * radius;
                let origin = center + frame.to_world(Vec3::new(disk.x, disk.y, -2.0 * radius));
                let ray = Ray::new(origin, frame.n);
                let sheared = ShearedRay::new(frame.n);
                hits += u32::from(pieces.iter().any(|p| p.intersect(&ray, &sheared).is_some()));
            }
            let expected = f64::from(area / (4.0 * std::f32::consts::PI * radius * radius));
            let error = (expected * (1.0 - expected) / n as f64).sqrt();
            assert!((f64::from(hits) / n as f64 - expected).abs() < 5.0 * error);
        }
    }

    #[test]
    fn rays_at_edges_and_vertices_of_a_closed_mesh_all_hit() {
        let meshes = [octahedron()];
        let geometry = Geometry::Mesh(Arena::default().push(octahedron()));
        let pieces = pieces(&shape(geometry, Transform::IDENTITY), &meshes);
        for i in 0..100_000u64 {
            let mut s = sampler(i);
            let origin = warp::square_to_sphere(s.next_2d()) * 0.3;
            let corners = meshes[0].triangles[(i % 8) as usize].map(|c| meshes[0].positions[c as usize]);
            let a = s.next_1d();
            let target = if i % 3 == 0 { corners[0] } else { corners[0] * a + corners[1] * (1.0 - a) };
            let ray = Ray::new(origin, (target - origin).normalize());
            let sheared = ShearedRay::new(ray.direction);
            assert!(pieces.iter().any(|p| p.intersect(&ray, &sheared).is_some()), "leak at {target}");
        }
    }
}
