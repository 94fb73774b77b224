//! Shapes, groups and instances.

use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::{Geometry, Shape};

use super::textures::Range;
use super::{Writer, materials, ply};
use crate::image::ImageError;

/// How much wider than all else a plane is that stands for an endless one.
const ENDLESS: f64 = 1000.0;

impl Writer<'_, '_> {
    pub(super) fn shapes(&mut self) -> Result<(), ImageError> {
        let scene = self.scene;
        for group in scene.groups.iter() {
            let id = self.id(&group.name);
            self.xml.plugin("shape", "shapegroup", &id);
            self.groups.push(id);
            for shape in &group.shapes {
                self.shape(shape)?;
            }
            self.xml.close();
        }
        for shape in &scene.shapes {
            self.shape(shape)?;
        }
        for instance in &scene.instances {
            let id = self.id(&instance.name);
            self.xml.plugin("shape", "instance", &id);
            self.xml.reference("", &self.groups[instance.group.index()]);
            self.xml.transform("to_world", &instance.to_world);
            self.xml.close();
        }
        Ok(())
    }

    fn shape(&mut self, shape: &Shape) -> Result<(), ImageError> {
        let id = self.id(&shape.name);
        let mut to_world = shape.to_world;
        match shape.geometry {
            Geometry::Sphere { center, radius } => {
                self.xml.plugin("shape", "sphere", &id);
                self.xml.point("center", center);
                self.xml.float("radius", radius);
            }
            Geometry::Cylinder { p0, p1, radius } => {
                self.xml.plugin("shape", "cylinder", &id);
                self.xml.point("p0", p0);
                self.xml.point("p1", p1);
                self.xml.float("radius", radius);
            }
            Geometry::Rectangle => self.xml.plugin("shape", "rectangle", &id),
            Geometry::Disk => self.xml.plugin("shape", "disk", &id),
            Geometry::Cube => self.xml.plugin("shape", "cube", &id),
            Geometry::Plane => {
                self.warn(format!("{}: a plane without end becomes a large rectangle", shape.name));
                let side = ENDLESS * self.extent(&to_world);
                to_world = Transform::scale(DVec3::new(side, side, 1.0)).then(to_world);
                self.xml.plugin("shape", "rectangle", &id);
            }
            Geometry::Mesh(mesh) => {
                let number = mesh.index();
                let mesh = &self.scene.meshes[mesh];
                let name = match self.meshes.get(&number) {
                    Some(name) => name.clone(),
                    None => {
                        let name = self.store(&format!("mesh-{number}.ply"), ply::encode(mesh))?;
                        self.meshes.insert(number, name.clone());
                        name
                    }
                };
                self.xml.plugin("shape", "ply", &id);
                self.xml.string("filename", &name);
                if mesh.normals.is_empty() {
                    self.xml.boolean("face_normals", true);
                }
            }
        }
        self.xml.transform("to_world", &to_world);
        if shape.flip_normals {
            self.xml.boolean("flip_normals", true);
        }
        self.xml.reference("", &materials::id(shape.material));
        let boundary = shape.boundary;
        for (name, medium) in [("interior", boundary.interior), ("exterior", boundary.exterior)] {
            if let Some(medium) = medium {
                self.xml.reference(name, &self.media[medium.index()]);
            }
        }
        if boundary.priority.is_some() {
            self.warn(format!("{}: Mitsuba has no priorities of overlapping shapes", shape.name));
        }
        if let Some(emission) = shape.emission {
            self.xml.plugin("emitter", "area", "");
            self.paint("radiance", emission, Range::Any);
            if let Some(medium) = boundary.light {
                self.xml.reference("", &self.media[medium.index()]);
            }
            self.xml.close();
        }
        self.xml.close();
        Ok(())
    }

    /// How far the scene reaches from the middle of a plane, in units of its own.
    fn extent(&self, plane: &Transform) -> f64 {
        let scene = self.scene;
        let middle = plane.point(Vec3::ZERO);
        let mut reach = f64::from(scene.camera.to_world.point(Vec3::ZERO).distance(middle));
        let mut add = |to_world: &Transform, shape: &Shape| {
            let points: &[Vec3] = match shape.geometry {
                Geometry::Mesh(mesh) => &scene.meshes[mesh].positions,
                Geometry::Sphere { center, radius } => &[center + radius, center - radius],
                Geometry::Cylinder { p0, p1, radius } => {
                    &[p0 + radius, p1 + radius, p0 - radius, p1 - radius]
                }
                Geometry::Plane => &[Vec3::ZERO],
                Geometry::Rectangle | Geometry::Disk | Geometry::Cube => &[Vec3::ONE, Vec3::NEG_ONE],
            };
            for point in points {
                let at = shape.to_world.then(*to_world).point(*point);
                reach = reach.max(f64::from(at.distance(middle)));
            }
        };
        scene.shapes.iter().for_each(|shape| add(&Transform::IDENTITY, shape));
        for instance in &scene.instances {
            scene.groups[instance.group].shapes.iter().for_each(|shape| add(&instance.to_world, shape));
        }
        let unit = f64::from(plane.vector(Vec3::X).length().min(plane.vector(Vec3::Y).length()));
        if reach > 0.0 { reach / unit } else { 1.0 }
    }
}
