use super::hues::Hues;
use super::level::{Item, Level, Other};
use super::nest::ranks;
use super::placed::Placed;
use super::scenery::Scenery;
use super::{Aims, Surfaced, Surroundings, World};
use crate::bvh::Simd;
use crate::camera::CameraRays;
use crate::color::Rgb;
use crate::light::{
    AreaEmitter, ConstantSky, Emitter, EmitterKind, EnvironmentMap, Goniometric, Light, LightKind, Projector,
    Spot, Sun, Target,
};
use crate::material::Material;
use crate::math::{Bounds, Transform, warp};
use crate::medium::{Matter, Media};
use crate::sampling::Discrete;
use crate::scene::{self, Scene, SceneError, SceneErrors, Subject};
use crate::shape::{Geometry, Mesh, Primitive, Shape, Triangle};
use crate::texture::Pixmap;

impl World {
    /// Checks a scene and prepares it for rendering.
    ///
    /// # Errors
    /// Every problem that the scene has. After this, rendering cannot fail.
    pub fn new(scene: Scene) -> Result<Self, SceneErrors> {
        let problems = scene::check(&scene);
        if !problems.is_empty() {
            return Err(SceneErrors(problems));
        }
        let (scenery, pieces_of_lamps) = scenery(&scene)?;
        let bounds = scenery.bounds();

        let camera = CameraRays::new(&scene.camera, &scene.film);
        let (center, radius) = bounds.with(camera.position()).bounding_sphere();
        // Infinite planes alone have no bounds; any size will do for light that only comes straight.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let (emitters, lamps, emitter_of_shape) =
            emitters(&scene, pieces_of_lamps, Target { center, radius });
        let aims = Aims::new(&scene, &scenery, &emitters, &emitter_of_shape, radius);
        let by_power = Discrete::new(emitters.iter().map(|e| f64::from(e.power.mean())));
        let for_direct = for_direct(&emitters);
        let mut surfaces: Vec<Surfaced> = scene
            .all_shapes()
            .enumerate()
            .map(|(i, s)| {
                let inside = Material::unmasked(&scene.materials, s.material);
                let invisible = scene.materials[inside] == Material::Null;
                Surfaced {
                    material: s.material,
                    flipped: s.flip_normals,
                    invisible,
                    masked: Material::is_masked(&scene.materials, s.material) && !invisible,
                    colored: matches!(s.geometry, Geometry::Mesh(mesh) if !scene.meshes[mesh].colors.is_empty()),
                    light: s.emission.zip(emitter_of_shape.get(i).copied().flatten()),
                    boundary: s.boundary.is_named().then_some(s.boundary),
                    rank: 0,
                    disperses: Material::dispersion(&scene.materials, s.material).is_some(),
                }
            })
            .collect();
        let ranked = ranks(&scene);
        for (rank, one) in (1..).zip(&ranked) {
            surfaces[one.shape as usize].rank = rank;
        }
        let transparent = surfaces.iter().any(|s| s.invisible);
        let cutouts = surfaces.iter().any(|s| s.masked);
        let dispersive = surfaces.iter().any(|s| s.disperses);
        let Media { list, grids } = &scene.media;
        let anywhere = scene.has_media();
        let matters = list.iter().take_while(|_| anywhere).map(|m| Matter::new(m, grids)).collect();
        let mut world = Self {
            scene,
            scenery,
            surfaces,
            cutouts,
            transparent,
            surface_lights: emitters.len(),
            wide_sky: emitters.iter().any(Emitter::is_wide_sky),
            emitters,
            by_power,
            for_direct,
            camera,
            hues: dispersive.then(Hues::new).flatten(),
            bounds,
            aims,
            lamps,
            ranked,
            matters,
            camera_surroundings: Surroundings::default(),
            light_surroundings: Vec::new(),
            remarks: Vec::new(),
        };
        world.look_around();
        if world.has_media() {
            world.kindle();
        }
        Ok(world)
    }
}

/// All surfaces, and the pieces of each shape that emits.
fn scenery(scene: &Scene) -> Result<(Scenery, Vec<Vec<Primitive>>), SceneErrors> {
    let mut parts = Parts::default();
    let top = parts.level(scene, &scene.shapes, 0);
    let mut first = scene.shapes.len();
    let mut groups = Vec::new();
    for group in scene.groups.iter() {
        groups.push(parts.level(scene, &group.shapes, first));
        first += group.shapes.len();
    }
    let levels: Vec<Level> = groups.into_iter().map(|pieces| parts.build(pieces)).collect();

    let (mut top, mut instances) = (top, Vec::new());
    for (number, instance) in scene.instances.iter().enumerate() {
        let group = instance.group.index();
        let placed = Placed::new(group as u32, &instance.to_world);
        let bounds = placed.bounds(levels[group].bounds);
        if is_sound(&bounds) {
            top.finite.push((bounds, Item::Other(Other::Instance(number as u32))));
        } else {
            parts.problems.push(nothing_left(Subject::Instance(number)));
        }
        instances.push(placed);
    }
    if !parts.problems.is_empty() {
        return Err(SceneErrors(parts.problems));
    }
    let top = parts.build(top);
    let Parts { meshes, mesh_of, primitives, owner, lamps, count, .. } = parts;
    let simd = Simd::detect();
    let scenery = Scenery { meshes, mesh_of, primitives, owner, top, groups: levels, instances, count, simd };
    Ok((scenery, lamps))
}

