//! Rays a second beside Embree: a closed box with a bumpy ball, as one mesh.
//!
//! `EMBREE_LIB=… cargo run --release --manifest-path bench/Cargo.toml --bin rays`, with
//! `-- small` for the smaller of both alone.

use std::hint::black_box;

use nephroid::camera::{Camera, Projection};
use nephroid::color::Rgb;
use nephroid::film::{FilmSettings, Filter};
use nephroid::handle::Arena;
use nephroid::material::Material;
use nephroid::math::{Ray, Transform, Vec2, Vec3, offset_origin, warp};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::Textures;
use nephroid::world::World;
use nephroid_bench::embree::{Embree, EmbreeScene, Mode, NONE, RayHit};
use nephroid_bench::{cpu_time, rounds};

/// Rows and columns of the balls.
const SIZES: [(u32, u32); 2] = [(132, 266), (500, 1_001)];

const SIDE: u32 = 512;
const ROUNDS: usize = 5;

fn main() -> Result<(), String> {
    let embree = Embree::load()?;
    let sizes: &[_] = if std::env::args().any(|a| a == "small") { &SIZES[..1] } else { &SIZES };
    for &(rows, columns) in sizes {
        compare(&embree, &box_and_ball(rows, columns));
    }
    cornell();
    Ok(())
}

fn compare(embree: &Embree, mesh: &Mesh) {
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(Vec3::to_array).collect();
    let n = mesh.triangles.len();
    println!("{n} triangles");
    let ours = || World::new(scene(vec![mesh.clone()])).expect("a sound scene");
    let copy = cpu_time(|| drop(black_box(scene(vec![mesh.clone()])))).as_secs_f64();
    let build = rounds(
        3,
        &mut [&mut || drop(black_box(embree.build(&positions, &mesh.triangles, Mode::Medium))), &mut || {
            drop(black_box(ours()))
        }],
    );
    println!(
        "  build, CPU s: Embree {:.3}, ours {:.3} (ratio {:.2}; {copy:.3} of it copies the mesh)",
        build[0],
        build[1],
        build[1] / build[0]
    );
    let world = ours();
    println!("  bytes a triangle: {:.1}", world.tree_bytes() as f64 / n as f64);
    let medium = embree.build(&positions, &mesh.triangles, Mode::Medium);
    let robust = embree.build(&positions, &mesh.triangles, Mode::Robust);

    let primary = primary();
    let (bounces, shadows) = secondary(&world, &primary);
    println!("  Mray/CPU s           Embree  ROBUST (ratio)   ours (ratio)  (to ROBUST)");
    for (name, rays) in
        [("primary", &primary), ("bounce, in order", &bounces), ("bounce, shuffled", &shuffled(&bounces))]
    {
        nearest(name, rays, &world, &medium, &robust);
    }
    for (name, rays) in [("any hit, in order", &shadows), ("any hit, shuffled", &shuffled(&shadows))] {
        any(name, rays, &world, &medium, &robust);
    }
}

fn embree_ray(ray: &Ray) -> RayHit {
    RayHit::new(ray.origin.to_array(), ray.direction.to_array(), ray.t_max)
}

fn nearest(name: &str, rays: &[Ray], world: &World, medium: &EmbreeScene, robust: &EmbreeScene) {
    let with = |scene: &EmbreeScene, out: &mut (u32, f64)| {
        *out = (0, 0.0);
        for ray in rays {
            let mut r = embree_ray(ray);
            scene.intersect(&mut r);
            if r.geometry != NONE {
                *out = (out.0 + 1, out.1 + f64::from(r.far));
            }
        }
    };
    let (mut a, mut b, mut c) = ((0, 0.0), (0, 0.0), (0, 0.0));
    let times = rounds(
        ROUNDS,
        &mut [&mut || with(medium, &mut a), &mut || with(robust, &mut b), &mut || {
            c = (0, 0.0);
            for ray in rays {
                if let Some(hit) = world.nearest(ray) {
                    c = (c.0 + 1, c.1 + f64::from(hit.t));
                }
            }
        }],
    );
    row(name, rays.len(), &times);
    let mean = |(n, sum): (u32, f64)| sum / f64::from(n);
    println!("      hits {} {} {}, mean t {:.6} {:.6} {:.6}", a.0, b.0, c.0, mean(a), mean(b), mean(c));
}

