use super::asking::Asked;
use super::hues::Hues;
use super::level::{Item, Items, Level, Other, PackedItem};
use super::nest::ranks;
use super::placed::Placed;
use super::scenery::Scenery;
use super::{Aims, Surfaced, Surroundings, World};
use crate::bvh::Simd;
use crate::camera::CameraRays;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::light::{
    AreaEmitter, ConstantSky, Emitter, EmitterKind, EnvironmentMap, Goniometric, Light, LightKind, Lookup,
    Projector, Spot, Sun, Target,
};
use crate::material::Material;
use crate::math::{Bounds, Transform, warp};
use crate::medium::{Matter, Media};
use crate::observer::{Observer, Phase, Silent, Work};
use crate::sampling::Discrete;
use crate::scene::{self, Scene, SceneError, SceneErrors, Subject};
use crate::shape::{Geometry, Mesh, Primitive, Shape, Triangle, TriangleLeaf};
use crate::texture::Pixmap;

impl World {
    /// Checks a scene and prepares it for rendering.
    ///
    /// # Errors
    /// Every problem that the scene has. After this, rendering cannot fail.
    pub fn new(scene: Scene) -> Result<Self, SceneErrors> {
        Self::observed(scene, &Silent)
    }

    /// The same, and tells how far the trees are: a scene of millions of triangles takes seconds. It cannot be
    /// stopped: [`Observer::cancelled`] is not asked.
    ///
    /// # Errors
    /// Every problem that the scene has.
    pub fn observed(mut scene: Scene, observer: &dyn Observer) -> Result<Self, SceneErrors> {
        let problems = scene::check(&scene);
        if !problems.is_empty() {
            return Err(SceneErrors(problems));
        }
        settle(&mut scene);
        let (scenery, pieces_of_lamps) = scenery(&scene, observer)?;
        let bounds = scenery.bounds();

        let camera = CameraRays::new(&scene.camera, &scene.film);
        let (center, radius) = bounds.with(camera.position()).bounding_sphere();
        // Infinite planes alone have no bounds; any size will do for light that only comes straight.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let lookup = Lookup { meshes: scenery.meshes.as_slice(), textures: &scene.textures };
        let (emitters, lamps, emitter_of_shape) =
            emitters(&scene, pieces_of_lamps, lookup, Target { center, radius });
        let aims = Aims::new(&scene, &scenery, &emitters, &emitter_of_shape, radius);
        let by_power = Discrete::new(emitters.iter().map(|e| f64::from(e.power.mean())));
        let asked = Asked::new(&emitters, lookup);
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
                    oriented: Material::is_oriented(&scene.materials, s.material, &scene.textures),
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
            skies: (0..).zip(&emitters).filter(|(_, e)| e.is_sky()).map(|(i, _)| i).collect(),
            wide_sky: emitters.iter().any(Emitter::is_wide_sky),
            dirac_lamps: emitters.iter().any(Emitter::is_dirac),
            emitters,
            by_power,
            asked,
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
fn scenery(scene: &Scene, observer: &dyn Observer) -> Result<(Scenery, Vec<Vec<Primitive>>), SceneErrors> {
    let mut parts = Parts::default();
    let top = parts.level(scene, &scene.shapes, 0);
    let mut first = scene.shapes.len();
    let mut groups = Vec::new();
    for group in scene.groups.iter() {
        groups.push(parts.level(scene, &group.shapes, first));
        first += group.shapes.len();
    }
    let in_groups: usize = groups.iter().map(|pieces| pieces.finite.len()).sum();
    let all = top.finite.len() + in_groups + scene.instances.len();
    let work = Work::begin(observer, Phase::Trees, 2 * all as u64);
    let levels: Vec<Level> =
        groups.into_iter().map(|pieces| parts.build(&work, scene, pieces, &[])).collect();

    let (mut top, mut instances, mut bounds_of) = (top, Vec::new(), Vec::new());
    for (number, instance) in scene.instances.iter().enumerate() {
        let group = instance.group.index();
        let placed = Placed::new(group as u32, &instance.to_world);
        let bounds = placed.bounds(levels[group].bounds);
        if is_sound(&bounds) {
            top.finite.push(Item::Other(Other::Instance(number as u32)).into());
        } else {
            parts.problems.push(nothing_left(Subject::Instance(number)));
        }
        bounds_of.push(bounds);
        instances.push(placed);
    }
    if !parts.problems.is_empty() {
        return Err(SceneErrors(parts.problems));
    }
    let top = parts.build(&work, scene, top, &bounds_of);
    let Parts { mesh_of, primitives, owner, lamps, count, .. } = parts;
    let (simd, meshes) = (Simd::detect(), scene.meshes.clone());
    let scenery = Scenery { meshes, mesh_of, primitives, owner, top, groups: levels, instances, count, simd };
    Ok((scenery, lamps))
}

/// What a level will be built of.
struct Pieces {
    finite: Vec<PackedItem>,
    infinite: Vec<u32>,
}

/// The parts of a [`Scenery`] while they come together.
#[derive(Default)]
struct Parts {
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
                Geometry::Mesh(mesh) => self.mesh(scene, mesh, shape, number, &mut pieces),
                _ => self.primitives(shape, number, &mut pieces),
            };
            let added = pieces.finite.len() + pieces.infinite.len() - before;
            self.count += added;
            if !sound || added == 0 {
                self.problems.push(nothing_left(Subject::Shape(number)));
            }
            if pieces.finite.len() > TriangleLeaf::MOST && pieces.finite.len() - added <= TriangleLeaf::MOST {
                let message = format!("here triangles become more than {} together", TriangleLeaf::MOST);
                self.problems.push(SceneError { subject: Subject::Shape(number), message });
            }
        }
        pieces
    }

    /// Adds the triangles of a mesh that have an area; false if one is not sound.
    fn mesh(
        &mut self,
        scene: &Scene,
        mesh: Handle<Mesh>,
        shape: &Shape,
        number: usize,
        pieces: &mut Pieces,
    ) -> bool {
        let at = mesh.index() as u32;
        self.mesh_of.push(Some(at));
        let mesh = &scene.meshes[mesh];
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
            pieces.finite.push(Item::Triangle { shape: number as u32, index }.into());
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
                pieces.finite.push(Item::Other(Other::Primitive(at)).into());
            } else {
                return false;
            }
        }
        self.lamps.push(if shape.emission.is_some() { own } else { Vec::new() });
        true
    }

    /// Builds a level, where the instances have these bounds.
    fn build(&self, work: &Work<'_>, scene: &Scene, pieces: Pieces, instances: &[Bounds]) -> Level {
        let (meshes, mesh_of, primitives) = (scene.meshes.as_slice(), &self.mesh_of, &self.primitives);
        let items = Items { list: &pieces.finite, meshes, mesh_of, primitives, instances };
        Level::new(work, &items, pieces.infinite)
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

/// Puts meshes in their places, so that each is there once: where several shapes show one at different places, all but the
/// last of them get their own.
fn settle(scene: &mut Scene) {
    let Scene { shapes, groups, meshes, .. } = scene;
    let mut shapes: Vec<&mut Shape> =
        shapes.iter_mut().chain(groups.iter_mut().flat_map(|group| &mut group.shapes)).collect();
    // For each mesh the shape whose place it gets: the last, unless one leaves it where it is.
    let mut heirs: Vec<Option<usize>> = vec![None; meshes.len()];
    for (number, shape) in shapes.iter().enumerate() {
        if let Geometry::Mesh(mesh) = shape.geometry {
            let heir = &mut heirs[mesh.index()];
            let stays = heir.is_some_and(|heir| shapes[heir].to_world == Transform::IDENTITY);
            *heir = if stays { *heir } else { Some(number) };
        }
    }
    for (number, shape) in shapes.iter_mut().enumerate() {
        if let Geometry::Mesh(mesh) = shape.geometry
            && heirs[mesh.index()] != Some(number)
            && shape.to_world != Transform::IDENTITY
        {
            let mut own = meshes[mesh].clone();
            own.place(&shape.to_world);
            shape.to_world = Transform::IDENTITY;
            shape.geometry = Geometry::Mesh(meshes.push(own));
        }
    }
    for number in heirs.into_iter().flatten() {
        let shape = &mut shapes[number];
        if let Geometry::Mesh(mesh) = shape.geometry {
            meshes.item_mut(mesh).place(&shape.to_world);
            shape.to_world = Transform::IDENTITY;
        }
    }
}

/// The lights of a scene, what each is in the scene, and the light that each shape is.
type Emitters = (Vec<Emitter>, Vec<Subject>, Vec<Option<u32>>);

fn emitters(scene: &Scene, pieces: Vec<Vec<Primitive>>, lookup: Lookup<'_>, target: Target) -> Emitters {
    let (mut emitters, mut lamps) = (Vec::new(), Vec::new());
    let mut of_shape = vec![None; scene.shapes.len()];
    for (i, (shape, pieces)) in scene.shapes.iter().zip(pieces).enumerate() {
        let Some(radiance) = shape.emission else { continue };
        let index = emitters.len() as u32;
        let convex = is_convex(shape).then_some(index);
        if let Some(area) = AreaEmitter::new(pieces, radiance, shape.flip_normals, convex, lookup) {
            of_shape[i] = Some(index);
            let power = area.power();
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