/// What a level will be built of.
struct Pieces {
    finite: Vec<(Bounds, Item)>,
    infinite: Vec<u32>,
}

/// The parts of a [`Scenery`] while they come together.
#[derive(Default)]
struct Parts {
    meshes: Vec<Mesh>,
    mesh_of: Vec<Option<u32>>,
    primitives: Vec<Primitive>,
    owner: Vec<u32>,
    lamps: Vec<Vec<Primitive>>,
    count: usize,
    problems: Vec<SceneError>,
}

impl Parts {
    /// Takes shapes apart, the first of which is number `first` of all.
    fn level(&mut self, scene: &Scene, shapes: &[Shape], first: usize) -> Pieces {
        let mut pieces = Pieces { finite: Vec::new(), infinite: Vec::new() };
        for (number, shape) in (first..).zip(shapes) {
            let before = pieces.finite.len() + pieces.infinite.len();
            let sound = match shape.geometry {
                Geometry::Mesh(mesh) => self.mesh(&scene.meshes[mesh], shape, number, &mut pieces),
                _ => self.primitives(shape, number, &mut pieces),
            };
            let added = pieces.finite.len() + pieces.infinite.len() - before;
            self.count += added;
            if !sound || added == 0 {
                self.problems.push(nothing_left(Subject::Shape(number)));
            }
        }
        pieces
    }

    /// Adds the triangles of a mesh that have an area; false if one is not sound.
    fn mesh(&mut self, mesh: &Mesh, shape: &Shape, number: usize, pieces: &mut Pieces) -> bool {
        let at = self.meshes.len() as u32;
        self.mesh_of.push(Some(at));
        self.meshes.push(placed(mesh, &shape.to_world));
        let mesh = &self.meshes[at as usize];
        let mut lamp = Vec::new();
        let mut sound = true;
        pieces.finite.reserve(mesh.triangles.len());
        for index in 0..mesh.triangles.len() as u32 {
            let triangle = Triangle::new(mesh, at, index);
            if !triangle.is_proper() {
                continue;
            }
            let bounds = triangle.bounds();
            sound &= is_sound(&bounds);
            pieces.finite.push((bounds, Item::Triangle { shape: number as u32, index }));
            if shape.emission.is_some() {
                lamp.push(Primitive::Triangle(triangle));
            }
        }
        self.lamps.push(lamp);
        sound
    }

    /// Adds the pieces of a shape that is no mesh; false if one is not sound.
    fn primitives(&mut self, shape: &Shape, number: usize, pieces: &mut Pieces) -> bool {
        self.mesh_of.push(None);
        let own = Primitive::of_shape(shape).unwrap_or_default();
        for &piece in &own {
            let at = self.primitives.len() as u32;
            self.primitives.push(piece);
            self.owner.push(number as u32);
            let bounds = piece.bounds();
            if bounds.is_empty() {
                pieces.infinite.push(at);
            } else if is_sound(&bounds) {
                pieces.finite.push((bounds, Item::Other(Other::Primitive(at))));
            } else {
                return false;
            }
        }
        self.lamps.push(if shape.emission.is_some() { own } else { Vec::new() });
        true
    }

    fn build(&self, pieces: Pieces) -> Level {
        // Only shapes that are meshes have triangles.
        let mesh = |shape: u32| &self.meshes[self.mesh_of[shape as usize].unwrap_or(0) as usize];
        Level::new(&pieces.finite, pieces.infinite, &self.primitives, mesh)
    }
}

fn nothing_left(subject: Subject) -> SceneError {
    let message = "nothing of it is left in single precision: it is too small, too thin or too large";
    SceneError { subject, message: message.into() }
}

/// Whether single precision holds where it lies.
fn is_sound(bounds: &Bounds) -> bool {
    bounds.extent().is_finite() && bounds.area().is_finite()
}

/// A mesh under a transform, still counter-clockwise where the transform mirrors.
fn placed(mesh: &Mesh, to_world: &Transform) -> Mesh {
    let mirrored = to_world.is_mirrored();
    Mesh {
        positions: mesh.positions.iter().map(|&p| to_world.point(p)).collect(),
        normals: mesh.normals.iter().map(|&n| to_world.normal(n)).collect(),
        uvs: mesh.uvs.clone(),
        colors: mesh.colors.clone(),
        triangles: mesh
            .triangles
            .iter()
            .map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect(),
    }
}

