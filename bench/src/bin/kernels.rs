//! The hot kernels, one at a time, for a counter of instructions: see `bench/instructions`, which runs this under
//! callgrind.
//!
//! `kernels` lists the names; `kernels NAME` runs one and prints how many units of work it did. Callgrind counts
//! what happens inside [`measured`] alone, so scenes and maps are made ready for nothing. Everything runs on one
//! thread.

use std::f32::consts::PI;
use std::hint::black_box;
use std::path::{Path, PathBuf};

use nephroid::camera::{Camera, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Film, FilmSettings, Filter, PixelSum};
use nephroid::handle::Arena;
use nephroid::light::{Light, LightKind};
use nephroid::material::{Bsdf, Material, Transport};
use nephroid::math::{Ray, Transform, Vec2, Vec3, warp};
use nephroid::medium::Boundary;
use nephroid::medium::Media;
use nephroid::observer::Silent;
use nephroid::photon_map::{Bandwidth, Kernel, NearestList, PhotonMap, Photons, Query, gather};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::Textures;
use nephroid::transport::{Extras, MapPlan, PhotonPlan, WalkSettings, photon_pass};
use nephroid::world::World;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

const RAYS: usize = 20_000;
const PATHS: u64 = 4096;
const QUERIES: usize = 2000;
const SAMPLES: usize = 20_000;
const SIDE: u32 = 256;

/// Name and work; the latter gives the units it did.
const KERNELS: [(&str, fn() -> usize); 12] = [
    ("mesh closest hit", || closest_hit(&bumpy_sphere())),
    ("mesh any hit", || any_hit(&bumpy_sphere())),
    ("cornell closest hit", || closest_hit(&cornell())),
    ("cornell any hit", || any_hit(&cornell())),
    ("photon path", photon_paths),
    ("map build, a photon", map_build),
    ("gather fixed radius", || gathers(|map| Bandwidth::Fixed { radius: map.typical_radius(20) })),
    ("gather nearest 50", || {
        gathers(|map| Bandwidth::Nearest { k: 50, max_radius: map.default_max_radius(50) })
    }),
    ("glass sample", || bsdf_samples(&glass())),
    ("phong sample and eval", || bsdf_samples(&phong())),
    ("film add, a pixel", film_add),
    ("film develop, a pixel", film_develop),
];

fn main() {
    let Some(name) = std::env::args().nth(1) else {
        KERNELS.iter().for_each(|(name, _)| println!("{name}"));
        return;
    };
    let Some((_, kernel)) = KERNELS.iter().find(|(known, _)| *known == name) else {
        eprintln!("no kernel is called \"{name}\"; without a name all are listed");
        std::process::exit(2);
    };
    // The pool is this very thread, or what is counted would happen elsewhere.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    pool.expect("nobody has made a pool before");
    println!("{}", kernel());
}

/// The function inside which instructions are counted.
#[inline(never)]
fn measured<T>(work: impl FnOnce() -> T) -> T {
    black_box(work())
}

/// Numbers in [0, 1) that are random enough (Vigna's splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    fn pair(&mut self) -> Vec2 {
        Vec2::new(self.next(), self.next())
    }

    fn direction(&mut self) -> Vec3 {
        warp::square_to_sphere(self.pair())
    }
}

fn cornell() -> World {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell.xml");
    let file = read_scene(&path, &DiskFiles, &Options::default()).expect("the default scene can be read");
    World::new(file.scene).expect("the default scene can be rendered")
}

/// One shape of a material, and a light.
fn world(mesh: Option<Mesh>, material: impl FnOnce(&mut Textures) -> Material) -> World {
    let (mut textures, mut materials, mut meshes) = (Textures::default(), Arena::default(), Arena::default());
    let material = materials.push(material(&mut textures));
    let geometry = mesh.map_or(Geometry::Rectangle, |mesh| Geometry::Mesh(meshes.push(mesh)));
    let to_world = Transform::IDENTITY;
    let shape = Shape {
        name: "shape".into(),
        geometry,
        to_world,
        material,
        emission: None,
        flip_normals: false,
        boundary: Boundary::default(),
    };
    let kind = LightKind::Point { position: Vec3::Z * 5.0, intensity: Rgb::WHITE };
    let film = FilmSettings { width: 4, height: 4, crop: None, filter: Filter::Box };
    let (shapes, lights) = (vec![shape], vec![Light { name: "lamp".into(), kind, medium: None }]);
    let camera = Camera { to_world, projection: Projection::Orthographic, medium: None };
    let (groups, instances) = (Arena::default(), Vec::new());
    World::new(Scene {
        camera,
        film,
        textures,
        materials,
        meshes,
        shapes,
        groups,
        instances,
        lights,
        media: Media::default(),
    })
    .expect("it is sound")
}

/// About 70 000 triangles around the origin, at distances from 0.9 to 1.1.
fn bumpy_sphere() -> World {
    let (columns, rows) = (264u32, 132u32);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let theta = PI * (row as f32 + 0.5) / (rows as f32 + 1.0);
            let phi = 2.0 * PI * column as f32 / columns as f32;
            let radius = 1.0 + 0.1 * (9.0 * theta).sin() * (7.0 * phi).sin();
            let around = Vec3::new(phi.cos() * theta.sin(), phi.sin() * theta.sin(), theta.cos());
            mesh.positions.push(around * radius);
            if row < rows && column < columns {
                let a = row * (columns + 1) + column;
                let b = a + columns + 1;
                mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
            }
        }
    }
    world(Some(mesh), |textures| Material::Diffuse { reflectance: textures.constant(Rgb::splat(0.5)) })
}