fn any(name: &str, rays: &[Ray], world: &World, medium: &EmbreeScene, robust: &EmbreeScene) {
    let with = |scene: &EmbreeScene, out: &mut usize| {
        *out = rays.iter().filter(|ray| scene.occluded(&mut embree_ray(ray))).count();
    };
    let (mut a, mut b, mut c) = (0, 0, 0);
    let times = rounds(
        ROUNDS,
        &mut [&mut || with(medium, &mut a), &mut || with(robust, &mut b), &mut || {
            c = rays.iter().filter(|ray| world.occluded(ray)).count();
        }],
    );
    row(name, rays.len(), &times);
    println!("      hits {a} {b} {c}");
}

fn row(name: &str, n: usize, times: &[f64]) {
    let rate = |time: f64| n as f64 / time * 1e-6;
    let (medium, robust, ours) = (rate(times[0]), rate(times[1]), rate(times[2]));
    println!(
        "  {name:<20} {medium:>6.2}  {robust:>6.2} ({:.2})   {ours:>6.2} ({:.2})  ({:.2})",
        robust / medium,
        ours / medium,
        ours / robust
    );
}

/// Rays of photons in a Cornell box of flat shapes: nothing to compare with, but what benches of photons
/// trace.
fn cornell() {
    let mut scene = scene(Vec::new());
    let material = scene.shapes.pop().map(|s: Shape| s.material);
    let material = material.unwrap_or_else(|| scene.materials.iter_handles().next().expect("one").0);
    let mut push = |geometry, to_world| {
        let name = String::new();
        scene.shapes.push(Shape {
            name,
            geometry,
            to_world,
            material,
            emission: None,
            flip_normals: false,
            boundary: nephroid::medium::Boundary::default(),
        });
    };
    use nephroid::math::DVec3;
    let turns = [(DVec3::X, 0.0), (DVec3::X, 90.0), (DVec3::X, -90.0), (DVec3::Y, 90.0), (DVec3::Y, -90.0)];
    for (axis, degrees) in turns {
        let wall = Transform::translate(DVec3::new(0.0, 0.0, -1.0)).then(Transform::rotate(axis, degrees));
        push(Geometry::Rectangle, wall);
    }
    for (x, height, angle) in [(-0.35, 0.6, 20.0), (0.35, 0.3, -17.0)] {
        let block = Transform::scale(DVec3::new(0.3, height, 0.3))
            .then(Transform::rotate(DVec3::Y, angle))
            .then(Transform::translate(DVec3::new(x, height - 1.0, 0.0)));
        push(Geometry::Cube, block);
    }
    let world = World::new(scene).expect("a sound scene");
    let mut rng = Numbers(5);
    let mut rays = Vec::new();
    while rays.len() < 262_144 {
        let mut ray = Ray::new(Vec3::new(0.0, 0.99, 0.0), -rng.hemisphere(Vec3::Y));
        for _ in 0..6 {
            rays.push(ray);
            let Some(hit) = world.intersect(&ray) else { break };
            let n = hit.point.ng * -hit.point.ng.dot(ray.direction).signum();
            let direction = rng.hemisphere(n);
            ray = Ray::new(
                offset_origin(hit.point.position, hit.point.error, hit.point.ng, direction),
                direction,
            );
        }
    }
    let (mut hits, mut met, mut stopped) = (0, 0, 0);
    let times = rounds(
        ROUNDS,
        &mut [
            &mut || hits = rays.iter().filter(|ray| world.nearest(ray).is_some()).count(),
            &mut || met = rays.iter().filter(|ray| world.intersect(ray).is_some()).count(),
            &mut || stopped = rays.iter().filter(|ray| world.occluded(ray)).count(),
        ],
    );
    let rate = |time: f64| rays.len() as f64 / time * 1e-6;
    println!(
        "Cornell box, Mray/CPU s: nearest {:.2}, with the surface {:.2}, any hit {:.2} ({hits} {met} {stopped} of {} hit)",
        rate(times[0]),
        rate(times[1]),
        rate(times[2]),
        rays.len()
    );
}

/// A small generator, so that rays are the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((x >> 40) as f32) / (1u64 << 24) as f32
    }

    fn pair(&mut self) -> Vec2 {
        Vec2::new(self.next(), self.next())
    }

    /// By the cosine about `n`.
    fn hemisphere(&mut self, n: Vec3) -> Vec3 {
        (n + warp::square_to_sphere(self.pair()) * 0.999).normalize()
    }
}

