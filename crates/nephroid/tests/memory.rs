//! What a big mesh takes in memory while its world is made. Alone in its program, for it counts all that is allocated.

use nephroid::camera::{Camera, Projection};
use nephroid::color::Rgb;
use nephroid::film::{FilmSettings, Filter};
use nephroid::material::Material;
use nephroid::math::{Transform, Vec3};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::world::World;
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Quads along each side of a square; enough triangles for a tree that is built in parts, of which one takes little.
const SIDE: u32 = 500;
const TRIANGLES: usize = 2 * (SIDE * SIDE) as usize;

/// A hilly square with smooth normals.
fn hills() -> Mesh {
    let corner = |i: u32| {
        let (x, y) = ((i % (SIDE + 1)) as f32, (i / (SIDE + 1)) as f32);
        // A parabola in each field of 50 quads, so that no two are alike in size.
        let wave = |v: f32| (v % 50.0 - 25.0) * (v % 50.0 - 25.0) / 60.0;
        Vec3::new(x, y, wave(x) + wave(y))
    };
    let mut triangles = Vec::with_capacity(TRIANGLES);
    for quad in 0..SIDE * SIDE {
        let first = quad / SIDE * (SIDE + 1) + quad % SIDE;
        let across = first + SIDE + 2;
        triangles.extend([[first, first + 1, across], [first, across, across - 1]]);
    }
    let count = (SIDE + 1) * (SIDE + 1);
    let mut mesh = Mesh { positions: (0..count).map(corner).collect(), triangles, ..Mesh::default() };
    mesh.compute_normals();
    mesh
}

#[test]
fn a_big_mesh_takes_little_memory() {
    // On one thread, so that it is the same each time.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let before = MEMORY.current_usage();
    let per_triangle = |bytes: usize| (bytes - before) as f64 / TRIANGLES as f64;
    let camera = Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None };
    let film = FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box };
    let mut scene = Scene::new(camera, film);
    let reflectance = scene.textures.constant(Rgb::WHITE);
    let material = scene.materials.push(Material::Diffuse { reflectance });
    let mesh = scene.meshes.push(hills());
    scene.shapes.push(Shape::new("hills", Geometry::Mesh(mesh), material));
    let mesh_alone = per_triangle(MEMORY.current_usage());
    MEMORY.reset_peak_usage();
    let world = pool.install(|| World::new(scene)).expect("a sound scene");
    let (peak, held) = (per_triangle(MEMORY.peak_usage()), per_triangle(MEMORY.current_usage()));
    assert_eq!(world.primitive_count(), TRIANGLES);
    // Vertices and indices; these with leaves and nodes; and with items, a binary tree and what is chosen of it.
    assert!(mesh_alone < 25.0, "the mesh takes {mesh_alone} bytes a triangle");
    assert!(held < 85.0, "{held} bytes a triangle are held");
    assert!(peak < 118.0, "{peak} bytes a triangle are needed at once");
}