/// Rays between random points of the scene's bounds: what is left of light after a bounce.
fn rays(world: &World) -> Vec<Ray> {
    let (bounds, mut numbers) = (world.bounds(), Numbers(1));
    let mut point = || {
        let at = Vec3::new(numbers.next(), numbers.next(), numbers.next());
        bounds.min + (bounds.max - bounds.min) * at
    };
    (0..RAYS).map(|_| (point(), point())).map(|(a, b)| Ray::new(a, (b - a).normalize())).collect()
}

fn closest_hit(world: &World) -> usize {
    let rays = rays(world);
    let hits = measured(|| rays.iter().filter_map(|ray| world.intersect(ray)).map(|hit| hit.t).sum::<f32>());
    assert!(hits > 0.0);
    rays.len()
}

fn any_hit(world: &World) -> usize {
    let mut rays = rays(world);
    let length = (world.bounds().max - world.bounds().min).length();
    rays.iter_mut().for_each(|ray| ray.t_max = 0.3 * length);
    let hits = measured(|| rays.iter().filter(|ray| world.occluded(ray)).count());
    assert!(hits > 0);
    rays.len()
}

fn emit(world: &World, seed: u64, paths: u64) -> Photons {
    let settings = WalkSettings::default();
    let plan = PhotonPlan { global: MapPlan { paths, ..MapPlan::default() }, ..PhotonPlan::default() };
    let pass = photon_pass(world, &settings, &plan, Extras::default(), seed, 0, &Silent);
    pass.expect("nobody cancels").global
}

fn photon_paths() -> usize {
    let world = cornell();
    let photons = measured(|| emit(&world, 1, PATHS));
    assert!(photons.stored() > 0);
    PATHS as usize
}

fn map_build() -> usize {
    let photons = emit(&cornell(), 1, 4 * PATHS);
    let stored = photons.stored();
    let map: PhotonMap = measured(|| PhotonMap::build(photons));
    assert_eq!(map.len(), stored);
    stored
}

/// Gathers where the photons of other paths lie, so as densely as light does.
fn gathers(bandwidth: impl FnOnce(&PhotonMap) -> Bandwidth) -> usize {
    let world = cornell();
    let map: PhotonMap = PhotonMap::build(emit(&world, 1, 4 * PATHS));
    let bandwidth = bandwidth(&map);
    let others = emit(&world, 2, PATHS);
    let query = |p: &nephroid::photon_map::Photon| Query {
        position: p.position,
        normal: p.normal,
        max_photon_depth: None,
    };
    let queries: Vec<Query> = others.as_slice().iter().take(QUERIES).map(query).collect();
    let mut heap = NearestList::new();
    let sum = measured(|| {
        let mut sum = Rgb::BLACK;
        for query in &queries {
            gather(&map, query, Kernel::Epanechnikov, bandwidth, &mut heap, |photon, weight| {
                sum += photon.power * weight;
            });
        }
        sum
    });
    assert!(sum.r > 0.0);
    queries.len()
}

/// The BSDF where a ray down the z axis meets the shape.
fn bsdf(material: impl FnOnce(&mut Textures) -> Material) -> Bsdf {
    let world = world(None, material);
    let ray = Ray::new(Vec3::new(0.1, 0.2, 3.0), -Vec3::Z);
    let hit = world.intersect(&ray).expect("the rectangle is there");
    world.bsdf(&hit, Vec3::Z)
}

fn glass() -> Bsdf {
    bsdf(|textures| Material::Dielectric {
        ext_ior: 1.0,
        int_ior: 1.5,
        specular_reflectance: textures.constant(Rgb::WHITE),
        specular_transmittance: textures.constant(Rgb::WHITE),
    })
}

fn phong() -> Bsdf {
    bsdf(|textures| Material::Phong {
        diffuse_reflectance: textures.constant(Rgb::splat(0.4)),
        specular_reflectance: textures.constant(Rgb::splat(0.4)),
        exponent: 30.0,
    })
}

fn bsdf_samples(bsdf: &Bsdf) -> usize {
    let mut numbers = Numbers(1);
    let mut upper = || Some(numbers.direction()).map(|w| Vec3::new(w.x, w.y, w.z.abs()));
    let inputs: Vec<Vec3> = (0..SAMPLES).filter_map(|_| upper()).collect();
    let us: Vec<(Vec2, f32)> = (0..SAMPLES).map(|_| (numbers.pair(), numbers.next())).collect();
    let sum = measured(|| {
        let mut sum = Rgb::BLACK;
        for (wo, (u, lobe)) in inputs.iter().zip(&us) {
            if let Some(sample) = bsdf.sample(*wo, *u, *lobe, Transport::Radiance) {
                sum += sample.weight;
                sum += bsdf.eval(*wo, sample.wi);
            }
        }
        sum
    });
    assert!(sum.r > 0.0);
    inputs.len()
}

fn pixel_sums() -> Vec<PixelSum> {
    let mut numbers = Numbers(1);
    let mut pixel = || {
        let mut sum = PixelSum::default();
        (0..4).for_each(|_| sum.add(Rgb::splat(numbers.next()), 1.0));
        sum
    };
    (0..SIDE * SIDE).map(|_| pixel()).collect()
}

fn film_add() -> usize {
    let (mut film, sums) = (Film::new(SIDE, SIDE), pixel_sums());
    measured(|| film.add_iteration(&sums));
    assert_eq!(film.iterations(), 1);
    sums.len()
}

fn film_develop() -> usize {
    let (mut film, sums) = (Film::new(SIDE, SIDE), pixel_sums());
    film.add_iteration(&sums);
    let image = measured(|| film.develop());
    assert!(image.mean().g > 0.0);
    sums.len()
}