/// A view into the box, in tiles of 8 by 8.
fn primary() -> Vec<Ray> {
    let origin = Vec3::new(0.1, 0.2, 1.9);
    let tile = |t: u32| ((t % (SIDE / 8)) * 8, (t / (SIDE / 8)) * 8);
    (0..SIDE * SIDE)
        .map(|i| {
            let (x, y) = tile(i / 64);
            let (x, y) = (x + i % 8, y + i / 8 % 8);
            let at = |p: u32| (p as f32 + 0.5) / SIDE as f32 * 1.6 - 0.8;
            Ray::new(origin, Vec3::new(at(x), at(y), -1.0).normalize())
        })
        .collect()
}

/// A diffuse bounce and a shadow ray to a lamp at the ceiling from each hit.
fn secondary(world: &World, primary: &[Ray]) -> (Vec<Ray>, Vec<Ray>) {
    let mut rng = Numbers(1);
    let hits = primary.iter().filter_map(|ray| Some((ray, world.intersect(ray)?)));
    hits.map(|(ray, hit)| {
        let p = hit.point;
        let n = if p.ng.dot(ray.direction) < 0.0 { p.ng } else { -p.ng };
        let direction = rng.hemisphere(n);
        let bounce = Ray::new(offset_origin(p.position, p.error, p.ng, direction), direction);
        // Lamps at the floor as well, so that most rays are stopped on their way.
        let lamp = Vec3::new(rng.next() - 0.5, if rng.next() < 0.3 { 1.95 } else { -1.95 }, rng.next() - 0.5);
        let origin = offset_origin(p.position, p.error, p.ng, lamp - p.position);
        (bounce, Ray { origin, direction: lamp - origin, t_max: 1.0 - 1e-5 })
    })
    .unzip()
}

fn shuffled(rays: &[Ray]) -> Vec<Ray> {
    let mut rng = Numbers(2);
    let mut rays = rays.to_vec();
    for i in (1..rays.len()).rev() {
        let j = (f64::from(rng.next()) * (i + 1) as f64) as usize;
        rays.swap(i, j);
    }
    rays
}

/// A closed box of side 4 and a ball with bumps in it, of `2·columns·(rows − 1)` and 12 triangles.
fn box_and_ball(rows: u32, columns: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..8u32 {
        let side = |bit: u32| if i >> bit & 1 == 1 { 2.0 } else { -2.0 };
        mesh.positions.push(Vec3::new(side(0), side(1), side(2)));
    }
    for axis in 0..3 {
        for high in 0..2u32 {
            let corner = |a: u32, b: u32| high << axis | a << ((axis + 1) % 3) | b << ((axis + 2) % 3);
            mesh.triangles.push([corner(0, 0), corner(1, 0), corner(1, 1)]);
            mesh.triangles.push([corner(0, 0), corner(1, 1), corner(0, 1)]);
        }
    }
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        let theta = f64::from(row) / f64::from(rows) * std::f64::consts::PI;
        for column in 0..columns {
            let phi = f64::from(column) / f64::from(columns) * 2.0 * std::f64::consts::PI;
            let (s, c) = theta.sin_cos();
            let r = 1.0 + 0.08 * (12.0 * phi).sin() * (15.0 * theta).sin() * s;
            mesh.positions.push(Vec3::new(
                (r * s * phi.cos()) as f32,
                (r * c) as f32,
                (r * s * phi.sin()) as f32,
            ));
        }
    }
    let at = |row: u32, column: u32| first + row * columns + column % columns;
    for row in 0..rows {
        for c in 0..columns {
            if row > 0 {
                mesh.triangles.push([at(row, c), at(row, c + 1), at(row + 1, c)]);
            }
            if row + 1 < rows {
                mesh.triangles.push([at(row, c + 1), at(row + 1, c + 1), at(row + 1, c)]);
            }
        }
    }
    mesh
}

fn scene(list: Vec<Mesh>) -> Scene {
    let (mut textures, mut materials, mut meshes) = (Textures::default(), Arena::default(), Arena::default());
    let material = materials.push(Material::Diffuse { reflectance: textures.constant(Rgb::splat(0.5)) });
    let shapes = list
        .into_iter()
        .map(|mesh| Shape {
            name: "mesh".into(),
            geometry: Geometry::Mesh(meshes.push(mesh)),
            to_world: Transform::IDENTITY,
            material,
            emission: None,
            flip_normals: false,
            boundary: nephroid::medium::Boundary::default(),
        })
        .collect();
    Scene {
        camera: Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None },
        film: FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box },
        textures,
        materials,
        meshes,
        shapes,
        groups: Arena::default(),
        instances: Vec::new(),
        lights: Vec::new(),
        media: nephroid::medium::Media::default(),
    }
}
