use super::{Aims, World};
use crate::bvh::Bvh;
use crate::camera::CameraRays;
use crate::color::Rgb;
use crate::light::{
    AreaEmitter, ConstantSky, Emitter, EmitterKind, EnvironmentMap, Light, LightKind, Lookup, Spot, Target,
};
use crate::material::Material;
use crate::math::{Bounds, Transform, warp};
use crate::sampling::Discrete;
use crate::scene::{self, Scene, SceneError, SceneErrors, Subject};
use crate::shape::{Geometry, Mesh, Primitive, Shape};

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
        let (meshes, pieces) = pieces(&scene)?;
        let mut bounds = Bounds::EMPTY;
        let (mut finite, mut infinite) = (Vec::new(), Vec::new());
        for (owner, pieces) in (0u32..).zip(&pieces) {
            for &piece in pieces {
                let b = piece.bounds();
                bounds = bounds.union(b);
                if b.is_empty() { infinite.push((piece, owner)) } else { finite.push((piece, owner)) }
            }
        }
        let boxes: Vec<Bounds> = finite.iter().map(|(p, _)| p.bounds()).collect();
        let (bvh, order) = Bvh::build(&boxes);
        let in_tree = order.len();
        let (primitives, owner) = order.iter().map(|&i| finite[i as usize]).chain(infinite).unzip();

        let camera = CameraRays::new(&scene.camera, &scene.film);
        let (center, radius) = bounds.with(camera.position()).bounding_sphere();
        // Infinite planes alone have no bounds; any size will do for light that only comes straight.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let (emitters, emitter_of_shape) = emitters(&scene, &pieces, Target { center, radius });
        let lookup = Lookup { meshes: &meshes, textures: &scene.textures };
        let aims = Aims::new(&scene, &pieces, &emitters, &emitter_of_shape, lookup, radius);
        let by_power = Discrete::new(emitters.iter().map(|e| f64::from(e.power.mean())));
        let for_direct = for_direct(&emitters);
        let invisible =
            scene.shapes.iter().map(|s| matches!(scene.materials[s.material], Material::Null)).collect();
        Ok(Self {
            scene,
            meshes,
            primitives,
            owner,
            in_tree,
            bvh,
            invisible,
            emitters,
            by_power,
            for_direct,
            emitter_of_shape,
            camera,
            bounds,
            aims,
        })
    }
}

/// World-space meshes, and the primitives of each shape.
fn pieces(scene: &Scene) -> Result<(Vec<Mesh>, Vec<Vec<Primitive>>), SceneErrors> {
    let mut meshes = Vec::new();
    let mut pieces = Vec::with_capacity(scene.shapes.len());
    let mut problems = Vec::new();
    for (i, shape) in scene.shapes.iter().enumerate() {
        let index = meshes.len();
        if let Geometry::Mesh(mesh) = shape.geometry {
            meshes.push(placed(&scene.meshes[mesh], &shape.to_world));
        }
        let own = Primitive::of_shape(shape, &meshes, index).filter(|own| own.iter().all(is_finite));
        pieces.push(own.unwrap_or_else(|| {
            problems.push(SceneError {
                subject: Subject::Shape(i),
                message: "nothing of it is left in single precision: it is too small, too thin or too large"
                    .into(),
            });
            Vec::new()
        }));
    }
    if problems.is_empty() { Ok((meshes, pieces)) } else { Err(SceneErrors(problems)) }
}

/// Whether single precision holds where it lies.
fn is_finite(piece: &Primitive) -> bool {
    let bounds = piece.bounds();
    bounds.is_empty() || (bounds.extent().is_finite() && bounds.area().is_finite())
}

/// A mesh in world space, still counter-clockwise where the transform mirrors.
fn placed(mesh: &Mesh, to_world: &Transform) -> Mesh {
    let mirrored = to_world.is_mirrored();
    Mesh {
        positions: mesh.positions.iter().map(|&p| to_world.point(p)).collect(),
        normals: mesh.normals.iter().map(|&n| to_world.normal(n)).collect(),
        uvs: mesh.uvs.clone(),
        triangles: mesh
            .triangles
            .iter()
            .map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect(),
    }
}

fn emitters(scene: &Scene, pieces: &[Vec<Primitive>], target: Target) -> (Vec<Emitter>, Vec<Option<u32>>) {
    let mut emitters = Vec::new();
    let mut of_shape = vec![None; scene.shapes.len()];
    for (i, shape) in scene.shapes.iter().enumerate() {
        let Some(radiance) = shape.emission else { continue };
        let index = emitters.len() as u32;
        let convex = is_convex(shape).then_some(index);
        if let Some(area) = AreaEmitter::new(pieces[i].clone(), radiance, shape.flip_normals, convex) {
            of_shape[i] = Some(index);
            let power = area.power(&scene.textures);
            emitters.push(Emitter { name: shape.name.clone(), kind: EmitterKind::Area(area), power });
        }
    }
    emitters.extend(scene.lights.iter().filter_map(|light| emitter(scene, light, target)));
    (emitters, of_shape)
}

/// Whether light that leaves a shape cannot meet it again.
fn is_convex(shape: &Shape) -> bool {
    match shape.geometry {
        Geometry::Rectangle | Geometry::Disk | Geometry::Plane => true,
        Geometry::Sphere { .. } | Geometry::Cylinder { .. } | Geometry::Cube => !shape.flip_normals,
        Geometry::Mesh(_) => false,
    }
}

/// `None` for an environment without light.
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
        LightKind::Environment { image, scale, to_world } => {
            let map = EnvironmentMap::new(&scene.textures, *image, *scale, to_world, target)?;
            let power = map.power();
            (EmitterKind::Environment(map), power)
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
