//! What meshes, shapes and their groups must satisfy to be rendered.

use super::check::{Problems, check_emission, check_transform, finite, positive};
use super::{Scene, Subject};
use crate::material::Material;
use crate::shape::{Geometry, Mesh, Shape};

fn is_masked(scene: &Scene, shape: &Shape) -> bool {
    scene.materials.contains(shape.material)
        && matches!(scene.materials[shape.material], Material::Mask { .. })
}

pub(super) fn check_mesh(mesh: &Mesh, mut problem: impl FnMut(&'static str)) {
    let n = mesh.positions.len();
    if mesh.triangles.is_empty() {
        problem("the mesh has no triangle");
    }
    if !mesh.positions.iter().all(|p| p.is_finite()) {
        problem("a vertex position is infinite or not a number");
    }
    if mesh.triangles.iter().flatten().any(|&i| i as usize >= n) {
        problem("a triangle refers to a vertex that does not exist");
    }
    for (length, name) in [
        (mesh.normals.len(), "the mesh must have a normal for each vertex or none"),
        (mesh.uvs.len(), "the mesh must have a texture coordinate for each vertex or none"),
        (mesh.colors.len(), "the mesh must have a colour for each vertex or none"),
    ] {
        if length != 0 && length != n {
            problem(name);
        }
    }
    if !mesh.normals.iter().all(|v| v.is_finite()) || !mesh.uvs.iter().all(|v| v.is_finite()) {
        problem("a vertex normal or texture coordinate is infinite or not a number");
    }
    if !mesh.colors.iter().all(|c| c.is_finite()) {
        problem("a vertex colour is infinite or not a number");
    }
}

pub(super) fn check_shapes(scene: &Scene, problems: &mut Problems) {
    let grouped = scene.groups.iter().flat_map(|group| &group.shapes);
    for (i, shape) in scene.shapes.iter().chain(grouped).enumerate() {
        let subject = Subject::Shape(i);
        check_transform(&shape.to_world, subject, problems);
        if !scene.materials.contains(shape.material) {
            problems.add(subject, "its material does not exist");
        }
        if shape.boundary.is_named() && is_masked(scene, shape) {
            problems.add(
                subject,
                "a masked surface bounds no medium, for nothing is crossed in its holes: put a shape of `null` material that \
                 names the media beside it",
            );
        }
        if shape.boundary.priority.is_some() {
            check_priority(scene, shape, subject, problems);
        }
        let needs_uniform_scale = match shape.geometry {
            Geometry::Sphere { center, radius } => {
                positive(radius, "radius", subject, problems);
                finite(center.is_finite(), "centre", subject, problems);
                true
            }
            Geometry::Cylinder { p0, p1, radius } => {
                positive(radius, "radius", subject, problems);
                finite(p0.is_finite() && p1.is_finite(), "axis", subject, problems);
                if p0 == p1 {
                    problems.add(subject, "the ends of the cylinder's axis coincide: it has no length");
                }
                true
            }
            Geometry::Mesh(mesh) => {
                if !scene.meshes.contains(mesh) {
                    problems.add(subject, "its mesh does not exist");
                }
                false
            }
            Geometry::Rectangle | Geometry::Disk | Geometry::Cube | Geometry::Plane => false,
        };
        if needs_uniform_scale && shape.to_world.uniform_scale().is_none() {
            problems.add(
                subject,
                "spheres and cylinders can only be scaled by the same factor on each axis: use a mesh for an ellipsoid",
            );
        }
        if let Some(emission) = shape.emission {
            if shape.geometry == Geometry::Plane {
                problems.add(subject, "an infinite plane cannot emit: its power has no end; use a rectangle");
            }
            if scene.materials.contains(shape.material)
                && matches!(scene.materials[shape.material], Material::Mask { .. })
            {
                problems.add(
                    subject,
                    "a masked shape cannot emit: give the light to a shape without a mask, and shape it by a texture of its radiance",
                );
            }
            check_emission(scene, emission, subject, problems);
        }
    }
}

/// A priority says what is inside where shapes overlap: so there must be an inside, and light must come there.
fn check_priority(scene: &Scene, shape: &Shape, subject: Subject, problems: &mut Problems) {
    if matches!(shape.geometry, Geometry::Rectangle | Geometry::Disk | Geometry::Cylinder { .. }) {
        let message = "a rectangle, a disk or a cylinder, which has no caps, encloses nothing and has no \
                       priority: use a closed shape";
        problems.add(subject, message);
    }
    let is_clear = |material: &Material| match *material {
        Material::Dielectric { .. } | Material::Null => true,
        Material::Dispersive { inside, .. } => {
            scene.materials.contains(inside) && matches!(scene.materials[inside], Material::Dielectric { .. })
        }
        _ => false,
    };
    if scene.materials.contains(shape.material) && !is_clear(&scene.materials[shape.material]) {
        let message = "only what light goes into has a priority: make it a smooth dielectric or `null`, or take \
                       the priority away";
        problems.add(subject, message);
    }
    if shape.emission.is_some() {
        problems.add(subject, "a lamp has no priority: put a lamp without one in its place");
    }
}

pub(super) fn check_groups(scene: &Scene, problems: &mut Problems) {
    let mut first = scene.shapes.len();
    for (i, group) in scene.groups.iter().enumerate() {
        if group.shapes.is_empty() {
            problems.add(Subject::Group(i), "the group has no shape: instances of it would show nothing");
        }
        for (j, shape) in (first..).zip(&group.shapes) {
            if shape.emission.is_some() {
                let message = "a shape of a group cannot emit light: put the lamp beside the instances";
                problems.add(Subject::Shape(j), message);
            }
            if shape.geometry == Geometry::Plane {
                let message = "an infinite plane cannot be part of a group: use a rectangle";
                problems.add(Subject::Shape(j), message);
            }
        }
        first += group.shapes.len();
    }
    for (i, instance) in scene.instances.iter().enumerate() {
        check_transform(&instance.to_world, Subject::Instance(i), problems);
        if !scene.groups.contains(instance.group) {
            problems.add(Subject::Instance(i), "its group does not exist");
        }
    }
}
