//! Scenes built in code and renders of them, for the tests in `tests/`: every estimator against its
//! closed form, and integrators against one another.

mod curved;
mod fog;
mod methods;
mod optics;
mod rooms;
mod slopes;
mod view;
mod volume_scenes;
mod volumes;

pub use curved::{beside_a_light, over_pixels, under_a_light};
pub use fog::{
    KERNELS, channel_means, collisions, expect_fair_books, grey_fog, medium_view, medium_views, volpath,
};
pub use methods::{Contestant, every_method, every_method_but};
pub use optics::{blurred, derivative, epanechnikov, fresnel, polygon_irradiance, root};
pub use rooms::{
    PixelKind, ROOM_PARTS, ROOMS, Room, RoomReference, built_in, coarser, kind_of_part, part_samples,
    pixel_kinds,
};
use slopes::iterate_to;
pub use slopes::{Errors, Part, Series, iterated, log_slope, single_iterations};
pub use view::{
    block_samples, forgiving, iterated_renders, light_tracer, map_view, mean_radiances, path, photon_mapper,
    photons_of, pixel_origins, progressive, renders,
};
pub use volume_scenes::{
    balls_in_fog, cloud_over_floor, foggy_niche, glossy_ball_in_fog, lantern_in_fog, three_media,
};
pub use volumes::{between, blocks, boxed, facing};

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Crop, FilmSettings, Filter};
use nephroid::handle::{Arena, Handle};
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig};
use nephroid::light::{Light, LightKind};
use nephroid::material::{Dispersion, Material, Metal};
use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::medium::Boundary;
use nephroid::medium::Media;
use nephroid::observer::Silent;
use nephroid::photon_map::Kernel;
use nephroid::scene::Scene;
use nephroid::session::{RenderSettings, Session};
use nephroid::shape::{Geometry, Mesh, Shape};
use nephroid::texture::{Image, Texture, Textures};
use nephroid::transport::{Extras, MapPlan, PhotonPass, PhotonPlan, WalkSettings, photon_pass};
use nephroid::world::World;
use std::ops::Range;

/// A scene under construction.
pub struct Builder {
    /// What has been built so far.
    pub scene: Scene,
}

impl Builder {
    /// An empty scene seen from `origin` towards `target`, through an angle of `fov_deg` on a square
    /// film of `side` pixels.
    ///
    /// # Panics
    /// If the camera looks along its up direction, +y, or +z where it looks along y.
    pub fn seen_from(origin: Vec3, target: Vec3, fov_deg: f32, side: u32) -> Self {
        let (o, t) = (origin.as_dvec3(), target.as_dvec3());
        let to_world = Transform::look_at(o, t, DVec3::Y)
            .or_else(|| Transform::look_at(o, t, DVec3::Z))
            .expect("origin and target differ");
        let projection =
            Projection::Perspective { fov_deg, fov_axis: FovAxis::X, principal_point_offset: Vec2::ZERO };
        Self {
            scene: Scene {
                camera: Camera { to_world, projection, medium: None },
                film: FilmSettings { width: side, height: side, crop: None::<Crop>, filter: Filter::Box },
                textures: Textures::default(),
                materials: Arena::default(),
                meshes: Arena::default(),
                shapes: Vec::new(),
                groups: Arena::default(),
                instances: Vec::new(),
                lights: Vec::new(),
                media: Media::default(),
            },
        }
    }

    /// A constant texture.
    pub fn constant(&mut self, value: f32) -> Handle<Texture> {
        self.scene.textures.constant(Rgb::splat(value))
    }

    /// A grey Lambertian material.
    pub fn diffuse(&mut self, albedo: f32) -> Handle<Material> {
        let reflectance = self.constant(albedo);
        self.scene.materials.push(Material::Diffuse { reflectance })
    }

    /// A mirror of a given reflectance.
    pub fn mirror(&mut self, reflectance: f32) -> Handle<Material> {
        let specular_reflectance = self.constant(reflectance);
        self.scene.materials.push(Material::Conductor { metal: Metal::PerfectMirror, specular_reflectance })
    }

    /// Smooth glass of index `ior` in air.
    pub fn glass(&mut self, ior: f32) -> Handle<Material> {
        let one = self.constant(1.0);
        self.scene.materials.push(Material::Dielectric {
            int_ior: ior,
            ext_ior: 1.0,
            specular_reflectance: one,
            specular_transmittance: one,
        })
    }

    /// Smooth glass in air that takes light apart.
    pub fn dispersive_glass(&mut self, dispersion: Dispersion) -> Handle<Material> {
        let inside = self.glass(dispersion.nominal_ior());
        self.scene.materials.push(Material::Dispersive { dispersion, inside })
    }

    /// The same material on both sides.
    pub fn two_sided(&mut self, material: Handle<Material>) -> Handle<Material> {
        self.scene.materials.push(Material::TwoSided { front: material, back: material })
    }