/// The lights of a scene, what each is in the scene, and the light that each shape is.
type Emitters = (Vec<Emitter>, Vec<Subject>, Vec<Option<u32>>);

fn emitters(scene: &Scene, pieces: Vec<Vec<Primitive>>, target: Target) -> Emitters {
    let (mut emitters, mut lamps) = (Vec::new(), Vec::new());
    let mut of_shape = vec![None; scene.shapes.len()];
    for (i, (shape, pieces)) in scene.shapes.iter().zip(pieces).enumerate() {
        let Some(radiance) = shape.emission else { continue };
        let index = emitters.len() as u32;
        let convex = is_convex(shape).then_some(index);
        if let Some(area) = AreaEmitter::new(pieces, radiance, shape.flip_normals, convex) {
            of_shape[i] = Some(index);
            let power = area.power(&scene.textures);
            emitters.push(Emitter { name: shape.name.clone(), kind: EmitterKind::Area(area), power });
            lamps.push(Subject::Shape(i));
        }
    }
    for (i, light) in scene.lights.iter().enumerate() {
        if let Some(emitter) = emitter(scene, light, target) {
            emitters.push(emitter);
            lamps.push(Subject::Light(i));
        }
    }
    (emitters, lamps, of_shape)
}

/// Whether light that leaves a shape cannot meet it again.
fn is_convex(shape: &Shape) -> bool {
    match shape.geometry {
        Geometry::Rectangle | Geometry::Disk | Geometry::Plane => true,
        Geometry::Sphere { .. } | Geometry::Cylinder { .. } | Geometry::Cube => !shape.flip_normals,
        Geometry::Mesh(_) => false,
    }
}

/// `None` for one whose image is without light.
fn emitter(scene: &Scene, light: &Light, target: Target) -> Option<Emitter> {
    let (kind, power): (EmitterKind, Rgb) = match &light.kind {
        &LightKind::Point { position, intensity } => {
            (EmitterKind::Point { position, intensity }, intensity / warp::SPHERE_PDF)
        }
        LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture } => {
            let spot = Spot::new(to_world, *intensity, *cutoff_deg, *beam_width_deg, *texture);
            let power = spot.power(&scene.textures);
            (EmitterKind::Spot(spot), power)
        }
        &LightKind::Directional { direction, irradiance } => (
            EmitterKind::Directional { direction: direction.normalize(), irradiance, target },
            irradiance * target.silhouette(),
        ),
        &LightKind::Constant { radiance } => {
            let sky = ConstantSky { radiance, target };
            (EmitterKind::Constant(sky), sky.power())
        }
        LightKind::Environment { image, mapping, scale, to_world } => {
            let map = EnvironmentMap::new(&scene.textures, (*image, *mapping), *scale, to_world, target)?;
            let power = map.power();
            (EmitterKind::Environment(map), power)
        }
        &LightKind::Sun { direction, irradiance, angular_radius_deg } if angular_radius_deg > 0.0 => {
            let sun = Sun::new(direction.normalize(), irradiance, angular_radius_deg, target);
            (EmitterKind::Sun(sun), sun.power())
        }
        &LightKind::Sun { direction, irradiance, .. } => (
            EmitterKind::Directional { direction: -direction.normalize(), irradiance, target },
            irradiance * target.silhouette(),
        ),
        LightKind::Goniometric { to_world, intensity, table, mapping } => {
            let lamp = Goniometric::new(&scene.textures, to_world, *intensity, (*table, *mapping))?;
            let power = lamp.power();
            (EmitterKind::Goniometric(Box::new(lamp)), power)
        }
        &LightKind::Projector { ref to_world, image, scale, unit, fov_deg, fov_axis } => {
            let Pixmap { width, height, .. } = scene.textures.images[image];
            let half = fov_axis.half_size(fov_deg, width as f32, height as f32);
            let lamp = Projector::new(&scene.textures, to_world, image, scale, unit, half)?;
            let power = lamp.power();
            (EmitterKind::Projector(Box::new(lamp)), power)
        }
    };
    Some(Emitter { name: light.name.clone(), kind, power })
}

/// Half by power, half evenly among the lights that have any. A sky's power is what reaches the bounds
/// of the scene, of which one place may see little, and power alone would all but never ask the lamp
/// beside it.
fn for_direct(emitters: &[Emitter]) -> Option<Discrete> {
    let powers: Vec<f64> = emitters.iter().map(|e| f64::from(e.power.mean())).collect();
    let (total, lit) = (powers.iter().sum::<f64>(), powers.iter().filter(|p| **p > 0.0).count() as f64);
    Discrete::new(powers.iter().map(|&p| if p > 0.0 { 0.5 * p / total + 0.5 / lit } else { 0.0 }))
}