    /// Adds a shape, and lets it be changed further.
    pub fn shape(
        &mut self,
        geometry: Geometry,
        to_world: Transform,
        material: Handle<Material>,
    ) -> &mut Shape {
        let name = format!("shape {}", self.scene.shapes.len());
        self.scene.shapes.push(Shape {
            name,
            geometry,
            to_world,
            material,
            emission: None,
            flip_normals: false,
            boundary: Boundary::default(),
        });
        self.scene.shapes.last_mut().expect("just pushed")
    }

    /// Adds a sphere.
    pub fn sphere(&mut self, center: Vec3, radius: f32, material: Handle<Material>) -> &mut Shape {
        self.shape(Geometry::Sphere { center, radius }, Transform::IDENTITY, material)
    }

    /// Adds a mesh.
    pub fn mesh(&mut self, mesh: Mesh, material: Handle<Material>) -> &mut Shape {
        let handle = self.scene.meshes.push(mesh);
        self.shape(Geometry::Mesh(handle), Transform::IDENTITY, material)
    }

    /// Adds a light without a surface.
    pub fn light(&mut self, kind: LightKind) {
        let name = format!("light {}", self.scene.lights.len());
        self.scene.lights.push(Light { name, kind, medium: None });
    }

    /// Adds a point light of a given intensity in W/sr.
    pub fn point_light(&mut self, position: Vec3, intensity: f32) {
        self.light(LightKind::Point { position, intensity: Rgb::splat(intensity) });
    }

    /// The world.
    ///
    /// # Panics
    /// If the scene has a problem.
    pub fn build(self) -> World {
        World::new(self.scene).expect("a sound scene")
    }
}

/// Renders as [`session`] does.
pub fn render(world: &World, method: Method, samples_per_pixel: u32, seed: u64) -> Image {
    session(world, method, samples_per_pixel, seed).film().develop()
}

/// The iterations of a render in [`session`]: three of a progressive one, as the second and the third are narrower than the
/// first.
pub fn iterations(method: &Method) -> u64 {
    match method {
        Method::Ppm(_) | Method::Vcm(_) | Method::Auto(_) => 3,
        Method::PhotonMapper(_) | Method::Path(_) | Method::LightTracer(_) => 1,
    }
}

/// Renders so many [`iterations`] and keeps the session.
///
/// # Panics
/// Never: nothing cancels it.
pub fn session(world: &World, method: Method, samples_per_pixel: u32, seed: u64) -> Session<'_> {
    let iterations = iterations(&method);
    let settings = RenderSettings { method, samples_per_pixel, seed };
    let mut session = Session::new(world, settings, &Silent);
    iterate_to(&mut session, iterations);
    session
}

/// Mean of all pixels and channels of a picture, in double precision.
pub fn picture_mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).sum();
    sum / (3 * image.pixels.len()) as f64
}

/// The [means](picture_mean) of one-iteration pictures with different seeds: independent estimates.
pub fn means(world: &World, method: &Method, samples_per_pixel: u32, seeds: Range<u64>) -> Vec<f64> {
    seeds.map(|seed| picture_mean(&render(world, method.clone(), samples_per_pixel, seed))).collect()
}

/// The photons of one iteration of so many paths, those of direct light with the global ones.
///
/// # Panics
/// Never: nothing cancels it.
pub fn photons(world: &World, settings: &WalkSettings, paths: u64, seed: u64) -> PhotonPass {
    let map = MapPlan { paths, ..MapPlan::default() };
    let plan = PhotonPlan { global: map, caustic: map, ..PhotonPlan::default() };
    let extras = Extras { direct: true, unseen: false };
    photon_pass(world, settings, &plan, extras, seed, 0, &Silent).expect("nothing cancels")
}

/// Every combination of kernel, bandwidth, source of direct light and final gathering, named, with
/// the other settings from `base`, which must have a `radius`: half of them use it, the other half
/// its `neighbours`.
pub fn photon_mapper_variants(base: &PhotonMapperConfig) -> Vec<(String, Method)> {
    let kernels = [
        Kernel::Box,
        Kernel::Cone { k: 1.0 },
        Kernel::Cone { k: 1.5 },
        Kernel::Gaussian,
        Kernel::Epanechnikov,
        Kernel::Biweight,
    ];
    let mut variants = Vec::new();
    for kernel in kernels {
        for radius in [None, base.radius] {
            for direct in [DirectSource::Rays, DirectSource::Map] {
                for final_gather in [FinalGather::Off, FinalGather::Auto, FinalGather::Rays(4)] {
                    let name = format!("{kernel}, radius {radius:?}, {direct:?}, gather {final_gather:?}");
                    let config = PhotonMapperConfig { kernel, radius, direct, final_gather, ..base.clone() };
                    variants.push((name, Method::PhotonMapper(config)));
                }
            }
        }
    }
    variants
}
